"""The levels of the contacts: which elements are at their limits, and what follows a turn."""

from ..compiler import kernel
from ..phases.problem import FIRST, LAST, MOVED, REVERSALS, SLIPS

#: Events of `step.first_event`.
NOTHING, YIELD, TURN = 0, 1, 2


@kernel
def displacement(problem, motion, j):
    """Displacement in a contact; the place of the base is that of the last `put_waves`."""
    total = -problem.moved[j] * motion.loads[0, problem.squares.size]
    for i in range(problem.squares.size):
        total += problem.chi[j, i] * motion.now.q[i]
    return total


@kernel
def slider(problem, cell, motion, j, i, z):
    """Place of the slider of element i of contact j."""
    now = motion.now
    if i - problem.first[j] < now.level[j]:
        return z - now.sense[j] * cell.limit[i]
    return now.place[i] - now.side[i] * cell.limit[i]


@kernel
def threshold(problem, cell, now, j):
    """Place at which the next element begins to slip; there is one."""
    i = problem.first[j] + now.level[j]
    return now.place[i] + (now.sense[j] - now.side[i]) * cell.limit[i]


@kernel
def has_threshold(problem, now, j):
    """Whether an element is not at its limit."""
    return problem.first[j] + now.level[j] < problem.first[j + 1]


@kernel
def put_pulls(problem, cell, motion, j, count):
    """Sum k y from each of the first `count` elements of contact j on; the others have not moved."""
    now, tangent = motion.now, motion.tangent
    for i in range(problem.first[j] + count - 1, problem.first[j] - 1, -1):
        spring = problem.spring[i]
        place = now.place[i] - now.side[i] * cell.limit[i]
        motion.pull[i + j] = motion.pull[i + j + 1] + spring * place
        for c in range(tangent.count[0]):
            tangent.pull[i + j, c] = tangent.pull[i + j + 1, c] + spring * tangent.slider[i, c]


@kernel
def _count_slip(motion, j):
    """Count a slip that begins, and a reversal of its sense."""
    counts, sense = motion.counts, motion.now.sense[j]
    counts[SLIPS, j] += 1.0
    if counts[LAST, j] * sense < 0.0:
        counts[REVERSALS, j] += 1.0
    counts[LAST, j] = sense
    if counts[FIRST, j] == 0.0:
        counts[FIRST, j] = sense


@kernel
def mark_level(motion, j):
    """Take the level of a contact into its highest one."""
    now = motion.now
    which = 1 if now.sense[j] > 0 else 0
    motion.most[which, j] = max(motion.most[which, j], now.level[j])
    if now.level[j] > 0:
        bit = 1.0 if now.sense[j] > 0 else 2.0
        if motion.counts[MOVED, j] != bit:
            motion.counts[MOVED, j] = min(3.0, motion.counts[MOVED, j] + bit)


@kernel
def slipping(motion, j):
    """Number of elements of a contact that slip both ways in this period.

    In an orbit one that slips does so; one that was at its limit on one side alone rests, at its edge.
    """
    return min(motion.most[0, j], motion.most[1, j])


@kernel
def pass_thresholds(problem, cell, motion, j, z):
    """Put all elements whose limits are reached at a place at their limits.

    Elements with exactly the same threshold as another of them are among them.
    """
    now, before = motion.now, motion.now.level[j]
    while has_threshold(problem, now, j):
        at = threshold(problem, cell, now, j)
        if now.sense[j] * (at - z) > 0.0:
            break
        z = at if now.sense[j] * (at - z) > 0.0 else z
        now.level[j] += 1
    if now.level[j] != before:
        if before == 0:
            _count_slip(motion, j)
        mark_level(motion, j)


@kernel
def begin_slip(problem, cell, motion, j, z):
    """Put the next element at its limit, which is reached at z to rounding, and those tied with it."""
    now = motion.now
    at = threshold(problem, cell, now, j)
    pass_thresholds(problem, cell, motion, j, max(at, z) if now.sense[j] > 0 else min(at, z))


@kernel
def slope_of(problem, tangent, j, c):
    """Derivative of the displacement in contact j by coordinate c."""
    total = 0.0
    for k in range(problem.squares.size):
        total += problem.chi[j, k] * tangent.q[k, c]
    return total


@kernel
def turn_back(problem, cell, motion, j, z):
    """Reverse a contact: its elements at their limits hold, all in one instant."""
    now, tangent, level = motion.now, motion.tangent, motion.now.level[j]
    first = problem.first[j]
    if level > 0:
        motion.turns[0] += 1
        for c in range(tangent.count[0]):
            tangent.slider[first, c] = slope_of(problem, tangent, j, c)
        for i in range(first, first + level):
            now.place[i], now.side[i], now.turn[i] = z, now.sense[j], motion.turns[0]
            for c in range(tangent.count[0]):
                tangent.slider[i, c] = tangent.slider[first, c]
        put_pulls(problem, cell, motion, j, level)
    now.level[j] = 0
    now.sense[j] = -now.sense[j]
    now.lead[j] = 1
    motion.range[0, j] = min(motion.range[0, j], z)
    motion.range[1, j] = max(motion.range[1, j], z)
    pass_thresholds(problem, cell, motion, j, z)
