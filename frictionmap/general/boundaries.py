"""Boundaries of general systems: permanent sticking, motions without stops, belts that pull one way."""

from dataclasses import dataclass

import numpy as np

from .. import checks
from .._kernels.engine.policies import MOVING_START_CAP
from .._kernels.general.problem import Problem
from ..jobs import Watch
from ..model.settings import Start
from ..model.system import System
from .closed_limits import has_closed_limits
from .held import belt_limit, direct_displacements, least_static_friction, stick_scales
from .loops import loop_stick_scales, refuse_further_loops
from .no_stop import find_intervals, no_intervals, put_closed_limits
from .problem import ModalSystem, general_of, is_symmetric

#: Intervals without stops that are looked for in maps.
INTERVALS = 4

#: Displacements in contacts by modes that depend on those in others: singular values below, over the largest.
_DEPENDENT = 1e-12


@dataclass(frozen=True)
class Boundaries:
    """Boundaries over r; NaN where a system has none of the kind."""

    beta_stick: np.ndarray  # (n_mu, n_r) scale from which all contacts stick permanently
    beta_stick_contact: np.ndarray  # (n_mu, n_r, N)
    beta_lim: np.ndarray  # (n_mu, n_r) end of the first interval without stops
    begins: np.ndarray  # (n_mu, n_r, intervals)
    ends: np.ndarray
    wall_velocity_lim: np.ndarray  # (n_r,) NaN without one contact on a belt
    limit_kind: np.ndarray  # (n_mu, n_r) codes `regimes.LIMIT_KINDS`: what ends it
    limiting_contact: np.ndarray  # (n_mu, n_r) int: which contact stops there, counted from 1; 0: none


