"""Friction ratios from single lags: in closed form for one mass on a wall, else roots of the exact lag."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ... import checks
from ...errors import InputError
from ...model.general import refuse_general
from ...model.modes import wrapped
from ...model.system import System
from ...roots import Brackets, polish
from ...steady.points import steady_states
from ...theory.boundary_curves import find_curves
from .extremes import Extremes, extremes_near_zero

#: Friction ratios over beta_stick at which lags are looked at: evenly, then ever closer to sticking, where
#: the lag of one mass comes back from beyond 90 deg.
_SHARES = np.concatenate((np.linspace(0.0, 0.9, 31), 1.0 - 0.1 * 0.6 ** np.arange(1.0, 16.0)))

#: Intervals next to a lag are divided into these parts: where motions with one more stop begin, the lag
#: bends so sharply that a rise and a fall may lie between two of the samples above.
_PARTS = np.linspace(0.0, 1.0, 11)

#: Lags that change less than this [rad] per unit of beta do not determine friction.
_LEAST_SLOPE = np.radians(10.0)

#: Step of beta for the slope.
_STEP = 1e-5

#: Lags nearer to each other than this [rad] are one: steady states are exact to some 1e-12.
_ROUNDING = 1e-12

#: Friction ratios nearer to each other than this are one that was found twice, where the motion ceases to be
#: continuous: two beside an extreme of the lag are further apart, by the root of its rounding.
_SAME = 1e-9

#: Decimals of the range of lags that a message has at most.
_MOST_DECIMALS = 6

ONE, SEVERAL, NONE, FLAT = 0, 1, 2, 3

#: Codes of the result for a lag, in order.
MEANINGS = ("one_friction_ratio", "several_friction_ratios", "no_friction_ratio_gives_it", "cannot_tell")


class FrictionRatios(NamedTuple):
    """Friction ratios that follow from one lag."""

    beta: tuple[float, ...]  # friction ratios that give it, increasing: none, one or more
    slope: tuple[float, ...]  # change of the lag with each of them [deg per unit]
    code: int  # of `MEANINGS`
    reason: str  # why there is none


class _Lags(NamedTuple):
    """Lags [rad] of points over increasing friction, (tried, points)."""

    beta: np.ndarray
    lag: np.ndarray


class _Measured(NamedTuple):
    """Lags of masses of a structure, one a point."""

    system: System
    r: np.ndarray
    lag: np.ndarray  # rad
    mass: np.ndarray  # from 0

    def at(self, some: np.ndarray) -> "_Measured":
        """Some of the points."""
        return self._replace(r=self.r[some], lag=self.lag[some], mass=self.mass[some])

    def off(self, beta: np.ndarray, which: np.ndarray) -> np.ndarray:
        """Lags at friction ratios, less those of the points `which` [rad]."""
        return wrapped(_lag(self.system, self.r[which], beta, self.mass[which]) - self.lag[which])


def friction_ratio(
    r: float | Sequence[float] | np.ndarray,
    phase_lag: float | Sequence[float] | np.ndarray,
    *,
    system: System | None = None,
    mass: int = 1,
) -> list[FrictionRatios]:
    """Friction ratios that give single lags of first harmonics, mu = 1.

    Parameters
    ----------
    r : float or array, shape (points,)
        Frequency ratios, > 0.
    phase_lag : float or array, shape (points,)
        Lags of a mass behind the load or base [deg], frequency-based.
    system : System
        Default: one mass and a fixed wall, without damping.
    mass : int
        Counted from 1.

    Returns
    -------
    list of FrictionRatios
        One a point: `beta`, none, one or more, and the `slope` of the lag [deg per unit of beta] at each;
        `code`, which `MEANINGS` has in words; `reason`.  Two from 90 deg on below resonance, where the lag
        of one mass on a fixed wall rises beyond 90 deg with friction and comes back as the mass sticks.  For
        other structures none if the lag does not determine it: below 10 deg per unit of beta, or rising and
        falling.

    Raises
    ------
    InputError
        An argument is invalid.

    Notes
    -----
    One undamped mass on a fixed wall in continuous motion, D = 4/pi, u = U/V, phi the lag, b = beta^2:
    D^2 u^2 b^2 + (2 D u sin^2 phi - D^2 cos^2 phi) b + sin^2 phi = 0, theory.md 10.

    Examples
    --------
    >>> import frictionmap as fm
    >>> round(fm.identify.friction_ratio(0.85, 14.74764)[0].beta[0], 5)
    0.2
    """
    system = System() if system is None else checks.instance(system, "system", System)
    refuse_general(system, "identify friction")
    mass = system.dofs.number(mass, "mass")
    at, lag = (np.atleast_1d(checks.array(one, name)) for one, name in ((r, "r"), (phase_lag, "phase_lag")))
    for values, name in ((at, "r"), (lag, "phase_lag")):
        if values.dtype.kind not in "iuf" or values.ndim != 1 or not np.isfinite(values).all():
            raise InputError(f"{name} must be finite numbers; got {checks.one_line(values)}")
    if at.size != lag.size:
        raise InputError(f"phase_lag must be {at.size} numbers, one per frequency; got {lag.size}")
    if not (at > 0.0).all():
        raise InputError(f"r must be > 0; got {at[at <= 0.0][0]:g}")
    return invert(system, at.astype(float), np.radians(lag), np.full(at.size, system.dofs.row(mass)))


def invert(system: System, r: np.ndarray, lag: np.ndarray, mass: np.ndarray) -> list[FrictionRatios]:
    """Determine friction ratios from lags [rad] of masses, from 0, as `friction_ratio`; all (points,)."""
    measured = _Measured(system, r, lag, mass)
    seen = _look(system, r, mass)
    beta, which = _roots(measured, seen)
    slope = _slopes(system, r[which], beta, mass[which])
    both = is_one_on_wall(system)
    steps = np.diff(np.unwrap(seen.lag, axis=0), axis=0)
    unsure = (steps.min(axis=0) < -_ROUNDING) & (steps.max(axis=0) > _ROUNDING)
    found = []
    for k in range(r.size):
        values, slopes = _distinct(beta[which == k], slope[which == k])
        reason, code = "", ONE if values.size == 1 else SEVERAL
        if values.size == 0:
            code, reason = NONE, _none_reason(measured, k, seen)
        elif not both and (unsure[k] or (np.abs(slopes) < _LEAST_SLOPE).any()):
            code, reason = FLAT, _flat_reason(r[k], unsure[k])
            values = slopes = np.empty(0)
        found.append(FrictionRatios(tuple(values.tolist()), tuple(np.degrees(slopes).tolist()), code, reason))
    return found


def is_one_on_wall(system: System) -> bool:
    """Whether it is one mass on a fixed wall."""
    return system.n == 1 and system.contact == "fixed-wall"


def distance_from_range(system: System, r: np.ndarray, lag: np.ndarray) -> np.ndarray:
    """Distance of lags [rad] of the first mass from the range that friction can give, (points,)."""
    mass = np.zeros(r.size, dtype=int)
    return _distance(_Measured(system, r, lag, mass), _look(system, r, mass))


def _distance(measured: _Measured, seen: _Lags) -> np.ndarray:
    """Distance of lags from the range that friction can give, (points,); 0 within it."""
    low, high = np.nanmin(seen.lag, axis=0), np.nanmax(seen.lag, axis=0)
    off = np.maximum(np.maximum(low - measured.lag, measured.lag - high), 0.0)
    beyond = np.flatnonzero(off)
    if beyond.size:  # the extremes lie between the samples
        some = measured.at(beyond)
        x = seen.beta[:, beyond]
        found = extremes_near_zero(some.off, x, wrapped(seen.lag[:, beyond] - some.lag), far=True)
        nearest = np.where(found.crossed, 0.0, np.abs(found.value))
        np.minimum.at(off, beyond[found.which], nearest)
    return off


def continuous_friction_ratios(r: np.ndarray, lag: np.ndarray) -> np.ndarray:
    """beta of one undamped mass on a fixed wall from its lag [rad] in continuous motion; (2, points).

    NaN where a root of the closed form gives another lag.  Whether the motion is continuous, beta <=
    beta_lim(r), is not looked at.  Next to resonance both roots may be below beta_lim, and right.  u = U/V is
    taken about its finite limit -4/pi there, where sin(lag) = 4 beta/pi.
    """
    d = 4.0 / np.pi
    y = 0.5 * np.pi * (r - 1.0) / r  # tan(pi/(2r)) = cot(y)
    with np.errstate(divide="ignore", invalid="ignore"):
        u = -2.0 / np.pi * (1.0 + r) * np.where(y == 0.0, 1.0, y / np.tan(y))
        sine, cosine = np.sin(lag), np.cos(lag)
        a, b, c = (d * u) ** 2, 2.0 * d * u * sine**2 - (d * cosine) ** 2, sine**2
        sum_of_roots = 0.5 * (-b + np.sqrt(b * b - 4.0 * a * c))
        square = np.array([c / sum_of_roots, sum_of_roots / a])
        # the lag enters by its squares: cos(lag) has the sign of V (1 + D beta^2 u)
        right = cosine * (1.0 - r) * (1.0 + d * square * u) > 0.0
        right[0] |= r == 1.0  # the other root is beta_lim there, whatever the lag
        return np.sqrt(np.where(right & (square >= 0.0), square, np.nan))


def _lag(system: System, r: np.ndarray, beta: np.ndarray, mass: np.ndarray) -> np.ndarray:
    """Lags in [-pi/2, 3 pi/2) of masses at rows of points; NaN at an undamped resonance."""
    found = steady_states(system, r, beta, 1.0)[0].phasors[np.arange(r.size), mass]
    found = np.where(np.isfinite(found) & (found != 0.0), found, np.nan)
    return np.remainder(0.5 * np.pi - np.angle(found), 2.0 * np.pi) - 0.5 * np.pi


def _look(system: System, r: np.ndarray, mass: np.ndarray) -> _Lags:
    """Lags over all friction; where a closed form gives beta in continuous motion, at 0 and beyond it."""
    stick = np.abs(system.contact_load(r))
    # a load at a resonance of the held structure moves it for any friction
    stick = np.where(np.isfinite(stick), stick, 1.0 / np.finfo(float).eps)
    low = np.zeros_like(r)
    if _has_closed_form(system):
        at, place = np.unique(r, return_inverse=True)
        low = np.minimum(find_curves(system, at, np.ones(1)).beta_lim[0, place], stick)
    beta = np.vstack((np.zeros_like(r), low + _SHARES[:, np.newaxis] * (stick - low)))
    count = beta.shape[0]
    lag = _lag(system, np.tile(r, count), beta.ravel(), np.tile(mass, count))
    return _Lags(beta, lag.reshape(beta.shape))


def _roots(measured: _Measured, seen: _Lags) -> tuple[np.ndarray, np.ndarray]:
    """Friction ratios that give the lags, and of which point each is; one may be found twice."""
    closed = _has_closed_form(measured.system)
    x = seen.beta[1:] if closed else seen.beta
    off = wrapped((seen.lag[1:] if closed else seen.lag) - measured.lag)
    beta, which = _crossings(measured, x, off)
    on_grid, points = np.nonzero(off == 0.0)
    beta, which = np.append(beta, x[on_grid, points]), np.append(which, points)
    if closed:
        direct = continuous_friction_ratios(measured.r, measured.lag)
        root, valid = np.nonzero(direct <= x[0])
        beta, which = np.append(beta, direct[root, valid]), np.append(which, valid)
    return beta, which


def _crossings(measured: _Measured, x: np.ndarray, off: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Where lags pass those measured, and where they come to them and turn back.

    x, off : (tried, points) friction ratios, and lags less those measured
    """
    k, which = np.nonzero(_near(off))
    some = measured.at(which)
    x = x[k, which] + (x[k + 1, which] - x[k, which]) * _PARTS[:, np.newaxis]
    inner = some.off(x[1:-1].ravel(), np.tile(np.arange(which.size), _PARTS.size - 2))
    off = np.vstack((off[k, which], inner.reshape(_PARTS.size - 2, which.size), off[k + 1, which]))
    k, column = np.nonzero(off[:-1] * off[1:] < 0.0)
    passed = Brackets(column, x[k, column], x[k + 1, column], off[k, column], off[k + 1, column])
    extreme = extremes_near_zero(some.off, x, off)
    brackets = Brackets(*map(np.concatenate, zip(passed, *_brackets_around(extreme), strict=True)))

    def difference(beta: np.ndarray, bracket: np.ndarray) -> np.ndarray:
        one = Brackets(*(part[bracket] for part in brackets))
        found = some.off(beta, one.which)
        # next to where motion ceases to be continuous a steady state may not be found: a line takes its place
        line = one.at_low + (beta - one.low) / (one.high - one.low) * (one.at_high - one.at_low)
        return np.where(np.isnan(found), line, found)

    beta = polish(difference, np.arange(brackets.which.size), *brackets[1:])
    touched = ~extreme.crossed & (np.abs(extreme.value) <= _ROUNDING)
    column = np.append(brackets.which, extreme.which[touched])
    return np.append(beta, extreme.place[touched]), which[column]


