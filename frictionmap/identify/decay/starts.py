"""Starting values for a decay: each number of half cycles before rest has a minimum of its own.

A decay is linear in x_F, X0, the centre and the drift.  Frequency and t0 are taken from the turning points,
zeta from a list, the linear unknowns are solved for, and steps of Levenberg and Marquardt improve the result.
"""

from typing import NamedTuple

import numpy as np

from ..signals.turning_points import TurningPoints, gaps_after, hides_turning_points, regular_run
from .motion import PARAMETERS, Decay, in_record, is_possible
from .problem import X_F, Record, model, problem

#: Damping ratios from which the search starts.
_DAMPINGS = (0.0, 0.01, 0.03, 0.1, 0.2, 0.35, 0.6)

#: Half cycles can hide in the noise after the last turning point that was found: the search for more ends
#: where this many in a row fit no better.
_HIDDEN = 8

#: Number of the last turning points found that may be noise.
_DOUBTED = 2

#: Samples by which starts are compared, and by which they are improved; a fit takes all samples.
_COMPARED, _IMPROVED = 400, 1600

#: Levenberg's damping: where it begins, by what it grows and falls, and where it is given up.
_FIRST, _GROWTH, _FALL, _LAST = 1e-3, 8.0, 0.2, 1e6

#: A sum has settled when a step lowers it by less than this share of it; most steps.
_SETTLED, _STEPS = 1e-5, 25


class Start(NamedTuple):
    """Starting values of a fit."""

    n: int  # half cycles before rest
    values: np.ndarray  # shape (unknowns,)
    sum: float  # of squares, of the samples of `for_refining`
    end: float  # of the record, s

    @property
    def possible(self) -> bool:
        """Whether the spring overcomes friction at every turning point that the mass leaves in the record."""
        decay = Decay(*self.values[: len(PARAMETERS)])
        return is_possible(decay, max(1, min(self.n, in_record(decay, self.end) + 1)))


class _Release(NamedTuple):
    """A turning point at which the decay may begin, the last one before the record or one within it."""

    t0: float  # s
    sign: float
    seen: int  # turning points after it up to the last one that was found


def for_refining(record: Record) -> Record:
    """The samples by which starts are improved."""
    return record.thinned(_IMPROVED)


def starts(record: Record, points: TurningPoints) -> list[Start]:
    """The best start for each number of half cycles before rest, and for no rest, by their sums."""
    half, points = _with_release(record, points)
    found = [
        start
        for release in _releases(record, points, half)
        for start in _starts_after_release(record, release, half)
    ]
    different: list[Start] = []
    for start in sorted(found, key=lambda start: start.sum):
        if not any(_alike(start, other, half) for other in different):
            different.append(start)
    return different


def _alike(one: Start, other: Start, half: float) -> bool:
    """Whether two starts have the same number of half cycles after the same turning point."""
    t0 = PARAMETERS.index("t0")
    return one.n == other.n and abs(one.values[t0] - other.values[t0]) < 0.5 * half


def _with_release(record: Record, points: TurningPoints) -> tuple[float, TurningPoints]:
    """Half a period [s], and the points with the end of a rest before them in the place of a part of it.

    A mass that is held looks like a turning point at any time before its release.  Of two points this one
    decides on the half period, so it is taken as twice the time from the middle of the swing to its end.
    """
    half = usual_half(points)
    if points.time.size > 2 or record.sensor is not None or gaps_after(record.time).size:
        return half, points  # those of a sensor are moved, and a gap may hide the middle
    begin, end = points.time[-2], points.time[-1]
    middle = 0.5 * (points.place[-2] + points.place[-1])
    swing = (record.time >= begin) & (record.time <= end)
    before = swing & ((record.x > middle) == (points.place[-2] > middle))
    if not before.any():
        return half, points
    own = 2.0 * (end - float(record.time[before][-1]))
    times = points.time.copy()
    times[0] = max(times[0], times[1] - own * (points.number[1] - points.number[0]))
    return own, points._replace(time=times)


def usual_half(points: TurningPoints) -> float:
    """Half a period [s], by a line through the times of turning points that follow each other regularly."""
    run = regular_run(points)
    number, time = points.number[run], points.time[run]
    if number.size < 2:
        return float(np.median(np.diff(points.time) / np.diff(points.number)))
    return float(np.polyfit(number, time, 1)[0])


