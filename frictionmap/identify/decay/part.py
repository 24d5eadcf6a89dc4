"""A free decay as a part of a joint fit."""

from collections.abc import Sequence

import numpy as np

from ..part import Part, Settings
from ..signals.turning_points import noise_level
from ..statistics.least_squares import Solution, continued_below
from ..statistics.robust import effective_variance, soften
from .free_decay import free_decay
from .motion import PARAMETERS
from .problem import plain_problem, record_of, weighted
from .rounding import rounding_weights

#: The natural frequency lies within this factor of that of the decay alone.
_RANGE = 1.5


def decay_part(label: str, arrays: Sequence[object], settings: Settings) -> Part:
    """A decay, fitted alone to begin with; it does not depend on mu."""
    time, x = arrays
    held = {name: value for name, value in settings.known.items() if name != "mu"}
    ds = free_decay(time, x, unit=settings.unit, known=held, loss=settings.loss)  # type: ignore[arg-type]
    record, n, start = record_of(ds, PARAMETERS)
    weights = rounding_weights(record.x, ds["model"].values)
    plain = continued_below(plain_problem(record, n, start))
    plain.lowest[0], plain.highest[0] = start[0] / _RANGE, start[0] * _RANGE
    problem, data = weighted(plain, weights), record.x
    sigma, level = float(ds["sigma"].values[0]), noise_level(data)
    if settings.loss == "soft_l1" and level > 0.0:
        at = Solution(start, *problem.residuals(start), np.zeros(start.size, dtype=bool))
        sigma = float(np.sqrt(effective_variance(problem, at, level)))
        problem = soften(problem, level)
    about_data = [
        one
        for one in str(ds.attrs["warnings"]).split("; ")
        if one.startswith(("clipped", "a gap", "the residuals have"))
    ]
    return Part(
        label, PARAMETERS, problem, start, sigma * float(ds["error_inflation"]), data.size - start.size,
        record.time, data, plain.residuals, tuple(about_data),
    )  # fmt: skip
