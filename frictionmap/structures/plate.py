"""Bending of uniform rectangular plates: natural frequencies, modes and static compliance.

Lengths are over the side along x, and D = rho h = 1.  Edges are clamped, supported or free.  Ritz's method
with the products of one-dimensional functions

    (1+s)^p (1-s)^q P_k^(2q, 2p)(s),   p, q = 2, 1, 0 for a clamped, supported, free edge

which are orthonormal: the mass matrix is the identity.  Gauss's rule integrates their products exactly.
The largest eigenvalues of the inverse stiffness are those of the lowest modes; they are found to rounding,
although the condition of the stiffness grows with the eighth power of the number of functions.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

#: Order of the zero of a displacement at an edge.
EDGES = {"clamped": 2, "supported": 1, "free": 0}

#: Functions along each side; without a corner of a clamped and a free edge the lowest frequencies are then
#: exact to 1e-9 or better, with one to 1e-5.
FUNCTIONS = 28

#: By how many functions fewer the frequencies are computed again, to estimate their errors.
FEWER = 4

#: Nodes of Gauss's rule beyond the number of functions: products of two functions and of a polynomial of the
#: fourth degree are exact.
_NODES_MORE = 8

#: Terms of the single series of a supported plate.  Of a point by a force at it, the terms fall with the
#: third power of their number only, and the mean of all others is added; else they change signs or decay.
_TERMS = 20000


class Edges(NamedTuple):
    """Kinds of the edges x = 0, x = a, y = 0, y = b, see `EDGES`."""

    left: str
    right: str
    front: str
    back: str

    @property
    def supported(self) -> bool:
        """Whether all edges are supported."""
        return set(self) == {"supported"}


@dataclass(frozen=True)
class PlateModes:
    """Modes of a plate, as sums of products of functions."""

    edges: Edges
    aspect: float  # b/a
    functions: int  # along each side
    rigid: int  # number of rigid-body modes, which come first
    w: np.ndarray  # (n^2,) all frequencies of the approximation, increasing; 0 of rigid-body modes
    vectors: np.ndarray  # (n^2, n^2) in columns

    def shapes(self, points: np.ndarray, count: int) -> np.ndarray:
        """The first `count` modes at points (points, 2) over a, of unit modal mass; (points, count)."""
        along = _values(self.edges.left, self.edges.right, self.functions, 2.0 * points[:, 0] - 1.0)[0]
        across = _values(
            self.edges.front, self.edges.back, self.functions, 2.0 * points[:, 1] / self.aspect - 1.0
        )[0]
        scale = 2.0 / math.sqrt(self.aspect)
        products = scale * (along[:, :, np.newaxis] * across[:, np.newaxis, :]).reshape(len(points), -1)
        return np.asarray(products @ self.vectors[:, :count])

    def compliance(self, points: np.ndarray, beyond: int = 0) -> np.ndarray:
        """Displacements at points by unit forces at points, (points, points), without the first modes.

        beyond : number of elastic modes left out, besides the rigid-body modes
        """
        first = self.rigid + beyond
        parts = self.shapes(points, self.w.size)[:, first:] / self.w[first:]
        return np.asarray(parts @ parts.T)

    @property
    def participation(self) -> np.ndarray:
        """Integrals of all modes over the plate: their loads by a unit acceleration of the edges, (n^2,)."""
        s, weights = np.polynomial.legendre.leggauss(self.functions + _NODES_MORE)
        along = weights @ _values(self.edges.left, self.edges.right, self.functions, s)[0]
        across = weights @ _values(self.edges.front, self.edges.back, self.functions, s)[0]
        return np.asarray(0.5 * math.sqrt(self.aspect) * np.outer(along, across).ravel() @ self.vectors)

    def sag(self, points: np.ndarray, first: int) -> np.ndarray:
        """Displacements at points by that acceleration, (points,), without the first modes."""
        share = self.participation[first:] / self.w[first:] ** 2
        return np.asarray(self.shapes(points, self.w.size)[:, first:] @ share)


def _values(first: str, last: str, count: int, s: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Functions with edges at s = -1 and 1 (points, count), and their first and second derivatives by s."""
    from scipy.special import eval_jacobi

    p, q = EDGES[first], EDGES[last]
    k = np.arange(count)
    column = s[:, np.newaxis]
    polynomial = []
    for order in range(3):  # derivatives of P_k^(2q, 2p)
        factor = np.ones(count)
        for step in range(order):
            factor = factor * 0.5 * (k + 2 * q + 2 * p + 1 + step)
        own = np.where(k >= order, k - order, 0)
        value = eval_jacobi(own, 2 * q + order, 2 * p + order, column)
        polynomial.append(np.where(k >= order, factor * value, 0.0))
    edge = np.polynomial.Polynomial([1.0, 1.0]) ** p * np.polynomial.Polynomial([1.0, -1.0]) ** q
    weight = [edge(column), edge.deriv(1)(column), edge.deriv(2)(column)]
    size = np.sqrt(_norms(p, q, k))
    return (
        weight[0] * polynomial[0] / size,
        (weight[1] * polynomial[0] + weight[0] * polynomial[1]) / size,
        (weight[2] * polynomial[0] + 2.0 * weight[1] * polynomial[1] + weight[0] * polynomial[2]) / size,
    )


