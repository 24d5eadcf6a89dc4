"""The only home of compiled code: numbers and arrays in, numbers and codes out.

=================  =========================================================================================
module             what is in it
=================  =========================================================================================
compiler           how kernels are compiled, linked and kept on disk; the fall-back to plain numba
closed_form        one vibrating mode: trigonometry of pi/(2R), decay and damping functions
continuous_motion  amplitude and phase of the continuous motion of one mass
event_codes        what follows the end of a slide
newton_limits      limits of Newton's method on the return map
taylor_series      the motion in one scan step: number of terms, first root, refined roots
boundary           response functions V, U, G, H, S and the boundaries, of one mass and of structures
one_mass           scan step, events, return map and sliding orbit of one mass
structure          the same of any structure, with its oscillators and states
many_harmonics     one mass under a load of several harmonics, for records of tests
engine             the solver of cells: follow, recognise a return, solve, measure; stability, other regimes
=================  =========================================================================================
"""
