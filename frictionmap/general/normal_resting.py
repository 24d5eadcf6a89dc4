"""Friction from which contacts can rest permanently where normal forces move with the structure.

Of the forces F + g that hold the contacts the constants g are free, and change the normal forces by E g:

    |F + g| <= mu (L + phi (N_s + N_1 + E g)),   E = -k_n d.(K + sum k_n d d^T)^-1 c

with the friction L = phi N0 at preload, and the normal force N_s of the constant load.
"""

import numpy as np

from ..model.general import ContactSystem, MergedContact
from ..model.system import System
from .held import held_forces, largest, orders_of
from .problem import general_of


def pressed_stiffness(system: System) -> np.ndarray:
    """Stiffness of the structure with all contacts closed and without friction, K + sum k_n d d^T."""
    stiffness: np.ndarray = np.array(system.modes.stiffness, dtype=float)
    for group in general_of(system).groups:
        if group.normal is not None:
            stiffness += group.normal.stiffness * np.outer(group.normal.direction, group.normal.direction)
    return stiffness


def _normal_rows(general: ContactSystem) -> np.ndarray:
    """k_n d of every contact, (N, n); 0 where the normal force is constant."""
    found = np.zeros(general.vectors.shape)
    for j, group in enumerate(general.groups):
        if group.normal is not None:
            found[j] = group.normal.stiffness * group.normal.direction
    return found


def is_known(system: System) -> bool:
    """Whether it has a closed form: without piecewise linear springs and contacts without friction."""
    general = general_of(system)
    smooth = any(one.normal is not None and one.normal.friction == 0.0 for one in general.groups)
    return not (general.springs or smooth)


def resting_friction(system: System, r: np.ndarray, mu: float) -> np.ndarray:
    """Friction ratio beta from which all contacts can rest permanently, (n_r,).

    0 where no friction of the grid is needed, infinite where none is enough, as at a resonance of the
    structure that is held without damping, and beside a belt.  Contacts that rest do not open.
    """
    general = general_of(system)
    if any(group.first.belt for group in general.groups):
        return np.full(r.size, np.inf)
    orders = np.array(orders_of(general), dtype=float)
    static = np.array([group.first.static_ratio(mu) for group in general.groups])
    forces, motions = held_forces(system, r)
    rows = _normal_rows(general)
    with np.errstate(invalid="ignore"):  # infinite motions
        normal = np.stack([motions[n] @ rows.T for n in orders_of(general)], axis=-1)
        force = np.stack([forces[n] for n in orders_of(general)], axis=-1)
        share = static * np.array([_phi(group) for group in general.groups])
        ends = [largest(orders, sign * force - share[:, np.newaxis] * normal) for sign in (1.0, -1.0)]
    closed = np.linalg.inv(pressed_stiffness(system))
    influence = -share[:, np.newaxis] * (rows @ closed @ general.vectors.T)
    own = np.array([group.friction(0.0, mu)[1] for group in general.groups])
    more = np.array([group.friction(1.0, mu)[1] for group in general.groups]) - own
    own = own + share * (rows @ closed @ general.offset)
    found = [_least(above, below, influence, own, more) for above, below in zip(*ends, strict=True)]
    return np.array(found)


def _phi(group: MergedContact) -> float:
    """Friction coefficient; 0 of a constant normal force, whose friction is `friction`."""
    return 0.0 if group.normal is None else float(group.normal.friction)


def _least(
    above: np.ndarray, below: np.ndarray, influence: np.ndarray, own: np.ndarray, more: np.ndarray
) -> float:
    """The least beta >= 0 with which some g satisfy the inequalities above; infinite without one.

    Parameters
    ----------
    above, below : (N,) largest F - mu phi N_1 and -F - mu phi N_1
    influence : (N, N) mu phi E
    own, more : (N,) limits of friction without the grid's beta, and their slope over it
    """
    from scipy.optimize import linprog

    if not (np.isfinite(above).all() and np.isfinite(below).all()):
        return np.inf
    count = own.size
    if count == 1 and abs(influence[0, 0]) < 1.0 and more[0] > 0.0:
        eta = influence[0, 0]
        needed = 0.5 * ((1.0 + eta) * above[0] + (1.0 - eta) * below[0])
        return float(max(0.0, needed - own[0]) / more[0])
    one = np.eye(count)
    rows = np.block([[-more[:, np.newaxis], one - influence], [-more[:, np.newaxis], -one - influence]])
    right = np.concatenate((own - above, own - below))
    cost = np.append(1.0, np.zeros(count))
    bounds = [(0.0, None), *[(None, None)] * count]
    found = linprog(cost, A_ub=rows, b_ub=right, bounds=bounds, method="highs")
    return float(found.x[0]) if found.status == 0 else np.inf
