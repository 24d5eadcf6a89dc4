"""Contacts of a page: places where the only one may be put, or several of which one is shown."""

from dataclasses import replace
from itertools import combinations
from typing import Any

from .. import checks
from ..errors import InputError
from ..model.system import CONTACTS, System
from .scene_parts import Contact

#: Masses up to which every one, and every pair of them, is offered as a contact.  Beyond it a list is no
#: choice any more.
_OFFERED_PAIRS, _OFFERED_MASSES = 6, 24

#: Contacts that are found by their names; more are numbered, too.
_NAMED = 12

#: Key of all contacts together, and beginning of that of one.
_ALL, _ONE = "all", "contact-"


def is_placed(system: System) -> bool:
    """Whether the only contact can be put elsewhere; else a choice says which of the contacts is shown."""
    return system.contacts is None and system.contact_system.count == 1


def contacts_of(system: System) -> tuple[Contact, ...]:
    """Contacts to choose from, the present one first."""
    if is_placed(system):
        own = _contact(system.contact, tuple(system.contact_masses), system.n)
        return (own, *(other for other in _others(system) if other.key != own.key))
    groups = system.contact_system.groups
    numbered = len(groups) > _NAMED
    each = tuple(
        Contact(f"{_ONE}{k}", f"{k} {group.name}" if numbered else group.name, "", ())
        for k, group in enumerate(groups, 1)
    )
    return each if len(each) == 1 else (Contact(_ALL, "all contacts together", "", ()), *each)


def shown_contact(key: str) -> int | None:
    """Contact that is shown, counted from 0; None: all together, or the only one."""
    return int(key.removeprefix(_ONE)) - 1 if key.startswith(_ONE) else None


def put_contact(system: System, key: str) -> System:
    """The system with the contact of this key.

    Raises
    ------
    InputError
        There is no such contact.
    """
    known = {one.key: one for one in contacts_of(system)}
    chosen = known[checks.choice(key, "contact", tuple(known))]
    return system if not chosen.kind or chosen is next(iter(known.values())) else _put(system, chosen)


def damped_alike(system: System) -> bool:
    """Whether all modes have one damping ratio, given as such."""
    return system.damping_ratios is not None and len(set(system.damping_ratios)) == 1  # type: ignore[arg-type]


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
                _put(system, contact)
            except InputError:
                continue
            found.append(contact)
    return found


def _put(system: System, contact: Contact) -> System:
    """The system with another contact; a wall that moves with the base needs a base that moves."""
    changes: dict[str, Any] = {"contact": contact.kind, "contact_masses": contact.masses}
    if contact.kind == "joined-base-wall" and system.excitation != "base":
        changes |= {"excitation": "base", "load": None, "load_mass": None}
    if damped_alike(system):  # reduced for another contact it may have more or fewer modes
        changes["damping_ratios"] = system.damping_ratios[0]  # type: ignore[index]
    return replace(system, **changes)
