"""The structure in one phase under no load: its place of rest, and what would end the phase.

s is the state q, q', f of springs in contacts, 1.
"""

from typing import NamedTuple

import numpy as np

from .._kernels.phases.kept import LIFTED
from .._kernels.phases.problem import ELASTIC, RIGID, Cell, Problem
from .._kernels.phases.rest import Bed
from .bed import FREE, basis_beside


class Phase(NamedTuple):
    """One phase."""

    bed: Bed
    rest: np.ndarray  # (m, 2 m + N + 1) modes at the place of rest
    slowest: float  # lowest natural frequency; infinite if nothing vibrates
    held: np.ndarray  # (N,) bool: contacts that friction holds


class _Forces(NamedTuple):
    """Contacts and springs of a phase; forces that push the modes are -(stiffness q + given s)."""

    stiffness: np.ndarray  # (m, m) of the phase; contacts with springs are held by them
    now: np.ndarray  # (m, 2 m + N + 1) what pulls the modes back in a state
    held: np.ndarray  # (N,) bool: contacts that friction holds
    rigid: np.ndarray  # (N,) bool: those without a spring


def _forces(problem: Problem, cell: Cell, pattern: np.ndarray, load: np.ndarray) -> _Forces:
    """What acts in a phase whose contacts are open or held, under a constant load on the modes."""
    contacts, modes = problem.chi.shape
    size = 2 * modes + contacts + 1
    opened = pattern[:contacts] == LIFTED
    held = ~opened & ((problem.law == RIGID) | (problem.law == ELASTIC))
    elastic, rigid = held & (problem.law == ELASTIC), held & (problem.law == RIGID)
    kn = np.where(opened, 0.0, problem.pressed)
    stiffness = np.diag(problem.squares) + problem.normal.T @ (kn[:, np.newaxis] * problem.normal)
    constant = problem.normal.T @ np.where(
        problem.presses, np.where(opened, -np.maximum(cell.preload, 0.0), np.minimum(cell.preload, 0.0)), 0.0
    )
    for s, piece in enumerate(pattern[contacts:]):
        slope, knot = problem.slopes[s, piece], max(piece - 1, 0)
        stiffness += slope * np.outer(problem.along[s], problem.along[s])
        constant += problem.along[s] * (problem.forces[s, knot] - slope * problem.knots[s, knot])
    now = np.zeros((modes, size))
    now[:, :modes], now[:, -1] = stiffness, constant - load
    now[:, 2 * modes : -1][:, elastic] = problem.chi[elastic].T
    kt = np.where(elastic, problem.spring, 0.0)
    stiffness = stiffness + problem.chi.T @ (kt[:, np.newaxis] * problem.chi)
    return _Forces(stiffness, now, held, rigid)


class _Rows(NamedTuple):
    """Quantities at the place of rest, and their changes by each held mode over its energy."""

    values: list[np.ndarray]  # (2 m + N + 1,)
    gains: list[float]

    def put(self, value: np.ndarray, by_place: np.ndarray, by_rate: np.ndarray | None = None) -> None:
        self.values.append(value)
        rate = 0.0 if by_rate is None else float(by_rate @ by_rate)
        self.gains.append(float(np.sqrt(by_place @ by_place + rate)))


