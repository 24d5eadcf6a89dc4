"""The motion from one time to another."""

import math

from ..compiler import kernel
from ..general.problem import SECTION
from .change import change_phase, count_time
from .problem import put_loads
from .record import record_step
from .series import advance, begin_step, observe, slave_forces, stop_exactly
from .tables import (
    advance_by_table,
    advance_tangent_by_table,
    find_table,
    is_quiet,
    observe_by_table,
    put_units,
)
from .tangent import advance_tangent, before_event, through_event
from .watch import clear_leads, first_event, has_leads

#: What became of a motion: followed; more events in a step than are followed; no pattern is consistent.
FOLLOWED, CHATTERS, UNDETERMINED = 0, 1, 2

#: Events in a step, and events at one time, that are followed.
_MOST_EVENTS = 2000
MOST_IMMEDIATE = 50

#: Steps shorter than this are rounding errors of one time, at which several contacts may change their phase:
#: the zeros known at its beginning are known after it.
INSTANT = 1e-13


@kernel
def pass_event(problem, row, cell, tau, motion, who, what, derive):
    """Change the phase at an event, and carry the derivatives through it; False if that is not determined.

    Parameters
    ----------
    problem, row, cell : Problem, Row, Cell
    tau : phase of the event
    motion : Motion, whose state is that of the event
    who, what : see `first_event`
    derive : whether the derivatives are carried on; they are those of just before the event
    """
    if row.orders.size > 0:
        put_loads(row, tau, motion.drive)
    rate = before_event(problem, row, cell, motion, who, what) if derive else 0.0
    if not change_phase(problem, row, cell, motion, who, what):
        return False
    stop_exactly(problem, row, motion)
    if derive:
        through_event(problem, row, cell, motion, rate)
    return True


@kernel
def _step_by_table(problem, row, cell, tau, table, rest, motion, derive):
    """Follow the motion to the next event of a step, or to its end, with the tables of its phase.

    Parameters
    ----------
    problem, row, cell : Problem, Row, Cell
    tau : phase
    table : number of the tables
    rest, motion, derive : see `step_on`

    Returns
    -------
    (x, who, what) : as `step_on`
    """
    put_units(problem, row, cell, tau, motion)
    step, who, what = rest, -1, 0
    if has_leads(motion) or not is_quiet(problem, cell, motion, table):
        observe_by_table(problem, motion, table)
        found, who, what = first_event(problem, cell, motion, rest)
        step = min(found, rest)
    if step > 0.0:
        if derive:
            advance_tangent_by_table(problem, motion, table, step)
        count_time(problem, motion, motion.counts, step * row.h)
        advance_by_table(problem, motion, table, step)
        slave_forces(problem, cell, motion)
        if step > INSTANT:
            clear_leads(motion)
    return step, who, what


@kernel
def step_on(problem, row, cell, tau, interval, rest, motion, derive):
    """Follow the motion to the next event of a step, or to its end; the pattern does not change.

    Parameters
    ----------
    problem, row, cell : Problem, Row, Cell
    tau, interval : phase, and number of the step if it begins here; see `begin_step`
    rest : of the step, over its length
    motion : Motion
    derive : whether the derivatives are carried on

    Returns
    -------
    (x, who, what) : length of the way, and the event, see `first_event`
    """
    recorded = motion.record.active[0] != 0
    table = -1 if recorded else find_table(problem, row, motion)
    if table >= 0:
        return _step_by_table(problem, row, cell, tau, table, rest, motion, derive)
    begin_step(problem, row, cell, tau, interval, motion)
    observe(problem, row, motion, recorded)
    found, who, what = first_event(problem, cell, motion, rest)
    step = min(found, rest)
    if step > 0.0:
        if recorded:
            record_step(problem, row, cell, motion, tau, step)
        if derive:
            advance_tangent(problem, row, cell, motion, step)
        count_time(problem, motion, motion.counts, step * row.h)
        advance(problem, cell, motion, step)
        if step > INSTANT:
            clear_leads(motion)
    return step, who, what


@kernel
def cross(problem, row, cell, begin, interval, length, motion, derive):
    """Follow the motion through one step, or a part of it.

    Parameters
    ----------
    problem, row, cell : Problem, Row, Cell
    begin, interval : phase and number of the step, see `begin_step`
    length : of the part, over that of the step
    motion : Motion
    derive : whether the derivatives are carried on

    Returns
    -------
    int : FOLLOWED, CHATTERS or UNDETERMINED
    """
    x, tau, immediate = 0.0, begin, 0
    for _ in range(_MOST_EVENTS):
        number = interval if x == 0.0 else -1
        step, who, what = step_on(problem, row, cell, tau, number, length - x, motion, derive)
        if who < 0:
            return FOLLOWED
        x += step
        tau = begin + x * row.h
        immediate = immediate + 1 if step <= INSTANT else 0
        if immediate > MOST_IMMEDIATE:
            return CHATTERS
        if not pass_event(problem, row, cell, tau, motion, who, what, derive):
            return UNDETERMINED
    return CHATTERS


@kernel
def follow_period(problem, row, cell, motion, derive):
    """Follow the motion for one period of the load, from the section on; a code of `cross`."""
    for k in range(row.intervals):
        code = cross(problem, row, cell, SECTION + k * row.h, k, 1.0, motion, derive)
        if code != FOLLOWED:
            return code
    return FOLLOWED


@kernel
def follow_to_section(problem, row, cell, begin, motion):
    """Follow the motion from a phase, 0 to SECTION, to the section; a code of `cross`."""
    parts = (SECTION - begin) / row.h
    for k in range(int(math.ceil(parts))):
        code = cross(problem, row, cell, begin + k * row.h, -1, min(1.0, parts - k), motion, False)
        if code != FOLLOWED:
            return code
    return FOLLOWED


@kernel
def follow_time(problem, row, cell, time, motion, derive):
    """Follow a motion without a load for some time, in steps; a code of `cross`.

    The first step begins at an event or inside a phase, and so does the last one end.
    """
    whole = math.floor(time)
    for k in range(int(whole)):
        code = cross(problem, row, cell, k * row.h, -1, 1.0, motion, derive)
        if code != FOLLOWED:
            return code
    if time > whole:
        return cross(problem, row, cell, whole * row.h, -1, time - whole, motion, derive)
    return FOLLOWED