def _norms(p: int, q: int, k: np.ndarray) -> np.ndarray:
    """Integrals over [-1, 1] of the squares of (1+s)^p (1-s)^q P_k^(2q, 2p)."""
    alpha, beta = 2 * q, 2 * p
    ratio = np.ones(k.size)  # (k+alpha)! (k+beta)! / (k! (k+alpha+beta)!)
    for step in range(1, alpha + 1):
        ratio = ratio * (k + step) / (k + beta + step)
    return 2.0 ** (alpha + beta + 1) / (2 * k + alpha + beta + 1) * ratio


def _line(first: str, last: str, count: int, length: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Integrals along a side of phi_i'' phi_j'', phi_i' phi_j' and phi_i phi_j'', (count, count) each."""
    s, weights = np.polynomial.legendre.leggauss(count + _NODES_MORE)
    value, slope, bend = _values(first, last, count, s)
    scale = 2.0 / length
    weighted = weights[:, np.newaxis]
    return (
        scale**4 * bend.T @ (weighted * bend),
        scale**2 * slope.T @ (weighted * slope),
        scale**2 * value.T @ (weighted * bend),
    )


def _stiffness(edges: Edges, aspect: float, nu: float, n: int) -> np.ndarray:
    """Stiffness (n^2, n^2) of the products of n functions along each side."""
    bend_x, slope_x, mixed_x = _line(edges.left, edges.right, n, 1.0)
    bend_y, slope_y, mixed_y = _line(edges.front, edges.back, n, aspect)
    one = np.eye(n)
    found = np.kron(bend_x, one) + np.kron(one, bend_y)
    found += nu * (np.kron(mixed_x, mixed_y.T) + np.kron(mixed_x.T, mixed_y))
    found += 2.0 * (1.0 - nu) * np.kron(slope_x, slope_y)
    return np.asarray(found)


def rigid_modes(edges: Edges) -> int:
    """Number of rigid-body modes: 3 of a free plate, 1 of a plate that can turn about one edge."""
    kinds = [kind for kind in edges if kind != "free"]
    if not kinds:
        return 3
    return int(kinds == ["supported"])


def solve_plate(edges: Edges, aspect: float, nu: float, functions: int = FUNCTIONS) -> PlateModes:
    """All modes of the approximation with n functions along each side.

    Parameters
    ----------
    edges : Edges
    aspect : b/a
    nu : Poisson's ratio
    functions : n
    """
    from scipy.linalg import eigh, solve_triangular

    stiffness = _stiffness(edges, aspect, nu, functions)
    rigid = rigid_modes(edges)
    shift = 1.0 if rigid else 0.0
    stiffness[np.diag_indices_from(stiffness)] += shift
    size = np.sqrt(np.diag(stiffness))
    factor = np.linalg.cholesky(stiffness / np.outer(size, size))
    root = solve_triangular(factor, np.diag(1.0 / size), lower=True)
    inverse, vectors = eigh(root.T @ root)
    squares = 1.0 / inverse[::-1] - shift
    squares[:rigid] = 0.0
    return PlateModes(edges, aspect, functions, rigid, np.sqrt(squares), vectors[:, ::-1])


def supported_compliance(points: np.ndarray, aspect: float) -> np.ndarray:
    """Displacements of a plate with four supported edges at points (points, 2) over a by unit forces there.

    A single series of sines along x; its factor -1/(2 alpha) d/d alpha of
    sinh(alpha y) sinh(alpha (b - y'))/(alpha sinh(alpha b)), y <= y', is written with decaying exponentials.
    """
    b, m = aspect, np.arange(1, _TERMS + 1)
    alpha = m * math.pi
    waves = np.sin(np.outer(points[:, 0], alpha))
    found = np.empty((len(points), len(points)))
    for i, (_, y) in enumerate(points):
        for j in range(i + 1):
            low, high = min(y, points[j, 1]), max(y, points[j, 1])
            factor = _across(alpha, low, b - high, b)
            found[i, j] = found[j, i] = 2.0 * float(waves[i] * waves[j] @ factor)
        if factor.any():  # terms tend to sin^2/(4 alpha^3), the mean of sin^2 is 1/2
            found[i, i] += 1.0 / (8.0 * math.pi**3 * (_TERMS + 0.5) ** 2)
    return found


def _across(alpha: np.ndarray, low: float, high: float, b: float) -> np.ndarray:
    """g = -1/(2 alpha) dG/d alpha of G = sinh(alpha l) sinh(alpha h)/(alpha sinh(alpha b)), l + h <= b."""
    below, above, whole = (-np.expm1(-2.0 * alpha * length) for length in (low, high, b))
    near = np.exp(-alpha * (b - low - high))  # G = near below above/(2 alpha whole)
    value = near * below * above / (2.0 * alpha * whole)
    if low == 0.0 or high == 0.0:
        return np.zeros_like(alpha)
    rate = (
        low * (2.0 - below) / below + high * (2.0 - above) / above - b * (2.0 - whole) / whole - 1.0 / alpha
    )  # dG/d alpha over G: sums of coth
    return -value * rate / (2.0 * alpha)
