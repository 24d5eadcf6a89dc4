"""The steady state of one cell of a structure: followed event by event, then solved as a periodic orbit.

The same way as `cycle` goes for one mass.  There a stop forgets all but the contact's place; here the rest of
the structure remembers, so anchors are compared, and solved for, with the whole state.
"""

import math
from typing import NamedTuple

import numpy as np

from ..regimes import (
    CONTINUOUS,
    INTEGRATED,
    MARGINAL,
    NOT_COMPUTED,
    RESOLVED,
    SOLVED,
    TOO_MANY_EVENTS,
)
from .continuous import continuous_amplitude, orbit_phase
from .cycle import (
    AVERAGED,
    LONGEST_PERIOD,
    averaged_cell,
    certain_stops,
    periodic_cell,
    plain_cell,
    settled,
    stuck_cell,
    unresolved,
)
from .events import REVERSE, STOP_THEN_BACK, STOP_THEN_ON, STUCK, TOUCH
from .follow import MOVING, NO_RELEASE, after_slide, slide_on
from .jit import entry, kernel
from .orbits import full_period, half_periods, longest_slide
from .oscillators import FELL
from .returns import (
    HALVES,
    PHASE_COS,
    PHASE_SIN,
    SIDE,
    copy_state,
    newton_step,
    order_of_events,
    return_map,
    solve_return,
    spectral_radius,
)
from .structure import W, energy, place, release_steady, vibrates_in_step
from .structure_orbit import orbit_state, stop_free_radius

#: Anchors remembered, at least and at most: a steady period with more is not recognised.  One a column; the
#: rows of the memory:
_MEMORY = 512
_LONGEST_MEMORY = 2**16
CODE, COS, SIN, TIME, SIGN, STATE = 0, 1, 2, 3, 4, 5

#: A stop shorter than this (in tau) is a touch of no duration, seen through rounding.
SHORTEST_STOP = 1e-12

#: Anchors looked back over for a return.
_MAX_RETURN = 64

#: Events per excitation period (over the scan step, if that is less than 1) of a motion that only chatters.
_EVENTS_PER_CYCLE = 4096.0

#: A return this close (relative to the motion) is worth a Newton iteration: with several steady states
#: one that is 0.1 off says too little of where the motion is heading.  The load's phase has to be this
#: close even where, with mu = 1, the steady state is unique and any state will do to start from.
_NEAR_RETURN = 0.01
_NEAR_PHASE = 0.3

#: An orbit with a slide longer than this (in tau) is not solved for, but waited for.
_LONGEST_SLIDE = 8.0 * math.pi

#: Orders of events that are tried on the way from a neighbour's orbit.
_MOST_ORDERS = 8

#: With several steady states: how much further off than expected the one solved for may be.
_HEADING = 4.0

#: Half periods of ever larger motion after which an undamped resonance counts as unbounded.
_GROWING = 64

#: Anchors this close are one.
_SAME = 1e-8

_TURN = 2.0 * math.pi


class Friction(NamedTuple):
    """The contact of one cell."""

    beta: float
    mu_beta: float
    b_lim: float  # boundary of beta to continuous motion


@entry
def fitting_memory(st, memory):
    """The memory, or another where the structure needs another: for four periods of the load.

    Not a longer one either: how far a return is looked for must not depend on what was there before.
    """
    needed = int(min(max(_MEMORY, math.ceil(2.0 / st.h)), _LONGEST_MEMORY))
    return memory if memory.shape[1] == needed else np.empty((STATE + 2 * st.n, needed))


@kernel
def _remember(st, memory, column, code, c, s, time, sign, state):
    memory[CODE, column] = code
    memory[COS, column] = c
    memory[SIN, column] = s
    memory[TIME, column] = time
    memory[SIGN, column] = sign
    for i in range(st.n):
        memory[STATE + i, column] = state[0, i]
        memory[STATE + st.n + i, column] = state[1, i]


