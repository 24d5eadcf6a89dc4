"""What is recorded of a motion beside its contacts: masses, drifts, accelerations, the force on the base.

drift_k = x_k - x_{k-1},  x_0 = u;    r^2 x_k'';    force on the base = sum of loads - r^2 ones.M x''
"""

from collections.abc import Collection

import numpy as np

from .._kernels.general.fill import Cells
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
    _refuse_for_points(system, names)
    if "drift" in names and system.matrices is not None:
        raise InputError(
            "cannot compute drift of a structure given by matrices: its storeys are not known; give a chain "
            "by mass_ratios, or take the differences of x in a response"
        )
    return any(name in RECORDED for name in names)


def _refuse_for_points(system: System, names: Collection[str]) -> None:
    """Refuse outputs that modes at points do not define."""
    if not system.by_modes:
        return
    points = general_of(system).points
    direct = points is not None and points.residual is not None
    for name in ("drift", "base_force", *(("acceleration_amplitude",) if direct else ())):
        if name in names:
            why = {
                "drift": "storeys are not known",
                "base_force": "the force on the base is not known from points",
                "acceleration_amplitude": "the residual flexibility has no inertia, and velocities jump",
            }[name]
            raise InputError(f"cannot compute {name} of a structure given by modes: {why}; omit it")


def observed_rows(system: System, modal: ModalSystem, further: bool) -> np.ndarray:
    """Rows for the kernels: displacements of the masses by modes (n, m); with further ones (3 n + 1, ...).

    The further columns are shares of the channels, and whether a row is a force, see `Record`.
    """
    phi = modal.phi if modal.points is None else modal.points.shapes
    n, m = phi.shape
    if has_direct(system):
        return _rows_with_forces(system, modal, further)
    if not further:
        return np.ascontiguousarray(phi)
    channels = channels_of(system, modal)
    rows = np.zeros((3 * n + 1, m + len(channels) + 1))
    rows[:n, :m] = rows[2 * n : 3 * n, :m] = phi
    rows[n : 2 * n, :m] = np.diff(phi, axis=0, prepend=np.zeros((1, m)))
    if modal.points is None:
        rows[3 * n, :m] = modal.mass.sum(axis=0) @ phi
    rows[2 * n :, -1] = 1.0
    if general_of(system).base:  # the first channel is then the motion of the base
        rows[n, m] = -1.0
    elif modal.points is None:
        rows[3 * n, m : m + len(channels)] = [-channel.push.sum() for channel in channels]
    return rows


def has_residual(system: System) -> bool:
    """Whether displacements contain those of modes that are left out."""
    points = general_of(system).points
    return points is not None and points.residual is not None


def has_direct(system: System) -> bool:
    """Whether displacements contain more than those of modes, see `_rows_with_forces`."""
    return has_residual(system) or general_of(system).shaken_points is not None


def _rows_with_forces(system: System, modal: ModalSystem, further: bool) -> np.ndarray:
    """Displacements of the points and, after all, in the contacts: (p + N, m + D + N + 1), or more rows.

    Columns are shares of modes, channels and friction forces, and whether a row is a force, see `Record`.
    Further rows of drifts and of the force on the base are zeros; accelerations are those without a residual.
    """
    general, rows = general_of(system), modal.points
    assert general.points is not None
    assert rows is not None
    n, (_, m) = system.n, rows.shapes.shape
    whole = np.hstack((rows.shapes, rows.loads, rows.forces, np.zeros((n, 1))))
    contacts = general.points.vectors @ whole
    if general.base:  # the first channel is its place, and the second one its acceleration
        contacts[:, m] -= general.joined
    if not further:
        return np.ascontiguousarray(np.vstack((whole, contacts)))
    acceleration = np.zeros_like(whole)
    acceleration[:, :m], acceleration[:, -1] = rows.shapes, 1.0
    acceleration[:, m + 1] = general.points.carried
    none = np.zeros_like(whole)
    return np.ascontiguousarray(np.vstack((whole, none, acceleration, none[:1], contacts)))


def of_contacts_last(system: System, cells: Cells) -> Cells:
    """Put the displacements in the contacts that are recorded after those of the points in their place.

    With a residual flexibility, the kernels know those of its other end; on a moving base, relative ones.
    """
    if not has_direct(system):
        return cells
    count = general_of(system).count

    def in_place(table: np.ndarray) -> np.ndarray:
        return np.concatenate((table[..., -count:], table[..., count:-count]), axis=-1)

    return cells._replace(lowest=in_place(cells.lowest), highest=in_place(cells.highest))


def observed_phasors(system: System, order: int, r: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Further rows of a harmonic motion x (n_r, n) of an order, complex (n_r, 2 n + 1)."""
    general = general_of(system)
    zero = np.zeros((r.size, 1))
    drift = np.diff(x, axis=1, prepend=zero + general.base.get(order, 0.0))
    acceleration = -((order * r[:, np.newaxis]) ** 2) * x
    if general.points is not None:
        return np.hstack((drift, acceleration, zero))  # the force on the base is not known, and not given
    base = (acceleration @ system.modes.mass.sum(axis=0))[:, np.newaxis]
    if not general.base:
        base = base - np.sum(general.forces.get(order, 0.0))
    return np.hstack((drift, acceleration, base))
