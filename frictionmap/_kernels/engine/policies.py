"""Initial states and thresholds shared by both kinds of motion."""

#: Energy amplitude of the moving start, relative to the response without friction, and the upper limit on
#: that response near resonance.  In 4,000 cells where sliding and sticking coexist, 25 initial states were
#: compared: with this one the largest share of the cells, 95 %, kept sliding.
MOVING_START = 1.5
MOVING_START_CAP = 10.0

#: Friction ratio, relative to the load in the contact, below which friction is treated as zero: half a unit
#: of rounding of the load.
NO_FRICTION = 2.0**-53

#: Scan steps per fastest period for bounds over a whole orbit; the bounds tighten with the square of the
#: step.
FINE_STEPS = 64.0

#: Nodes of the two ladders in beta of `coexistence`: multiples of beta_lim/8, and nodes from beta_stick
#: upwards.
EIGHTHS = 9
RUNGS = 24

#: Slots for saved states: the anchor of the orbit being measured; the current state, and the orbit it is
#: compared with, while the solver checks whether the motion approaches that orbit; the nodes of both ladders
#: in both directions.
ANCHOR, NOW, GOAL, AROUND = 0, 1, 2, 3
ABOVE = AROUND + 2 * EIGHTHS
SLOTS = ABOVE + 2 * RUNGS
