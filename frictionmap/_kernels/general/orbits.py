"""Steady states by Newton's method on the return map: the state, its multipliers, its period."""

import math
from typing import NamedTuple

from ..compiler import kernel, late_kernel
from ..spectral_radius import spectral_radius
from ..structure.newton import solve_linear
from .counts import MOVED
from .follow import FOLLOWED
from .laws.kinds import state_size
from .lower_upper import factor_rows, solve_rows
from .parts import go_on, go_part
from .problem import SIZE, is_carried
from .return_map import (
    NONE_KEPT,
    fill_newton,
    fill_right,
    fix_rigid,
    go_round,
    has_factors,
    keep_places,
    keeps_factors,
    motion_size,
    return_distance,
    step_size,
    take_end,
    take_step,
)

#: Kinds of `Steady`; AVERAGED: the motion stops and starts without returning, see `course`.
REPEATS, NO_REPEAT, CHATTERS, UNDETERMINED, AVERAGED = 0, 1, 2, 3, 4

#: Outcome of Newton's method: a contact slides in one direction, ever less; see `creep`.
DRIFTS = 5

#: Newton steps at most, and the largest part of the distance before that may be left after each.  Below
#: _ROUNDED more may be left once: the velocity of a contact that hardly slides depends on the square of the
#: rest.
_MOST_STEPS = 12
_LESS = 0.5

#: Contacts per step in which Newton's method may lead away from the steady state, before the events have
#: their order in it; none of less than twice this number.
_STRAYS = 5

#: Returns at most where derivatives serve for several steps, and the largest part of the distance that each
#: may leave: else new derivatives lead on sooner.
_MOST_RETURNS = 100
_LESS_KEPT = 0.25

#: A distance that such a step does not lessen is due to rounding errors below this, some units of the last
#: place; else to the derivatives.
_FLOOR = 1e-14

#: Steps of inverse iteration, and the growth in one of them from which on a multiplier may be so near to 1
#: that it must be known.
_INVERSE_STEPS, _GROWTH = 4, 1e6

#: Largest step over the size of the motion, and largest motion over its size without friction: beyond, the
#: equations are singular (an undamped resonance).
LARGEST = 1e10

#: Largest error of a measured state, which is its distance from the one that it returns to, over the share
#: of a disturbance that a return takes away.
MEASURED = 1e-12

#: A step below this is the last one: the next would be of the size of its square, far below the distance of
#: two states that are rounded alike, see `return_map.round_state`.  `measure` looks after it.
_LAST = 1e-9

#: A step below this is due to the rounding of a state, or leads nearer than that.
NEARBY = 1e-4

#: A distance that does not shrink is that of rounding errors, once, below this.
_ROUNDED = 1e-7

#: A steady state that is back to this share of its size after a part of its period has that period.
RETURNED = 1e-9


class Steady(NamedTuple):
    """The steady state of a cell."""

    status: int
    halves: int  # half periods after which it returns, or that averages are of
    cycles: float  # periods followed


@kernel
def radius_of_two(a, b, c, d):
    """Largest modulus of the eigenvalues of the matrix (a, b; c, d)."""
    mean, half = 0.5 * (a + d), 0.5 * (a - d)
    square = half * half + b * c
    if square >= 0.0:
        return abs(mean) + math.sqrt(square)
    return math.sqrt(mean * mean - square)


@kernel
def largest_multiplier(problem, row, halves, precision, motion, memory):
    """Largest modulus of the multipliers, without those of contacts that rest; see `spectral_radius`."""
    size = state_size(problem)
    fill_newton(problem, row, halves, motion, memory)
    if halves % 2 == 1:  # a place where a contact rests becomes its mirror image
        keep_places(problem, row, motion, memory, memory.matrix, -1.0)
        fix_rigid(problem, memory)
    for a in range(size):
        for b in range(size):
            memory.matrix[a, b] = (1.0 if a == b else 0.0) - memory.matrix[a, b]
    if size == 2:
        return radius_of_two(
            memory.matrix[0, 0], memory.matrix[0, 1], memory.matrix[1, 0], memory.matrix[1, 1]
        )
    return spectral_radius(memory.matrix, size, motion.tangent, precision)


@late_kernel(float)
def improve_by_part(problem, row, friction, motion, memory, record):
    """Take one Newton step on the map over a part of half a period, see `parts`; its size, the error of the
    state before it, over the size of the motion.
    """
    if go_part(problem, row, friction, motion, memory, record, True) != FOLLOWED:
        return math.inf
    fill_newton(problem, row, 1, motion, memory)
    if not solve_linear(memory.matrix, memory.right, state_size(problem)):
        return math.inf
    return take_step(problem, row, memory)


