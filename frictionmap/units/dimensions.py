"""Keys of [system] that have a dimension: the table of them, and their conversion to ratios.

A chain in kilograms and newtons per millimetre defines what r = 1 is: its first mass and its first spring go
to `Units`.  All other numbers become ratios to the reference values of `Scales`, each rounded once.
"""

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

from .. import checks
from ..errors import InputError
from ..model.contact import CONTACTS, WALLS, without_wall
from ..model.general import ACCELERATION
from ..model.spring_element import Spring
from ..model.system import System
from .axes import grid_ratios, has_units, needs
from .quantities import EXAMPLES, Quantity, is_foreign, quantities, quantity
from .scales import (
    NO_SCALES,
    OF_MODEL,
    Scales,
    Units,
    Wanted,
    reference_scales,
    rounded,
)
from .structures import structure_as_modes, with_model_units
from .table import PI

#: Keys of [system] with a dimension, and what they measure.  [] stands for the place in a list; a list of
#: numbers in the place of one is meant, too.
DIMENSIONS = {
    "masses": "mass",
    "springs": "stiffness",
    "dampers": "viscosity",
    "load": "force",
    "load_harmonics[].amplitude": "force",
    "load_harmonics[].re": "force",
    "load_harmonics[].im": "force",
    "load_offset": "force",
    "contact_stiffness": "stiffness",
    "wall_velocity": "velocity",
    "wall_speed": "velocity",
    "contacts[].force": "force",
    "contacts[].stiffness": "stiffness",
    "contacts[].wall_velocity": "velocity",
    "contacts[].wall_speed": "velocity",
    "contacts[].law.speed": "velocity",
    "contacts[].normal.stiffness": "stiffness",
    "contacts[].normal.preload": "force",
    "springs[].gap": "length",
    "springs[].backlash": "length",
    "springs[].stiffness": "stiffness",
    "springs[].displacement": "length",
    "springs[].force": "force",
    "springs[].stiffness_below": "stiffness",
    "springs[].stiffness_above": "stiffness",
}

#: Keys of [design] with a dimension; the limit of a transmitted force is a force.
OF_DESIGN = {"band": "frequency", "r": "frequency", "beta": "force", "limit": "length"}

#: Numbers of matrices, which have the unit of the matrices: their units need matrices in SI units.
OF_MATRICES = {
    "frequency_scale": "frequency",
    "stiffness_scale": "stiffness",
    "rayleigh[1]": "rate",
    "rayleigh[2]": "time",
}

#: Keys of [system] that hold the ratios of a chain.
RATIOS = {"masses": "mass_ratios", "springs": "stiffness_ratios"}

#: Keys of [units] that the first number of a chain is.
FIRST = {"masses": "mass", "springs": "stiffness"}


class _Place(NamedTuple):
    """A number in a table: its key as in `DIMENSIONS`, its name in messages, and what it measures."""

    key: str
    name: str
    kind: str


def kind_of(key: str, in_table: Mapping[str, Any] | None = None) -> str:
    """What a key of [system] measures; empty if it has no dimension.

    in_table : the table that the key is in: an entry of load_harmonics without a mass moves the base
    """
    found = DIMENSIONS.get(key) or OF_MATRICES.get(key) or ""
    if key.startswith("load_harmonics") and "mass" not in (in_table or {}):
        return "length" if found else ""
    return found


def kinds_of(key: str) -> tuple[str, ...]:
    """What a key of [system] may measure; nothing if it has no dimension."""
    return tuple(dict.fromkeys(filter(None, (kind_of(key, {"mass": 1}), kind_of(key)))))


def _changed(
    value: Any, key: str, name: str, change: Callable[[Any, _Place], Any], inside: Any = None,
    every: bool = False,
) -> Any:  # fmt: skip
    """A copy of a table in which the numbers with units are changed, or every one with a dimension.

    inside : the table that the number is in
    """
    if isinstance(value, Mapping):
        return {
            part: _changed(one, f"{key}.{part}".lstrip("."), f"{name}.{part}".lstrip("."), change, value)
            for part, one in value.items()
        }
    if isinstance(value, (list, tuple)):
        places = [
            (one, _within(key, k) if isinstance(one, Mapping) or not kind_of(key, inside) else key)
            for k, one in enumerate(value, 1)
        ]
        first = int(key in ("contacts", "springs"))  # counted as in the messages of `System`
        every = has_units(value)  # then all of them must have one
        return [
            _changed(one, own, f"{name}[{k}]", change, inside, every)
            for k, (one, own) in enumerate(places, first)
        ]
    kind = kind_of(key, inside)
    return change(value, _Place(key, name, kind)) if kind and (every or has_units(value)) else value


