"""Free decay of one mass with Coulomb and viscous friction.

===========  ========================================================================
module       what is in it
===========  ========================================================================
motion       the exact decay and its derivatives
sensor       sensors of the motion, its velocity or acceleration, with their filters
measured     what a sensor shows of a decay, and its derivatives
electronics  the unit of a record, filters that it passed, samples that they spoil
problem      least squares of a record on the exact decay
starts       initial estimates of the fit, for each number of half cycles before rest
fit          the decay nearest to all samples
falling      a warning of friction that falls with the speed, and what it looks like
wander       a slow wander of the measured zero
rounding     errors that a coarse converter makes, alike in samples at one place
errors       errors where noise is correlated, or hides the number of half cycles
checks       whether a record is a free decay, and whether the fit follows it
results      rest, bounds of mu, friction in other units
free_decay   `free_decay`: from arrays to estimates
part         a free decay as a part of a joint fit
===========  ========================================================================
"""
