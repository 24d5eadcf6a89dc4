"""The steady state of one cell: followed event by event, then solved as a periodic orbit.

Stops make the return map one-dimensional: a stop forgets all but its displacement.  Once the order of
events repeats, Newton's method finishes in a few returns (`orbits`).

A motion that no longer stops approaches the continuous orbit of theory 2.  Two motions that both never
stick approach each other in the energy norm whatever mu is, so the approach is certain as soon as the
distance is less than that at which a stop is possible at all (`continuous.stop_free_radius`).
"""

import math
from typing import NamedTuple

from ..regimes import (
    CLOSED_FORM,
    CONTINUOUS,
    INTEGRATED,
    MARGINAL,
    NOT_COMPUTED,
    NOT_PERIODIC,
    NOT_REACHED,
    PERMANENT_STICKING,
    QUASI_STATIC,
    RESOLVED,
    SOLVED,
    STICK_SLIP,
    TOO_MANY_EVENTS,
    UNRESOLVED,
)
from .continuous import (
    continuous_amplitude,
    distance_to_orbit,
    orbit_phase,
    stop_free_radius,
)
from .events import (
    NO_END,
    REVERSE,
    STOP_THEN_BACK,
    STOP_THEN_ON,
    STUCK,
    TOUCH,
    after_slide,
    slide,
)
from .jit import kernel
from .orbits import first_push, full_period, half_periods, measure_orbit, solve_orbit, stop_ends

#: Events remembered, at least and at most: a steady period with more is not recognised.  At small r there
#: are up to 1/(2r) in a period.  The rows of the memory:
_HISTORY = 2048
_LONGEST_HISTORY = 2**18
CODES, PLACES, COSINES, SINES, TIMES = 0, 1, 2, 3, 4
HISTORY_ROWS = 5

#: The orbit solved for last, from which the next cell's may be found: slides until it returns (0: there is
#: none), displacement and sign at the end of a stop, and from there on the events, at most MOST_EVENTS.
COUNT, PLACE, SIDE, FIRST = 0, 1, 2, 3
MOST_EVENTS = 32
NEIGHBOUR = FIRST + MOST_EVENTS

#: Anchors looked back over for a return: symmetric motions need one or a few, sub-harmonic ones more.
_MAX_RETURN = 32

#: Events per excitation period (over 1/r, if that is more) beyond which the motion only chatters.
_EVENTS_PER_CYCLE = 4096.0

#: A return this close (relative to the displacement) is worth a Newton iteration; with mu = 1, where the
#: steady state is unique, every one is (two displacements are never further apart than 2).
_NEAR_RETURN = 0.1
_NEAR_RETURN_UNIQUE = 2.0

#: With several steady states the one solved for must be where the motion is heading: no further off than
#: this many times what the last return and the contraction there make one expect.
_HEADING = 4.0

#: Distance to an end of the places of rest, over r^2, below which a slide takes less than a tenth of it.
_CREEPING = 0.02

#: Half periods of ever larger motion after which an undamped resonance counts as unbounded.
_GROWING = 64

#: Excitation periods after which a steady motion repeats; one that takes more counts as not periodic.
LONGEST_PERIOD = 8

#: Excitation periods over which such a motion is averaged.
AVERAGED = 100.0

_TURN = 2.0 * math.pi


class Limits(NamedTuple):
    """When to stop; constant over a sweep."""

    cycles: float
    tolerance: float
    newton: bool  # solve for the periodic orbit instead of waiting for it


class Cell(NamedTuple):
    """Result of one cell, in units of the normalised oscillator."""

    regime: int
    status: int
    origin: int
    stops: float  # per excitation period
    amplitude: float
    stuck: float  # share of the steady period
    period: int  # excitation periods
    cycles: float  # excitation periods followed
    z: float  # state from which the steady state starts over with an upward slide, or sticks
    cos: float
    sin: float
    sign: float  # -1.0 where that state is the mirror image of the true one
    events: int  # slides until it returns; 0 where stuck and for the closed form
    net: float  # force in the contact at its start, friction taken off


