"""`history`: motions in time as labelled variables."""

from collections.abc import Callable, Mapping, Sequence
from itertools import product
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from .. import checks
from ..datasets.labels import REFERENCES, SCALES, attributes
from ..datasets.motion_labels import DRIVES, IN_SI, MOTIONS, OF_CONTACTS, SI_LABELS, TIMES, si_name
from ..datasets.provenance import excitation_of, now
from ..errors import InputError
from ..general.dataset import refuse_static
from ..jobs import Progress, Watch, run_counted
from ..model.general import ContactSystem
from ..model.system import System
from ..model.variations import checked_variations
from ..phases.dataset import spring_coordinates
from ..units.scales import Scales, Units, scales_of
from ..version import __version__
from .averages import asked_averages, averages_of, describe_averages
from .bank_motions import BankMotions
from .cells import Asked, Found, Motions
from .channels import drive_of
from .further_axes import axis_coordinates, part_of_progress, stacked
from .holding import holding_friction
from .opening import OpeningMotions
from .opening_holding import opening_holding_friction
from .origins import record_attributes
from .record import Record, checked_records
from .scaling import friction_ratios, motion_scales, scale_of
from .starts import start_of
from .structure import Structure, structure_of

#: Peaks that are given by their names, and the variables of their largest moduli.
_PEAKS = {
    "x": "amplitude", "z": "contact_amplitude", "acceleration": "acceleration_amplitude",
    "friction": "friction_amplitude", "base_force": "base_force", "spring_force": "spring_force",
}  # fmt: skip

#: Those of which both ends are given, and those of which the time is.
_BOTH_ENDS = ("x", "z", "acceleration", "friction", "base_force")
_TIMED = ("x", "z", "acceleration", "friction")


class Grid(NamedTuple):
    """The motions that are wanted."""

    records: tuple[Record, ...]
    scale: np.ndarray
    mu: np.ndarray
    beta: np.ndarray

    @property
    def shape(self) -> tuple[int, int, int, int]:
        """Number of records, scales, mu and beta."""
        return len(self.records), self.scale.size, self.mu.size, self.beta.size


def _axis(given: Any, name: str, **ends: float) -> np.ndarray:
    values = np.atleast_1d(checks.array(given, name))
    if values.ndim != 1 or not values.size:
        shown = given.tolist() if isinstance(given, np.ndarray) else given
        raise InputError(name, f"must be a number or a list of numbers; got {checks.one_line(shown)}")
    found = np.array(
        [checks.number(value, f"{name}[{k}]", **ends) for k, value in enumerate(values.tolist())]
    )
    if (np.diff(found) <= 0.0).any():
        raise InputError(name, f"must increase; got {checks.one_line(found.tolist())}")
    return found


def _after(given: Any) -> float | None:
    if isinstance(given, str):
        if given != "rest":
            raise InputError("after", f'must be "rest" or a time >= 0 after the record; got {given!r}')
        return None
    return checks.number(given, "after", least=0.0)


def _every(given: Any, grid: Grid) -> int:
    """Samples between two states that are kept; 0: none."""
    if isinstance(given, str):
        checks.choice(given, "samples", ("all", "none"))
        every = 1 if given == "all" else 0
    else:
        every = checks.whole(given, "samples", least=1)
    several = grid.records if every and len(grid.records) > 1 else ()
    if len(np.unique([step for one in several for step in one.pieces.steps])) > 1:
        raise InputError(
            "samples",
            f'must be "none" for records with different steps, which have no common times; got {given!r}',
        )
    return every


