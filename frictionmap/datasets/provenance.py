"""Provenance of a dataset: its history, and the configuration that reproduces it."""

import json
import math
import re
from collections.abc import Mapping
from dataclasses import asdict, fields
from datetime import UTC, datetime
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from ..model.contact import WALLS
from ..model.general import contacts_of
from ..model.matrices import Matrices
from ..structures.modes import OF_BASE, Modes

if TYPE_CHECKING:
    from ..model.contact import Contact
    from ..model.normal_contact import NormalForce
    from ..model.settings import Solver
    from ..model.spring_element import Spring
    from ..model.system import System
    from ..structures.dofs import Dofs
    from ..units.scales import Units

#: Larger axes and matrices are not written as text, but named in a comment.
_MOST_VALUES = 10_000
_MOST_MASSES = 64

#: Where a system keeps its lines, beside its cached properties.
_LINES = "_lines_of_configuration"

#: Keys of [system] and their default values.
_SYSTEM = {
    "contact": None,
    "contact_masses": (1,),
    "load_mass": 1,
    "loads": None,
    "mass_ratios": (1.0,),
    "stiffness_ratios": (1.0,),
    "damping_ratios": None,
    "dampers": None,
    "rayleigh": None,
    "decouple": None,
    "frequency_scale": None,
    "stiffness_scale": 1.0,
    "excitation": "force",
    "damping_reference": "ground",
    "base_control": "displacement",
}


def excitation_of(system: "System") -> str:
    """Global attribute `excitation`: "base", "force" on one mass, or "forces", one on each with its phase."""
    return "forces" if system.load is not None else str(system.excitation)


def now() -> str:
    """Present time in the format of a history."""
    return datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%SZ")


def made_by(
    function: str,
    title: str,
    system: "System",
    axes: Mapping[str, np.ndarray | float],
    solver: "Solver | None" = None,
    curves: Mapping[str, object] | None = None,
    study: Mapping[str, object] | None = None,
    units: "Units | None" = None,
) -> dict[str, str]:
    """Global attributes `history` and `config` of a computed dataset; see `configuration`."""
    call = ", ".join(f"{name} = {_format_axis(np.atleast_1d(values))}" for name, values in axes.items())
    return {
        "history": f"{now()} frictionmap.{function} of {system.contact}, {call}",
        "config": configuration(title, system, axes, solver, curves, study, units=units),
    }


def configuration(
    title: str,
    system: "System",
    axes: Mapping[str, np.ndarray | float],
    solver: "Solver | None" = None,
    curves: Mapping[str, object] | None = None,
    study: Mapping[str, object] | None = None,
    matrices: str = "",
    units: "Units | None" = None,
) -> str:
    """Write a configuration from which `load_config` builds the same system, axes and settings, to the bit.

    matrices : file with the matrices of the system; without it, data too large for text become comments, as
    do settings that the function does not use
    """
    most = float("inf") if matrices else _MOST_VALUES
    lines = [f"title = {quoted(title)}", "", "[system]", *_kept_system_lines(system, matrices), ""]
    if units is not None:
        lines += ["[units]", *(f"{key} = {quoted(text)}" for key, text in units.given.items()), ""]
    lines.append("[grid]")
    lines += [_axis_line(name, np.atleast_1d(values), most) for name, values in axes.items()]
    if "beta" not in axes:
        lines.append("beta = 1.0  # boundaries need none")
    if solver is not None:
        lines += ["", "[solver]", *_solver_lines(solver)]
    if curves is not None:
        lines += ["", "[curves]", *(f"{key} = {value_text(value)}" for key, value in curves.items())]
    if study is not None:
        lines += ["", "[axes]", *(f"{_key(key)} = {value_text(value)}" for key, value in study.items())]
    return "\n".join(lines) + "\n"


@lru_cache(maxsize=16)
def _solver_lines(solver: "Solver") -> tuple[str, ...]:
    return tuple(f"{key} = {value_text(value)}" for key, value in asdict(solver).items())


