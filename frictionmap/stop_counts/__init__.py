"""Borders between numbers of stops per cycle, as exact curves.

==========  ===========================================================================================
module      what is in it
==========  ===========================================================================================
phases      slides and stops as affine maps of the state
orbits      periodic motions with a given sequence of slides and stops
conditions  the kinds of borders and their equations
margins     consistency margins of an orbit
tracing     borders as curves: Newton's method for a point, pseudo-arclength from point to point
seeds       neighbouring cells with different numbers of stops, and their orbits
beginnings  first points of borders: those that end the orbits of a seed
curves      all borders in a window
dataset     `borders`: the same as a dataset
==========  ===========================================================================================
"""