def history(
    system: System,
    record: Record | Sequence[Record],
    beta: ArrayLike | None = None,
    mu: ArrayLike = 1.0,
    *,
    scale: ArrayLike = 1.0,
    units: Units | None = None,
    start: str | Mapping[str, Any] | xr.Dataset = "rest",
    after: str | float = "rest",
    samples: str | int = "all",
    beta_hold: bool = True,
    statistics: Mapping[str, Any] | None = None,
    axes: Mapping[str, Any] | None = None,
    threads: int | None = None,
    progress: Progress | None = None,
    watch: Watch | None = None,
) -> xr.Dataset:
    """Follow motions in time under records: histories, peaks, events, energies, place of rest.

    Between samples and events everything is linear, so that motions are exact to rounding.

    Parameters
    ----------
    system : System
        Its load is not used; with excitation "base" and damping_reference "ground" the damping acts on
        absolute velocities.
    record : Record or sequence of Record
        Load, or motion of the base, over time; masses then move relative to the base.
    beta : array_like
        Ratios of kinetic friction force to P [-], >= 0, increasing; default 1.
    mu : array_like
        Ratios of static to kinetic friction [-], >= 1, increasing.
    scale : array_like
        Factors of the records, increasing.
    units : Units, optional
        Reference values that convert times to seconds and friction to newtons.  A record with a unit needs
        the natural frequency.  Where nothing states P, P/m_1 is 1 m/s^2.  `beta` may then be forces, or
        accelerations of friction over m_1: "0.05 g".
    start : "rest", mapping, Dataset or path
        ``{"x": [...], "v": [...]}``: displacements and velocities of the masses; of a structure given by
        modes also `q` and `q_rate`, those of the modes; or the last state of a `history`, or the state at
        tau = 0 of a `response`, taken relative to its base.
    after : "rest" or float
        How long the motion is followed after the record, without load: until no contact can move again,
        which is proved by the energy, or a time, in seconds for records with a unit.
    samples : "all", int or "none"
        Which samples of the histories are kept: all, every so many, none.  A single motion has both sides of
        all events, too.
    beta_hold : bool
        Whether the friction from which nothing moves is found, too: a further motion of every record.  Else
        it is NaN.
    statistics : mapping, optional
        Under stationary loads: mean, variance and peak of every quantity, with errors by batch means, as
        `stationary` finds them over the time of the record from the samples that are kept, or from all if
        none are.  A table of `start`, the time that is left out, `window` of the peak and `batches`; times
        are in seconds for records with units.
    axes : mapping, optional
        Further axes: values of numbers of the system, as of `sweep`.  The motions of all their systems are
        in one dataset, which has these dimensions first, and the samples without the sides of events.
    threads : int, optional
        Number of threads; default: all processors.  The result is equal to the bit for any number.
    progress, watch : callable, optional
        As in `sweep`.

    Returns
    -------
    xarray.Dataset
        Over (record, scale, mu, beta), after the names of `axes`, and (dof, time), (contact, time), (event):
        see the manual.  Points of a structure given by modes take the place of masses; their names are in
        `point_name`.

    Raises
    ------
    InputError
        An argument has the wrong type or is out of range.

    Examples
    --------
    A mass on a spring under a triangular pulse, with friction of a fifth of its peak:

    >>> import frictionmap as fm
    >>> pulse = fm.Record([0.0, 1.0, 0.0], dt=1.0, quantity="force")
    >>> ds = fm.history(fm.System(), pulse, beta=[0.2])
    >>> int(ds.stops.squeeze())
    1
    """
    checks.instance(system, "system", System)
    wanted = Wanted(record, beta, mu, scale, units, start, after, samples, beta_hold, statistics)
    if axes is None:
        return _motions(system, wanted, False, threads, progress, watch)
    variations = checked_variations(system, axes)
    scales_of(units, system, variations)
    coords, found = axis_coordinates(variations), []
    for done, point in enumerate(variations.points()):
        part = part_of_progress(progress, done, variations.count)
        found.append(_motions(variations.at(point), wanted, True, threads, part, watch))
    ds = stacked(found, {axis.name: axis.size for axis in variations.axes}).assign_coords(coords)
    return ds.assign_attrs(title="Motions in time", system=variations.describe())


