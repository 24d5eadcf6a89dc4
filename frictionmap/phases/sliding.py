"""Steady sliding on belts: its place, and the growth of small vibrations.

K_s x* = load, with the stiffness of the contacts that are closed and of the pieces of the springs at x*.
"""

from typing import NamedTuple

import numpy as np

from ..general.slopes import first_order
from .system import PhaseSystem

#: Phases that are tried until one holds its own equilibrium.
_MOST_TRIALS = 60

#: Growth below this share of the fastest rate is the rounding error of eigenvalues.
_ROUNDING = 1e-12


class Sliding(NamedTuple):
    """Steady sliding of one cell."""

    place: np.ndarray  # (n,) x*; NaN without one
    normal_force: np.ndarray  # (N,)
    growth: float  # largest real part of the roots, over omega_1; NaN without a place
    frequency: float  # its imaginary part
    stiffness: np.ndarray  # (n, n) of its phase; NaN without a place

    @property
    def is_stable(self) -> bool:
        """Whether small vibrations decay."""
        return self.growth < 0.0


def _pieces(system: PhaseSystem, x: np.ndarray) -> list[int]:
    """Piece of every spring at a place."""
    return [int(np.searchsorted(one.displacement, one.direction @ x)) for one in system.springs]


def steady_sliding(system: PhaseSystem, limit: np.ndarray, preload: np.ndarray) -> Sliding:
    """The equilibrium in which every contact slides on its belt, or is open.

    A contact without a belt rests at a place of its own: then there is none.

    Parameters
    ----------
    system : PhaseSystem
    limit : (N,) friction where d.x = 0
    preload : (N,) N0
    """
    n, count = system.n, len(system.contacts)
    none = Sliding(np.full(n, np.nan), np.full(count, np.nan), np.nan, np.nan, np.full((n, n), np.nan))
    belts = np.array([one.belt for one in system.contacts])
    if any(one.friction != 0.0 or one.normal is None for one in np.array(system.contacts)[belts == 0.0]):
        return none
    x = np.zeros(n)
    phase = (np.zeros(count, dtype=bool), _pieces(system, x))
    for _ in range(_MOST_TRIALS):
        stiffness, load = _phase_of(system, phase, limit, preload, -np.sign(belts))
        try:
            x = np.linalg.solve(stiffness, load)
        except np.linalg.LinAlgError:
            return none
        force = normal_forces(system, preload, x)
        found = (force < 0.0, _pieces(system, x))
        if (found[0] == phase[0]).all() and found[1] == phase[1]:
            roots = np.linalg.eigvals(first_order(system.mass, system.damping, stiffness))
            worst = roots[np.argmax(roots.real)]
            growth = float(worst.real) if abs(worst.real) > _ROUNDING * np.abs(roots).max() else 0.0
            return Sliding(x, np.maximum(force, 0.0), growth, float(abs(worst.imag)), stiffness)
        phase = found
    return none


def normal_forces(system: PhaseSystem, preload: np.ndarray, x: np.ndarray) -> np.ndarray:
    """N of every contact, as if it were closed."""
    moved = [
        0.0 if one.normal is None else one.normal_stiffness * (one.normal @ x) for one in system.contacts
    ]
    return preload + np.array(moved)


def _phase_of(
    system: PhaseSystem, phase: tuple[np.ndarray, list[int]], limit: np.ndarray, preload: np.ndarray,
    senses: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:  # fmt: skip
    """Stiffness and constant load in a phase in which all closed contacts slide."""
    opened, pieces = phase
    stiffness = system.stiffness.astype(float)
    load = np.zeros(system.n) if system.offset is None else np.asarray(system.offset, dtype=float).copy()
    for j, one in enumerate(system.contacts):
        if one.normal is not None:
            load += one.normal * (max(preload[j], 0.0) if opened[j] else -min(preload[j], 0.0))
        if opened[j]:
            continue
        load -= senses[j] * limit[j] * one.direction
        if one.normal is not None:
            push = one.normal + senses[j] * one.friction * one.direction
            stiffness = stiffness + one.normal_stiffness * np.outer(push, one.normal)
    for spring, piece in zip(system.springs, pieces, strict=True):
        knot, slope, c = max(piece - 1, 0), spring.slopes[piece], spring.direction
        stiffness = stiffness + slope * np.outer(c, c)
        load -= (spring.force[knot] - slope * spring.displacement[knot]) * c
    return stiffness, load
