"""Force of a damper over a given displacement or velocity.

===============  ======================================================================
module           what is in it
===============  ======================================================================
branches         the displacement between its turning points
play             force of a spring with play in series with friction, along the branches
problem          joint least squares of the motion and of the force
descent          Levenberg-Marquardt for the many unknowns of a motion
shape            branches of a measured motion, from its own noise
starts           initial estimates, with the displacement held
fit              the joint fit, with the noise of both channels
static_friction  the interval of static over kinetic friction
held             tests in which nothing slips, or the contact is rigid
verdict          what the test shows, by likelihood ratios, and what the fit lacks
cautions         warnings about a fit
outcome          estimates and errors, with and without slip
loop             `loop`: from arrays to estimates
===============  ======================================================================
"""
