"""Steady state of one mass under a load of several harmonics: cycles are followed until the state repeats.

Once the number of events repeats, Newton's method on the state after one period is used; its result is
accepted only if it is stable.
"""

import math
from typing import NamedTuple

import numpy as np

from ..compiler import entry, kernel
from .cycle import follow
from .slides import Samples, friction_mass, scratch

REPEATS = 0
NO_REPEAT = 1  # no repetition within the cycles allowed, or not after one period
HANGS = 2  # ever shorter slides follow each other

#: Largest Newton step, and largest change over one period, of a converged state, relative to the motion.
_TOLERANCE = 1e-12
_NO_CHANGE = 1e-14

#: Largest multiplier of a stable motion; the excess over 1 is rounding error.
_STABLE = 1.0 + 1e-9

#: A determinant of terms of size 1 below this is rounding error: an undamped resonance has no steady state.
_SINGULAR = 1e-13

#: A Newton step is taken if it is shorter than this share of the last one and than _FARTHEST of the motion;
#: otherwise _PAUSE cycles are followed first.
_SHORTER = 0.5
_FARTHEST = 0.3  # larger steps leave the range in which the map is linear
_PAUSE = 8


class Steady(NamedTuple):
    """Steady state at tau = 0, and the events of its period."""

    status: int
    q: float
    v: float
    stops: int
    stuck: float
    turn_load: float
    cycles: int


@kernel
def _newton(cycle, q, v):
    """Newton step to the fixed point of the map linearised about (q, v); infinite if there is none."""
    t = cycle.tangent
    rest_q = cycle.q - q
    rest_v = cycle.v - v
    determinant = (1.0 - t.q_q) * (1.0 - t.v_v) - t.q_v * t.v_q
    if not _SINGULAR < abs(determinant) < math.inf:
        return math.inf, math.inf
    return (
        ((1.0 - t.v_v) * rest_q + t.q_v * rest_v) / determinant,
        (t.v_q * rest_q + (1.0 - t.q_q) * rest_v) / determinant,
    )


@kernel
def _largest_multiplier(t):
    """Largest modulus of the multipliers."""
    half = 0.5 * (t.q_q + t.v_v)
    determinant = t.q_q * t.v_v - t.q_v * t.v_q
    square = half * half - determinant
    if square <= 0.0:
        return math.sqrt(max(determinant, 0.0))
    return abs(half) + math.sqrt(square)


@kernel
def _find(mass, q, v, most, work, no_samples):
    """Return (status, q, v, cycles) of the state that repeats."""
    events = -1
    last = math.inf
    ready = 1  # the first cycle from which a Newton step may be taken
    scale = 0.0
    linear = mass.friction == 0.0
    for n in range(most):
        cycle = follow(mass, q, v, work, no_samples)
        if not cycle.complete:
            return HANGS, q, v, n
        scale = max(scale, abs(cycle.q), mass.r * abs(cycle.v))
        move = max(abs(cycle.q - q), mass.r * abs(cycle.v - v))
        if move <= _NO_CHANGE * scale:
            return REPEATS, cycle.q, cycle.v, n
        step_q, step_v = _newton(cycle, q, v)
        size = max(abs(step_q), mass.r * abs(step_v))
        near = cycle.events == events and n >= ready and size < min(_SHORTER * last, _FARTHEST * scale)
        if near or (linear and math.isfinite(size)):
            if _largest_multiplier(cycle.tangent) > _STABLE:
                ready = most  # an unstable motion is not approached
            elif size <= _TOLERANCE * scale:
                return REPEATS, q + step_q, v + step_v, n
            else:
                events = cycle.events
                last = size
                q += step_q
                v += step_v
                continue
        elif last < math.inf:
            ready = n + _PAUSE
            last = math.inf
        events = cycle.events
        q = cycle.q
        v = cycle.v
    return NO_REPEAT, q, v, most


@entry
def steady_motion(r, zeta, friction, mu, load, q, v, phases, displacements, most):
    """Find the steady state that the motion from (q, v) at tau = 0 reaches.

    Parameters
    ----------
    r, zeta : frequency ratio > 0, damping ratio >= 0
    friction, mu : kinetic friction over stiffness >= 0, static over kinetic friction >= 1
    load : (N + 1,) complex harmonics 0, 1, ... of the load over stiffness, a length as q
    q, v : initial state
    phases, displacements : (k,) increasing phases in [0, 2 pi); filled with q there
    most : cycles allowed

    Returns
    -------
    Steady
    """
    mass = friction_mass(r, zeta, friction, mu, load)
    work = scratch()
    no_samples = Samples(phases[:0], displacements[:0], np.zeros(1, np.int64))
    status, q, v, cycles = _find(mass, q, v, most, work, no_samples)
    cycle = follow(mass, q, v, work, Samples(phases, displacements, np.zeros(1, np.int64)))
    return Steady(status, q, v, cycle.stops, cycle.stuck, cycle.turn_load, cycles)
