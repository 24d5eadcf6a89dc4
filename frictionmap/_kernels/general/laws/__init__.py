"""Contact laws: what a contact is while it is held, what is watched, and what follows an event.

Each law has a file.  The engine asks through `contact`, which passes each question on to the law of the
contact; `kinds` determines the law from the numbers of the contact.  A contact is in one of few phases, in
each of which the motion is linear: it slides up or down, or it is held, by a constraint or by a spring.

========  ========================================================================================
module    what is in it
========  ========================================================================================
kinds     which law a contact has; constraint, stiffness and coordinates of its present phase
speed     friction over the sliding speed: segments, the events between them, what depends on velocity
coulomb   limits of Coulomb friction, which all laws have: watched quantities, their first zero
rigid     held by a constraint; forces jump where it arrives, and where it is released for mu > 1
elastic   a spring and a slider in series: its force is a coordinate of the state and never jumps
coupled   elastic contacts in which forces displace others at once: their rates, and where slips begin
contact   what the engine asks of a contact, whatever its law
========  ========================================================================================
"""
