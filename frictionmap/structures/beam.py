"""Bending of uniform beams: natural frequencies, modes and static compliance, for all pairs of ends.

Lengths are over that of the beam, and EI = rho A = 1: phi'''' = b^4 phi, w = b^2.  A mode is

    phi = A cos bx + B sin bx + C e^{-bx} + D e^{-b(1-x)}

whose terms stay within 1, so that no mode number costs digits.  A free beam has rigid-body modes, too.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

#: Orders of the derivatives that vanish at an end: displacement 0, slope 1, moment 2, shear force 3.
ENDS = {"clamped": (0, 1), "pinned": (0, 2), "free": (2, 3), "guided": (1, 3)}

#: Order of the derivative by whose sign at the right end modes are turned, and that sign: next to the end the
#: displacement is positive.
_TURNED = {"clamped": (2, 1.0), "pinned": (1, -1.0), "free": (0, 1.0), "guided": (0, 1.0)}

#: Steps of the iterations for b: each multiplies the error by 1/cosh b or less, 0.3 for the first mode of a
#: cantilever, and by far less for all others.
_MOST_STEPS = 60


class Ends(NamedTuple):
    """Kinds of the left and the right end, see `ENDS`."""

    left: str
    right: str

    @property
    def pair(self) -> frozenset[str]:
        """The kinds, whichever end has them: frequencies do not depend on it."""
        return frozenset(self)


def rigid_lines(ends: Ends) -> np.ndarray:
    """Rigid-body modes as lines r_0 + r_1 x of unit modal mass, (k, 2): a turn about a pinned end, or a
    translation and, if both ends are free, a turn about the middle.
    """
    bending = {"free", "guided"}
    if ends.pair == {"free", "pinned"}:
        return math.sqrt(3.0) * np.array([[0.0, 1.0] if ends.left == "pinned" else [1.0, -1.0]])
    if not ends.pair <= bending:
        return np.empty((0, 2))
    lines = np.array([[1.0, 0.0], [-math.sqrt(3.0), 2.0 * math.sqrt(3.0)]])
    return lines if ends.pair == {"free"} else lines[:1]


def rigid_shapes(ends: Ends, x: np.ndarray) -> np.ndarray:
    """Rigid-body modes at places x (points,); (points, k)."""
    lines = rigid_lines(ends)
    return lines[:, 0] + np.outer(x, lines[:, 1])


def roots(ends: Ends, count: int) -> np.ndarray:
    """The first roots b of the frequency equation above 0, (count,).

    They lie at (i + c) pi + delta.  The equation gives delta as a function of b, without cancellation.
    """
    i = np.arange(1, count + 1)
    pair = ends.pair
    if pair <= {"clamped", "free"}:  # cos b = 1/cosh b, or -1/cosh b for one of each
        mixed = len(pair) == 2
        centre = (i - 0.5 if mixed else i + 0.5) * math.pi
        side = np.where(i % 2 == 0, -1.0, 1.0)
        return _settled(centre, lambda b: side * np.arcsin(1.0 / np.cosh(np.minimum(b, 700.0))))
    if pair & {"clamped", "free"}:  # tan b = tanh b, or -tanh b
        pinned = "pinned" in pair
        sign = -1.0 if pinned else 1.0
        centre = (i - sign * 0.25) * math.pi
        return _settled(centre, lambda b: sign * np.arctan(np.exp(-2.0 * b)))
    return (i if len(pair) == 1 else i - 0.5) * math.pi


def _settled(centre: np.ndarray, shift: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
    """Solve b = centre + shift(b)."""
    b = centre
    for _ in range(_MOST_STEPS):
        b, before = centre + shift(b), b
        if (b == before).all():
            break
    return b


def _terms(b: float, x: np.ndarray, order: int) -> np.ndarray:
    """Derivatives of the four terms of a mode by x, over b^order; (points, 4)."""
    sign = -1.0 if order % 2 else 1.0
    found = np.empty((x.size, 4))
    cosine, sine = np.cos(b * x), np.sin(b * x)
    turned = ((cosine, sine), (-sine, cosine), (-cosine, -sine), (sine, -cosine))[order]
    found[:, 0], found[:, 1] = turned
    found[:, 2], found[:, 3] = sign * np.exp(-b * x), np.exp(-b * (1.0 - x))
    return found


def _mode(ends: Ends, b: float) -> np.ndarray:
    """Amplitudes (4,) of the terms of the mode with this root, of unit modal mass."""
    zero, one = np.zeros(1), np.ones(1)
    rows = [_terms(b, zero, order)[0] for order in ENDS[ends.left]]
    rows += [_terms(b, one, order)[0] for order in ENDS[ends.right]]
    amplitudes = np.linalg.svd(np.array(rows))[2][-1]
    at_end = [float(_terms(b, one, order)[0] @ amplitudes) for order in range(4)]
    # the integral of phi^2 by parts; the parts at the left end vanish, as does phi phi''' + phi' phi''
    square = 0.25 * (at_end[0] ** 2 + at_end[2] ** 2 - 2.0 * at_end[1] * at_end[3])
    order, sign = _TURNED[ends.right]
    return amplitudes * math.copysign(1.0 / math.sqrt(square), sign * at_end[order])


def shapes(ends: Ends, b: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Modes with roots b (modes,) at places x (points,) in [0, 1], of unit modal mass; (points, modes)."""
    found = np.empty((x.size, b.size))
    for k, root in enumerate(b):
        found[:, k] = _terms(float(root), x, 0) @ _mode(ends, float(root))
    for end, kind in ((0.0, ends.left), (1.0, ends.right)):
        if 0 in ENDS[kind]:
            found[x == end] = 0.0
    return found