@kernel
def history_length(r):
    """Events to remember at the frequency r: those of four periods of the load."""
    return int(min(max(_HISTORY, math.ceil(2.0 / r)), _LONGEST_HISTORY))


@kernel
def plain_cell(regime, status, origin, stops, amplitude, stuck, period, cycles):
    nan = math.nan
    return Cell(regime, status, origin, stops, amplitude, stuck, period, cycles, nan, nan, nan, 1.0, 0, nan)


@kernel
def unresolved(status, cycles):
    nan = math.nan
    return plain_cell(UNRESOLVED, status, INTEGRATED, nan, nan, nan, 0, cycles)


@kernel
def stuck_cell(origin, status, cycles, z, sign):
    """Permanent sticking at z."""
    nan = math.nan
    return Cell(PERMANENT_STICKING, status, origin, nan, 0.0, 1.0, 1, cycles, z, nan, nan, sign, 0, nan)


@kernel
def continuous_cell(oscillator, b, origin, cycles):
    """Continuous motion by the closed form."""
    amplitude = continuous_amplitude(oscillator.v_abs, oscillator.u, oscillator.g, b)
    status = MARGINAL if oscillator.marginal and b > 0.0 else RESOLVED
    return plain_cell(CONTINUOUS, status, origin, 0.0, amplitude, 0.0, 1, cycles)


@kernel
def quasi_static_cell():
    """r = 0 between the boundaries: stick-slip whose number of stops has no limit."""
    nan = math.nan
    return plain_cell(STICK_SLIP, QUASI_STATIC, CLOSED_FORM, nan, nan, nan, 0, 0.0)


@kernel
def periodic_cell(halves, stops, amplitude, stuck, origin, cycles, z, c, s, sign, slides, net):
    """A steady state that returns, as its mirror image if need be, after `halves` half periods."""
    if halves < 1:
        return unresolved(NOT_REACHED, cycles)
    regime = STICK_SLIP if stops > 0 else CONTINUOUS
    return Cell(
        regime, RESOLVED, origin, 2.0 * stops / halves, amplitude, stuck, full_period(halves), cycles,
        z, c, s, sign, slides, net,
    )  # fmt: skip


@kernel
def averaged_cell(since, time, end, stops, amplitude, stuck):
    """Stick-slip that does not repeat, by what it did from `since` on.

    A motion that was left before its end, or did not stop at all in that time, is not decided.
    """
    if stops == 0 or time < end:
        return unresolved(NOT_REACHED, time / _TURN)
    measured = time - since
    return plain_cell(
        STICK_SLIP, NOT_PERIODIC, INTEGRATED, stops * _TURN / measured, amplitude, stuck / measured, 0,
        time / _TURN,
    )  # fmt: skip


@kernel
def certain_stops(stops, slides, halves, b, mu_b, b_lim):
    """Stops of an orbit in `halves` half periods: one in each where none was seen but one there must be.

    From b_lim on, and with mu = 1, no motion with two turns a period is without stops.  Next to b_lim they
    last shorter than rounding can tell.
    """
    return halves if stops == 0 and slides <= halves and mu_b == b and b >= b_lim else stops


@kernel
def settled(gap, old_gap, tolerance):
    """Whether returns that were `old_gap` and are `gap` off leave less than the tolerance to go."""
    rate = min(gap / old_gap, 0.999999) if old_gap > 0.0 else 0.0
    return gap * rate <= 10.0 * tolerance * (1.0 - rate)


@kernel
def _orbit_cell(step, r, b, mu_b, b_lim, z, c, s, sign, code, count, origin, cycles, work):
    """The steady state that returns to an anchor after `count` slides, or sooner."""
    slides, halves, stops, amplitude, stuck = measure_orbit(step, r, b, mu_b, z, c, s, code, count, work)
    stops = certain_stops(stops, slides, halves, b, mu_b, b_lim)
    return periodic_cell(
        halves, stops, amplitude, stuck, origin, cycles, z, c, s, sign, slides, first_push(b, mu_b, z, c)
    )


