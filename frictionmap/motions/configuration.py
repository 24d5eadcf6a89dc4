"""The tables [record], [history] and [spectrum] of a configuration."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from .. import checks
from ..errors import InputError
from ..files.config import (
    checked_table,
    common_tables,
    further_axes,
    names_of_tables,
    read_tree,
    unknown_key,
    within,
)
from ..files.variants import put_variants
from ..jobs import Progress
from ..model.general import refuse_modes
from ..model.system import System
from ..model.variations import checked_variations
from ..units.quantities import quantities
from ..units.scales import NO_SCALES, Units
from .bounds import interpolation_bounds
from .dataset import history
from .further_axes import spectra_along
from .record import Record
from .scaling import motion_scales
from .spectra import VARIABLES, Asked, at_once, checked_spectra
from .table import records_of

#: Keys of [record] that say how motions are followed, not what the records are.
_OF_MOTIONS = ("scale", "after")


@dataclass(frozen=True)
class Motions:
    """Motions in time that a configuration describes."""

    title: str
    name: str  # of the file, without its ending
    text: str  # the TOML text used, overrides applied
    files: tuple[Path, ...]
    system: System
    units: Units | None
    records: tuple[Record, ...]
    arguments: Mapping[str, Any]  # of `history`
    friction: str  # the key of beta in the configuration

    def follow(self, records: Sequence[Record] | None = None, **options: Any) -> xr.Dataset:
        """Follow the motions, or those under other records and with other arguments; errors name keys."""
        arguments = {**self.arguments, **options}
        try:
            return history(
                self.system, self.records if records is None else records, units=self.units, **arguments
            )
        except InputError as error:
            where = error.where.partition("[")[0].partition(".")[0]
            if where == "axes":
                raise
            table = "record" if where in _OF_MOTIONS else "history"
            given = where in (*_OF_MOTIONS, *self.arguments)
            if where == "beta":
                error = error.renamed(self.friction + error.where.removeprefix("beta"))
            raise (within(table, error) if given else error) from None


@dataclass(frozen=True)
class Task:
    """A configuration of motions in time."""

    title: str
    name: str  # of the file, without its ending
    text: str  # the TOML text used, overrides applied
    files: tuple[Path, ...]
    motions: int  # how many
    ask: Callable[..., xr.Dataset]
    #: of spectra: the oscillators, for a store, and the names of the wanted variables
    asked: Callable[[], Asked] | None = None
    wanted: tuple[str, ...] | None = None


def _records(tree: Mapping[str, Any], path: Path) -> tuple[tuple[Record, ...], tuple[Path, ...]]:
    """The records of a configuration, and the files that they were read from."""
    if "record" not in tree:
        raise InputError("the configuration must have a table [record]; got none")
    given = checked_table(tree, "record")
    try:
        return records_of({k: v for k, v in given.items() if k not in _OF_MOTIONS}, path.parent)
    except InputError as error:
        raise (within("record", error) if error.where else error) from None


def _under_one_name(given: dict[str, Any], table: str, name: str, other: str) -> str:
    """Put the friction under the name that a function takes; return that which the table has."""
    if other in given:
        if name in given:
            raise InputError(
                "cannot use", f"{table}.{other}", f"with {table}.{name}: both are the friction; omit one"
            )
        given[name] = given.pop(other)
        return other
    return name


def _count(*axes: object) -> int:
    found = 1
    for axis in axes:
        found *= len(axis) if isinstance(axis, list) else 1
    return found


def load_history(path: str | Path, overrides: Sequence[str] = ()) -> Task:
    """Read a configuration of motions in time as a task.

    Raises
    ------
    InputError
        See `load_motions`.
    """
    found = load_motions(path, overrides)
    axes = found.arguments.get("axes")
    count = len(found.records) * _count(*(found.arguments.get(name) for name in ("scale", "beta", "mu")))
    count *= 1 if axes is None else checked_variations(found.system, axes).count

    def ask(**options: Any) -> xr.Dataset:
        ds = found.follow(**options)
        if axes is not None:
            return ds
        return ds.assign_attrs(_interpolation_bound(ds, found.system, found.records, found.units))

    return Task(found.title, found.name, found.text, found.files, count, ask)


def load_motions(path: str | Path, overrides: Sequence[str] = ()) -> Motions:
    """Read a configuration of motions in time; [grid] is not used.

    Raises
    ------
    InputError
        The file cannot be read or is not TOML; a key is unknown, missing or of the wrong type.
    """
    path = Path(path)
    tree, text = read_tree(path, overrides)
    varied = put_variants(tree.get("axes"), path.parent)
    common = common_tables(tree, path)
    records, files = _records(tree, path)
    given, record = dict(checked_table(tree, "history")), checked_table(tree, "record")
    arguments = {name: record[name] for name in _OF_MOTIONS if name in record}
    friction = _under_one_name(given, "history", "beta", "friction")
    start = given.get("start")
    if isinstance(start, str) and start != "rest":
        given["start"] = str(path.parent / start)
        files = (*files, path.parent / start)
    arguments |= given
    axes = further_axes(tree, motion_scales(common.units, common.system))
    arguments |= {} if axes is None else {"axes": axes}
    files = (*files, *varied)
    return Motions(
        common.title,
        path.stem,
        text,
        (*common.files, *files),
        common.system,
        common.units,
        records,
        arguments,
        friction,
    )


def load_spectrum(path: str | Path, overrides: Sequence[str] = ()) -> Task:
    """Read a configuration of friction response spectra; of [system] only the damping is used.

    Raises
    ------
    InputError
        The file cannot be read or is not TOML; a key is unknown, missing or of the wrong type.
    """
    path = Path(path)
    tree, text = read_tree(path, overrides)
    title = tree.get("title", path.stem)
    if not isinstance(title, str):
        raise InputError(f"title must be text; got {title!r}")
    records, files = _records(tree, path)
    given, record = dict(checked_table(tree, "spectrum")), checked_table(tree, "record")
    _under_one_name(given, "spectrum", "friction", "beta")
    for key in ("period", "friction"):
        if key not in given:
            raise InputError(f"spectrum.{key}", "must be given; got nothing")
    try:
        given["period"] = _periods(given["period"])
        given["friction"] = _values(given["friction"], "friction", "acceleration")
    except InputError as error:
        raise within("spectrum", error) from None
    if "after" in record:
        raise InputError(
            "cannot use", "record.after", "for spectra: motions are followed to their rest; omit it"
        )
    given |= {"scale": record["scale"]} if "scale" in record else {}
    given |= _system_values(tree, path, given)
    wanted = _names(given.pop("quantities", None))
    asked = partial(_spectra, records, given)
    axes = further_axes(tree, NO_SCALES)
    count = len(records) * _count(*(given.get(name) for name in ("scale", "mu", "period", "friction")))
    count *= _count(*(axes or {}).values())
    return Task(
        title, path.stem, text, (path, *files), count, partial(_chosen, asked, wanted, axes),
        None if axes else asked, wanted,
    )  # fmt: skip


def _names(wanted: Sequence[str] | None) -> tuple[str, ...] | None:
    """The variables that are wanted, with their status; None: all."""
    if wanted is None:
        return None
    for name in wanted:
        checks.choice(name, "spectrum.quantities", tuple(VARIABLES))
    return tuple(dict.fromkeys((*wanted, "status")))


def _chosen(
    asked: Callable[..., Asked], wanted: tuple[str, ...] | None, axes: Mapping[str, Any] | None,
    threads: int | None = None, progress: Progress | None = None,
) -> xr.Dataset:  # fmt: skip
    def at_point(progress: Progress | None = None, **point: Any) -> xr.Dataset:
        return at_once(asked(**point), threads, progress)

    ds = at_point(progress) if axes is None else spectra_along(axes, at_point, progress)
    return ds if wanted is None else ds[list(wanted)]


def _system_values(tree: Mapping[str, Any], path: Path, given: Mapping[str, Any]) -> dict[str, Any]:
    """What a table [system] says of the one mass of spectra: damping, and the spring of its contact."""
    for key in tree:
        if key not in names_of_tables():
            raise unknown_key(key, "", names_of_tables())
    if "system" not in tree:
        return {}
    system = common_tables(tree, path).system
    refuse_modes(system, "compute spectra")
    if system.n > 1 or system.contact_system.count > 1:
        raise InputError(
            f"cannot compute spectra of {system.n} masses and {system.contact_system.count} contacts: a "
            "spectrum is of one mass with one contact; use frictionmap history"
        )
    contact = system.contact_system.groups[0].first
    for key, value in (("law", contact.law), ("wall_speed", contact.belt), ("normal_load", contact.nu)):
        if value:
            raise InputError(
                f"cannot compute spectra of a contact with {key}: they are of constant friction at a wall at "
                "rest; use frictionmap history, or omit it"
            )
    ratios: Any = system.damping_ratios
    found: dict[str, Any] = {"damping": ratios[0]}
    stiffness = system.contact_system.groups[0].stiffness
    if stiffness is not None:
        found["contact_stiffness"] = stiffness
    return {name: value for name, value in found.items() if name not in given}


def _values(given: Any, name: str, kind: str) -> Any:
    """A number or a list, of which a range `{ start, stop, num, spacing }` is a short form."""
    if not isinstance(given, Mapping):
        return given
    valid = ("start", "stop", "num", "spacing")
    for key in given:
        if key not in valid:
            raise InputError(f"unknown key {f'spectrum.{name}.{key}'!r}; valid: {', '.join(valid)}")
    for key in ("start", "stop", "num"):
        if key not in given:
            raise InputError(f"{name}.{key}", "must be given; got nothing")
    spacing = checks.choice(given.get("spacing", "linear"), f"{name}.spacing", ("linear", "log"))
    ends = [given["start"], given["stop"]]
    exact = quantities(ends, name, kind)
    ends = ends if exact is None else [float(end) for end in exact]
    least = {"above": 0.0} if kind == "time" else {"least": 0.0}
    start, stop = (
        checks.number(end, f"{name}.{key}", **least) for key, end in zip(valid[:2], ends, strict=True)
    )
    num = checks.whole(given["num"], f"{name}.num", least=2)
    if spacing == "log" and start <= 0.0:
        raise InputError(f"{name}.start", f"must be > 0 with spacing log; got {start:g}")
    values = np.linspace(start, stop, num) if spacing == "linear" else np.geomspace(start, stop, num)
    if exact and kind == "acceleration":
        return [f"{value!r} m/s^2" for value in values.tolist()]
    return values.tolist()


def _periods(given: Any) -> Any:
    """Periods in seconds, or in the unit of time of the records."""
    found = _values(given, "period", "time")
    listed = found if isinstance(found, list) else [found]
    if any(isinstance(one, str) for one in listed):
        return [float(one) for one in quantities(listed, "period", "time") or ()]
    return found


def _spectra(records: tuple[Record, ...], given: Mapping[str, Any], **point: Any) -> Asked:
    """The oscillators that a configuration describes; errors name keys of the tables.

    point : numbers in the place of others
    """
    arguments = {**given, **point}
    period, friction = arguments.pop("period"), arguments.pop("friction")
    try:
        return checked_spectra(records, period, friction, **arguments)
    except InputError as error:
        where = error.where.partition("[")[0]
        raise (within("spectrum", error) if where in given else error) from None


def _interpolation_bound(
    ds: xr.Dataset, system: System, records: tuple[Record, ...], units: Units | None
) -> dict[str, float]:
    """What the interpolation of the records can change in a displacement, where mu = 1 and it has a bound."""
    if (ds["mu"].values != 1.0).any() or system.contact_system.has_phases:
        return {}
    each = [interpolation_bounds(system, record, units=units)["amplitude"].max().item() for record in records]
    length = motion_scales(units, system).of("length") if "amplitude_m" in ds else None
    most = max(each) * float(np.abs(ds["scale"].values).max()) * (1.0 if length is None else length)
    return {"interpolation_bound": most} if np.isfinite(most) else {}