def _format_axis(values: np.ndarray) -> str:
    """Format the values of an axis: up to three of them, or the range."""
    if values.size <= 3:
        return ", ".join(f"{value:g}" for value in values.tolist())
    return f"{values[0]:g} to {values[-1]:g} ({values.size} values)"


def _axis_line(name: str, values: np.ndarray, most: float) -> str:
    start, stop, num = float(values[0]), float(values[-1]), values.size
    if num > 3 and np.array_equal(np.linspace(start, stop, num), values):
        return f"{name} = {{ start = {start!r}, stop = {stop!r}, num = {num} }}"
    if num > most:
        return f"# {name} = {num} values from {start!r} to {stop!r}, those of the axis {name}"
    return f"{name} = {value_text(values.tolist())}"


def _kept_system_lines(system: "System", matrices: str) -> list[str]:
    """The table [system]; without a file it is kept with the system, which does not change."""
    if matrices:
        return _system_lines(system, matrices)
    kept = vars(system)
    if _LINES not in kept:
        kept[_LINES] = _system_lines(system, "")
    found: list[str] = kept[_LINES]
    return found


def system_text(system: "System") -> str:
    """Write the table [system] of a configuration for this system."""
    return "\n".join(["[system]", *_system_lines(system, "")]) + "\n"


def _system_lines(system: "System", file: str) -> list[str]:
    matrices = system.matrices
    own = {key: getattr(system, key) for key in _SYSTEM} | _contacts_and_loads(system)
    own["load"] = own.pop("loads")  # for a reduced structure, on the remaining masses
    if system.reduction is not None:  # r refers to the full structure, not to the matrices below
        own["frequency_scale"] = system.omega_1
    lines = [
        f"{key} = {value_text(value)}" for key, value in own.items() if value not in (None, _SYSTEM.get(key))
    ]
    if system.reduction is not None:
        asked = system.reduction.asked._asdict()
        lines.append(f"# reduced from {system.reduction.structure.n}: reduce = {value_text(asked)}")
    if isinstance(matrices, Modes):
        return [*lines, _modes_line(matrices)]
    if not isinstance(matrices, Matrices):
        return lines
    if file:
        return [*lines, f"matrices = {quoted(file)}"]
    if matrices.n > _MOST_MASSES:
        return [*lines, f"# matrices = {matrices.n} by {matrices.n}, too large to be put here"]
    table = {name: array.tolist() for name, array in matrices.arrays.items()}
    return [*lines, f"matrices = {value_text(table)}"]


def _modes_line(modes: Modes) -> str:
    """Modes as a table in one line, or a comment where it would be too large."""
    count = modes.shapes.size
    if count > _MOST_VALUES:
        return f"# modes = {modes.w.size} at {len(modes.points)} points, too large to be put here"
    table = {"frequencies": modes.w.tolist(), "points": list(modes.points), "shapes": modes.shapes.tolist()}
    if modes.residual is not None:
        table["residual"] = modes.residual.tolist()
    table |= {name: own.tolist() for name in OF_BASE if (own := getattr(modes, name)) is not None}
    return f"modes = {value_text({**table, 'normalised': 'mass'})}"


def _contacts_and_loads(system: "System") -> dict[str, object]:
    """Keys of [system] for springs, belts, normal loads, several contacts and several harmonics."""
    found: dict[str, object] = {}
    if system.contacts is not None:
        found |= {"contact": None, "contact_masses": (1,)}
        found["contacts"] = [_contact_keys(one, system.dofs) for one in contacts_of(system)]
    else:
        one = _contact_keys(contacts_of(system)[0], system.dofs)
        found["contact_stiffness"] = one.get("stiffness")
        found |= {name: one.get(name) for name in WALLS}
        found["normal_load"] = one.get("normal_load")
    if any(getattr(system, name) is not None for name in ("load_harmonics", "load_file", "waveform")):
        numbers = system.dofs.numbers
        entries = [
            {"n": n, "mass": int(numbers[row]), "re": value.real, "im": value.imag}
            for n, vector in system.contact_system.loads.items()
            for row, value in enumerate(vector.tolist())
            if value != 0.0
        ]
        entries += [{"n": n, "re": u.real, "im": u.imag} for n, u in system.contact_system.base.items()]
        found |= {"load_harmonics": entries, "load_mass": 1}
    if system.load_offset is not None:
        found["load_offset"] = system.contact_system.constant_loads.tolist()
    if system.springs is not None:
        found["springs"] = [_spring_keys(one, system.dofs) for one in system.springs]  # type: ignore[arg-type]
    return found


