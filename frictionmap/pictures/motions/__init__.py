"""Pictures of one steady state, and of motions under records.

==========  ===========================================================
module      what is in it
==========  ===========================================================
traces      motion, stops and friction levels of every contact
loops       friction over the motion in the contacts
history     motion, friction force and events in time
in_time     motions under records; friction response spectra
belt_cycle  one motion on a belt without a load
suites      peaks over the scale of records; energies over friction
orbit       phase portrait, friction loop, harmonics
animation   moving picture: masses, lights of stuck contacts, loop
==========  ===========================================================
"""
