"""The motion from one time to another."""

import math

from ..compiler import kernel
from ..general.problem import SECTION
from ..phases.problem import LAST, MOVED, REVERSALS, SLIPS, STUCK
from .level import (
    NOTHING,
    TURN,
    begin_slip,
    displacement,
    mark_level,
    pass_thresholds,
    put_pulls,
    turn_back,
)
from .record import record_step
from .step import (
    advance,
    choose_length,
    clear_leads,
    contact_velocity,
    first_event,
    put_series,
    put_waves,
)
from .tangent import advance_tangent

#: What became of a motion: followed; more events in a period than are followed.
FOLLOWED, CHATTERS = 0, 1

#: Steps of a period, and events of a contact at one time, at most.
MOST_STEPS, MOST_IMMEDIATE = 1000000, 100

#: Angles of the fastest part of the motion that are rounding errors of one time: velocities that begin at 0
#: there do so still after them.
INSTANT = 1e-13


@kernel
def begin_state(problem, row, cell, tau, motion):
    """Make levels and senses suit a state, and begin to count."""
    put_waves(row, tau, motion)
    motion.turns[0] = 0
    for j in range(problem.moved.size):
        motion.counts[SLIPS, j] = motion.counts[REVERSALS, j] = 0.0
        motion.counts[STUCK, j] = motion.counts[MOVED, j] = 0.0
        z, w = displacement(problem, motion, j), contact_velocity(problem, motion, j)
        motion.range[0, j] = motion.range[1, j] = z
        motion.most[0, j] = motion.most[1, j] = 0
        put_pulls(problem, cell, motion, j, problem.first[j + 1] - problem.first[j])
        if w * motion.now.sense[j] < 0.0:
            turn_back(problem, cell, motion, j, z)
        if w != 0.0:
            motion.now.lead[j] = 0
        pass_thresholds(problem, cell, motion, j, z)
        mark_level(motion, j)


@kernel
def _forget_turns(motion):
    """Forget which turns there were before this period."""
    for i in range(motion.now.turn.size):
        motion.now.turn[i] = 0


@kernel
def pass_event(problem, cell, motion, j, what):
    """Change the level or the sense of a contact at an event, with the waves of its time."""
    z = displacement(problem, motion, j)
    if what == TURN:
        turn_back(problem, cell, motion, j, z)
    else:
        begin_slip(problem, cell, motion, j, z)


@kernel
def follow(problem, row, cell, begin, end, motion):
    """Follow the motion from one phase to a later one; FOLLOWED or CHATTERS."""
    tau, immediate = begin, 0
    put_waves(row, tau, motion)
    for _ in range(MOST_STEPS):
        if tau >= end:
            return FOLLOWED
        length, angle = choose_length(problem, row, cell, motion, end - tau)
        count = put_series(problem, row, cell, motion, length, angle)
        x, who, what = first_event(problem, cell, motion, count)
        if x > 0.0:
            for j in range(problem.moved.size):
                if motion.now.level[j] == 0:
                    motion.counts[STUCK, j] += x * length
            if motion.record.active[0] != 0:
                record_step(problem, cell, motion, tau, length, count, x)
            advance_tangent(problem, row, motion, count, length, x)
            advance(motion, count, length, x)
            tau = end if x == 1.0 and length >= end - tau else tau + x * length
        put_waves(row, tau, motion)
        if x * angle > INSTANT:
            clear_leads(motion)
            immediate = 0
        else:
            immediate += 1
            if immediate > MOST_IMMEDIATE * problem.moved.size:
                return CHATTERS
        if what != NOTHING:
            pass_event(problem, cell, motion, who, what)
    return CHATTERS


@kernel
def _mirror(problem, motion):
    """Turn the sign of a motion, and put the sliders that rest in its middle."""
    now, tangent = motion.now, motion.tangent
    for i in range(problem.squares.size):
        now.q[i], now.p[i] = -now.q[i], -now.p[i]
        for c in range(tangent.count[0]):
            tangent.q[i, c], tangent.p[i, c] = -tangent.q[i, c], -tangent.p[i, c]
    for i in range(problem.spring.size):
        rests = now.turn[i] == 0
        now.place[i] = 0.0 if rests else -now.place[i]
        now.side[i] = 0.0 if rests else -now.side[i]
        for c in range(tangent.count[0]):
            tangent.slider[i, c] = -tangent.slider[i, c]
    for j in range(problem.moved.size):
        now.sense[j] = -now.sense[j]
        motion.counts[LAST, j] = -motion.counts[LAST, j]


@kernel
def follow_period(problem, row, cell, motion, half):
    """Follow the motion for one period of the load, from the section on, with its counts; see `follow`.

    With `half` for half a period, which ends at the mirror image: under odd orders, of a steady motion whose
    sliders at rest are in its middle, that is the state at the beginning.
    """
    _forget_turns(motion)
    begin_state(problem, row, cell, SECTION, motion)
    way = math.pi if half else 2.0 * math.pi
    code = follow(problem, row, cell, SECTION, SECTION + way, motion)
    for j in range(problem.moved.size):
        z = displacement(problem, motion, j)
        motion.range[0, j] = min(motion.range[0, j], z)
        motion.range[1, j] = max(motion.range[1, j], z)
    if half:
        _mirror(problem, motion)
    return code
