"""A structure with contacts and springs as arrays for the kernels."""

from typing import NamedTuple

import numpy as np

from .._kernels.general.problem import TURN
from .._kernels.phases.fill import Cells, Grid
from .._kernels.phases.problem import COUNT_ROWS, ELASTIC, Problem, Row, make_row
from ..general.problem import ties
from .system import PhaseSystem


class Modal(NamedTuple):
    """A structure in modal coordinates."""

    squares: np.ndarray  # (m,) w^2
    phi: np.ndarray  # (n, m), modal mass 1
    damping: np.ndarray  # (m, m)


def modal(system: PhaseSystem) -> Modal:
    """Modes of the structure without contacts and springs."""
    root = np.linalg.inv(np.linalg.cholesky(system.mass))
    squares, vectors = np.linalg.eigh(root @ system.stiffness @ root.T)
    phi = root.T @ vectors
    return Modal(squares, phi, phi.T @ system.damping @ phi)


def _rows(vectors: list[np.ndarray], n: int) -> np.ndarray:
    return np.array(vectors, dtype=float).reshape(len(vectors), n)


def problem_of(system: PhaseSystem, modes: Modal, observed: np.ndarray) -> Problem:
    """The arrays of a system; `observed` (R, n) are further displacements whose extremes are wanted."""
    n, contacts, springs = system.n, system.contacts, system.springs
    law = np.array([one.law for one in contacts], dtype=np.int64).reshape(len(contacts))
    place = np.full(law.size, -1, dtype=np.int64)
    place[law == ELASTIC] = 2 * n + np.arange(np.count_nonzero(law == ELASTIC))
    presses = np.array([one.normal is not None for one in contacts], dtype=bool).reshape(law.size)
    pressed = np.array([one.normal_stiffness for one in contacts], dtype=float)
    most = max((len(one.displacement) for one in springs), default=1)
    knots, forces = np.zeros((len(springs), most)), np.zeros((len(springs), most))
    slopes = np.zeros((len(springs), most + 1))
    for s, one in enumerate(springs):
        count = len(one.displacement)
        knots[s, :count], forces[s, :count] = one.displacement, one.force
        slopes[s, : count + 1] = one.slopes
    normal = [np.zeros(n) if one.normal is None else one.normal for one in contacts]
    return Problem(
        modes.squares, np.ascontiguousarray(modes.damping),
        np.ascontiguousarray(_rows([one.direction for one in contacts], n) @ modes.phi),
        np.ascontiguousarray(_rows(normal, n) @ modes.phi),
        np.ascontiguousarray(_rows([one.direction for one in springs], n) @ modes.phi),
        law, place, presses, pressed,
        np.array([one.friction * one.normal_stiffness for one in contacts], dtype=float),
        np.array([one.stiffness for one in contacts], dtype=float),
        np.array([one.moved for one in contacts], dtype=float), knots, forces, slopes,
        np.array([len(one.displacement) for one in springs], dtype=np.int64).reshape(len(springs)),
        np.ascontiguousarray(observed @ modes.phi), _ties(system),
    )  # fmt: skip


def _ties(system: PhaseSystem) -> np.ndarray:
    """The rigid contacts that together keep an elastic one as it is, (N, N) bool; see `ties`.

    They keep both its ends at rest, and d.x if its normal force moves.
    """
    contacts, count = system.contacts, len(system.contacts)
    if not contacts:
        return np.zeros((0, 0), dtype=bool)
    vectors = [one.direction for one in contacts]
    vectors += [np.zeros(system.n) if one.normal is None else one.normal for one in contacts]
    # a wall_speed and a wall_velocity are the same at one r only
    belts = [[one.wall_speed, one.wall_velocity] for one in contacts] + [[0.0, 0.0]] * count
    moved = [one.moved for one in contacts] + [0.0] * count
    # all vectors d, and the c of elastic contacts, are asked for
    asked = [one.stiffness for one in contacts] + [1.0] * count
    found = ties(
        np.column_stack((_rows(vectors, system.n), np.array(belts))), np.array(moved), np.zeros(2 * count),
        np.array(asked),
    )  # fmt: skip
    ends, pressed = found[:count, :count], found[count:, :count]
    for j, one in enumerate(contacts):
        if one.law != ELASTIC or (one.normal is not None and not (ends[j].any() and pressed[j].any())):
            ends[j] = False
        elif one.normal is not None:
            ends[j] |= pressed[j]
    return np.ascontiguousarray(ends)


