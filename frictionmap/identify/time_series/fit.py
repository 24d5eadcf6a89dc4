"""The steady motion nearest to all samples of a record.

The base is measured, too: errors b of its harmonics, with covariance B, move the motion by J_b b, and the
residuals are correlated by that, s^2 V = s^2 I + J_b B J_b^T.  The least sum is that of V^(-1/2) times the
residuals: the most likely motion and base together, with b eliminated.  The zero of the measurement may drift
and wander: a straight line and slow waves are fitted with the motion.
"""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from ..parameters import CONTACT_STIFFNESS, SOFTEST
from ..signals.noise import noise_of_fit
from ..signals.phasors import Phasors, scatter_of
from ..statistics.least_squares import Noise, Problem, Solution, minimise
from ..statistics.robust import pseudo_residuals
from .motion import (
    DELAY,
    F_N,
    LAW,
    MU,
    OFFSET,
    PARAMETERS,
    WITH_SPRING,
    Motion,
    Shaken,
    base_slopes,
    inner,
    motion,
    outer,
    places_and_slopes,
    shaken,
)
from .starts import other_springs, starts
from .static_friction import FITTED, IDLE, KNOWN, ONE, is_asked_for

#: Number of starts that are followed, that with a spring where the first ones leave more than noise, and of
#: samples used; the best one continues with all samples.
_FOLLOWED = 4
_MORE_FOLLOWED = 24
_SAMPLES = 600

#: Evaluations of the fit from one start, and of that of all samples with a spring or of a model that nobody
#: asked for: those that end near the record take up to 50.  A stiff spring whose swings make the sum rough,
#: or a model far from the record, takes no end of them.
_EVALUATIONS, _EVALUATIONS_OF_ALL = 60, 120

#: Fits to pseudo-values: each is a step of Newton's method with the mean slope, so few are needed.
_ROUNDS = 8

#: They end where no pseudo-value changes by more than this share of the scale.
_SETTLED = 1e-3

#: The natural frequency lies within this factor of a start.
_RANGE = 1.5

#: A delay is looked for up to this share of a cycle, and a gain up to this factor.
_DELAY, _GAIN = 0.25, 2.0

#: Where straight lines go on below the floors, and where motions end: f_n and the delay apart.
_BELOW = np.array([0.0, -0.5, -np.inf, -1.0, 0.0, 1.0 / _GAIN, -np.inf])
_HIGHEST = np.array([0.0, 10.0, np.inf, 16.0, 0.0, _GAIN, np.inf])


class Whitening(NamedTuple):
    """V^(-1/2) = I - U diag(shrink) U^T."""

    directions: np.ndarray  # U, shape (samples, harmonics)
    shrink: np.ndarray

    def __call__(self, values: np.ndarray) -> np.ndarray:
        """V^(-1/2) times residuals or slopes."""
        along = (self.directions.T @ values).T * self.shrink
        return values - self.directions @ along.T


class Samples(NamedTuple):
    """The mass as it was measured."""

    time: np.ndarray  # s
    x: np.ndarray
    fitted: np.ndarray  # x, or pseudo-values where there may be outliers
    near: np.ndarray  # x without drift, wander and outliers, to begin with
    slow: np.ndarray  # shape (samples, 1 + waves), a straight line and slow waves, of norm 1
    everywhere: np.ndarray  # the same at all times of the record
    scale: float | None  # residuals beyond it have little influence; None: all count alike


class RecordFit(NamedTuple):
    """A steady motion; the solution is in what is fitted, see `inner`, and its residuals are whitened.

    For a contact with a spring, what is said of mu = 1 holds for the rigid contact, compliance 0.

    After the parameters come the parts of the slow waves, see `Samples`.
    """

    mass: Shaken
    samples: Samples
    problem: Problem  # mu is not free where the data do not determine it
    with_law: Problem  # with mu free, if it is not known
    solution: Solution
    noise: Noise
    model_error: float  # residuals at the harmonics over the noise beside them; 1 if due to chance
    whitening: Whitening
    by_base: np.ndarray  # J_b, shape (samples, harmonics): real parts, then imaginary ones
    motion: Motion
    static: int  # KNOWN, ONE, FITTED or IDLE

    @property
    def values(self) -> np.ndarray:
        """The parameters."""
        return outer(self.solution.values[: len(PARAMETERS)], self.mass.elastic)

    @property
    def free(self) -> np.ndarray:
        """Parameters that are not known, bool (parameters,)."""
        return self.with_law.free[: len(PARAMETERS)]

    @property
    def residual(self) -> np.ndarray:
        """Fitted less measured."""
        return self.motion.places + self.slow_at(self.samples.slow) - self.samples.x

    def slow_at(self, waves: np.ndarray) -> np.ndarray:
        """Drift and wander of the zero, `Samples.slow` at some times."""
        return waves @ self.solution.values[len(PARAMETERS) :]