def compliance(ends: Ends, x: np.ndarray) -> np.ndarray:
    """Displacements at places x by unit forces at places x, (points, points).

    Of a beam with rigid-body modes it is what all other modes contribute: the force and the inertia that it
    causes are in balance, and the displacement has no part along rigid-body modes.
    """
    return np.array([_deflection(ends, float(place), x) for place in x]).T


def _deflection(ends: Ends, place: float, x: np.ndarray) -> np.ndarray:
    """Displacements at x by a unit force at a place: a ramp^3/6, minus the inertia, plus a cubic."""
    lines = rigid_lines(ends)
    inertia = (lines[:, 0] + lines[:, 1] * place) @ lines  # a line: what rigid-body modes take of the force
    rows, right = [], []
    for end, kind in ((0.0, ends.left), (1.0, ends.right)):
        for order in ENDS[kind]:
            rows.append(_power_slopes(end, order))
            right.append(-float(_particular(np.array([end]), place, inertia, order)[0]))
    for line in lines:
        rows.append([line[0] / (k + 1) + line[1] / (k + 2) for k in range(4)])
        right.append(-_moment(place, inertia, line))
    cubic = np.linalg.lstsq(np.array(rows), np.array(right))[0]
    return np.asarray(_particular(x, place, inertia, 0) + np.polynomial.polynomial.polyval(x, cubic))


def _power_slopes(x: float, order: int) -> list[float]:
    """Derivatives of 1, x, x^2, x^3 at x."""
    return [math.perm(k, order) * x ** (k - order) if k >= order else 0.0 for k in range(4)]


def _particular(x: np.ndarray, place: float, inertia: np.ndarray, order: int) -> np.ndarray:
    """Derivatives of the part with the force and the inertia: (x - place)_+^3/6 minus I^4 of a line.

    Third derivatives are those at an end, x = 0 or 1.
    """
    ramp = np.where(x > place, x - place, 0.0) ** (3 - order) / math.factorial(3 - order)
    if order == 3:  # the shear force just outside of an end counts the force at it
        ramp = np.where(x == 1.0, 1.0, 0.0)
    first = x ** (4 - order) / math.factorial(4 - order)
    second = x ** (5 - order) / math.factorial(5 - order)
    return ramp - inertia[0] * first - inertia[1] * second


def _moment(place: float, inertia: np.ndarray, line: np.ndarray) -> float:
    """Integral over the beam of `_particular` times a line."""
    rest = 1.0 - place
    ramp = (line[0] + line[1] * place) * rest**4 / 24.0 + line[1] * rest**5 / 30.0
    taken = 0.0
    for k, part in enumerate(inertia):  # part x^k of the line, integrated four times
        size = part * math.factorial(k) / math.factorial(k + 4)
        taken += size * (line[0] / (k + 5) + line[1] / (k + 6))
    return float(ramp - taken)
