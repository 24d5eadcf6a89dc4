"""Friction response spectra: the peaks of one mass with friction over its natural period."""

from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from .. import checks
from ..datasets.labels import REFERENCES
from ..datasets.motion_labels import STATUSES
from ..datasets.provenance import now
from ..errors import InputError
from ..jobs import Job, Progress, Watch, run_jobs
from ..units.quantities import quantities
from ..units.table import UNITS
from ..version import __version__
from .elastic_spectra import follow_elastic, refuse_elastic
from .lanes import Driven, Grid, Oscillators, Responses, driven, follow, in_lanes, parts_of
from .origins import record_attributes
from .pieces import Pieces, derivative
from .record import Record, checked_records

DIMS = ("record", "scale", "mu", "period", "beta")

#: Variables: meaning, unit without units of the record, SI unit, and type.
VARIABLES = {
    "amplitude": ("largest displacement", "m", np.float64),
    "acceleration_amplitude": ("largest absolute acceleration", "m s-2", np.float64),
    "residual": ("place where the mass comes to rest", "m", np.float64),
    "sliding_distance": ("sliding distance", "m", np.float64),
    "stops": ("stops: ends of slides", "1", np.int64),
    "turns": ("changes of the sense of a slide without a stop", "1", np.int64),
    "asleep_time": ("time from which the contact does not move again", "s", np.float64),
    "status": ("how the motion ended", "1", np.int8),
}

_LENGTHS = ("amplitude", "residual", "sliding_distance")
#: What may become of an oscillator.
_STATUSES = STATUSES[:4]


def _records(given: Any) -> tuple[Record, ...]:
    listed = checked_records(given, "records")
    units = {one.unit is None for one in listed}
    if len(units) > 1:
        raise InputError("records", "must all have a unit, or none; got some with and some without")
    if len({one.quantity == "force" for one in listed}) > 1:
        raise InputError("records", "must all be forces, or all motions of the base; got both")
    return listed


def _size(record: Record) -> float:
    """Factor of the values of a record: of its unit in SI, and of a force its share on the mass."""
    if record.quantity != "force":
        return 1.0 if record.unit is None else float(UNITS[record.unit].size)
    if record.unit is not None:
        raise InputError(
            "records", f"must be forces over the mass, without a unit; got {checks.one_line(record.unit)}"
        )
    if record.mass not in (None, 1):
        raise InputError("mass", f"must be 1, as a spectrum is of one mass; got {record.mass}")
    if record.vector is not None and len(record.vector) != 1:
        raise InputError("vector", f"must have one number, for one mass; got {len(record.vector)}")
    return 1.0 if record.vector is None else float(record.vector[0])


def load_of(record: Record) -> Pieces:
    """Load on a mass 1 as polynomials: the force, or minus the acceleration of the base."""
    pieces = record.pieces
    sign = 1.0 if record.quantity == "force" else -1.0
    for _ in range({"velocity": 1, "displacement": 2}.get(record.quantity, 0)):
        pieces = derivative(pieces)
    return pieces._replace(terms=sign * _size(record) * pieces.terms)


def _refuse_units(given: Any, name: str, values: Any, records: tuple[Record, ...]) -> None:
    """Refuse values with a unit, which `values` are, beside records without one."""
    if values is not None and records[0].unit is None:
        hint = "be numbers without a unit, because the records have none"
        raise InputError(name, f"must {hint}; got {checks.one_line(given)}")


def _friction(given: Any, records: tuple[Record, ...]) -> np.ndarray:
    """Friction force over the mass."""
    values = quantities(given, "friction", "acceleration")
    _refuse_units(given, "friction", values, records)
    if values is None and records[0].unit is not None:
        hint = 'have a unit, such as "0.05 g", because the records have one'
        raise InputError("friction", f"must {hint}; got {checks.one_line(given)}")
    return checks.axis(given if values is None else [float(one) for one in values], "friction", least=0.0)


def _periods(given: Any, records: tuple[Record, ...]) -> np.ndarray:
    """Periods > 0, in seconds or those of records without a unit; infinite without a spring."""
    seconds = quantities(given, "period", "time")
    _refuse_units(given, "period", seconds, records)
    if seconds is not None:
        given = [float(one) for one in seconds]
    values = np.atleast_1d(checks.array(given, "period"))
    if values.dtype.kind in "iuf" and values.ndim == 1 and values.size and np.isposinf(values[-1]):
        finite = checks.axis(values[:-1], "period", least=-np.inf) if values.size > 1 else np.empty(0)
        found = np.append(finite, np.inf)
    else:
        found = checks.axis(values, "period", least=-np.inf)
    if found[0] <= 0.0:
        raise InputError("period", f"must be > 0; got {found[0]:g}")
    return found


class Asked(NamedTuple):
    """The oscillators of spectra, and the stiffness of their contact over that of the spring; None: rigid."""

    grid: Grid
    stiffness: float | None


def checked_spectra(
    records: Any,
    period: ArrayLike,
    friction: Any,
    *,
    mu: ArrayLike = 1.0,
    damping: float = 0.0,
    contact_stiffness: float | None = None,
    scale: ArrayLike = 1.0,
) -> Asked:
    """The arguments of `spectrum`, checked."""
    listed = _records(records)
    grid = Grid(
        listed, checks.axis(scale, "scale", least=-np.inf), checks.axis(mu, "mu", least=1.0),
        _periods(period, listed), _friction(friction, listed), checks.number(damping, "damping", least=0.0),
    )  # fmt: skip
    if contact_stiffness is None:
        return Asked(grid, None)
    refuse_elastic(grid)
    return Asked(grid, checks.number(contact_stiffness, "contact_stiffness", above=0.0))