@kernel
def _gap(history, now, then):
    """How far apart two remembered anchors are, in units of the displacement."""
    size = max(abs(history[PLACES, now]), abs(history[PLACES, then]))
    gap = abs(history[PLACES, now] - history[PLACES, then])
    if history[CODES, now] == REVERSE:  # the phase is not a function of the displacement there
        turn = abs(history[COSINES, now] - history[COSINES, then])
        gap += size * (turn + abs(history[SINES, now] - history[SINES, then]))
    return gap / size if size > 0.0 else math.inf


@kernel
def _near_return(history, events, closeness, shortest):
    """(lag, gap): slides since the motion was nearly where it is now, and how nearly; 0 if it was not.

    The shortest return, or the one beyond which a longer one is not closer by far: a sub-harmonic
    motion may be nearly symmetric.
    """
    now = (events - 1) % history.shape[1]
    best = 0
    best_gap = math.inf
    near = closeness
    seen = 0
    for lag in range(1, min(events, history.shape[1])):
        then = (events - 1 - lag) % history.shape[1]
        halves = half_periods(history[TIMES, now] - history[TIMES, then])
        if halves > 2 * LONGEST_PERIOD:
            break
        if history[CODES, then] == history[CODES, now] and full_period(halves) <= LONGEST_PERIOD:
            gap = _gap(history, now, then)
            if gap <= near:
                best = lag
                best_gap = gap
                near = 0.25 * gap
            seen += 1
            if (shortest and best > 0) or seen == _MAX_RETURN:
                break
    return best, best_gap


@kernel
def _creeps(r, mu_b, history, events):
    """Whether stops creep to an end of |z| <= mu b - 1, where the contact sticks for good (mu = 1).

    At a small distance y from it a slide takes some 4.5 y^2/r^2 off y: the end is never passed, and never
    reached in a finite time.
    """
    if events < 2:
        return False
    now = (events - 1) % history.shape[1]
    then = (events - 2) % history.shape[1]
    if history[CODES, now] != STOP_THEN_ON or history[CODES, then] != STOP_THEN_ON:
        return False
    far = abs(history[PLACES, now]) - (mu_b - 1.0)
    taken = abs(history[PLACES, then]) - abs(history[PLACES, now])
    return far < _CREEPING * r * r and 0.0 <= taken < 0.5 * far


@kernel
def _middle(history, events):
    """Displacement between the last stop and the one before; nan if there is none before."""
    now = events - 1
    for lag in range(1, min(events, history.shape[1])):
        then = (now - lag) % history.shape[1]
        if history[CODES, then] == STOP_THEN_BACK or history[CODES, then] == STOP_THEN_ON:
            return 0.5 * (history[PLACES, now % history.shape[1]] + history[PLACES, then])
    return math.nan


@kernel
def _solve(step, oscillator, b, mu_b, c, s, stopped, lag, gap, history, events, tolerance, work):
    """The periodic orbit that the motion approaches, by Newton's method: (found, z, c, s, slides).

    First the order of events of the last return is tried, from where the motion is now.  Next to a
    multiplier of -1 a motion stays asymmetric for thousands of periods, with an order of events that the
    symmetric orbit between its two halves does not have.  So, where the steady state is unique (mu = 1)
    and an orbit found is the one however it was found, the symmetric orbits with one or two stops a half
    period are tried too.
    """
    now = (events - 1) % history.shape[1]
    z = history[PLACES, now]
    unique = mu_b == b
    guesses = 3 if unique and history[CODES, now] == STOP_THEN_BACK else 1
    start = z
    for guess in range(guesses):
        count = lag
        if guess > 0:
            start = _middle(history, events)
            count = guess
        found, z1, c1, s1, contraction = solve_orbit(
            step, oscillator, b, mu_b, start, c, s, stopped, history[CODES], events - count, count,
            tolerance, work,
        )  # fmt: skip
        off = abs(z1 - z) + (0.0 if stopped else abs(z) * (abs(c1 - c) + abs(s1 - s)))
        if found and (unique or off <= _HEADING * gap * abs(z) / (1.0 - contraction)):
            return True, z1, c1, s1, count
    return False, z, c, s, 0


