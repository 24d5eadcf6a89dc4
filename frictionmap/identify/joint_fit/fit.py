"""Joint fit of several decays and records: shared f_n, zeta and mu, and one friction force for each."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from ..part import SHARED, Part
from ..statistics.least_squares import Noise, Problem, Solution, minimise
from ..time_series.static_friction import FITTED, IDLE, KNOWN, ONE, is_asked_for

F_N, ZETA, MU = range(len(SHARED))

#: Rounds in which the noise of the parts is taken from the residuals of the joint fit.
_ROUNDS = 2


class JointFit(NamedTuple):
    """A fit of all parts; values are shared ones, then those of each part, (mu - 1)^2 for mu."""

    parts: list[Part]
    problem: Problem  # mu is not free where the data do not ask for it
    with_mu: Problem
    solution: Solution
    noise: Noise
    static: int  # KNOWN, ONE, FITTED or IDLE

    def each(self, solution: Solution | None = None) -> list[tuple[Part, np.ndarray]]:
        """The parts with their values in a solution, that of the fit by default, in their own order."""
        values = (solution or self.solution).values
        return [(part, values[at]) for part, at in _each(self.parts)]

    @property
    def model_error(self) -> float:
        """The largest of the parts."""
        return max(part.model_error for part in self.parts)


def fit_jointly(parts: list[Part], known: Mapping[str, float]) -> JointFit:
    """The least sum over all parts, with mu = 1 unless it is known or the data ask for more."""
    held = {"mu": 1.0, **known}
    begun = [_minimised(one, held) for one in _begun(parts, known)]
    parts, solution = min(begun, key=lambda found: _comparable(*found))
    for _ in range(_ROUNDS):
        parts = [part.measured_again(solution.values[at]) for part, at in _each(parts)]
        solution = minimise(_problem(parts, held), solution.values)
    fit = _fit(parts, held, known, solution, KNOWN)
    return fit if "mu" in known else _with_static(fit, known)


def places_of(parts: list[Part]) -> list[np.ndarray]:
    """Indices of the parameters of each part among all parameters."""
    found, following = [], len(SHARED)
    for part in parts:
        at = np.empty(part.start.size, dtype=int)
        for name in set(SHARED) & set(part.names):
            at[part.names.index(name)] = SHARED.index(name)
        at[part.own] = following + np.arange(len(part.own))
        following += len(part.own)
        found.append(at)
    return found


def _each(parts: list[Part]) -> list[tuple[Part, np.ndarray]]:
    return list(zip(parts, places_of(parts), strict=True))


def _begun(parts: list[Part], known: Mapping[str, float]) -> list[list[Part]]:
    """Parts with starts from those that lead, or, if there is none, from each."""
    begun = []
    for source in [part for part in parts if part.leads] or parts:
        shared = {name: float(source.start[source.names.index(name)]) for name in ("f_n", "zeta")}
        begun.append([part if part is source else part.with_shared(shared, known) for part in parts])
    return begun


def _start(parts: list[Part], known: Mapping[str, float]) -> np.ndarray:
    """Shared values of the first part that was fitted with them free, then those of each part."""
    size = len(SHARED) + sum(len(part.own) for part in parts)
    values = np.zeros(size)
    for part, at in _each(parts):
        values[at] = part.start
    for part, at in _each(parts):
        if part.leads:
            values[at[:2]] = part.start[:2]
    for name in ("f_n", "zeta"):
        if name in known:
            values[SHARED.index(name)] = known[name]
    values[MU] = (known.get("mu", 1.0) - 1.0) ** 2
    return values


def _minimised(parts: list[Part], held: Mapping[str, float]) -> tuple[list[Part], Solution]:
    return parts, minimise(_problem(parts, held), _start(parts, held))


def _comparable(parts: list[Part], solution: Solution) -> float:
    """The sum in one measure for all starts: logarithms of the squares of each part."""
    total = 0.0
    for part, at in _each(parts):
        residual = part.problem.residuals(solution.values[at])[0]
        total += residual.size * float(np.log(max(float(residual @ residual), np.finfo(float).tiny)))
    return total


def _problem(parts: list[Part], known: Mapping[str, float]) -> Problem:
    """All residuals, each over the noise of its part."""
    places = places_of(parts)
    size = 1 + max(int(at.max()) for at in places)
    free = np.ones(size, dtype=bool)
    floor, lowest, highest = np.full(size, -np.inf), np.full(size, -np.inf), np.full(size, np.inf)
    for part, at in _each(parts):
        free[at] = part.problem.free
        floor[at] = np.maximum(floor[at], part.problem.floor)
        lowest[at] = np.maximum(lowest[at], part.problem.lowest)
        highest[at] = np.minimum(highest[at], part.problem.highest)
    free[: len(SHARED)] = [name not in known for name in SHARED]

    def residuals(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        found = [(part.problem.residuals(values[at]), part.sigma, at) for part, at in _each(parts)]
        residual = np.concatenate([own / sigma for (own, _), sigma, _ in found])
        slopes = np.zeros((residual.size, size))
        begin = 0
        for (own, own_slopes), sigma, at in found:
            slopes[begin : begin + own.size, at] = own_slopes / sigma
            begin += own.size
        return residual, slopes

    return Problem(residuals, free, floor, lowest, highest)


def _fit(
    parts: list[Part], held: Mapping[str, float], known: Mapping[str, float], solution: Solution, static: int
) -> JointFit:
    noise = Noise(1.0, np.zeros((solution.residual.size, 0)), sum(part.freedom for part in parts))
    return JointFit(parts, _problem(parts, held), _problem(parts, known), solution, noise, static)


def _with_static(fit: JointFit, known: Mapping[str, float]) -> JointFit:
    """The fit with mu free, if the data ask for it; else that with mu = 1."""
    solution = minimise(fit.with_mu, fit.solution.values)
    if stops(fit, solution) and is_asked_for(
        fit.solution.sum - solution.sum, fit.with_mu, solution, fit.noise, MU
    ):
        parts = [part.measured_again(solution.values[at]) for part, at in _each(fit.parts)]
        solution = minimise(_problem(parts, known), solution.values)
        return _fit(parts, known, known, solution, FITTED)
    on_bound = fit.solution.at_bound.copy()
    on_bound[MU] = True
    return fit._replace(
        solution=fit.solution._replace(at_bound=on_bound), static=ONE if stops(fit, fit.solution) else IDLE
    )


def stops(fit: JointFit, solution: Solution) -> bool:
    """Whether the mass sticks in one of the parts."""
    return any((part.stops(values) or 0) > 0 for part, values in fit.each(solution))
