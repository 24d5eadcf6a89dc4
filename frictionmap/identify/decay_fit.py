"""The decay nearest to all samples: the number of half cycles before rest is one of its unknowns."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from .decay_motion import PARAMETERS, Decay, amplitudes, displacement_and_slopes, half_period
from .least_squares import Problem, Solution, minimise
from .robust import softened
from .turning_points import TurningPoints

#: The measured place of the centre may change by so much a second.
DRIFT = "drift"

#: In these the motion is linear.
_LINEAR = ("x_F", "X0", "centre", DRIFT)

ZETA, X_F = PARAMETERS.index("zeta"), PARAMETERS.index("x_F")

#: Damping ratios from which the search starts.
_DAMPINGS = (0.0, 0.003, 0.01, 0.03, 0.1, 0.3)

#: Half cycles that may hide in the noise after the last turning point that was seen.
_HIDDEN = 8

#: Samples of which the search makes use; the fit takes all.
_SEARCHED = 4000

#: Sums of squares that differ by less variances of a sample are alike: three standard errors.
_AS_GOOD = 9.0

#: Shares of the motion that no measurement tells: sums of smaller residuals are zero.
_ROUNDING = 1e-9

#: The natural frequency is within this share of what the turning points tell.
_FREQUENCY_RANGE = 0.2

#: Ranges in which the model holds; beyond 1 there are no turning points.
_ZETA_RANGE = (-0.5, 0.99)


class Record(NamedTuple):
    """What was measured, and what is fitted to it."""

    time: np.ndarray  # s
    x: np.ndarray
    known: Mapping[str, float]  # parameters that are held
    names: tuple[str, ...]  # of all parameters: those of a decay, and perhaps the drift
    outliers: float | None = None  # residuals beyond this have little weight

    def thinned(self, most: int) -> "Record":
        """The record with no more samples than `most`, or a few."""
        every = max(1, self.time.size // most)
        return self._replace(time=self.time[::every], x=self.x[::every])


class Fit(NamedTuple):
    """A decay, and whether the mass came to rest within the record."""

    solution: Solution
    half_cycles: int  # before rest, or begun in the record
    at_rest: bool

    @property
    def decay(self) -> Decay:
        """The parameters by their names."""
        return Decay(*(float(value) for value in self.solution.values[: len(PARAMETERS)]))

    @property
    def heights(self) -> np.ndarray:
        """A_0, A_1, ...: all turning points up to rest, or up to the end of the record."""
        return amplitudes(self.decay, self.half_cycles - (not self.at_rest))


def problem(record: Record, n: int, start: np.ndarray) -> Problem:
    """Least squares of all samples on a decay that ends at turning point `n`; a drift is that of the zero."""

    def residuals(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return _model(record, n, values, record.x)

    lowest, highest = np.full(start.size, -np.inf), np.full(start.size, np.inf)
    lowest[0], highest[0] = start[0] * (1.0 - _FREQUENCY_RANGE), start[0] * (1.0 + _FREQUENCY_RANGE)
    lowest[ZETA], highest[ZETA] = _ZETA_RANGE
    free = np.array([name not in record.known for name in record.names])
    floor = np.array([0.0 if name in ("zeta", "x_F") else -np.inf for name in record.names])
    return Problem(residuals, free, floor, lowest, highest)


def _model(
    record: Record, n: int, values: np.ndarray, less: np.ndarray | float
) -> tuple[np.ndarray, np.ndarray]:
    """The model less something, and its slopes by all parameters."""
    place, slopes = displacement_and_slopes(Decay(*values[: len(PARAMETERS)]), n, record.time)
    if len(record.names) > len(PARAMETERS):
        place = place + values[-1] * record.time
        slopes = np.column_stack((slopes, record.time))
    return place - less, slopes


def fit_decay(record: Record, points: TurningPoints) -> tuple[Fit, Problem]:
    """The least sum over all numbers of half cycles near what turning points tell.

    Of several that fit alike, one counts only if friction would not have held the mass before.
    """
    starts = _starts(record.thinned(_SEARCHED), points)
    numbers = sorted(starts)
    tried: dict[int, tuple[Fit, Problem]] = {}

    def attempt(place: int) -> float:
        n = numbers[place]
        if n not in tried:
            tried[n] = _fit(record, n, starts[n][1])
        return tried[n][0].solution.sum

    # sums fall towards the right number from both sides; the search begins at the best start
    begin = min(range(len(numbers)), key=lambda place: starts[numbers[place]][0])
    for step in (1, -1):
        place = begin
        while 0 <= place + step < len(numbers) and attempt(place + step) <= attempt(place):
            place += step
    attempt(len(numbers) - 1)  # not at rest in the record: this one always can be
    return _best(list(tried.values()), record.time.size, float(np.ptp(record.x)))


def _best(tried: list[tuple[Fit, Problem]], samples: int, size: float) -> tuple[Fit, Problem]:
    """The least sum; among those that chance alone tells apart the least one of a motion that can be."""
    tried = sorted(tried, key=lambda found: found[0].solution.sum)
    least = max(tried[0][0].solution.sum, samples * (_ROUNDING * size) ** 2)
    as_good = [found for found in tried if found[0].solution.sum <= least * (1.0 + _AS_GOOD / samples)]
    return min(as_good, key=lambda found: not _possible(found[0]))


def _fit(record: Record, n: int, start: np.ndarray) -> tuple[Fit, Problem]:
    task = problem(record, n, start)
    solution = minimise(task if record.outliers is None else softened(task, record.outliers), start)
    decay = Decay(*solution.values[: len(PARAMETERS)])
    in_record = int((record.time[-1] - decay.t0) / half_period(decay))
    return Fit(solution, min(n, in_record + 1), n <= in_record), task


def _possible(fit: Fit) -> bool:
    """Whether the spring overcame friction at every turning point that the mass left."""
    left = fit.heights[:-1] if fit.at_rest else fit.heights
    return bool((left > fit.decay.x_F).all()) or fit.decay.x_F == 0.0


def _starts(record: Record, points: TurningPoints) -> dict[int, tuple[float, np.ndarray]]:
    """For every number of half cycles worth a try the sum and the parameters of a good start.

    A decay is linear in x_F, X0, the centre and the drift: frequency and t0 are taken from the turning
    points, zeta from a list, and the rest is solved for.
    """
    time, known = record.time, record.known
    half = _half_period(points)
    f_n = known.get("f_n", 0.5 / half)
    count = points.time.size
    first = float(np.median(points.time - np.arange(count) * half))  # a release is seen too late
    up = 1.0 if points.place[0] > points.place[1] else -1.0
    if first < time[0]:  # noise at the beginning, not a turning point
        first, count, up = first + half, count - 1, -up
    starts: dict[int, tuple[float, np.ndarray]] = {}
    # either the record begins in a swing, or with the mass held at the first turning point
    for t0, sign, seen in ((first - half, -up, count), (first, up, count - 1)):
        in_record = int((time[-1] - t0) / half)
        resting = range(max(1, seen), min(seen + _HIDDEN, in_record) + 1) if known.get("x_F") != 0.0 else ()
        for n in {*resting, in_record + 2}:  # the last one: not at rest in the record
            for zeta in [known["zeta"]] if "zeta" in known else _DAMPINGS:
                found = _linear(record, n, Decay(f_n, zeta, 0.0, sign, known.get("t0", t0), 0.0))
                if n not in starts or found[0] < starts[n][0]:
                    starts[n] = found
    return starts


def _linear(record: Record, n: int, unit: Decay) -> tuple[float, np.ndarray]:
    """Sum and parameters of the least squares over what the motion is linear in; `unit` holds the others."""
    start = np.concatenate((unit, np.zeros(len(record.names) - len(unit))))
    linear = np.isin(record.names, _LINEAR)
    slopes = _model(record, n, start, 0.0)[1][:, linear]
    values = np.array([record.known.get(name, 0.0) for name in record.names])[linear]
    wanted = np.array([name not in record.known for name in record.names])[linear]
    rest = record.x - slopes @ values
    values[wanted] = np.linalg.lstsq(slopes[:, wanted], rest, rcond=None)[0]
    residual = record.x - slopes @ values
    start[linear] = values
    start[X_F] = max(start[X_F], 0.0)
    return float(residual @ residual), start


def _half_period(points: TurningPoints) -> float:
    """Half a period, by a line through the times of all turning points."""
    usual = float(np.median(np.diff(points.time)))
    steps = np.rint(np.diff(points.time) / usual)
    good = steps >= 1.0
    if not good.all() or points.time.size < 3:
        return usual
    number = np.concatenate(([0.0], np.cumsum(steps)))
    return float(np.polyfit(number, points.time, 1)[0])