def _within(key: str, k: int) -> str:
    """Key of entry k of a list, counted from 1."""
    return f"{key}[{k}]" if f"{key}[{k}]" in OF_MATRICES else f"{key}[]"


@dataclass(frozen=True)
class _Model:
    """What matrices in SI units define, from a table [system]."""

    table: Mapping[str, Any]

    @property
    def stiffness_scale(self) -> float:
        """Stiffness that displacements are over [N/m]."""
        given = self.table.get("stiffness_scale")
        return self._system.stiffness_scale if given is None else checks.number(given, "stiffness_scale")

    @property
    def omega_1(self) -> float:
        """Frequency at r = 1 [rad/s]."""
        given = self.table.get("frequency_scale")
        if given is not None:
            return checks.number(given, "frequency_scale", above=0.0)
        return self._system.omega_1

    @cached_property
    def _system(self) -> System:
        """The system with other numbers than those with units."""
        return System(**_changed(self.table, "", "", lambda value, place: 1.0))


def in_ratios(
    table: Mapping[str, Any], units: Units | None, wanted: Sequence[Wanted] = (), name: str = ""
) -> dict[str, Any]:
    """Convert a table [system] to arguments of `System`: numbers with units become ratios.

    wanted : further numbers with units, for which a missing reference value is named, too
    name : of the table, for messages

    Raises
    ------
    InputError
        A number has no unit of its kind, or a reference value is missing: all of them are named.
    """
    if units is not None and units.constant_acceleration:
        table = {"base_control": ACCELERATION, **table}
    if not any(has_units(value) for value in table.values()):
        return dict(table)
    _refuse_walls(table, name)
    plain = _with_speeds(_plain_matrix_numbers(table, units, name))
    given: list[Wanted] = []

    def note(value: Any, place: _Place) -> None:
        (quantities if is_foreign(value) else quantity)(value, place.name, place.kind)
        given.append(Wanted(place.kind, place.name, value))

    _changed(plain, "", name, note)
    if not given:
        return plain
    scales = NO_SCALES if units is None else reference_scales(units, _Model(plain))
    scales.require([*wanted, *given])
    return dict(_changed(plain, "", name, lambda value, place: _ratio(value, place, scales)))


def _refuse_walls(table: Mapping[str, Any], name: str) -> None:
    """Refuse a wall that moves with a unit, of contacts that have none, before its unit is converted."""
    contacts = table.get("contacts")
    several = contacts if isinstance(contacts, (list, tuple)) else ()
    named = [(f"{name}.contacts[{k}].", one, one.get("kind")) for k, one in enumerate(several, 1)
             if isinstance(one, Mapping)]  # fmt: skip
    for place, one, kind in ((f"{name}.", table, table.get("contact")), *named):
        for wall in WALLS:
            if has_units(one.get(wall)) and kind in CONTACTS and kind != "fixed-wall":
                raise without_wall(kind, f"{place}{wall}".lstrip("."), checks.one_line(one[wall]))


def _with_speeds(table: Mapping[str, Any]) -> dict[str, Any]:
    """Wall velocities with units are speeds that are the same at all frequencies."""
    found = dict(table)
    if has_units(found.get("wall_velocity")) and "wall_speed" not in found:
        found["wall_speed"] = found.pop("wall_velocity")
    contacts = found.get("contacts")
    if isinstance(contacts, (list, tuple)):
        found["contacts"] = [_with_speeds(one) if isinstance(one, Mapping) else one for one in contacts]
    return found


def _is_several(value: Any) -> bool:
    """Whether a quantity of another package is an array."""
    return len(getattr(value, "shape", ())) > 0


def _ratio(value: Any, place: _Place, scales: Scales) -> Any:
    """The ratio of a number; several of an array with units."""
    one = scales.needed(place.kind, place.name, value)
    if is_foreign(value):
        found = [rounded(number / one) for number in quantities(value, place.name, place.kind) or ()]
        return found if len(found) != 1 or _is_several(value) else found[0]
    return rounded(quantity(value, place.name, place.kind).value / one)


