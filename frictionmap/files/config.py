"""Configuration files (TOML): read, overridden, checked key by key."""

import os
import re
import tomllib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from decimal import ROUND_CEILING, Decimal
from fractions import Fraction
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

import numpy as np

from .. import checks
from ..datasets.provenance import to_toml
from ..errors import InputError, naming
from ..model.periodic_load import WAVEFORMS
from ..model.sectors import in_full
from ..model.settings import (
    BORDERS,
    GENERAL_OUTPUTS,
    OUTPUTS,
    CurveSettings,
    Solver,
    curve_settings,
    unknown_output,
)
from ..model.system import System
from ..model.variations import Variations, checked_variations
from ..no_load.belts import belts_of, is_phases
from ..units.axes import KINDS, Ladder, grid_ratios, needs
from ..units.dimensions import axes_in_ratios, chain_in_ratios, in_ratios, wanted_axes
from ..units.scales import Scales, Units, Wanted, rounded, scales_of
from .keys import AXES, KEYS, names
from .variants import put_variants

#: Values of one axis; more are surely a slip of the keyboard, and would not fit in memory with the others.
_MOST_VALUES = checks.MOST_CELLS

#: Keys by table; those of [axes] are named by keys of [system].
_SECTIONS: dict[str, tuple[str, ...] | None] = {
    "title": (),
    **{section: names(section) for section in KEYS if section},
    "axes": None,
}
#: Keys of contacts that [system] has not.
_OF_CONTACTS = ("kind", "ratio", "stiffness", "law", "law_file", "normal")
#: Key of [grid] in the place of beta: friction over the normal force of [units].
_COEFFICIENT = "friction_coefficient"
#: Key of [grid] in the place of r: belt speeds without a load.
_SPEED = "wall_speed"

_AXIS_KEYS = ("start", "stop", "step", "num", "values")
#: Ways to give an axis exclude each other: on the command line, a key takes the place of these.
_RIVALS = {
    "start": ("values",),
    "stop": ("values",),
    "step": ("num", "values"),
    "num": ("step", "values"),
    "values": ("start", "stop", "step", "num"),
}
#: What tomllib raises; its own error is a ValueError, and so is that of a number with thousands of digits.
_NOT_TOML = (ValueError, RecursionError)


T = TypeVar("T")


@dataclass(frozen=True)
class Config:
    """A checked configuration."""

    title: str
    system: System
    r: np.ndarray
    beta: np.ndarray
    mu: np.ndarray
    solver: Solver
    curves: CurveSettings
    text: str  # the TOML text used, overrides applied
    name: str  # of the file, without its ending
    variations: Variations | None = None  # along further axes
    files: tuple[Path, ...] = ()  # that it was read from
    units: Units | None = None  # what r = 1 and beta = 1 are
    borders: bool = False  # whether borders between numbers of stops are asked for
    wall_speed: np.ndarray | None = None  # in the place of r, which is empty, without a load

    def refuse_belt(self, what: str) -> None:
        """Refuse a grid of belt speeds; `what`: words after "cannot", such as "compute response curves"."""
        if self.wall_speed is not None:
            raise InputError(
                f"cannot {what} over grid.wall_speed: this is offered under loads; give grid.r instead"
            )


#: Called with the numbers of values of mu, r and beta and of points along further axes, the system and the
#: settings, before the axes are made.
Room = Callable[[Mapping[str, int], System, Solver, CurveSettings, Units | None], None]


def _fits(counts: Mapping[str, int], *_: object) -> None:
    checks.cells(counts["mu"], counts["r"], counts["beta"], points=counts["points"])


#: Tables that have no meaning without a load.
_OF_LOADS = ("solver", "curves", "axes")


