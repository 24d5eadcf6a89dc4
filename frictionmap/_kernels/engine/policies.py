"""Starts and thresholds that both kinds of motion share."""

#: The moving start, in units of the motion that the load alone sustains: energy amplitude, and the cap on
#: that motion near resonance.  Of 25 starts tried on 4,000 cells where sliding and sticking coexist this one
#: slid on in the largest share, 95 %.
MOVING_START = 1.5
MOVING_START_CAP = 10.0

#: Scan steps per fastest period for bounds over a whole orbit: their slack is of second order in the step.
FINE_STEPS = 64.0

#: Nodes of the ladders of `coexistence`: around beta_lim, in eighths of it, and from beta_stick up.
EIGHTHS = 9
RUNGS = 24

#: Places for states to come back to: the anchor of the orbit measured; where the motion is while it is
#: seen whether it goes to an orbit, and that orbit; and the nodes of both ladders, either way.
ANCHOR, NOW, GOAL, AROUND = 0, 1, 2, 3
ABOVE = AROUND + 2 * EIGHTHS
SLOTS = ABOVE + 2 * RUNGS
