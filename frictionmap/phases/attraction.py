"""A proof that a motion without a load ends in steady sliding.

In the phase of steady sliding y' = A y is linear: V = y^T P y with A^T P + P A = -I falls, and so bounds what
ends the phase: every |l.y| <= sqrt(V l^T P^-1 l).
"""

import numpy as np
from scipy.linalg import solve_continuous_lyapunov

from .._kernels.phases.problem import SMOOTH
from ..general.slopes import first_order
from .sliding import Sliding, normal_forces
from .system import PhaseSystem


def attracts(
    system: PhaseSystem, sliding: Sliding, preload: np.ndarray, x: np.ndarray, velocity: np.ndarray,
    senses: np.ndarray,
) -> bool:  # fmt: skip
    """Whether a motion certainly ends in steady sliding.

    Parameters
    ----------
    system, sliding : PhaseSystem, Sliding
    preload : (N,) N0
    x, velocity : (n,) displacements and velocities of the masses
    senses : (N,) of the contacts, 0 where one sticks
    """
    if not sliding.is_stable:
        return False
    force = normal_forces(system, preload, sliding.place)
    for one, own, sense in zip(system.contacts, force, senses, strict=True):
        closed = one.law != SMOOTH and (one.normal is None or own > 0.0)
        if closed and sense != -np.sign(one.belt):
            return False
    form = solve_continuous_lyapunov(
        first_order(system.mass, system.damping, sliding.stiffness).T, -np.eye(2 * system.n)
    )
    y = np.concatenate((x - sliding.place, velocity))
    rows, margins = _limits(system, sliding.place, force)
    if not margins.size:
        return True
    reach = np.sqrt((y @ form @ y) * np.einsum("ij,ij->i", rows, np.linalg.solve(form, rows.T).T))
    return bool((reach < margins).all())


def _limits(system: PhaseSystem, x: np.ndarray, force: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """What ends the phase of steady sliding: functions of the state, and their distances from limits."""
    still, rows, margins = np.zeros(system.n), [], []
    for one, own in zip(system.contacts, force, strict=True):
        if one.normal is not None:
            rows.append(np.concatenate((one.normal_stiffness * one.normal, still)))
            margins.append(abs(own))
        if one.law == SMOOTH or (one.normal is not None and own <= 0.0):
            continue
        row = -np.sign(one.belt) * one.direction
        if one.stiffness and one.normal is not None:
            row = row - one.friction * one.normal_stiffness / one.stiffness * one.normal
        rows.append(np.concatenate((still, row)))
        margins.append(abs(one.belt))
    for spring in system.springs:
        rows.append(np.concatenate((spring.direction, still)))
        margins.append(float(np.abs(np.array(spring.displacement) - spring.direction @ x).min()))
    return np.array(rows).reshape(len(rows), 2 * system.n), np.array(margins)