def load_config(path: str | Path, overrides: Sequence[str] = (), room: Room | None = None) -> Config:
    """Read a configuration file and apply overrides such as ``grid.r.step=0.01``.

    A path in it, also one of an override, is relative to the folder of the file.  `room` may refuse a grid
    before memory is allocated; by default it refuses too many cells.

    Raises
    ------
    InputError
        The file cannot be read or is not TOML; a key is unknown, missing, of the wrong type or out of
        range.  The message names the key.

    Examples
    --------
    >>> import os
    >>> import tempfile
    >>> from pathlib import Path
    >>> import frictionmap as fm
    >>> path = Path(tempfile.mkdtemp()) / "map.toml"
    >>> lines = ["[system]", "[grid]", "r = { start = 0.0, stop = 2.0, step = 0.1 }", "beta = [0.2, 0.4]"]
    >>> _ = path.write_text(os.linesep.join(lines))
    >>> fm.load_config(path, ["grid.r.step=0.5"]).r
    array([0. , 0.5, 1. , 1.5, 2. ])
    """
    tree, text = read_tree(path, overrides)
    files = put_variants(tree.get("axes"), Path(path).parent)
    config = _check(tree, to_toml(tree) if files else text, Path(path), room)
    return replace(config, files=(*config.files, *files))


def config_of(text: str, system: Mapping[str, object]) -> Config:
    """Check a configuration given as text; `system` replaces keys of its table.

    Raises
    ------
    InputError
        It is none, or its matrices are in a file: one of that name may lie here, and be another.
    """
    tree = parse(text)
    tree["system"] = {**tree.get("system", {}), **system}
    in_files = _matrix_files(_system_table(tree, Path()))
    if in_files:
        raise InputError(
            f"cannot use system.matrices: they are in a file, {in_files[0]}; give them as arrays"
        )
    return _check(tree, text, Path("config"), lambda *_: None)


def read_tree(path: str | Path, overrides: Sequence[str] = ()) -> tuple[dict, str]:
    """The tables of a configuration file, overrides applied, and its text; its keys are not checked.

    Raises
    ------
    InputError
        The file cannot be read or is not TOML, or an override makes no sense.
    """
    if not isinstance(path, (str, os.PathLike)):
        raise InputError(f"configuration must be the path of a TOML file; got {checks.one_line(path)}")
    if isinstance(overrides, str) or not isinstance(overrides, Sequence):
        raise InputError(
            f"overrides must be a list such as ['grid.r.step=0.01']; got {checks.one_line(overrides)}"
        )
    path = Path(path)
    try:
        text = path.read_bytes().decode("utf-8-sig")  # some editors put a mark at the beginning
    except UnicodeDecodeError:
        results = "results are read by frictionmap plot, info and export"
        advice = results if path.suffix == ".nc" else "save it as UTF-8"
        raise InputError(f"cannot read configuration {path}: it is not text in UTF-8; {advice}") from None
    except (OSError, ValueError) as error:  # a name with a null character is a ValueError
        reason = getattr(error, "strerror", None) or error
        raise InputError(
            f"cannot read configuration {path}: {reason}; give the path of a TOML file"
        ) from None
    with naming(f"configuration {path}"):
        tree = parse(text)
    _override_all(tree, overrides)
    return tree, to_toml(tree) if overrides else text


def parse(text: str) -> dict:
    """Parse the text of a configuration; its keys are not checked."""
    try:
        return tomllib.loads(text)
    except _NOT_TOML as error:
        raise InputError(f"cannot parse as TOML: {error}; {_correction(text, str(error))}") from None


#: Mistakes in a line of TOML, and what to do about them.
_MISTAKES = (
    (re.compile(r"[=\[{,]\s*([+-]?\d+),(\d+)\s*(?=$|[#}\]]|,\s*[A-Za-z])"), "use a decimal point: {0}.{1}"),
    (
        re.compile(r"[=\[,]\s*([+-]?[\d.]+(?:[eE][+-]?\d+)?\s*(?:[A-Za-z\u00b5%][^\s,}\]#\"']*))"),
        'put a number with its unit in quotes: "{0}"',
    ),
    (
        re.compile(r"=\s*(?!(?:true|false|inf|nan)\b)([A-Za-z_][^,}\]#=\"']*?)\s*(?=$|[,}\]#])"),
        'put text in quotes: "{0}"',
    ),
)