@kernel
def _distance(st, memory, now, then):
    """Energy norm of the difference of two remembered states."""
    total = 0.0
    for i in range(st.n):
        z = memory[STATE + i, now] - memory[STATE + i, then]
        v = memory[STATE + st.n + i, now] - memory[STATE + st.n + i, then]
        total += (st.modes[W, i] * z) ** 2 + (st.rate * v) ** 2
    return math.sqrt(total)


@kernel
def _near_return(st, memory, events, size, unique, shortest):
    """(lag, gap, halves): slides since the motion was nearly where it is now; lag = 0 if it was not."""
    now = (events - 1) % memory.shape[1]
    best, best_gap, best_halves = 0, math.inf, 0
    near = math.inf if unique else _NEAR_RETURN
    seen = 0
    for lag in range(1, min(events, memory.shape[1])):
        then = (events - 1 - lag) % memory.shape[1]
        if memory[CODE, then] != memory[CODE, now]:
            continue
        turn = abs(memory[COS, now] - memory[COS, then]) + abs(memory[SIN, now] - memory[SIN, then])
        if turn > _NEAR_PHASE:
            continue
        halves = half_periods(memory[TIME, now] - memory[TIME, then])
        if halves > 2 * LONGEST_PERIOD:
            break
        if halves < 1 or (halves % 2 == 1) != (memory[SIGN, now] != memory[SIGN, then]):
            continue
        if full_period(halves) > LONGEST_PERIOD:
            continue
        gap = turn + _distance(st, memory, now, then) / size
        if gap <= near:
            best, best_gap, best_halves = lag, gap, halves
            near = 0.25 * gap
        seen += 1
        if (shortest and best > 0) or seen == _MAX_RETURN:
            break
    return best, best_gap, best_halves


@kernel
def _solve(
    st, friction, unique, net, state, c, s, codes, first, lag, gap, halves, limits, work, scratch
):  # fmt: skip
    """The periodic orbit that the motion approaches: `_converge` from the middle of the next slide."""
    n = st.n
    beta = friction.beta
    copy_state(state, work.middle, n)
    copy_state(state, work.moved, n)
    steps, end, _, _, _ = slide_on(st, beta, net, work.moved, c, s, _LONGEST_SLIDE / st.h, scratch)
    if end != FELL:
        return False, c, s
    _, _, c_m, s_m, _ = slide_on(st, beta, net, work.middle, c, s, 0.5 * steps, scratch)
    return _converge(
        st, friction, unique, state, c_m, s_m, codes, first, lag, gap, halves, limits, work, scratch
    )


@kernel
def _converge(
    st, friction, unique, state, c_m, s_m, codes, first, lag, gap, halves, limits, work, scratch
):  # fmt: skip
    """A periodic orbit by Newton's method: (found, cos, sin).

    The unknown, work.middle, is the state in a slide at the load's phase (c_m, s_m); `state` becomes the
    orbit's at the end of that slide.
    """
    n = st.n
    beta, mu_beta = friction.beta, friction.mu_beta
    c, s = c_m, s_m
    copy_state(work.middle, work.start, n)
    if not solve_return(
        st, beta, mu_beta, c_m, s_m, codes, first, lag, halves, limits.tolerance, work, scratch
    ):
        return False, c, s
    if not unique:
        # it must attract, and be where the motion is heading
        copy_state(work.middle, work.moved, n)
        if not return_map(
            st, beta, mu_beta, work.moved, c_m, s_m, codes, first, lag, halves, True, work, scratch
        ):
            return False, c, s
        contraction = spectral_radius(work.flow, 2 * n, work.square)
        for i in range(n):
            work.moved[0, i] = work.middle[0, i] - work.start[0, i]
            work.moved[1, i] = work.middle[1, i] - work.start[1, i]
        off = energy(st, work.moved)
        if not (contraction < 1.0 and off <= _HEADING * gap * energy(st, work.middle) / (1.0 - contraction)):
            return False, c, s
    copy_state(work.middle, state, n)
    _, end, c, s, _ = slide_on(st, beta, MOVING, state, c_m, s_m, _LONGEST_SLIDE / st.h, scratch)
    if end != FELL:
        return False, c, s
    copy_state(work.middle, work.solved, n)
    work.anchored[HALVES], work.anchored[PHASE_COS], work.anchored[PHASE_SIN] = halves, c_m, s_m
    return True, c, s


