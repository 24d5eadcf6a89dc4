"""Continuous orbit of a structure (theory.md 2), and the distance from it within which no motion can stop."""

import math
from typing import NamedTuple

import numpy as np

from ..closed_form import decay
from ..compiler import entry, kernel
from ..compiler.vectors import LANES, filled, lane, least, load, most
from ..continuous_motion import since_maximum
from .oscillators import YC, YS, padded
from .state import DAMPING, LOAD, LOAD_RATE, PUSH, SPEED, SPEED_RATE, W

#: Intervals of half a period that a table holds at once; and the factor by which their number is raised where
#: it remains below that, because the bounds tighten with the square of their length.
_CHUNK, _TIGHTER = 8192, 3.0

#: Rows of a wave: at its nodes cosine and sine of the time since the maximum, and what unit friction adds to
#: the velocity dz/dt and to the load; then numbers.
_COS, _SIN, _FAST, _HEAVY, _NUMBERS = 0, 1, 2, 3, 4
_WAVE_ROWS = 5

#: Places of the numbers: intervals of half a period; 1 + the first one in the table, 0 for none; the
#: velocity and the load without friction, by cosine and sine of the load phase; bounds on the second
#: derivatives in tau of what unit friction adds.
_INTERVALS, _FIRST, _SPEED_COS, _SPEED_SIN, _LOAD_COS, _LOAD_SIN, _CURVE, _BEND = 0, 1, 2, 3, 4, 5, 6, 7


class Continuous(NamedTuple):
    """Response functions at every r; arrays (n_r, n) of the free oscillators, and (n_r,) of the contact."""

    re: np.ndarray  # response to the load; of modes lambda_i/(w_i^2 - r^2 + 2 i zeta_i w_i r)
    im: np.ndarray
    u_modes: np.ndarray
    g_modes: np.ndarray
    v_abs: np.ndarray
    v_arg: np.ndarray
    u: np.ndarray
    g: np.ndarray


@kernel
def orbit_state(st, orbit, i, beta, phase, c, s, out):
    """Compute the state of the continuous orbit at a load phase.

    Parameters
    ----------
    st : StructureAtFrequency
    orbit : Continuous; i : index of the frequency
    beta : kinetic friction force
    phase : load phase at the maximum of z
    c, s : cosine and sine of the load phase
    out : (2, n) filled with the state
    """
    tau, sign = since_maximum(c, s, phase)
    cosine = math.cos(tau + phase)
    sine = math.sin(tau + phase)
    for j in range(st.n):
        w = st.modes[W, j]
        zeta = st.modes[DAMPING, j]
        q, e = decay(zeta, w / st.r * tau)
        d = e + 2.0 * zeta * q
        g1 = 1.0 + orbit.g_modes[i, j]
        turn = orbit.u_modes[i, j] * st.r / w  # u R
        pull = beta * st.modes[PUSH, j] / (w * w)
        z = orbit.re[i, j] * cosine - orbit.im[i, j] * sine + pull * (1.0 - g1 * d - turn * q)
        v = -st.r * (orbit.re[i, j] * sine + orbit.im[i, j] * cosine) + pull * w * (g1 * q - turn * e)
        out[0, j] = sign * z
        out[1, j] = sign * v / st.rate


@entry
def make_wave(h, finer):
    """Allocate a wave, the table of `stop_free_radius`, for steps of h/finer in tau at most; `finer` >= 1."""
    asked = math.pi / h * finer
    intervals = int(math.ceil(max(asked, min(_TIGHTER * asked, _CHUNK))))
    wave = np.zeros((_WAVE_ROWS, padded(min(intervals, _CHUNK) + 1) + LANES))
    wave[_NUMBERS, _INTERVALS] = intervals
    return wave


@kernel
def _after_maximum(st, orbit, i, j):
    """(z, dz/dt) of oscillator j at a maximum, as unit friction makes it, less its static response."""
    w = st.modes[W, j]
    pull = st.modes[PUSH, j] / (w * w)
    return -pull * (1.0 + orbit.g_modes[i, j]), -pull * orbit.u_modes[i, j] * st.r


@kernel
def _fill_numbers(st, orbit, i, wave):
    """Fill the velocity and the load without friction, and bounds on what unit friction adds."""
    numbers = wave[_NUMBERS]
    numbers[_SPEED_COS], numbers[_SPEED_SIN] = st.rate * st.free[st.n, YC], st.rate * st.free[st.n, YS]
    numbers[_LOAD_COS], numbers[_LOAD_SIN] = st.free_cos, st.free_sin
    numbers[_CURVE] = numbers[_BEND] = 0.0
    for j in range(st.n):
        re, im = orbit.re[i, j], orbit.im[i, j]
        speed, speed_rate = st.modes[SPEED, j], st.modes[SPEED_RATE, j]
        heavy, heavy_rate = st.modes[LOAD, j], st.modes[LOAD_RATE, j]
        numbers[_SPEED_COS] += speed * re - speed_rate * (st.r * im)
        numbers[_SPEED_SIN] -= speed * im + speed_rate * (st.r * re)
        numbers[_LOAD_COS] += heavy * re - heavy_rate * (st.r * im)
        numbers[_LOAD_SIN] -= heavy * im + heavy_rate * (st.r * re)
        z, v = _after_maximum(st, orbit, i, j)
        w, rate = st.modes[W, j], 2.0 * st.modes[DAMPING, j] * st.modes[W, j]
        acceleration = -w * w * z - rate * v
        # the energy of the acceleration, too, never grows in free motion
        energy = math.hypot(w * acceleration, w * w * v + rate * acceleration) / (st.r * st.r)
        numbers[_CURVE] += (abs(speed) / w + abs(speed_rate)) * energy
        numbers[_BEND] += (abs(heavy) / w + abs(heavy_rate)) * energy