@kernel
def any_rests(counts):
    """Whether any contact did not move on the last way."""
    rests = False
    for j in range(counts.shape[1]):
        rests = rests or counts[MOVED, j] == 0.0
    return rests


@kernel
def drifts(problem, counts, halves, j):
    """Whether a contact slid, on the last way, in one direction where it must come back: at a wall at rest,
    and with springs that bring it back.

    On half periods it comes back in the other half, which mirrors this one.
    """
    slid_one_way = counts[MOVED, j] == 1.0 or counts[MOVED, j] == 2.0
    return slid_one_way and problem.belt[j] == 0.0 and halves % 2 == 0 and not is_carried(problem, j)


@kernel
def any_drifts(problem, counts, halves):
    """Whether any contact drifts, see `drifts`."""
    any_ = False
    for j in range(counts.shape[1]):
        any_ = any_ or drifts(problem, counts, halves, j)
    return any_


@kernel
def _factor_kept(problem, row, halves, motion, memory):
    """Keep the derivatives in `motion.tangent`, factored; False if the equations of a step are singular."""
    size = state_size(problem)
    fill_newton(problem, row, halves, motion, memory)
    for a in range(size):
        for b in range(size):
            memory.factors[a, b] = memory.matrix[a, b]
    regular = factor_rows(memory.factors, memory.rows, size)
    memory.kept[0] = halves if regular else NONE_KEPT
    return regular


@kernel
def _is_finite(values):
    """Whether all values are finite."""
    finite = True
    for a in range(values.size):
        finite = finite and math.isfinite(values[a])
    return finite


@kernel
def _solve_kept(problem, row, halves, derived, motion, memory):
    """Solve for a Newton step with the derivatives of this return, or with those that are kept; False if they
    are singular.
    """
    if derived:
        if not _factor_kept(problem, row, halves, motion, memory):
            return False
    else:
        fill_right(problem, memory)
        fix_rigid(problem, memory)
    solve_rows(memory.factors, memory.rows, state_size(problem), memory.right)
    return _is_finite(memory.right)


@kernel
def square_kept(problem, row, motion, memory):
    """Keep the derivatives over a whole period, the square of those over half of it: the motion of the other
    half mirrors this one.

    Parameters
    ----------
    problem, row, motion, memory : see `newton`; the pattern in `motion` is replaced
    """
    size, width = state_size(problem), motion.tangent.shape[1]
    product = motion.onward[1]
    for a in range(size):
        for i in range(width):
            product[a, i] = 0.0
        for b in range(size):
            for i in range(width):
                product[a, i] += motion.tangent[a, b] * motion.tangent[b, i]
    for a in range(size):
        for i in range(width):
            motion.tangent[a, i] = product[a, i]
    _factor_kept(problem, row, 2, motion, memory)


@kernel
def kept_error(problem, row, halves, memory):
    """Error of the state in `memory.start` over the size of the motion, after a return without derivatives:
    the step to which the derivatives that are kept lead; NaN without such, or where a multiplier is near 1.

    Parameters
    ----------
    problem, row, halves, memory : see `go_round`
    """
    size = state_size(problem)
    if not has_factors(memory, halves):
        return math.nan
    for a in range(size):
        memory.right[a] = 1.0
    for _ in range(_INVERSE_STEPS):
        solve_rows(memory.factors, memory.rows, size, memory.right)
        growth = 0.0
        for a in range(size):
            growth = max(growth, abs(memory.right[a]))
        if not (growth < _GROWTH and _is_finite(memory.right)):
            return math.nan
        for a in range(size):
            memory.right[a] /= growth
    fill_right(problem, memory)
    fix_rigid(problem, memory)
    solve_rows(memory.factors, memory.rows, size, memory.right)
    return step_size(problem, row, memory) if _is_finite(memory.right) else math.nan


