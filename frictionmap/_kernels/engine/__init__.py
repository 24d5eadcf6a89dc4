"""Solver of single cells, shared by one mass and by structures.

=============  ====================================================================================
module         what is in it
=============  ====================================================================================
periods        half periods in a time, and periods of a recurring motion
policies       initial states and thresholds shared by both kinds of motion
records        records passed to and returned by the solver: contact, state, limits, orbit, cell
memory         ring buffer of past anchors
cycle_log      what a motion did in every excitation period, and its averages
schedules      when Newton's method is tried
segment_table  slides and stops of a steady state in order, each with its exact motion
one_mass       one mass as a kind of motion
many_masses    a structure as a kind of motion
motion         the operations that each kind of motion implements
recurrence     recurrence detection
measure        stops, amplitude, stuck fraction and segment table of a periodic orbit
march          the solver: follow the motion from event to event, then solve for the periodic orbit
window         segment table of the last periods of a motion that does not repeat
extremes       largest displacements, and largest force to the ground
transforms     Fourier integrals over one segment
harmonics      exact harmonics of friction, masses and contact
dissipation    sliding distance, and work of the dampers
distortion     the part of a motion beyond its mean and first harmonic
time_history   a steady state sampled in time
floquet        Floquet multipliers, and deviation from antiperiodicity
exponents      Lyapunov exponents of irregular motions
details        further outputs of a map: amplitudes of the masses, multipliers, asymmetry
quantities     what response curves hold: extremes, harmonics, work
further        details and quantities of a cell, as far as they are requested
coexistence    `also_reachable`: regimes that other initial states lead to
fill           the cells of a map
=============  ====================================================================================
"""