@kernel
def _from_neighbour(st, orbit, i, friction, limits, work, scratch):
    """The steady state, the only one, from an orbit near by: (found, cos, sin, sign, slides).

    It is that of the last cell, if that was solved for, or the motion without stops whose velocity touches
    zero where the strip of the open cells begins.  `_converge` from there, with the events that follow.
    """
    beta, mu_beta = friction.beta, friction.mu_beta
    halves, c, s = int(work.anchored[HALVES]), work.anchored[PHASE_COS], work.anchored[PHASE_SIN]
    sign = work.anchored[SIDE]
    if halves > 0:
        copy_state(work.solved, work.middle, st.n)
    else:
        v_abs, u = orbit.v_abs[i], orbit.u[i]
        if math.isinf(v_abs) or not beta * abs(u) < v_abs:
            return False, 1.0, 0.0, 1.0, 0
        phase = orbit_phase(v_abs, orbit.v_arg[i], u, beta)
        # in the middle of the rising half
        halves, c, s, sign = 1, math.sin(phase), -math.cos(phase), 1.0
        orbit_state(st, orbit, i, beta, phase, c, s, work.middle)
    work.anchored[HALVES] = 0.0
    for _ in range(_MOST_ORDERS):
        copy_state(work.middle, work.moved, st.n)
        count = order_of_events(st, beta, mu_beta, work.moved, c, s, halves, work.codes, work, scratch)
        if count == 0:
            break
        copy_state(work.middle, work.near, st.n)
        found, c1, s1 = _converge(
            st, friction, True, work.anchor, c, s, work.codes, 0, count, 0.0, halves, limits, work, scratch
        )
        if found:
            return True, c1, s1, sign, count
        # the order changes on the way: a step with this one, then on with what follows there
        copy_state(work.near, work.middle, st.n)
        move = newton_step(st, beta, mu_beta, c, s, work.codes, 0, count, halves, work, scratch)
        if not move < math.inf:
            break
        for j in range(st.n):
            work.middle[0, j] += work.moved[0, j]
            work.middle[1, j] += work.moved[1, j]
    return False, c, s, sign, 0


@kernel
def measure(st, friction, net, state, c, s, code, count, work, scratch):
    """The orbit that returns to the anchor `state`, reached by `code`, after `count` slides or sooner.

    Returns (slides, half periods, stops, amplitude, share of time stuck); `state` is left as it was.
    """
    n = st.n
    copy_state(state, work.moved, n)
    c0, s0 = c, s
    time = stuck = amplitude = 0.0
    stops = 0
    slides = 0
    limit = longest_slide(st, st.r)
    for _ in range(count):
        steps, _, c, s, _ = slide_on(st, friction.beta, net, work.moved, c, s, limit, scratch)
        amplitude = max(amplitude, abs(place(st, work.moved)))
        time += steps * st.h
        event, c, s, net, wait, _, _ = after_slide(
            st, friction.beta, friction.mu_beta, work.moved, work.held, c, s, limit * st.h, scratch
        )
        if (event == STOP_THEN_BACK or event == STOP_THEN_ON) and wait > SHORTEST_STOP:
            stops += 1
            stuck += wait
        time += wait
        slides += 1
        if event == code and abs(c - c0) + abs(s - s0) <= _SAME:
            for i in range(n):
                work.middle[0, i] = work.moved[0, i] - state[0, i]
                work.middle[1, i] = work.moved[1, i] - state[1, i]
            if energy(st, work.middle) <= _SAME * energy(st, state):
                break
    halves = half_periods(time)
    return slides, halves, stops, amplitude, stuck / time


