"""The phase after an event, counted."""

from ..compiler import kernel
from .pattern import is_at_rest, release_contact, rest_tied, settle
from .problem import (
    DOWN,
    ELASTIC,
    FIRST,
    LAST,
    LIFTOFFS,
    MOVED,
    NORMAL,
    OPEN,
    REVERSALS,
    RIGID,
    SLIPS,
    SMOOTH,
    STOPS,
    STUCK,
    TURNS,
    UP,
)
from .series import begin_terms, dot, factor_held, is_held, is_tied, limit_at, slave_forces, sliding_velocity

#: Distance of a force from its limit, relative to it, that is rounding error of the time at rest.
_ROUNDING = 1e-9


@kernel
def _count_slip(motion, j):
    """Count a slip of an elastic contact that begins, and a reversal of its sense."""
    counts, sense = motion.counts, motion.sense[j]
    counts[SLIPS, j] += 1.0
    if counts[LAST, j] * sense < 0.0:
        counts[REVERSALS, j] += 1.0
    counts[LAST, j] = sense
    if counts[FIRST, j] == 0.0:
        counts[FIRST, j] = sense


@kernel
def _close(problem, row, cell, motion, j):
    """Close a contact: its friction begins at 0."""
    motion.open[j], motion.sense[j], motion.f[j] = 0, 0, 0.0
    motion.lead[j, NORMAL] = 1
    if problem.law[j] == SMOOTH:
        return True
    w = sliding_velocity(problem, row, motion, j)
    if problem.law[j] == ELASTIC:
        if problem.spring[j] * abs(w) <= problem.lift[j] * dot(problem.normal, j, motion.p):
            motion.lead[j, UP] = motion.lead[j, DOWN] = 1
        else:
            motion.sense[j] = 1 if w > 0.0 else -1
        return True
    if not is_at_rest(problem, row, motion, j):
        motion.sense[j] = 1 if w > 0.0 else -1
        return True
    motion.open[j] = 1  # without friction the acceleration decides
    begin_terms(problem, row, cell, motion, 1)
    motion.open[j] = 0
    rate = dot(problem.chi, j, motion.terms.moves[2])
    rate -= problem.moved[j] * motion.drive[2, problem.squares.size]
    if rate != 0.0:
        motion.sense[j] = 1 if rate > 0.0 else -1
        motion.lead[j, UP] = 1
    else:
        motion.lead[j, UP] = motion.lead[j, DOWN] = 1
    return True


@kernel
def _change_normal(problem, row, cell, motion, j):
    """Open or close a contact."""
    motion.lead[j, UP] = motion.lead[j, DOWN] = 0
    if motion.open[j] != 0:
        return _close(problem, row, cell, motion, j)
    motion.open[j], motion.sense[j], motion.f[j] = 1, 0, 0.0
    motion.lead[j, NORMAL] = 1
    motion.counts[LIFTOFFS, j] += 1.0
    return True


@kernel
def _end_slide(problem, row, cell, motion, j):
    """End a slide of a rigid contact: a stop or a turn."""
    before = motion.sense[j]
    found = settle(problem, row, cell, motion, j, before)
    for i in range(problem.law.size):
        rigid = problem.law[i] == RIGID and motion.sense[i] != 0
        if rigid and (i == j or is_at_rest(problem, row, motion, i)):
            motion.lead[i, UP] = 1
    if motion.sense[j] == 0:
        motion.counts[STOPS, j] += 1.0
    else:
        motion.counts[TURNS, j] += 1.0
    return found


@kernel
def _release(problem, row, cell, motion, j, sense):
    """Let a rigid contact slide."""
    if cell.static[j] > 1.0:
        found = release_contact(problem, row, cell, motion, j, sense)
        for i in range(problem.law.size):
            rigid = problem.law[i] == RIGID and motion.sense[i] != 0
            if rigid and is_at_rest(problem, row, motion, i):
                motion.lead[i, UP] = 1
        return found
    motion.sense[j] = sense
    motion.lead[j, UP] = 2  # velocity and acceleration begin at 0
    return True