def _releases(record: Record, points: TurningPoints, half: float) -> list[_Release]:
    """Turning points from which the record may follow the decay."""
    time = record.time
    first = float(np.median(points.time - points.number * half))  # a release is seen too late
    last, up = int(points.number[-1]), 1.0 if points.upper[0] else -1.0
    if first < time[0]:  # noise at the beginning, not a turning point
        first, last, up = first + half, last - 1, -up
    # either the record begins in a swing, or with the mass held at the first turning point
    earliest = 1
    if hides_turning_points(time[time <= points.time[0]], half):  # or with others, which a gap hides
        earliest = max(1, int(np.ceil((first - time[0]) / half)))
    # what a velocity or an acceleration shows of a held mass is an extreme of its noise, no turning point
    latest = -1 if record.sensor is not None and record.sensor.order else 0
    return [_Release(first - k * half, up * (-1.0) ** k, last + k) for k in range(latest, earliest + 1)]


def _starts_after_release(record: Record, release: _Release, half: float) -> list[Start]:
    """The best start for each number of half cycles after a release."""
    compared, improved = record.thinned(_COMPARED), for_refining(record)
    most = int((record.time[-1] - record.known.get("t0", release.t0)) / half)
    guesses = _guesses(record, release, half)
    found = [_best_start(compared, improved, most + 2, guesses)]  # not at rest in the record
    if record.known.get("x_F") == 0.0:
        return found
    least, failed = np.inf, 0
    for n in range(max(1, release.seen - _DOUBTED), most + 1):
        if n > release.seen and failed >= _HIDDEN:
            break
        found.append(_best_start(compared, improved, n, [*guesses, found[-1].values]))
        failed = 0 if found[-1].sum < least else failed + 1
        least = min(least, found[-1].sum)
    return found


def _guesses(record: Record, release: _Release, half: float) -> list[np.ndarray]:
    """Unknowns, of which only those that are not linear count, for several damping ratios."""
    known, guesses = record.known, []
    for zeta in [known["zeta"]] if "zeta" in known else _DAMPINGS:
        guess = np.zeros(record.free.size)
        f_n = 0.5 / (half * np.sqrt(1.0 - zeta**2))
        guess[: len(PARAMETERS)] = known.get("f_n", f_n), zeta, 0.0, release.sign, release.t0, 0.0
        guesses.append(guess)
    return guesses


def _best_start(compared: Record, improved: Record, n: int, guesses: list[np.ndarray]) -> Start:
    """The guess with the least sum, improved."""
    solved = [_solve_linear_part(compared, n, guess) for guess in guesses]
    return _refine_start(improved, n, min(solved, key=lambda found: found[0])[1])


def _solve_linear_part(record: Record, n: int, guess: np.ndarray) -> tuple[float, np.ndarray]:
    """Sum and unknowns of the least squares over those that the motion is linear in."""
    values = guess.copy()
    for index, name in enumerate(record.names):
        values[index] = record.known.get(name, values[index])
    linear, wanted = record.linear, record.linear & record.free
    slopes = model(record, n, values)[1]
    held = linear & ~wanted
    rest = record.x - slopes[:, held] @ values[held]
    values[wanted] = np.linalg.lstsq(slopes[:, wanted], rest, rcond=None)[0]
    residual = rest - slopes[:, wanted] @ values[wanted]
    values[X_F] = max(values[X_F], 0.0)
    return float(residual @ residual), values


def _refine_start(record: Record, n: int, values: np.ndarray) -> Start:
    """A start after steps of Levenberg and Marquardt; bounds from below are not heeded."""
    task = problem(record, n, values)
    residual, slopes = task.residuals(values)
    least, damping = float(residual @ residual), _FIRST
    for _ in range(_STEPS):
        trial = values.copy()
        trial[task.free] -= _step(residual, slopes[:, task.free], damping)
        trial = np.clip(trial, task.lowest, task.highest)
        tried, its_slopes = task.residuals(trial)
        found = float(tried @ tried)
        if not found < least:
            damping *= _GROWTH
            if damping > _LAST:
                break
            continue
        settled = least - found < _SETTLED * least
        values, residual, slopes, least, damping = trial, tried, its_slopes, found, damping * _FALL
        if settled:
            break
    return Start(n, values, least, float(record.time[-1]))


def _step(residual: np.ndarray, slopes: np.ndarray, damping: float) -> np.ndarray:
    """A step of Levenberg and Marquardt, each unknown in units of the length of its slopes."""
    length = np.linalg.norm(slopes, axis=0)
    length[length == 0.0] = 1.0
    slopes = slopes / length
    normal = slopes.T @ slopes
    step = np.linalg.lstsq(normal + damping * np.eye(length.size), slopes.T @ residual, rcond=None)[0]
    return np.asarray(step / length)
