"""Systems with several contacts, springs in contacts, belts, varying normal loads or periodic loads.

    r^2 M x'' + r C1 x' + K x + W f = p(tau),   z = W^T x - s u(tau),   w = z' - v

`contact_system` collects the contacts and loads of any `System`, in whichever form they are given.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Protocol, TypeVar

import numpy as np

from .. import checks
from ..errors import InputError
from ..structures.dofs import Dofs
from .contact import BANKS, MOST_CONTACTS, WALLS, Contact, checked_contacts
from .normal_contact import MovingNormal
from .periodic_load import (
    DEFAULT_HARMONICS,
    ENTRY_KEYS,
    MOST_HARMONICS,
    WAVEFORMS,
    PeriodicLoad,
    check_entry,
    load_table,
    order,
    phasor,
    sampled,
    scalar_harmonics,
    waveform,
)
from .points import Points
from .spring_element import Spring, SpringElement

#: Keys of a system that only this engine takes.
KEYS = (
    "contacts", "contact_stiffness", "wall_velocity", "wall_speed", "normal_load", "load_harmonics",
    "load_file", "waveform", "load_offset", "springs",
)  # fmt: skip

#: What a moving base holds constant over frequency: its displacement, or its acceleration.
DISPLACEMENT, ACCELERATION = "displacement", "acceleration"
BASE_CONTROLS = (DISPLACEMENT, ACCELERATION)

#: Rows of W are linearly dependent if a combination of them is smaller than this per mass: above rounding,
#: and below any difference that is meant.
_PARALLEL = 1e-12

#: Why rigid contacts with linearly dependent vectors have no motion.
LOOP = "they close a loop, and their forces in a common stop are not determined"


class Definition(Protocol):
    """Keys of a system that are read here, checked or not yet."""

    @property
    def contact(self) -> Any: ...

    @property
    def contact_masses(self) -> Any: ...

    @property
    def load_mass(self) -> Any: ...

    @property
    def load(self) -> Any: ...

    @property
    def excitation(self) -> Any: ...

    @property
    def contacts(self) -> Any: ...

    @property
    def contact_stiffness(self) -> float | Sequence[float] | None: ...

    @property
    def wall_velocity(self) -> float: ...

    @property
    def wall_speed(self) -> float: ...

    @property
    def base_control(self) -> str: ...

    @property
    def normal_load(self) -> Any: ...

    @property
    def load_harmonics(self) -> Any: ...

    @property
    def load_file(self) -> Any: ...

    @property
    def waveform(self) -> Any: ...

    @property
    def harmonics(self) -> int | None: ...

    @property
    def load_offset(self) -> Any: ...

    @property
    def springs(self) -> Any: ...

    @property
    def n(self) -> int: ...

    @property
    def dofs(self) -> Dofs: ...

    @property
    def loads(self) -> tuple[complex, ...] | None: ...

    @property
    def general(self) -> "ContactSystem | None": ...


_Definition = TypeVar("_Definition", bound=Definition)


@dataclass(frozen=True)
class MergedContact:
    """A contact, several parallel rigid ones that act as one, a bank, or an element of a bank."""

    members: tuple[Contact, ...]
    vector: np.ndarray  # (n,) c
    base: int  # s: 1 if its wall moves with the base
    normal: MovingNormal | None = None  # a normal force that moves with the structure

    @property
    def first(self) -> Contact:
        """The contact that gives spring, belt and normal load."""
        return self.members[0]

    @property
    def stiffness(self) -> float | None:
        """Stiffness of its spring over k1, of a bank that of all springs; None if it is rigid."""
        own = self.first.stiffness
        return float(sum(own)) if isinstance(own, tuple) else own  # type: ignore[return-value]

    @property
    def is_bank(self) -> bool:
        """Whether it is a bank of elements as one contact."""
        return isinstance(self.first.stiffness, tuple)

    @property
    def element_count(self) -> int:
        """Number of elements, 1 of a contact that is no bank."""
        own = self.first.stiffness
        return len(own) if isinstance(own, tuple) else 1

    @property
    def name(self) -> str:
        """Names of the members."""
        return " + ".join(member.label for member in self.members)

    def friction(self, beta: float | np.ndarray, mu: float | np.ndarray) -> tuple[Any, Any]:
        """Kinetic and static friction at a friction ratio and a static-to-kinetic ratio of the grid."""
        kinetic: Any = 0.0
        static: Any = 0.0
        for one in self.members:
            own = self._kinetic(one, beta)
            kinetic = kinetic + own
            static = static + own * one.static_ratio(mu)
        return kinetic, static

    @staticmethod
    def _kinetic(one: Contact, beta: Any) -> Any:
        """Kinetic friction of a member; with a moving normal force that at preload."""
        if one.has_preload:
            return one.normal.friction * max(0.0, one.normal.preload) + 0.0 * beta
        if one.force is None:
            return (sum(one.ratio) if isinstance(one.ratio, tuple) else one.ratio) * beta
        return sum(one.force) if isinstance(one.force, tuple) else one.force


@dataclass(frozen=True)
class ContactSystem:
    """Contacts and loads of a system, in one form."""

    groups: tuple[MergedContact, ...]
    forces: Mapping[int, np.ndarray]  # phasors (n,) of the loads on the masses, by order
    base: Mapping[int, complex]  # phasors of the base motion
    offset: np.ndarray  # (n,) constant loads
    loop: str = ""  # numbers of the rigid contacts that close a loop; empty without one
    free: bool = False  # whether the structure has rigid-body modes; set by the system
    springs: tuple[SpringElement, ...] = ()  # piecewise linear ones
    points: Points | None = None  # of a structure given by modes: then n counts modes

    @property
    def count(self) -> int:
        """Number of contacts, parallel ones as one."""
        return len(self.groups)

    @property
    def vectors(self) -> np.ndarray:
        """The vectors c of the contacts, (N, n)."""
        return np.array([group.vector for group in self.groups])

    @property
    def independent(self) -> np.ndarray:
        """Vectors of contacts, as many as are linearly independent: those held, all are held."""
        found = self.vectors[:1]
        for vector in self.vectors[1:]:
            more = np.vstack((found, vector))
            found = more if rank_of(more) == len(more) else found
        return found

    @property
    def stiffnesses(self) -> np.ndarray:
        """Stiffness of every contact, with the flexibility of modes left out; 0 where it is rigid; (N,)."""
        own = np.array([group.stiffness or 0.0 for group in self.groups])
        if self.points is None or self.points.residual is None:
            return own
        return np.asarray(1.0 / (1.0 / own + self.points.own))

    @property
    def flexibility(self) -> np.ndarray:
        """F = Kt^-1 + R_cc (N, N) of elastic contacts that it couples beside the modes; else (0, 0)."""
        own = np.array([group.stiffness or 0.0 for group in self.groups])
        if self.points is None or not self.points.couples(own):
            return np.zeros((0, 0))
        return self.points.flexibility(own)

    @property
    def loads(self) -> Mapping[int, np.ndarray]:
        """Phasors of the loads on the masses, or points, by order."""
        return self.forces if self.points is None else self.points.loads

    @property
    def constant_loads(self) -> np.ndarray:
        """Constant loads on the masses, or points, (n,)."""
        return self.offset if self.points is None else self.points.offset

    @property
    def shaken_points(self) -> Points | None:
        """The points of a structure given by modes on a moving base: modes are then relative to the base."""
        return self.points if self.base else None

    @property
    def joined(self) -> np.ndarray:
        """1 of contacts whose wall is joined to the base, else 0; (N,)."""
        return np.array([float(group.base) for group in self.groups])

    @property
    def wall_shares(self) -> np.ndarray:
        """Motion of the walls of contacts by that of the base, relative to which masses move, (N,).

        A wall at rest moves by -u.
        """
        if self.points is not None:
            return np.asarray(self.joined - self.points.vectors @ self.points.carried)
        return self.joined - np.array([group.vector.sum() for group in self.groups])

    def moved(self, matrix: np.ndarray) -> np.ndarray:
        """Product of a matrix (n, n) with the displacements by a unit displacement of the base, (n,)."""
        points = self.shaken_points
        return np.asarray(matrix.sum(axis=1) if points is None else matrix @ points.participation)

    def direct_motion(self, order: int, r: np.ndarray) -> np.ndarray:
        """Displacements of points beside those by modes, by a harmonic of load and base, (p,) or (n_r, p)."""
        assert self.points is not None
        found, points = self.points.pushed(order), self.shaken_points
        return found if points is None else found + self.base.get(order, 0.0) * points.shaken(order * r)

    def displacements(self, order: int, r: np.ndarray, motion: np.ndarray, forces: np.ndarray) -> np.ndarray:
        """Displacements of the masses, or points, by a harmonic motion (n_r, n) and forces (n_r, N)."""
        if self.points is None:
            return motion
        return self.points.displacements(self.direct_motion(order, r), motion, forces)

    def in_modes(self, points: Points) -> "ContactSystem":
        """The same contacts and loads of points, as they act on the modes."""
        shapes = points.shapes
        groups = tuple(replace(group, vector=shapes.T @ group.vector) for group in self.groups)
        return replace(
            self,
            groups=groups,
            forces={n: shapes.T @ force for n, force in self.forces.items()},
            offset=shapes.T @ self.offset,
            loop=_describe_loop(groups),
            points=points,
        )

    @property
    def rows(self) -> list[int]:
        """Rows of the masses in contact or under load, counted from 0."""
        used = [*self.vectors, *self.forces.values(), self.offset]
        used += [group.normal.direction for group in self.groups if group.normal is not None]
        used += [spring.direction for spring in self.springs]
        return np.flatnonzero(np.any(used, axis=0)).tolist()

    def at(self, rows: np.ndarray) -> "ContactSystem":
        """The same contacts and loads of a structure that keeps only these rows, `self.rows` among them."""
        return replace(
            self,
            groups=tuple(_group_at(group, rows) for group in self.groups),
            springs=tuple(replace(one, direction=one.direction[rows]) for one in self.springs),
            forces={n: force[rows] for n, force in self.forces.items()},
            offset=self.offset[rows],
        )

    @property
    def orders(self) -> tuple[int, ...]:
        """Orders of all harmonics, of normal loads too."""
        normal = {n for group in self.groups for n in group.first.nu}
        return tuple(sorted({*self.forces, *self.base, *normal}))

    @property
    def elastic(self) -> np.ndarray:
        """Whether each contact has a spring, (N,) bool."""
        return np.array([group.stiffness is not None for group in self.groups])

    @property
    def has_banks(self) -> bool:
        """Whether a contact is a bank of elements."""
        return any(group.is_bank for group in self.groups)

    @property
    def has_law(self) -> bool:
        """Whether the friction of a contact depends on its speed."""
        return any(group.first.law is not None for group in self.groups)

    @property
    def has_phases(self) -> bool:
        """Whether the stiffness changes with the motion: contacts that open, piecewise linear springs."""
        return bool(self.springs) or any(group.normal is not None for group in self.groups)

    def has_equal_friction(self, mu: float) -> bool:
        """Whether static and kinetic friction of every contact are equal at this mu of the grid."""
        return all(one.static_ratio(mu) == 1.0 for group in self.groups for one in group.members)

    @property
    def merged(self) -> str:
        """Describe the contacts that were merged; empty if none were."""
        found = [group.name for group in self.groups if len(group.members) > 1]
        return f"parallel contacts act as one: {'; '.join(found)}" if found else ""


def _group_at(group: MergedContact, rows: np.ndarray) -> MergedContact:
    """A contact of a structure that keeps only these rows."""
    normal = group.normal
    if normal is not None:
        normal = replace(normal, direction=normal.direction[rows])
    return replace(group, vector=group.vector[rows], normal=normal)


def uses_general(system: Definition) -> bool:
    """Whether a system needs the general engine."""
    given = (getattr(system, name) for name in KEYS if name not in WALLS)
    moved = system.wall_velocity != 0.0 or system.wall_speed != 0.0
    return moved or system.base_control != DISPLACEMENT or any(one is not None for one in given)


def contact_system(system: Definition) -> ContactSystem:
    """Collect and check the contacts and loads of a system, in whichever form they are given."""
    if system.harmonics is not None and system.waveform is None:
        raise InputError(
            "cannot use", "harmonics", "without waveform: it is the number of its harmonics; omit it"
        )
    groups = _groups(system)
    forces, base = _loads(system)
    if system.load_offset is not None and system.excitation == "base":
        raise InputError(
            "cannot use", "load_offset", "with base excitation: it is a force on each mass; omit one"
        )
    offset = _offset(system.load_offset, system.n)
    springs = tuple(one.on(system.dofs, f"springs[{k}]") for k, one in enumerate(system.springs or (), 1))
    found = ContactSystem(groups, forces, base, offset, _describe_loop(groups), springs=springs)
    if not found.forces and not found.base:
        if not any(group.first.belt for group in groups):
            raise InputError("load_harmonics", "must have a harmonic that is not zero; got none")
        raise InputError(
            "cannot compute without a load: a belt alone makes vibrations of a period of their own; "
            "give load_harmonics"
        )
    return found


def refuse_general(system: Definition, what: str) -> None:
    """Refuse a system that needs the general engine.

    what : words after "cannot", such as "compute peak thresholds"
    """
    if system.general is not None:
        refuse_modes(system, what)
        if system.general.free:
            raise InputError(
                f"cannot {what} of a free structure: this is offered where springs hold it at a place; add a "
                f"spring to the ground, such as 1e-6 of the others"
            )
        used = [name for name in KEYS if getattr(system, name) not in (None, 0.0)] or ["base_control"]
        raise InputError(
            f"cannot {what} of a system with {used[0]}: this is offered for one rigid contact under one "
            f"harmonic load; omit {used[0]}"
        )


def refuse_modes(system: Definition, what: str) -> None:
    """Refuse a structure given by modes; `what`: words after "cannot", such as "compute spectra"."""
    if system.general is not None and system.general.points is not None:
        raise InputError(
            f"cannot {what} of a structure given by modes: this is offered for chains and matrices; give "
            f"matrices M and K"
        )


def refuse_law(
    system: Definition, what: str, why: str = "friction over speed is not offered there; omit law"
) -> None:
    """Refuse friction over speed.

    what : words after "cannot", such as "compute motions under records"
    why : the reason, and what to do
    """
    for k, one in enumerate(system.contacts or (), 1):
        if one.law is not None:
            raise InputError(f"cannot {what} with contacts[{k}].law: {why}")


def refuse_phases(system: Definition, what: str, why: str = "") -> None:
    """Refuse contacts that open, and piecewise linear springs.

    what : words after "cannot", such as "compute motions under records"
    why : the reason, and what to do; default: it is not offered
    """
    keys = [
        f"contacts[{k}].normal" for k, one in enumerate(system.contacts or (), 1) if one.normal is not None
    ]
    if system.springs is not None:
        keys.append("springs")
    if keys:
        usual = f"contacts that open and piecewise linear springs are not offered there; omit {keys[0]}"
        raise InputError(f"cannot {what} with {keys[0]}: {why or usual}")


def refuse_banks(system: Definition, what: str) -> None:
    """Refuse banks that are one contact.

    what : words after "cannot", such as "compute motions under records"
    """
    for group in () if system.general is None else system.general.groups:
        if group.is_bank:
            raise InputError(
                f"cannot {what} with {group.name}, a bank of {group.element_count} elements as one "
                f"contact: this is offered where up to {MOST_CONTACTS} elements are contacts; use "
                f'bank = "elements"'
            )


def contacts_of(system: Definition) -> tuple[Contact, ...]:
    """The contacts of a system, in either form; banks as one contact each."""
    if system.contacts is not None:
        return system.contacts
    own = {
        "stiffness": system.contact_stiffness, "wall_velocity": system.wall_velocity,
        "wall_speed": system.wall_speed, "normal_load": system.normal_load,
    }  # fmt: skip
    return (Contact(system.contact, system.contact_masses, **own),)


def in_general_form(system: _Definition) -> _Definition:
    """A system in the form that the general engine takes: with a list of contacts if it takes no other."""
    if system.general is not None:
        return system
    return replace(system, contacts=contacts_of(system))  # type: ignore[type-var]  # a system is a dataclass


def check_contacts(system: Definition) -> tuple[Contact, ...] | None:
    """Check the contacts of the form with several; None in the other form."""
    if system.contacts is None:
        return None
    for name, default in (
        ("contact_stiffness", None), ("wall_velocity", 0.0), ("wall_speed", 0.0), ("normal_load", None),
    ):  # fmt: skip
        if getattr(system, name) != default:
            raise InputError("cannot use", name, "with contacts: each contact has its own; omit one")
    found = checked_contacts(system.contacts)
    masses: tuple = found[0].masses  # type: ignore[assignment]  # checked
    first = (found[0].kind, masses)
    given = (system.contact, tuple(system.contact_masses))
    if given in (first, ("fixed-wall", (1,))):
        return found
    counted = contact_rows(masses, found[0].kind, system.dofs, mass_key(system, 1))  # as a copy has them
    if given != (found[0].kind, counted):
        raise InputError("cannot use", "contact", "with contacts: both define where friction acts; omit one")
    return found


def mass_key(system: Definition, k: int) -> str:
    """Key under which the masses of contact k, counted from 1, are given."""
    return "contact_masses" if system.contacts is None else f"contacts[{k}].masses"


def contact_rows(masses: Sequence[int | str], kind: str, dofs: Dofs, key: str) -> tuple[int, ...]:
    """Numbers of the masses of a contact, checked.

    key : name of the key that gives them, for messages
    """
    count = 2 if kind == "between-masses" else 1
    if len(masses) != count:
        wanted = "two masses [A, B]" if count == 2 else "one mass"
        raise InputError(key, f"must name {wanted} for {kind}; got {list(masses)}")
    numbers = tuple(dofs.number(mass, f"{key}[{k}]") for k, mass in enumerate(masses))
    if count == 2 and numbers[0] >= numbers[1]:
        raise InputError(key, f"must be [A, B] with A < B; got {list(masses)}")
    return numbers


def vector_of(contact: Contact, dofs: Dofs, key: str) -> np.ndarray:
    """c (n,) of a contact: z = c.x - s u; `key` as in `contact_rows`."""
    masses: tuple = contact.masses  # type: ignore[assignment]
    rows = dofs.rows(contact_rows(masses, contact.kind, dofs, key))
    c = np.zeros(dofs.n)
    c[rows[-1]] = 1.0
    if len(rows) == 2:
        c[rows[0]] = -1.0
    return c


def _groups(system: Definition) -> tuple[MergedContact, ...]:
    """The contacts of a system, banks as their elements or as one, parallel rigid ones merged."""
    found: list[MergedContact] = []
    contacts = contacts_of(system)
    elements = _elements(system, contacts)
    for k, contact in elements:
        name = f"contacts[{k}]" if system.contacts is not None else "contact"
        base = int(contact.kind == "joined-base-wall")
        if base and system.excitation != "base":
            raise InputError(name, "must have base excitation for a joined-base-wall; got 'force'")
        vector = vector_of(contact, system.dofs, mass_key(system, k))
        for i, other in enumerate(found):
            same = np.array_equal(other.vector, vector) and other.base == base
            if not same or any(not _may_merge(one) for one in (contact, other.first)):
                continue
            walls = any(getattr(contact, name) != getattr(other.first, name) for name in WALLS)
            same_load = contact.nu == other.first.nu and contact.normal_record is other.first.normal_record
            if walls or not same_load or contact.law != other.first.law:
                raise InputError(
                    name,
                    f"must have the wall_velocity, the normal_load and the law of {other.name}, with which "
                    f"it is parallel; got another one",
                )
            found[i] = MergedContact((*other.members, contact), vector, base)
            break
        else:
            normal = None if contact.normal is None else contact.normal.on(system.dofs, f"{name}.normal")
            found.append(MergedContact((contact,), vector, base, normal))
    if not any(one.ratio or one.force or one.has_preload for one in contacts):
        raise InputError("contacts", "must have a ratio or a force > 0; got none")
    return tuple(found)


def _elements(system: Definition, contacts: Sequence[Contact]) -> list[tuple[int, Contact]]:
    """The contacts with their numbers, banks as their elements, or whole where there are too many."""
    separate, whole = BANKS
    many = sum(len(one.elements) for one in contacts if one.bank != whole) > MOST_CONTACTS
    found: list[tuple[int, Contact]] = []
    for k, one in enumerate(contacts, 1):
        as_one = one.bank == whole or (many and one.bank != separate)
        found += [(k, one)] if as_one else [(k, element) for element in one.elements]
    if len(found) > MOST_CONTACTS:
        key = "contact_stiffness" if system.contacts is None else "contacts"
        raise InputError(key, f"must have at most {MOST_CONTACTS} elements in all; got {len(found)}")
    return found


def _may_merge(contact: Contact) -> bool:
    """Whether a contact acts as one with others that are parallel to it."""
    return contact.stiffness is None and contact.normal is None


def _describe_loop(groups: Sequence[MergedContact]) -> str:
    """List the rigid contacts whose vectors are linearly dependent; empty if there are none."""
    rigid = [k for k, group in enumerate(groups) if group.stiffness is None]
    if not rigid:
        return ""
    w = np.array([groups[k].vector for k in rigid])
    w = w / np.abs(w).max(axis=1, keepdims=True)  # in modes, entries have any size
    rank = rank_of(w)
    if rank == len(rigid):
        return ""
    # a contact is in a loop if the others move all that it moves
    loop = [rigid[k] + 1 for k in range(len(rigid)) if rank_of(np.delete(w, k, axis=0)) == rank]
    return ", ".join(map(str, loop))


def rank_of(w: np.ndarray) -> int:
    """Number of linearly independent rows of W (contacts, n)."""
    return int(np.linalg.matrix_rank(w, tol=_PARALLEL * w.shape[1])) if w.size else 0


def _offset(given: object, n: int) -> np.ndarray:
    if given is None:
        return np.zeros(n)
    values = checks.array(given, "load_offset").astype(float)
    if values.shape != (n,) or not np.isfinite(values).all():
        raise InputError("load_offset", f"must have one finite number per mass ({n}); got {values.tolist()}")
    return values


def _loads(system: Definition) -> tuple[dict[int, np.ndarray], dict[int, complex]]:
    """Phasors of the loads on the masses, and of the base motion, by order."""
    ways = [name for name in ("load_harmonics", "load_file", "waveform") if getattr(system, name) is not None]
    if len(ways) > 1:
        raise InputError("cannot use", ways[0], f"with {ways[1]}: both define the load; omit one")
    if ways and system.load is not None:
        raise InputError("cannot use", "load", f"with {ways[0]}: both define the load; omit one")
    given: Any = system.load_harmonics
    if ways == ["load_file"]:
        given = load_table(system.load_file)
    elif ways == ["waveform"]:
        given = _waveform(system)
    if given is None:
        return _one_harmonic(system)
    if isinstance(given, PeriodicLoad):
        return _on_load_mass(system, given.harmonics)
    if isinstance(given, Mapping):
        return _from_mapping(system, given)
    return _from_entries(system, given, ways[0])


def _waveform(system: Definition) -> PeriodicLoad:
    given = system.waveform
    highest = DEFAULT_HARMONICS if system.harmonics is None else checks.whole(
        system.harmonics, "harmonics", least=1, most=MOST_HARMONICS
    )  # fmt: skip
    if given in WAVEFORMS:
        return waveform(str(given), highest)
    if not str(given).lower().endswith(".csv"):
        raise InputError(
            "waveform",
            f"must be one of {', '.join(WAVEFORMS)}, or a CSV file of one period with the columns "
            f"time, force; got {given!r}",
        )
    return sampled(given, highest)


def _one_harmonic(system: Definition) -> tuple[dict[int, np.ndarray], dict[int, complex]]:
    """The load of the form with one harmonic."""
    if system.excitation == "base":
        return {}, {1: 1.0 + 0.0j}
    load = np.zeros(system.n, dtype=complex)
    if system.load is not None:
        load[:] = system.loads
    else:
        load[system.dofs.row(system.load_mass)] = 1.0
    return {1: load}, {}


def _on_load_mass(
    system: Definition, harmonics: Mapping[int, complex]
) -> tuple[dict[int, np.ndarray], dict[int, complex]]:
    if system.excitation == "base":
        return {}, dict(harmonics)
    row = system.dofs.row(system.load_mass)
    unit = np.eye(system.n)[row]
    return {n: value * unit for n, value in harmonics.items()}, {}


def _from_mapping(
    system: Definition, given: Mapping[Any, Any]
) -> tuple[dict[int, np.ndarray], dict[int, complex]]:
    """Harmonics {n: phasor or vector of phasors}."""
    if all(np.ndim(value) == 0 for value in given.values()):
        return _on_load_mass(system, scalar_harmonics(given, "load_harmonics"))
    if system.excitation == "base":
        raise InputError("load_harmonics", "must have one phasor per order for base excitation; got vectors")
    forces = {}
    for key, value in given.items():
        n = order(key, "load_harmonics: order")
        vector = checks.array(value, f"load_harmonics[{key}]").astype(complex)
        if vector.shape != (system.n,) or not np.isfinite(vector).all():
            raise InputError(
                f"load_harmonics[{key}]",
                f"must have one finite number per mass ({system.n}); got {vector.tolist()}",
            )
        if vector.any():
            forces[n] = vector
    return forces, {}


def _from_entries(
    system: Definition, given: object, name: str
) -> tuple[dict[int, np.ndarray], dict[int, complex]]:
    """Harmonics as a list of { n, mass, amplitude, phase_deg }."""
    if not isinstance(given, Sequence) or isinstance(given, (str, bytes)):
        raise InputError(
            name,
            f"must be a list of {{ n, mass, amplitude, phase_deg }}, a mapping of orders to phasors "
            f"or a PeriodicLoad; got {checks.one_line(given)}",
        )
    forces: dict[int, np.ndarray] = {}
    base: dict[int, complex] = {}
    for k, one in enumerate(given):
        entry = check_entry(one, f"{name}[{k}]", ENTRY_KEYS)
        n, value = order(entry["n"], f"{name}[{k}].n"), phasor(entry, f"{name}[{k}]")
        if "mass" not in entry:
            if system.excitation != "base":
                raise InputError(
                    f"{name}[{k}]",
                    "must name a mass: without one it is a motion of the base, which "
                    'excitation = "base" needs; got none',
                )
            base[n] = base.get(n, 0.0) + value
            continue
        if system.excitation == "base":
            raise InputError(
                f"{name}[{k}]",
                f"must have no mass with base excitation, which loads all masses; got mass {entry['mass']}",
            )
        mass = entry["mass"]
        mass = int(mass) if isinstance(mass, float) and mass == math.floor(mass) else mass
        row = system.dofs.row(system.dofs.number(mass, f"{name}[{k}].mass"))
        forces.setdefault(n, np.zeros(system.n, dtype=complex))[row] += value
    return {n: v for n, v in forces.items() if v.any()}, {n: v for n, v in base.items() if v != 0.0}


def base_is_meant(system: Definition) -> bool:
    """Whether the load says that the base moves: harmonics without a mass, or a joined wall."""
    given = system.load_harmonics
    entries = given if isinstance(given, Sequence) and not isinstance(given, (str, bytes)) else ()
    without_mass = any(isinstance(one, Mapping) and "mass" not in one for one in entries)
    walls = any(one.kind == "joined-base-wall" for one in system.contacts or () if isinstance(one, Contact))
    return without_mass or walls


def format_orders(orders: Sequence[int]) -> str:
    """Format orders of harmonics: up to six of them, or the first and the last."""
    if len(orders) <= 6:
        return ", ".join(map(str, orders))
    return f"{orders[0]}, {orders[1]}, ..., {orders[-1]}"


def describe_springs(springs: Sequence[Spring], dofs: Dofs) -> str:
    """Describe piecewise linear springs in one line."""
    return "; ".join(_describe_spring(one, dofs) for one in springs)


def _describe_spring(one: Spring, dofs: Dofs) -> str:
    masses: tuple = one.masses  # type: ignore[assignment]
    words = [dofs.word(dofs.number(mass, "masses")) for mass in masses]
    if len(words) == 2:
        where = f"between masses {words[0]} and {words[1]}"
    else:
        where = (
            "between the mass and the ground" if dofs.n == 1 else f"between mass {words[0]} and the ground"
        )
    if one.gap is not None:
        return f"spring {where} (gap {'-' * (one.side == -1)}{one.gap:g}, stiffness {one.stiffness:g})"
    if one.backlash is not None:
        return f"spring with backlash {one.backlash:g} {where} (stiffness {one.stiffness:g})"
    return f"piecewise linear spring {where} (knots {len(one.displacement or ())})"


def describe_contacts(general: ContactSystem, dofs: Dofs) -> str:
    """Describe the contacts in one line."""
    return "; ".join(_describe_group(group, dofs) for group in general.groups)


def _describe_group(group: MergedContact, dofs: Dofs) -> str:
    one = group.first
    masses: tuple = one.masses  # type: ignore[assignment]
    a, b = (dofs.word(dofs.number(mass, "masses")) for mass in (masses[0], masses[-1]))
    several = "masses" if dofs.noun == "mass" else f"{dofs.noun}s"
    mass = "the mass" if dofs.n == 1 and dofs.noun == "mass" else f"{dofs.noun} {b}"
    words = {
        "fixed-wall": f"friction between {mass} and a fixed wall",
        "joined-base-wall": f"friction between {mass} and a wall that moves with the base",
        "between-masses": f"friction between {several} {a} and {b}",
    }[one.kind]
    more = []
    if one.stiffness is not None:
        more.append(f"contact stiffness {group.stiffness:g}")
    if group.is_bank:
        more.append(f"bank of {len(one.elements)} elements")
    if one.wall_velocity:
        more.append(f"wall velocity {one.wall_velocity:g}")
    if one.wall_speed:
        more.append(f"wall speed {one.wall_speed:g}")
    if one.nu:
        more.append("varying normal load")
    if one.normal is not None:
        more.append(f"normal force of stiffness {one.normal.stiffness:g}, friction {one.normal.friction:g}")
    if one.law is not None:
        more.append(f"friction over speed, {len(one.law.speed)} segments")
    if len(group.members) > 1:
        more.append(f"{len(group.members)} parallel contacts as one")
    return f"{words} ({', '.join(more)})" if more else words
