"""What can be changed of a system with several contacts, springs, belts or periodic loads."""

from typing import Any

from ..model.system import System
from .scene_parts import Contact, Slider

#: Ratios of a slider to the value that it begins with; where a slider of friction ends, at least.
_RATIO, _MOST_FRICTION = 10.0, 2.0


def contact_choices(system: System) -> tuple[Contact, ...]:
    """All contacts together, and each by its name; one contact alone is no choice."""
    assert system.general is not None
    each = tuple(
        Contact(f"contact-{k}", group.name, "", ()) for k, group in enumerate(system.general.groups, 1)
    )
    return each if len(each) == 1 else (Contact("all", "all contacts together", "", ()), *each)


def chosen_contact(key: str) -> int | None:
    """Place of a chosen contact, counted from 0; None for all together."""
    return int(key.removeprefix("contact-")) - 1 if key.startswith("contact-") else None


def _friction(key: str, label: str, value: float, unit: str, measure: str = "") -> Slider:
    return Slider(key, label, 0.0, max(_MOST_FRICTION, 2.0 * value), value, "linear", unit, measure)


def _scaled(key: str, label: str, value: float, unit: str) -> Slider:
    return Slider(key, label, value / _RATIO, value * _RATIO, value, "log", unit)


def contact_sliders(system: System) -> tuple[Slider, ...]:
    """Sliders of friction, springs and belts."""
    found: list[Slider] = []
    if system.contacts is None:
        if isinstance(system.contact_stiffness, float):
            found.append(
                _scaled(
                    "contact_stiffness", "contact stiffness kt / k1", system.contact_stiffness, "times k1"
                )
            )
        if system.wall_velocity > 0.0:
            found.append(
                _scaled("wall_velocity", "wall velocity v / (ωP/k1)", system.wall_velocity, "times ωP/k1")
            )
        return tuple(found)
    contacts: Any = system.contacts  # checked by the system
    for k, contact in enumerate(contacts, 1):
        name, key = contact.label, f"contacts[{k}]"
        if isinstance(contact.force, float):
            found.append(
                _friction(f"{key}.force", f"friction F / P, {name}", contact.force, "times P", "force")
            )
        elif contact.force is None and len(contacts) > 1 and not isinstance(contact.ratio, tuple):
            found.append(
                _friction(f"{key}.ratio", f"friction over β, {name}", contact.ratio or 0.0, "times β")
            )
        if isinstance(contact.stiffness, float):
            found.append(_scaled(f"{key}.stiffness", f"kt / k1, {name}", contact.stiffness, "times k1"))
        if contact.wall_velocity > 0.0:
            found.append(
                _scaled(
                    f"{key}.wall_velocity", f"wall velocity, {name}", contact.wall_velocity, "times ωP/k1"
                )
            )
    return tuple(found)
