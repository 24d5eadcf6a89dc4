"""What follows from a fitted decay: rest, bounds of mu, friction in other units."""

import numpy as np
import xarray as xr

from ... import checks
from ...errors import InputError
from ...units.table import conversion
from ..signals.turning_points import TurningPoints, linear_decrement
from ..statistics.estimates import number, with_error
from ..statistics.least_squares import Errors
from .electronics import Signal
from .fit import DecayFit
from .problem import F_N, X_F, Record


def results(
    record: Record, fits: list[DecayFit], found: Errors, signal: Signal, points: TurningPoints
) -> dict[str, xr.Variable]:
    """All but the estimates and what depends on further arguments.

    points : turning points of the record; their places are those of the signal
    """
    result = _decrement(fits[0], signal, points) | _motion(fits, signal)
    return result | _wander(record, fits[0], signal.unit) | _over_mass(fits[0], found, signal)


def _decrement(fit: DecayFit, signal: Signal, points: TurningPoints) -> dict[str, xr.Variable]:
    """What the linear decrement gives, if there are two maxima or minima."""
    decrement = linear_decrement(points)
    if decrement is None:
        return {}
    length = decrement / signal.gain_at(fit.decay.f_n)
    words = "x_F by the linear decrement T(4.3), true if zeta = 0"
    return {"linear_decrement": number(length, words, signal.length)}


def _motion(fits: list[DecayFit], signal: Signal) -> dict[str, xr.Variable]:
    """Number of half cycles, place of rest, and the bounds of mu that follow."""
    fit = fits[0]
    bounds = np.array([_bounds_of_mu(one) for one in fits])
    lower, upper = bounds[:, 0].min(), bounds[:, 1].max()
    result = {
        "half_cycles": xr.Variable(
            (), np.int32(fit.half_cycles), {"long_name": "half cycles before rest, or begun in the record"}
        ),
        "at_rest": xr.Variable((), np.int8(fit.at_rest), {"long_name": "1 if it came to rest in the record"}),
        "mu_lower": number(lower, "static over kinetic friction is at least this, as it rests where it does"),
        "mu_upper": number(
            upper, "static over kinetic friction is below this, as it left the turning point before"
        ),
    }
    if fit.at_rest and signal.shows_rest:
        heights = fit.heights
        side = np.sign(fit.decay.X0) * (-1.0) ** fit.half_cycles
        result["rest"] = number(fit.decay.centre + side * float(heights[-1]), "place of rest", signal.length)
    return result


def _bounds_of_mu(fit: DecayFit) -> tuple[float, float]:
    """Least and largest mu, from where the mass came to rest and which turning point it left last."""
    heights, friction = fit.heights, fit.decay.x_F
    if friction == 0.0 or not fit.possible:
        return 0.0, np.inf
    passed = heights[:-1] if fit.at_rest else heights
    return abs(float(heights[-1])) / friction if fit.at_rest else 0.0, float(passed[-1]) / friction


def _wander(record: Record, fit: DecayFit, unit: str) -> dict[str, xr.Variable]:
    """The wander of the zero that was fitted, if there is one."""
    if record.wander is None or not record.terms:
        return {}
    slow = record.wander @ fit.solution.values[record.steady :]
    return {
        "wander_terms": xr.Variable(
            (), np.int32(record.terms), {"long_name": "terms of the polynomial that the zero follows"}
        ),
        "wander_rms": number(float(np.std(slow)), "slow wander of the zero, root mean square", unit),
    }


def scaled(
    fit: DecayFit, found: Errors, signal: Signal, base: float | None, stiffness: float | None
) -> dict[str, xr.Variable]:
    """x_F as a friction ratio and as a force, with its error."""
    scales: list[tuple[str, str, str, float]] = []
    if base is not None:
        scales.append(("beta", "friction ratio x_F/Y", "1", 1.0 / checks.number(base, "base", above=0.0)))
    if stiffness is not None and signal.is_angle:
        raise InputError(
            "cannot use stiffness with angles: x_F is an angle; the moment of friction is the rotational "
            "stiffness times x_F in rad; omit stiffness"
        )
    if stiffness is not None:
        newtons = checks.number(stiffness, "stiffness", above=0.0) * conversion(signal.length, "m")
        scales.append(("friction_force", "kinetic friction force k x_F", "N", newtons))
    x_F, error = fit.decay.x_F, float(found.standard_error[X_F])  # noqa: N806
    result: dict[str, xr.Variable] = {}
    for name, words, units, scale in scales:
        result |= with_error(name, scale * x_F, scale * error, words, units, f"standard error of {name}")
    return result


def _over_mass(fit: DecayFit, found: Errors, signal: Signal) -> dict[str, xr.Variable]:
    """Friction force over mass, x_F omega_n^2: velocities and accelerations show it without a stiffness."""
    if signal.order == 0:
        return {}
    rate = (2.0 * np.pi * fit.decay.f_n) ** 2 * conversion(signal.length, "m")
    index = [F_N, X_F]
    covariance = found.correlation[np.ix_(index, index)] * np.outer(*2 * [found.standard_error[index]])
    slopes = rate * np.array([2.0 * fit.decay.x_F / fit.decay.f_n, 1.0])
    error = float(np.sqrt(slopes @ covariance @ slopes))
    return with_error("friction_over_mass", rate * fit.decay.x_F, error, "friction force over mass", "m/s^2")