def _correction(text: str, error: str) -> str:
    """What to do about text that is not TOML: a frequent mistake in the line that the error names."""
    place = re.search(r"at line (\d+)", error)
    lines = text.splitlines()
    line = lines[int(place[1]) - 1] if place and 0 < int(place[1]) <= len(lines) else ""
    for mistake, remedy in _MISTAKES:
        found = mistake.search(line)
        if found:
            return remedy.format(*found.groups())
    quotes = line.partition("#")[0].count('"') % 2
    return "close the quotation mark" if quotes else "correct the syntax"


def _override_all(tree: dict, overrides: Sequence[str]) -> None:
    """Set the keys of `--set`, in order; none may undo one before it."""
    done: dict[str, str] = {}
    for override in overrides:
        if not isinstance(override, str):
            raise InputError(
                f"overrides must be text such as 'grid.r.step=0.01'; got {checks.one_line(override)}"
            )
        key, value = _key_and_value(override)
        for before, text in done.items():
            if _undoes(key, before):
                raise InputError(
                    f"cannot apply --set {override}: it undoes --set {text}; give one of the two"
                )
        done[key] = override
        _override(tree, key.split("."), value, override)


def _key_and_value(override: str) -> tuple[str, object]:
    """Split an override into dotted key and TOML value; a bare word counts as a string."""
    key, equals, text = override.partition("=")
    parts = [part.strip().strip("\"'") for part in key.split(".")]  # quoted as in the file, or not
    text = text.strip()
    if not equals or not all(parts) or not text:
        raise InputError(f"--set must be KEY=VALUE, such as grid.r.step=0.01; got {override!r}")
    if len(override.splitlines()) > 1:
        raise InputError(f"--set must be one line; got {override!r}")
    try:
        # inside braces nothing is dropped in silence: a comment would hide the closing one
        found = tomllib.loads(f"all = {{ value = {text} }}")
    except _NOT_TOML:
        found = {}
    whole = found.get("all", {})
    only = set(found) == {"all"} and set(whole) == {"value"}
    return ".".join(parts), whole["value"] if only else text


def _undoes(key: str, before: str) -> bool:
    """Whether setting `key` would drop what `before` has set."""
    if f"{before}.".startswith(f"{key}."):
        return True
    axis, _, last = key.rpartition(".")
    return axis.startswith(("grid.", "axes.")) and before in {
        f"{axis}.{rival}" for rival in _RIVALS.get(last, ())
    }


def _override(tree: dict, parts: list[str], value: object, override: str) -> None:
    branch = tree
    for depth, part in enumerate(parts[:-1], start=1):
        branch = branch.setdefault(part, {})
        if not isinstance(branch, dict):
            name = ".".join(parts[:depth])
            raise InputError(
                f"cannot apply --set {override}: {name} is not a table; set {name} itself, now {branch!r}"
            )
    if parts[0] in ("grid", "axes") and len(parts) == 3:
        for rival in _RIVALS.get(parts[-1], ()):
            branch.pop(rival, None)
    branch[parts[-1]] = value


def unknown_key(key: str, section: str, valid: Sequence[str]) -> InputError:
    """Return an error that names an unknown key and the valid ones."""
    name = f"{section}.{key}" if section else key
    hint = checks.nearest(key, valid)
    if "contacts" in valid and key in _OF_CONTACTS:
        hint = " (it is a key of an entry of [[system.contacts]])"
    return InputError(f"unknown key {name!r}{hint}; valid: {', '.join(valid)}")


def names_of_tables() -> tuple[str, ...]:
    """Names of all tables of configurations."""
    return tuple(_SECTIONS)


def checked_table(tree: Mapping[str, object], name: str) -> Mapping[str, Any]:
    """A table of a configuration, its keys checked; its values belong to who asks."""
    return _table(tree, name)


def _table(tree: Mapping[str, object], name: str) -> Mapping[str, object]:
    table = tree.get(name, {})
    if not isinstance(table, Mapping):
        raise InputError(f"{name} must be a table [{name}]; got {table!r}")
    valid = _SECTIONS[name]
    for key in table:
        if valid is not None and key not in valid:
            raise unknown_key(key, name, valid)
    return table


def within(section: str, error: InputError) -> InputError:
    """Return an error about a key of a table, with the table named."""
    return error.renamed(f"{section}.{error.where}") if error.where else InputError(f"[{section}]: {error}")


