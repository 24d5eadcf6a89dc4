"""Motions of structures whose contacts are banks of elastic elements, under periodic loads and records.

The elements of a bank slip in one order after every turn, so that a bank has as many linear phases as it has
elements, and one more.

============  ====================================================================================
module        what is in it
============  ====================================================================================
problem       a structure with banks, one cell, and the memory of a motion
level         levels of the contacts: which elements are at their limits, what follows a turn
step          one step: Taylor series of the motion, and the first event on them
tangent       derivatives of the motion by its state at the section
record        extremes, works and distances of a steady motion, and its steps
follow        the motion from one time to another
orbit         Newton's method for the state that returns, and what proves that a motion goes there
steady        the steady motion of one cell
trail         the steady motions of the last cells, which the next one begins from
fill          cells of a map, and the steps of one motion
kept          peaks, works, slips, events and samples of a motion under a record
under_record  the motion under a record: its start, an interval, its end
============  ====================================================================================
"""
