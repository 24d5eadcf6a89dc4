"""Further axes of a study: parameters of a system that vary, one by one or together.

A parameter is named as in a configuration: ``damping_ratios`` for all modes at once, or one entry of a list,
counted from 1, such as ``stiffness_ratios[2]``; its dimension is then ``stiffness_ratios_2``.
"""

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from .. import checks
from ..errors import InputError
from .system import System

#: Keys that vary as one number, and keys of which one list entry varies, with a description.
NUMBERS = {
    "damping_ratios": "damping ratio of all modes",
    "load_mass": "mass that the load acts on",
    "frequency_scale": "frequency of r = 1, in the units of sqrt(K/M)",
    "stiffness_scale": "stiffness that displacements are over, in the units of K",
    "contact_stiffness": "contact stiffness over k_1",
    "wall_velocity": "velocity of the wall over omega P/k_1",
    "wall_speed": "speed of the wall over omega_1 P/k_1",
}
LISTS = {
    "mass_ratios": "mass ratio m_{0}/m_1",
    "stiffness_ratios": "stiffness ratio k_{0}/k_1",
    "damping_ratios": "damping ratio of mode {0}",
    "dampers": "dashpot {0} over sqrt(k_1 m_1)",
    "load": "load on mass {0}, over P",
    "contact_masses": "mass in contact, number {0} of them",
}
_WHOLE = ("load_mass", "contact_masses")

#: What the entries of a list belong to, one and several.
_COUNTED = {
    "mass_ratios": ("mass", "masses"),
    "stiffness_ratios": ("mass", "masses"),
    "dampers": ("damper", "dampers"),
    "contact_masses": ("mass in contact", "masses in contact"),
    "contacts": ("contact", "contacts"),
}
_INDEXED = re.compile(r"([a-z_]+)\[([1-9][0-9]*)\]")

#: Numbers of one of several contacts, such as ``contacts[2].force``.
CONTACT_NUMBERS = {
    "force": "friction force of contact {0}, over P",
    "ratio": "ratio of contact {0} to beta",
    "mu": "static-to-kinetic ratio of contact {0}",
    "stiffness": "stiffness of contact {0}, over k_1",
    "wall_velocity": "wall velocity of contact {0}, over omega P/k_1",
    "wall_speed": "wall speed of contact {0}, over omega_1 P/k_1",
    "normal.preload": "normal force of contact {0} at rest, over P",
    "normal.stiffness": "normal stiffness of contact {0}, over k_1",
    "normal.friction": "friction coefficient of contact {0}",
}
_OF_CONTACT = re.compile(r"contacts\[([1-9][0-9]*)\]\.([a-z_]+(?:\.[a-z_]+)?)")


@dataclass(frozen=True)
class Number:
    """One numerical parameter of a system."""

    key: str
    place: int | None  # in a list, counted from 1
    part: str = ""  # of a contact

    @property
    def dimension(self) -> str:
        """Name as a dimension or a coordinate."""
        if self.part:
            return f"{self.key}_{self.place}_{self.part}".replace(".", "_")
        return self.key if self.place is None else f"{self.key}_{self.place}"

    @property
    def text(self) -> str:
        """Name in a configuration."""
        if self.part:
            return f"{self.key}[{self.place}].{self.part}"
        return self.key if self.place is None else f"{self.key}[{self.place}]"

    @property
    def meaning(self) -> str:
        """Description of the parameter."""
        if self.part:
            return CONTACT_NUMBERS[self.part].format(self.place)
        return NUMBERS[self.key] if self.place is None else LISTS[self.key].format(self.place)

    def put_into(self, before: Any, value: float) -> Any:
        """Return the value of the key with this parameter set to `value`."""
        if self.part:
            return self._put_into_contact(before, value)
        given = int(value) if self.key in _WHOLE and value == int(value) else float(value)
        if self.place is None:
            return given
        values = list(before or ())
        if self.place > len(values):
            raise self._beyond(len(values))
        values[self.place - 1] = given
        return values

    def _put_into_contact(self, contacts: Any, value: float) -> list:
        """Return the contacts with this number of one of them set to `value`."""
        values = list(contacts or ())
        assert self.place is not None
        if self.place > len(values):
            raise self._beyond(len(values))
        before = values[self.place - 1]
        if self.part.startswith("normal."):
            values[self.place - 1] = self._put_into_normal(before, value)
            return values
        rival = {"force": {"ratio": None}, "ratio": {"force": None}}.get(self.part, {})
        values[self.place - 1] = replace(before, **{self.part: float(value)}, **rival)
        return values

    def _put_into_normal(self, contact: Any, value: float) -> Any:
        """Return a contact with this number of its normal force set to `value`.

        A preload takes the place of the friction at preload.
        """
        if contact.normal is None:
            raise InputError(
                f"cannot use axis {self.text}: contacts[{self.place}] has no normal; give normal first"
            )
        part = self.part.removeprefix("normal.")
        rival = {"ratio": None, "force": None} if part == "preload" else {}
        return replace(contact, normal=replace(contact.normal, **{part: float(value)}), **rival)

    def _beyond(self, count: int) -> InputError:
        """Return the error of an index beyond a list with `count` entries."""
        if count == 0:
            return InputError(
                f"cannot use axis {self.text}: the system has no {self.key}; give {self.key} first"
            )
        one, many = _COUNTED.get(self.key, (f"value of {self.key}", f"values of {self.key}"))
        return InputError(
            "cannot use",
            "axis",
            f"{self.text}: the system has {count} {one if count == 1 else many}; use an index <= {count}",
        )