def computed(
    wanted: Asked, threads: int, progress: Progress | None = None, watch: Watch | None = None
) -> xr.Dataset:
    """Variables and axes of spectra."""
    grid = wanted.grid
    if wanted.stiffness is None:
        return _labelled(grid, _followed(grid, threads, progress, watch))
    sizes = [_size(record) for record in grid.records]
    return _labelled(grid, follow_elastic(grid, wanted.stiffness, sizes, threads, progress, watch))


def at_once(
    wanted: Asked, threads: int | None, progress: Progress | None = None, watch: Watch | None = None
) -> xr.Dataset:
    """Spectra in memory, with what they say of themselves."""
    count, scales, n_mu, n_period, n_beta = wanted.grid.shape
    checks.cells(n_mu, n_period, n_beta, points=count * scales)
    ds = computed(wanted, checks.threads(threads), progress, watch)
    return ds.assign_attrs(described(wanted.grid.records))


def described(records: Sequence[Record]) -> dict[str, str]:
    """What spectra say of themselves."""
    return {
        "Conventions": "CF-1.11", "title": "Friction response spectra",
        "source": f"frictionmap {__version__}", "references": REFERENCES,
        "history": f"{now()} frictionmap.spectrum", **record_attributes(None, records),
    }  # fmt: skip


def _oscillators(grid: Grid) -> tuple[Oscillators, np.ndarray]:
    """Oscillators under one record, and the factor of the record of each.

    A record times s and friction times s are the motion times s: friction is divided by it instead.
    """
    scale, mu, period, beta = np.meshgrid(grid.scale, grid.mu, grid.period, grid.friction, indexing="ij")
    with np.errstate(divide="ignore", invalid="ignore"):
        beta = np.where(scale == 0.0, np.inf, beta / np.abs(scale))
    w = 2.0 * np.pi / period
    flat = [one.ravel() for one in (w, np.full(w.shape, grid.damping), beta, mu)]
    return Oscillators(*flat), scale.ravel()


def _followed(grid: Grid, threads: int, progress: Progress | None, watch: Watch | None) -> np.ndarray:
    """What became of all oscillators, (variables, *grid.shape)."""
    these, scale = _oscillators(grid)
    found = np.zeros((len(Responses._fields), len(grid.records), scale.size))
    sizes: list[int] = []  # of the jobs that are made
    ended = 0

    def done(index: int) -> None:
        nonlocal ended
        ended += sizes[index]
        if progress is not None:
            progress(ended, found[0].size)

    run_jobs(_jobs(grid.records, these, found, sizes), threads, done, watch)
    for name in ("amplitude", "acceleration_amplitude", "sliding_distance"):
        found[Responses._fields.index(name)] *= np.abs(scale)
    found[Responses._fields.index("residual")] *= scale
    return found.reshape((len(found), *grid.shape))


def _jobs(
    records: Sequence[Record], these: Oscillators, found: np.ndarray, sizes: list[int]
) -> Iterator[Job]:
    """Jobs of up to eight oscillators, whose numbers go to `sizes`.

    They are made one by one: a record in parts of its samples is needed as long as its own jobs run.
    """
    for k, record in enumerate(records):
        pieces = load_of(record)
        drive = driven(pieces, 1, record.quantity != "force")
        for count, members in in_lanes(parts_of(pieces, these.w, these.zeta)):
            if count != drive.parts:
                drive = driven(pieces, count, drive.base)
            sizes.append(members.size)
            yield _run, (drive, these, members, found[:, k])


def _run(drive: Driven, these: Oscillators, members: np.ndarray, found: np.ndarray) -> None:
    """Follow some oscillators; found : (variables, oscillators)."""
    found[:, members] = follow(drive, Oscillators(*(values[members] for values in these)))


def _labelled(grid: Grid, found: np.ndarray) -> xr.Dataset:
    physical = grid.records[0].unit is not None
    variables = {}
    for name, values in zip(Responses._fields, found, strict=True):
        long_name, unit, kind = VARIABLES[name]
        attrs: dict[str, Any] = {"long_name": long_name, "units": unit if physical else "1"}
        if name in _LENGTHS and grid.records[0].quantity != "force":
            attrs["comment"] = "relative to the base"
        if name == "status":
            attrs |= {"flag_values": np.array([code.value for code in _STATUSES], dtype=np.int8)}
            attrs["flag_meanings"] = " ".join(code.name for code in _STATUSES)
        variables[name] = (DIMS, values.astype(kind), attrs)
    coords = {
        "record": ("record", np.arange(1, len(grid.records) + 1), {"long_name": "record, counted from 1"}),
        "scale": ("scale", grid.scale, {"long_name": "factor of the record", "units": "1"}),
        "mu": ("mu", grid.mu, {"long_name": "ratio of static to kinetic friction force", "units": "1"}),
        "period": ("period", grid.period, {"long_name": "natural period", "units": "s" if physical else "1"}),
        "beta": (
            "beta", grid.friction,
            {"long_name": "kinetic friction force over the mass", "units": "m s-2" if physical else "1"},
        ),
    }  # fmt: skip
    return xr.Dataset(variables, coords, {"damping": grid.damping})