def _build(kind: Callable[..., T], table: Mapping[str, object], section: str) -> T:
    try:
        return kind(**table)
    except InputError as error:
        raise within(section, error) from None


def _system_table(tree: Mapping[str, object], folder: Path) -> Mapping[str, Any]:
    """The table [system], with `matrices` as seen from the folder of the configuration."""
    table: dict[str, Any] = dict(_table(tree, "system"))
    if isinstance(table.get("load"), list):
        table["load"] = [_load(value, f"system.load[{index}]") for index, value in enumerate(table["load"])]
    for key in ("load_file", "waveform"):
        given = table.get(key)
        if isinstance(given, str) and given and given not in WAVEFORMS:
            table[key] = folder / given
    modes = table.get("modes")
    if isinstance(modes, str) and modes:
        table["modes"] = folder / modes
    elif isinstance(modes, Mapping) and isinstance(modes.get("file"), str):
        table["modes"] = {**modes, "file": folder / modes["file"]}
    if isinstance(table.get("contacts"), list):
        table["contacts"] = [_contact(one, folder) for one in table["contacts"]]
    matrices = table.get("matrices", {})
    if isinstance(matrices, str) and matrices:
        table["matrices"] = folder / matrices
    elif isinstance(matrices, Mapping) and any(isinstance(one, str) for one in matrices.values()):
        table["matrices"] = {
            name: folder / one if isinstance(one, str) and one else one for name, one in matrices.items()
        }
    elif not isinstance(matrices, Mapping):
        raise InputError(
            f"system.matrices must be the path of an .npz file, or a table of arrays M, K and optionally C; "
            f"got {matrices!r}"
        )
    if "sectors" in table:
        return _build(in_full, {"given": table}, "system")
    return table


def _contact(given: Any, folder: Path) -> Any:
    """An entry of contacts, with `law_file` as seen from the folder of the configuration."""
    path = given.get("law_file") if isinstance(given, Mapping) else None
    return {**given, "law_file": folder / path} if isinstance(path, str) and path else given


def _matrix_files(table: Mapping[str, Any]) -> list[Path]:
    """The files that the matrices or modes are in."""
    every: list[Any] = []
    for given in (table.get("matrices"), table.get("modes")):
        every += given.values() if isinstance(given, Mapping) else [given]
    return [one for one in every if isinstance(one, Path)]


def _load(value: object, name: str) -> object:
    """Convert one load: a number, or [real part, imaginary part]."""
    if not isinstance(value, list):
        return value
    if len(value) != 2:
        raise InputError(f"{name} must be a number or [real part, imaginary part]; got {value}")
    return complex(*(checks.number(part, name) for part in value))


def read_system(table: Mapping[str, object], folder: Path) -> System:
    """The system of a table [system] in a configuration in that folder, checked."""
    chain, _ = chain_in_ratios(_system_table({"system": table}, folder), {}, "system")
    return _build(System, chain, "system")


def system_in(text: str) -> System | None:
    """System of a configuration given as text; None if the text does not define all of it.

    Matrices in a file of their own are not looked for.
    """
    try:
        tree = parse(text)
        table = _system_table(tree, Path())
        if "system" not in tree or _matrix_files(table):
            return None
        return _build(System, chain_in_ratios(table, {})[0], "system")
    except InputError:
        return None


class Common(NamedTuple):
    """Tables that all configurations of computations have."""

    title: str
    system: System
    units: Units | None
    files: tuple[Path, ...]  # that the configuration was read from


def common_tables(tree: Mapping[str, object], path: Path, wanted: Sequence[Wanted] = ()) -> Common:
    """Check the names of all tables; read the title, the system and the units.

    wanted : numbers with units outside of [system], for which a missing reference value is named, too

    Raises
    ------
    InputError
        A key is unknown, missing, of the wrong type or out of range.  The message names the key.
    """
    if "data" in tree and "grid" not in tree:
        raise InputError(
            "cannot compute from a configuration with [data]: it describes measured data; "
            "use frictionmap identify"
        )
    for key in tree:
        if key not in _SECTIONS:
            raise unknown_key(key, "", tuple(_SECTIONS))
    title = tree.get("title", path.stem)
    if not isinstance(title, str):
        raise InputError(f"title must be text; got {title!r}")
    if "system" not in tree:
        raise InputError("the configuration must have a table [system]; got none")
    described = _system_table(tree, path.parent)
    given = _table(tree, "units")
    chain, completed = chain_in_ratios(described, given, "system")
    units = _build(Units, completed, "units") if completed else None
    system = _build(System, in_ratios(chain, units, wanted, "system"), "system")
    return Common(title, system, units, (path, *_matrix_files(described)))


