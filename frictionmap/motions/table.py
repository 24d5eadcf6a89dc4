"""The table [record] of a configuration: files, or a pulse, a sweep, or random records.

file = "elcentro.at2", files = "suite/*.AT2", pulse = { kind = "ricker", amplitude = "0.4 g",
duration = "2 s" }, sweep = { from, to, duration, law, .. }, or generate = { kind, duration, dt, seed, .. }.
"""

from collections.abc import Callable, Mapping, Sequence
from glob import glob
from pathlib import Path
from typing import Any

from .. import checks
from ..errors import InputError
from ..files.config import unknown_key
from ..files.keys import names
from .densities import KEYS as OF_DENSITIES
from .record import Record

#: Where records come from; exactly one of them.
SOURCES = ("file", "files", "pulse", "sweep", "generate")

#: Keys of these tables.
_OF_PULSE = ("kind", "amplitude", "duration", "rise")
_OF_SWEEP = ("from", "to", "duration", "law", "amplitude", "rise", "fall")
_OF_GENERATE = (
    "kind", "duration", "dt", "seed", "count", "level", "rms", "peak", "envelope", *OF_DENSITIES,
)  # fmt: skip

#: Keys beside each source: what is said of any record, and what only of files or of samples.
_COMMON = ("quantity", "unit", "mass", "vector")
_BESIDE = {
    "file": (*_COMMON, "interpolation", "dt", "baseline", "decimal", "columns"),
    "files": (*_COMMON, "interpolation", "dt", "baseline", "decimal", "columns"),
    "pulse": _COMMON,
    "sweep": _COMMON,
    "generate": (*_COMMON, "interpolation", "baseline"),
}

#: Names of arguments of `Record.sweep` whose keys are other words.
_SWEEP_NAMES = {"from": "start", "to": "stop"}


def records_of(table: Mapping[str, Any], folder: Path) -> tuple[tuple[Record, ...], tuple[Path, ...]]:
    """Records of a table [record], and the files that they were read from.

    table : without `scale` and `after`, which say how motions are followed
    folder : that paths are relative to

    Raises
    ------
    InputError
        A key is unknown, missing, of the wrong type or out of range; the message names it.
    """
    for key in table:
        if key not in names("record"):
            raise unknown_key(key, "record", names("record"))
    given = [source for source in SOURCES if source in table]
    if not given:
        raise InputError("file", f"must be given, or one of {', '.join(SOURCES[1:])}; got none of them")
    if len(given) > 1:
        raise InputError("cannot use", given[1], f"with {given[0]}: both give records; omit one")
    source = given[0]
    beside = {key: value for key, value in table.items() if key not in (source, "peak")}
    for key in beside:
        if key not in _BESIDE[source]:
            raise InputError("cannot use", key, f"with {source}: it does not apply to it; omit it")
    if "unit" not in beside and source in ("pulse", "sweep", "generate"):
        beside |= _unit_of(table[source], table)
    found, files = _SOURCES[source](table[source], beside, folder)
    if "peak" in table:
        _check_peak(table, found)
        found = [record.scaled_to(table["peak"]) for record in found]
    return tuple(found), files


def _check_peak(table: Mapping[str, Any], found: Sequence[Record]) -> None:
    """Refuse a peak without a unit where the files, not the table, state the unit."""
    unit, peak = found[0].unit, table["peak"]
    of_file = "unit" not in table and ("file" in table or "files" in table)
    if of_file and unit is not None and not isinstance(peak, str):
        given = checks.one_line(peak)
        raise InputError(
            "peak", f"must have a unit, such as '{given} {unit}', beside a file in {unit}; got {given}"
        )


def _unit_of(source: Any, table: Mapping[str, Any]) -> dict[str, str]:
    """The unit of a size that has one, such as that of peak = "0.4 g"."""
    given = {**table, **source} if isinstance(source, Mapping) else table
    for key in ("amplitude", "rms", "peak"):
        words = str(given.get(key, "")).split()
        if isinstance(given.get(key), str) and len(words) == 2:
            return {"unit": words[1]}
    return {}


_Found = tuple[list[Record], tuple[Path, ...]]


def _file(given: Any, beside: Mapping[str, Any], folder: Path) -> _Found:
    return _read([_path(given, "file", folder)], beside)


def _files(given: Any, beside: Mapping[str, Any], folder: Path) -> _Found:
    if isinstance(given, str):
        paths = sorted(folder / name for name in glob(given, root_dir=folder, recursive=True))
        if not paths:
            raise InputError(
                "files",
                f"must be a pattern that matches files in {folder}, such as 'suite/*.AT2'; got {given!r}",
            )
        return _read(paths, beside)
    if not isinstance(given, list) or not given:
        raise InputError("files", f"must be a pattern or a list of paths; got {checks.one_line(given)}")
    return _read([_path(one, f"files[{k}]", folder) for k, one in enumerate(given)], beside)


def _path(given: Any, name: str, folder: Path) -> Path:
    if not isinstance(given, str) or not given:
        raise InputError(name, f"must be the path of a file; got {checks.one_line(given)}")
    return folder / given


def _read(paths: Sequence[Path], beside: Mapping[str, Any]) -> _Found:
    return [Record.read(path, **beside) for path in paths], tuple(paths)


def _pulse(given: Any, beside: Mapping[str, Any], _folder: Path) -> _Found:
    arguments = {"amplitude": 1.0, **_arguments(given, "pulse", _OF_PULSE, ("kind", "duration"))}
    return [_named("pulse", {}, Record.pulse, arguments, beside)], ()


def _sweep(given: Any, beside: Mapping[str, Any], _folder: Path) -> _Found:
    arguments = {
        _SWEEP_NAMES.get(key, key): value
        for key, value in _arguments(given, "sweep", _OF_SWEEP, ("from", "to", "duration")).items()
    }
    return [_named("sweep", _SWEEP_NAMES, Record.sweep, arguments, beside)], ()


def _generate(given: Any, beside: Mapping[str, Any], _folder: Path) -> _Found:
    arguments = _arguments(given, "generate", _OF_GENERATE, ("kind", "duration", "dt"))
    return _named("generate", {}, Record.generate, arguments, beside), ()


_SOURCES: dict[str, Callable[[Any, Mapping[str, Any], Path], _Found]] = {
    "file": _file,
    "files": _files,
    "pulse": _pulse,
    "sweep": _sweep,
    "generate": _generate,
}


def _arguments(given: Any, name: str, valid: Sequence[str], needed: Sequence[str]) -> dict[str, Any]:
    """The keys of a table within [record]."""
    if not isinstance(given, Mapping):
        raise InputError(name, f"must be a table of {', '.join(valid)}; got {checks.one_line(given)}")
    for key in given:
        if key not in valid:
            raise unknown_key(key, f"record.{name}", valid)
    for key in needed:
        if key not in given:
            raise InputError(f"{name}.{key}", "must be given; got nothing")
    return dict(given)


def _named(
    name: str, renamed: Mapping[str, str], make: Callable[..., Any], arguments: Mapping[str, Any],
    beside: Mapping[str, Any],
) -> Any:  # fmt: skip
    """The records that a method makes; errors name keys of the table."""
    keys = {argument: key for key, argument in renamed.items()}
    try:
        return make(**arguments, **beside)
    except InputError as error:
        if error.where not in arguments:
            raise
        raise error.renamed(f"{name}.{keys.get(error.where, error.where)}") from None
