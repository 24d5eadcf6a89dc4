"""Subject of a page: system, initial view, parameters that can be changed."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import combinations
from pathlib import Path
from typing import TYPE_CHECKING, Any, get_args

import numpy as np

from .. import checks
from ..errors import InputError
from ..model.settings import Solver, Start
from ..model.system import CONTACTS, System
from ..model.variations import named_number
from ..units.axes import KINDS, ratios
from ..units.scales import Units, scales_of
from .general_scene import chosen_contact, contact_choices, contact_sliders
from .scene_parts import Contact, Slider

if TYPE_CHECKING:
    from ..files.config import Config

#: Masses up to which every one, and every pair of them, is offered as a contact; and up to which every ratio
#: has a slider.  Beyond it a list is no choice any more.
_OFFERED_PAIRS, _OFFERED_MASSES, _OFFERED_RATIOS = 6, 24, 8

#: Systems that are kept: a slider that is moved to and fro comes back to them.
_KEPT = 32

#: Ratios of a slider to the value that it begins with; where a slider for mu, and one for zeta, ends.
_RATIO, _MOST_MU, _MOST_ZETA = 10.0, 3.0, 1.0


@dataclass(frozen=True)
class Scene:
    """Subject of a page: system, initial view, settings."""

    title: str
    system: System
    r: tuple[float, float]
    beta: tuple[float, float]
    mu: float
    solver: Solver
    config: "Config | None" = None
    units: Units | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "changed", lru_cache(_KEPT)(self._changed))

    @property
    def files(self) -> Sequence[Path]:
        """Files from which it was read."""
        return () if self.config is None else self.config.files

    @property
    def sliders(self) -> tuple[Slider, ...]:
        """Parameters that can be changed by sliders."""
        mu = Slider(
            "mu", "μ", 1.0, max(_MOST_MU, 2.0 * self.mu), self.mu, "linear", "times the kinetic friction"
        )
        general = self.system.general
        if general is None:
            return (mu, *_damping_sliders(self.system), *_ratio_sliders(self.system))
        first = () if general.elastic.all() else (mu,)  # at break-away a spring would jump
        own = contact_sliders(self.system)
        return (*first, *_damping_sliders(self.system), *own, *_ratio_sliders(self.system))

    @property
    def contacts(self) -> tuple[Contact, ...]:
        """Contacts that the system can have, its own first; of a general one, those that can be shown."""
        if self.system.general is not None:
            return contact_choices(self.system)
        own = _contact(self.system.contact, tuple(self.system.contact_masses), self.system.n)
        return (own, *(other for other in _others(self.system) if other.key != own.key))

    def shown_contact(self, key: str) -> int | None:
        """Contact of a general system that is shown, counted from 0; None: all together."""
        return None if self.system.general is None else chosen_contact(key)

    def _changed(self, contact: str, numbers: tuple[tuple[str, float], ...]) -> System:
        """Change the contact and numbers of the system; contact "": unchanged.

        Raises
        ------
        InputError
            A key is unknown, or there is no such system.
        """
        system = self.system
        if contact and contact != self.contacts[0].key:
            keys = tuple(known.key for known in self.contacts)
            checks.choice(contact, "contact", keys)
            if system.general is None:
                system = _with_contact(system, self.contacts[keys.index(contact)])
        changed: dict[str, Any] = {}
        for text, value in numbers:
            number = named_number(text, "slider")
            before = changed.get(number.key, getattr(system, number.key))
            changed[number.key] = number.put_into(before, value)
        return replace(system, **changed)  # at once: one alone may make no sense

    changed: Any = None  # `_changed`, with what it found kept


def _damped_alike(system: System) -> bool:
    """Whether all modes have one damping ratio, given as such."""
    return system.damping_ratios is not None and len(set(system.damping_ratios)) == 1  # type: ignore[arg-type]


def _damping_sliders(system: System) -> tuple[Slider, ...]:
    given = system.damping_ratios
    if given is None:  # a matrix C
        return ()
    ratios = tuple(given)  # type: ignore[arg-type]
    alike = _damped_alike(system)
    if not alike and len(ratios) > _OFFERED_RATIOS:
        return ()
    keys = ("damping_ratios",) if alike else tuple(f"damping_ratios[{k + 1}]" for k in range(len(ratios)))
    of_one = system.n == 1
    labels = ("ζ" if of_one else "ζ of all modes",) if alike else tuple(f"ζ{k + 1}" for k in range(system.n))
    return tuple(
        Slider(key, label, 0.0, max(_MOST_ZETA, 2.0 * value), value, "square", "of critical damping")
        for key, label, value in zip(keys, labels, ratios, strict=False)
    )


def _ratio_sliders(system: System) -> tuple[Slider, ...]:
    if system.matrices is not None or not 1 < system.n <= _OFFERED_RATIOS:
        return ()

    def slider(key: str, letter: str, k: int, value: float) -> Slider:
        label, unit = f"{letter}{k} / {letter}1", f"times {letter}1"
        return Slider(f"{key}[{k}]", label, value / _RATIO, value * _RATIO, value, "log", unit)

    return tuple(
        slider(key, letter, k, value)
        for key, letter in (("mass_ratios", "m"), ("stiffness_ratios", "k"))
        for k, value in enumerate(getattr(system, key)[1:], start=2)
    )


def _contact(kind: str, masses: tuple[int | str, ...], n: int) -> Contact:
    where = {
        "fixed-wall": "fixed wall",
        "joined-base-wall": "wall on the moving base",
        "between-masses": "",
    }[kind]
    names = f"masses {masses[0]} and {masses[-1]}" if len(masses) > 1 else f"mass {masses[0]}"
    label = where if n == 1 else ", ".join(part for part in (names, where) if part)
    return Contact(f"{kind}:{','.join(map(str, masses))}", label, kind, masses)


def _others(system: System) -> list[Contact]:
    """Contacts that the system can have."""
    n = system.n
    own = tuple(system.contact_masses)
    masses: list[tuple[int | str, ...]] = (
        [(k,) for k in range(1, n + 1)] if n <= _OFFERED_MASSES else [own[:1]]
    )
    pairs: list[tuple[int | str, ...]] = list(combinations(range(1, n + 1), 2)) if n <= _OFFERED_PAIRS else []
    if system.matrices is not None:  # only its own degrees of freedom are known to be what they should
        masses, pairs = [own] if len(own) == 1 else [], []
    found = []
    for kind in CONTACTS:
        for chosen in pairs if kind == "between-masses" else masses:
            contact = _contact(kind, tuple(chosen), n)
            try:
                _with_contact(system, contact)
            except InputError:
                continue
            found.append(contact)
    return found


def _with_contact(system: System, contact: Contact) -> System:
    """The system with another contact; a wall that moves with the base needs a base that moves."""
    changes: dict[str, Any] = {"contact": contact.kind, "contact_masses": contact.masses}
    if contact.kind == "joined-base-wall" and system.excitation != "base":
        changes |= {"excitation": "base", "load": None, "load_mass": None}
    if _damped_alike(system):  # reduced for another contact it may have more or fewer modes
        changes["damping_ratios"] = system.damping_ratios[0]  # type: ignore[index]
    return replace(system, **changes)


def _ends(values: Any) -> tuple[float, float]:
    """Range of an axis; around the value if there is only one."""
    first, last = float(values[0]), float(values[-1])
    return (first, last) if last > first else (0.5 * first, 1.5 * first or 1.0)


def scene_of(config: "Config") -> Scene:
    """Make the scene of a configuration, with the first point of further axes and the first mu."""
    system = config.system
    if config.variations is not None:
        system = config.variations.at([0] * len(config.variations.axes))
    ends, mu = (_ends(config.r), _ends(config.beta)), float(config.mu[0])
    return Scene(config.title, system, *ends, mu, config.solver, config, config.units)


def checked_range(values: object, name: str) -> tuple[float, float]:
    """The two ends of a range of r or beta."""
    most = checks.LARGEST_RATIO if name == "r" else float("inf")
    ends = checks.axis(values, name, least=0.0, most=most)
    if ends.size < 2:
        raise InputError(f"{name} must be a range of two numbers, or more; got {ends.size}")
    return float(ends[0]), float(ends[-1])


def scene_of_system(
    system: System, r: object, beta: object, mu: object, start: object, title: object, units: Units | None
) -> Scene:
    """Make the scene of a system, from checked arguments."""
    checks.instance(system, "system", System)
    if not isinstance(title, str):
        raise InputError(f"title must be text; got {checks.one_line(title)}")
    checks.choice(start, "start", get_args(Start))
    mu = checks.number(mu, "mu", least=1.0)
    scales = scales_of(units, system)  # they may not go with it
    settings: Mapping[str, Any] = {"start": start}
    ends = (
        checked_range(ratios(r, "r", KINDS["r"], scales), "r"),
        checked_range(ratios(beta, "beta", KINDS["beta"], scales), "beta"),
    )
    system.costs(np.array(ends[0]))
    return Scene(title, system, *ends, mu, Solver(**settings), units=units)
