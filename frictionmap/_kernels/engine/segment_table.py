"""Segment table of a steady state: its slides and stops in order, each with its exact motion.

Each row is one segment.  A segment that is the mirror image of the true motion has sign -1.  The state at its
start is that of `structure.state.StructureAtFrequency`, of the free oscillators in a slide and of the held
oscillators in a stop, for both kinds of motion.  All results except the regime are read from this table.
"""

import math

from ..compiler import entry, kernel
from ..structure.sliding_orbit import orbit_state
from ..structure.state import contact_displacement

BEGIN = 0  # start in tau, since the first segment began
LENGTH = 1  # duration in tau
SENSE = 2  # 1 for a slide (upwards, mirrored or not), 0 for a stop
SIGN = 3  # -1 where the row is the mirror image of the true motion
COS = 4  # load phase at the start
SIN = 5
STOP_Z = 6  # z of a stop
Z_END = 7  # z at the end
CONTACT_FORCE = 8  # contact force less the friction at the start of a slide
EVENT = 9  # event that ended a slide, see `one_mass.events`
STATE = 10  # 2n numbers for a slide, 2m for a stop: coordinates, then velocities in t = tau/r


@entry
def segment_columns(n):
    """Columns of the segment table for n modes."""
    return STATE + 2 * n


@kernel
def put_state(state, n, rate, c, s, row):
    """Write load phase and state at the start of a segment with n moving oscillators."""
    row[COS] = c
    row[SIN] = s
    for i in range(n):
        row[STATE + i] = state[0, i]
        row[STATE + n + i] = state[1, i] * rate


@kernel
def put_mass(z, c, s, row):
    """Write load phase and displacement at the start of a segment of one mass; its velocity is zero there."""
    row[COS] = c
    row[SIN] = s
    row[STATE] = z
    row[STATE + 1] = 0.0


@kernel
def put_segment(row, begin, length, sense, sign, z_end):
    """Write the remaining columns of a segment."""
    row[BEGIN] = begin
    row[LENGTH] = length
    row[SENSE] = sense
    row[SIGN] = sign
    row[STOP_Z] = z_end if sense == 0.0 else math.nan
    row[Z_END] = z_end


@entry
def continuous_segment(st, orbit, i, beta, phase, row, work):
    """Write the rising half of the continuous orbit, which is a segment table of one row.

    Parameters
    ----------
    st : StructureAtFrequency
    orbit : Continuous; i : index of the frequency
    beta : kinetic friction force
    phase : load phase at the maximum of z
    row : (columns,) row to fill
    work : Workspace
    """
    c, s = -math.cos(phase), -math.sin(phase)
    orbit_state(st, orbit, i, beta, phase, c, s, work.start)
    z = contact_displacement(st, work.start, c, s)
    put_state(work.start, st.n, st.rate, c, s, row)
    put_segment(row, 0.0, math.pi, 1.0, 1.0, -z)


@entry
def take_start(st, row, work):
    """Read the start of a segment: (slides, n, state), the state being that of its n moving oscillators."""
    slides = row[SENSE] > 0.0
    n = st.n if slides else st.m
    state = work.moved if slides else work.held
    for i in range(n):
        state[0, i] = row[STATE + i]
        state[1, i] = row[STATE + n + i] / st.rate
    return slides, n, state
