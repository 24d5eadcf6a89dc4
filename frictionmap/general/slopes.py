"""Steady sliding under friction over speed, one contact: slopes at which it loses stability, one-way sliding.

Sliding at one speed on a belt, friction of the slope -s over the speed acts as the damping -beta s c c^T.
"""

from typing import NamedTuple

import numpy as np
from scipy.linalg import eig

from ..model.friction_law import FrictionLaw
from ..model.system import System
from .held import largest, orders_of, sliding_phasors
from .problem import general_of

#: A zero is imaginary if its real part, and real if its imaginary part, is below this share of its size:
#: double zeros are computed to half of the digits.
REAL = 1e-6

#: Steps of Newton's method from the zeros of a pencil, with half of the digits, to rounding.
POLISHED = 6

#: Damping of a mode, over its rate, that is none; and zeros beyond which a pencil has infinite ones.
_NONE, _INFINITE = 1e-12, 1e12


class SlopeLimits(NamedTuple):
    """Friction beta times the slope of its fall."""

    limit: float  # from which steady sliding is unstable
    certificate: float  # up to which the steady state under any load is unique
    frequency: float  # of the vibration at the limit, over omega_1; NaN where a motion without decay is


def slope_limits(system: System) -> SlopeLimits:
    """Limits of the slope of the fall for a system with one contact."""
    modes = system.modes
    return limits_of(modes.mass, modes.damping, modes.stiffness, general_of(system).vectors[0])


def limits_of(mass: np.ndarray, damping: np.ndarray, stiffness: np.ndarray, c: np.ndarray) -> SlopeLimits:
    """Limits of the slope of the fall for the contact c of a structure.

    The limit is 1/max Y, Y(o) = i o c^T Z^-1 c where it is real, Z = K - o^2 M + i o C1: there a root of the
    motion crosses the imaginary axis.  The certificate is 1/(c^T C1^-1 c): the least fall with which
    C1 - beta s c c^T >= 0 does not hold.
    """
    if _undamped(mass, damping, stiffness, c):
        return SlopeLimits(0.0, 0.0, np.nan)
    most, at = max(
        (o * -_response(o, mass, damping, stiffness, c)[0].imag, o)
        for o in _zeros(mass, damping, stiffness, c)
    )
    moved, *_ = np.linalg.lstsq(damping, c)
    reached = np.abs(damping @ moved - c).max() <= REAL * np.abs(c).max()
    return SlopeLimits(1.0 / most, 1.0 / float(c @ moved) if reached else 0.0, at)


def _undamped(mass: np.ndarray, damping: np.ndarray, stiffness: np.ndarray, c: np.ndarray) -> bool:
    """Whether a free motion without decay moves the contact."""
    roots, vectors = np.linalg.eig(first_order(mass, damping, stiffness))
    lasts = np.abs(roots.real) <= _NONE * np.abs(roots)
    return bool((np.abs(c @ vectors[: c.size, lasts]) > REAL).any())


def first_order(mass: np.ndarray, damping: np.ndarray, stiffness: np.ndarray) -> np.ndarray:
    """Matrix of the states x, x', (2 n, 2 n); its eigenvalues are the roots l of l^2 M + l C + K."""
    n, inverse = len(mass), np.linalg.inv(mass)
    return np.block([[np.zeros((n, n)), np.eye(n)], [-inverse @ stiffness, -inverse @ damping]])


def finite_zeros(pencil: np.ndarray, shift: np.ndarray) -> np.ndarray:
    """Finite eigenvalues of pencil - l shift."""
    with np.errstate(divide="ignore", invalid="ignore"):
        zeros = eig(pencil, shift, right=False)
    zeros = zeros[np.isfinite(zeros)]
    return zeros[np.abs(zeros) < _INFINITE]


def rates_with(a: np.ndarray, b: np.ndarray, out: np.ndarray, sign: float) -> list[float]:
    """Rates o > 0 at which g(i o) = out.(i o - a)^-1 b is imaginary (sign 1) or real (sign -1).

    They are zeros of g(l) + sign g(-l), those of a linear system of twice the order, so that none is missed.
    They have half of the digits.
    """
    none = np.zeros_like(a)
    pencil = np.block(
        [
            [a, none, b[:, np.newaxis]],
            [none, -a, -sign * b[:, np.newaxis]],
            [out[np.newaxis], out[np.newaxis], np.zeros((1, 1))],
        ]
    )
    zeros = finite_zeros(pencil, np.diag(np.append(np.ones(2 * b.size), 0.0)))
    return [float(zero.imag) for zero in zeros if zero.imag > 0.0 and abs(zero.real) <= REAL * abs(zero)]


def _zeros(mass: np.ndarray, damping: np.ndarray, stiffness: np.ndarray, c: np.ndarray) -> list[float]:
    """Rates o > 0 at which g(i o) = c^T Z^-1 c is imaginary."""
    none = np.zeros(c.size)
    b, out = np.concatenate((none, np.linalg.solve(mass, c))), np.concatenate((c, none))
    found = []
    for o in rates_with(first_order(mass, damping, stiffness), b, out, 1.0):
        for _ in range(POLISHED):
            value, slope = _response(o, mass, damping, stiffness, c)
            o -= value.real / slope.real if slope.real != 0.0 else 0.0
        found.append(o)
    return found


def _response(
    o: float, mass: np.ndarray, damping: np.ndarray, stiffness: np.ndarray, c: np.ndarray
) -> tuple[complex, complex]:
    """g(i o) = c^T Z^-1 c and its derivative by o."""
    x = np.linalg.solve(stiffness - o * o * mass + 1j * o * damping, c.astype(complex))
    return complex(c @ x), complex(x @ (2.0 * o * mass - 1j * damping) @ x)


def one_way_speed(system: System, r: float, beta: float) -> float:
    """Least wall speed, over omega_1 P/k_1, from which one-way sliding in the last segment of the law is a
    motion of a system with one contact.

    The friction there is a constant and the damping beta a c c^T: the velocity V of the contact without
    friction becomes V/(1 + i n r beta a A), A = c^T Z^-1 c, per harmonic n.
    """
    general, modes = general_of(system), system.modes
    law = general.groups[0].first.law or FrictionLaw()
    rise = general.groups[0].friction(beta, 1.0)[0] * law.slope
    orders = np.array(orders_of(general), dtype=float)
    speeds = 1j * orders * sliding_phasors(system, np.array([r]))[0, 0]
    for k, n in enumerate(orders):
        flexible = _response(n * r, modes.mass, modes.damping, modes.stiffness, general.vectors[0])[0]
        speeds[k] /= 1.0 + 1j * n * r * rise * flexible
    belt = -1.0 if general.groups[0].first.belt < 0.0 else 1.0
    return law.speed[-1] + r * float(largest(orders, belt * speeds[np.newaxis])[0])