@dataclass(frozen=True, eq=False)  # comparing arrays gives no single truth value
class Axis:
    """A dimension along which one parameter varies, or several together."""

    name: str
    numbers: tuple[Number, ...]
    values: tuple[np.ndarray, ...]  # (size,) each

    @property
    def size(self) -> int:
        """Number of points along the axis."""
        return int(self.values[0].size)

    @property
    def zipped(self) -> bool:
        """Whether the axis counts points of several parameters; False if it is the parameter itself."""
        return self.name != self.numbers[0].dimension or len(self.numbers) > 1


@dataclass(frozen=True)
class Variations:
    """A system and the axes along which it varies."""

    system: System
    axes: tuple[Axis, ...]

    @property
    def count(self) -> int:
        """Number of points."""
        return math.prod(self.shape)

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of points along every axis."""
        return tuple(axis.size for axis in self.axes)

    @property
    def described(self) -> dict[str, Any]:
        """The axes as they were given: values by name, or a mapping for parameters that vary together."""
        described: dict[str, Any] = {}
        for axis in self.axes:
            columns = {
                number.text: values.tolist() for number, values in zip(axis.numbers, axis.values, strict=True)
            }
            described |= {axis.name: columns} if axis.zipped else columns
        return described

    def describe(self) -> str:
        """Describe the system and the parameters that vary."""
        keys = dict.fromkeys(number.key for axis in self.axes for number in axis.numbers)
        return self.system.describe() + (f"; varied: {', '.join(keys)}" if keys else "")

    def costs(self, r: np.ndarray) -> None:
        """Refuse a reduction or decoupling error above the allowed one at any point, see `System.costs`."""
        if self.system.costs(r):
            for point in self.points():
                self.at(point).costs(r)

    def points(self) -> Iterator[tuple[int, ...]]:
        """Iterate over all points, the last axis fastest."""
        return iter(np.ndindex(self.shape))

    def at(self, point: Sequence[int]) -> System:
        """Build the system at a point.

        Raises
        ------
        InputError
            No such system exists; the message names the point.
        """
        changed: dict[str, Any] = {}
        where: list[str] = []
        try:
            for axis, index in zip(self.axes, point, strict=True):
                for number, values in zip(axis.numbers, axis.values, strict=True):
                    value = float(values[index])
                    where.append(f"{number.dimension} = {value:g}")
                    before = changed.get(number.key, getattr(self.system, number.key))
                    changed[number.key] = number.put_into(before, value)
            return replace(self.system, **changed)  # all at once: a single change may be invalid by itself
        except InputError as error:
            raise InputError(f"axes, at {', '.join(where)}: {error}") from None

    def chosen(self, places: Mapping[str, int]) -> "Variations":
        """Fix some axes at the given indices, and return the remaining variations."""
        gone = [axis for axis in self.axes if axis.name in places]
        system = Variations(self.system, tuple(gone)).at([places[axis.name] for axis in gone])
        return Variations(system, tuple(axis for axis in self.axes if axis.name not in places))


def checked_variations(system: System, axes: "Mapping[str, Any] | Variations") -> Variations:
    """Check the `axes` of `sweep`: every value of each axis is tried with the first value of the others.

    Raises
    ------
    InputError
        A name or a value is invalid, or no system has it.
    """
    if isinstance(axes, Variations):
        return axes
    if not isinstance(axes, Mapping) or not axes:
        raise InputError(
            "axes",
            "must be a mapping such as {'damping_ratios': [0, 0.01]} with at least one axis; "
            f"got {checks.one_line(axes)}",
        )
    found = tuple(_axis(name, values) for name, values in axes.items())
    numbers = [number for axis in found for number in axis.numbers]
    for number in numbers:
        rivals = [other for other in numbers if other.key == number.key and other is not number]
        if any(other == number or other.place is None or number.place is None for other in rivals):
            raise InputError("axes", f"must change {number.key} in one way only; got {', '.join(axes)}")
    if len({axis.name for axis in found}) < len(found):
        raise InputError(
            "axes", f"must have different dimensions; got {', '.join(axis.name for axis in found)}"
        )
    variations = Variations(system, found)
    first = [0] * len(found)
    for k, axis in enumerate(found):
        for index in range(axis.size):
            variations.at([*first[:k], index, *first[k + 1 :]])
    return variations


def _axis(name: object, values: object) -> Axis:
    if not isinstance(name, str) or not name:
        raise InputError("axes", f"must have strings as names; got {checks.one_line(name)}")
    if isinstance(values, Mapping):
        if not re.fullmatch("[a-z][a-z0-9_]*", name) or re.sub("_[0-9]+$", "", name) in (*NUMBERS, *LISTS):
            raise InputError(
                "axes",
                f"must have a name of its own in lower-case letters, such as sample, for parameters "
                f"that vary together; got {name!r}",
            )
        columns = {key: _column(f"axes.{name}.{key}", column) for key, column in values.items()}
        sizes = {key: column.size for key, column in columns.items()}
        if not columns or len(set(sizes.values())) > 1:
            words = ", ".join(f"{key} {size}" for key, size in sizes.items()) or "none"
            raise InputError(f"axes.{name}", f"must have as many values of every key; got {words}")
        return Axis(
            name, tuple(named_number(key, f"axes.{name}") for key in columns), tuple(columns.values())
        )
    number = named_number(name, "axes")
    column = checks.axis(values, f"axes.{name}", least=-np.inf)
    return Axis(number.dimension, (number,), (column,))


def _column(name: str, values: object) -> np.ndarray:
    """Check a list of numbers in any order."""
    column = np.atleast_1d(checks.array(values, name))
    if column.ndim != 1 or column.size == 0 or column.dtype.kind not in "iuf":
        raise InputError(name, f"must be a list of numbers; got {checks.one_line(values)}")
    wrong = np.flatnonzero(~np.isfinite(column))
    if wrong.size:
        raise InputError(f"{name}[{wrong[0]}]", f"must be finite; got {column[wrong[0]]}")
    return column.astype(float)


def named_number(key: object, where: str) -> Number:
    """The number of a system that a key names; `where` begins the message about another key."""
    if key in NUMBERS:
        return Number(str(key), None)
    matched = _INDEXED.fullmatch(key) if isinstance(key, str) else None
    if matched and matched[1] in LISTS:
        return Number(matched[1], int(matched[2]))
    of_contact = _OF_CONTACT.fullmatch(key) if isinstance(key, str) else None
    if of_contact and of_contact[2] in CONTACT_NUMBERS:
        return Number("contacts", int(of_contact[1]), of_contact[2])
    valid = (
        *NUMBERS,
        *(f"{name}[i]" for name in LISTS),
        *(f"contacts[i].{name}" for name in CONTACT_NUMBERS),
    )
    raise InputError(
        where,
        f"must name a number of the system, i counted from 1: {', '.join(valid)}; "
        f"got {checks.one_line(key)}{checks.nearest(str(key), valid)}",
    )