@kernel
def _orbit_cell(st, friction, net, state, c, s, sign, code, count, origin, cycles, work, scratch):
    """The steady state that returns to an anchor after `count` slides, or sooner."""
    slides, halves, stops, amplitude, stuck = measure(
        st, friction, net, state, c, s, code, count, work, scratch
    )
    stops = certain_stops(stops, slides, halves, friction.beta, friction.mu_beta, friction.b_lim)
    return periodic_cell(halves, stops, amplitude, stuck, origin, cycles, math.nan, c, s, sign, slides, net)


@kernel
def steady_structure(
    st, fine, orbit, i, marginal, friction, unique, moves, state, c, s, limits, stop, memory, work, scratch
):  # fmt: skip
    """Steady state reached from a free state at load phase (c, s).

    Parameters
    ----------
    st : Structure
    fine : a Structure with steps at least as short, for bounds over a whole orbit
    orbit, i, marginal : response functions, the frequency's place in them, whether r = w_k/(2 k) there
    friction : Friction; beta > 0
    unique : mu = 1; then the orbit solved for last, if any (work.anchored), is tried as a start
    moves : whether it starts with z' > 0; otherwise z' = 0
    state : (2, n) start; replaced by an anchor of the steady state
    limits, stop : as in `cycle.steady_cell`
    memory, work, scratch : arrays that are written into
    """
    n = st.n
    beta, mu_beta = friction.beta, friction.mu_beta
    end_time = _TURN * limits.cycles
    max_steps = end_time / st.h + 1.0
    max_events = _EVENTS_PER_CYCLE * limits.cycles * max(1.0, 1.0 / st.h)
    v_abs = orbit.v_abs[i]
    resonance = math.isinf(v_abs)
    in_step = vibrates_in_step(st)
    slides = 0
    solved = False
    c1, s1, sign1 = c, s, 1.0
    if unique and limits.newton and not (in_step or (marginal and beta < friction.b_lim)):
        solved, c1, s1, sign1, slides = _from_neighbour(st, orbit, i, friction, limits, work, scratch)
    around = beta < friction.b_lim and not resonance
    amplitude = phase = radius = 0.0
    if around and not solved:
        phase = orbit_phase(v_abs, orbit.v_arg[i], orbit.u[i], beta)
        amplitude = continuous_amplitude(v_abs, orbit.u[i], orbit.g[i], beta)
        radius = stop_free_radius(fine, orbit, i, beta, mu_beta, phase, work.table, work.middle, work.moved)

    time = 0.0
    sign = 1.0
    events = running = growing = 0
    peak = 0.0
    half = tries = 0
    pause = 1
    next_try = 2
    code = REVERSE
    net = MOVING
    old_lag, old_gap = 0, math.inf
    window = _TURN * min(AVERAGED, 0.5 * limits.cycles)
    window_end = window
    old_opened = opened = 0.0  # when these began
    stops, stuck, largest = 0, 0.0, 0.0
    old_stops, old_stuck, old_largest = 0, 0.0, 0.0

    while not solved and time < end_time:
        if stop[0] != 0:
            return unresolved(NOT_COMPUTED, time / _TURN)
        if moves or events > 0:
            steps, end, c, s, _ = slide_on(st, beta, net, state, c, s, max_steps, scratch)
            if end != FELL:
                break
            time += steps * st.h
        z = place(st, state)
        size = abs(z)
        code, c, s, net, wait, _, _ = after_slide(
            st, beta, mu_beta, state, work.held, c, s, end_time - time, scratch
        )
        if code == STUCK:
            return stuck_cell(INTEGRATED, MARGINAL if in_step else RESOLVED, time / _TURN, z, sign)
        if code == NO_RELEASE:
            break
        if code == REVERSE or code == STOP_THEN_BACK:
            sign = -sign
        events += 1
        if events > max_events:
            return unresolved(TOO_MANY_EVENTS, time / _TURN)
        stopped = code == STOP_THEN_BACK or code == STOP_THEN_ON
        if time >= window_end:
            window_end += window
            old_opened, opened = opened, time
            old_stops, old_stuck, old_largest = stops, stuck, largest
            stops, stuck, largest = 0, 0.0, 0.0
        largest = max(largest, size)
        if stopped:
            if wait > SHORTEST_STOP:
                stops += 1
            stuck += wait
            time += wait
            running = 0
            growing = 0
        else:
            running += 1
            growing = growing + 1 if size > peak else 0
            if resonance and growing >= _GROWING and beta < friction.b_lim:
                return plain_cell(CONTINUOUS, RESOLVED, INTEGRATED, 0.0, math.inf, 0.0, 1, time / _TURN)
        _remember(st, memory, (events - 1) % memory.shape[1], code, c, s, time, sign, state)
        if around and not stopped and (running > 1 or events == 1):
            orbit_state(st, orbit, i, beta, phase, c, s, work.moved)
            for j in range(n):
                work.moved[0, j] -= state[0, j]
                work.moved[1, j] -= state[1, j]
            gap = energy(st, work.moved)
            if gap < radius or gap <= limits.tolerance * energy(st, state):
                status = MARGINAL if marginal else RESOLVED
                return plain_cell(CONTINUOUS, status, INTEGRATED, 0.0, amplitude, 0.0, 1, time / _TURN)
        peak = size

        # look for a return once a half period: at stops, or at turns where it no longer stops
        if int(time / math.pi) == half or code == TOUCH:
            continue
        if not stopped and (around or resonance or running < 8):
            continue
        half = int(time / math.pi)
        shortest = limits.newton and tries % 2 == 0
        lag, gap, halves = _near_return(
            st, memory, events, energy(st, state), unique and limits.newton, shortest
        )
        near = lag > 0 and (stopped or running >= 2 * lag)
        if not near:
            old_lag = 0
        if limits.newton and half >= next_try and (near or unique):
            copy_state(state, work.anchor, n)
            codes = memory[CODE]
            first, count = events - lag, lag
            c1, s1, net1, sign1 = c, s, net, sign
            # just below beta_stick the motion creeps for thousands of periods to where it slides, by little,
            # from its held motion; where the steady state is unique that is tried too
            if not near or (unique and tries % 3 == 2):
                starts, c1, s1 = release_steady(st, mu_beta, work.held, work.anchor)
                codes, first, count, halves = work.codes, 0, 1 if starts else 0, 1
                codes[0] = STOP_THEN_BACK
                net1, sign1 = mu_beta - beta, 1.0
            if count > 0:
                solved, c1, s1 = _solve(
                    st, friction, unique, net1, work.anchor, c1, s1, codes, first, count, gap, halves, limits,
                    work, scratch,
                )  # fmt: skip
            if solved:
                slides = count
                break
            tries += 1
            pause += 1 + pause // 4
            next_try = half + pause
        if not near:
            continue
        returned = lag == old_lag and gap <= limits.tolerance
        if not limits.newton and returned and settled(gap, old_gap, limits.tolerance):
            slides = lag
            break
        old_lag = lag
        old_gap = gap

    if solved:
        # the anchor that follows the solved slide
        copy_state(work.anchor, state, n)
        code, c, s, net, _, _, _ = after_slide(st, beta, mu_beta, state, work.held, c1, s1, end_time, scratch)
        work.anchored[SIDE] = sign1
        sign = -sign1 if code == REVERSE or code == STOP_THEN_BACK else sign1
    if slides > 0:
        return _orbit_cell(
            st, friction, net, state, c, s, sign, code, slides, SOLVED if solved else INTEGRATED,
            time / _TURN, work, scratch,
        )  # fmt: skip
    if in_step or (marginal and beta < friction.b_lim):
        return unresolved(MARGINAL, time / _TURN)
    return averaged_cell(
        old_opened, time, end_time, old_stops + stops, max(old_largest, largest), old_stuck + stuck
    )
