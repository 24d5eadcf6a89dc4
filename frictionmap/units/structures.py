"""Beams, plates and modes of a table [system]: numbers with units in SI units."""

from collections.abc import Mapping
from dataclasses import fields
from typing import Any

from .. import checks
from ..errors import InputError
from ..structures.uniform import Beam, Plate
from .axes import has_units
from .quantities import is_foreign, quantity
from .scales import MODEL_HAS, OF_MODEL, rounded
from .table import PI

#: Tables of [system] that define a structure, what makes it, and what their keys measure.
STRUCTURES: dict[str, tuple[type[Beam] | type[Plate], dict[str, str]]] = {
    "beam": (
        Beam,
        {
            "length": "length", "bending_stiffness": "bending stiffness",
            "mass_per_length": "mass per length", "E": "modulus", "width": "length", "height": "length",
            "diameter": "length", "density": "density", "points": "length", "end_springs": "stiffness",
            "end_masses": "mass",
        },
    ),
    "plate": (
        Plate,
        {
            "size": "length", "thickness": "length", "bending_stiffness": "plate stiffness",
            "mass_per_area": "mass per area", "E": "modulus", "density": "density", "points": "length",
        },
    ),
}  # fmt: skip


def keys_of(name: str) -> tuple[str, ...]:
    """The keys of a table [system.beam] or [system.plate]."""
    return tuple(field.name for field in fields(STRUCTURES[name][0]))


def _plain(value: Any, name: str, kind: str) -> Any:
    """A number with a unit in SI units; lists and tables of them; plain numbers as they are."""
    if isinstance(value, Mapping):
        return {key: _plain(one, f"{name}.{key}", kind) for key, one in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(one, f"{name}[{k}]", kind) for k, one in enumerate(value)]
    if not isinstance(value, str) and not is_foreign(value):
        return value
    return rounded(quantity(value, name, kind).value)


def _built(table: Any, name: str, key: str) -> Beam | Plate:
    """The beam or plate of a table."""
    if not isinstance(table, Mapping):
        raise InputError(f"{name}.{key}", f"must be a table [{name}.{key}]; got {checks.one_line(table)}")
    kind, measures = STRUCTURES[key]
    valid = keys_of(key)
    for own in table:
        if own not in valid:
            hint = checks.nearest(own, valid)
            raise InputError(f"unknown key '{name}.{key}.{own}'{hint}; valid: {', '.join(valid)}")
    plain = {
        own: _plain(value, f"{name}.{key}.{own}", measures[own]) if own in measures else value
        for own, value in table.items()
    }
    try:
        return kind(**plain)
    except InputError as error:
        raise error.renamed(f"{name}.{key}.{error.where}" if error.where else f"{name}.{key}") from None


def structure_as_modes(table: Mapping[str, Any], name: str) -> dict[str, Any]:
    """A table [system] with `modes` in the place of a beam or plate, and its frequencies in rad/s.

    name : of the table, for messages
    """
    changed = dict(table)
    given = [key for key in (*STRUCTURES, "modes", "matrices") if key in table]
    if len(given) > 1:
        raise InputError(
            "cannot use", f"{name}.{given[0]}", f"with {given[1]}: both define the structure; omit one"
        )
    for key in STRUCTURES:
        if key in table:
            changed["modes"] = _built(changed.pop(key), name, key)
    modes = changed.get("modes")
    if isinstance(modes, Mapping) and isinstance(modes.get("frequencies"), (list, tuple)):
        changed["modes"] = {**modes, "frequencies": _rates(modes["frequencies"], f"{name}.modes.frequencies")}
    return changed


def _rates(frequencies: Any, name: str) -> list[Any]:
    """Frequencies [rad/s]; plain numbers as they are."""
    return [
        rounded(2 * PI * quantity(one, f"{name}[{k}]", "frequency").value) if isinstance(one, str) else one
        for k, one in enumerate(frequencies)
    ]


def with_model_units(table: Mapping[str, Any], units: Mapping[str, Any]) -> dict[str, Any]:
    """Keys of [units]; frequency and stiffness of a structure given by modes are its own, in SI units.

    Without keys it is in SI units if a contact or another number beside the modes has a unit.
    """
    if "modes" not in table or "mass" in units or not (units or any(map(has_units, table.values()))):
        return dict(units)
    return {**dict.fromkeys(MODEL_HAS, OF_MODEL), **units}
