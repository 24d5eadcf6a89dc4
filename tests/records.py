"""Records of one mass on a shaken base for tests: its equation of motion integrated, and noise on top."""

import cmath
import functools
from typing import NamedTuple

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq


class Truth(NamedTuple):
    """What is measured, in Hz, mm and s, and how."""

    f_n: float
    zeta: float
    x_F: float  # noqa: N815
    mu: float
    offset_x: float
    f: float
    base: tuple  # complex harmonics 0, 1, ...
    contact: str = "fixed-wall"
    damping_reference: str = "base"
    rate: float = 250.0
    length: float = 10.0
    noise_x: float = 0.01
    noise_y: float = 0.003


class Cycle(NamedTuple):
    """The last cycle that was integrated."""

    parts: list  # (begin, end, place(t)), t in [0, 1/f]
    stops: int
    change: float  # of the state in it, in mm
    state: np.ndarray  # x and its velocity at its end


@functools.cache
def _waves(truth, derivative):
    """Angular frequencies [rad/s] of the base's harmonics, and the phasors of a derivative of it by time."""
    rates = 2.0 * np.pi * truth.f * np.arange(len(truth.base))
    return rates, np.array(truth.base) * (1j * rates) ** derivative


def base_at(truth, t, derivative=0):
    """The base, or a derivative of it by time."""
    rates, phasors = _waves(truth, derivative)
    return (np.exp(1j * np.multiply.outer(t, rates)) @ phasors).real


def _acceleration(truth, t, x, v):
    """x'' without friction: m x'' + c (x' - y') + k (x - offset - y) = 0, or with c x'."""
    w = 2.0 * np.pi * truth.f_n
    shaken = truth.damping_reference == "base"
    speed = v - (base_at(truth, t, 1) if shaken else 0.0)
    return -(w**2) * (x - truth.offset_x - base_at(truth, t)) - 2.0 * truth.zeta * w * speed


def _wall(truth, t, derivative):
    """The surface that the mass rubs on."""
    return base_at(truth, t, derivative) if truth.contact == "joined-base-wall" else 0.0 * t


def _pull(truth, t, x, v):
    """What friction would have to hold in a stop, over the stiffness."""
    free = _acceleration(truth, t, x, v) - _wall(truth, t, 2)
    return free / (2.0 * np.pi * truth.f_n) ** 2


def _stop(truth, begin, end, x):
    """Until when it sticks, and the held motion."""

    def place(t):
        return x + _wall(truth, t, 0) - _wall(truth, begin, 0)

    def left(t):
        return truth.mu * truth.x_F - np.abs(_pull(truth, t, place(t), _wall(truth, t, 1)))

    grid = np.linspace(begin, end, max(3, int(4000 * (end - begin) * truth.f)))
    over = np.flatnonzero(left(grid[1:]) < 0.0)
    if not over.size:
        return end, place
    k = int(over[0])
    if left(grid[k]) <= 0.0:
        return grid[k], place
    return brentq(left, grid[k], grid[k + 1], xtol=1e-15), place


def _slide(truth, begin, end, state, sense, dense):
    """Until when it slides, the motion (if it is asked for), and the state there."""
    w = 2.0 * np.pi * truth.f_n
    # x'' is linear in x and v, under waves of the base: plain numbers are quicker than arrays
    rates, base = _waves(truth, 0)
    shaken = truth.damping_reference == "base"
    load = w**2 * base + (2.0 * truth.zeta * w * _waves(truth, 1)[1] if shaken else 0.0)
    waves = list(zip((1j * rates).tolist(), load.tolist(), strict=True))
    pull = w**2 * (truth.offset_x - truth.x_F * sense)

    def slope(t, y):
        x, v = y.tolist()
        push = sum((phasor * cmath.exp(rate * t)).real for rate, phasor in waves)
        return [v, push + pull - w**2 * x - 2.0 * truth.zeta * w * v]

    def turn(t, y):
        return y[1] - _wall(truth, t, 1)

    turn.terminal, turn.direction = True, -sense
    run = solve_ivp(
        slope, (begin, end), state, "DOP853", events=turn, dense_output=dense, rtol=3e-13, atol=1e-13,
        max_step=0.02 / max(truth.f_n, truth.f),
    )  # fmt: skip
    return run.t[-1], lambda t: run.sol(t)[0], run.y[:, -1], run.status == 1


