"""The displacement between its turning points: a smooth curve, or a straight line, for each branch.

On branch j, with x from -1 at t_j to 1 at t_{j+1}, a smooth displacement is the cubic from U_j to
U_{j+1} with slopes of zero at turning points, and (1 - x^2)^2 sum_k c_jk P_k(x) with Legendre polynomials
P_k.  The ends of the record are no turning points: the slopes there are unknown.
"""

from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.polynomial import Polynomial
from numpy.polynomial.legendre import leg2poly

_X = Polynomial([0.0, 1.0])

#: Shares of the displacements at the beginning and at the end of a branch; parts of the slopes there.
_LINE = ((1.0 - _X) / 2.0, (1.0 + _X) / 2.0)
_CUBIC = ((2.0 - 3.0 * _X + _X**3) / 4.0, (2.0 + 3.0 * _X - _X**3) / 4.0)
_SLOPES = ((1.0 + _X) * (1.0 - _X) ** 2 / 4.0, (1.0 + _X) ** 2 * (_X - 1.0) / 4.0)


class Layout(NamedTuple):
    """Where the unknowns of a displacement are: U_j, inner t_j, and the shapes of the branches."""

    begin: float  # s, first and last time of the record
    end: float
    terms: tuple[int, ...]  # of each branch: how many c_jk; -1: a straight line

    @property
    def branches(self) -> int:
        """How many branches there are."""
        return len(self.terms)

    @property
    def times(self) -> slice:
        """Unknown times of the turning points."""
        return slice(self.branches + 1, 2 * self.branches)

    @property
    def straight(self) -> bool:
        """Whether all branches are straight lines."""
        return self.terms[0] < 0

    def shapes(self, j: int) -> tuple[np.ndarray, list[int]]:
        """Functions of x that make up branch j, see `_functions`, and the unknowns that multiply them."""
        open_ends = tuple(end for end, branch in enumerate((0, self.branches - 1)) if j == branch)
        if self.straight:
            return _functions(-1, ()), [j, j + 1]
        before = 2 * self.branches + 2 + sum(self.terms[:j])
        slopes = [2 * self.branches + end for end in open_ends]
        return _functions(self.terms[j], open_ends), [
            j,
            j + 1,
            *range(before, before + self.terms[j]),
            *slopes,
        ]

    @property
    def size(self) -> int:
        """How many unknowns there are."""
        return 2 * self.branches if self.straight else 2 * self.branches + 2 + sum(self.terms)

    def nodes(self, values: np.ndarray) -> np.ndarray:
        """Times of the ends of all branches."""
        return np.concatenate(([self.begin], values[self.times], [self.end]))


class Motion(NamedTuple):
    """Displacement and its derivatives by time at some times, and their derivatives by the unknowns."""

    branch: np.ndarray  # (samples,) in which each sample is
    derivatives: np.ndarray  # (4, samples): u, u', u'', u'''
    slopes: np.ndarray  # (3, samples, unknowns): of u, u', u''


@cache
def _functions(terms: int, open_ends: tuple[int, ...]) -> np.ndarray:
    """Coefficients of functions of x and of their derivatives, shape (4, functions, powers)."""
    bulges = [(1.0 - _X**2) ** 2 * Polynomial(leg2poly(np.eye(terms)[k])) for k in range(terms)]
    functions = [*_CUBIC, *bulges, *(_SLOPES[end] for end in open_ends)] if terms >= 0 else [*_LINE]
    powers = max(function.coef.size for function in functions)
    result = np.zeros((4, len(functions), powers))
    for k, function in enumerate(functions):
        for n in range(4):
            coefficients = function.deriv(n).coef if n else function.coef
            result[n, k, : coefficients.size] = coefficients
    return result


def motion(layout: Layout, values: np.ndarray, time: np.ndarray) -> Motion:
    """The displacement at some times, also a little beyond the ends of the record."""
    nodes = layout.nodes(values)
    branch = np.clip(np.searchsorted(nodes, time, side="right") - 1, 0, layout.branches - 1)
    derivatives, slopes = np.empty((4, time.size)), np.zeros((3, time.size, layout.size))
    for j in range(layout.branches):
        here = np.flatnonzero(branch == j)
        if here.size:
            _branch(layout, values, j, nodes[j : j + 2], time[here], here, derivatives, slopes)
    return Motion(branch, derivatives, slopes)


def _branch(
    layout: Layout, values: np.ndarray, j: int, ends: np.ndarray, time: np.ndarray, here: np.ndarray,
    derivatives: np.ndarray, slopes: np.ndarray,
) -> None:  # fmt: skip
    """Fill in one branch: by t = t_j + (1 + x) L/2 the n-th derivative is (2/L)^n d^n u/dx^n."""
    length = ends[1] - ends[0]
    x = 2.0 * (time - ends[0]) / length - 1.0
    coefficients, places = layout.shapes(j)
    by_x = coefficients @ np.vander(x, coefficients.shape[2], increasing=True).T
    scale = (2.0 / length) ** np.arange(4)
    plain = np.einsum("nfs,f->ns", by_x, values[places])
    derivatives[:, here] = plain * scale[:, np.newaxis]
    for n in range(3):
        slopes[n][np.ix_(here, np.array(places))] = by_x[n].T * scale[n]
        for node, x_by_node, shorter in ((j, -(1.0 - x) / length, 1.0), (j + 1, -(1.0 + x) / length, -1.0)):
            if 0 < node < layout.branches:
                slopes[n][here, layout.branches + node] = scale[n] * (
                    plain[n + 1] * x_by_node + shorter * n * plain[n] / length
                )