@kernel
def cell_nearby(step, oscillator, b, mu_b, b_lim, limits, neighbour, work):
    """The steady state where it is the only one, mu = 1, from an orbit near by; unresolved if that fails.

    It is that of the last cell, if that was solved for, or the motion without stops, which begins to stop
    where it turns.
    """
    count = int(neighbour[COUNT])
    if count == 0:
        if math.isinf(oscillator.v_abs) or not b_lim > 0.0:
            return unresolved(NOT_REACHED, 0.0)
        count = 1
        neighbour[PLACE] = -continuous_amplitude(oscillator.v_abs, oscillator.u, oscillator.g, b_lim)
        neighbour[SIDE] = 1.0
        neighbour[FIRST] = STOP_THEN_BACK
    neighbour[COUNT] = 0.0
    solved, z, c, s, _ = solve_orbit(
        step, oscillator, b, mu_b, neighbour[PLACE], 1.0, 0.0, True, neighbour[FIRST:], 0, count,
        limits.tolerance, work,
    )  # fmt: skip
    if not solved:
        return unresolved(NOT_REACHED, 0.0)
    neighbour[COUNT] = count
    neighbour[PLACE] = z
    code = int(neighbour[FIRST + count - 1])
    return _orbit_cell(
        step, oscillator.r, b, mu_b, b_lim, z, c, s, neighbour[SIDE], code, count, SOLVED, 0.0, work
    )


