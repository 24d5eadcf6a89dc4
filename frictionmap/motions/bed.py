"""The structure with all contacts held, after a record: its place of rest, and whether it moves again."""

from typing import NamedTuple

import numpy as np

from .._kernels.general.problem import Problem
from .._kernels.history.asleep import Bed
from ..general.problem import pull_of

#: Squared frequencies of held modes below this share of the largest are those of motions that nothing
#: restores, computed with rounding error.
FREE = 1e-13

#: A force by walls that go on is 0 below this share of what the stiffest mode needs.
_DRAGGED = 1e-9


class Held(NamedTuple):
    """The structure with all contacts held; s is the state q, q', f of springs."""

    bed: Bed
    rest: np.ndarray  # (m, 2 m + N) modes at the place of rest
    slowest: float  # lowest natural frequency of the held structure; infinite if nothing vibrates
    restored: bool  # whether every motion that the contacts leave has one


class Left(NamedTuple):
    """What a base that keeps a velocity goes on doing after its record."""

    walls: np.ndarray  # (N,) velocities of walls
    load: np.ndarray  # (m,) constant load by dampers to the ground

    def at(self, bed: Bed, squares: np.ndarray, factor: float) -> Bed:
        """The bed after a record of this factor; squares : (m,) of the frequencies of the modes."""
        restored = squares > 0.0
        still = not factor or not (self.walls.any() or self.load[~restored].any())
        shift = factor * np.where(restored, self.load / np.where(restored, squares, 1.0), 0.0)
        return bed._replace(active=bed.active * int(still), shift=shift)


def left_by(problem: Problem, last: np.ndarray, step: float) -> Left:
    """Find it.

    last : (D, terms) polynomials of the channels after the record, over intervals of length `step`
    """
    return Left(problem.base @ last[:, 1] / step, problem.push @ last[:, 0])


def dragged(problem: Problem, left: Left) -> np.ndarray:
    """Contacts whose forces grow without end while all of them are held at walls that go on, (N,) bool.

    Static forces F that give every contact the velocity w of its wall: K q = chi^T F, chi q + F/kt = w.
    """
    walls, elastic = left.walls + problem.belt, problem.spring > 0.0
    flexible = np.where(elastic, 1.0 / np.where(elastic, problem.spring, 1.0), 0.0)
    both = np.block([[np.diag(problem.squares), -problem.chi.T], [problem.chi, np.diag(flexible)]])
    forces = np.linalg.lstsq(both, np.concatenate((0.0 * problem.squares, walls)))[0][problem.squares.size :]
    stiffness = problem.squares.max() / (problem.chi**2).sum(axis=1) + problem.spring
    return np.asarray(np.abs(forces) > _DRAGGED * stiffness * np.abs(walls).max())


def basis_beside(rigid: np.ndarray, modes: int) -> np.ndarray:
    """Orthonormal motions (m, h) that the held rigid contacts leave."""
    if not rigid.size:
        return np.eye(modes)
    _, sizes, right = np.linalg.svd(rigid)
    rank = int((sizes > sizes[0] * 1e-12).sum())
    return right[rank:].T


def held(problem: Problem) -> Held:
    """Build it from a system in modal coordinates of unit mass."""
    contacts, modes = problem.chi.shape
    size = 2 * modes + contacts
    elastic = problem.spring > 0.0
    chi_r, chi_e, kt = problem.chi[~elastic], problem.chi[elastic], problem.spring[elastic]
    if problem.coupling.flexibility.size:
        kt = np.linalg.inv(problem.coupling.flexibility)
    q = np.eye(modes, size)
    p = np.eye(modes, size, modes)
    f = np.eye(contacts, size, 2 * modes)[elastic]
    basis = basis_beside(chi_r, modes)
    stiffness = basis.T @ (np.diag(problem.squares) + chi_e.T @ pull_of(kt, chi_e)) @ basis
    squares, shapes = np.linalg.eigh(stiffness) if basis.shape[1] else (np.empty(0), np.empty((0, 0)))
    restored = squares > FREE * max(squares.max(initial=0.0), problem.squares.max(initial=0.0))
    shapes_r = basis @ shapes[:, restored]
    omega = np.sqrt(squares[restored])
    pull = shapes_r.T @ (problem.squares[:, np.newaxis] * q + chi_e.T @ f)
    away = pull / (omega**2)[:, np.newaxis]  # held modes, from their place of rest
    rest = q - shapes_r @ away
    springs = f - pull_of(kt, chi_e @ (q - rest))
    vibration = np.vstack((omega[:, np.newaxis] * away, (basis @ shapes).T @ p))
    forces, gains = np.zeros((contacts, size)), np.zeros(contacts)
    forces[elastic] = springs
    gains[elastic] = np.linalg.norm(pull_of(kt, chi_e @ shapes_r) / omega, axis=1)
    if chi_r.size:
        mobility = chi_r @ chi_r.T
        load = problem.squares[:, np.newaxis] * rest + chi_e.T @ springs
        forces[~elastic] = -np.linalg.solve(mobility, chi_r @ load)
        by_place = (np.diag(problem.squares) + chi_e.T @ pull_of(kt, chi_e)) @ shapes_r / omega
        by_rate = problem.damping @ basis @ shapes
        both = np.linalg.solve(mobility, chi_r @ np.hstack((by_place, by_rate)))
        paired = np.zeros((both.shape[0], by_rate.shape[1]))
        paired[:, restored] = both[:, : omega.size]
        gains[~elastic] = np.sqrt((paired**2).sum(axis=1) + (both[:, omega.size :] ** 2).sum(axis=1))
    belt = bool(problem.belt.any())
    return Held(
        Bed(
            np.ascontiguousarray(vibration), np.ascontiguousarray(forces), gains,
            np.array([not belt], dtype=np.int64), np.zeros(modes),
        ),
        np.ascontiguousarray(rest), float(omega.min(initial=np.inf)), bool(restored.all()),
    )  # fmt: skip
