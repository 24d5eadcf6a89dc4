"""What is recorded of a motion beside its contacts: masses, drifts, accelerations, the force on the base.

drift_k = x_k - x_{k-1},  x_0 = u;    r^2 x_k'';    force on the base = sum of loads - r^2 ones.M x''
"""

from collections.abc import Collection

import numpy as np

from ..errors import InputError
from ..model.settings import RECORDED
from ..model.system import System
from .problem import ModalSystem, channels_of, general_of


def wants_further(system: System, names: Collection[str]) -> bool:
    """Whether any of the outputs needs further rows: n drifts, n accelerations, the force on the base.

    Raises
    ------
    InputError
        Drifts are wanted of a structure whose storeys are not known.
    """
    if "drift" in names and system.matrices is not None:
        raise InputError(
            "cannot compute drift of a structure given by matrices: its storeys are not known; give a chain "
            "by mass_ratios, or take the differences of x in a response"
        )
    return any(name in RECORDED for name in names)


def observed_rows(system: System, modal: ModalSystem, further: bool) -> np.ndarray:
    """Rows for the kernels: displacements of the masses by modes (n, m); with further ones (3 n + 1, ...).

    The further columns are shares of the channels, and whether a row is a force, see `Record`.
    """
    phi, (n, m) = modal.phi, modal.phi.shape
    if not further:
        return np.ascontiguousarray(phi)
    channels = channels_of(system, modal)
    rows = np.zeros((3 * n + 1, m + len(channels) + 1))
    rows[:n, :m] = rows[2 * n : 3 * n, :m] = phi
    rows[n : 2 * n, :m] = np.diff(phi, axis=0, prepend=np.zeros((1, m)))
    rows[3 * n, :m] = modal.mass.sum(axis=0) @ phi
    rows[2 * n :, -1] = 1.0
    if general_of(system).base:  # the first channel is then the motion of the base
        rows[n, m] = -1.0
    else:
        rows[3 * n, m : m + len(channels)] = [-channel.push.sum() for channel in channels]
    return rows


def observed_phasors(system: System, order: int, r: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Further rows of a harmonic motion x (n_r, n) of an order, complex (n_r, 2 n + 1)."""
    general = general_of(system)
    zero = np.zeros((r.size, 1))
    drift = np.diff(x, axis=1, prepend=zero + general.base.get(order, 0.0))
    acceleration = -((order * r[:, np.newaxis]) ** 2) * x
    base = (acceleration @ system.modes.mass.sum(axis=0))[:, np.newaxis]
    if not general.base:
        base = base - np.sum(general.forces.get(order, 0.0))
    return np.hstack((drift, acceleration, base))
