"""Chains of masses without friction, base shaken: sweeps of amplitudes and lags.

==========  ================================================================
module      what is in it
==========  ================================================================
response    response of a chain, and its derivatives
two_masses  two masses in closed form
inverse     a chain from the resonances and antiresonances of its first mass, on either side of samples
fit         the chain nearest to amplitudes and lags
errors      fits to data whose errors are not known
estimates   the dataset of such a fit
data        tables of sweeps, checked
sweep       `sweep`: from amplitudes and lags over frequency to estimates
==========  ================================================================
"""