def bed_of(
    problem: Problem, cell: Cell, pattern: np.ndarray, free: int, still: bool, load: np.ndarray
) -> Phase:
    """Build it.

    free : modes of the structure; others are the place of the base, which stays
    still : whether no wall moves without a load
    load : (m,) constant load on the modes: by dampers, over which a base moves on
    """
    contacts, modes = problem.chi.shape
    size = 2 * modes + contacts + 1
    acting = _forces(problem, cell, pattern, load)
    basis = np.pad(basis_beside(problem.chi[acting.rigid, :free], free), ((0, modes - free), (0, 0)))
    within = basis.T @ acting.stiffness @ basis
    squares, shapes = np.linalg.eigh(within) if basis.shape[1] else (np.empty(0), np.empty((0, 0)))
    scale = max(np.abs(squares).max(initial=0.0), problem.squares.max(initial=0.0))
    restored = squares > FREE * scale
    shapes = basis @ shapes
    omega = np.sqrt(squares[restored])
    away = shapes[:, restored].T @ acting.now / (omega**2)[:, np.newaxis]
    rest = np.eye(modes, size) - shapes[:, restored] @ away
    vibration = np.vstack((omega[:, np.newaxis] * away, shapes.T @ np.eye(modes, size, modes)))
    by_place = shapes[:, restored] / omega
    rows = _margins(problem, cell, pattern, acting, rest, by_place, shapes)
    active = still and bool(restored.all())
    return Phase(
        Bed(
            pattern.astype(np.int64), np.ascontiguousarray(vibration),
            np.array(rows.values).reshape(len(rows.values), size), np.array(rows.gains),
            np.array([active], dtype=np.int64),
        ),
        np.ascontiguousarray(rest), float(omega.min(initial=np.inf)), acting.held,
    )  # fmt: skip


def _margins(
    problem: Problem, cell: Cell, pattern: np.ndarray, acting: _Forces, rest: np.ndarray,
    by_place: np.ndarray, shapes: np.ndarray,
) -> _Rows:  # fmt: skip
    """What ends a phase where it is zero.

    rest : (m, 2 m + N + 1) modes at rest; by_place (m, v), shapes (m, v) : places and rates of the modes by
        the coordinates of the vibration
    """
    contacts, size = problem.chi.shape[0], rest.shape[1]
    one, rows = np.eye(size)[-1], _Rows([], [])
    for j in np.flatnonzero(problem.presses):
        sign = -1.0 if pattern[j] == LIFTED else 1.0
        force = sign * problem.pressed[j] * problem.normal[j]
        rows.put(force @ rest + sign * cell.preload[j] * one, force @ by_place)
    values, places, rates = _held_forces(problem, acting, rest, by_place, shapes)
    for j in np.flatnonzero(acting.held):
        pressed = cell.static[j] * problem.lift[j] * problem.normal[j]
        most = pressed @ rest + cell.static[j] * cell.limit[j] * one
        for sign in (1.0, -1.0):
            rows.put(most - sign * values[j], pressed @ by_place - sign * places[j], rates[j])
    for s, piece in enumerate(pattern[contacts:]):
        for sign, knot, there in ((-1.0, piece, piece < problem.knot_count[s]), (1.0, piece - 1, piece > 0)):
            if there:
                along = sign * problem.along[s]
                rows.put(along @ rest - sign * problem.knots[s, knot] * one, along @ by_place)
    return rows


def _held_forces(
    problem: Problem, acting: _Forces, rest: np.ndarray, by_place: np.ndarray, shapes: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Forces in contacts at rest (N, 2 m + N + 1), by the places and by the rates of the vibration."""
    contacts, modes = problem.chi.shape
    size = rest.shape[1]
    values, places = np.zeros((contacts, size)), np.zeros((contacts, by_place.shape[1]))
    rates = np.zeros((contacts, shapes.shape[1]))
    elastic, rigid = acting.held & ~acting.rigid, acting.rigid
    pull = problem.spring[elastic, np.newaxis] * problem.chi[elastic]
    forces = np.eye(size)[2 * modes : -1][elastic]
    values[elastic] = forces + pull @ (rest - np.eye(modes, size))
    places[elastic] = pull @ by_place
    chi = problem.chi[rigid]
    if len(chi):
        back = np.linalg.solve(chi @ chi.T, chi)
        at_rest = acting.now + acting.stiffness @ (rest - np.eye(modes, size))
        values[rigid] = -back @ at_rest
        places[rigid] = -back @ acting.stiffness @ by_place
        rates[rigid] = -back @ problem.damping @ shapes
    return values, places, rates
