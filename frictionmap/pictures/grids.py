"""Axes of cells: edges between grid points, limits, linear or logarithmic."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..errors import InputError

#: A grid is logarithmic if the ratios of its points agree to this relative tolerance and their differences do
#: not.
_EVEN = 0.02

#: Cells that are kept beyond each limit of an axis.
_BEYOND = 3


def _is_even(steps: np.ndarray) -> bool:
    return bool(np.ptp(steps) <= _EVEN * steps.mean())


def is_logarithmic(values: np.ndarray) -> bool:
    """Whether grid points have a constant ratio rather than a constant difference."""
    if values.size < 3 or values[0] <= 0.0:
        return False
    return _is_even(np.diff(np.log(values))) and not _is_even(np.diff(values))


#: Height, in units of the axis, at which infinite values are drawn, so that lines leave the picture.
HIGH = 1e3


@dataclass(frozen=True)
class Grid:
    """One axis of a map: grid points, and the cells around them."""

    values: np.ndarray  # increasing
    shown: tuple[float, float] | None = None  # limits of the drawn axis, if not those of the values

    @cached_property
    def logarithmic(self) -> bool:
        """Whether the axis is logarithmic."""
        return is_logarithmic(self.values)

    def _warp(self, values: np.ndarray) -> np.ndarray:
        if not self.logarithmic:
            return values
        with np.errstate(divide="ignore"):
            return np.log(np.maximum(values, 0.0))

    @cached_property
    def edges(self) -> np.ndarray:
        """Edges of the cells, half-way between grid points on the drawn axis; shape (n + 1,)."""
        if self.values.size == 1:
            half = 0.5 * abs(self.values[0]) or 0.5
            return np.array([self.values[0] - half, self.values[0] + half])
        at = self._warp(self.values)
        ends = 1.5 * at[[0, -1]] - 0.5 * at[[1, -2]]
        edges = np.concatenate((ends[:1], 0.5 * (at[1:] + at[:-1]), ends[1:]))
        return np.exp(edges) if self.logarithmic else edges

    @cached_property
    def limits(self) -> tuple[float, float]:
        """Limits of the drawn axis: those asked for, or its end points, or the edges of a single cell."""
        if self.shown is not None:
            return self.shown
        first, last = (self.values if self.values.size > 1 else self.edges)[[0, -1]]
        return float(first), float(last)

    def part(self) -> slice:
        """The cells within the limits, and some beyond, so that the axis stays what it is."""
        first, last = np.searchsorted(self.values, self.limits)
        return slice(max(0, int(first) - _BEYOND), int(last) + _BEYOND)

    def share(self, values: np.ndarray) -> np.ndarray:
        """Position of values on the drawn axis: 0 at its start, 1 at its end."""
        low, high = self._warp(np.array(self.limits))
        return (self._warp(np.asarray(values, dtype=float)) - low) / (high - low)

    def at(self, share: np.ndarray) -> np.ndarray:
        """Values at positions on the drawn axis."""
        low, high = self._warp(np.array(self.limits))
        place = low + share * (high - low)
        return np.exp(place) if self.logarithmic else place


def limited(name: str, values: np.ndarray, limits: tuple[float, float] | None) -> Grid:
    """Return the axis of r or beta with these limits, or with its own.

    Raises
    ------
    InputError
        No cell is within the limits, or they are not > 0 on a logarithmic axis.
    """
    grid = Grid(values, limits)
    if limits is None:
        return grid
    if grid.logarithmic and limits[0] <= 0.0:
        raise InputError(f"limits of {name} must be > 0 on a logarithmic axis; got {limits[0]:g}")
    if limits[1] < values[0] or limits[0] > values[-1]:
        ends = f"{values[0]:.4g} to {values[-1]:.4g}"
        raise InputError(f"limits of {name} must overlap {ends}; got {limits[0]:g}, {limits[1]:g}")
    return grid
