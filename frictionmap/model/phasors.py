"""Complex arrays as pairs of real ones, whose operations round alike at every place of an array.

numpy's own do not: a product of complex numbers is fused in the middle of an array, and not at its end.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np


@dataclass(slots=True)
class Phasors:
    """Real and imaginary parts, of one shape."""

    re: np.ndarray
    im: np.ndarray

    @classmethod
    def zeros(cls, *shape: int) -> "Phasors":
        """All zero."""
        return cls(np.zeros(shape), np.zeros(shape))

    @classmethod
    def of(cls, values: np.ndarray) -> "Phasors":
        """From a complex array."""
        return cls(values.real, values.imag)

    def complex(self) -> np.ndarray:
        """As a complex array."""
        values = np.empty(self.re.shape, dtype=complex)
        values.real, values.imag = self.re, self.im
        return values

    def rows(self) -> np.ndarray:
        """As a complex array, transposed; sums over its rows go in the order of memory."""
        return np.ascontiguousarray(self.complex().T)

    def __getitem__(self, at: Any) -> "Phasors":
        return Phasors(self.re[at], self.im[at])

    def __setitem__(self, at: Any, values: "Phasors") -> None:
        self.re[at], self.im[at] = values.re, values.im

    def __add__(self, other: "Phasors") -> "Phasors":
        return Phasors(self.re + other.re, self.im + other.im)

    def __sub__(self, other: "Phasors") -> "Phasors":
        return Phasors(self.re - other.re, self.im - other.im)

    def __mul__(self, other: "Phasors") -> "Phasors":
        return Phasors(self.re * other.re - self.im * other.im, self.re * other.im + self.im * other.re)

    def __truediv__(self, other: "Phasors") -> "Phasors":
        """By the larger part of the divisor, so that nothing overflows on the way (Smith)."""
        wide = np.abs(other.im) > np.abs(other.re)
        large, small = np.where(wide, other.im, other.re), np.where(wide, other.re, other.im)
        with np.errstate(all="ignore"):  # a divisor of zero leaves what is no number
            ratio = small / large
            below = large + small * ratio
            re = np.where(wide, self.re * ratio + self.im, self.re + self.im * ratio)
            im = np.where(wide, self.im * ratio - self.re, self.im - self.re * ratio)
            return Phasors(re / below, im / below)

    def times(self, factor: Any) -> "Phasors":
        """Times real numbers."""
        return Phasors(factor * self.re, factor * self.im)

    def over(self, divisor: Any) -> "Phasors":
        """Over real numbers."""
        return Phasors(self.re / divisor, self.im / divisor)

    def turned(self) -> "Phasors":
        """Times i."""
        return Phasors(-self.im, self.re)

    def where(self, kept: np.ndarray, other: "Phasors") -> "Phasors":
        """These where `kept`, others elsewhere."""
        return Phasors(np.where(kept, self.re, other.re), np.where(kept, self.im, other.im))

    @property
    def size(self) -> np.ndarray:
        """Moduli."""
        return np.hypot(self.re, self.im)

    @property
    def nonzero(self) -> np.ndarray:
        """Where they are not zero."""
        return (self.re != 0.0) | (self.im != 0.0)
