"""Records of the steady motion of one mass on a base that moves with several harmonics.

===============  ===================================================================
module           what is in it
===============  ===================================================================
motion           exact steady motions under the measured base, and their derivatives
starts           where the fit starts
static_friction  whether mu is fitted, and its interval
fit              the steady motion nearest to all samples
data             records, checked, with their harmonics
errors           errors of the fit, and of what follows from it
labels           what a record is without any model, and what to mind of it
verdict          what a record shows of friction, and what it cannot tell apart
record           `record`: from arrays to estimates
===============  ===================================================================
"""
