"""Closed forms over frequency: boundaries of the regimes, and the continuous motion.

=================  ==============================================================================
module             what is in it
=================  ==============================================================================
boundary_curves    beta_lim, T(2.26), and beta_stick over frequency from V, U, G, H, S, as arrays
boundaries         the same as a dataset, with features
half_waves         motion over half a period from a maximum of z, and its largest modulus
energy             work per cycle, and force transmitted to the ground
continuous_motion  `continuous_motion`: steady states that never stop
limit_curves       amplitude and phase of every mass at beta_lim
=================  ==============================================================================
"""