class Wanted(NamedTuple):
    """Arguments of `history`."""

    record: Any
    beta: Any
    mu: Any
    scale: Any
    units: Units | None
    start: Any
    after: Any
    samples: Any
    beta_hold: Any
    statistics: Any


def _motions(
    system: System, wanted: Wanted, several: bool, threads: int | None, progress: Progress | None,
    watch: Watch | None,
) -> xr.Dataset:  # fmt: skip
    """The motions of one system; several : of one of several, which have common times."""
    scales = motion_scales(wanted.units, system)
    beta = friction_ratios(1.0 if wanted.beta is None else wanted.beta, "beta", scales)
    grid = Grid(
        checked_records(wanted.record, "record"),
        _axis(wanted.scale, "scale"),
        _axis(wanted.mu, "mu", least=1.0),
        _axis(beta, "beta", least=0.0),
    )
    structure = structure_of(system, True)
    refuse_static(structure.system.contact_system, grid.mu)
    averages = asked_averages(wanted.statistics, grid.records[0].unit)
    every = _every("all" if averages and wanted.samples == "none" else wanted.samples, grid)
    asked = Asked(start_of(structure, wanted.start), _after(wanted.after), every)
    single = int(np.prod(grid.shape)) == 1 and not several
    if not isinstance(wanted.beta_hold, bool):
        raise InputError("beta_hold", f"must be true or false; got {checks.one_line(wanted.beta_hold)}")
    holds = wanted.beta_hold and not asked.start.moves
    found = _follow(structure, grid, scales, asked, (single, holds), threads, progress, watch)
    variables, coords = _labelled(structure, grid, asked, found, single)
    attrs = {
        "Conventions": "CF-1.11", "title": "Motion in time" if single else "Motions in time",
        "source": f"frictionmap {__version__}", "references": REFERENCES, "system": system.describe(),
        "excitation": excitation_of(system), "history": f"{now()} frictionmap.history",
        **record_attributes(structure.system, grid.records),
        **{name: one for kind, name in SCALES.items() if (one := scales.of(kind)) is not None},
    }  # fmt: skip
    if averages is not None:
        factors = [scale_of(one, scales).time for one in grid.records]
        variables |= averages_of(xr.Dataset(variables, coords), averages, grid.records, factors)
        attrs["statistics"] = describe_averages(averages)
    if wanted.samples == "none":
        variables = {name: one for name, one in variables.items() if "time" not in one.dims}
        coords.pop("time", None)
    both = in_si(coords | variables, scales)
    coords = {name: both.pop(name) for name in coords}
    return xr.Dataset(both, coords, attrs)


def in_si(found: Mapping[str, xr.Variable], scales: Scales) -> dict[str, xr.Variable]:
    """Times in seconds; lengths, velocities, accelerations, forces and works in SI units beside ratios."""
    frequency, force, length = (scales.of(kind) for kind in ("frequency", "force", "length"))
    ones: dict[str, float] = {}
    if length is not None:
        ones["length"] = length
    if force is not None:
        ones["force"] = force
    if force is not None and length is not None:
        ones["work"] = force * length
    both = dict(found)
    if frequency is not None:
        omega = 2.0 * np.pi * frequency
        if length is not None:
            ones["velocity"], ones["acceleration"] = omega * length, omega * omega * length
        both |= _in_seconds(found, omega)
    ones |= {f"squared {measure}": one * one for measure, one in ones.items()}
    for measure, one in ones.items():
        for name in IN_SI.get(measure, ()):
            if name in found:
                beside = si_name(name, measure)
                values = found[name].values * one
                both[beside] = xr.Variable(found[name].dims, values, attributes(SI_LABELS[beside]))
    return both


def _in_seconds(given: Mapping[str, xr.Variable], omega: float) -> dict[str, xr.Variable]:
    found = {}
    for name in TIMES:
        if name in given:
            meaning = given[name].attrs["long_name"].split(", over")[0]
            attrs = given[name].attrs | {"units": "s", "long_name": meaning}
            found[name] = xr.Variable(given[name].dims, given[name].values / omega, attrs)
    return found


