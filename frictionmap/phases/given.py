"""Systems of the model in the form that is solved here."""

from dataclasses import dataclass

import numpy as np

from ..errors import InputError
from ..general.held import linear_parts, orders_of
from ..general.problem import refuse_loop
from ..model.general import DISPLACEMENT, ContactSystem, MergedContact, refuse_banks
from ..model.system import System
from .arrays import fastest, modal, problem_of
from .system import PhaseContact, PhaseSystem

#: Largest rate of the fastest part of the motion, in tau.
_HIGHEST_RATE = 1e4


@dataclass(frozen=True)
class GivenContact(PhaseContact):
    """A contact of a system, whose friction may be that of several parallel ones."""

    group: MergedContact | None = None

    def at(self, beta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Friction where d.x = 0, and the preload, over beta."""
        assert self.group is not None
        normal = self.group.normal
        if normal is not None and normal.preload is not None:
            preload = np.full_like(beta, normal.preload)
            return normal.friction * preload, preload
        limit = np.zeros_like(beta) + self.group.friction(beta, 1.0)[0]
        return limit, limit if normal is None else normal.preload_at(limit)


def _static(group: MergedContact, key: str) -> float | None:
    """Ratio of static to kinetic friction, of all its parallel contacts; None: that of the grid."""
    ratios = {one.mu for one in group.members}
    if len(ratios) > 1:
        raise InputError(
            key,
            "must have the mu of the contacts that are parallel to it, beside contacts that open or "
            f"piecewise linear springs; got {', '.join(str(one) for one in sorted(ratios, key=str))}",
        )
    return ratios.pop()


def _refuse_group(group: MergedContact, key: str) -> None:
    """Refuse what only contacts of other systems have."""
    first = group.first
    for name, there, why in (
        ("law", first.law is not None, "friction over speed"),
        ("normal_load", bool(first.nu), "a given normal load"),
    ):
        if there:
            raise InputError(
                "cannot use",
                f"{key}.{name}",
                f"beside contacts that open or piecewise linear springs: {why} is not offered there; omit it",
            )


def _contact(group: MergedContact, key: str) -> GivenContact:
    _refuse_group(group, key)
    first, normal = group.first, group.normal
    own = {"stiffness": group.stiffness or 0.0, "wall_speed": first.wall_speed, "group": group}
    own["moved"] = float(group.base)
    if normal is not None:
        own |= {
            "normal": normal.direction, "normal_stiffness": normal.stiffness, "friction": normal.friction,
            "preload": normal.preload,
        }  # fmt: skip
    return GivenContact(group.vector, static=_static(group, key), wall_velocity=first.wall_velocity, **own)  # type: ignore[arg-type]


def phase_system(system: System, r: float) -> PhaseSystem:
    """The structure, contacts, springs and loads of a system at one frequency ratio > 0."""
    general: ContactSystem = system.contact_system
    refuse_loop(general)
    refuse_banks(system, "compute motions with contacts that open or piecewise linear springs")
    if system.base_control != DISPLACEMENT:
        system = system.at_frequency(r)
        general = system.contact_system
    modes = system.modes
    contacts = [_contact(group, f"contacts[{k}]") for k, group in enumerate(general.groups, 1)]
    loads = {n: linear_parts(system, modes.stiffness, n, np.array([r]))[1][0] for n in orders_of(general)}
    return PhaseSystem(
        modes.mass, modes.damping, modes.stiffness, contacts, general.springs, loads, dict(general.base),
        general.offset,
    )  # fmt: skip


def changes_with_r(system: System) -> bool:
    """Whether the loads on the masses depend on r."""
    relative = system.damping_reference == "base" and bool(system.modes.damping.any())
    return relative or system.base_control != DISPLACEMENT


def least_ratio(system: System) -> float:
    """Least r > 0 at which motions are followed."""
    given = phase_system(system, 1.0)
    return fastest(problem_of(given, modal(given), np.zeros((0, system.n)))) / _HIGHEST_RATE


def check_ratios(system: System, r: np.ndarray) -> None:
    """Refuse frequencies at which a period of the load has too many steps."""
    if float(r[0]) <= 0.0:
        raise InputError(
            "r", f"must be > 0 with contacts that open or piecewise linear springs; got {r[0]:g}"
        )
    least = least_ratio(system)
    if float(r[0]) < least:
        raise InputError(
            "r",
            f"must be >= {least:.3g} for this system: below, a period of the load has more than 10^4 periods "
            f"of the fastest free motion; got {r[0]:g}",
        )
