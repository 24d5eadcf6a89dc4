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
from .orbits import first_push, measure_orbit, solve_orbit, stop_ends

#: Events remembered; a steady period with more is not recognised.  The rows of the memory:
HISTORY = 2048
CODES, PLACES, COSINES, SINES = 0, 1, 2, 3
HISTORY_ROWS = 4

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

#: Excitation periods over which a motion that does not repeat is averaged.
_AVERAGED = 100.0

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
    period = halves if halves % 2 == 1 else halves // 2
    regime = STICK_SLIP if stops > 0 else CONTINUOUS
    return Cell(
        regime, RESOLVED, origin, 2.0 * stops / halves, amplitude, stuck, period, cycles,
        z, c, s, sign, slides, net,
    )  # fmt: skip


@kernel
def averaged_cell(window, stops, amplitude, stuck, cycles):
    """Stick-slip that does not repeat, by what it did in a window of time."""
    return plain_cell(
        STICK_SLIP, NOT_PERIODIC, INTEGRATED, stops * _TURN / window, amplitude, stuck / window, 0, cycles
    )


@kernel
def settled(gap, old_gap, tolerance):
    """Whether returns that were `old_gap` and are `gap` off leave less than the tolerance to go."""
    rate = min(gap / old_gap, 0.999999) if old_gap > 0.0 else 0.0
    return gap * rate <= 10.0 * tolerance * (1.0 - rate)


@kernel
def _orbit_cell(step, r, b, mu_b, z, c, s, sign, code, count, origin, cycles, work):
    """The steady state that returns to an anchor after `count` slides, or sooner."""
    slides, halves, stops, amplitude, stuck = measure_orbit(step, r, b, mu_b, z, c, s, code, count, work)
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
    now = (events - 1) % HISTORY
    best = 0
    best_gap = math.inf
    near = closeness
    seen = 0
    for lag in range(1, min(events, HISTORY)):
        then = (events - 1 - lag) % HISTORY
        if history[CODES, then] == history[CODES, now]:
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
    now = (events - 1) % HISTORY
    then = (events - 2) % HISTORY
    if history[CODES, now] != STOP_THEN_ON or history[CODES, then] != STOP_THEN_ON:
        return False
    far = abs(history[PLACES, now]) - (mu_b - 1.0)
    taken = abs(history[PLACES, then]) - abs(history[PLACES, now])
    return far < _CREEPING * r * r and 0.0 <= taken < 0.5 * far


@kernel
def _middle(history, events):
    """Displacement between the last stop and the one before; nan if there is none before."""
    now = events - 1
    for lag in range(1, min(events, HISTORY)):
        then = (now - lag) % HISTORY
        if history[CODES, then] == STOP_THEN_BACK or history[CODES, then] == STOP_THEN_ON:
            return 0.5 * (history[PLACES, now % HISTORY] + history[PLACES, then])
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
    now = (events - 1) % HISTORY
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
def steady_cell(step, fine, oscillator, b, mu_b, b_lim, z, v, c, s, limits, stop, history, work):
    """Steady state reached from (z, z' = v >= 0) at load phase (c, s).

    Parameters
    ----------
    step, oscillator, limits : see their classes
    fine : a Step at least as short, for bounds over a whole orbit
    b, mu_b : kinetic and static friction over the load amplitude; b > 0
    b_lim : boundary of b to continuous motion
    stop : (1,) set by another thread to end the work
    history, work : scratch; shapes (HISTORY_ROWS, HISTORY) and (MAX_TERMS,)
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
    window = _TURN * min(_AVERAGED, 0.5 * limits.cycles)
    window_end = window
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
        now = events % HISTORY
        history[CODES, now] = code
        history[PLACES, now] = z
        history[COSINES, now] = c
        history[SINES, now] = s
        events += 1
        if events > max_events:
            return unresolved(TOO_MANY_EVENTS, time / _TURN)
        stopped = code == STOP_THEN_BACK or code == STOP_THEN_ON
        if time >= window_end:
            window_end += window
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
            step, oscillator.r, b, mu_b, z, c, s, sign, code, slides, SOLVED if solved else INTEGRATED,
            time / _TURN, work,
        )  # fmt: skip
    if oscillator.marginal and b < b_lim:
        return unresolved(MARGINAL, time / _TURN)
    if old_stops == 0 or (running > 0 and stops == 0):
        return unresolved(NOT_REACHED, time / _TURN)
    return averaged_cell(window, old_stops, old_largest, old_stuck, time / _TURN)
