"""One steady state with the series of all its steps."""

from typing import Any, NamedTuple

import numpy as np

from .._kernels.compiler.lending import lent, made
from .._kernels.general.problem import H, Problem
from .._kernels.general.record import Record
from .._kernels.general.series import Friction
from .._kernels.general.steady import Steady, make_workspace, one_steady_state


class Recorded(NamedTuple):
    """A steady state, or the last period followed, and its steps."""

    found: Steady
    halves: int  # half periods that the steps cover, see `one_steady_state`
    multiplier: float
    counts: np.ndarray  # see `follow`
    record: Record
    h: float  # length of an interval
    steps: int  # how many there are


class Memory:
    """What steady states of problems of the same sizes are found and recorded in, one after the other.

    problem : one of them
    masses : see `make_record`
    most : steps that there is room for at first; 0: none are kept
    """

    def __init__(self, problem: Problem, masses: np.ndarray, most: int) -> None:
        self._problem, self._masses = problem, masses
        self.make_room(most)

    def make_room(self, most: int) -> None:
        """Allocate the memory anew, for more steps."""
        self.workspace = made(make_workspace, self._problem, self._masses, most)
        self.given = lent(self.workspace)


def recorded_state(
    problem: Any, i: int, friction: Friction, start: np.ndarray, limits: tuple[int, float], memory: Memory,
    settled: bool = True,
) -> Recorded:  # fmt: skip
    """Find the steady state of one cell; where there is no room for all its steps, once more with more.

    Parameters
    ----------
    problem, i, friction : see `one_steady_state`; what is used again may be lent already
    start : initial state, see `from_rest`
    limits : periods followed at most, and tolerance
    memory : what it is found in; the record is valid until that is used again
    settled : see `one_steady_state`
    """
    cycles, tolerance = limits
    while True:
        found, halves, multiplier = one_steady_state(
            lent(problem), i, lent(friction), start, float(cycles), tolerance, memory.given, settled
        )
        workspace = memory.workspace
        record, steps = workspace.record, int(workspace.record.count[0])
        room = record.steps.shape[0]
        if steps <= room or room == 0:
            counts, h = workspace.memory.counts, float(workspace.row.numbers[H])
            return Recorded(found, halves, multiplier, counts, record, h, steps)
        memory.make_room(2 * steps)