def friction_lines(system: System, mu: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Kinetic (N, 2) and static (n_mu, N, 2) friction as a line over beta: slope, value at 0."""
    groups = general_of(system).groups
    kinetic = np.empty((len(groups), 2))
    static = np.empty((mu.size, len(groups), 2))
    for j, group in enumerate(groups):
        for m, value in enumerate(mu):
            (k0, s0), (k1, s1) = group.friction(0.0, float(value)), group.friction(1.0, float(value))
            kinetic[j] = k1 - k0, k0
            static[m, j] = s1 - s0, s0
    return kinetic, static


def rest_states(system: System, modal: ModalSystem, r: np.ndarray) -> np.ndarray:
    """Modes and velocities at rest at tau = 0, (n_r, 2, m); masses at a joined wall have its displacement."""
    general = general_of(system)
    phi, mass, points = modal.phi, modal.mass, general.shaken_points
    if points is not None:
        return _points_at_rest(system, modal, r)
    x = np.zeros(len(mass))
    u = sum(value.real for value in general.base.values())
    moved = {group.vector.tobytes(): group.vector for group in general.groups if group.base}
    for vector in moved.values():  # of parallel contacts once
        x += u * vector / (vector @ vector)
    state = np.zeros((r.size, 2, phi.shape[1]))
    state[:, 0] = phi.T @ mass @ x
    alone = moving_alone(system, modal)
    state[:, 1, alone] = load_velocities(system, modal, r, np.zeros(r.size))[:, alone]
    return state


def _points_at_rest(system: System, modal: ModalSystem, r: np.ndarray) -> np.ndarray:
    """The states of `rest_states` of modes relative to the base: contacts are where masses have them."""
    general = general_of(system)
    assert general.points is not None
    vectors, iota = general.points.vectors, modal.phi.T @ general.moved(modal.mass)
    u, rate = sum(general.base.values()), sum(1j * n * one for n, one in general.base.items())
    moved = {row.tobytes(): row for row, base in zip(vectors, general.joined, strict=True) if base}
    x = sum((row / (row @ row) for row in moved.values()), np.zeros(vectors.shape[1]))
    state = np.zeros((r.size, 2, iota.size))
    state[:, 0], state[:, 1] = -u.real * iota, -rate.real * iota
    direct = sum(direct_displacements(general, order, r) for order in general.base)
    missing = u.real * (vectors @ x) - direct.real - state[:, 0] @ modal.chi.T
    state[:, 0] += missing @ np.linalg.pinv(modal.chi, rcond=_DEPENDENT).T
    alone = moving_alone(system, modal)
    state[:, 1, alone] = load_velocities(system, modal, r, np.zeros(r.size))[:, alone]
    return state


def stays_at_rest(system: System, start: Start) -> bool:
    """Whether a motion from rest never begins at or above beta_stick, whatever mu and the law of friction.

    Rigid contacts hold all masses, and the load is as large both ways: the place at rest is the best one.
    """
    general = general_of(system)
    held = general.count == general.vectors.shape[1] and not general.elastic.any() and not general.base
    alike = is_symmetric(general) and not any(group.first.nu for group in general.groups)
    return start == "rest" and held and alike


def moving_alone(system: System, modal: ModalSystem) -> np.ndarray:
    """Rigid-body modes that only the load moves, (m,) bool: they keep any velocity that they begin with."""
    untouched = ~modal.chi.any(axis=0) & ~modal.damping.any(axis=0)
    return (np.arange(modal.squares.size) < system.rigid_modes) & untouched


def load_velocities(system: System, modal: ModalSystem, r: np.ndarray, tau: np.ndarray) -> np.ndarray:
    """Velocities q' at phases tau (n_r,) of modes on which only the load acts, with the mean 0; (n_r, m)."""
    found = np.zeros((r.size, modal.squares.size))
    general = general_of(system)
    places = {
        order: -(modal.phi.T @ load) / np.where(r > 0.0, order * r, 1.0)[:, np.newaxis] ** 2
        for order, load in general.forces.items()
    }
    if general.shaken_points is not None:
        places = {order: -u * (modal.phi.T @ general.moved(modal.mass)) for order, u in general.base.items()}
    for order, place in places.items():
        found += (1j * order * place * np.exp(1j * order * tau)[:, np.newaxis]).real
    return found


def sliding_states(problem: Problem, r: np.ndarray, size: float) -> np.ndarray:
    """Modes and velocities at tau = 0 of the motion without friction, times `size`, (n_r, 2, m).

    The response of each mode is limited to `MOVING_START_CAP` times the static one.
    """
    loads = np.einsum("md,rdh->rmh", problem.push, problem.phasors[:, 0] - 1j * problem.phasors[:, 1])
    turn = problem.orders * r[:, np.newaxis]
    squares, damping = problem.squares[:, np.newaxis], np.diag(problem.damping)[:, np.newaxis]
    stiffness = squares - turn[:, np.newaxis] ** 2 + 1j * damping * turn[:, np.newaxis]
    least = np.maximum(squares, turn[:, np.newaxis] ** 2) / MOVING_START_CAP
    modulus = np.abs(stiffness)
    unit = np.where(modulus > 0.0, stiffness / np.where(modulus > 0.0, modulus, 1.0), 1.0)
    response = size * loads / (unit * np.maximum(modulus, least))
    velocity = 1j * problem.orders * response
    return np.ascontiguousarray(np.stack((response.real.sum(axis=2), velocity.real.sum(axis=2)), axis=1))


def _one_way_limit(system: System, r: np.ndarray) -> np.ndarray:
    """`belt_limit`; NaN where friction depends on the speed, and so the limit on the friction."""
    return np.full(r.size, np.nan) if general_of(system).has_law else belt_limit(system, r)


def _loop_boundaries(system: System, r: np.ndarray, mu: np.ndarray, intervals: int) -> Boundaries:
    """Boundaries of contacts that close loops: permanent sticking of all."""
    refuse_further_loops(general_of(system), mu)
    none = no_intervals((mu.size, r.size, intervals))
    return Boundaries(
        loop_stick_scales(system, r, mu),
        np.full((mu.size, r.size, general_of(system).count), np.nan),
        np.full((mu.size, r.size), np.nan),
        none.begins,
        none.ends,
        np.full(r.size, np.nan),
        none.kind,
        none.contact,
    )


def find_boundaries(
    system: System, r: np.ndarray, mu: np.ndarray, threads: int | None = None, watch: Watch | None = None,
    intervals: int = INTERVALS, searched: bool = True,
) -> Boundaries:  # fmt: skip
    """Find the boundaries over r; the intervals without stops take the longest.

    threads : number of threads; default: all processors of the process
    watch : called repeatedly; an exception raised by it ends the search
    intervals : number of intervals without stops that are looked for, from beta = 0 up
    searched : whether intervals are searched that are no closed forms; else they are NaN
    """
    general = general_of(system)
    if general.loop:
        return _loop_boundaries(system, r, mu, intervals)
    needed = least_static_friction(system, r)
    by_contact = stick_scales(general, needed, mu)
    stick = by_contact.max(axis=2)
    if general.elastic.any() or general.has_law:  # with a law the motion decides, see theory.md
        found = no_intervals((mu.size, r.size, intervals))
    elif not searched:
        found = no_intervals((mu.size, r.size, intervals))
        if has_closed_limits(system):
            put_closed_limits(system, r, mu, found)
    else:
        lines = friction_lines(system, mu)
        found = find_intervals(system, r, mu, lines, needed, intervals, checks.threads(threads), watch)
    first = np.where(found.begins[:, :, 0] == 0.0, found.ends[:, :, 0], 0.0)
    if general.has_law or not (searched or has_closed_limits(system)):
        first = np.full_like(first, np.nan)
    return Boundaries(
        stick,
        by_contact,
        first,
        found.begins,
        found.ends,
        _one_way_limit(system, r),
        found.kind,
        found.contact,
    )
