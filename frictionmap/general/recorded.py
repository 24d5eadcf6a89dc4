"""One steady state with the series of all its steps."""

from typing import NamedTuple

import numpy as np

from .._kernels.compiler.lending import lent, made
from .._kernels.general.problem import H, Problem
from .._kernels.general.record import Record
from .._kernels.general.series import Friction
from .._kernels.general.steady import Steady, make_workspace, one_steady_state

#: Steps that are kept at first.
_FIRST = 64


class Recorded(NamedTuple):
    """A steady state, or the last period followed, and its steps."""

    found: Steady
    halves: int  # half periods that the steps cover, see `one_steady_state`
    multiplier: float
    counts: np.ndarray  # see `follow`
    record: Record
    h: float  # length of an interval
    steps: int  # how many there are


def recorded_state(
    problem: Problem, i: int, friction: Friction, start: np.ndarray, limits: tuple[int, float],
    masses: np.ndarray, most: int = _FIRST, settled: bool = True,
) -> Recorded:  # fmt: skip
    """Find the steady state of one cell; where there is no room for all its steps, once more with more.

    Parameters
    ----------
    problem, i, friction, masses : see `one_steady_state`
    start : initial state, see `from_rest`
    limits : periods followed at most, and tolerance
    most : steps for which there is room at first; 0: none are kept
    settled : see `one_steady_state`
    """
    cycles, tolerance = limits
    while True:
        workspace = made(make_workspace, problem, masses, most)
        found, halves, multiplier = one_steady_state(
            lent(problem), i, lent(friction), start, float(cycles), tolerance, lent(workspace), settled
        )
        record, steps = workspace.record, int(workspace.record.count[0])
        if steps <= most or most == 0:
            counts, h = workspace.memory.counts, float(workspace.row.numbers[H])
            return Recorded(found, halves, multiplier, counts, record, h, steps)
        most = 4 * steps
