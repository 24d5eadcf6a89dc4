"""Several contacts, springs in contacts, belts, varying normal loads and periodic loads.

===============  ================================================================================
module           what is in it
===============  ================================================================================
certificate      friction over speed up to which there is one steady state
problem          a system over r as arrays for the kernels
observed         masses, drifts of storeys, accelerations, and the force on the base
held             forces in contacts that do not slide, and the boundaries that follow from them
slopes           steady sliding under friction over speed: slopes of its fall, one-way sliding
normal_force     normal forces that move with the structure: no slip, steady sliding, flutter
normal_resting   friction from which contacts with such normal forces can rest permanently
normal_limits    boundaries of contacts with such normal forces
loops            contacts that close a loop: permanent sticking, forces that are not determined
closed_limits    friction without stops in closed form, where there is one
no_stop          intervals of friction without stops
boundaries       boundaries over r: permanent sticking, no stops, one-way sliding on belts
limit_kinds      what ends the motion without stops, and which contact stops
partial          least friction at which one contact sticks while the others move
starts           initial states: at rest, or in a large sliding motion
still            masses that do not move
outputs          outputs of maps and responses: what each is computed from, and for which contacts
cyclic           rings under travelling loads: the sectors that differ, and the others from them
maps             the cells of a map, on several threads
resting_starts   motions from many states in which a contact is at its limit of friction (mu > 1)
dataset          maps and boundaries as labelled variables
responses        sizes of steady states on a grid and at scattered points
recorded         one steady state and the series of its steps, from the kernels
steps            one steady state as the series of its steps
cycle            harmonics, works and phases of a steady state
response         one steady state in time
curves           response curves
first_harmonics  first harmonics at a list of points (r, beta), mu = 1
one_mass         one mass under a load of several harmonics, for measured records
===============  ================================================================================
"""
