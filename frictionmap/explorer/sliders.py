"""Sliders of a page: numbers of a system that can be changed."""

from ..model.contact import Contact
from ..model.general import contacts_of
from ..model.system import System
from .contacts import damped_alike
from .law_numbers import numbers_of_law
from .scene_parts import Slider

#: Numbers of a kind up to which each has a slider; beyond it a list is no choice any more.
_OFFERED = 8

#: Ratios of a slider to the value that it begins with; where a slider for mu, zeta and friction ends, at
#: least.
_RATIO, _MOST_MU, _MOST_ZETA, _MOST_FRICTION = 10.0, 3.0, 1.0, 2.0


def sliders_of(system: System, mu: float) -> tuple[Slider, ...]:
    """Numbers that can be changed, the most important ones first: two of them are stored together."""
    return (*_mu(system, mu), *_damping(system), *_contacts(system), *_ratios(system))


def is_of_belt(key: str) -> bool:
    """Whether a slider is of the speed of a wall, which is an axis of a map without a load."""
    return key.endswith(("wall_speed", "wall_velocity"))


def _upward(
    key: str, label: str, ends: tuple[float, float], value: float, unit: str, scale: str = "linear",
    measure: str = "",
) -> Slider:  # fmt: skip
    """A slider to the largest number that is usual, or further if the value is large."""
    return Slider(key, label, ends[0], max(ends[1], 2.0 * value), value, scale, unit, measure)


def _scaled(key: str, label: str, value: float, unit: str, measure: str = "") -> Slider:
    """A slider from a small share of a number to a large multiple of it."""
    return Slider(key, label, value / _RATIO, value * _RATIO, value, "log", unit, measure)


def _mu(system: System, mu: float) -> tuple[Slider, ...]:
    """None for springs alone, which would jump at break-away."""
    if system.contact_system.elastic.all():
        return ()
    return (_upward("mu", "μ", (1.0, _MOST_MU), mu, "times the kinetic friction"),)


def _damping(system: System) -> tuple[Slider, ...]:
    given = system.damping_ratios
    if given is None:  # a matrix C
        return ()
    ratios = tuple(given)  # type: ignore[arg-type]
    alike = damped_alike(system)
    if not alike and len(ratios) > _OFFERED:
        return ()
    keys = ("damping_ratios",) if alike else tuple(f"damping_ratios[{k + 1}]" for k in range(len(ratios)))
    of_one = system.n == 1
    labels = ("ζ" if of_one else "ζ of all modes",) if alike else tuple(f"ζ{k + 1}" for k in range(system.n))
    return tuple(
        _upward(key, label, (0.0, _MOST_ZETA), value, "of critical damping", "square")
        for key, label, value in zip(keys, labels, ratios, strict=False)
    )


def _contacts(system: System) -> tuple[Slider, ...]:
    """Friction, springs and belts of the contacts."""
    given, alone = contacts_of(system), system.contacts is None
    found: list[Slider] = []
    for k, contact in enumerate(given, 1):
        key, name = ("", "") if alone else (f"contacts[{k}].", f", {contact.label}")
        found += _friction(contact, key, name, several=len(given) > 1)
        if isinstance(contact.stiffness, float):
            own, label = ("contact_", "contact stiffness kt / k1") if alone else ("", f"kt / k1{name}")
            found.append(_scaled(f"{key}{own}stiffness", label, contact.stiffness, "times k1", "stiffness"))
        if contact.wall_velocity > 0.0:
            label = "wall velocity v / (ωP/k1)" if alone else f"wall velocity{name}"
            found.append(_scaled(f"{key}wall_velocity", label, contact.wall_velocity, "times ωP/k1"))
        if contact.wall_speed > 0.0:
            label = "wall speed v / (ω1P/k1)" if alone else f"wall speed{name}"
            found.append(_scaled(f"{key}wall_speed", label, contact.wall_speed, "times ω1P/k1", "velocity"))
        found += [*_law(contact, key, name), *_normal(contact, key, name)]
    return tuple(found)


#: Numbers of friction over speed: label, end of the slider at least, what the number is over.
_LAW = {
    "kinetic": ("friction at high speed / at 0", 1.5, "times the friction at speed 0"),
    "speed": ("speed at which friction falls", 0.0, "times ω1P/k1"),
    "viscous": ("slope added to friction over speed", 1.0, "per ω1P/k1"),
    "last": ("friction at the last break point / at 0", 1.5, "times the friction at speed 0"),
    "slope": ("slope of friction beyond the last break point", 1.0, "per ω1P/k1"),
}


def _law(contact: Contact, key: str, name: str) -> list[Slider]:
    """Friction over speed: how far it falls, at which speed, and how it rises."""
    if contact.law is None:
        return []
    found = []
    for number, value in numbers_of_law(contact.law).items():
        label, most, unit = _LAW[number]
        ends = (f"{key}law.{number}", f"{label}{name}")
        if number == "speed":
            found.append(_scaled(*ends, value, unit, "velocity"))
        else:
            found.append(_upward(*ends, (0.0, most), value, unit))
    return found


def _normal(contact: Contact, key: str, name: str) -> list[Slider]:
    """A normal force that moves with the structure: preload, stiffness and coefficient of friction."""
    if contact.normal is None:
        return []
    normal, found = contact.normal, []
    if normal.preload is not None:
        size = max(abs(normal.preload), 1.0)
        ends = (-size if normal.preload < 0.0 else 0.0, 5.0 * size)
        found.append(
            Slider(f"{key}normal.preload", f"preload N0 / P{name}", *ends, normal.preload, "linear",
                   "times P; negative: a gap", "force")
        )  # fmt: skip
    found.append(_scaled(f"{key}normal.stiffness", f"normal stiffness kn / k1{name}", normal.stiffness,
                         "times k1", "stiffness"))  # fmt: skip
    if normal.friction > 0.0:
        found.append(_upward(f"{key}normal.friction", f"coefficient of friction{name}", (0.0, 1.0),
                             normal.friction, ""))  # fmt: skip
    return found


def _friction(contact: Contact, key: str, name: str, *, several: bool) -> list[Slider]:
    """Friction of a contact of a list: its force, or its ratio to that of the others."""
    ends = (0.0, _MOST_FRICTION)
    if isinstance(contact.force, float):
        label = f"friction F / P{name}"
        return [_upward(f"{key}force", label, ends, contact.force, "times P", measure="force")]
    if contact.force is None and several and isinstance(contact.ratio, float):
        return [_upward(f"{key}ratio", f"friction over β{name}", ends, contact.ratio, "times β")]
    return []


def _ratios(system: System) -> tuple[Slider, ...]:
    """Masses and springs of a chain, over those of the first mass."""
    if system.matrices is not None or not 1 < system.n <= _OFFERED:
        return ()
    return tuple(
        _scaled(f"{key}[{k}]", f"{letter}{k} / {letter}1", value, f"times {letter}1", measure)
        for key, letter, measure in (("mass_ratios", "m", "mass"), ("stiffness_ratios", "k", "stiffness"))
        for k, value in enumerate(getattr(system, key)[1:], start=2)
    )