class Followed(NamedTuple):
    """All motions of a grid."""

    motions: list[Motions]  # of every record
    found: np.ndarray  # of Found, the shape of the grid
    hold: np.ndarray | None  # (records, scales, mu, N) static friction that holds every contact, where wanted


def _kind_of(general: ContactSystem) -> tuple[type[Motions], Callable]:
    """What follows the motions of a system, and what finds the friction that holds its contacts."""
    if general.has_banks:
        return BankMotions, holding_friction
    return (OpeningMotions, opening_holding_friction) if general.has_phases else (Motions, holding_friction)


def _follow(
    structure: Structure, grid: Grid, scales: Scales, asked: Asked, wanted: tuple[bool, bool],
    threads: int | None, progress: Progress | None, watch: Watch | None,
) -> Followed:  # fmt: skip
    """Follow all motions; wanted: the states at events, and the forces with all contacts held."""
    general = structure.system.contact_system
    factors = [scale_of(one, scales) for one in grid.records]
    kind, held = _kind_of(general)
    motions = [
        kind(structure, drive_of(structure.system, one, factor))
        for one, factor in zip(grid.records, factors, strict=True)
    ]
    each = [asked._replace(after=asked.after and asked.after * factor.time) for factor in factors]
    found = np.empty(grid.shape, dtype=object)
    single, holds = wanted
    hold = np.empty((*grid.shape[:3], general.count))

    def task(i: int, k: int, m: int, b: int) -> Callable[[], None]:
        def run() -> None:
            found[i, k, m, b] = motions[i].at(grid.beta[b], grid.mu[m], float(grid.scale[k]), each[i], single)

        return run

    def hold_task(i: int) -> Callable[[], None]:
        def run() -> None:
            hold[i] = held(motions[i], grid.scale, grid.mu, each[i])

        return run

    tasks = [task(*index) for index in product(*map(range, grid.shape))]
    tasks += [hold_task(i) for i in range(len(motions)) if holds]
    run_counted([(one, ()) for one in tasks], checks.threads(threads), progress, watch)
    return Followed(motions, found, hold if holds else None)


def _peaks(structure: Structure, motions: Motions, one: Found) -> dict[str, np.ndarray]:
    found = {}
    low, high = one.kept.peaks[0], one.kept.peaks[1]
    for name, largest in _PEAKS.items():
        rows = motions.watched.places[name]
        if rows.stop == rows.start:
            continue
        found[largest] = np.maximum(np.abs(low[rows]), np.abs(high[rows]))
        if name in _BOTH_ENDS:
            found[f"{name}_max"], found[f"{name}_min"] = high[rows], low[rows]
        if name in _TIMED:
            up = np.abs(high[rows]) >= np.abs(low[rows])
            found[f"{largest}_time"] = np.where(up, one.kept.times[1, rows], one.kept.times[0, rows])
    for name in ("base_force", "base_force_max", "base_force_min"):
        if name in found:
            found[name] = found[name][0]
    return found


def _scalars(structure: Structure, motions: Motions, one: Found, asked: Asked) -> dict[str, Any]:
    """Numbers of one motion: of all, of each contact, of each mass."""
    kept, shapes = one.kept, structure.shapes
    elastic = structure.spring > 0.0
    stops = kept.changes[0]
    before, energy = motions.energies_at_ends(one, asked.start)
    q, p = one.state
    walls = float(kept.works[1] + kept.record.works[1].sum())
    rests = one.place is not None
    turn = structure.given_modes
    modal = {} if structure.points is None else {"modal_place": turn @ q, "modal_velocity": turn @ p}
    return _peaks(structure, motions, one) | motions.further_scalars(one) | modal | {
        "residual": motions.places(one) if rests else np.full(len(shapes), np.nan),
        "contact_residual": motions.contact_places(one) if rests else np.full(elastic.size, np.nan),
        "stops": np.where(elastic, np.nan, stops), "slips": np.where(elastic, stops, np.nan),
        "turns": kept.changes[2],
        "stuck_fraction": np.minimum(one.counts[2] / one.end, 1.0) if one.end else 1.0 + 0.0 * stops,
        "sliding_distance": kept.record.distance, "largest_slide": kept.slides[1],
        "work_load": kept.works[0], "work_friction": kept.record.works[0], "work_walls": walls,
        "work_damping": kept.works[0] + walls - kept.record.works[0].sum() - (energy - before),
        "energy": energy, "events": kept.counts[0], "end_time": one.end,
        "asleep_time": one.asleep,
        "first_motion": kept.first[0], "status": one.status,
    }  # fmt: skip


