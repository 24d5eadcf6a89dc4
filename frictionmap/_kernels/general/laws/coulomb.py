"""Coulomb friction: a slide lasts to the zero of its velocity, a stop to a side of the range of forces."""

from ...compiler import inner_kernel, kernel
from ...compiler.vectors import LANES, load, store
from ..crossings import NONE, first_zero, slope_at, value_at
from ..problem import TERMS, WATCHED, WIDTH, force_row, normal_row, velocity_row

#: A velocity within this share of its size, on its way to zero, is zero together with one that is: in
#: symmetric systems contacts arrive together.
TOGETHER = 1e-11


@inner_kernel
def _slide_end(motion, source, sign, shift):
    """First zero of sign times a series without its first terms, which are zero."""
    for k in range(0, TERMS, LANES):
        store(load(motion.series, source * WIDTH + k + shift) * sign, motion.scratch, k)
    return first_zero(motion.scratch, WATCHED)


@inner_kernel
def _limit_reached(motion, force, nu, size, sign, shift):
    """First zero of the distance of a force from one side of its range.

    Parameters
    ----------
    motion : Motion with the series of the step
    force, nu : rows of the force and of the normal load
    size : static friction under constant normal load
    sign : 1.0 or -1.0, the side
    shift : number of leading terms that are zero by definition
    """
    series, scratch = motion.series, motion.scratch
    for k in range(0, TERMS, LANES):
        at = k + shift
        limit = load(series, nu * WIDTH + at) * size
        store(limit - load(series, force * WIDTH + at) * sign, scratch, k)
    if shift > 0 and scratch[WATCHED, 0] < 0.0:
        return 0.0  # at its limit, and about to exceed it
    return first_zero(scratch, WATCHED)


@inner_kernel
def first_event(problem, friction, motion, j):
    """Return (x, side) of the first event of a contact in the present step; x = NONE without one.

    side: 0 for a velocity that vanishes, else the side of its range that a force reaches.
    """
    if motion.sense[j] != 0:
        end = _slide_end(motion, velocity_row(problem, j), float(motion.sense[j]), motion.fresh[j])
        return end, 0
    found, side = NONE, 0
    if motion.idle[j]:
        return found, side
    force, nu = force_row(problem, j), normal_row(problem, j)
    for sign in (1, -1):
        shift = max(0, sign * motion.fresh[j])
        x = _limit_reached(motion, force, nu, friction.static[j], float(sign), shift)
        if x < found:
            found, side = x, sign
    return found, side


@kernel
def watched_slope(problem, friction, motion, x, j, side):
    """Rate of change, at the event (x, side) of a contact, of the quantity that is watched there."""
    if side == 0:
        return slope_at(motion.series, velocity_row(problem, j), x)
    slope = friction.static[j] * slope_at(motion.series, normal_row(problem, j), x)
    return slope - side * slope_at(motion.series, force_row(problem, j), x)


@kernel
def comes_to_rest(problem, motion, x, j):
    """Whether the velocity of a slide is zero at x up to rounding error, and on its way down."""
    w, size = velocity_row(problem, j), 0.0
    for k in range(TERMS):
        size += abs(motion.series[w, k])
    if abs(value_at(motion.series, w, x)) > TOGETHER * size:
        return False
    return motion.sense[j] * slope_at(motion.series, w, x) <= 0.0