def is_of_elements(springs: Any) -> bool:
    """Whether the key `springs` has piecewise linear springs, which are tables, and not those of a chain."""
    listed = isinstance(springs, (list, tuple)) and len(springs) > 0
    return listed and all(isinstance(one, (Mapping, Spring)) for one in springs)


def _refuse_elements(springs: Sequence[Any], name: str) -> None:
    """Refuse tables among the springs of a chain."""
    for one in springs:
        if isinstance(one, (Mapping, Spring)):
            raise InputError(
                name,
                "must be stiffnesses of a chain or tables of piecewise linear springs, not both; got "
                f"{checks.one_line(springs)}; give the chain by stiffness_ratios and units.stiffness",
            )


def chain_in_ratios(
    table: Mapping[str, Any], units: Mapping[str, Any], name: str = ""
) -> tuple[dict[str, Any], dict[str, Any]]:
    """Put the ratios of a chain in the place of its masses and springs, the first of which go to the units.

    table : keys of [system]; units : keys of `Units`; name : of the table, for messages
    """
    changed = structure_as_modes(table, name or "system")
    completed = with_model_units(changed, units)
    springs = table.get("springs")
    if isinstance(springs, (list, tuple)) and not is_of_elements(springs):
        _refuse_elements(springs, f"{name}.springs".lstrip("."))
    given = [own for own in RATIOS if own in table and not is_of_elements(table[own])]
    for own in given:
        where, key = f"{name}.{own}".lstrip("."), RATIOS[own]
        if key in table:
            raise InputError(
                "cannot use", f"{name}.{key}".lstrip("."), f"with {own}: both define the chain; omit one"
            )
        follows = [FIRST[own], *(["natural_frequency"] if len(given) == len(RATIOS) else [])]
        for rival in follows:
            if rival in units:
                raise InputError("cannot use", f"units.{rival}", f"with {where}: it follows; omit it")
        values = _positive(changed.pop(own), where, DIMENSIONS[own])
        completed[FIRST[own]] = values[0].text
        changed[key] = [rounded(one.value / values[0].value) for one in values]
    if len(given) == len(RATIOS) and len({len(changed[RATIOS[own]]) for own in given}) > 1:
        count = len(changed[RATIOS["masses"]])
        raise InputError(
            f"{name}.springs".lstrip("."),
            f"must have as many values as masses ({count}); got {len(changed[RATIOS['springs']])}",
        )
    return changed, completed


def _positive(values: Any, name: str, kind: str) -> list[Quantity]:
    """A list of numbers with units, > 0."""
    if is_foreign(values) and _is_several(values):
        values = list(values)
    if not isinstance(values, (list, tuple)) or not values:
        raise InputError(
            name,
            f"must be a list of numbers with a unit of {kind}, such as ['{EXAMPLES[kind]}']; "
            f"got {checks.one_line(values)}",
        )
    found = [quantity(value, f"{name}[{k}]", kind) for k, value in enumerate(values)]
    for k, one in enumerate(found):
        if one.value <= 0:
            raise InputError(f"{name}[{k}]", f"must be > 0; got {one.text}")
    return found


def _plain_matrix_numbers(table: Mapping[str, Any], units: Units | None, name: str) -> dict[str, Any]:
    """Numbers of matrices in SI units as plain numbers."""

    def plain(value: Any, place: _Place) -> Any:
        if place.key not in OF_MATRICES:
            return value
        needed = "stiffness" if place.kind == "stiffness" else "natural_frequency"
        if units is None or getattr(units, needed) != OF_MODEL:
            raise InputError(
                place.name,
                f"must be a number in the units of the matrices, or they must be in SI units, which "
                f'units.{needed} = "model" states; got {checks.one_line(value)}',
            )
        found = quantity(value, place.name, place.kind).value
        return rounded(found * 2 * PI if place.kind == "frequency" else found)

    return dict(_changed(table, "", name, plain))


#: Keys of a range, which columns of numbers that vary together do not have.
_OF_RANGE = ("start", "stop", "values")

_INDEX = re.compile(r"\[[1-9][0-9]*\]")


def _axis_key(name: str) -> tuple[str, str]:
    """Key of an axis as in `DIMENSIONS`, and the name of the axis in ratios."""
    key = _INDEX.sub("[]", name)
    listed = key.removesuffix("[]")
    own = listed if listed in DIMENSIONS else key
    return own, name.replace(own, RATIOS[own], 1) if own in RATIOS else name


