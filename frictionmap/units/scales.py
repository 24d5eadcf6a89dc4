"""Reference values that convert ratios to Hz and N, and the lengths and forces that follow from them."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields
from decimal import Decimal
from fractions import Fraction
from typing import Any, NamedTuple, Protocol

from .. import checks
from ..errors import InputError
from ..model.general import ACCELERATION
from ..model.html import as_table
from ..model.shown import Shown
from ..model.system import System
from ..model.variations import Variations
from .quantities import EXAMPLES, quantity
from .table import PI, UNITS

#: What of a structure given by matrices is read as it stands: they are in SI units then.
OF_MODEL = "model"
MODEL_HAS = ("natural_frequency", "stiffness")

#: What every number of `Units` measures.
UNIT_KINDS = {
    "natural_frequency": "frequency",
    "load": "force",
    "base_amplitude": "length",
    "base_acceleration": "acceleration",
    "acceleration_frequency": "frequency",
    "stiffness": "stiffness",
    "mass": "mass",
    "normal_force": "force",
}

#: A normal force that is the weight of the first mass.
WEIGHT = "weight"

#: Words that may stand in the place of a number.
WORDS = {**dict.fromkeys(MODEL_HAS, OF_MODEL), "normal_force": WEIGHT}

#: Values of which some follow from the others: how many of them may be given, and what to do.
_RIVALS = (
    (("load", "base_amplitude", "base_acceleration"), 1, "one follows from the other; give one of them"),
    (("natural_frequency", "stiffness", "mass"), 2, "each follows from the two others; give two of them"),
)

#: The one that needs the other, and why.
_NEEDS = (
    (
        "base_acceleration",
        "acceleration_frequency",
        "Y = a/omega^2 needs its frequency, or natural_frequency where a is the same at all frequencies",
    ),
    ("acceleration_frequency", "base_acceleration", "it is the frequency of that acceleration"),
)


#: What 1 is lies within 1/this to this in SI units: then so do, within doubles, numbers of datasets and
#: products of two.
_LARGEST = 10**100

#: What 1 is of each kind, and its unit.
_ONES = {
    "frequency": ("r = 1", "Hz"),
    "force": ("beta = 1", "N"),
    "length": ("an amplitude of 1", "m"),
    "work": ("a work of 1", "J"),
}


@dataclass(frozen=True, repr=False)
class Units(Shown):
    """Reference values that convert ratios to Hz and N.

    Each is a text such as "4.2 Hz", or a quantity of pint, astropy or unyt.

    Parameters
    ----------
    natural_frequency : str, optional
        Frequency at r = 1: sqrt(k_1/m_1)/(2 pi) of a chain, which follows from stiffness and mass, too;
        frequency_scale/(2 pi) of matrices.  Hz, kHz, rad/s, rpm.  "model": matrices are in SI units, and so
        is their frequency_scale, in rad/s.
    load : str, optional
        Amplitude P of the load, with a base that moves P = k_1 Y.  N, mN, kN, lbf.
    base_amplitude : str, optional
        Instead of the load: amplitude Y of the base; it must move.  mm, m, um, in.
    base_acceleration, acceleration_frequency : str, optional
        Instead of the load: the acceleration of the base (m/s^2, or g = 9.80665 m/s^2) at one frequency.
        Y = a/omega^2 is the same at all others.  Without the frequency, with base_control = "acceleration" of
        `System`, the acceleration is the same at all frequencies.
    stiffness : str, optional
        k_1 of a chain, stiffness_scale of matrices.  N/m, N/mm, kN/m, kN/mm, lbf/in.  "model": matrices are
        in SI units, and so is their stiffness_scale, in N/m.
    mass : str, optional
        m_1 of a chain: with the natural frequency it gives k_1, with the stiffness the natural frequency.
        kg, lb.

    normal_force : str, optional
        Normal force N in the contact: friction is then also given by its coefficient, as `friction`.  N, mN,
        kN, lbf; "weight": that of the first mass of a chain, m_1 g.

    What follows of them for r = 1, beta = 1, an amplitude and a work of 1 is 1e-100 to 1e100 in SI units.

    Raises
    ------
    InputError
        Text is no number with a unit of the right kind, above 0; or numbers exclude each other.

    Examples
    --------
    >>> import frictionmap as fm
    >>> units = fm.Units(natural_frequency="4.2 Hz", load="12.5 N", stiffness="3 N/mm")
    >>> ds = fm.sweep(fm.System(), r=["2.1 Hz", "252 rpm"], beta=["2.5 N"], units=units)
    >>> ds.r.values, ds.frequency.values, ds.beta.values
    (array([0.5, 1. ]), array([2.1, 4.2]), array([0.2]))
    """

    natural_frequency: str | Any = None
    load: str | Any = None
    base_amplitude: str | Any = None
    base_acceleration: str | Any = None
    acceleration_frequency: str | Any = None
    stiffness: str | Any = None
    mass: str | Any = None
    normal_force: str | Any = None

    def __post_init__(self) -> None:
        given = [name for name in UNIT_KINDS if getattr(self, name) is not None]
        if not given:
            raise InputError("units", f"must have at least one of {', '.join(UNIT_KINDS)}; got none")
        for names, most, why in _RIVALS:
            rivals = [name for name in names if name in given]
            if len(rivals) > most:
                raise InputError("cannot use", rivals[most], f"with {' and '.join(rivals[:most])}: {why}")
        if "mass" in given and not {"natural_frequency", "stiffness"} & set(given):
            raise InputError(
                "cannot use",
                "mass",
                "alone: it gives k1 = m1 omega_1^2 with natural_frequency, and this frequency with "
                "stiffness; give one of the two",
            )
        for name, needed, why in _NEEDS:
            if name in given and needed not in given and not self.constant_acceleration:
                raise InputError("cannot use", name, f"without {needed}: {why}; give both")
        for name in given:
            self._check(name)

    def _check(self, name: str) -> None:
        """Check a number with a unit and keep its text."""
        value = getattr(self, name)
        if isinstance(value, str) and value == WORDS.get(name):
            return
        found = quantity(value, name, UNIT_KINDS[name])
        if found.value <= 0:
            raise InputError(name, f"must be > 0; got {checks.one_line(value)}")
        object.__setattr__(self, name, found.text)

    @property
    def constant_acceleration(self) -> bool:
        """Whether the acceleration of the base is the same at all frequencies."""
        if self.base_acceleration is None or self.acceleration_frequency is not None:
            return False
        pair = self.mass is not None and self.stiffness is not None
        return self.natural_frequency is not None or pair

    def value(self, name: str) -> Fraction | None:
        """Value in SI units, Hz for a frequency; None if not given or taken from the model."""
        text = getattr(self, name)
        return None if text in (None, WORDS.get(name)) else quantity(text, name, UNIT_KINDS[name]).value

    @property
    def given(self) -> dict[str, str]:
        """Given values, as in a configuration."""
        return {field.name: text for field in fields(self) if (text := getattr(self, field.name)) is not None}

    def friction(self, coefficient: float) -> str:
        """The friction force of a coefficient, mu N: a text that every axis of beta takes.

        Examples
        --------
        >>> import frictionmap as fm
        >>> fm.Units(load="400 N", normal_force="500 N").friction(0.3)
        '150.0 N'
        """
        given = checks.number(coefficient, "coefficient", least=0.0)
        normal = self.normal()
        if normal is None:
            raise InputError("normal_force", "must be given for a friction coefficient; got nothing")
        return f"{rounded(Fraction(given) * normal)!r} N"

    def normal(self) -> Fraction | None:
        """Normal force [N]; None if it does not follow."""
        if self.normal_force != WEIGHT:
            return self.value("normal_force")
        mass, frequency, stiffness = (self.value(name) for name in ("mass", "natural_frequency", "stiffness"))
        if mass is None and frequency is not None and stiffness is not None:
            mass = stiffness / (2 * PI * frequency) ** 2
        return None if mass is None else mass * UNITS["g"].size

    def _repr_html_(self) -> str:
        return as_table("Units", {name.replace("_", " "): text for name, text in self.given.items()})


class Wanted(NamedTuple):
    """A number with a unit: its kind, its key and what was given."""

    kind: str
    name: str
    given: object


#: Numbers that a message about missing reference values names.
_NAMED = 4


@dataclass(frozen=True)
class Scales:
    """Exact reference values of the ratios in SI units; None if they do not follow from the given ones.

    frequency : at r = 1 [Hz]
    force : P, at beta = 1 [N]
    length : P/k_1, or Y [m]
    stiffness : k_1, or stiffness_scale [N/m]
    normal : normal force N in the contact, friction coefficients times which are friction [N]
    """

    frequency: Fraction | None
    force: Fraction | None
    length: Fraction | None
    stiffness: Fraction | None = None
    normal: Fraction | None = None

    @property
    def work(self) -> Fraction | None:
        """Force times length [J]."""
        return None if self.force is None or self.length is None else self.force * self.length

    @property
    def velocity(self) -> Fraction | None:
        """omega_1 P/k_1 [m/s]."""
        return (
            None if self.frequency is None or self.length is None else 2 * PI * self.frequency * self.length
        )

    @property
    def mass(self) -> Fraction | None:
        """k_1/omega_1^2 [kg]."""
        if self.frequency is None or self.stiffness is None:
            return None
        return self.stiffness / (2 * PI * self.frequency) ** 2

    @property
    def viscosity(self) -> Fraction | None:
        """k_1/omega_1 [N s/m]."""
        if self.frequency is None or self.stiffness is None:
            return None
        return self.stiffness / (2 * PI * self.frequency)

    @property
    def coefficient(self) -> Fraction | None:
        """P/N: the friction coefficient at beta = 1."""
        return None if self.force is None or self.normal is None else self.force / self.normal

    def of(self, kind: str) -> float | None:
        """Reference value of a kind of numbers, such as frequency, force, length or work."""
        found: Fraction | None = getattr(self, kind)
        return None if found is None else float(found)

    def needed(self, kind: str, name: str, given: object) -> Fraction:
        """Reference value of a number; the error names the keys that it needs."""
        self.require([Wanted(kind, name, given)])
        found: Fraction = getattr(self, kind)
        return found

    def require(self, wanted: Sequence[Wanted]) -> None:
        """Refuse numbers with units of which a reference value is missing, all of them in one message."""
        lacking = [one for one in wanted if getattr(self, one.kind) is None]
        if not lacking:
            return
        missing = self._missing({one.kind for one in lacking})
        what = " and ".join(f"{one.name} = {checks.one_line(one.given)}" for one in lacking[:_NAMED])
        more = f" and {len(lacking) - _NAMED} more" if len(lacking) > _NAMED else ""
        are = "a reference value is" if len(missing) == 1 else "reference values are"
        raise InputError(
            f"cannot convert {what}{more} to ratios: {are} missing; give {' and '.join(missing)}, "
            f"such as {' and '.join(_line(key) for key in missing)}"
        )

    def _missing(self, kinds: set[str]) -> list[str]:
        """Keys of [units] that numbers of these kinds need and that do not follow from the given ones."""
        forces, lengths = kinds & {"force", "coefficient"}, kinds & {"length", "velocity"}
        springs = kinds & {"stiffness", "mass", "viscosity"}
        no_load = self.force is None and self.length is None
        if self.length is None:
            springs |= lengths
        elif self.force is None:
            springs |= forces
        found = {
            "units.natural_frequency (or units.mass with units.stiffness)": self.frequency is None
            and kinds & {"frequency", "velocity", "mass", "viscosity"},
            "units.load (or units.base_amplitude for a moving base)": no_load and (forces or lengths),
            "units.stiffness": self.stiffness is None and springs,
            "units.normal_force": self.normal is None and "coefficient" in kinds,
        }
        return [key for key, is_missing in found.items() if is_missing]


def _line(missing: str) -> str:
    """The line of a configuration that gives a missing reference value."""
    key = missing.partition(" ")[0]
    return f'{key} = "{EXAMPLES[UNIT_KINDS[key.removeprefix("units.")]]}"'


class Reference(Protocol):
    """What matrices in SI units define."""

    @property
    def omega_1(self) -> float: ...
    @property
    def stiffness_scale(self) -> float: ...


#: No units are given.
NO_SCALES = Scales(None, None, None)


def scales_of(units: Units | None, system: System, variations: Variations | None = None) -> Scales:
    """Reference values of the ratios of a system in SI units.

    Raises
    ------
    InputError
        The units do not go with the system, or what they make of 1 is beyond 1e-100 to 1e100.
    """
    if units is None:
        return NO_SCALES
    checks.instance(units, "units", Units)
    _check_system(units, system)
    _check_variations(variations)
    return reference_scales(units, system)


def reference_scales(units: Units, system: Reference) -> Scales:
    """Reference values of the ratios from units and what the matrices of a system define.

    Raises
    ------
    InputError
        What the units make of 1 is beyond 1e-100 to 1e100.
    """
    frequency, stiffness = _frequency(units, system), _stiffness(units, system)
    mass = units.value("mass")
    if mass is not None and frequency is not None:
        stiffness = mass * (2 * PI * frequency) ** 2
    elif mass is not None and stiffness is not None:
        frequency = _root(stiffness / mass) / (2 * PI)
    force, length = units.value("load"), _base_amplitude(units, frequency)
    if stiffness is not None:
        force, length = (
            length * stiffness if force is None and length is not None else force,
            force / stiffness if length is None and force is not None else length,
        )
    scales = Scales(frequency, force, length, stiffness, units.normal())
    _check_sizes(scales, units)
    return scales


def _check_sizes(scales: Scales, units: Units) -> None:
    """Refuse numbers that together give an extreme reference value."""
    for kind, (one, unit) in _ONES.items():
        found: Fraction | None = getattr(scales, kind)
        if found is not None and not Fraction(1, _LARGEST) <= found <= _LARGEST:
            size = Decimal(found.numerator) / Decimal(found.denominator)  # it may be beyond doubles
            given = ", ".join(f"{name} {text}" for name, text in units.given.items())
            raise InputError(
                "units",
                f"must make {one} mean {1 / _LARGEST:g} to {_LARGEST:g} {unit}; got {size:.3g} {unit} "
                f"from {given}",
            )


def _check_system(units: Units, system: System) -> None:
    """Refuse units that the system does not have: of the base, of the first mass, of matrices."""
    for name in ("base_amplitude", "base_acceleration"):
        if getattr(units, name) is not None and system.excitation != "base":
            raise InputError(
                "cannot use",
                f"units.{name}",
                ": it needs base excitation; for a force-excited system use units.load",
            )
    constant = system.base_control == ACCELERATION
    if units.base_acceleration is not None and units.constant_acceleration != constant:
        remedy = "omit acceleration_frequency" if constant else "use base_control = 'acceleration'"
        raise InputError(
            "cannot use",
            "units.base_acceleration",
            f"with base_control = {system.base_control!r}: it is the acceleration at one frequency with "
            f"acceleration_frequency, and at all frequencies without; {remedy}",
        )
    if units.mass is not None and system.matrices is not None:
        raise InputError(
            "cannot use",
            "units.mass",
            "with matrices: only a chain has a first mass; use units.stiffness for stiffness_scale",
        )
    if units.normal_force == WEIGHT and units.normal() is None:
        raise InputError(
            "units.normal_force",
            "must be a force, or 'weight' with units.mass or system.masses; got 'weight' without a mass",
        )
    for name in MODEL_HAS:
        if getattr(units, name) == OF_MODEL and system.matrices is None:
            raise InputError(
                f"units.{name}",
                "must be a number with its unit for a chain, whose numbers are ratios; got 'model'",
            )


def _check_variations(variations: Variations | None) -> None:
    """Refuse axes along which a reference value changes."""
    for axis in () if variations is None else variations.axes:
        for number in axis.numbers:
            if number.key in ("frequency_scale", "stiffness_scale"):
                raise InputError(
                    "cannot use",
                    "units",
                    f"with axes.{axis.name}: {number.key} changes along it, so one unit "
                    f"cannot hold for all points; remove one of the two",
                )


def rounded(value: Fraction) -> float:
    """The nearest double; infinity beyond all."""
    try:
        return float(value)
    except OverflowError:
        return math.inf if value > 0 else -math.inf


def _root(value: Fraction) -> Fraction:
    """The square root, to 60 digits as pi, or exactly where it is rational."""
    found = [math.isqrt(number) for number in (value.numerator, value.denominator)]
    if found[0] ** 2 == value.numerator and found[1] ** 2 == value.denominator:
        return Fraction(*found)
    scale = 10**60 * value.denominator  # of the square root's numerator over this denominator
    return Fraction(math.isqrt(value.numerator * value.denominator * 10**120), scale)


def _frequency(units: Units, system: Reference) -> Fraction | None:
    if units.natural_frequency == OF_MODEL:
        return Fraction(system.omega_1) / (2 * PI)
    return units.value("natural_frequency")


def _stiffness(units: Units, system: Reference) -> Fraction | None:
    return Fraction(system.stiffness_scale) if units.stiffness == OF_MODEL else units.value("stiffness")


def _base_amplitude(units: Units, at_one: Fraction | None) -> Fraction | None:
    """Y; of a constant acceleration that at r = 1."""
    acceleration = units.value("base_acceleration")
    if acceleration is None:
        return units.value("base_amplitude")
    frequency = at_one if units.constant_acceleration else units.value("acceleration_frequency")
    return None if frequency is None else acceleration / (2 * PI * frequency) ** 2