@kernel
def _fill_wave(st, orbit, i, first, count, wave):
    """Fill the nodes of `count` intervals, from interval `first` on; those after the last are like it."""
    step = math.pi / wave[_NUMBERS, _INTERVALS]
    turn_c, turn_s = math.cos(step), math.sin(step)
    c, s = math.cos(first * step), math.sin(first * step)
    for k in range(wave.shape[1]):
        wave[_COS, k], wave[_SIN, k] = c, s
        wave[_FAST, k] = wave[_HEAVY, k] = 0.0
        if k < count:
            c, s = turn_c * c - turn_s * s, turn_s * c + turn_c * s
    for j in range(st.n):
        w, zeta = st.modes[W, j], st.modes[DAMPING, j]
        static = st.modes[PUSH, j] / (w * w)
        turn_q, turn_e = decay(zeta, w / st.r * step)
        turn_d = turn_e + 2.0 * zeta * turn_q
        q, e = decay(zeta, w / st.r * (first * step))
        d = e + 2.0 * zeta * q
        z, v = _after_maximum(st, orbit, i, j)
        z, v = d * z + q / w * v, e * v - q * w * z
        for k in range(wave.shape[1]):
            wave[_FAST, k] += st.modes[SPEED, j] * (static + z) + st.modes[SPEED_RATE, j] * v
            wave[_HEAVY, k] += st.modes[LOAD, j] * (static + z) + st.modes[LOAD_RATE, j] * v
            if k < count:
                z, v = turn_d * z + turn_q / w * v, turn_e * v - turn_q * w * z
    wave[_NUMBERS, _FIRST] = first + 1.0


@kernel
def _least_square(st, count, speed, load_, mu_beta, beta, wave):
    """Square of the least deviation that stops the contact in `count` intervals of a wave.

    Parameters
    ----------
    st : StructureAtFrequency
    count : number of intervals in the table
    speed, load_ : velocity dz/dt and load: (parts by cosine and sine of the time since the maximum, and how
        far a straight line over an interval may be off)
    mu_beta, beta : static and kinetic friction force
    wave : see `make_wave`
    """
    width = wave.shape[1]
    per_speed, per_load = 1.0 / math.sqrt(st.inverse_mass), 1.0 / st.reach
    share = 1.0 - st.overlap * st.overlap
    beyond = 1.0 / share if share > 0.0 else 0.0
    nothing = filled(0.0)
    worst = filled(math.inf)
    for k in range(0, count, LANES):
        cosine, sine = load(wave, _COS * width + k), load(wave, _SIN * width + k)
        fast = cosine * speed[0] + sine * speed[1] + load(wave, _FAST * width + k) * beta
        heavy = cosine * load_[0] + sine * load_[1] + load(wave, _HEAVY * width + k) * beta
        cosine, sine = load(wave, _COS * width + k + 1), load(wave, _SIN * width + k + 1)
        next_fast = cosine * speed[0] + sine * speed[1] + load(wave, _FAST * width + k + 1) * beta
        next_heavy = cosine * load_[0] + sine * load_[1] + load(wave, _HEAVY * width + k + 1) * beta
        # z falls after its maximum; a load that changes its sign in an interval is zero there
        slowest = (most(fast, next_fast) + speed[2]) * -per_speed
        lightest = most(least(heavy, next_heavy), most(heavy, next_heavy) * -1.0)
        lightest = (lightest - (load_[2] + mu_beta)) * per_load
        more = most(most(slowest, lightest), nothing)
        # what changes one of them enough may change the other enough
        gap = most(least(slowest, lightest) - more * st.overlap, nothing)
        worst = least(worst, more * more + gap * gap * beyond)
    found = math.inf
    for k in range(LANES):
        found = min(found, lane(worst, k))
    return found


@kernel
def stop_free_radius(st, orbit, i, beta, mu_beta, phase, wave):
    """Distance (energy norm) from the continuous orbit within which no motion can stop.

    A stop requires a deviation that makes z' zero and |load| at most mu beta at the same time; the least one
    over half a period is bounded below from nodes and curvature.  The orbit is the response to the load plus
    beta times what unit friction adds, which is kept in the wave for all cells at one frequency.

    Parameters
    ----------
    st : StructureAtFrequency
    orbit : Continuous; i : index of the frequency
    beta, mu_beta : kinetic and static friction force
    phase : load phase at the maximum of z
    wave : see `make_wave`; of this structure and frequency
    """
    numbers = wave[_NUMBERS]
    if numbers[_FIRST] == 0.0:
        _fill_numbers(st, orbit, i, wave)
    intervals = int(numbers[_INTERVALS])
    eighth = 0.125 * (math.pi / intervals) ** 2
    c, s = math.cos(phase), math.sin(phase)
    a, b = numbers[_SPEED_COS], numbers[_SPEED_SIN]
    speed = c * a + s * b, c * b - s * a, eighth * (math.hypot(a, b) + beta * numbers[_CURVE])
    a, b = numbers[_LOAD_COS], numbers[_LOAD_SIN]
    heavy = c * a + s * b, c * b - s * a, eighth * (math.hypot(a, b) + beta * numbers[_BEND])
    square = math.inf
    for first in range(0, intervals, _CHUNK):
        count = min(intervals - first, _CHUNK)
        if numbers[_FIRST] != first + 1.0:
            _fill_wave(st, orbit, i, first, count, wave)
        square = min(square, _least_square(st, count, speed, heavy, mu_beta, beta, wave))
    return math.sqrt(square)
