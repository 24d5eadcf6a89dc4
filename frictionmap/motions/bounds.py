"""How far a motion can be from one with less friction, or from one under another record, for mu = 1.

Let a motion with friction b and one with more, b + d, have the same record and start; d' is the difference of
their velocities, f1 and f2 are their forces, and E is the energy of the difference, of springs in contacts,
too.  Where the first one sticks, abs(f1) <= r b, its contact only takes energy from the difference; where it
slides at w1, the other force exceeds r b by r d at most, and only to slow the difference down.  So

    E' <= d sum r_i abs(w1_i),   that is   E <= d sum r_i s_i   and   sqrt(2 E) <= d sum r_i norm(chi_i) t_i

with distances s_i and times t_i that the motion with less friction has slid: none is added once it rests.
The second one needs rigid contacts, of which w1 - w2 is chi_i d'.  A displacement e.x differs by
sqrt(e.K^-1 e) sqrt(2 E) at most.
"""

import numpy as np
import xarray as xr

from ..model.system import System
from ..units.axes import rounded
from ..units.scales import Scales, Units
from ..units.table import PI
from .scaling import motion_scales
from .structure import Structure, structure_of

#: Quantities with a bound, and the variable that has it: places of rest are places of the motion, too.
BOUNDED = {"amplitude": "amplitude", "residual": "amplitude", "contact_amplitude": "contact_amplitude"}


def displacement_bounds(structure: Structure, rows: np.ndarray) -> np.ndarray:
    """sqrt(e.K^-1 e) of rows e in modal coordinates; infinite where nothing restores."""
    squares = structure.modal.squares
    with np.errstate(divide="ignore", invalid="ignore"):
        parts = np.where(rows == 0.0, 0.0, rows**2 / squares)
    return np.sqrt(parts.sum(axis=1))


def friction_bounds(system: System, ds: xr.Dataset, step: float, *, units: Units | None = None) -> xr.Dataset:
    """Bounds on the change of displacements if beta grows by `step` at most.

    Parameters
    ----------
    system : System
    ds : Dataset
        Of `history` of this system.
    step : float
        Of beta, >= 0.
    units : Units, optional
        Those of `history`.

    Returns
    -------
    xarray.Dataset
        `amplitude` and `contact_amplitude`, over P/k_1: no displacement of a mass and no motion in a contact
        differs by more at any time.  NaN for mu > 1, under varying normal loads, and for motions without a
        known end.
    """
    structure = structure_of(system)
    general = structure.system.contact_system
    grows = [float(one.friction(1.0, 1.0)[0] - one.friction(0.0, 1.0)[0]) for one in general.groups]
    ratios = xr.DataArray(grows, dims="contact")
    distance, stuck = (_by_contact(ds[name]) for name in ("sliding_distance", "stuck_fraction"))
    root = (2.0 * step * (ratios * distance).sum("contact", skipna=False)) ** 0.5
    if not structure.spring.any():
        norms = xr.DataArray(np.linalg.norm(structure.modal.chi, axis=1), dims="contact")
        omega = 1.0 if ds["end_time"].attrs.get("units") != "s" else _omega(motion_scales(units, system))
        times = (1.0 - stuck) * ds["end_time"] * omega
        straight = step * (ratios * norms * times).sum("contact", skipna=False)
        root = root.where(root <= straight, straight)
    plain = all(one.normal_record is None for group in general.groups for one in group.members)
    equal = [plain and general.has_equal_friction(float(mu)) for mu in ds["mu"].values]
    known = (ds["status"] == 0) & xr.DataArray(equal, dims="mu")
    root = root.where(known)
    masses = xr.DataArray(displacement_bounds(structure, structure.modal.phi), dims="dof")
    contacts = xr.DataArray(displacement_bounds(structure, structure.modal.chi), dims="contact")
    return xr.Dataset({"amplitude": root * masses, "contact_amplitude": root * contacts})


def _omega(scales: Scales) -> float:
    """Angular frequency of the reference, of a dataset with times in seconds."""
    return 1.0 if scales.frequency is None else rounded(2 * PI * scales.frequency)


def _by_contact(values: xr.DataArray) -> xr.DataArray:
    """The values without numbers of contacts; a single contact has the dimension, too."""
    values = values if "contact" in values.dims else values.expand_dims("contact")
    return values.drop_vars("contact", errors="ignore")
