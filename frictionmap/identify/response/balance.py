"""Harmonic balance of a contact with a spring: fast approximate first harmonics, from which fits start.

Let A be the response in the contact to a force in it, and V that to the load, Z = V - A F.  A spring k in
series with a slider beta answers a harmonic motion of amplitude a with F = K(a) Z: K = k if k a <= beta,
else, with c = 1 - 2 beta/(k a) and t = arccos c,

    K(a) = k/pi (t - c sqrt(1 - c^2) + i (1 - c^2))

and a follows from a |1 + A K(a)| = |V|.
"""

from typing import NamedTuple

import numpy as np

from ...model.system import System
from ...theory.half_waves import compliances, contact_compliances, dynamic_amplification

#: Halvings of the interval of the amplitude.
_HALVINGS = 30


class _Responses(NamedTuple):
    """Responses at k frequencies."""

    free: np.ndarray  # (k, n) masses without friction
    contact: np.ndarray  # (k,) V
    masses_to_force: np.ndarray  # (k, n) per force in the contact
    contact_to_force: np.ndarray  # (k,) A


def _responses(system: System, r: np.ndarray) -> _Responses:
    modes = system.modes
    per_mode = dynamic_amplification(modes, r)
    return _Responses(
        modes.mass_responses(r), modes.contact_response(r), per_mode @ compliances(modes).T,
        per_mode @ contact_compliances(modes),
    )  # fmt: skip


def stick_friction(system: System, r: np.ndarray, stiffness: float) -> np.ndarray:
    """Friction ratio (k,) from which the slider rests: abs(V)/abs(1/k + A)."""
    found = _responses(system, r)
    return np.abs(found.contact) / np.abs(1.0 / stiffness + found.contact_to_force)


def balanced_phasors(system: System, r: np.ndarray, beta: np.ndarray, stiffness: float) -> np.ndarray:
    """First harmonics of the masses, (k, n), with a spring of this stiffness in the contact of a system.

    r, beta : (k,) frequency ratios > 0, friction ratios >= 0
    """
    at, index = np.unique(r, return_inverse=True)
    found = _Responses(*(part[index] for part in _responses(system, at)))
    size = np.abs(found.contact)
    low = np.zeros(r.size)
    high = size + 4.0 / np.pi * beta * np.abs(found.contact_to_force)
    with np.errstate(invalid="ignore"):  # infinite at an undamped resonance
        for _ in range(_HALVINGS):
            middle = 0.5 * (low + high)
            short = middle * np.abs(1.0 + found.contact_to_force * _secant(middle, beta, stiffness)) < size
            low, high = np.where(short, middle, low), np.where(short, high, middle)
        secant = _secant(high, beta, stiffness)
        force = secant * found.contact / (1.0 + found.contact_to_force * secant)
        return found.free - found.masses_to_force * force[:, np.newaxis]


def _secant(amplitude: np.ndarray, beta: np.ndarray, stiffness: float) -> np.ndarray:
    """K of a spring and a slider in series."""
    slips = stiffness * amplitude > beta
    c = 1.0 - 2.0 * np.where(slips, beta / np.where(slips, stiffness * amplitude, 1.0), 1.0)
    square = 1.0 - c * c
    return stiffness / np.pi * (np.arccos(c) - c * np.sqrt(square) + 1j * square)
