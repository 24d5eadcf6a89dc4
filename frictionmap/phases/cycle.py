"""Quantities of a steady motion over a cycle: harmonics, works, phases."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from .._kernels.phases.problem import SECTION
from ..general.cycle import first_harmonics, parts
from ..model.system import System
from .arrays import Modal
from .motion import Steps, at_times, traces_at
from .solve import Found

#: Gauss points of a part of a step, and the largest turn of a harmonic in a part: with these the integral of
#: a polynomial of the degree of a series times the harmonic is exact to rounding.
NODES, WEIGHTS = np.polynomial.legendre.leggauss(20)
TURN = 4.0

#: Phasor that is not known.
_UNKNOWN = complex(np.nan, np.nan)


class Points(NamedTuple):
    """A motion at the Gauss points of its steps."""

    tau: np.ndarray  # (T,)
    weights: np.ndarray  # (T,) of an integral over tau
    q: np.ndarray  # (m, T)
    rate: np.ndarray  # (m, T)
    friction: np.ndarray  # (N, T)


@dataclass(frozen=True)
class Cycle:
    """A steady motion and the structure that it is of."""

    system: System
    r: float
    found: Found
    steps: Steps

    @property
    def modal(self) -> Modal:
        """Modes, (n, m) in `phi`."""
        return self.found.modes

    @property
    def shapes(self) -> np.ndarray:
        """Displacements of the masses, or of the points of a structure given by modes, by the modes."""
        return self.modal.phi

    @property
    def period(self) -> int:
        """Periods of the load; 0: it does not repeat."""
        return self.found.period

    @property
    def drifts(self) -> bool:
        """Whether the motion is another one after each period: springs hold every structure here."""
        return False

    @property
    def begins(self) -> np.ndarray:
        """Times at which the steps begin."""
        return self.steps.begins

    def displacements(self, tau: np.ndarray, order: int = 0, row: int | slice = slice(None)) -> np.ndarray:
        """Displacements of the masses, or with `order` 1 their derivatives by tau; of one row or all."""
        length = 2.0 * np.pi * self.found.averaged
        found = at_times(self.steps, self.modal.squares.size, np.mod(tau - SECTION, length))
        return np.asarray(self.shapes[row] @ (found.rate if order else found.q))

    def points(self, highest: int) -> Points:
        """The motion at Gauss points that are dense enough for harmonics up to `highest`."""
        steps, many = self.steps, max(1, int(np.ceil(highest * self.steps.h / TURN)))
        count = steps.begins.size
        edges = (np.arange(many)[:, np.newaxis] + 0.5 * (NODES + 1.0)) / many  # of a step of length 1
        step = np.repeat(np.arange(count), edges.size)
        x = (steps.lengths[:, np.newaxis] * edges.ravel()).ravel()
        own = np.tile(0.5 * WEIGHTS / many, (count, many)) * steps.lengths[:, np.newaxis] * steps.h
        found = traces_at(steps, self.modal.squares.size, step, x)
        tau = SECTION + steps.begins[step] + x * steps.h
        return Points(tau, own.ravel(), found.q, found.rate, found.friction)


def harmonics(values: np.ndarray, points: Points, highest: int, periods: int) -> np.ndarray:
    """Harmonics 0 to `highest` of values (..., T): X_0 the mean, x = X_0 + Re sum X_n exp(i n tau)."""
    order = np.arange(highest + 1)
    waves = np.exp(-1j * np.outer(points.tau, order)) * points.weights[:, np.newaxis]
    found = values @ waves / (np.pi * periods)
    found[..., 0] *= 0.5
    return found


def harmonic_phasors(cycle: Cycle, highest: int) -> dict[str, np.ndarray]:
    """Harmonics of masses, contacts and friction forces; NaN of a motion that does not repeat."""
    problem, points = cycle.found.problem, cycle.points(highest)
    values = {
        "displacement_harmonic": cycle.shapes @ points.q, "contact_harmonic": problem.chi @ points.q,
        "friction_harmonic": points.friction,
    }  # fmt: skip
    found = {name: harmonics(one, points, highest, cycle.found.averaged) for name, one in values.items()}
    if problem.moved.any():  # with the base
        for n, place in cycle.system.at_frequency(cycle.r).contact_system.base.items():
            if n <= highest:
                found["contact_harmonic"][:, n] -= problem.moved * place
    if cycle.period:
        return found
    return {name: np.full_like(one, _UNKNOWN) for name, one in found.items()}


def in_contacts(cycle: Cycle, moved: np.ndarray, tau: np.ndarray, derivative: int = 0) -> np.ndarray:
    """Displacements of masses in contacts (N, T) relative to walls, which may move with the base.

    derivative : 0, or 1 for velocities
    """
    base = np.zeros_like(tau)
    for n, phasor in cycle.system.at_frequency(cycle.r).contact_system.base.items():
        base = base + ((1j * n) ** derivative * phasor * np.exp(1j * n * tau)).real
    return moved - cycle.found.problem.moved[:, np.newaxis] * base


def _base_velocity(cycle: Cycle, tau: np.ndarray) -> np.ndarray:
    """Velocity of the base to which the dampers are relative, dx/dtau."""
    found = np.zeros_like(tau)
    if cycle.system.damping_reference == "base":
        for n, phasor in cycle.system.at_frequency(cycle.r).contact_system.base.items():
            found += (1j * n * phasor * np.exp(1j * n * tau)).real
    return found


def work_values(cycle: Cycle) -> dict[str, np.ndarray]:
    """Works per period of the load; that of the load, or of what moves the base, by the balance.

    Of a motion that does not repeat only the work of friction is known, an average.
    """
    friction, wall = (cycle.found.numbers[name] for name in ("work_friction", "work_wall"))
    if not cycle.period:
        unknown = np.array(np.nan)
        return {"work_input": unknown, "work_damping": unknown, "work_friction": friction}
    points = cycle.points(1)
    velocity = cycle.modal.phi @ points.rate - _base_velocity(cycle, points.tau)
    power = (velocity * (cycle.system.modes.damping @ velocity)).sum(axis=0)
    damping = float(cycle.r * (power * points.weights).sum() / cycle.period)
    general = cycle.system.contact_system
    if general.base:
        given = float(friction.sum() + damping - wall.sum())
    else:
        x = harmonics(cycle.modal.phi @ points.q, points, max(general.forces), cycle.period)
        given = np.pi * sum(n * (p * x[:, n].conj()).imag.sum() for n, p in general.forces.items())
    return {"work_input": np.array(given), "work_damping": np.array(damping), "work_friction": friction}


def cycle_values(cycle: Cycle, highest: int) -> dict[str, np.ndarray]:
    """All quantities of a cell over a cycle; phasors as real and imaginary parts."""
    phasors = harmonic_phasors(cycle, max(highest, 1))
    return {
        **{name: parts(values) for name, values in phasors.items()},
        **first_harmonics(phasors),
        **work_values(cycle),
    }