def command_for(tree: Mapping[str, object]) -> str:
    """The command that computes from a configuration, by its tables."""
    if "grid" in tree:
        return "map"
    commands = {"data": "identify", "history": "history", "spectrum": "spectrum", "record": "history"}
    return next((command for table, command in commands.items() if table in tree), "map")


def _refuse_motions(tree: Mapping[str, object]) -> None:
    """Refuse a configuration of motions in time, which has no grid of steady states."""
    if (command := command_for(tree)) in ("history", "spectrum"):
        raise InputError(
            "cannot compute steady states from a configuration without [grid]: it describes motions in time; "
            f"use frictionmap {command}"
        )


def _check(tree: Mapping[str, object], text: str, path: Path, room: Room | None) -> Config:
    _refuse_motions(tree)
    wanted = _wanted(tree)
    title, system, units, files = common_tables(tree, path, wanted)
    settings, borders = _without_borders(_table(tree, "solver"))
    _check_outputs(settings.get("outputs"), system)
    solver = _build(Solver, settings, "solver")
    curves = _build(curve_settings, _table(tree, "curves"), "curves")
    design_table(tree)
    scales = scales_of(units, system)
    scales.require(wanted)
    further = further_axes(tree, scales)
    variations = None if further is None else checked_variations(system, further)
    grid = _grid(tree, scales_of(units, system, variations))
    if _SPEED in grid:
        return _belt(tree, text, path, grid, Common(title, system, units, files))
    counts = {key: _count(grid[key], f"grid.{key}") for key in ("mu", "r", "beta")}
    points = 1 if variations is None else variations.count
    (room or _fits)({**counts, "points": points}, system, solver, curves, units)
    axes = {
        key: checks.axis(_values(grid[key], f"grid.{key}"), f"grid.{key}", **bounds)
        for key, bounds in AXES.items()
        if key in counts
    }
    if borders and variations is not None:
        raise InputError(
            "cannot find borders between numbers of stops with [axes]: they are those of one system; "
            "remove [axes] or these outputs"
        )
    try:
        (variations or system).costs(axes["r"])
    except InputError as error:
        raise within("system", error) from None
    return Config(
        title, system, axes["r"], axes["beta"], axes["mu"], solver, curves, text, path.stem, variations,
        files, units, borders,
    )  # fmt: skip


def _check_outputs(outputs: object, system: System) -> None:
    """Refuse unknown outputs, listing those of this system."""
    from ..solvers.choose import valid_outputs

    for name in outputs if isinstance(outputs, list) else ():
        if name not in (*OUTPUTS, *GENERAL_OUTPUTS):
            raise unknown_output(name, valid_outputs(system)).renamed("solver.outputs")


def _belt(
    tree: Mapping[str, object], text: str, path: Path, grid: Mapping[str, Any], common: Common
) -> Config:
    """Check a configuration of belt speeds without a load."""
    for table in _OF_LOADS:
        if table in tree:
            raise InputError("cannot use", f"[{table}]", "with grid.wall_speed: there is no load; remove it")
    axes = {}
    for key in ("mu", _SPEED, "beta"):
        _count(grid[key], f"grid.{key}")
        bounds = AXES[key] if key in KINDS or key == "mu" else {"least": 0.0}
        axes[key] = checks.axis(_values(grid[key], f"grid.{key}"), f"grid.{key}", **bounds)
    checks.cells(axes["mu"].size, axes[_SPEED].size, axes["beta"].size)
    if axes[_SPEED][0] == 0.0:
        raise InputError("grid.wall_speed", "must be > 0 without a load: a belt at rest moves nothing; got 0")
    try:
        belts = belts_of(common.system)
        if is_phases(common.system):
            from ..no_load.opening import given_of

            given_of(common.system, belts)
    except InputError as error:
        raise within("system", error) from None
    return Config(
        common.title, common.system, np.empty(0), axes["beta"], axes["mu"], Solver(), curve_settings(), text,
        path.stem, None, common.files, common.units, wall_speed=axes[_SPEED],
    )  # fmt: skip


