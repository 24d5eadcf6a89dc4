"""Response functions V, U, G, H, S and the boundaries of the regimes.

=========  ============================================================================
module     what is in it
=========  ============================================================================
one_mass   S of one mass, T(2.27): the largest value of a bracket over half a period
functions  V, U, G, H, S of one mass over frequency; damping functions of several modes
structure  S and its bound T(5.55), and the boundaries of structures over frequency
=========  ============================================================================
"""
