"""Structures of the torture test, for the package and in 40 digits."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

import frictionmap as fm

from ...references import closed_forms
from ...references.closed_forms import Number, mp

#: Masses up to which the condition number counts every ratio, and a name lists them.
FEW = 5


@dataclass(frozen=True)
class Body:
    """One structure, for the package and in 40 digits."""

    name: str
    system: fm.System
    masses: tuple[float, ...]
    springs: tuple[float, ...]
    zeta: float
    ground: tuple[float, ...] = ()  # springs of every mass to the ground beside the chain's, if any

    def precise(self, masses: Sequence, springs: Sequence, zeta: Number) -> closed_forms.Structure:
        """The structure in 40 digits, with these numbers."""
        mass, stiffness = closed_forms.chain_matrices(masses, springs)
        for i, spring in enumerate(self.ground):
            stiffness[i, i] += mp.mpf(spring)
        n = len(masses)
        load = [0.0] * n
        load[(self.system.load_mass or 1) - 1] = 1.0
        return closed_forms.structure(
            mass, stiffness, self.system.contact_vector.tolist(), load, self.system.base_motion, [zeta] * n
        )

    @cached_property
    def own(self) -> closed_forms.Structure:
        """The structure in 40 digits."""
        return self.precise(self.masses, self.springs, self.zeta)


def one_mass(zeta: float, contact: str = "fixed-wall") -> Body:
    """One mass."""
    name = f"{'wall' if contact == 'fixed-wall' else 'base-wall'}, zeta = {zeta!r}"
    return Body(name, fm.System(contact=contact, damping_ratios=zeta), (1.0,), (1.0,), zeta)


def chain(
    masses: Sequence[float], springs: Sequence[float], zeta: float, contact: Sequence[int], load: int = 1
) -> Body:
    """Chain with contact between a mass and a wall, or between two masses."""
    system = fm.System(
        contact="fixed-wall" if len(contact) == 1 else "between-masses", contact_masses=contact,
        load_mass=load, mass_ratios=masses, stiffness_ratios=springs, damping_ratios=zeta,
    )  # fmt: skip
    name = f"chain m {_few(masses)} k {_few(springs)}, contact {list(contact)}, zeta = {zeta!r}"
    return Body(name, system, tuple(masses), tuple(springs), zeta)


def _few(values: Sequence[float]) -> str:
    return f"{list(values)}".replace(".0", "") if len(values) <= FEW else f"[{len(values)}]"


def close_modes(n: int, coupling: float, zeta: float) -> Body:
    """Weakly coupled equal oscillators, each on its own spring: n frequencies within 2 `coupling`."""
    springs = [coupling] * n
    ground = [1.0] * n
    stiffness = np.diag(ground) + np.diag(springs) + np.diag(np.append(springs[1:], 0.0))
    stiffness -= np.diag(springs[1:], 1) + np.diag(springs[1:], -1)
    # what the package gets is rounded: in 40 digits it is the same
    system = fm.System(
        matrices={"M": np.eye(n), "K": stiffness}, frequency_scale=1.0, contact_masses=[1], load_mass=1,
        damping_ratios=zeta,
    )  # fmt: skip
    return Body(
        f"{n} oscillators coupled by {coupling:g}, zeta = {zeta!r}", system, (1.0,) * n, tuple(springs), zeta,
        tuple(np.diag(stiffness) - np.array(springs) - np.append(springs[1:], 0.0)),
    )  # fmt: skip


def chains(quick: bool) -> list[Body]:
    bodies = [chain((1.0, 1.0), (1.0, 1.0), 0.0, [1]), chain((1.0, 1.0), (1.0, 1.0), 0.01, [1, 2])]
    if not quick:
        bodies += [
            chain((1.0, 0.5, 2.0), (1.0, 2.0, 0.7), 0.0, [2]),
            chain((1.0,) * 5, (1.0,) * 5, 0.0, [3]),
            chain((1.0,) * 5, (1.0,) * 5, 0.01, [2, 4], 3),
        ]
    return bodies


def one_mass_rows(quick: bool) -> list[tuple[Body, float]]:
    ratios = (0.3, 1.0, 2.0) if quick else (
        0.05, 0.1, 0.2, 0.3, 1.0 / 3.0, 0.4, 0.5, 0.7, 0.999, 1.0, 1.0 + 1e-9, 1.2, 2.0, 5.0, 20.0, 100.0,
        1e4,
    )  # fmt: skip
    dampings = (0.0, 0.2) if quick else (0.0, 1e-6, 0.01, 0.2, 1.0, 3.0)
    contacts = ("fixed-wall",) if quick else ("fixed-wall", "joined-base-wall")
    return [(one_mass(z, c), r) for c in contacts for z in dampings for r in ratios]
