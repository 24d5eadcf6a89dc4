"""Polynomials over the intervals of a record: interpolation, derivatives, integrals.

A piece is a polynomial of degree up to 5 in x = (t - t_k)/h_k, which runs from 0 to 1 over interval k.
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
    terms: np.ndarray  # (K, PIECE_TERMS) coefficients of powers of x

    @property
    def ends(self) -> np.ndarray:
        """Values at the ends of the intervals, (K,)."""
        return self.terms.sum(axis=1)


def even_step(times: np.ndarray) -> float | None:
    """The distance of samples that are equally spaced up to the rounding of their times; else None."""
    steps = np.diff(times)
    step = float((times[-1] - times[0]) / steps.size)
    return step if np.abs(steps - step).max() <= _EVEN * step else None


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
    from scipy.interpolate import CubicSpline  # loads slowly

    spline = CubicSpline(np.concatenate(([0.0], np.cumsum(steps))), values, bc_type=ends)
    scales = steps ** np.arange(4)[:, np.newaxis]
    return Pieces(times, steps, _filled(list(spline.c[::-1] * scales)))


def with_slopes(times: np.ndarray, steps: np.ndarray, values: np.ndarray, slopes: np.ndarray) -> Pieces:
    """Cubics with the values and the slopes of samples at both ends of each interval.

    A smooth function with these samples is at most h^4/384 times its largest fourth derivative away, h the
    longest interval.
    """
    begin, end = slopes[:-1] * steps, slopes[1:] * steps
    rise = np.diff(values)
    return Pieces(
        times, steps, _filled([values[:-1], begin, 3.0 * rise - 2.0 * begin - end, begin + end - 2.0 * rise])
    )


def derivative(given: Pieces) -> Pieces:
    """Derivative by time."""
    terms = np.zeros_like(given.terms)
    terms[:, :-1] = given.terms[:, 1:] * np.arange(1.0, PIECE_TERMS) / given.steps[:, np.newaxis]
    return given._replace(terms=terms)


def integral(given: Pieces) -> Pieces:
    """Integral from the beginning."""
    terms = np.zeros_like(given.terms)
    terms[:, 1:] = given.terms[:, :-1] / np.arange(1.0, PIECE_TERMS) * given.steps[:, np.newaxis]
    gained = np.cumsum(terms.sum(axis=1, dtype=np.longdouble))
    terms[1:, 0] = gained[:-1]
    return given._replace(terms=terms)


def shifted(terms: np.ndarray, begin: np.ndarray) -> np.ndarray:
    """Coefficients (K, PIECE_TERMS) of the same polynomials from x = begin (K,) on."""
    found = terms.copy()
    for i in range(PIECE_TERMS - 1):
        for n in range(PIECE_TERMS - 2, i - 1, -1):
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
    terms *= share[:, np.newaxis] ** np.arange(PIECE_TERMS)
    return Pieces(times, steps, np.where(inside[:, np.newaxis], terms, 0.0))


def extremes(given: Pieces) -> tuple[float, float]:
    """Lowest and highest value, between samples too."""
    low, high = np.inf, -np.inf
    slopes = given.terms[:, 1:] * np.arange(1.0, PIECE_TERMS)
    for terms, slope in zip(given.terms, slopes, strict=True):
        values = [terms[0], terms.sum()]
        if slope[1:].any():
            roots = np.roots(slope[::-1])
            inside = roots[(np.abs(roots.imag) <= 1e-12) & (roots.real > 0.0) & (roots.real < 1.0)].real
            values += [float(np.polyval(terms[::-1], x)) for x in inside]
        low, high = min(low, *values), max(high, *values)
    return low, high