def samples_of(
    phasors: Phasors, time: np.ndarray, x: np.ndarray, winsorised: np.ndarray, used: np.ndarray, robust: bool
) -> Samples:
    """The samples that are used.

    time, x, winsorised, used : shape (samples,), all that the phasors are of; x without outliers; which are
        used
    """
    line = time - phasors.middle
    slow = np.column_stack((line, phasors.waves))
    slow /= np.linalg.norm(slow[used], axis=0)
    near = winsorised - phasors.drift[1] * line - phasors.wander[:, 1]
    scale = float(scatter_of(phasors.residual[:, 1])) if robust else 0.0
    return Samples(
        time[used], x[used], (winsorised if scale else x)[used], near[used], slow[used], slow, scale or None
    )


def fit_record(
    contact: str, damping_reference: str, phasors: Phasors, samples: Samples, known: Mapping[str, float],
    elastic: bool = False, thorough: bool = True,
) -> RecordFit:  # fmt: skip
    """The least sum over all samples, with mu = 1 unless it is known or the data ask for more.

    elastic : whether the contact has a spring, whose compliance is fitted unless it is known
    thorough : whether fits may take any number of evaluations, and more starts are followed where the first
        ones, with a spring, leave more than noise

    Where there may be outliers, pseudo-values from the last fit take the place of x (Huber and Ronchetti,
    Robust Statistics, 2009, section 7.8): this converges to the estimate of soft_l1, and the errors are those
    of least squares.
    """
    few = slice(None, None, max(1, samples.time.size // _SAMPLES))
    coarse = shaken(contact, damping_reference, phasors, samples.time[few], elastic)
    mass = shaken(contact, damping_reference, phasors, samples.time, elastic)
    held = known if elastic else {"mu": 1.0, **known}
    candidates = starts(contact, damping_reference, phasors, held, elastic)
    near = _nearest(coarse, samples.near[few], held, candidates[:_FOLLOWED])
    scatter = float(np.sqrt(near.sum / samples.near[few].size))
    begin = _begin(near, samples)
    most = None if thorough and not elastic else _EVALUATIONS_OF_ALL
    at_one = _fit_near(mass, phasors, samples, known, begin, scatter, begin, most)
    for everywhere in _looks(known, thorough) if elastic else ():
        if at_one.model_error == 1.0:
            break
        x = samples.near[few]
        others = candidates if everywhere else other_springs(coarse, x, at_one.values)[:_FOLLOWED]
        begin = _begin(_nearest(coarse, x, known, others[:_MORE_FOLLOWED]), samples)
        other = _fit_near(mass, phasors, samples, known, begin, scatter, begin, most)
        at_one = min(at_one, other, key=lambda fit: float(np.sum(fit.residual**2)))
    starting = [at_one.solution.values]
    with_mu = not elastic and "mu" not in known
    if with_mu and at_one.model_error > 1.0:  # else nothing far away can be much nearer
        candidates = starts(contact, damping_reference, phasors, known)
        starting.append(_begin(_nearest(coarse, samples.near[few], known, candidates[:_FOLLOWED]), samples))
    fit = _with_static(at_one, phasors, starting, most)
    # without outliers once more if mu is fitted: what errors of the base do was computed for mu = 1
    for _ in range(_ROUNDS if samples.scale else int(fit.static == FITTED)):
        again = _with_pseudo_values(fit)
        change = np.abs(again.fitted - fit.samples.fitted).max()
        scatter = float(np.sqrt(fit.solution.sum / again.x.size))
        values = at_one.solution.values, scatter, fit.solution.values
        at_one = _fit_near(mass, phasors, again, known, *values, most)
        fit = _with_static(at_one, phasors, [fit.solution.values], most)
        if samples.scale and change < _SETTLED * samples.scale:
            break
    return fit


def _looks(known: Mapping[str, float], thorough: bool) -> list[bool]:
    """Where springs are looked for that leave no more than noise: everywhere, or beside the best one."""
    beside = [] if CONTACT_STIFFNESS in known else [False, False]
    return [*beside, True, *beside] if thorough else beside


def _with_pseudo_values(fit: RecordFit) -> Samples:
    """The samples with pseudo-values from the fitted motion, if there may be outliers."""
    samples = fit.samples
    if samples.scale is None:
        return samples
    pseudo = pseudo_residuals(fit.residual, samples.scale)
    return samples._replace(fitted=samples.x + fit.residual - pseudo)


def _fit_near(
    mass: Shaken,
    phasors: Phasors,
    samples: Samples,
    known: Mapping[str, float],
    start: np.ndarray,
    scatter: float,
    about: np.ndarray,
    most: int | None,
) -> RecordFit:
    """The least sum near a start, with mu = 1 unless it is known.

    scatter : standard deviation of a sample, without what errors of the base make
    about : values of the motion that errors of the base move
    most : evaluations
    """
    held = known if mass.elastic else {"mu": 1.0, **known}
    by_base = base_slopes(mass, outer(about[: len(PARAMETERS)], mass.elastic))
    whitening = _whitening(by_base, base_errors(mass, phasors), scatter)
    with_law = _problem(mass, samples, _free(known, samples, mass.elastic), start, whitening)
    problem = with_law._replace(free=_free(held, samples, mass.elastic))
    solution = minimise(problem, start, most)
    found = motion(mass, outer(solution.values[: len(PARAMETERS)], mass.elastic))
    noise = noise_of_record(phasors, samples, problem, solution)
    return RecordFit(mass, samples, problem, with_law, solution, *noise, whitening, by_base, found, KNOWN)


def _with_static(fit: RecordFit, phasors: Phasors, begin: list[np.ndarray], most: int | None) -> RecordFit:
    """The fit with mu free, if it is not known and the data ask for it; else the fit as it is.

    A spring is free to begin with, and the contact is rigid where that explains the data as well.
    """
    task = fit.with_law
    if not task.free[LAW]:
        return fit
    if fit.mass.elastic:
        rigid = _rigid(fit, phasors)
        stiff = fit.solution.at_bound[LAW] or rigid.solution.sum <= fit.solution.sum
        return rigid if stiff else fit._replace(static=FITTED)
    solution = min((minimise(task, start, most) for start in begin), key=lambda found: found.sum)
    found = motion(fit.mass, outer(solution.values[: len(PARAMETERS)]))
    noise, model_error = noise_of_record(phasors, fit.samples, task, solution)
    gain = fit.solution.sum - solution.sum
    if found.stops > 0 and is_asked_for(gain, task, solution, noise, MU):
        return fit._replace(
            problem=task, solution=solution, noise=noise, model_error=model_error, motion=found,
            static=FITTED,
        )  # fmt: skip
    on_bound = fit.solution.at_bound.copy()
    on_bound[MU] = True
    return fit._replace(
        solution=fit.solution._replace(at_bound=on_bound),
        static=ONE if fit.motion.stops > 0 else IDLE,
    )  # fmt: skip


def _rigid(fit: RecordFit, phasors: Phasors) -> RecordFit:
    """The fit with a rigid contact in place of the stiffest spring."""
    start = fit.solution.values.copy()
    start[LAW] = 0.0
    free = fit.with_law.free.copy()
    free[LAW] = False
    problem = _problem(fit.mass, fit.samples, free, start, fit.whitening)
    solution = minimise(problem, start)
    found = motion(fit.mass, solution.values[: len(PARAMETERS)])
    noise, model_error = noise_of_record(phasors, fit.samples, problem, solution)
    on_bound = solution.at_bound.copy()
    on_bound[LAW] = True
    return fit._replace(
        problem=problem, solution=solution._replace(at_bound=on_bound), noise=noise, model_error=model_error,
        motion=found, static=ONE,
    )  # fmt: skip


def problem_of(fit: RecordFit, known: Mapping[str, float]) -> Problem:
    """The problem that was solved, with other parameters held."""
    free = _free(known, fit.samples, fit.mass.elastic)
    return _problem(fit.mass, fit.samples, free, fit.solution.values, fit.whitening)


def noise_of_record(
    phasors: Phasors, samples: Samples, problem: Problem, solution: Solution
) -> tuple[Noise, float]:
    """The noise, and the error of the model in it."""
    free = problem.free & ~solution.at_bound
    return noise_of_fit(
        samples.time, solution.residual, phasors.frequency, phasors.values.shape[1] - 1,
        int(free[:OFFSET].sum()), samples.slow.shape[1] - 1,
    )  # fmt: skip


def _begin(near: Solution, samples: Samples) -> np.ndarray:
    """Starting values of the fit of all samples: a nearby motion, drift and wander."""
    slow = np.linalg.lstsq(samples.slow, samples.fitted - samples.near, rcond=None)[0]
    return np.concatenate((near.values, slow))


def _nearest(
    mass: Shaken, x: np.ndarray, known: Mapping[str, float], candidates: list[np.ndarray]
) -> Solution:
    """The least sum from several starts, of samples without drift and outliers."""
    none = np.zeros((x.size, 0))
    samples = Samples(np.zeros(x.size), x, x, x, none, none, None)
    free, elastic = _free(known, samples, mass.elastic), mass.elastic
    fitted = [inner(start, elastic) for start in candidates]
    problems = [(_problem(mass, samples, free, start), start) for start in fitted]
    found = (minimise(_within(task), start, _EVALUATIONS) for task, start in problems)
    return min(found, key=lambda one: one.sum)


def _free(known: Mapping[str, float], samples: Samples, elastic: bool) -> np.ndarray:
    names = WITH_SPRING if elastic else PARAMETERS
    return np.array([name not in known for name in names] + [True] * samples.slow.shape[1])


def places_at(fit: RecordFit, phasors: Phasors, time: np.ndarray) -> np.ndarray:
    """The fitted motion at other times."""
    mass = shaken(fit.mass.contact, fit.mass.damping_reference, phasors, time, fit.mass.elastic)
    return motion(mass, fit.values).places


def _within(problem: Problem) -> Problem:
    """Bound the problem by its floors, without linear continuation; sufficient for starting values."""
    return problem._replace(lowest=np.maximum(problem.lowest, problem.floor))


def base_errors(mass: Shaken, phasors: Phasors) -> np.ndarray:
    """Standard errors of the base's harmonics: of the real parts, then of the imaginary ones."""
    return np.tile(phasors.errors[0, : mass.base.size], 2)


def _whitening(by_base: np.ndarray, errors: np.ndarray, scatter: float) -> Whitening:
    """V^(-1/2), for residuals that scatter by that much on their own."""
    if scatter == 0.0:  # samples without any noise
        return Whitening(by_base[:, :0], errors[:0])
    directions, sizes, _ = np.linalg.svd(by_base * (errors / scatter), full_matrices=False)
    return Whitening(directions, 1.0 - 1.0 / np.hypot(1.0, sizes))


def _problem(
    mass: Shaken,
    samples: Samples,
    free: np.ndarray,
    start: np.ndarray,
    whitening: Whitening | None = None,
) -> Problem:
    """Least squares of `samples.fitted`, whitened if errors of the base are allowed for."""
    size = len(PARAMETERS)

    def plain(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        places, slopes = places_and_slopes(mass, values[:size], free[:size])
        slow = samples.slow @ values[size:]
        return places + slow - samples.fitted, np.hstack((slopes, samples.slow))

    waves = np.full(samples.slow.shape[1], np.inf)
    lowest, highest = np.concatenate((_BELOW, -waves)), np.concatenate((_HIGHEST, waves))
    lowest[F_N], highest[F_N] = start[F_N] / _RANGE, start[F_N] * _RANGE
    lowest[DELAY], highest[DELAY] = -_DELAY / mass.frequency, _DELAY / mass.frequency
    if mass.elastic:
        highest[LAW] = SOFTEST
    problem = Problem(plain, free, np.concatenate((mass.floor, -waves)), lowest, highest)
    return problem if whitening is None else _whitened(problem, whitening)


def _whitened(problem: Problem, whitening: Whitening) -> Problem:
    def residuals(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        residual, slopes = problem.residuals(values)
        return whitening(residual), whitening(slopes)

    return problem._replace(residuals=residuals)