def _traces(structure: Structure, motions: Motions, one: Found, energies: bool) -> dict[str, np.ndarray]:
    """Histories of one motion: (..., time); energies : whether there are both sides of all events."""
    m, contacts = structure.modal.chi.shape[1], structure.spring.size
    states = one.kept.states[: one.kept.counts[1]].T
    columns = states[1:]
    places = motions.watched.places
    values = motions.watched.weights @ columns
    z, f = values[places["z"]], columns[2 * m : 2 * m + contacts]
    kt = structure.own_springs[:, np.newaxis]
    with np.errstate(divide="ignore", invalid="ignore"):
        slider = np.where(kt > 0.0, z - f / kt, np.nan)
    if energies:
        still = np.where(kt > 0.0, slider, z)
        found = motions.energies(one, states, still)
    else:
        found = {}
    moving = {}
    if not structure.softer:  # else velocities of points jump
        moving = {"v": structure.shapes @ columns[m : 2 * m], "acceleration": values[places["acceleration"]]}
    found |= {
        "time": states[0], "x": values[places["x"]], **moving, "z": z, "friction": f,
        "direction": one.kept.senses[: one.kept.counts[1]].T, "y": slider,
        "drive": columns[-motions.problem.push.shape[1]],
    }  # fmt: skip
    return found | motions.further_traces(one, values)


def _stacked(values: list[np.ndarray], shape: tuple[int, ...], fill: float) -> np.ndarray:
    """Arrays of all motions as one; the last dimension is padded."""
    longest = max(value.shape[-1] for value in values)
    padded = [
        np.concatenate((value, np.full((*value.shape[:-1], longest - value.shape[-1]), fill)), axis=-1)
        for value in values
    ]
    return np.array(padded).reshape((*shape, *padded[0].shape))


def _variable(name: str, values: np.ndarray, contacts: int) -> xr.Variable:
    label = MOTIONS[name]
    dims = list(label.dims)
    if name in OF_CONTACTS:
        at = 4
        if contacts == 1:
            values = values.reshape((*values.shape[:at], *values.shape[at + 1 :]))
        else:
            dims.insert(at, "contact")
    return xr.Variable(dims, values.astype(label.dtype), attributes(label))


def _hold(structure: Structure, grid: Grid, forces: np.ndarray) -> np.ndarray:
    """beta from which no contact ever moves, (records, scales, mu)."""
    found = np.zeros(grid.shape[:3])
    for j, group in enumerate(structure.system.contact_system.groups):
        for m, mu in enumerate(grid.mu):
            _, fixed = group.friction(0.0, mu)
            _, one = group.friction(1.0, mu)
            needed = forces[:, :, m, j] - fixed
            endless = np.where(np.isnan(needed), np.nan, np.inf)
            own = np.where(needed <= 0.0, 0.0, needed / (one - fixed) if one > fixed else endless)
            found[:, :, m] = np.maximum(found[:, :, m], own)
    return found


_Variables = dict[str, xr.Variable]


