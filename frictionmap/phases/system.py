"""Matrices, contacts, springs and loads in one form, from a system or from arrays."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from .._kernels.phases.problem import ELASTIC, RIGID, SMOOTH
from ..model.spring_element import SpringElement


@dataclass(frozen=True)
class PhaseContact:
    """A contact.

    direction : (n,) c
    ratio : friction force over the grid's beta; None where `limit` or `preload` gives it
    limit : friction force that the grid does not change
    static : ratio of static to kinetic friction, None: that of the grid; 1 with a spring
    stiffness : kt; 0: rigid
    wall_speed, wall_velocity : of the wall, over omega_1 P/k1 or over omega P/k1
    moved : 1 where the wall moves with the base
    normal : (n,) d; None where the normal force is constant
    normal_stiffness, friction, preload : kn, phi, N0; N0 is None where it follows from the friction force
    """

    direction: np.ndarray
    ratio: float | None = 1.0
    limit: float | None = None
    static: float | None = None
    stiffness: float = 0.0
    wall_speed: float = 0.0
    wall_velocity: float = 0.0
    moved: float = 0.0
    normal: np.ndarray | None = None
    normal_stiffness: float = 0.0
    friction: float = 0.0
    preload: float | None = None

    @property
    def belt(self) -> float:
        """Velocity of the wall at r = 1."""
        return self.wall_speed + self.wall_velocity

    @property
    def law(self) -> int:
        """Its law in the kernels."""
        if self.normal is not None and self.friction == 0.0:
            return SMOOTH
        return ELASTIC if self.stiffness else RIGID

    def at(self, beta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Friction where d.x = 0, and the preload, over beta."""
        if self.preload is not None:
            preload = np.full_like(beta, self.preload)
            return self.friction * preload, preload
        limit = np.full_like(beta, self.limit) if self.limit is not None else (self.ratio or 0.0) * beta
        return limit, limit / self.friction if self.friction else limit


@dataclass(frozen=True)
class PhaseSystem:
    """A structure with contacts and springs.

    mass, damping, stiffness : (n, n)
    contacts, springs : PhaseContact, SpringElement
    loads : phasors (n,) by order
    base : phasors of the base motion by order, for walls that move with it
    offset : (n,) constant load
    """

    mass: np.ndarray
    damping: np.ndarray
    stiffness: np.ndarray
    contacts: Sequence[PhaseContact] = ()
    springs: Sequence[SpringElement] = ()
    loads: Mapping[int, np.ndarray] = field(default_factory=dict)
    base: Mapping[int, complex] = field(default_factory=dict)
    offset: np.ndarray | None = None

    @property
    def n(self) -> int:
        """Number of masses."""
        return self.mass.shape[0]
