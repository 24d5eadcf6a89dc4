"""Friction that falls with the speed: up to which one there is a single steady state, whatever the start.

For mu = 1 the energy of the difference d of two motions never grows, and they end in one motion, if

    C1 + sum_i beta_i a_i c_i c_i^T >= 0,

a_i the least slope of the friction of contact i over its speed, at most 0: its force less a_i times the
velocity grows with the velocity, so that E' <= -d'.(C1 + sum_i beta_i a_i c_i c_i^T) d'.

Where contacts can rest under the forces F_i(tau) that hold them, the difference from that motion has
E' <= -sum_i (beta_i g_i(V_i) + s_i V_i - abs(F_i)) abs(w_i), V_i = r abs(w_i), with any s_i such that
C1 - sum_i s_i c_i c_i^T >= 0: whatever mu, every motion comes to rest if beta_i g_i(V) + s_i V is at least
max abs(F_i) at all speeds V.
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


def sure_slopes(system: System) -> np.ndarray:
    """Slopes s (N,) of falling friction that the damping outweighs together, C1 - sum_i s_i c_i c_i^T >= 0.

    They are equal, and 0 where friction falls nowhere or undamped modes move the contact.
    """
    general = system.contact_system
    rates, modes = np.linalg.eigh(system.modes.damping)
    damped = rates > _NONE * rates.max(initial=0.0)
    parts = general.vectors @ modes
    free = np.abs(parts[:, ~damped]).max(axis=1, initial=0.0) > _UNMOVED * np.abs(parts).max(axis=1)
    which = (_falls(general) > 0.0) & ~free
    over = parts[which][:, damped] / np.sqrt(rates[damped])
    most = np.linalg.eigvalsh(over @ over.T).max(initial=0.0)
    return np.where(which, (1.0 - _MARGIN) / most if most > 0.0 else 0.0, 0.0)


def friction_to_rest(system: System, needed: np.ndarray) -> np.ndarray:
    """Kinetic friction just above speed 0 with which every motion comes to rest, (n_r, N).

    Between break points (F - s V)/g(V) is monotonic, and beyond the last one it falls: its largest value is
    at a break point.

    needed : (n_r, N) friction F with which the contacts hold
    """
    found = needed.copy()
    for j, (group, slope) in enumerate(zip(system.contact_system.groups, sure_slopes(system), strict=True)):
        law = group.first.law
        for speed, factor in zip(law.speed, law.factor, strict=True) if law is not None else ():
            rest = needed[:, j] - slope * speed
            with np.errstate(divide="ignore", invalid="ignore"):  # friction that vanishes at a speed
                found[:, j] = np.maximum(found[:, j], np.where(rest > 0.0, rest / factor, 0.0))
    return found