def _labelled(
    structure: Structure, grid: Grid, asked: Asked, followed: Followed, single: bool
) -> tuple[_Variables, _Variables]:
    """Variables and coordinates; single : the energies of one motion over time, too."""
    general = structure.system.contact_system
    contacts, elastic = general.count, general.elastic
    cells = list(product(*map(range, grid.shape)))
    ones = [(followed.motions[cell[0]], followed.found[cell]) for cell in cells]
    table = [_scalars(structure, motions, one, asked) for motions, one in ones]
    variables = {}
    for name in table[0]:
        if (name == "slips" and not elastic.any()) or (name == "stops" and elastic.all()):
            continue
        values = np.array([row[name] for row in table], dtype=float)
        variables[name] = _variable(name, values.reshape((*grid.shape, *values.shape[1:])), contacts)
    coords = _coordinates(structure, grid)
    if asked.every:
        traces = [_traces(structure, motions, one, single) for motions, one in ones]
        longest = max(traces, key=lambda trace: trace["time"].size)
        coords["time"] = xr.Variable("time", longest["time"], attributes(MOTIONS["time"]))
        for name in traces[0]:
            if name == "time" or (name == "y" and not elastic.any()):
                continue
            fill = 0.0 if name == "direction" else np.nan
            stacked = _stacked([trace[name] for trace in traces], grid.shape, fill)
            variables[name] = _variable(name, stacked, contacts)
        variables["drive"].attrs["long_name"] = _drive_words(grid.records)
    variables |= _events([one for _, one in ones], grid.shape)
    hold = np.full(grid.shape[:3], np.nan)
    if followed.hold is not None:
        hold = _hold(structure, grid, followed.hold)
    variables["beta_hold"] = xr.Variable(MOTIONS["beta_hold"].dims, hold, attributes(MOTIONS["beta_hold"]))
    return variables, coords


def _drive_words(records: Sequence[Record]) -> str:
    """What the records are: forces, or accelerations of the base; both if there are both."""
    found = {DRIVES["force" if one.quantity == "force" else "base"] for one in records}
    return found.pop() if len(found) == 1 else MOTIONS["drive"].long_name


def _events(ones: list[Found], shape: tuple[int, ...]) -> dict[str, xr.Variable]:
    tables = [one.kept.events[: one.kept.counts[0]] for one in ones]
    times = _stacked([table[:, 0] for table in tables], shape, np.nan)
    numbers = _stacked([table[:, 1] + 1.0 for table in tables], shape, 0.0)
    kinds = _stacked([table[:, 2] for table in tables], shape, -1.0)
    return {
        name: _variable(name, values, 1)
        for name, values in (("event_time", times), ("event_contact", numbers), ("event_kind", kinds))
    }


def _coordinates(structure: Structure, grid: Grid) -> dict[str, xr.Variable]:
    general = structure.system.contact_system
    own: dict[str, Any] = {
        "record": np.arange(1, len(grid.records) + 1), "scale": grid.scale, "mu": grid.mu,
        "beta": grid.beta, "dof": np.array(structure.system.dofs.numbers),
    }  # fmt: skip
    if structure.points is not None:
        own["point_name"] = np.array(structure.system.dofs.written_labels, dtype=np.str_)
    if general.springs:
        own |= {name: one.values for name, one in spring_coordinates(structure.system).items()}
    if general.has_banks:
        counts = [group.element_count for group in general.groups]
        own["element_contact"] = np.repeat(np.arange(1, general.count + 1), counts)
    names = [one.name or one.quantity for one in grid.records]
    own["record_name"] = np.array(names, dtype=np.str_)
    if general.count > 1:
        own["contact"] = np.arange(1, general.count + 1)
        own["contact_name"] = np.array([group.name for group in general.groups], dtype=np.str_)
    found = {}
    for name, values in own.items():
        attrs = attributes(MOTIONS[name])
        if MOTIONS[name].dtype is np.str_:
            attrs.pop("units")
        found[name] = xr.Variable(MOTIONS[name].dims, values, attrs)
    return found
