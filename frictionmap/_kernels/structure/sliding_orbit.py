"""Continuous orbit of a structure (theory.md 2), and the distance from it within which no motion can stop."""

import math
from typing import NamedTuple

import numpy as np

from ..closed_form import decay
from ..compiler import kernel
from ..continuous_motion import least_deviation, since_maximum
from .oscillators import OW, OZ, YC, YS, bounds, step_on, watch_load
from .state import DAMPING, LOAD, LOAD_RATE, PUSH, W, contact_load


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


@kernel
def stop_free_radius(st, orbit, i, beta, mu_beta, phase, loaded, state, before):
    """Distance (energy norm) from the continuous orbit within which no motion can stop.

    A stop requires a deviation that makes z' zero and |load| at most mu beta at the same time; the least one
    over half a period is bounded below from scan steps and curvature.

    Parameters
    ----------
    st : StructureAtFrequency
    orbit : Continuous; i : index of the frequency
    beta, mu_beta : kinetic and static friction force
    phase : load phase at the maximum of z
    loaded : (n + 1, COLUMNS) work array, table of `oscillators` whose watched sum is the contact load
    state, before : (2, n) work arrays
    """
    c = -math.cos(phase)
    s = -math.sin(phase)
    orbit_state(st, orbit, i, beta, phase, c, s, state)
    for j in range(st.n + 1):
        for column in range(loaded.shape[1]):
            loaded[j, column] = st.free[j, column]
    watch_load(loaded, st.free_cos, st.free_sin)
    for j in range(st.n):
        loaded[j, OZ] = st.modes[LOAD, j]
        loaded[j, OW] = st.modes[LOAD_RATE, j] * st.rate
    fast_per = st.rate / math.sqrt(st.inverse_mass)
    curve, _, _, curve_growth, _, _ = bounds(st.free, beta, state, c, s)
    bend, _, _, bend_growth, _, _ = bounds(loaded, beta, state, c, s)
    turn_c, turn_s = math.cos(st.h), math.sin(st.h)
    speed = 0.0
    load = contact_load(st, state, c, s)
    radius = math.inf
    for _ in range(int(math.ceil(math.pi / st.h))):
        speed1 = step_on(st.free, st.n, beta, state, before, c, s)
        c, s = turn_c * c - turn_s * s, turn_c * s + turn_s * c
        speed1 += st.free[st.n, YC] * c + st.free[st.n, YS] * s
        load1 = contact_load(st, state, c, s)
        fast = fast_per * (min(speed, speed1) - 0.125 * curve)
        # a load that changes sign within the step is zero there
        least = min(abs(load), abs(load1)) if load * load1 > 0.0 else 0.0
        loaded = (least - 0.125 * bend - mu_beta) / st.reach
        radius = min(radius, least_deviation(fast, loaded, st.overlap))
        curve += curve_growth
        bend += bend_growth
        speed = speed1
        load = load1
    return radius
