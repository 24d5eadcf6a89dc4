"""One motion in time, from the Taylor terms of its steps."""

from typing import NamedTuple

import numpy as np

from .._kernels.general.problem import LONG, SECTION
from .._kernels.phases.problem import ELASTIC, Motion, Problem, Row
from .arrays import Modal
from .system import PhaseSystem

#: Gauss points of a step: powers of series of TERMS terms are integrated to rounding.
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(20)


class Steps(NamedTuple):
    """The steps of a recorded motion, in order of time."""

    begins: np.ndarray  # (K,) tau since the section
    lengths: np.ndarray  # (K,) in units of h
    terms: np.ndarray  # (K, LONG, m + N)
    sense: np.ndarray  # (K, N)
    open: np.ndarray  # (K, N) bool
    piece: np.ndarray  # (K, S)
    h: float


def steps_of(problem: Problem, row: Row, motion: Motion) -> Steps:
    """The steps that a record keeps."""
    record, contacts = motion.record, problem.law.size
    count = int(record.count[0])
    table, patterns = record.steps[:count], record.patterns[:count]
    lengths = table[:, LONG, 1]
    begins = np.concatenate(([0.0], np.cumsum(lengths * row.h)[:-1]))
    return Steps(
        begins, lengths, table[:, :LONG], patterns[:, :contacts],
        patterns[:, contacts : 2 * contacts].astype(bool), patterns[:, 2 * contacts :], row.h,
    )  # fmt: skip


def _powers(x: np.ndarray, derivative: int) -> np.ndarray:
    """Powers of x, or their derivatives, (points, LONG)."""
    k = np.arange(LONG)
    factor = np.ones(LONG)
    for i in range(derivative):
        factor = factor * (k - i)
    exponents = np.maximum(k - derivative, 0)
    return factor * x[:, np.newaxis] ** exponents


class Traces(NamedTuple):
    """A motion at some times."""

    q: np.ndarray  # (m, T)
    rate: np.ndarray  # (m, T) q'
    friction: np.ndarray  # (N, T)
    step: np.ndarray  # (T,) number of the step


def traces_at(steps: Steps, modes: int, step: np.ndarray, x: np.ndarray) -> Traces:
    """A motion at places x of some steps."""
    terms = steps.terms[step]
    values = np.einsum("tk,tki->it", _powers(x, 0), terms)
    rates = np.einsum("tk,tki->it", _powers(x, 1), terms[:, :, :modes]) / steps.h
    return Traces(values[:modes], rates, values[modes:], step)


def at_times(steps: Steps, modes: int, tau: np.ndarray) -> Traces:
    """A motion at times after the section."""
    step = np.clip(np.searchsorted(steps.begins, tau, side="right") - 1, 0, steps.begins.size - 1)
    x = np.clip((tau - steps.begins[step]) / steps.h, 0.0, steps.lengths[step])
    return traces_at(steps, modes, step, x)


def base_motion(system: PhaseSystem, tau: np.ndarray) -> np.ndarray:
    """Displacement of the base."""
    found = np.zeros_like(tau)
    for n, place in system.base.items():
        found = found + (place * np.exp(1j * n * tau)).real
    return found


def loads_at(system: PhaseSystem, tau: np.ndarray) -> np.ndarray:
    """Loads on the masses, (n, T), the constant ones too."""
    found = np.zeros((system.n, tau.size))
    for n, load in system.loads.items():
        found = found + (np.asarray(load)[:, np.newaxis] * np.exp(1j * n * tau)).real
    if system.offset is not None:
        found = found + np.asarray(system.offset, dtype=float)[:, np.newaxis]
    return found


def works(system: PhaseSystem, modes: Modal, steps: Steps, r: float, periods: int) -> dict[str, np.ndarray]:
    """Works of the load and of viscous damping per period of the load."""
    many = steps.begins.size
    step = np.repeat(np.arange(many), _NODES.size)
    x = (0.5 * (_NODES + 1.0)[np.newaxis] * steps.lengths[:, np.newaxis]).ravel()
    weights = (0.5 * _WEIGHTS[np.newaxis] * steps.lengths[:, np.newaxis] * steps.h).ravel()
    found = traces_at(steps, modes.squares.size, step, x)
    velocity = modes.phi @ found.rate
    load = loads_at(system, SECTION + steps.begins[step] + x * steps.h)
    given = (weights * (load * velocity).sum(axis=0)).sum()
    taken = (weights * r * (velocity * (system.damping @ velocity)).sum(axis=0)).sum()
    return {"work_input": np.array(given / periods), "work_damping": np.array(taken / periods)}


def events(steps: Steps) -> dict[str, np.ndarray]:
    """Where a contact slides, stops, opens or closes, in order of time after the section."""
    state = np.where(steps.open, 2, steps.sense)
    k, j = np.nonzero(state != np.roll(state, 1, axis=0))
    return {
        "event_tau": steps.begins[k] + SECTION, "event_contact": j + 1,
        "event_direction": steps.sense[k, j].astype(np.int8), "event_open": steps.open[k, j].astype(np.int8),
    }  # fmt: skip


def in_time(
    system: PhaseSystem, problem: Problem, modes: Modal, steps: Steps, preload: np.ndarray, tau: np.ndarray
) -> dict[str, np.ndarray]:
    """Displacements, velocities, forces and phases at times.

    Parameters
    ----------
    system, problem, modes, steps : PhaseSystem, Problem, Modal, Steps
    preload : (N,) N0
    tau : phases >= 0 within the cycle; the record begins at the section
    """
    length = float(steps.begins[-1] + steps.lengths[-1] * steps.h)
    found = at_times(steps, modes.squares.size, np.mod(tau - SECTION, length))
    x, opened = modes.phi @ found.q, steps.open[found.step].T
    z = problem.chi @ found.q - problem.moved[:, np.newaxis] * base_motion(system, tau)
    force = preload[:, np.newaxis] + problem.pressed[:, np.newaxis] * (problem.normal @ found.q)
    stretched = problem.along @ found.q
    traces = {
        "x": x, "v": modes.phi @ found.rate, "z": z, "friction": found.friction,
        "direction": steps.sense[found.step].T.astype(np.int8), "open": opened.astype(np.int8),
        "normal_force": np.where(opened, 0.0, force), "spring_displacement": stretched,
        "spring_force": np.array([one(u) for one, u in zip(system.springs, stretched, strict=True)])
        if system.springs else np.zeros((0, tau.size)),
    }  # fmt: skip
    if (problem.law == ELASTIC).any():
        kt = problem.spring[:, np.newaxis]
        with np.errstate(divide="ignore", invalid="ignore"):
            traces["y"] = np.where(kt > 0.0, z - found.friction / kt, np.nan)
    return traces
