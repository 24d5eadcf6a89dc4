"""Solver of single cells, shared by one mass and by structures.

| module | what is in it |
|---|---|
| `records` | records passed to and returned by the solver: contact, contact state, limits, orbit, cell |
| `motion` | interface that each kind of motion implements |
| `one_mass`, `many_masses` | the two kinds of motion |
| `memory` | ring buffer of past anchors |
| `recurrence` | recurrence detection |
| `statistics` | averages of motions that do not repeat; schedule of Newton's method |
| `march` | solver: follow the motion from event to event, then solve for the periodic orbit |
| `measure` | stops, amplitude, share stuck and segment table of a periodic orbit |
| `segment_table` | table of the slides and stops of a steady state |
| `extremes`, `transforms`, `harmonics`, `dissipation`, `distortion`, `floquet`, `time_history` | results that
are read from the segment table |
| `details`, `quantities` | the results that a map or a set of response curves requests |
| `coexistence` | further regimes that a cell can reach from other initial states |
| `window` | segment table of the last periods of a motion that does not repeat |
| `fill` | cells of a map |
| `policies` | initial states and thresholds shared by both kinds of motion |
"""
