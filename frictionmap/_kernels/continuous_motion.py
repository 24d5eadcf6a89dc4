"""Continuous motion of one mass in closed form: amplitude T(2.34), (7.20), phase, time since a maximum."""

import math

from .compiler import entry, kernel


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
