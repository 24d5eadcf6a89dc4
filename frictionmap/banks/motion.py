"""One motion in time, from the Taylor terms of its steps."""

from typing import NamedTuple

import numpy as np

from .._kernels.banks.problem import Motion, Problem
from .._kernels.general.problem import SECTION


class Steps(NamedTuple):
    """The steps of a recorded motion, in order of time; a place x = 1 is the end of its series."""

    begins: np.ndarray  # (K,) tau since the section
    lengths: np.ndarray  # (K,) of the series, in tau
    ends: np.ndarray  # (K,) part of them that is the step
    terms: np.ndarray  # (K, LONG, m + N)
    level: np.ndarray  # (K, N)
    sense: np.ndarray  # (K, N)


def steps_of(problem: Problem, motion: Motion, offset: np.ndarray | None) -> Steps:
    """The steps that a record keeps, about displacements `offset` of the modes."""
    record, contacts = motion.record, problem.moved.size
    count = int(record.count[0])
    tau, length, end = record.times[:count].T
    patterns = record.patterns[:count]
    if offset is not None:
        record.steps[:count, 0, : offset.size] += offset
    return Steps(
        tau - SECTION, length, end, record.steps[:count], patterns[:, :contacts], patterns[:, contacts:]
    )


class Traces(NamedTuple):
    """A motion at some times."""

    q: np.ndarray  # (m, T)
    rate: np.ndarray  # (m, T) q'
    friction: np.ndarray  # (N, T)
    step: np.ndarray  # (T,) number of the step


def traces_at(steps: Steps, modes: int, step: np.ndarray, x: np.ndarray) -> Traces:
    """A motion at places x of some steps."""
    terms = steps.terms[step]
    values, rates = np.zeros(terms.shape[::2]), np.zeros(terms.shape[::2])
    for k in range(terms.shape[1] - 1, -1, -1):
        rates = rates * x[:, np.newaxis] + values
        values = values * x[:, np.newaxis] + terms[:, k]
    rates = rates / steps.lengths[step][:, np.newaxis]
    return Traces(values.T[:modes], rates.T[:modes], values.T[modes:], step)


def at_times(steps: Steps, modes: int, tau: np.ndarray) -> Traces:
    """A motion at phases; the steps are those of one period from the section on."""
    since = np.mod(tau - SECTION, 2.0 * np.pi)
    step = np.clip(np.searchsorted(steps.begins, since, side="right") - 1, 0, steps.begins.size - 1)
    x = np.clip((since - steps.begins[step]) / steps.lengths[step], 0.0, steps.ends[step])
    return traces_at(steps, modes, step, x)