@late_kernel((int, float))
def newton_kept(problem, row, friction, halves, tolerance, motion, memory, record, renews):
    """`newton` with derivatives that serve for as many steps as they lead on fast.

    Parameters
    ----------
    problem, row, friction, halves, tolerance, motion, memory, record : see `newton`
    renews : whether new derivatives follow those that are kept; else it has failed then
    """
    last = last_derived = math.inf
    cycles = 0.0
    drifting = missed = False
    steps, strays = 0, problem.spring.size // _STRAYS
    if memory.kept[0] != halves:
        memory.kept[0] = NONE_KEPT
    for _ in range(_MOST_RETURNS):
        derives = memory.kept[0] == NONE_KEPT
        steps += derives
        if steps > _MOST_STEPS:
            break
        code, followed = go_on(problem, row, friction, halves, motion, memory, record, derives)
        cycles += 0.5 * followed
        if code != FOLLOWED:
            return NO_REPEAT, cycles
        drifting = any_drifts(problem, memory.counts, halves)
        distance = return_distance(problem, row, memory)
        slow = not distance < (_LESS * last_derived if derives else _LESS_KEPT * last)
        floor = tolerance if derives else min(tolerance, _FLOOR)
        if distance == 0.0 or (slow and distance <= floor):
            return DRIFTS if drifting else REPEATS, cycles
        if slow and not derives:
            memory.kept[0] = NONE_KEPT
            if renews:
                continue
            return NO_REPEAT, cycles
        if slow and strays > 0 and not distance < _ROUNDED:
            strays -= 1
            if not math.isfinite(distance):  # the derivatives are those of another pattern
                take_end(memory)
                continue
        elif slow:
            if missed or not distance < _ROUNDED:
                return NO_REPEAT, cycles
            missed = True
        last = distance
        if derives:
            last_derived = distance
        if not _solve_kept(problem, row, halves, derives, motion, memory):
            return NO_REPEAT, cycles
        step = take_step(problem, row, memory)
        if not (step <= LARGEST and motion_size(problem, row, memory) <= LARGEST * row.numbers[SIZE]):
            return NO_REPEAT, cycles
        if step <= (max(tolerance, _LAST) if derives else min(tolerance, _LAST)):
            return DRIFTS if drifting else REPEATS, cycles
    return DRIFTS if drifting else NO_REPEAT, cycles


@kernel
def newton(problem, row, friction, halves, tolerance, motion, memory, record):
    """Find the state that returns after some half periods, from the one in `memory.start`.

    Parameters
    ----------
    problem, row, friction : Problem, Row, Friction
    halves : number of half periods
    tolerance : largest change of the state over a return, over its size
    motion, memory, record : Motion, Return, Record

    Returns
    -------
    (status, cycles) : REPEATS, DRIFTS or NO_REPEAT; periods followed
    """
    if keeps_factors(memory):
        return newton_kept(problem, row, friction, halves, tolerance, motion, memory, record, True)
    last = math.inf
    cycles = 0.0
    size = state_size(problem)
    drifting = missed = False
    contacts = problem.spring.size
    strays = contacts // _STRAYS if contacts >= 2 * _STRAYS else 0
    for _ in range(_MOST_STEPS):
        code, followed = go_on(problem, row, friction, halves, motion, memory, record, True)
        cycles += 0.5 * followed
        if code != FOLLOWED:
            return NO_REPEAT, cycles
        drifting = any_drifts(problem, memory.counts, halves)
        distance = return_distance(problem, row, memory)
        if distance == 0.0 or not distance < _LESS * last:
            if distance <= tolerance:
                return DRIFTS if drifting else REPEATS, cycles
            if strays > 0 and not distance < _ROUNDED:
                strays -= 1
                if not math.isfinite(distance):  # the derivatives are those of another pattern
                    take_end(memory)
                    continue
            elif missed or not distance < _ROUNDED:
                return NO_REPEAT, cycles
            else:
                missed = True
        last = distance
        fill_newton(problem, row, halves, motion, memory)
        if not solve_linear(memory.matrix, memory.right, size):
            return NO_REPEAT, cycles
        step = take_step(problem, row, memory)
        if not (step <= LARGEST and motion_size(problem, row, memory) <= LARGEST * row.numbers[SIZE]):
            return NO_REPEAT, cycles
        if step <= max(tolerance, _LAST):
            return DRIFTS if drifting else REPEATS, cycles
    return DRIFTS if drifting else NO_REPEAT, cycles


@kernel
def least_period(problem, row, friction, halves, base, motion, memory, record):
    """Smallest number of half periods after which a steady state returns, and the periods followed for it.

    Parameters
    ----------
    problem, row, friction : Problem, Row, Friction
    halves : half periods after which it returns
    base : smallest number that is possible
    motion, memory, record : Motion, Return, Record
    """
    cycles = 0.0
    for shorter in range(base, halves, base):
        if halves % shorter == 0:
            go_round(problem, row, friction, shorter, motion, memory, record, False)
            cycles += 0.5 * shorter
            if return_distance(problem, row, memory) <= RETURNED:
                return shorter, cycles
    return halves, cycles
