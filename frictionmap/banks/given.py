"""Systems of the model in the form that is solved here, and what is refused."""

from typing import Any

import numpy as np

from ..errors import InputError
from ..general.held import least_static_friction, linear_parts, orders_of, stick_scales
from ..general.problem import modal_system
from ..general.starts import states_at
from ..model.general import DISPLACEMENT, ContactSystem, MergedContact
from ..model.system import System
from ..phases.arrays import modal
from .arrays import fastest, problem_of
from .system import Bank, BankSystem, Start, ordered

#: Largest rate of the fastest part of the motion, in tau.
_HIGHEST_RATE = 1e4


def _values(given: Any, count: int) -> np.ndarray:
    """Friction of every element: that of the list, or equal shares."""
    if isinstance(given, tuple):
        return np.array(given)
    return np.full(count, (given or 0.0) / count)


def _refuse_group(group: MergedContact, key: str) -> None:
    """Refuse what only contacts of other systems have."""
    first = group.first
    if group.stiffness is None:
        raise InputError(
            "cannot use",
            key,
            "beside a bank as one contact: it is rigid, and all contacts must be elastic there; give it a "
            'stiffness, or use bank = "elements"',
        )
    for name, there, why in (
        ("wall_velocity", bool(first.wall_velocity), "a wall that moves at constant velocity"),
        ("wall_speed", bool(first.wall_speed), "a wall that moves at constant velocity"),
        ("normal_load", bool(first.nu), "a normal load that varies"),
        ("normal_record", first.normal_record is not None, "a normal load that varies"),
        ("normal", group.normal is not None, "a contact that opens"),
    ):
        if there:
            raise InputError(
                "cannot use",
                f"{key}.{name}",
                f"with a bank as one contact: {why} is not offered there; omit it",
            )


def _bank(group: MergedContact, key: str) -> Bank:
    """A contact of one element or more."""
    _refuse_group(group, key)
    first = group.first
    given: Any = first.stiffness
    stiffness = np.atleast_1d(np.array(given, dtype=float))
    ratio, force = _values(first.ratio, stiffness.size), _values(first.force, stiffness.size)
    if first.force is not None:
        ratio = np.zeros(stiffness.size)
    return ordered(group.vector, stiffness, ratio, force, float(group.base))


def banks_of(general: ContactSystem) -> tuple[Bank, ...]:
    """The contacts of a system."""
    if general.springs:
        raise InputError(
            "cannot use", "springs", "with a bank as one contact: this is not offered there; omit it"
        )
    return tuple(_bank(group, f"contacts[{k}]") for k, group in enumerate(general.groups, 1))


def bank_system(system: System, r: float) -> BankSystem:
    """The structure, contacts and loads of a system at one frequency ratio > 0."""
    general = system.contact_system
    contacts = banks_of(general)
    if system.base_control != DISPLACEMENT:
        system = system.at_frequency(r)
        general = system.contact_system
    modes = system.modes
    loads = {n: linear_parts(system, modes.stiffness, n, np.array([r]))[1][0] for n in orders_of(general)}
    moved = dict(general.base) if any(one.moved for one in contacts) else {}
    offset = np.linalg.solve(modes.stiffness, general.offset) if general.offset.any() else None
    points = None if general.points is None else general.points.shapes
    return BankSystem(modes.mass, modes.damping, modes.stiffness, contacts, loads, moved, offset, points)


def needed_friction(system: System, r: np.ndarray) -> np.ndarray:
    """Friction of each contact, of all its elements, with which none of them slips, (n_r, N).

    All springs of the elements are stretched alike, by half the range of the force over their stiffness.  The
    one that slips first has the least friction over its stiffness.
    """
    given = bank_system(system, 1.0)
    if system.base_control == DISPLACEMENT:
        needed = least_static_friction(system, r)
    else:
        rows = [least_static_friction(system.at_frequency(float(one)), np.array([one])) for one in r]
        needed = np.concatenate(rows)
    with np.errstate(divide="ignore"):  # an element without friction always slips
        return needed * np.array([one.surplus for one in given.contacts])


def no_slip_limits(system: System, r: np.ndarray) -> np.ndarray:
    """beta from which no element of any contact slips, (n_r,)."""
    found = stick_scales(system.contact_system, needed_friction(system, r), np.ones(1))
    return np.asarray(found[0].max(axis=1))


def starts_of(system: System, r: np.ndarray, start: str) -> list[Start]:
    """The states from which motions begin, those of the general engine."""
    if system.base_control != DISPLACEMENT and r.size == 1:
        system = system.at_frequency(float(r[0]))
    modal = modal_system(system)
    states = states_at(system, modal, r, start)  # type: ignore[arg-type]
    return [Start(modal.phi @ q, modal.phi @ p, float(tau[0])) for q, p, tau in states]


def changes_with_r(system: System) -> bool:
    """Whether the loads on the masses depend on r."""
    relative = system.damping_reference == "base" and bool(system.modes.damping.any())
    return relative or system.base_control != DISPLACEMENT


def least_ratio(system: System) -> float:
    """Least r > 0 at which motions are followed."""
    given = bank_system(system, 1.0)
    return fastest(problem_of(given, modal(given), np.zeros((0, given.n)))) / _HIGHEST_RATE  # type: ignore[arg-type]


def check_ratios(system: System, r: np.ndarray) -> None:
    """Refuse frequencies at which a period of the load has too many steps."""
    if float(r[0]) <= 0.0:
        raise InputError("r", f"must be > 0 with a bank as one contact; got {r[0]:g}")
    least = least_ratio(system)
    if float(r[0]) < least:
        raise InputError(
            "r",
            f"must be >= {least:.3g} for this system: below, a period of the load has more than 10^4 periods "
            f"of the fastest free motion; got {r[0]:g}",
        )
