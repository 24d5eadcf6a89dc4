"""Response functions V, U, G, H, S over frequency, from which `theory.boundary_curves` computes beta_lim.

=========  ============================================================================
module     what is in it
=========  ============================================================================
one_mass   S of one mass, T(2.27): the largest value of a bracket over half a period
functions  V, U, G, H, S of one mass over frequency; damping functions of several modes
structure  U, G, H, S of structures over frequency, and the modal bound, T(5.55)
=========  ============================================================================
"""
