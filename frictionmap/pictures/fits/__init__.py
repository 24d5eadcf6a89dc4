"""Pictures of fits to measured data.

=========  =====================================================
module     what is in it
=========  =====================================================
data       measured samples with their errors, and residuals
picture    the parts of a picture of a fit
samples    fits to any data
decay      free decays with their envelope
sweep      sweeps of two masses
position   measured motions among the regimes of their structure
responses  panels of amplitudes and lags over frequency
chain      sweeps of chains
forced     forced responses with the curves of their sets
record     records in time, and their cycles superimposed
loop       damper tests in time, and as force over motion
figure     choice of these pictures, and their layout
=========  =====================================================
"""
