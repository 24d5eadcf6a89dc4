"""Friction that falls with the speed: up to which one there is a single steady state, whatever the start.

For mu = 1 the energy of the difference d of two motions never grows, and they end in one motion, if

    C1 + sum_i beta_i a_i c_i c_i^T >= 0,

a_i the least slope of the friction of contact i over its speed, at most 0: its force less a_i times the
velocity grows with the velocity, so that E' <= -d'.(C1 + sum_i beta_i a_i c_i c_i^T) d'.
"""

import numpy as np
from scipy.linalg import eigh

from ..model.general import ContactSystem
from ..model.system import System

#: Damping of a mode, over the largest, that is none; and the part of a contact, over the whole, that such
#: modes move by rounding error.
_NONE, _UNMOVED = 1e-12, 1e-9

#: Share of the friction at the limit that is left out, for the rounding error of the limit.
_MARGIN = 1e-12


def _friction(general: ContactSystem, beta: float) -> np.ndarray:
    """Kinetic friction of every contact, (N,)."""
    return np.array([group.friction(beta, 1.0)[0] for group in general.groups])


def _falls(general: ContactSystem) -> np.ndarray:
    """Steepest fall of the friction of every contact, over that just above speed 0, >= 0, (N,)."""
    return np.array([-group.first.law.least_slope if group.first.law else 0.0 for group in general.groups])


def certified_beta(system: System) -> float:
    """Largest beta up to which the condition holds; infinite if at all; -1 if at none."""
    general = system.contact_system
    falls, fixed = _falls(general), _friction(general, 0.0)
    at_zero, rises = falls * fixed, falls * (_friction(general, 1.0) - fixed)
    rates, modes = np.linalg.eigh(system.modes.damping)
    damped = rates > _NONE * rates.max(initial=0.0)
    parts = general.vectors @ modes
    free = np.abs(parts[:, ~damped]).max(axis=1, initial=0.0) > _UNMOVED * np.abs(parts).max(axis=1)
    if (free & (at_zero > 0.0)).any():
        return -1.0
    over = parts[:, damped] / np.sqrt(rates[damped])
    left = np.eye(int(damped.sum())) - over.T @ (at_zero[:, np.newaxis] * over)
    least = np.linalg.eigvalsh(left).min(initial=np.inf)
    if least < 0.0:
        return -1.0
    if not rises.any():
        return np.inf
    if (free & (rises > 0.0)).any() or least == 0.0:
        return 0.0
    taken = over.T @ (rises[:, np.newaxis] * over)
    return (1.0 - _MARGIN) / float(eigh(taken, left, eigvals_only=True)[-1])


def certified_friction(system: System) -> np.ndarray:
    """Kinetic friction at `certified_beta`, (N,): infinite where it falls nowhere, -1 if the condition never
    holds.  With less in some contacts it holds, too.
    """
    general, beta = system.contact_system, certified_beta(system)
    fixed = _friction(general, 0.0)
    grows = _friction(general, 1.0) - fixed
    found = fixed + np.where(grows > 0.0, beta, 0.0) * np.where(grows > 0.0, grows, 1.0)
    found = np.full_like(fixed, -1.0) if beta < 0.0 else found
    return np.where(_falls(general) > 0.0, found, np.inf)
