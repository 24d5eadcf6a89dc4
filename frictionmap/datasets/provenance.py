"""How a dataset came to be: its history, and the configuration that makes it again."""

import json
import math
import re
from collections.abc import Mapping
from dataclasses import asdict
from datetime import UTC, datetime
from typing import TYPE_CHECKING

import numpy as np

from ..model.matrices import Matrices

if TYPE_CHECKING:
    from ..model.settings import Solver
    from ..model.system import System
    from ..units.scales import Units

#: What is larger is not put into text, but named in a comment.
_MOST_VALUES = 10_000
_MOST_MASSES = 64

#: Keys of [system] and the values that they have if they are left out.
_SYSTEM = {
    "contact": None,
    "contact_masses": (1,),
    "load_mass": 1,
    "loads": None,
    "mass_ratios": (1.0,),
    "stiffness_ratios": (1.0,),
    "damping_ratios": None,
    "rayleigh": None,
    "decouple": None,
    "frequency_scale": None,
    "stiffness_scale": 1.0,
    "excitation": "force",
    "damping_reference": "ground",
}


def now() -> str:
    """The time, as a history has it."""
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
    """Global attributes `history` and `config` of what a function computed; see `configuration`."""
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
    """A configuration: read by `load_config` it gives the same system, axes and settings, to the bit.

    matrices : a file that has those of the system; else what is too large for text is a comment, as is what
        a function does not need
    """
    most = float("inf") if matrices else _MOST_VALUES
    lines = [f"title = {quoted(title)}", "", "[system]", *_system_lines(system, matrices), ""]
    if units is not None:
        lines += ["[units]", *(f"{key} = {quoted(text)}" for key, text in units.given.items()), ""]
    lines.append("[grid]")
    lines += [_axis_line(name, np.atleast_1d(values), most) for name, values in axes.items()]
    if "beta" not in axes:
        lines.append("beta = 1.0  # boundaries need none")
    if solver is not None:
        lines += ["", "[solver]", *(f"{key} = {value_text(value)}" for key, value in asdict(solver).items())]
    if curves is not None:
        lines += ["", "[curves]", *(f"{key} = {value_text(value)}" for key, value in curves.items())]
    if study is not None:
        lines += ["", "[axes]", *(f"{_key(key)} = {value_text(value)}" for key, value in study.items())]
    return "\n".join(lines) + "\n"


def _format_axis(values: np.ndarray) -> str:
    if values.size <= 3:
        return ", ".join(f"{value:g}" for value in values)
    return f"{values[0]:g} to {values[-1]:g} ({values.size} values)"


def _axis_line(name: str, values: np.ndarray, most: float) -> str:
    start, stop, num = float(values[0]), float(values[-1]), values.size
    if num > 3 and np.array_equal(np.linspace(start, stop, num), values):
        return f"{name} = {{ start = {start!r}, stop = {stop!r}, num = {num} }}"
    if num > most:
        return f"# {name} = {num} values from {start!r} to {stop!r}, those of the axis {name}"
    return f"{name} = {value_text(values.tolist())}"


def system_text(system: "System") -> str:
    """The table [system] of a configuration that gives this system again."""
    return "\n".join(["[system]", *_system_lines(system, "")]) + "\n"


def _system_lines(system: "System", file: str) -> list[str]:
    matrices = system.matrices
    own = {key: getattr(system, key) for key in _SYSTEM}
    own["load"] = own.pop("loads")  # of a reduced structure those on the masses that are left
    if system.reduction is not None:  # of the whole structure, which the matrices below do not tell
        own["frequency_scale"] = system.omega_1
    lines = [
        f"{key} = {value_text(value)}" for key, value in own.items() if value not in (None, _SYSTEM.get(key))
    ]
    if system.reduction is not None:
        asked = system.reduction.asked._asdict()
        lines.append(f"# reduced from {system.reduction.structure.n}: reduce = {value_text(asked)}")
    if not isinstance(matrices, Matrices):
        return lines
    if file:
        return [*lines, f"matrices = {quoted(file)}"]
    if matrices.n > _MOST_MASSES:
        return [*lines, f"# matrices = {matrices.n} by {matrices.n}, too large to be put here"]
    table = {name: array.tolist() for name, array in matrices.arrays.items()}
    return [*lines, f"matrices = {value_text(table)}"]


def quoted(text: str) -> str:
    """Text as a TOML basic string: JSON has the same escapes, but leaves the delete character."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def _key(name: str) -> str:
    """A key, in quotes if TOML wants them."""
    return name if re.fullmatch("[A-Za-z0-9_-]+", name) else quoted(name)


def value_text(item: object) -> str:
    """A value as TOML; a complex number is [real part, imaginary part]."""
    if isinstance(item, bool):
        return "true" if item else "false"
    if isinstance(item, str):
        return quoted(item)
    if isinstance(item, complex):
        real = item.imag == 0.0 and math.copysign(1.0, item.imag) > 0.0  # -1 - 0i has another angle
        return value_text(item.real if real else [item.real, item.imag])
    if isinstance(item, (list, tuple)):
        return "[" + ", ".join(value_text(element) for element in item) + "]"
    if isinstance(item, Mapping):
        return "{ " + ", ".join(f"{_key(key)} = {value_text(v)}" for key, v in item.items()) + " }"
    return repr(item)


def to_toml(tree: Mapping[str, object]) -> str:
    """A configuration tree as TOML text."""
    lines = [f"{_key(key)} = {value_text(v)}" for key, v in tree.items() if not isinstance(v, Mapping)]
    for name, table in tree.items():
        if isinstance(table, Mapping):
            lines += ["", f"[{name}]"]
            lines += [f"{_key(key)} = {value_text(v)}" for key, v in table.items()]
    return "\n".join(lines) + "\n"
