"""Free decay of one mass with Coulomb and viscous friction, in closed form, with its derivatives.

With x_F = F/k and the place x measured from the centre, half a cycle about s x_F follows another, s the sign
of the turning point it began at:

    x = s x_F + (X_j - s x_F) g(omega_n (t - t_j)),   g(u) = e^{-zeta u} (cos d u + zeta/d sin d u)
    A_{j+1} = q A_j - (1 + q) x_F,   A_j = s_j X_j,   q = e^{-pi zeta/d},   d = sqrt(1 - zeta^2)

Turning points are half a period apart, pi/(omega_n d), whatever the friction.  Without viscous damping A
falls by 2 x_F a half cycle, T(4.2).  Before t0 the mass is held where it is let go.
"""

from typing import NamedTuple

import numpy as np


class Decay(NamedTuple):
    """Parameters of a decay."""

    f_n: float  # natural frequency without friction and damping, Hz
    zeta: float  # viscous damping ratio, below 1 in modulus
    x_F: float  # noqa: N815  friction force over stiffness, in the unit of the displacement
    X0: float  # turning point at t0, from the centre
    t0: float  # a turning point, s
    centre: float  # where the unloaded mass is


PARAMETERS = Decay._fields


def half_period(decay: Decay) -> float:
    """Time between two turning points, s."""
    return 0.5 / (decay.f_n * np.sqrt(1.0 - decay.zeta**2))


def amplitudes(decay: Decay, n: int) -> np.ndarray:
    """A_0..A_n, shape (n + 1,): how far the turning points are from the centre.

    The last one may be negative: the mass has come to rest before the centre.
    """
    q, _ = _ratio(decay.zeta)
    result = np.empty(n + 1)
    result[0] = abs(decay.X0)
    for j in range(n):
        result[j + 1] = q * result[j] - (1.0 + q) * decay.x_F
    return result


def is_possible(decay: Decay, left: int) -> bool:
    """Whether the spring overcomes friction at the first `left` turning points, which the mass leaves."""
    return decay.x_F == 0.0 or bool((amplitudes(decay, left - 1) > decay.x_F).all())


def in_record(decay: Decay, end: float) -> int:
    """Half cycles that are over at a time [s], if the mass does not come to rest."""
    return int((end - decay.t0) / half_period(decay))


def envelope(decay: Decay, time: np.ndarray) -> np.ndarray:
    """Distances from the centre, shape (samples,), of the smooth curve through all turning points.

    With s half cycles since t0 it is q^s A_0 - (1 + q) x_F (1 - q^s)/(1 - q): a straight line without viscous
    damping, an exponential without friction.
    """
    halves = (time - decay.t0) / half_period(decay)
    decrement = np.pi * decay.zeta / np.sqrt(1.0 - decay.zeta**2)
    lost = -np.expm1(-decrement * halves)
    friction = halves if decrement == 0.0 else lost / -np.expm1(-decrement)
    return (1.0 - lost) * abs(decay.X0) - (1.0 + np.exp(-decrement)) * decay.x_F * friction


def displacement(decay: Decay, n: int, time: np.ndarray) -> np.ndarray:
    """Places at `time`, shape (samples,), of a mass that is at rest from turning point `n` on."""
    return displacement_and_slopes(decay, n, time)[0]


def displacement_and_slopes(decay: Decay, n: int, time: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Places, shape (samples,), and their derivatives by the parameters, shape (samples, 6).

    Places and speeds are continuous at turning points, so that the derivatives hold across them.
    """
    d = np.sqrt(1.0 - decay.zeta**2)
    sign = 1.0 if decay.X0 >= 0.0 else -1.0
    phase = 2.0 * np.pi * decay.f_n * np.maximum(time - decay.t0, 0.0)
    j = np.clip(np.floor(phase * d / np.pi), 0, n).astype(int)
    u = np.where(j < n, phase - j * np.pi / d, 0.0)
    moving = j < n
    s = sign * np.where(j % 2 == 0, 1.0, -1.0)
    height, by_zeta, by_friction, by_first = turning_point_slopes(decay, n)
    g, g_u, g_zeta = _half_cycle(u, decay.zeta)
    away = height[j] - decay.x_F
    place = s * np.where(moving, decay.x_F + away * g, height[j])
    speed = np.where(moving, s * away * g_u, 0.0)  # by the phase
    by_damping = by_zeta[j] * g + away * (g_zeta - g_u * j * np.pi * decay.zeta / d**3)
    slopes = np.empty((time.size, len(PARAMETERS)))
    slopes[:, 0] = speed * phase / decay.f_n
    slopes[:, 1] = s * np.where(moving, by_damping, by_zeta[j])
    slopes[:, 2] = s * np.where(moving, 1.0 + (by_friction[j] - 1.0) * g, by_friction[j])
    slopes[:, 3] = sign * s * by_first[j] * g
    slopes[:, 4] = -speed * 2.0 * np.pi * decay.f_n
    slopes[:, 5] = 1.0
    return decay.centre + place, slopes


def _ratio(zeta: float) -> tuple[float, float]:
    """q and its derivative by zeta."""
    d = np.sqrt(1.0 - zeta**2)
    q = np.exp(-np.pi * zeta / d)
    return q, -np.pi * q / d**3


def turning_point_slopes(decay: Decay, n: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """A_0..A_n, and their derivatives by zeta, x_F and A_0."""
    q, slope = _ratio(decay.zeta)
    height = amplitudes(decay, n)
    by_zeta, by_friction = np.zeros(n + 1), np.zeros(n + 1)
    for j in range(n):
        by_zeta[j + 1] = q * by_zeta[j] + slope * (height[j] - decay.x_F)
        by_friction[j + 1] = q * by_friction[j] - (1.0 + q)
    return height, by_zeta, by_friction, q ** np.arange(n + 1)


def _half_cycle(u: np.ndarray, zeta: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """g at the phases u since a turning point, and its derivatives by u and by zeta."""
    d = np.sqrt(1.0 - zeta**2)
    envelope, sine, cosine = np.exp(-zeta * u), np.sin(d * u), np.cos(d * u)
    g = envelope * (cosine + zeta / d * sine)
    g_zeta = -u * g + envelope * (u * zeta / d * sine + sine / d**3 - u * (zeta / d) ** 2 * cosine)
    return g, -envelope * sine / d, g_zeta