def design_table(tree: Mapping[str, object]) -> Mapping[str, object]:
    """The table [design] of a configuration, its keys checked; its values belong to `design`."""
    return _table(tree, "design")


def _without_borders(solver: Mapping[str, object]) -> tuple[dict[str, object], bool]:
    """The table [solver] without outputs that are no variables of cells, and whether there are some."""
    settings, outputs = dict(solver), solver.get("outputs")
    if not isinstance(outputs, list) or not any(name in BORDERS for name in outputs):
        return settings, False
    settings["outputs"] = [name for name in outputs if name not in BORDERS]
    if not settings["outputs"]:
        del settings["outputs"]
    return settings, True


def _wanted(tree: Mapping[str, object]) -> list[Wanted]:
    """The numbers with units of [grid] and [axes]."""
    grid, axes = _table(tree, "grid"), _table(tree, "axes")
    kinds = _kinds(grid)
    found = [one for key, kind in kinds.items() for one in needs(grid.get(key), f"grid.{key}", kind)]
    if _COEFFICIENT in grid:
        found.append(Wanted("coefficient", f"grid.{_COEFFICIENT}", grid[_COEFFICIENT]))
    return [*found, *wanted_axes(axes)]


def _kinds(grid: Mapping[str, object]) -> Mapping[str, str]:
    """Kinds of the axes of [grid] with units: belt speeds take the place of r where there is no load."""
    return {_SPEED: "velocity", "beta": KINDS["beta"]} if _SPEED in grid else KINDS


def _grid(tree: Mapping[str, object], scales: Scales) -> dict[str, Any]:
    """The axes of the table [grid]; those with units as ratios."""
    grid: dict[str, Any] = {"mu": [1.0], **_table(tree, "grid")}
    if _COEFFICIENT in grid:
        _put_coefficients(grid, scales)
    if _SPEED in grid and "r" in grid:
        raise InputError(
            "cannot use",
            "grid.wall_speed",
            "with grid.r: it takes the place of r where there is no load; omit one; under a load, use "
            "wall_speed in [axes]",
        )
    for key, kind in _kinds(grid).items():
        if key not in grid:
            raise InputError(f"grid.{key} must be a number, a list of numbers or a range; got nothing")
        if isinstance(grid[key], Mapping):
            _check_form(grid[key], f"grid.{key}")
        grid[key] = grid_ratios(grid[key], f"grid.{key}", kind, scales)
    return grid


def _put_coefficients(grid: dict[str, Any], scales: Scales) -> None:
    """Put friction ratios mu N/P in the place of friction coefficients, each rounded once."""
    name, given = f"grid.{_COEFFICIENT}", grid.pop(_COEFFICIENT)
    if "beta" in grid:
        raise InputError("cannot use", name, "with grid.beta: both are the friction; omit one")
    if isinstance(given, Mapping):
        _check_form(given, name)
    _count(given, name)
    values = checks.axis(_values(given, name), name, least=0.0)
    one = scales.needed("coefficient", name, given)
    grid["beta"] = [rounded(Fraction(Decimal(repr(value))) / one) for value in values.tolist()]


def further_axes(tree: Mapping[str, object], scales: Scales) -> dict[str, Any] | None:
    """The table [axes] as `sweep` takes it, in ratios; None without it.

    Numbers, or for a dimension of several keys a mapping of them.
    """
    if "axes" not in tree:
        return None
    axes: dict[str, Any] = {}
    for key, given in axes_in_ratios(_table(tree, "axes"), scales).items():
        if isinstance(given, Ladder):
            axes[key] = given.values()
        elif not isinstance(given, Mapping) or set(given) & set(_AXIS_KEYS):
            _count(given, f"axes.{key}")
            axes[key] = _values(given, f"axes.{key}")
        else:
            axes[key] = {name: _listed(values, f"axes.{key}.{name}") for name, values in given.items()}
    return axes


