"""All compiled code: numbers and arrays in, numbers and codes out.

=================  =====================================================================================
module             what is in it
=================  =====================================================================================
compiler           how kernels are compiled, linked and kept on disk; the fall-back to plain numba
closed_form        one vibrating mode: trigonometry of pi/(2R), decay and damping functions
continuous_motion  amplitude and phase of the continuous motion of one mass; the least deviation that stops
event_codes        what follows the end of a slide
newton_limits      limits of Newton's method on the return map
taylor_series      the motion in one scan step: number of terms, first root, refined roots
boundary           response functions V, U, G, H, S of one mass and of structures, the terms of beta_lim
one_mass           scan step, events, return map and sliding orbit of one mass
extrapolation      where a cell begins: the polynomial through the last cells of its row
spectral_radius    the largest modulus of the eigenvalues of a matrix, from its powers
structure          the same for any structure, with its oscillators and states
logs               numbers of every cycle of a motion that does not repeat, their means and errors
long_periods       when a motion is searched for a long period, and when it is taken as irregular
general            any number of contacts, springs in contacts, belts, periodic loads
history            motions in time under records
no_load            motions on a belt without a load: all cycles of one mass; rides of structures
phases             normal forces that move, separation, piecewise linear springs
banks              banks of elastic elements, each bank one contact
motions_in_time    motions under records and after them, from interval to interval, of all engines
engine             solver of cells: recurrence, periodic orbits, outputs, stability, coexistence
=================  =====================================================================================
"""
