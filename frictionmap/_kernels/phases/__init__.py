"""Motions through linear phases: normal forces that move, separation, gaps, backlash, bilinear springs.

A contact is open or closed, and where it is closed it slips or is held; a spring is on one of its pieces.
In every such phase the motion is a Taylor series that follows from the equation of motion term by term, and
the phase ends at the first zero of quantities that are linear in the state.

============  ====================================================================================
module        what is in it
============  ====================================================================================
problem       a system, the constants of one r, the friction of one cell, the memory of a motion
series        Taylor series of a step in the present phase; forces that hold rigid contacts
watch         quantities whose zero ends a phase, and the first of these zeros
pattern       the phase from a state, and which rigid contacts slide after an event
change        the phase after an event, counted
tables        tables of the phases of one r: series of a step by the coordinates at its beginning
tangent       derivatives of the motion by its state at the beginning
record        extremes, works and distances of a steady motion, and its steps
follow        the motion from one time to another
orbit         Newton's method for the state that returns, and its multipliers
steady        the steady motion of one cell under a periodic load
cycles        the steady motion of one cell without a load, on belts: its period is unknown
fill          cells of a map, and the steps of one motion, with and without a load
kept          what is kept of a motion under a record: peaks, works, slides, events, samples
rest          when a motion without a load has ended; contacts held in place
under_record  the motion under a record: its start, a part of an interval, its end
============  ====================================================================================
"""
