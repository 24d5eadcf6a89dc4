"""First harmonics of steady states at a list of points, each with its own frequency and friction ratio."""

from typing import NamedTuple

import numpy as np

from .. import regimes
from .._kernels.engine.quantities import LAG, MODULUS
from ..model.settings import Solver, Start
from ..model.system import System
from ..theory.boundary_curves import Curves, find_curves
from ..theory.half_waves import compliances, dynamic_amplification
from .quantity_data import quantity_request
from .scattered import AT_ONCE, allocate_at, follow


class States(NamedTuple):
    """Steady states at k points; NaN and unresolved where none exists or none was found."""

    phasors: np.ndarray  # (k, n) complex, X_k1 over P/k1 (Y); infinite at an undamped resonance
    regime: np.ndarray  # (k,) int8


def possible_states(system: System, r: np.ndarray, beta: np.ndarray, mu: float) -> list[States]:
    """Find the possible steady states at points that increase in r; see `steady.points`."""
    points = _Points(r, beta, mu)
    return _unique_states(system, points) if mu == 1.0 else _multiple_states(system, points)


class _Points(NamedTuple):
    r: np.ndarray  # (k,) increasing
    beta: np.ndarray  # (k,)
    mu: float


def _unique_states(system: System, points: _Points) -> list[States]:
    """Find the unique steady states of mu = 1."""
    at, index = np.unique(points.r, return_inverse=True)
    curves = find_curves(system, at, np.ones(1))
    lim, stick = curves.beta_lim[0, index], curves.beta_stick[0, index]
    friction = points.beta > 0.0
    stuck = friction & (points.beta >= stick)
    continuous = ~friction | (points.beta <= lim) & ~stuck
    states = _undefined_states(points.r.size, system.n)
    states.phasors[stuck] = system.modes.held_response(at)[index[stuck]]
    states.regime[stuck] = regimes.PERMANENT_STICKING
    _put_continuous(system, at, curves, index, points.beta, continuous, states)
    _follow(system, points, "rest", np.flatnonzero(~stuck & ~continuous), states)
    return [states]


def _multiple_states(system: System, points: _Points) -> list[States]:
    """Find steady states of mu > 1."""
    at, index = np.unique(points.r, return_inverse=True)
    curves = find_curves(system, at, np.array([points.mu]))
    continuous = (points.beta == 0.0) | (points.beta <= curves.beta_lim[0, index])
    states = [_undefined_states(points.r.size, system.n) for _ in range(3)]
    _put_continuous(system, at, curves, index, points.beta, continuous, states[0])
    moving = np.flatnonzero(points.beta > 0.0)
    _follow(system, points, "rest", moving, states[1])
    _follow(system, points, "moving", moving, states[2])
    return states


def _undefined_states(count: int, masses: int) -> States:
    return States(
        np.full((count, masses), complex(np.nan, np.nan)), np.full(count, regimes.UNRESOLVED, np.int8)
    )


def _put_continuous(
    system: System, r: np.ndarray, curves: Curves, index: np.ndarray, beta: np.ndarray, where: np.ndarray,
    states: States,
) -> None:  # fmt: skip
    """Fill in X_k1 = V_k - F_1 A_k(1) with F_1 = (4 i beta/pi) e^{-i phi_z}, theory.md 9, at some of the
    points.

    index : (k,) index of the frequency `r` of each point, for which the curves are
    where : (k,) bool
    """
    modes = system.modes
    index, beta = index[where], beta[where]
    v, u = curves.v[index], curves.u[index]
    swing = np.zeros_like(beta)
    np.multiply(beta, u, out=swing, where=beta > 0.0)  # without friction U may be infinite
    size = np.abs(v)
    responses = dynamic_amplification(modes, r) @ compliances(modes).T
    with np.errstate(invalid="ignore"):  # infinite at an undamped resonance
        root = np.sqrt(np.maximum(size - np.abs(swing), 0.0) * (size + np.abs(swing)))
        turn = (root + 1j * swing) / size * v / size  # e^{-i phi_z}, T(7.21)
        shift = (4j / np.pi * beta * turn)[:, np.newaxis] * responses[index]
        shift[beta == 0.0] = 0.0
        states.phasors[where] = modes.mass_responses(r)[index] - shift
    states.regime[where] = regimes.CONTINUOUS


def _follow(system: System, points: _Points, start: Start, chosen: np.ndarray, states: States) -> None:
    """Fill in the steady states reached from an initial state at the chosen points."""
    solver = Solver(start=start, outputs=("regime", "status"))
    request = quantity_request(("first_harmonic_amplitude", "first_harmonic_phase"))
    for first in range(0, chosen.size, AT_ONCE):
        some = chosen[first : first + AT_ONCE]
        rows = np.arange(some.size)
        found = allocate_at(system, points.r[some], points.beta[some], points.mu, solver, request)
        follow(found, rows)
        firsts = found.cells.results.firsts[0, rows, found.column, : system.n]
        size, lag = firsts[..., MODULUS], firsts[..., LAG]
        states.phasors[some] = size * np.exp(-1j * np.where(size == 0.0, 0.0, lag))  # at rest: no lag
        states.regime[some] = found.out.regime[0, rows, found.column]