@kernel
def _change_friction(problem, row, cell, motion, j, which):
    """Change between slip and rest."""
    motion.lead[j, UP] = motion.lead[j, DOWN] = 0
    sense = motion.sense[j]
    if sense == 0:
        sense = 1 if which == UP else -1
        if problem.law[j] == RIGID:
            return _release(problem, row, cell, motion, j, sense)
        motion.sense[j] = sense
        _count_slip(motion, j)
        return True
    if problem.law[j] == RIGID:
        return _end_slide(problem, row, cell, motion, j)
    motion.f[j] = sense * limit_at(problem, cell, j, dot(problem.normal, j, motion.q))
    motion.sense[j] = 0
    motion.lead[j, UP if sense > 0 else DOWN] = 2  # force and rate are those of the limit
    return True


@kernel
def wake_tied(problem, row, cell, motion, order):
    """Begin the motion of elastic contacts at the limit that a rigid one has kept at rest: slip or not.

    The velocity begins at 0, with mu = 1 the acceleration too, and `order` is 2; where the force drops it is
    1.  The first term that is not 0 decides, beside that of the limit.
    """
    began = False
    for j in range(problem.law.size):
        woken = motion.idle[j] and not is_tied(problem, motion, j)
        limit = limit_at(problem, cell, j, dot(problem.normal, j, motion.q))
        if not woken or abs(motion.f[j]) < limit * (1.0 - _ROUNDING):
            continue
        if not began:
            begin_terms(problem, row, cell, motion, 4)
            began = True
        sense = 1 if motion.f[j] > 0.0 else -1
        rate = dot(problem.chi, j, motion.terms.moves[order + 1])
        rate -= problem.moved[j] * motion.drive[order + 1, problem.squares.size]
        change = problem.lift[j] * dot(problem.normal, j, motion.terms.moves[order + 1])
        if sense * problem.spring[j] * rate > change:
            motion.sense[j] = sense
            motion.lead[j, UP] = order
            _count_slip(motion, j)
        else:
            motion.lead[j, UP if sense > 0 else DOWN] = order + 1


@kernel
def change_phase(problem, row, cell, motion, who, what):
    """Change the pattern at an event; False if contacts do not determine their forces.

    `drive` is that of the present time; see `first_event` for `who` and `what`.
    """
    contacts = problem.law.size
    if who >= contacts:
        s = who - contacts
        motion.piece[s] += 1 if what == 0 else -1
        motion.lead_spring[s, 1 if what == 0 else 0] = 1
        motion.crossings[s] += 1.0
        found = True
    elif what == NORMAL:
        found = _change_normal(problem, row, cell, motion, who)
    else:
        found = _change_friction(problem, row, cell, motion, who, what)
    slave_forces(problem, cell, motion)
    found = factor_held(problem, row, motion) and found
    drops = who < contacts and cell.static[who] > 1.0
    wake_tied(problem, row, cell, motion, 1 if drops else 2)
    rest_tied(problem, cell, motion)
    return found


@kernel
def count_time(problem, motion, counts, time):
    """Add a time > 0 in which the pattern was the present one."""
    for j in range(problem.law.size):
        if motion.open[j] != 0:
            counts[OPEN, j] += time
        elif is_held(problem, motion, j):
            counts[STUCK, j] += time
        elif motion.sense[j] != 0:
            way = 1.0 if motion.sense[j] > 0 else 2.0
            counts[MOVED, j] = way if counts[MOVED, j] in (0.0, way) else 3.0


@kernel
def clear_counts(motion):
    """Set all counters to 0."""
    for j in range(motion.sense.size):
        for k in range(motion.counts.shape[0]):
            motion.counts[k, j] = 0.0
    for s in range(motion.piece.size):
        motion.crossings[s] = 0.0
