"""Continuous motion of one mass in closed form: amplitude T(2.34), (7.20), phase, time since a maximum; how
far from a continuous motion the contact stops.
"""

import math

from .compiler import entry, inner_kernel, kernel


@kernel
def continuous_amplitude(v_abs, u, g, b):
    """Amplitude Z of T(2.34), (7.20) for chi^2/w^2 = 1; infinite at an undamped resonance."""
    if math.isinf(v_abs):
        return math.inf
    if b == 0.0:
        return v_abs  # u may have no limit (r = 0)
    swing = b * u
    return math.sqrt((v_abs - swing) * (v_abs + swing)) - b * g


@entry
def orbit_phase(v_abs, v_arg, u, b):
    """Load phase phi_z at a maximum of z of the continuous orbit, theory.md 2."""
    swing = b * u
    return math.atan2(-swing, math.sqrt((v_abs - swing) * (v_abs + swing))) - v_arg


@kernel
def since_maximum(c, s, phase):
    """Return (tau, sign): the time since the orbit's last maximum, or since its last minimum with sign -1."""
    tau = math.atan2(s, c) - phase
    tau -= 2.0 * math.pi * math.floor(tau / (2.0 * math.pi))
    if tau > math.pi:
        return tau - math.pi, -1.0
    return tau, 1.0


@inner_kernel
def least_deviation(speed, load, overlap):
    """Least norm of a deviation that changes the velocity of a contact and the load in it as much as a stop
    requires.

    Parameters
    ----------
    speed, load : norms of the least deviations that change either of them enough; not positive where none is
        needed
    overlap : modulus of the cosine of the angle between these two
    """
    less, more = min(speed, load), max(speed, load)
    if less <= overlap * more:  # the deviation that changes one of them changes the other enough
        return more
    return math.sqrt((less * less + more * more - 2.0 * overlap * less * more) / (1.0 - overlap * overlap))
