"""Two masses on a shaken base, without friction, in closed form.

    X_1 = (f1 f2/f0)^2 (f0^2 - f^2)/((f1^2 - f^2)(f2^2 - f^2)),   f1 < f0 < f2
    sqrt(k1/m1)/2 pi = f1 f2/f0,   gamma = m2/m1 = (f0^2 - f1^2)(f2^2 - f0^2)/f0^4,
    kappa = k2/k1 = (f0^2 - f1^2)(f2^2 - f0^2)/(f1 f2)^2

f1 and f2 are the natural frequencies, f0 is that of the second mass on its spring alone, where the first one
stands still.  gamma and kappa are those of T(6.17) to T(6.19), in closed form.
"""

from typing import NamedTuple

import numpy as np


class Ratios(NamedTuple):
    """Ratios of two masses that follow from three frequencies."""

    f_k1m1: float  # Hz
    gamma: float
    kappa: float


def ratios(f0: float, f1: float, f2: float) -> Ratios:
    """Ratios of two masses with natural frequencies f1 < f2, the first at rest at f0 between them."""
    split = (f0**2 - f1**2) * (f2**2 - f0**2)
    return Ratios(f1 * f2 / f0, split / f0**4, split / (f1 * f2) ** 2)


def ratio_slopes(f0: float, f1: float, f2: float) -> np.ndarray:
    """Derivatives of the logarithms of `ratios`, shape (3, 3), by f0, f1 and f2."""
    below, above = f0**2 - f1**2, f2**2 - f0**2
    split = np.array([2.0 * f0 / below - 2.0 * f0 / above, -2.0 * f1 / below, 2.0 * f2 / above])
    product = np.array([0.0, 1.0 / f1, 1.0 / f2])
    last = np.array([1.0 / f0, 0.0, 0.0])
    return np.array([product - last, split - 4.0 * last, split - 2.0 * product])


def log_amplitude(frequencies: np.ndarray, f: np.ndarray) -> np.ndarray:
    """ln |X_1|/Y at `f`, of `frequencies` f0, f1 and f2."""
    f0, f1, f2 = frequencies

    def away(place: float) -> np.ndarray:
        """ln |place^2 - f^2|, which has no square to overflow."""
        distance: np.ndarray = np.log(np.abs(place - f)) + np.log(place + f)
        return distance

    return 2.0 * np.log(f1 * f2 / f0) + away(f0) - away(f1) - away(f2)


def frequencies(f_k1m1: float, gamma: float, kappa: float) -> tuple[float, float, float]:
    """f0, f1 and f2 of two masses: the inverse of `ratios`."""
    zero = kappa / gamma
    half = 0.5 * (1.0 + kappa + zero)
    high = half + np.sqrt(half**2 - zero)
    f0, f1, f2 = f_k1m1 * np.sqrt([zero, zero / high, high])
    return float(f0), float(f1), float(f2)
