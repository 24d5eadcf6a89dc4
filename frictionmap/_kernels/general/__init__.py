"""Motions of structures with any number of contacts, rigid or elastic, under any periodic load.

A motion is a chain of steps.  In each the modes are Taylor series that follow from the equation of motion
term by term, with the forces that hold the held contacts, so that no combination of held contacts needs a
solution of its own.  Events are located on these series, with certainty.

=============  =====================================================================================
module         what is in it
=============  =====================================================================================
keys           places of patterns in tables
problem        a system over r, the constants of one r, the memory of a motion: arrays and their rows
crossings      values of a series, and its first zero, with certainty
cholesky       factors of small positive definite matrices
counts         counters of a motion
laws           contact laws: phases, watched quantities, what follows an event
row            the constants of one r and the memory of a motion, allocated and filled; series of the load
held_together  forces that hold many contacts, in a term of a series
series         series of one step: modes, forces, motion in the contacts
pattern        which contacts slide and which are held after an event
loops          rigid contacts that close loops: which are held, and with which forces
events         turns, stops and slowest instants of slides
record         extremes, works, steps and events of a steady motion
left_free      derivatives of motions in which many contacts are held, in the coordinates that are free
tangent        derivatives of the motion by its state at the section
glide          intervals in which nothing happens, by tables
follow         the motion from one phase of the load to another
return_map     the state after some half periods, and Newton steps to one that returns
parts          rings whose sectors move alike: the state after a part of half a period
recurrence     recurrence detection: the last states at the section, and a return to one of them
lower_upper    factors of general matrices
orbits         steady states by Newton's method, their multipliers and periods
creep          contacts that slide ever less, and in the end rest
places         places of contacts that rest, from the motion that leads there
approach       whether a motion goes to a steady state, for mu > 1
course         what a motion does in every period of the load, and its averages if it does not return
single_tables  one mass with one rigid contact: tables of one r
single_mass    its steady state for mu = 1, by these tables
steady         the steady state of one cell
fill           the cells of a map
partial        the force that holds one contact while the others move
neighbours     steady states next to each other in friction, and what may lie between them
reach          the steady state at a friction ratio, from one next to it
ends           ends of intervals of friction without stops
no_stop        friction ratios at which no contact stops
samples        displacements of a recorded motion
=============  =====================================================================================
"""
