"""The table of phases of a steady state: slides and stops in order, each with its exact motion.

One row a phase; a phase that is a mirror image is told so by its sign.  The state at its start is that of
`structure.StructureAtFrequency`, free oscillators in a slide and held oscillators in a stop, whatever kind of
motion was followed.  All that is asked of a steady state beyond its regime is read from here.
"""

import math

from ..jit import entry, kernel
from ..structure.sliding_orbit import orbit_state
from ..structure.state import contact_displacement

BEGIN = 0  # in tau, since the first phase
LENGTH = 1  # in tau
SENSE = 2  # 1 for a slide (upwards, mirrored or not), 0 for a stop
SIGN = 3  # -1 where the row is the mirror image of the motion
COS = 4  # load's phase at the start
SIN = 5
STOP_Z = 6  # z of a stop
Z_END = 7  # z at the end
CONTACT_FORCE = 8  # force in the contact at the start of a slide, friction taken off
EVENT = 9  # which ended a slide, see `one_mass.events`
STATE = 10  # 2n of a slide, or 2m of a stop: coordinates, and velocities in t = tau/r


@entry
def segment_columns(n):
    """Columns of the table for n modes."""
    return STATE + 2 * n


@kernel
def put_state(state, n, rate, c, s, row):
    """The start of a phase in which n oscillators move."""
    row[COS] = c
    row[SIN] = s
    for i in range(n):
        row[STATE + i] = state[0, i]
        row[STATE + n + i] = state[1, i] * rate


@kernel
def put_mass(z, c, s, row):
    """The start of a phase of one mass, which has no velocity there; in a stop nothing else moves."""
    row[COS] = c
    row[SIN] = s
    row[STATE] = z
    row[STATE + 1] = 0.0


@kernel
def put_segment(row, begin, length, sense, sign, z_end):
    """What else there is to a phase."""
    row[BEGIN] = begin
    row[LENGTH] = length
    row[SENSE] = sense
    row[SIGN] = sign
    row[STOP_Z] = z_end if sense == 0.0 else math.nan
    row[Z_END] = z_end


@entry
def continuous_segment(st, orbit, i, beta, phase, row, work):
    """The rising half of the continuous orbit, a table of one phase; `phase` is the load's at its maximum."""
    c, s = -math.cos(phase), -math.sin(phase)
    orbit_state(st, orbit, i, beta, phase, c, s, work.start)
    z = contact_displacement(st, work.start, c, s)
    put_state(work.start, st.n, st.rate, c, s, row)
    put_segment(row, 0.0, math.pi, 1.0, 1.0, -z)


@entry
def take_start(st, row, work):
    """(slides, n, state): whether a phase slides, and the state of its n oscillators at its start."""
    slides = row[SENSE] > 0.0
    n = st.n if slides else st.m
    state = work.moved if slides else work.held
    for i in range(n):
        state[0, i] = row[STATE + i]
        state[1, i] = row[STATE + n + i] / st.rate
    return slides, n, state