def cycle(truth, state, stuck, dense=True):
    """One cycle from a state: what happened, and the state after it; without `dense` no places in slides."""
    period, t = 1.0 / truth.f, 0.0
    parts, stops = [], 0
    sense = np.sign(state[1] - _wall(truth, 0.0, 1))
    while t < period:
        if stuck:
            begin, x = t, state[0]
            t, place = _stop(truth, begin, period, x)
            state = np.array([place(t), _wall(truth, t, 1)])
            sense = np.sign(_pull(truth, t, *state))
            stuck = t >= period
        else:
            begin = t
            t, place, state, turned = _slide(truth, begin, period, state, sense, dense)
            if turned:
                pull = _pull(truth, t, *state)
                state[1] = _wall(truth, t, 1)
                stuck, sense = abs(pull) <= truth.mu * truth.x_F, np.sign(pull)
                stops += int(stuck)
        parts.append((begin, t, place))
    return parts, stops, state, stuck


def steady(truth, cycles=60, accuracy=1e-10, start=None):
    """Integrated from a moving start until a cycle changes nothing, or as often as is allowed."""
    stuck = False
    state = np.array([truth.offset_x, 0.1 * truth.f * abs(truth.base[1])]) if start is None else start
    for _ in range(cycles):
        before = state, stuck
        _, stops, after, stuck = cycle(truth, state, stuck, dense=False)
        change = float(np.max(np.abs(after - state) / [1.0, 2.0 * np.pi * truth.f]))
        state = after
        if change < accuracy:
            break
    parts = cycle(truth, *before)[0]  # the last one again, with its places
    return Cycle(parts, stops, change, state)


def places(truth, motion, time):
    """The mass in the steady state."""
    t = np.mod(time, 1.0 / truth.f)
    x = np.empty(t.size)
    for begin, end, place in motion.parts:
        inside = (t >= begin) & (t <= end)
        x[inside] = place(t[inside])
    return x


def synthetic(truth, motion, seed):
    """Times, base and mass as they are measured, with noise of its own for every seed."""
    time = np.arange(int(truth.rate * truth.length) + 1) / truth.rate
    rng = np.random.default_rng(seed)
    base = base_at(truth, time) + rng.normal(0.0, truth.noise_y, time.size)
    return time, base, places(truth, motion, time) + rng.normal(0.0, truth.noise_x, time.size)


#: Step of the differences that give velocities [s]: their error is some 1e-6 of a slide's acceleration.
_STEP = 1e-5

#: Slower than this [mm/s] over the wall the mass is stuck.
_STUCK = 1e-4


def rates(truth, motion, time):
    """Velocities and accelerations of the mass in the steady state, by the equation of motion."""
    t = np.mod(time, 1.0 / truth.f)
    v, a = np.empty(t.size), np.empty(t.size)
    for begin, end, place in motion.parts:
        inside = (t >= begin) & (t <= end)
        low, high = np.maximum(t[inside] - _STEP, begin), np.minimum(t[inside] + _STEP, end)
        v[inside] = (place(high) - place(low)) / (high - low)
        over = v[inside] - _wall(truth, t[inside], 1)
        x, w = place(t[inside]), 2.0 * np.pi * truth.f_n
        sliding = _acceleration(truth, t[inside], x, v[inside]) - w**2 * truth.x_F * np.sign(over)
        a[inside] = np.where(np.abs(over) > _STUCK, sliding, _wall(truth, t[inside], 2))
    return v, a


def filtered(truth, values_at, time, highest=0.4):
    """A periodic signal with a jump, behind a filter against aliasing: harmonics up to a share of the rate.

    values_at : the signal at times within one period, which is sampled a thousand times as often
    """
    count = int(highest * truth.rate / truth.f)
    fine = np.arange(1000 * count) / (1000 * count * truth.f)
    harmonics = np.fft.rfft(values_at(fine))[: count + 1] / fine.size
    harmonics[1:] *= 2.0
    turn = np.exp(2j * np.pi * truth.f * np.multiply.outer(time, np.arange(count + 1)))
    return (turn @ harmonics).real
