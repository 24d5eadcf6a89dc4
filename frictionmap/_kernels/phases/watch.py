"""Quantities whose zero ends a phase, and the first of these zeros."""

from ..compiler import inner_kernel, kernel
from ..general.crossings import NONE, first_zero
from ..general.problem import TERMS
from .problem import NORMAL, RIGID, SMOOTH, UP, D, F, W, observed_row, watch_row


@kernel
def put_watched(problem, cell, motion, j, which):
    """Fill the series of a quantity watched in a contact: positive until its event."""
    contacts, series, at = problem.law.size, motion.series, watch_row(problem)
    normal, friction = D * contacts + j, F * contacts + j
    sense = motion.sense[j]
    if which == NORMAL:
        sign = -1.0 if motion.open[j] != 0 else 1.0
        for k in range(TERMS + 1):
            series[at, k] = sign * problem.pressed[j] * series[normal, k]
        series[at, 0] += sign * cell.preload[j]
    elif sense != 0:
        scale = sense if problem.law[j] == RIGID else sense * problem.spring[j]
        rate = 0.0 if problem.law[j] == RIGID else problem.lift[j]
        for k in range(TERMS + 1):
            series[at, k] = scale * series[W * contacts + j, k] - rate * ((k + 1.0) * series[normal, k + 1])
    else:
        sign = 1.0 if which == UP else -1.0
        rate = cell.static[j] * problem.lift[j]
        for k in range(TERMS):
            series[at, k] = rate * series[normal, k] - sign * series[friction, k]
        series[at, 0] += cell.static[j] * cell.limit[j]
        series[at, TERMS] = 0.0


@kernel
def put_knot(problem, motion, s, which):
    """Fill the distance from the knot above (0) or below (1) a piece of a spring."""
    series, at = motion.series, watch_row(problem)
    sign = -1.0 if which == 0 else 1.0
    knot = motion.piece[s] if which == 0 else motion.piece[s] - 1
    for k in range(TERMS + 1):
        series[at, k] = sign * series[observed_row(problem) + s, k]
    series[at, 0] -= sign * problem.knots[s, knot]


@inner_kernel
def _zero_after(motion, at, lead):
    """First zero of the series watched, apart from those that are known at its beginning."""
    series = motion.series
    if lead > 0:
        for k in range(TERMS + 1 - lead):
            series[at, k] = series[at, k + lead]
        for k in range(TERMS + 1 - lead, TERMS + 1):
            series[at, k] = 0.0
    return first_zero(series, at)


@kernel
def is_watched(problem, motion, j, which):
    """Whether a quantity of a contact is watched in the present phase."""
    if which == NORMAL:
        return problem.presses[j]
    if motion.open[j] != 0 or problem.law[j] == SMOOTH or motion.idle[j]:
        return False
    return which == UP or motion.sense[j] == 0


@kernel
def first_event(problem, cell, motion, rest):
    """The first event in a step, up to x = rest: its x (NONE without one), the contact, what was watched.

    Of a spring the contact is N + its number, and 0 or 1 stand for the knot above or below.
    """
    contacts, at = problem.law.size, watch_row(problem)
    best, who, what = NONE, -1, 0
    for j in range(contacts):
        for which in range(3):
            if is_watched(problem, motion, j, which):
                put_watched(problem, cell, motion, j, which)
                x = _zero_after(motion, at, motion.lead[j, which])
                if x < best:
                    best, who, what = x, j, which
    for s in range(problem.along.shape[0]):
        for which in range(2):
            last = motion.piece[s] == (problem.knot_count[s] if which == 0 else 0)
            if not last:
                put_knot(problem, motion, s, which)
                x = _zero_after(motion, at, motion.lead_spring[s, which])
                if x < best:
                    best, who, what = x, contacts + s, which
    if best > rest:
        return NONE, -1, 0
    return best, who, what


@kernel
def has_leads(motion):
    """Whether some zeros at the beginning of the step are known."""
    sum_ = 0
    for j in range(motion.sense.size):
        sum_ += motion.lead[j, 0] + motion.lead[j, 1] + motion.lead[j, 2]
    for s in range(motion.piece.size):
        sum_ += motion.lead_spring[s, 0] + motion.lead_spring[s, 1]
    return sum_ > 0


@kernel
def clear_leads(motion):
    """Forget which zeros were known at the beginning of a step."""
    for j in range(motion.sense.size):
        for which in range(3):
            motion.lead[j, which] = 0
    for s in range(motion.piece.size):
        motion.lead_spring[s, 0] = motion.lead_spring[s, 1] = 0
