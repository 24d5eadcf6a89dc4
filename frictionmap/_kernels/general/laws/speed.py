"""Friction over the sliding speed: segments in which it depends linearly on the velocity.

    f = beta s (g_0 + a V),   V = r |w| = s r w,   so that   f = s beta g_0 + beta a r w

g_0 is the value at speed 0 of the line that a segment is part of, a its slope, s the sense.  A slide goes
from segment to segment without a jump: only the slope of the force changes.  A contact that is held, or
begins to slide, is in segment 0.
"""

import math

from ...compiler import inner_kernel, kernel, late_kernel
from ...compiler.vectors import LANES, load, store, total
from ..counts import COUNT_ROWS, CROSSINGS
from ..crossings import first_zero
from ..problem import TERMS, WATCHED, WIDTH, H, R, force_row, slide_velocity, velocity_row

#: Sides of events at break points: the speed falls below the lower one, or exceeds the upper one.
SLOWER, FASTER = 2, 3

#: Values of `Motion.fresh` after a break point, beyond numbers of zeros: the speed has exceeded it, or fallen
#: below it.
ROSE, FELL = 64, 65


@inner_kernel
def has_law(problem):
    """Whether the friction of any contact depends on its speed."""
    return problem.law.speed.shape[1] > 0


@inner_kernel
def count_rows(problem):
    """Rows of the counters of a motion."""
    return COUNT_ROWS + problem.law.speed.shape[1]


@kernel
def is_certified(problem, friction):
    """Whether friction that falls with the speed leaves one steady state only; see `general.certificate`."""
    certified = True
    for j in range(problem.law.certified.size):
        certified = certified and friction.kinetic[j] <= problem.law.certified[j]
    return certified


@kernel
def steepest(problem, j):
    """Largest modulus of the slopes of the friction of a contact over its speed."""
    most = 0.0
    for k in range(problem.law.speed.shape[1]):
        most = max(most, abs(problem.law.slope[j, k]))
    return most


@kernel
def rate_under(problem, i, friction):
    """Bound on the rate of the fastest part of the motion at r[i], with the damping by friction of one cell;
    see `general.problem.fastest`.
    """
    if not has_law(problem):
        return problem.rates[i]
    c, k, order = problem.law.norms[0], problem.law.norms[1], 0.0
    for j in range(friction.kinetic.size):
        c += friction.kinetic[j] * problem.law.steepest[j]
    for n in range(problem.orders.size):
        order = max(order, problem.orders[n])
    return max(0.5 * (c + math.sqrt(c * c + 4.0 * k)) / problem.r[i], order)


@inner_kernel
def key_bits(problem):
    """Bits of a contact in a pattern: whether it is held; with segments of friction, which one it is in."""
    return 16 if has_law(problem) else 1


@inner_kernel
def is_at_speed(side):
    """Whether an event is one at a break point."""
    return side == SLOWER or side == FASTER


@inner_kernel
def velocity_unit(row):
    """A speed over omega_1 P/k_1 of 1, in units of the interval."""
    return row.numbers[H] / row.numbers[R]


@kernel
def speed_of(problem, row, motion, j):
    """Speed of a contact over omega_1 P/k_1, from the state; the series of the channels must be there."""
    return abs(slide_velocity(problem, row, motion, j)) / velocity_unit(row)


@kernel
def set_segments(problem, row, motion):
    """Find the segments in which contacts slide, from the velocities of the state."""
    if not has_law(problem):
        return
    for j in range(motion.sense.size):
        motion.segment[j] = 0
        if motion.fresh[j] >= ROSE:
            motion.fresh[j] = 0
        if motion.sense[j] == 0:
            continue
        speed = speed_of(problem, row, motion, j)
        for k in range(1, problem.law.count[j]):
            if speed > problem.law.speed[j, k]:
                motion.segment[j] = k


@kernel
def factor_at(problem, row, motion, j):
    """Friction of a sliding contact over that just above speed 0, from the state; 1 without a law."""
    if not has_law(problem):
        return 1.0
    k = motion.segment[j]
    factor = problem.law.constant[j, k]
    if problem.law.slope[j, k] != 0.0:
        factor += problem.law.slope[j, k] * speed_of(problem, row, motion, j)
    return factor


@inner_kernel
def constant_factor(problem, motion, j):
    """The part of the friction that does not depend on the velocity, over that just above speed 0."""
    return problem.law.constant[j, motion.segment[j]] if has_law(problem) else 1.0


@late_kernel(bool)
def set_law_damping(problem, row, friction, motion):
    """Fill the derivatives of friction forces by velocities; whether one is not zero."""
    found = False
    if has_law(problem):
        for j in range(motion.sense.size):
            slope = problem.law.slope[j, motion.segment[j]] if motion.sense[j] != 0 else 0.0
            motion.law_damping[j] = friction.kinetic[j] * slope / velocity_unit(row) if slope != 0.0 else 0.0
            found = found or slope != 0.0
    return found


@inner_kernel
def law_forces(problem, row, k, motion):
    """Add to term k of the forces of sliding contacts what depends on their velocities."""
    modes, channels = problem.push.shape
    width = row.chi.shape[1]
    for j in range(problem.spring.size):
        if motion.law_damping[j] == 0.0:
            continue
        w = 0.0
        for m in range(0, width, LANES):
            w += total(load(row.chi, j * width + m) * load(motion.moves, (k + 1) * width + m))
        for d in range(channels):
            w -= problem.base[j, d] * motion.series[modes + d, k + 1]
        w *= k + 1.0
        if k == 0:
            w -= row.numbers[H] * problem.belt[j]
        motion.series[force_row(problem, j), k] += motion.law_damping[j] * w


@inner_kernel
def _bound_reached(motion, source, sign, bound, shift):
    """First zero of sign times a velocity plus a bound, without as many leading zeros."""
    for k in range(0, TERMS, LANES):
        store(load(motion.series, source * WIDTH + k + shift) * sign, motion.scratch, k)
    if shift == 0:
        motion.scratch[WATCHED, 0] += bound
    return first_zero(motion.scratch, WATCHED)


@inner_kernel
def first_bound(problem, row, motion, j, found, side):
    """Return (x, side) of the first break point that a slide passes before x = `found`; else as given."""
    segment, sign = motion.segment[j], float(motion.sense[j])
    w, unit = velocity_row(problem, j), velocity_unit(row)
    if segment > 0:
        shift = 1 if motion.fresh[j] == ROSE else 0
        x = _bound_reached(motion, w, sign, -problem.law.speed[j, segment] * unit, shift)
        if x < found:
            found, side = x, SLOWER
    if segment + 1 < problem.law.count[j]:
        shift = 1 if motion.fresh[j] == FELL else 0
        x = _bound_reached(motion, w, -sign, problem.law.speed[j, segment + 1] * unit, shift)
        if x < found:
            found, side = x, FASTER
    return found, side


@kernel
def pass_break_point(motion, counts, j, side):
    """Go to the next segment."""
    motion.segment[j] += 1 if side == FASTER else -1
    motion.fresh[j] = ROSE if side == FASTER else FELL
    counts[CROSSINGS, j] += 1.0
