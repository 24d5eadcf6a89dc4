"""A structure whose contacts are banks of elastic elements, in one form."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np


@dataclass(frozen=True)
class Bank:
    """A contact of elastic elements in parallel, in the order in which they slip.

    direction : (n,) c
    stiffness : (E,) k of the elements
    ratio, force : (E,) friction of the elements: ratio times the grid's beta, plus force
    moved : 1 where the wall moves with the base
    """

    direction: np.ndarray
    stiffness: np.ndarray
    ratio: np.ndarray
    force: np.ndarray
    moved: float = 0.0

    def limits(self, beta: np.ndarray) -> np.ndarray:
        """Elongations at which the elements slip, (B, E)."""
        friction = self.ratio * beta[:, np.newaxis] + self.force
        return np.asarray(friction / self.stiffness)

    @property
    def surplus(self) -> float:
        """Friction of all elements over the force of all springs at which the first element slips."""
        friction = self.ratio + self.force
        least = (friction / self.stiffness).min()
        return float(friction.sum() / self.stiffness.sum() / least)


def ordered(
    direction: np.ndarray, stiffness: np.ndarray, ratio: np.ndarray, force: np.ndarray, moved: float
) -> Bank:
    """A bank of elements in any order, all of them with a ratio or all with a force."""
    order = np.argsort((ratio + force) / stiffness, kind="stable")
    return Bank(direction, stiffness[order], ratio[order], force[order], moved)


class Start(NamedTuple):
    """A state from which a motion is followed, with no force in the elements."""

    x: np.ndarray  # (n,)
    v: np.ndarray  # (n,) x'
    tau: float  # phase


@dataclass(frozen=True)
class BankSystem:
    """A structure with banks.

    mass, damping, stiffness : (n, n)
    contacts : Bank
    loads : phasors (n,) by order
    base : phasors of the base motion by order, for walls that move with it
    offset : (n,) displacements of the masses under the constant loads, about which the motion is: no spring
        of an element is stretched by them
    points : (p, n) displacements of points; None where the masses are the points
    """

    mass: np.ndarray
    damping: np.ndarray
    stiffness: np.ndarray
    contacts: tuple[Bank, ...]
    loads: Mapping[int, np.ndarray] = field(default_factory=dict)
    base: Mapping[int, complex] = field(default_factory=dict)
    offset: np.ndarray | None = None
    points: np.ndarray | None = None

    @property
    def n(self) -> int:
        """Number of masses."""
        return self.mass.shape[0]

    @property
    def rows(self) -> np.ndarray:
        """Displacements of all points, (p, n)."""
        return np.eye(self.n) if self.points is None else self.points
