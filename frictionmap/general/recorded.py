"""One steady state with the series of all its steps."""

from typing import Any, NamedTuple

import numpy as np

from .._kernels.compiler.lending import lent, made
from .._kernels.general.problem import H, Problem
from .._kernels.general.record import Record
from .._kernels.general.series import Friction
from .._kernels.general.steady import Steady, Workspace, make_workspace, one_steady_state


class Recorded(NamedTuple):
    """A steady state, or the last period followed, and its steps."""

    found: Steady
    halves: int  # half periods that the steps cover, see `one_steady_state`
    multiplier: float
    counts: np.ndarray  # see `follow`
    record: Record
    h: float  # length of an interval
    steps: int  # how many there are


class Memory(NamedTuple):
    """What a steady state is found and recorded in."""

    workspace: Workspace
    given: Any  # the same, lent


def make_memory(problem: Problem, masses: np.ndarray, most: int) -> Memory:
    """Allocate memory for a record of `most` steps; other problems of the same sizes can use it later."""
    workspace = made(make_workspace, problem, masses, most)
    return Memory(workspace, lent(workspace))


def recorded_state(
    problem: Problem, i: int, friction: Friction, start: np.ndarray, limits: tuple[int, float],
    masses: np.ndarray, memory: Memory, settled: bool = True,
) -> Recorded:  # fmt: skip
    """Find the steady state of one cell; where there is no room for all its steps, once more with more.

    Parameters
    ----------
    problem, i, friction, masses : see `one_steady_state`
    start : initial state, see `from_rest`
    limits : periods followed at most, and tolerance
    memory : what it is found in; the record is valid until that is used again
    settled : see `one_steady_state`
    """
    cycles, tolerance = limits
    while True:
        workspace, given = memory
        found, halves, multiplier = one_steady_state(
            lent(problem), i, lent(friction), start, float(cycles), tolerance, given, settled
        )
        record, steps = workspace.record, int(workspace.record.count[0])
        if steps <= record.steps.shape[0]:
            counts, h = workspace.memory.counts, float(workspace.row.numbers[H])
            return Recorded(found, halves, multiplier, counts, record, h, steps)
        memory = make_memory(problem, masses, 4 * steps)
