"""The decay nearest to all samples: the number of half cycles before rest is one of its unknowns."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from .decay_motion import PARAMETERS, Decay, amplitudes, displacement_and_slopes, half_period
from .least_squares import Problem, Solution, minimise
from .turning_points import TurningPoints

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


class Fit(NamedTuple):
    """A decay, and whether the mass came to rest within the record."""

    solution: Solution
    half_cycles: int  # before rest, or begun in the record
    at_rest: bool

    @property
    def decay(self) -> Decay:
        """The parameters by their names."""
        return Decay(*(float(value) for value in self.solution.values))

    @property
    def heights(self) -> np.ndarray:
        """A_0, A_1, ...: all turning points up to rest, or up to the end of the record."""
        return amplitudes(self.decay, self.half_cycles - (not self.at_rest))


def problem(time: np.ndarray, x: np.ndarray, n: int, start: Decay, known: Mapping[str, float]) -> Problem:
    """Least squares of all samples on a decay that ends at turning point `n`."""

    def residuals(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        place, slopes = displacement_and_slopes(Decay(*values), n, time)
        return place - x, slopes

    lowest, highest = np.full(len(PARAMETERS), -np.inf), np.full(len(PARAMETERS), np.inf)
    lowest[0], highest[0] = start.f_n * (1.0 - _FREQUENCY_RANGE), start.f_n * (1.0 + _FREQUENCY_RANGE)
    lowest[ZETA], highest[ZETA] = _ZETA_RANGE
    free = np.array([name not in known for name in PARAMETERS])
    floor = np.array([0.0 if name in ("zeta", "x_F") else -np.inf for name in PARAMETERS])
    return Problem(residuals, free, floor, lowest, highest)


def fit_decay(
    time: np.ndarray, x: np.ndarray, points: TurningPoints, known: Mapping[str, float]
) -> tuple[Fit, Problem]:
    """The least sum over all numbers of half cycles near what turning points tell.

    Of several that fit alike, one counts only if friction would not have held the mass before.
    """
    starts = _starts(time, x, points, known)
    numbers = sorted(starts)
    tried: dict[int, tuple[Fit, Problem]] = {}

    def attempt(place: int) -> float:
        n = numbers[place]
        if n not in tried:
            tried[n] = _fit(time, x, n, starts[n][1], known)
        return tried[n][0].solution.sum

    # sums fall towards the right number from both sides; the search begins at the best start
    begin = min(range(len(numbers)), key=lambda place: starts[numbers[place]][0])
    for step in (1, -1):
        place = begin
        while 0 <= place + step < len(numbers) and attempt(place + step) <= attempt(place):
            place += step
    attempt(len(numbers) - 1)  # not at rest in the record: this one always can be
    return _best(list(tried.values()), time.size, float(np.ptp(x)))


def _best(tried: list[tuple[Fit, Problem]], samples: int, size: float) -> tuple[Fit, Problem]:
    """The least sum; among those that chance alone tells apart the least one of a motion that can be."""
    tried = sorted(tried, key=lambda found: found[0].solution.sum)
    least = max(tried[0][0].solution.sum, samples * (_ROUNDING * size) ** 2)
    as_good = [found for found in tried if found[0].solution.sum <= least * (1.0 + _AS_GOOD / samples)]
    return min(as_good, key=lambda found: not _possible(found[0]))


def _fit(
    time: np.ndarray, x: np.ndarray, n: int, start: Decay, known: Mapping[str, float]
) -> tuple[Fit, Problem]:
    task = problem(time, x, n, start, known)
    solution = minimise(task, np.array(start))
    decay = Decay(*solution.values)
    in_record = int((time[-1] - decay.t0) / half_period(decay))
    return Fit(solution, min(n, in_record + 1), n <= in_record), task


def _possible(fit: Fit) -> bool:
    """Whether the spring overcame friction at every turning point that the mass left."""
    left = fit.heights[:-1] if fit.at_rest else fit.heights
    return bool((left > fit.decay.x_F).all()) or fit.decay.x_F == 0.0


def _starts(
    time: np.ndarray, x: np.ndarray, points: TurningPoints, known: Mapping[str, float]
) -> dict[int, tuple[float, Decay]]:
    """For every number of half cycles worth a try the sum and the parameters of a good start.

    A decay is linear in x_F, X0 and the centre: frequency and t0 are taken from the turning points, zeta from
    a list, and the rest is solved for.
    """
    every = max(1, time.size // _SEARCHED)
    time, x = time[::every], x[::every]
    half = _half_period(points)
    f_n = known.get("f_n", 0.5 / half)
    count = points.time.size
    first = float(np.median(points.time - np.arange(count) * half))  # a release is seen too late
    up = 1.0 if points.place[0] > points.place[1] else -1.0
    if first < time[0]:  # noise at the beginning, not a turning point
        first, count, up = first + half, count - 1, -up
    starts: dict[int, tuple[float, Decay]] = {}
    # either the record begins in a swing, or with the mass held at the first turning point
    for t0, sign, seen in ((first - half, -up, count), (first, up, count - 1)):
        in_record = int((time[-1] - t0) / half)
        resting = range(max(1, seen), min(seen + _HIDDEN, in_record) + 1) if known.get("x_F") != 0.0 else ()
        for n in {*resting, in_record + 2}:  # the last one: not at rest in the record
            for zeta in [known["zeta"]] if "zeta" in known else _DAMPINGS:
                found = _linear(time, x, n, Decay(f_n, zeta, 0.0, sign, known.get("t0", t0), 0.0), known)
                if n not in starts or found[0] < starts[n][0]:
                    starts[n] = found
    return starts


def _linear(
    time: np.ndarray, x: np.ndarray, n: int, unit: Decay, known: Mapping[str, float]
) -> tuple[float, Decay]:
    """Sum and parameters of the least squares over x_F, X0 and centre; `unit` holds the others."""
    names = ("x_F", "X0", "centre")
    slopes = displacement_and_slopes(unit, n, time)[1][:, [PARAMETERS.index(name) for name in names]]
    wanted = [name not in known for name in names]
    values = np.array([known.get(name, 0.0) for name in names])
    rest = x - slopes @ values
    values[wanted] = np.linalg.lstsq(slopes[:, wanted], rest, rcond=None)[0]
    residual = x - slopes @ values
    friction, first, centre = (float(value) for value in values)
    start = unit._replace(x_F=max(friction, 0.0), X0=first, centre=centre)
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
