"""How far a motion can be from one with less friction, or from one under another record, for mu = 1.

Let a motion with friction b and one with more, b + d, have the same record and start; d' is the difference of
their velocities, f1 and f2 are their forces, and E is the energy of the difference, of springs in contacts,
too.  Where the first one sticks, abs(f1) <= r b, its contact only takes energy from the difference; where it
slides at w1, the other force exceeds r b by r d at most, and only to slow the difference down.  So

    E' <= d sum r_i abs(w1_i),   that is   E <= d sum r_i s_i   and   sqrt(2 E) <= d sum r_i norm(chi_i) t_i

with distances s_i and times t_i that the motion with less friction has slid: none is added once it rests.
The second one needs rigid contacts, of which w1 - w2 is chi_i d'.  A displacement e.x differs by
sqrt(e.K^-1 e) sqrt(2 E) at most.

Under two records, with equal friction, contacts only take energy from the difference, and a difference dL of
the loads gives E' <= norm(M^-1/2 P dL) norm(M^1/2 d'), so that sqrt(2 E) <= integral of norm(M^-1/2 P dL).
"""

from dataclasses import replace

import numpy as np
import xarray as xr

from ..errors import InputError
from ..model.system import System
from ..units.axes import rounded
from ..units.scales import Scales, Units
from ..units.table import PI
from .channels import Drive, drive_of
from .pieces import Pieces, on_times, padded
from .record import Record
from .scaling import motion_scales, scale_of
from .structure import Structure, structure_of

#: Quantities with a bound, and the variable that has it: places of rest are places of the motion, too.
BOUNDED = {"amplitude": "amplitude", "residual": "amplitude", "contact_amplitude": "contact_amplitude"}

#: The other interpolation of samples of smooth functions.
_OTHER = {"linear": "cubic", "cubic": "linear"}


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
        differs by more at any time.  NaN for mu > 1, under varying normal loads, for friction over speed, and
        for motions without a known end.
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
    plain = plain and not general.has_law
    equal = [plain and general.has_equal_friction(float(mu)) for mu in ds["mu"].values]
    known = (ds["status"] == 0) & xr.DataArray(equal, dims="mu")
    return _displacements(structure, root.where(known))


def _displacements(structure: Structure, root: xr.DataArray | float) -> xr.Dataset:
    """How far displacements of masses, and motions in contacts, can be apart at a bound of sqrt(2 E)."""
    if structure.softer:  # points move beside the modes, too
        root = np.nan * root
    masses = xr.DataArray(displacement_bounds(structure, structure.shapes), dims="dof")
    contacts = xr.DataArray(displacement_bounds(structure, structure.modal.chi), dims="contact")
    return xr.Dataset({"amplitude": root * masses, "contact_amplitude": root * contacts})


def record_bounds(system: System, one: Record, other: Record, *, units: Units | None = None) -> xr.Dataset:
    """Bounds on how far two motions are apart whose records differ, for any friction with mu = 1.

    Parameters
    ----------
    system : System
    one, other : Record
        They act on the same masses, or both move the base.
    units : Units, optional
        As of `history`.

    Returns
    -------
    xarray.Dataset
        `amplitude` and `contact_amplitude`, over P/k_1: no displacement of a mass and no motion in a contact
        differs by more at any time.  NaN where friction falls with the speed, and where the place or the
        velocity of the base acts, too: of such a difference there is no bound without the friction.

    Raises
    ------
    InputError
        The records do not act alike.

    Examples
    --------
    >>> import frictionmap as fm
    >>> push = fm.Record([0.0, 1.0, 0.0], dt=0.1, quantity="force")
    >>> late = fm.Record([0.0, 0.9, 0.0], dt=0.1, quantity="force")
    >>> float(record_bounds(fm.System(), push, late).amplitude.squeeze().round(4))
    0.0115
    """
    structure = structure_of(system)
    general = structure.system.contact_system
    falls = any(min(group.first.law.slopes) < 0.0 for group in general.groups if group.first.law)
    if falls or not general.has_equal_friction(1.0):
        return _displacements(structure, np.nan)
    scales = motion_scales(units, system)
    drives = [drive_of(structure.system, record, scale_of(record, scales)) for record in (one, other)]
    if not np.array_equal(drives[0].push, drives[1].push):
        raise InputError("other", f"must act as {one.quantity} {one.name or ''} does; got {other!r}")
    if any(drive.base.any() or drive.terms[-1].any() for drive in drives):
        return _displacements(structure, np.nan)
    return _displacements(structure, _impulse(structure, *drives))


def interpolation_bounds(system: System, record: Record, *, units: Units | None = None) -> xr.Dataset:
    """What straight lines between the samples can change against a spline, as `record_bounds` of the two.

    NaN of records that are known between their samples: formulas, samples that hold, displacements.
    """
    if record.series is not None or record.quantity == "displacement" or record.interpolation not in _OTHER:
        return _displacements(structure_of(system), np.nan)
    other = replace(record, interpolation=_OTHER[record.interpolation])
    return record_bounds(system, record, other, units=units)


def _impulse(structure: Structure, one: Drive, other: Drive) -> float:
    """Integral of norm(M^-1/2 P dL) over time, at most.

    Over an interval it is no more than the root of the mean square times the length (Cauchy and Schwarz):
    a tenth too much for a parabola.  The square is a polynomial, which Gauss's rule integrates exactly.
    """
    times = np.unique(np.concatenate((one.times, other.times)))
    steps = np.diff(times)
    count = max(one.terms.shape[2], other.terms.shape[2])
    apart = _terms_on(one, times, steps, count) - _terms_on(other, times, steps, count)
    nodes, weights = np.polynomial.legendre.leggauss(count)
    values = apart @ (0.5 + 0.5 * nodes) ** np.arange(count)[:, np.newaxis]
    push = structure.modal.phi.T @ one.push
    squares = np.einsum("kdx,de,kex->kx", values, push.T @ push, values)
    return float(steps @ np.sqrt(squares @ (0.5 * weights)))


def _terms_on(drive: Drive, times: np.ndarray, steps: np.ndarray, count: int) -> np.ndarray:
    """Polynomials of the channels over other intervals, (K, D, count)."""
    own = [Pieces(drive.times, drive.steps[:-1], table) for table in drive.terms[:-1].transpose(1, 0, 2)]
    return np.stack([padded(on_times(one, times, steps).terms, count) for one in own], axis=1)


def _omega(scales: Scales) -> float:
    """Angular frequency of the reference, of a dataset with times in seconds."""
    return 1.0 if scales.frequency is None else rounded(2 * PI * scales.frequency)


def _by_contact(values: xr.DataArray) -> xr.DataArray:
    """The values without numbers of contacts; a single contact has the dimension, too."""
    values = values if "contact" in values.dims else values.expand_dims("contact")
    return values.drop_vars("contact", errors="ignore")