def _listed(values: object, name: str) -> object:
    _count_list(values, name)
    return values


def _is_number(value: object) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def _check_form(axis: Mapping[str, object], name: str) -> None:
    """Refuse an axis table with missing or contradictory keys."""
    for key in axis:
        if key not in _AXIS_KEYS:
            raise unknown_key(key, name, _AXIS_KEYS)
    valid = "{ start, stop, step }, { start, stop, num } or { values }"
    keys = set(axis)
    if keys not in ({"values"}, {"start", "stop", "step"}, {"start", "stop", "num"}):
        raise InputError(f"{name} must be {valid}; got {', '.join(axis) or 'nothing'}")


def _check_range(axis: Mapping[str, object], name: str) -> None:
    """Refuse an invalid range."""
    start = checks.number(axis["start"], f"{name}.start")
    stop = checks.number(axis["stop"], f"{name}.stop")
    if stop < start:
        raise InputError(f"{name}.stop must be >= start ({start:g}); got {stop:g}")
    if "step" in axis:
        checks.number(axis["step"], f"{name}.step", above=0.0)
    elif checks.whole(axis["num"], f"{name}.num", least=1, most=_MOST_VALUES) == 1 and stop > start:
        raise InputError(f"{name}.num must be >= 2 to hold both {start:g} and {stop:g}; got 1")


def _steps(axis: Mapping[str, object], name: str) -> int:
    """Number of steps from start to stop, the last one shorter if need be; in decimal, as typed."""
    start, stop, step = (Decimal(repr(axis[key])) for key in ("start", "stop", "step"))
    count = (stop - start) / step
    if count >= _MOST_VALUES:
        raise InputError(
            f"{name}.step must leave at most {_MOST_VALUES:.0e} values; "
            f"got {axis['step']!r}, which makes {float(count) + 1:.3g}"
        )
    return int(count.to_integral_value(ROUND_CEILING))


def _count(axis: object, name: str) -> int:
    """Number of values of an axis, before memory is allocated."""
    if isinstance(axis, Ladder):
        return axis.count
    if isinstance(axis, Mapping):
        _check_form(axis, name)
        if "values" in axis:
            return _count_list(axis["values"], f"{name}.values")
        _check_range(axis, name)
        return _steps(axis, name) + 1 if "step" in axis else int(axis["num"])
    if isinstance(axis, list):
        return _count_list(axis, name)
    if _is_number(axis):
        checks.number(axis, name)
        return 1
    raise InputError(f"{name} must be a number, a list of numbers or a table; got {axis!r}")


def _count_list(values: object, name: str) -> int:
    if not isinstance(values, list):
        raise InputError(f"{name} must be a list of numbers; got {values!r}")
    for index, value in enumerate(values):
        checks.number(value, f"{name}[{index}]")
    return len(values)


def _values(axis: object, name: str) -> object:
    """The values of an axis that `_count` has accepted."""
    if isinstance(axis, Ladder):
        return axis.values()
    if not isinstance(axis, Mapping):
        return axis
    if "values" in axis:
        return axis["values"]
    if "num" in axis:
        return np.linspace(float(axis["start"]), float(axis["stop"]), int(axis["num"]))
    start, step = (Decimal(repr(axis[key])) for key in ("start", "step"))
    values = _decimal_steps(start, step, _steps(axis, name))
    values[-1] = axis["stop"]  # both ends are included
    return values


def _decimal_steps(start: Decimal, step: Decimal, count: int) -> np.ndarray:
    """start + k step, k = 0..count, as the doubles next to the decimal numbers.

    So 35 steps of 0.02 are 0.7, and a tie with a boundary is the one that was meant.
    """
    places = max(0, *(-int(number.as_tuple().exponent) for number in (start, step)))
    unit = 10**places
    first, increment = int(start * unit), int(step * unit)
    if places <= 22 and abs(first) + increment * count < 2**53:  # then the division rounds once
        return (first + increment * np.arange(count + 1)) / float(unit)
    return np.array([float(start + k * step) for k in range(count + 1)])
