"""Polynomials over the intervals of a record: interpolation, derivatives, integrals.

A piece is a polynomial in x = (t - t_k)/h_k, which runs from 0 to 1 over interval k.
"""

from typing import NamedTuple

import numpy as np

from .._kernels.general.problem import PIECE_TERMS

INTERPOLATIONS = ("linear", "cubic", "hold")

#: Samples whose distances differ by no more than this share are equally spaced: times in files are rounded.
_EVEN = 1e-6

#: A value and the one before it differ by no more than this share of the largest where nothing jumps: it is
#: what the rounding of a sum of the terms leaves.
SAME = 1e-13


class Pieces(NamedTuple):
    """A function of time as polynomials."""

    times: np.ndarray  # (K + 1,) ends of the intervals
    steps: np.ndarray  # (K,) their lengths, equal to the bit where they are meant to be
    terms: np.ndarray  # (K, terms) coefficients of powers of x

    @property
    def ends(self) -> np.ndarray:
        """Values at the ends of the intervals, (K,)."""
        return self.terms.sum(axis=1)


def even_step(times: np.ndarray) -> float | None:
    """The distance of samples that are equally spaced up to the rounding of their times; else None."""
    steps = np.diff(times)
    step = float((times[-1] - times[0]) / steps.size)
    return step if np.abs(steps - step).max() <= _EVEN * step else None


def levelled(steps: np.ndarray, duration: float) -> np.ndarray:
    """Steps that differ by no more than the rounding of times up to `duration`, each as the least of them."""
    values, place = np.unique(steps, return_inverse=True)
    begins = np.concatenate(([True], np.diff(values) > np.spacing(duration)))
    return values[begins][np.cumsum(begins) - 1][place]


def _filled(columns: list[np.ndarray]) -> np.ndarray:
    found = np.zeros((columns[0].size, PIECE_TERMS))
    for k, column in enumerate(columns):
        found[:, k] = column
    return found


def interpolated(times: np.ndarray, steps: np.ndarray, values: np.ndarray, how: str, ends: str) -> Pieces:
    """Interpolate samples.

    Parameters
    ----------
    times, values : (n,) of the samples
    steps : (n - 1,) distances of the samples
    how : "linear", "cubic", or "hold": the last value holds for a step more
    ends : of the spline: "natural", second derivative zero, or "clamped", first derivative zero
    """
    if how == "hold":
        steps = np.append(steps, steps[-1])
        return Pieces(np.append(times, times[-1] + steps[-1]), steps, _filled([values]))
    if how == "linear":
        return Pieces(times, steps, _filled([values[:-1], np.diff(values)]))
    return Pieces(times, steps, _filled(_spline(steps, values, ends)))


def _spline(steps: np.ndarray, values: np.ndarray, ends: str) -> list[np.ndarray]:
    """Terms of a spline: values and slopes are those of the pieces on both sides of a sample, to the bit.

    Samples that are equally spaced are a distance of 1 apart: differences of times would round by more.
    """
    from scipy.interpolate import CubicSpline  # loads slowly

    lengths = np.ones_like(steps) if (steps == steps[0]).all() else steps
    knots = np.concatenate(([0.0], np.cumsum(lengths)))
    slopes = CubicSpline(knots, values, bc_type=ends)(knots, 1)
    rise, first, last = np.diff(values), lengths * slopes[:-1], lengths * slopes[1:]
    return [values[:-1], first, 3.0 * rise - 2.0 * first - last, first + last - 2.0 * rise]


def padded(terms: np.ndarray, count: int) -> np.ndarray:
    """The same polynomials with `count` terms."""
    return np.pad(terms, ((0, 0), (0, count - terms.shape[1])))


def scaled(given: Pieces, time: float, value: float) -> Pieces:
    """The same function with other units of time and values."""
    return Pieces(given.times * time, given.steps * time, given.terms * value)


def derivative(given: Pieces) -> Pieces:
    """Derivative by time."""
    terms = np.zeros_like(given.terms)
    terms[:, :-1] = given.terms[:, 1:] * np.arange(1.0, terms.shape[1]) / given.steps[:, np.newaxis]
    return given._replace(terms=terms)


def integral(given: Pieces) -> Pieces:
    """Integral from the beginning."""
    count = given.terms.shape[1] + bool(given.terms[:, -1].any())
    terms = np.zeros((len(given.terms), count))
    terms[:, 1:] = given.terms[:, : count - 1] / np.arange(1.0, count) * given.steps[:, np.newaxis]
    gained = np.cumsum(terms.sum(axis=1, dtype=np.longdouble))
    terms[1:, 0] = gained[:-1]
    return given._replace(terms=terms)


def shifted(terms: np.ndarray, begin: np.ndarray) -> np.ndarray:
    """Coefficients (K, terms) of the same polynomials from x = begin (K,) on."""
    found, count = terms.copy(), terms.shape[1]
    for i in range(count - 1):
        for n in range(count - 2, i - 1, -1):
            found[:, n] += begin * found[:, n + 1]
    return found


def on_times(given: Pieces, times: np.ndarray, steps: np.ndarray) -> Pieces:
    """The same function over other intervals, each within one of its own; zero after its end."""
    middle = times[:-1] + 0.5 * steps
    k = np.searchsorted(given.times, middle, side="right") - 1
    inside = k < given.steps.size
    k = np.minimum(k, given.steps.size - 1)
    begin = (times[:-1] - given.times[k]) / given.steps[k]
    share = steps / given.steps[k]
    terms = shifted(given.terms[k], begin)
    terms *= share[:, np.newaxis] ** np.arange(terms.shape[1])
    return Pieces(times, steps, np.where(inside[:, np.newaxis], terms, 0.0))


def extremes(given: Pieces) -> tuple[float, float]:
    """Lowest and highest value, between samples too."""
    order = np.arange(given.terms.shape[1])
    ends = np.array([given.terms[:, 0], given.ends])
    low, high = float(ends.min()), float(ends.max())
    slopes = given.terms[:, 1:] * order[1:]
    # a polynomial exceeds its ends by an eighth of its largest second derivative at most
    reach = np.abs(given.terms) @ (order * (order - 1.0)) / 8.0
    beats = (ends.max(axis=0) + reach > high) | (ends.min(axis=0) - reach < low)
    for terms, slope in zip(given.terms[beats], slopes[beats], strict=True):
        values = []
        if slope[1:].any():
            roots = np.roots(slope[::-1])
            inside = roots[(np.abs(roots.imag) <= 1e-12) & (roots.real > 0.0) & (roots.real < 1.0)].real
            values = [float(np.polyval(terms[::-1], x)) for x in inside]
        low, high = min([low, *values]), max([high, *values])
    return low, high