def axis_kind(name: str) -> str:
    """What the values of a further axis measure; empty if they have no unit."""
    own, _ = _axis_key(name)
    return "" if own in OF_MATRICES else kind_of(own)


def axes_in_ratios(axes: Any, scales: Scales) -> Any:
    """Convert the values of further axes with units to ratios; others are returned unchanged.

    Raises
    ------
    InputError
        A number has no unit of its kind, or a reference value is missing: all of them are named.
    """
    if not isinstance(axes, Mapping):
        return axes
    scales.require(list(wanted_axes(axes)))
    found: dict[str, Any] = {}
    for name, values in axes.items():
        if isinstance(values, Mapping) and not axis_kind(str(name)) and set(values).isdisjoint(_OF_RANGE):
            found[name] = _columns_in_ratios(values, f"axes.{name}", scales)
        else:
            key = _varied_key(str(name), values)
            found[_axis_key(key)[1]] = _axis_ratios(values, key, f"axes.{name}", scales)
    return found


def _columns_in_ratios(columns: Mapping[str, Any], name: str, scales: Scales) -> dict[str, Any]:
    """Convert the numbers of an axis that vary together."""
    found: dict[str, Any] = {}
    for given, column in columns.items():
        key = _varied_key(str(given), column)
        ratio = _axis_key(key)[1]
        if ratio in found:
            raise InputError(
                "cannot use", f"{name}.{given}", f"beside another {ratio}: both give the same axis; omit one"
            )
        found[ratio] = _axis_ratios(column, key, f"{name}.{given}", scales)
    return found


def _varied_key(key: str, values: Any) -> str:
    """The key that values vary: wall velocities with units are speeds, the same at all frequencies."""
    is_speed = axis_kind(key) == "velocity" and has_units(values)
    return key.replace("wall_velocity", "wall_speed") if is_speed else key


def _axis_ratios(values: Any, key: str, name: str, scales: Scales) -> Any:
    own, _ = _axis_key(key)
    if own in RATIOS:
        if key.endswith("[1]"):
            raise InputError(
                "cannot use", f"axis {key}", f": the others are over the first one of {own}; vary another one"
            )
        if not has_units(values):
            raise InputError(
                name, f"must be numbers with a unit of {kind_of(own)}; got {checks.one_line(values)}"
            )
    kind = axis_kind(key)
    return grid_ratios(values, name, kind, scales) if kind else values


def wanted_axes(axes: Mapping[str, Any]) -> Iterator[Wanted]:
    """The numbers with units of further axes."""
    for name, values in axes.items():
        kind = axis_kind(str(name))
        if kind:
            yield from needs(values, f"axes.{name}", kind)
        elif isinstance(values, Mapping):
            for key, column in values.items():
                if axis_kind(str(key)):
                    yield from needs(column, f"axes.{name}.{key}", axis_kind(str(key)))


def system_in_units(units: Units | None = None, **keys: Any) -> tuple[System, Units | None]:
    """Make a system from numbers with units.

    Parameters
    ----------
    units : Units, optional
        Reference values; the masses and springs of a chain add theirs.
    **keys
        Arguments of `System`, with numbers or with texts such as "800 N/mm" or quantities of pint, astropy or
        unyt; and masses and springs of a chain instead of their ratios.  Contacts are mappings.

    Returns
    -------
    system, units : the system in ratios, and the units to be given with it

    Raises
    ------
    InputError
        A number has no unit of its kind, or a reference value is missing: all of them are named.

    Examples
    --------
    >>> import frictionmap as fm
    >>> system, units = fm.system_in_units(
    ...     fm.Units(load="100 N"), masses=["40 kg", "20 kg"], springs=["500 N/mm", "250 N/mm"],
    ...     contacts=[{"kind": "fixed-wall", "masses": [2], "stiffness": "1 kN/mm"}],
    ... )
    >>> system.mass_ratios, system.contacts[0].stiffness, units.stiffness
    ((1.0, 0.5), 2.0, '500 N/mm')
    """
    if units is not None:
        checks.instance(units, "units", Units)
    table, completed = chain_in_ratios(keys, {} if units is None else units.given)
    found = Units(**completed) if completed else None
    return System(**in_ratios(table, found)), found
