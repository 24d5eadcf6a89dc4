"""Starts and thresholds that both kinds of motion share."""

#: The moving start, in units of the motion that the load alone sustains: energy amplitude, and the cap on
#: that motion near resonance.  Of 25 starts tried on 4,000 cells where sliding and sticking coexist this one
#: slid on in the largest share, 95 %.
MOVING = 1.5
MOVING_CAP = 10.0

#: Scan steps per fastest period for bounds over a whole orbit: their slack is of second order in the step.
FINE_STEPS = 64.0

#: Places for states to come back to: the anchor of the orbit measured; where the motion is while it is
#: seen whether it goes to an orbit, and that orbit; and two for `coexistence`.
ANCHOR, NOW, GOAL, NEIGHBOUR, FARTHEST, SLOTS = 0, 1, 2, 3, 4, 5
