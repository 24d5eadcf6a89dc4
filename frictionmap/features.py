"""Features of the regimes and of the continuous response that need no map: limits, peaks, invariant points.

Equation numbers are those of theory.md 7 and of the thesis (T).
"""

import math
from collections.abc import Callable
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from . import checks
from ._kernels.closed_form import damping_functions
from .system import System

#: Samples between two poles that a change of sign is looked for in.
_SAMPLES = 200


class HighFrequency(NamedTuple):
    """Boundaries in the limit r -> infinity; infinite where they grow without bound."""

    beta_lim: float
    beta_stick: float


def peak_thresholds(system: System) -> np.ndarray:
    """Least beta for which the i-th resonant peak is finite, T(6.2), (6.26), (7.62); shape (n,).

    (pi/4)|lambda_i/chi_i| without damping; with it T(7.62), which is approximate.  Infinite for a mode that
    the contact does not see.
    """
    modes = system.modes
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = np.abs(modes.participation) / np.abs(modes.chi)
    x = math.pi * modes.zeta
    # (cosh x - 1)/(2 zeta sinh x) = tanh(x/2)/(2 zeta), which is pi/4 at zeta = 0
    factor = np.full(x.size, 0.25 * math.pi)
    np.divide(np.tanh(0.5 * x), 2.0 * modes.zeta, out=factor, where=modes.zeta > 0.0)
    return np.where(modes.chi == 0.0, np.inf, ratio * factor)


def high_frequency_limits(system: System, mu: float = 1.0) -> HighFrequency:
    """beta_lim and beta_stick for r -> infinity, T(2.31), (6.8), (6.28), (6.29), with mu squared.

    Zero if the load acts elsewhere than on a mass in contact; a joined base-wall's grow with r^2.
    """
    mu = checks.number(mu, "mu", least=1.0)
    if system.base_motion:
        return HighFrequency(math.inf, math.inf)
    modes = system.modes
    share = abs(modes.contact @ np.linalg.solve(modes.mass, modes.load)) / modes.inverse_mass
    return HighFrequency(float(share) * 2.0 / math.hypot(2.0 * mu, math.pi), float(share) / mu)


def quasi_static_displacement(system: System, beta: float) -> np.ndarray:
    """Displacements for r -> 0 while the contact slides: K x0 = p - beta c, T(6.5); shape (n,)."""
    beta = checks.number(beta, "beta", least=0.0)
    modes = system.modes
    return np.linalg.solve(modes.stiffness, modes.load.real - beta * modes.contact)


def _functions(system: System, r: float, weights: np.ndarray) -> tuple[float, float]:
    """V and U of the displacement with modal weights (chi for z, phi_k for x_k), undamped parts real."""
    modes = system.modes
    v = modes.response(np.array([r]), weights)[0].real
    u = sum(
        weight * chi / w**2 * damping_functions(w, zeta, r)[0]
        for w, zeta, chi, weight in zip(modes.w, modes.zeta, modes.chi, weights, strict=True)
        if chi != 0.0
    )
    return float(v), float(u)


def _roots(f: Callable[[float], float], poles: np.ndarray, low: float, high: float) -> np.ndarray:
    """Roots of f in (low, high), which is smooth between its poles."""
    from scipy.optimize import brentq

    edges = np.unique(np.concatenate(([low], poles[(poles > low) & (poles < high)], [high])))
    roots = []
    for left, right in pairwise(edges):
        r = left + (right - left) * (np.arange(_SAMPLES) + 0.5) / _SAMPLES
        values = np.array([f(x) for x in r])
        for k in np.flatnonzero(np.sign(values[1:]) * np.sign(values[:-1]) < 0):
            roots.append(brentq(f, r[k], r[k + 1], xtol=1e-15, rtol=1e-15))
        roots.extend(r[values == 0.0])
    return np.unique(roots)


def _poles(system: System, low: float) -> np.ndarray:
    """Natural frequencies and, above `low`, their odd sub-multiples, where U is infinite without damping."""
    modes = system.modes
    seen = modes.w[modes.chi != 0.0]
    if seen.size == 0:
        return modes.w
    odd = np.arange(1.0, max(3.0, 2.0 * seen.max() / low), 2.0)
    return np.unique(np.concatenate((modes.w, (seen[:, np.newaxis] / odd).ravel())))


def invariant_points(system: System, low: float, high: float) -> np.ndarray:
    """Frequency ratios in (low, high) where the amplitude of z does not depend on beta: U = 0, T(6.9).

    Without damping these are all: between two of its poles U falls from +inf to -inf, once.
    """
    low = checks.number(low, "low", above=0.0)
    high = checks.number(high, "high", above=low)
    chi = system.modes.chi
    return _roots(lambda r: _functions(system, r, chi)[1], _poles(system, low), low, high)


def mass_invariant_points(system: System, mass: int, low: float, high: float) -> np.ndarray:
    """The same for the displacement of one mass, undamped: 1 - 2 V_k U/(V U_k) = 0, T(6.10).

    Of a mass in contact with a fixed wall the points are those of `invariant_points`.
    """
    mass = checks.whole(mass, "mass", least=1, most=system.n)
    low = checks.number(low, "low", above=0.0)
    high = checks.number(high, "high", above=low)
    modes = system.modes
    row = modes.phi[mass - 1]

    def difference(r: float) -> float:
        v_k, u_k = _functions(system, r, row)
        v, u = _functions(system, r, modes.chi)
        return (v - modes.base_motion) * u_k - 2.0 * v_k * u

    return _roots(difference, _poles(system, low), low, high)
