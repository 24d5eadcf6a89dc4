"""Coulomb friction: a slide lasts to the zero of its velocity, a stop to a side of the range of forces."""

from ...compiler import inner_kernel, kernel
from ...compiler.vectors import LANES, filled, load, store
from ..crossings import NONE, first_zero, slope_at, value_at
from ..problem import NEXT, TERMS, WATCHED, WIDTH, force_row, normal_row, varies, velocity_row
from .kinds import has_force
from .speed import ROSE

#: A velocity within this share of its size, on its way to zero, is zero together with one that is: in
#: symmetric systems contacts arrive together.
TOGETHER = 1e-11


@inner_kernel
def _lag(problem, friction, j):
    """beta/k_t of an elastic contact whose normal load varies, else 0.

    The force s beta nu of a contact that slips then changes its spring: y' = w - s beta nu'/k_t of the slider
    is not the velocity w in the contact.
    """
    return friction.kinetic[j] / problem.spring[j] if has_force(problem, j) and varies(problem, j) else 0.0


@inner_kernel
def _watch_slide(problem, friction, motion, j, shift):
    """Put the speed of a slide into the scratch, without its first terms, which are zero."""
    sign, lag = float(motion.sense[j]), _lag(problem, friction, j)
    velocity, nu = velocity_row(problem, j) * WIDTH + shift, normal_row(problem, j) * WIDTH + shift
    for k in range(0, TERMS, LANES):
        speed = load(motion.series, velocity + k) * sign
        if lag != 0.0:
            rate = load(motion.series, nu + k + 1) * load(NEXT, k + shift)
            speed = speed - rate * lag
        store(speed, motion.scratch, k)
    for k in range(TERMS, WIDTH, LANES):
        store(filled(0.0), motion.scratch, k)


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
def reaches(problem, friction, motion, j, sign):
    """First x in the present step at which the force of a held contact is at one side of its range."""
    shift = max(0, sign * motion.fresh[j])
    force, nu = force_row(problem, j), normal_row(problem, j)
    return _limit_reached(motion, force, nu, friction.static[j], float(sign), shift)


@inner_kernel
def first_event(problem, friction, motion, j):
    """Return (x, side) of the first event of a contact in the present step; x = NONE without one.

    side: 0 for a velocity that vanishes, else the side of its range that a force reaches.
    """
    if motion.sense[j] != 0:
        if motion.segment[j] > 0:  # faster than a break point, see `speed`
            return NONE, 0
        zeros = motion.fresh[j] if motion.fresh[j] < ROSE else 0
        _watch_slide(problem, friction, motion, j, zeros)
        return first_zero(motion.scratch, WATCHED), 0
    found, side = NONE, 0
    if motion.idle[j]:
        return found, side
    for sign in (1, -1):
        x = reaches(problem, friction, motion, j, sign)
        if x < found:
            found, side = x, sign
    return found, side


@kernel
def slip_rate(problem, friction, motion, x, j):
    """Velocity at x of the present step of a contact that slides, of an elastic one that of its slider."""
    _watch_slide(problem, friction, motion, j, 0)
    return motion.sense[j] * value_at(motion.scratch, WATCHED, x)


@kernel
def watched_slope(problem, friction, motion, x, j, side):
    """Rate of change, at the event (x, side) of a contact, of the quantity that is watched there.

    side = 0: the velocity of the slide.
    """
    if side == 0:
        _watch_slide(problem, friction, motion, j, 0)
        return motion.sense[j] * slope_at(motion.scratch, WATCHED, x)
    slope = friction.static[j] * slope_at(motion.series, normal_row(problem, j), x)
    return slope - side * slope_at(motion.series, force_row(problem, j), x)


@kernel
def comes_to_rest(problem, friction, motion, x, j):
    """Whether the velocity of a slide is zero at x up to rounding error, and on its way down."""
    _watch_slide(problem, friction, motion, j, 0)
    size = 0.0
    for k in range(TERMS):
        size += abs(motion.scratch[WATCHED, k])
    if abs(value_at(motion.scratch, WATCHED, x)) > TOGETHER * size:
        return False
    return slope_at(motion.scratch, WATCHED, x) <= 0.0
