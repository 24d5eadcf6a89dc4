"""Continuous orbit of the normalised oscillator (theory.md 2), and the distance within which no motion can
stop.
"""

import math
from typing import NamedTuple

from ..closed_form import decay
from ..compiler import kernel
from ..continuous_motion import least_deviation, since_maximum


class Oscillator(NamedTuple):
    """Normalised oscillator at one r; all fields depend on (r, zeta) only."""

    r: float
    zeta: float
    v_abs: float  # |V|, infinite at an undamped resonance
    v_arg: float
    u: float
    g: float
    marginal: bool  # undamped at r = 1/(2n), where the continuous motions form a continuum


@kernel
def distance_to_orbit(oscillator, b, amplitude, phase, z, c, s):
    """Energy norm sqrt(z^2 + r^2 z'^2) of the distance of a state at rest from the continuous orbit.

    Parameters
    ----------
    oscillator : Oscillator
    b : kinetic friction over load amplitude
    amplitude, phase : amplitude of the orbit, and load phase at its maximum
    z : displacement of the state
    c, s : cosine and sine of its load phase
    """
    a = 1.0 / oscillator.r
    tau, sign = since_maximum(c, s, phase)
    q, e = decay(oscillator.zeta, a * tau)
    g1 = 1.0 + oscillator.g
    d = e + 2.0 * oscillator.zeta * q
    from_cos = amplitude + b * oscillator.g
    swing = b * oscillator.u
    cosine = math.cos(tau)
    sine = math.sin(tau)
    orbit_z = from_cos * cosine + swing * sine + b * (1.0 - g1 * d) - swing * oscillator.r * q
    orbit_v = swing * (cosine - e) - from_cos * sine + b * g1 * a * q
    return math.hypot(z - sign * orbit_z, oscillator.r * orbit_v)


@kernel
def stop_free_radius(step, oscillator, b, mu_b, amplitude, phase):
    """Distance (energy norm) from the continuous orbit within which no motion can stop.

    A stop requires deviations r z' and z that make z' zero and |load| at most mu b at the same time; the
    least norm of both over half a period is bounded below from scan steps and their curvature.
    """
    c = -math.cos(phase)
    s = -math.sin(phase)
    z = -amplitude
    w = 0.0
    stiffness = step.stiffness
    omega = math.sqrt(stiffness)
    square = step.h * step.h
    acceleration = stiffness * (c - b - z)
    energy = omega * abs(acceleration) + abs(stiffness * s * step.h + step.damping * acceleration)
    to_velocity = oscillator.r / step.h
    radius = math.inf
    load = z - c
    n = int(math.ceil(math.pi / step.h))
    for _ in range(n):
        energy += stiffness * square
        z1 = step.zz * z + step.zw * w + step.z_cos * c + step.z_sin * s - step.z_one * b
        w1 = step.wz * z + step.ww * w + step.w_cos * c + step.w_sin * s - step.w_one * b
        c1 = step.cos * c - step.sin * s
        s = step.cos * s + step.sin * c
        c = c1
        load1 = z1 - c
        fast = to_velocity * (min(w, w1) - 0.125 * energy)
        # a load that changes sign within the step is zero there
        least = min(abs(load), abs(load1)) if load * load1 > 0.0 else 0.0
        loaded = least - 0.125 * (energy / omega + square) - mu_b
        radius = min(radius, least_deviation(fast, loaded, 0.0))
        z = z1
        w = w1
        load = load1
    return radius