def _near(off: np.ndarray) -> np.ndarray:
    """Intervals of samples in which zero may lie, bool (tried - 1, points): no further off than lags change.

    Between samples a lag may rise and fall by some of the change from one sample to the next.
    """
    change = np.abs(np.diff(off, axis=0))
    around = np.pad(change, ((1, 1), (0, 0)))
    around = np.maximum(np.maximum(around[:-2], around[2:]), change)
    nearest = np.minimum(np.abs(off[:-1]), np.abs(off[1:]))
    return (nearest <= around) & (change < 0.5 * np.pi)


def _brackets_around(extreme: Extremes) -> tuple[Brackets, Brackets]:
    """Brackets below and above the extremes beyond zero."""
    below = extreme.crossed & (extreme.place > extreme.low) & (extreme.at_low * extreme.value < 0.0)
    above = extreme.crossed & (extreme.place < extreme.high) & (extreme.at_high * extreme.value < 0.0)
    which, low, high, at_low, at_high, place, value = extreme
    return (
        Brackets(*(part[below] for part in (which, low, place, at_low, value))),
        Brackets(*(part[above] for part in (which, place, high, value, at_high))),
    )


def _distinct(beta: np.ndarray, slope: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Friction ratios in order, each once, and their slopes."""
    order = np.argsort(beta)
    beta, slope = beta[order], slope[order]
    first = np.diff(beta, prepend=-np.inf) > _SAME
    return beta[first], slope[first]


def _slopes(system: System, r: np.ndarray, beta: np.ndarray, mass: np.ndarray) -> np.ndarray:
    """Change of the lags with beta [rad], by differences; one-sided at 0."""
    low, high = np.maximum(beta - _STEP, 0.0), beta + _STEP
    slope = wrapped(_lag(system, r, high, mass) - _lag(system, r, low, mass)) / (high - low)
    growing = np.isnan(slope)  # at the resonance of one undamped mass, where sin(lag) = 4 beta/pi
    slope[growing] = 4.0 / np.sqrt(np.pi**2 - (4.0 * beta[growing]) ** 2)
    return slope


def _has_closed_form(system: System) -> bool:
    return is_one_on_wall(system) and system.normalised and not system.modes.zeta.any()


def _none_reason(measured: _Measured, k: int, seen: _Lags) -> str:
    """State the range of lags that friction can give at a point, which excludes the measured one."""
    r, lag = float(measured.r[k]), float(np.degrees(measured.lag[k]))
    point = np.array([k])
    off = np.degrees(_distance(measured.at(point), _Lags(seen.beta[:, point], seen.lag[:, point]))[0])
    low, high = np.degrees(np.nanmin(seen.lag[:, k])), np.degrees(np.nanmax(seen.lag[:, k]))
    low, high = (min(low, lag + off), high) if lag < low else (low, max(high, lag - off))
    words = f"no friction ratio gives a lag of {lag:.4g} deg at r = {r:.4g}"
    if not is_one_on_wall(measured.system):
        return f"{words}: it is {low:.4g} to {high:.4g} deg"
    for decimals in range(_MOST_DECIMALS + 1):
        size = 10.0**decimals
        ends = np.floor(low * size) / size, np.ceil(high * size) / size
        if not ends[0] <= lag <= ends[1]:
            break
    side = "above" if r > 1.0 else "below"
    return f"{words}: {side} resonance it is {ends[0]:.{decimals}f} to {ends[1]:.{decimals}f} deg"


def _flat_reason(r: float, unsure: bool) -> str:
    why = "rises and falls with friction" if unsure else "changes by less than 10 deg per unit of beta"
    return f"the lag at r = {r:.4g} {why}: it does not determine beta"