def fastest(problem: Problem) -> float:
    """Bound on the rate of the fastest part of the motion in any phase, in t = tau/r.

    The roots of l^2 + c l + k have moduli of (c + sqrt(c^2 + 4 k))/2 at most; k bounds the norm of the
    stiffness of every phase, whose part by friction is not symmetric.
    """
    stiffness = np.diag(np.abs(problem.squares))
    stiffness = stiffness + problem.chi.T @ (problem.spring[:, np.newaxis] * problem.chi)
    stiffness = stiffness + problem.normal.T @ (problem.pressed[:, np.newaxis] * problem.normal)
    stiffest = np.abs(problem.slopes).max(axis=1, initial=0.0)
    stiffness = stiffness + problem.along.T @ (stiffest[:, np.newaxis] * problem.along)
    turned = problem.lift * np.linalg.norm(problem.chi, axis=1) * np.linalg.norm(problem.normal, axis=1)
    k = float(np.linalg.eigvalsh(stiffness)[-1] + turned.sum())
    c = float(np.linalg.norm(problem.damping, 2))
    return 0.5 * (c + np.sqrt(c * c + 4.0 * k))


def row_of(system: PhaseSystem, problem: Problem, modes: Modal, r: float) -> Row:
    """The constants of one frequency ratio."""
    orders = sorted({*system.loads, *system.base})
    phasors = np.zeros((len(orders), system.n + 1), dtype=complex)
    for n, load in system.loads.items():
        phasors[orders.index(n), :-1] = modes.phi.T @ load
    for n, place in system.base.items():
        phasors[orders.index(n), -1] = place
    rate = max(fastest(problem) / r, float(max(orders)))
    intervals = int(np.ceil(2.0 * np.pi * rate / TURN))
    belt = np.array([one.wall_velocity + one.wall_speed / r for one in system.contacts])
    return make_row(
        problem, r, 2.0 * np.pi / intervals, intervals, belt.reshape(problem.law.size),
        np.array(orders, dtype=float), np.ascontiguousarray(np.stack((phasors.real, -phasors.imag))),
    )  # fmt: skip


def grid_of(system: PhaseSystem, modes: Modal, beta: np.ndarray, mu: float, cycles: int) -> Grid:
    """Friction and preloads of the cells of one frequency ratio, from rest."""
    shape = (beta.size, len(system.contacts))
    limit, preload, static = np.zeros(shape), np.zeros(shape), np.ones(shape)
    offset = np.zeros(system.n) if system.offset is None else np.asarray(system.offset, dtype=float)
    constant = np.tile(modes.phi.T @ offset, (beta.size, 1))
    for j, one in enumerate(system.contacts):
        limit[:, j], preload[:, j] = one.at(beta)
        if one.stiffness == 0.0:
            static[:, j] = mu if one.static is None else one.static
        if one.normal is None:
            preload[:, j] = limit[:, j]
    return Grid(limit, static, preload, constant, np.zeros((2, system.n)), cycles)


def allocate(problem: Problem, many: int) -> Cells:
    """Allocate cells."""
    contacts, modes = problem.chi.shape
    springs, rows = problem.along.shape[0], problem.observed.shape[0]
    size = 2 * modes + int((problem.place >= 0).sum())

    def empty(*shape: int) -> np.ndarray:
        return np.full((many, *shape), np.nan)

    width = rows + 2 * contacts + springs
    return Cells(
        empty(5), empty(COUNT_ROWS, contacts), empty(width), empty(width), empty(contacts), empty(contacts),
        empty(contacts), empty(springs), empty(springs), empty(size),
    )  # fmt: skip
