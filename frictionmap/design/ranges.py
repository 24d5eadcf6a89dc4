"""The ranges of friction in which a response stays within a limit over a band."""

import numpy as np

from ..datasets.amounts import DIGITS, UP
from ..errors import InputError, NoSteadyState
from .minimum import Points, changes, crossing
from .optimum import Optimum, describe_cells, find_optimum, largest
from .performance import PerformanceCurve
from .task import Task


def find_ranges(
    task: Task, curve: PerformanceCurve, limit: float, given: object
) -> tuple[Optimum, np.ndarray, np.ndarray]:
    """Find all ranges of beta with M(beta) <= limit: the optimum, where they begin and where they end.

    given : the limit as the user wrote it

    A range that reaches the lower end of the search begins there; one that reaches friction that holds over
    the whole band has no end.

    Raises
    ------
    InputError
        The limit is below the least peak.
    NoSteadyState
        A cell of the band has no periodic steady state, and may exceed the limit.
    """
    optimum = find_optimum(task, curve)
    if limit < optimum.best.size:
        least = task.amounts.response(optimum.best.size, UP, DIGITS)
        raise InputError(
            "limit",
            f"must be >= {least}, the least peak, at {task.amounts.friction_and_ratio(optimum.best.beta)}; "
            f"got {given}",
        )
    points = optimum.points

    def values(beta: np.ndarray) -> np.ndarray:
        return largest(curve.at(beta))

    refuse_unknown(task, curve, limit)
    ends = [crossing(values, points, int(k), limit) for k in changes(points, limit)]
    allowed = points.size <= limit
    begins_inside, ends_inside = bool(allowed[0]), bool(allowed[-1])
    if begins_inside:
        ends.insert(0, float(points.beta[0]))
    if ends_inside:
        ends.append(_last(task, points))
    return optimum, np.array(ends[0::2]), np.array(ends[1::2])


def refuse_unknown(task: Task, curve: PerformanceCurve, limit: float) -> None:
    """Refuse a limit that all known responses at some friction keep, but perhaps not those of other cells."""
    for beta, cells in curve.unknown.items():
        if cells.peak <= limit:
            raise NoSteadyState(
                f"cannot answer: {describe_cells(task.amounts, beta, cells)}, where all others keep the "
                "limit; narrow the band or the range of beta, or add damping"
            )


def _last(task: Task, points: Points) -> float:
    """The end of a range that reaches the end of the search: none where everything holds from there on."""
    return np.inf if points.beta[-1] >= task.stuck.beta else float(points.beta[-1])