def _spring_keys(spring: "Spring", dofs: "Dofs") -> dict[str, object]:
    """A piecewise linear spring as an entry of system.springs; its masses by their numbers."""
    found = _given_keys(spring)
    return found | {"masses": [dofs.number(one, "masses") for one in spring.masses]}  # type: ignore[union-attr]


def _normal_keys(normal: "NormalForce", dofs: "Dofs") -> dict[str, object]:
    """A normal force as the table of a contact; its masses by their numbers."""
    found = _given_keys(normal)
    if normal.mass is not None:
        found["mass"] = dofs.number(normal.mass, "mass")
    if normal.masses is not None:
        found["masses"] = [dofs.number(one, "masses") for one in normal.masses]
    return found


def _given_keys(one: Any) -> dict[str, object]:
    """The fields of a description that are not None; lists as such."""
    own = {field.name: getattr(one, field.name) for field in fields(one)}
    return {
        key: list(value) if isinstance(value, tuple) else value
        for key, value in own.items()
        if value is not None
    }


def _contact_keys(contact: "Contact", dofs: "Dofs") -> dict[str, object]:
    """A contact as an entry of system.contacts, without defaults; its masses by their numbers."""
    given: tuple = contact.masses  # type: ignore[assignment]
    masses = [dofs.number(one, "masses") for one in given]
    own = {key: getattr(contact, key) for key in ("ratio", "force", "mu", "stiffness", "bank", *WALLS)}
    own = {"name": contact.label if masses != list(given) else contact.name, **own}
    own = {key: list(value) if isinstance(value, tuple) else value for key, value in own.items()}
    normal = [{"n": n, "re": value.real, "im": value.imag} for n, value in contact.nu.items()]
    found = {"kind": contact.kind, "masses": masses, **own, "normal_load": normal or None}
    if contact.law is not None:
        found["law"] = contact.law.as_keys()
    if contact.normal is not None:
        found["normal"] = _normal_keys(contact.normal, dofs)
    return {
        key: value
        for key, value in found.items()
        if value not in (None, 0.0) or (key == "force" and value == 0.0)
    }


def quoted(text: str) -> str:
    """Write text as a TOML basic string: JSON has the same escapes except for the delete character."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def _key(name: str) -> str:
    """Write a key, in quotes where TOML requires them."""
    return name if re.fullmatch("[A-Za-z0-9_-]+", name) else quoted(name)


def value_text(item: object) -> str:
    """Write a value as TOML; a complex number becomes [real part, imaginary part]."""
    if isinstance(item, bool):
        return "true" if item else "false"
    if isinstance(item, str):
        return quoted(item)
    if isinstance(item, complex):
        real = item.imag == 0.0 and math.copysign(1.0, item.imag) > 0.0  # -1 - 0i has a different angle
        return value_text(item.real if real else [item.real, item.imag])
    if isinstance(item, (list, tuple)):
        return "[" + ", ".join(value_text(element) for element in item) + "]"
    if isinstance(item, Mapping):
        return "{ " + ", ".join(f"{_key(key)} = {value_text(v)}" for key, v in item.items()) + " }"
    return repr(item)


def to_toml(tree: Mapping[str, object]) -> str:
    """Write a configuration tree as TOML text."""
    lines = [f"{_key(key)} = {value_text(v)}" for key, v in tree.items() if not isinstance(v, Mapping)]
    for name, table in tree.items():
        if isinstance(table, Mapping):
            lines += ["", f"[{name}]"]
            lines += [f"{_key(key)} = {value_text(v)}" for key, v in table.items()]
    return "\n".join(lines) + "\n"
