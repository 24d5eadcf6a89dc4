"""Slides and stops of one mass under a load of several harmonics.

    r^2 q'' + 2 zeta r q' + q + b s = g(tau),   g = Re sum_n G_n e^{i n tau},   s = sgn(q')

b is the kinetic friction over the stiffness, a length.  A slide is followed in steps so short that the Taylor
series of the motion, whose recurrence is the equation of motion, is exact to rounding: no special case is
needed for a resonant harmonic, nor for zeta = 1.  Inside a step the displacement is counted along the slide,
y = s q, so that every slide is an upward one.
"""

import math
from typing import NamedTuple

import numpy as np

from ..closed_form import fastest_rate
from ..compiler import entry, kernel
from ..taylor_series import first_root

#: Largest angle of the fastest part per step [rad] ...
_TURN = 0.5

#: ... for which a series of this many terms is exact to rounding: 0.5^19/19! = 2e-23.
_TERMS = 20


class FrictionMass(NamedTuple):
    """A mass with its load and its friction."""

    r: float
    zeta: float
    friction: float  # b
    static_friction: float  # mu b
    load: np.ndarray  # complex G_n, n = 0, 1, ...
    step: float  # the longest step in tau


class Scratch(NamedTuple):
    """Taylor series of one step."""

    load: np.ndarray  # coefficients of g
    speed: np.ndarray  # coefficients of dy/dx, x in [0, 1] along the step
    gap: np.ndarray  # coefficients of static friction less load


class Samples(NamedTuple):
    """Phases at which the displacement is requested."""

    phases: np.ndarray  # increasing, in [0, 2 pi)
    displacements: np.ndarray  # displacements there, filled along the way
    next: np.ndarray  # shape (1,), int: index of the first one not yet filled


@entry
def friction_mass(r, zeta, friction, mu, load):
    """Build the mass with the step length that its motion requires."""
    rate = max(float(load.size), fastest_rate(1.0 / r, zeta))
    return FrictionMass(r, zeta, friction, mu * friction, load, _TURN / rate)


@entry
def scratch():
    """Allocate the series of one step."""
    return Scratch(np.empty(_TERMS), np.empty(_TERMS), np.empty(_TERMS))


@kernel
def load_series(load, tau, length, out):
    """Compute the Taylor coefficients of g(tau + length x) in x."""
    for k in range(out.size):
        out[k] = 0.0
    for n in range(load.size):
        turn = complex(math.cos(n * tau), math.sin(n * tau))
        term = load[n] * turn
        factor = complex(0.0, n * length)
        for k in range(out.size):
            out[k] += term.real
            term *= factor / (k + 1.0)


@kernel
def load_and_rate(load, tau):
    """Evaluate g and g' at tau."""
    value = 0.0
    rate = 0.0
    for n in range(load.size):
        term = load[n] * complex(math.cos(n * tau), math.sin(n * tau))
        value += term.real
        rate -= n * term.imag
    return value, rate


@kernel
def settle(mass, q, g):
    """Return (sense, force) of the slide that starts from rest; (0.0, 0.0) for a stop (equality sticks).

    The force is r^2 times the acceleration along the slide.
    """
    pull = g - q
    if abs(pull) <= mass.static_friction:
        return 0.0, 0.0
    return math.copysign(1.0, pull), abs(pull) - mass.friction


@kernel
def _slide_series(mass, length, sense, q, v, pull, work):
    """Compute the series of one step of a slide.

    Parameters
    ----------
    mass : FrictionMass
    length : length of the step in tau
    sense : 1.0 for an upward slide, -1.0 for a downward one
    q, v : state at the start of the step
    pull : force along the slide at its start, less the friction
    work : Scratch; work.speed is filled
    """
    a = length / mass.r
    stiffness = a * a
    damping = 2.0 * mass.zeta * a
    y = sense * q
    y1 = length * sense * v
    work.speed[0] = y1
    for k in range(_TERMS - 1):
        force = sense * work.load[k] - y if k > 0 else pull
        y2 = (stiffness * force - damping * (k + 1.0) * y1) / ((k + 1.0) * (k + 2.0))
        work.speed[k + 1] = (k + 2.0) * y2
        y = y1
        y1 = y2


@kernel
def _displacement(work, sense, q, x):
    """Displacement q at x in a step that starts at q."""
    rise = 0.0
    for k in range(_TERMS - 1, -1, -1):
        rise = rise * x + work.speed[k] / (k + 1.0)
    return q + sense * rise * x


@kernel
def _velocity(work, x):
    """Velocity dy/dx at x in a step."""
    value = 0.0
    for k in range(_TERMS - 1, -1, -1):
        value = value * x + work.speed[k]
    return value


@kernel
def slide(mass, tau, sense, q, v, force, end, work, samples):
    """Follow a slide to its first turn, or to `end`.

    Parameters
    ----------
    mass : FrictionMass
    tau : time
    sense : 1.0 for an upward slide, -1.0 for a downward one
    q, v : state
    force : force of `settle` where the slide starts from rest, used as given: 0 after a stop with mu = 1
    end : time in tau to stop at
    work : Scratch
    samples : Samples, filled along the way

    Returns
    -------
    (tau, q, v, turned) : time and state at the end, and whether the slide has turned
    """
    at_rest = v == 0.0
    while tau < end:
        length = min(mass.step, end - tau)
        load_series(mass.load, tau, length, work.load)
        pull = force if at_rest else sense * (work.load[0] - q) - mass.friction
        _slide_series(mass, length, sense, q, v, pull, work)
        first = 0
        if at_rest:
            first = 1 if force > 0.0 else 2  # skip the root at the start
        x = first_root(work.speed, first, _TERMS)
        stop = tau + min(x, 1.0) * length
        while samples.next[0] < samples.phases.size and samples.phases[samples.next[0]] < stop:
            k = samples.next[0]
            samples.displacements[k] = _displacement(work, sense, q, (samples.phases[k] - tau) / length)
            samples.next[0] = k + 1
        if x <= 1.0:
            return stop, _displacement(work, sense, q, x), 0.0, True
        q = _displacement(work, sense, q, 1.0)
        v = sense * _velocity(work, 1.0) / length
        tau = stop if length == mass.step else end
        at_rest = False
    return end, q, v, False


@kernel
def _breaks_free(mass, q, sense, work):
    """Position x in a step at which the load first exceeds the static friction in a direction; 2.0 if it does
    not.
    """
    work.gap[0] = mass.static_friction - sense * (work.load[0] - q)
    for k in range(1, _TERMS):
        work.gap[k] = -sense * work.load[k]
    return first_root(work.gap, 0, _TERMS)


@kernel
def wait(mass, tau, q, end, work, samples):
    """Follow a stop; return (tau, sense of the slide that starts), or (end, 0.0)."""
    sense = 0.0
    while tau < end and sense == 0.0:
        length = min(mass.step, end - tau)
        load_series(mass.load, tau, length, work.load)
        up = _breaks_free(mass, q, 1.0, work)
        down = _breaks_free(mass, q, -1.0, work)
        x = min(up, down)
        if x <= 1.0:
            sense = 1.0 if up <= down else -1.0
            tau += x * length
        else:
            tau = tau + length if length == mass.step else end
    while samples.next[0] < samples.phases.size and samples.phases[samples.next[0]] < tau:
        samples.displacements[samples.next[0]] = q
        samples.next[0] += 1
    return tau, sense
