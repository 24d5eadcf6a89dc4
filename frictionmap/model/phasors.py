"""Complex arrays as pairs of real ones, whose operations round independently of the position in the array.

Complex products of numpy do not: they use fused operations in the middle of an array, but not at its end.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np


@dataclass(slots=True)
class Phasors:
    """Real and imaginary parts, of equal shape."""

    re: np.ndarray
    im: np.ndarray

    @classmethod
    def zeros(cls, *shape: int) -> "Phasors":
        """Phasors that are all zero."""
        return cls(np.zeros(shape), np.zeros(shape))

    @classmethod
    def of(cls, values: np.ndarray) -> "Phasors":
        """Phasors from a complex array."""
        return cls(values.real, values.imag)

    def complex(self) -> np.ndarray:
        """Convert to a complex array."""
        values = np.empty(self.re.shape, dtype=complex)
        values.real, values.imag = self.re, self.im
        return values

    def rows(self) -> np.ndarray:
        """Convert to a transposed complex array, contiguous along each row."""
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
        """Divide by the larger part of the divisor first, so that no intermediate value overflows (Smith)."""
        wide = np.abs(other.im) > np.abs(other.re)
        large, small = np.where(wide, other.im, other.re), np.where(wide, other.re, other.im)
        with np.errstate(all="ignore"):  # division by zero gives NaN
            ratio = small / large
            below = large + small * ratio
            re = np.where(wide, self.re * ratio + self.im, self.re + self.im * ratio)
            im = np.where(wide, self.im * ratio - self.re, self.im - self.re * ratio)
            return Phasors(re / below, im / below)

    def times(self, factor: Any) -> "Phasors":
        """Multiply by real numbers."""
        return Phasors(factor * self.re, factor * self.im)

    def over(self, divisor: Any) -> "Phasors":
        """Divide by real numbers."""
        return Phasors(self.re / divisor, self.im / divisor)

    def turned(self) -> "Phasors":
        """Multiply by i."""
        return Phasors(-self.im, self.re)

    def where(self, kept: np.ndarray, other: "Phasors") -> "Phasors":
        """Select these where `kept`, others elsewhere."""
        return Phasors(np.where(kept, self.re, other.re), np.where(kept, self.im, other.im))

    @property
    def size(self) -> np.ndarray:
        """Moduli."""
        return np.hypot(self.re, self.im)

    @property
    def nonzero(self) -> np.ndarray:
        """Whether each phasor is nonzero."""
        return (self.re != 0.0) | (self.im != 0.0)
