"""The decay nearest to all samples: the number of half cycles before rest is one of its unknowns."""

from typing import NamedTuple

import numpy as np

from ..signals.turning_points import TurningPoints
from ..statistics.correlation import long_inflation
from ..statistics.least_squares import Problem, Solution, minimise
from ..statistics.robust import effective_variance
from .motion import PARAMETERS, Decay, amplitudes, half_period, in_record, is_possible
from .problem import Record, plain_problem, problem, weighted_problem
from .starts import for_refining, starts

#: Sums of squares that differ by less variances of a sample are alike: three standard errors.
_AS_GOOD = 9.0

#: A start is not followed if its sum over some samples is larger by this: five standard errors.
_HOPELESS = 25.0

#: Fits at most, of starts that some of the samples cannot distinguish.
_MOST_FITS = 12

#: Shares of the motion that no measurement resolves: sums of smaller residuals are zero.
_ROUNDING = 1e-9


class DecayFit(NamedTuple):
    """A fitted decay, and whether the mass came to rest within the record."""

    n: int  # the turning point with which the model ends
    solution: Solution
    half_cycles: int  # before rest, or begun in the record
    at_rest: bool
    problem: Problem  # what was solved: outliers may have little weight
    plain: Problem  # each sample with its full weight

    @property
    def decay(self) -> Decay:
        """The parameters by their names."""
        return Decay(*(float(value) for value in self.solution.values[: len(PARAMETERS)]))

    @property
    def heights(self) -> np.ndarray:
        """A_0, A_1, ...: all turning points up to rest, or up to the end of the record."""
        return amplitudes(self.decay, self.half_cycles - (not self.at_rest))

    @property
    def possible(self) -> bool:
        """Whether the spring overcame friction at every turning point that the mass left."""
        return is_possible(self.decay, self.half_cycles)


def fit_decay(record: Record, points: TurningPoints) -> list[DecayFit]:
    """Fits with different numbers of half cycles that the noise cannot distinguish, the best one first.

    It has the least sum, if possible of those in which friction would not have held the mass before.
    """
    some = for_refining(record)
    least = reference = np.inf
    allowed = 0.0
    fits: list[DecayFit] = []
    for start in sorted(starts(record, points), key=lambda start: (not start.possible, start.sum)):
        # what friction would have held counts only if it fits clearly better
        margin = _HOPELESS if start.possible else -_AS_GOOD
        if start.sum > reference + margin * allowed or len(fits) == _MOST_FITS:
            continue
        fits.append(_fit(record, start.n, start.values))
        if fits[-1].solution.sum < least:
            least, allowed = fits[-1].solution.sum, noise_variance(record, fits[-1])
            reference = _sum(some, start.n, fits[-1].solution.values)
    alike = [fit for fit in fits if fit.solution.sum <= least + _AS_GOOD * allowed]
    alike.sort(key=lambda fit: (not fit.possible, fit.solution.sum))
    best = alike[0]
    return [best, *(fit for fit in alike[1:] if fit.possible and _same_release(fit, best))]


def refit(record: Record, fit: DecayFit) -> DecayFit:
    """A fit of a record that has further terms of a wander, with the same number of half cycles."""
    values = np.zeros(record.free.size)
    values[: fit.solution.values.size] = fit.solution.values
    return _fit(record, fit.n, values)


def noise_variance(record: Record, fit: DecayFit) -> float:
    """Variance of a sample for comparing fits: larger where residuals are correlated."""
    variance = sample_variance(record, fit) * long_inflation(fit.solution.residual) ** 2
    return max(variance, rounding_variance(record))


def rounding_variance(record: Record) -> float:
    """The variance of a sample below which residuals are rounding."""
    return (_ROUNDING * float(np.ptp(record.x))) ** 2


def sample_variance(record: Record, fit: DecayFit) -> float:
    """The variance of a sample by which slopes give the errors of estimates."""
    if record.outliers is not None:
        return effective_variance(
            weighted_problem(record, fit.n, fit.solution.values), fit.solution, record.outliers
        )
    return fit.solution.sum / freedom_of(record)


def freedom_of(record: Record) -> float:
    """Samples, by their weights, less unknowns; at least 1."""
    return max(record.counted - float(record.free.sum()), 1.0)


def _fit(record: Record, n: int, start: np.ndarray) -> DecayFit:
    task = problem(record, n, start)
    solution = minimise(task, start)
    decay = Decay(*solution.values[: len(PARAMETERS)])
    most = in_record(decay, record.time[-1])
    plain = plain_problem(record, n, start)
    return DecayFit(n, solution, min(n, most + 1), n <= most, task, plain)


def _sum(record: Record, n: int, values: np.ndarray) -> float:
    residual = problem(record, n, values).residuals(values)[0]
    return float(residual @ residual)


def _same_release(one: DecayFit, other: DecayFit) -> bool:
    """Whether two fits begin at the same turning point."""
    return abs(one.decay.t0 - other.decay.t0) < 0.5 * half_period(other.decay)