@kernel
def steady_cell(step, fine, oscillator, b, mu_b, b_lim, z, v, c, s, limits, stop, history, neighbour, work):
    """Steady state reached from (z, z' = v >= 0) at load phase (c, s).

    Parameters
    ----------
    step, oscillator, limits : see their classes
    fine : a Step at least as short, for bounds over a whole orbit
    b, mu_b : kinetic and static friction over the load amplitude; b > 0
    b_lim : boundary of b to continuous motion
    stop : (1,) set by another thread to end the work
    history, work : scratch; shapes (HISTORY_ROWS, `history_length` or more) and (MAX_TERMS,)
    neighbour : (NEIGHBOUR,) becomes the orbit solved for
    """
    end = _TURN * limits.cycles
    max_steps = end / step.h + 1.0
    max_events = _EVENTS_PER_CYCLE * limits.cycles * max(1.0, 1.0 / oscillator.r)
    unique = mu_b == b
    closeness = _NEAR_RETURN_UNIQUE if unique and limits.newton else _NEAR_RETURN
    resonance = math.isinf(oscillator.v_abs)
    orbit = b < b_lim and not resonance
    amplitude = phase = radius = 0.0
    if orbit:
        amplitude = continuous_amplitude(oscillator.v_abs, oscillator.u, oscillator.g, b)
        phase = orbit_phase(oscillator.v_abs, oscillator.v_arg, oscillator.u, b)
        radius = stop_free_radius(fine, oscillator, b, mu_b, amplitude, phase)

    time = 0.0
    sign = 1.0
    events = 0
    running = 0  # slides since the last stop
    growing = 0  # of these, the last ones each larger than the one before
    peak = 0.0
    half = 0  # half periods of the excitation passed at the last look for a return
    pause = 1  # half periods until the next try of Newton's method; longer after each failure
    next_try = 2
    tries = 0
    slides = 0  # of the periodic orbit, once it is found
    solved = False
    code = REVERSE
    old_lag = 0  # the last near return
    old_gap = math.inf
    # stops, time stuck and largest displacement in the last whole window, and in the one under way
    window = _TURN * min(AVERAGED, 0.5 * limits.cycles)
    window_end = window
    old_opened = opened = 0.0  # when these began
    stops, stuck, largest = 0, 0.0, 0.0
    old_stops, old_stuck, old_largest = 0, 0.0, 0.0

    w = v * step.h
    acceleration = step.stiffness * (c - b - z) - step.damping * w
    n = 0.0
    while time < end:
        if stop[0] != 0:
            return unresolved(NOT_COMPUTED, time / _TURN)
        if v > 0.0 or events > 0:
            n, z, c, s = slide(step, b, z, w, acceleration, c, s, max_steps, work)
            if n == NO_END:
                break
        size = abs(z)
        time += n * step.h
        code, z, c, s, push, wait = after_slide(b, mu_b, z, c, s)
        if code == STUCK:
            return stuck_cell(INTEGRATED, RESOLVED, time / _TURN, z, sign)
        w = 0.0
        acceleration = step.stiffness * push
        if code == REVERSE or code == STOP_THEN_BACK:
            sign = -sign
        now = events % history.shape[1]
        history[CODES, now] = code
        history[PLACES, now] = z
        history[COSINES, now] = c
        history[SINES, now] = s
        history[TIMES, now] = time
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
        if unique and mu_b >= 1.0 and _creeps(oscillator.r, mu_b, history, events):
            return stuck_cell(INTEGRATED, RESOLVED, time / _TURN, math.copysign(mu_b - 1.0, z), sign)
        if stopped:
            stops += 1
            stuck += wait
            time += wait
            running = 0
            growing = 0
        else:
            running += 1
            growing = growing + 1 if size > peak else 0
            if resonance and growing >= _GROWING and b < b_lim:
                return continuous_cell(oscillator, b, INTEGRATED, time / _TURN)
            if orbit and (running > 1 or events == 1):
                gap = distance_to_orbit(oscillator, b, amplitude, phase, z, c, s)
                if gap < radius or gap <= limits.tolerance * amplitude:
                    return continuous_cell(oscillator, b, INTEGRATED, time / _TURN)
        peak = size

        # look for a return once a half period: at stops, or at turns where it no longer stops
        if int(time / math.pi) == half or code == TOUCH:
            continue
        if not stopped and (orbit or resonance or running < 8):
            continue
        half = int(time / math.pi)
        # a short return is the better conditioned one; where it leads nowhere the closest is tried
        shortest = limits.newton and tries % 2 == 0
        lag, gap = _near_return(history, events, closeness, shortest)
        if lag == 0 or (not stopped and running < 2 * lag):
            old_lag = 0
            continue
        if limits.newton:
            if half >= next_try:
                solved, z1, c1, s1, slides = _solve(
                    step, oscillator, b, mu_b, c, s, stopped, lag, gap, history, events,
                    limits.tolerance, work,
                )  # fmt: skip
                if solved:
                    z, c, s = z1, c1, s1
                    if stopped and slides <= MOST_EVENTS:
                        neighbour[COUNT] = slides
                        neighbour[PLACE] = z
                        neighbour[SIDE] = sign
                        for m in range(slides):
                            neighbour[FIRST + m] = history[CODES, (events - slides + m) % history.shape[1]]
                    break
                tries += 1
                pause += 1 + pause // 4
                next_try = half + pause
        elif gap <= limits.tolerance and lag == old_lag and settled(gap, old_gap, limits.tolerance):
            slides = lag
            if stopped:
                c, s = stop_ends(mu_b, z)
            break
        old_lag = lag
        old_gap = gap

    if slides > 0:
        return _orbit_cell(
            step, oscillator.r, b, mu_b, b_lim, z, c, s, sign, code, slides, SOLVED if solved else INTEGRATED,
            time / _TURN, work,
        )  # fmt: skip
    if oscillator.marginal and b < b_lim:
        return unresolved(MARGINAL, time / _TURN)
    return averaged_cell(
        old_opened, time, end, old_stops + stops, max(old_largest, largest), old_stuck + stuck
    )


@kernel
def solve_cell(step, fine, oscillator, b, mu_b, b_lim, z, v, c, s, limits, stop, history, neighbour, work):
    """`cell_nearby` where that may do, else `steady_cell`; the same arguments."""
    if mu_b == b and limits.newton and b >= b_lim:
        found = cell_nearby(step, oscillator, b, mu_b, b_lim, limits, neighbour, work)
        if found.regime != UNRESOLVED:
            return found
    return steady_cell(
        step, fine, oscillator, b, mu_b, b_lim, z, v, c, s, limits, stop, history, neighbour, work
    )
