"""Motion of one mass under a measured base or force of any shape, from its initial state.

========  =========================================================================
module    what is in it
========  =========================================================================
drive     samples of a base or force, the spline through them, how it moves a mass
model     the motion, what a sensor shows of it, and the derivatives of that
problem   least squares, with the noise of the drive as covariance of the residuals
starts    initial estimates, and the minima to which they lead
fit       the least sum, samples beside events, renewed covariance
checks    arrays and parameters, checked; records in which nothing slips
outcome   estimates, their errors and intervals, verdict and warnings
history   `history`: from arrays to estimates
========  =========================================================================
"""
