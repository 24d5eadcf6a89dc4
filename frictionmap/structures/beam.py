"""Bending of uniform beams: natural frequencies, modes and static compliance, for all pairs of ends.

Lengths are over that of the beam, and EI = rho A = 1: phi'''' = b^4 phi, w = b^2.  A mode is

    phi = A cos bx + B sin bx + C e^{-bx} + D e^{-b(1-x)}

whose terms stay within 1, so that no mode number costs digits.  A free beam has rigid-body modes, too.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ..errors import InputError

#: Orders of the derivatives that vanish at an end: displacement 0, slope 1, moment 2, shear force 3.
ENDS = {"clamped": (0, 1), "pinned": (0, 2), "free": (2, 3), "guided": (1, 3)}

#: Order of the derivative by whose sign at the right end modes are turned, and that sign: next to the end the
#: displacement is positive.
_TURNED = {"clamped": (2, 1.0), "pinned": (1, -1.0), "free": (0, 1.0), "guided": (0, 1.0)}

#: Least root of a beam with masses at its ends; 10^6 times its own mass at the end of a cantilever has 0.04.
_LEAST_ROOT = 1e-2

#: Steps of the iterations for b: each multiplies the error by 1/cosh b or less, 0.3 for the first mode of a
#: cantilever, and by far less for all others.
_MOST_STEPS = 60


class Tips(NamedTuple):
    """Springs to the ground, over EI/L^3, and masses, over rho A L, at the left and the right end."""

    springs: tuple[float, float] = (0.0, 0.0)
    masses: tuple[float, float] = (0.0, 0.0)

    def shear(self, b: float) -> tuple[float, float]:
        """Share of phi in the conditions on phi'''/b^3 at the left and the right end."""
        left, right = (k / b**3 - m * b for k, m in zip(*self, strict=True))
        return left, -right


#: Ends without springs and masses.
BARE = Tips()


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


def rigid_left(ends: Ends, tips: Tips) -> int:
    """Number of rigid-body modes that springs at the ends leave."""
    lines = rigid_lines(ends)
    held = np.array([[1.0, float(end)] for end in (0, 1) if tips.springs[end]]).reshape(-1, 2)
    return len(lines) - int(np.linalg.matrix_rank(held @ lines.T)) if lines.size and held.size else len(lines)


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


def _difference(b: float) -> float:
    """sinh b - sin b, without cancellation."""
    if b > 1.0:
        return math.sinh(b) - math.sin(b)
    return 2.0 * sum(b ** (4 * k + 3) / math.factorial(4 * k + 3) for k in range(5))


def _dynamic_stiffness(b: float) -> np.ndarray:
    """Forces and moments at the ends by displacements and slopes there, at w = b^2; (4, 4)."""
    # over cosh b, which may exceed all doubles
    over = 1.0 / math.cosh(b) if b < 700.0 else 0.0
    s, c, t = math.sin(b), math.cos(b), math.tanh(b)
    if b < 1.0:
        h, sine, hyperbolic = 0.5 * b, math.sin(0.5 * b), math.sinh(0.5 * b)
        root = over * (4.0 * (sine * hyperbolic) ** 2 - 2.0 * _difference(h) * (sine + hyperbolic))
        apart, beyond = 2.0 * over * (sine**2 + hyperbolic**2), over * _difference(b)
    else:
        root, apart, beyond = over - c, 1.0 - c * over, t - s * over
    place, slope = b**3 * (s + c * t), b * (s - c * t)
    mixed, far = b**2 * s * t, -(b**3) * (s * over + t)
    across, turned = b**2 * apart, b * beyond
    return (
        np.array(
            [
                [place, mixed, far, across],
                [mixed, slope, -across, turned],
                [far, -across, place, -mixed],
                [across, turned, -mixed, slope],
            ]
        )
        / root
    )


def roots_with_tips(ends: Ends, tips: Tips, count: int) -> np.ndarray:
    """The first roots b of a beam with springs or masses at its ends, (count,).

    The number of roots below a b is that of the beam with both ends clamped, plus the number of negative
    eigenvalues of the dynamic stiffness (Wittrick and Williams): each root is found by bisection.
    """
    clamped = roots(Ends("clamped", "clamped"), count + 4)
    free = [2 * end + k for end, kind in enumerate(ends) for k in (0, 1) if k not in ENDS[kind]]

    def below(b: float) -> int:
        stiffness = _dynamic_stiffness(b)
        stiffness[0, 0] += tips.springs[0] - tips.masses[0] * b**4
        stiffness[2, 2] += tips.springs[1] - tips.masses[1] * b**4
        negative = np.linalg.eigvalsh(stiffness[np.ix_(free, free)]) < 0.0
        return int((clamped < b).sum()) + int(negative.sum())

    if below(_LEAST_ROOT):
        raise InputError(
            "end_masses",
            f"must leave the first root b of the frequency w = b^2 above {_LEAST_ROOT:g}, in units of the "
            f"beam; got {tips.masses[0]:g} and {tips.masses[1]:g} times its mass",
        )
    found = np.empty(count)
    for i in range(count):
        low, high = _LEAST_ROOT, float(clamped[i + 2])
        while (middle := 0.5 * (low + high)) not in (low, high):
            low, high = (low, middle) if below(middle) > i else (middle, high)
        found[i] = high
    return found


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


def _mode(ends: Ends, b: float, tips: Tips) -> np.ndarray:
    """Amplitudes (4,) of the terms of the mode with this root, of unit modal mass."""
    zero, one = np.zeros(1), np.ones(1)
    rows = []
    for end, kind, share in zip((zero, one), ends, tips.shear(b), strict=True):
        for order in ENDS[kind]:
            row = _terms(b, end, order)[0]
            rows.append(row + share * _terms(b, end, 0)[0] if order == 3 and share else row)
    amplitudes = np.linalg.svd(np.array(rows))[2][-1]
    at_end = [float(_terms(b, one, order)[0] @ amplitudes) for order in range(4)]
    at_start = [float(_terms(b, zero, order)[0] @ amplitudes) for order in range(4)]
    # the integral of phi^2 by parts; phi' phi'' vanishes at the ends, and phi phi''' where they are bare
    square = 0.25 * (at_end[0] ** 2 + at_end[2] ** 2 - 2.0 * at_end[1] * at_end[3])
    if tips != BARE:
        square += 0.75 * (at_end[0] * at_end[3] - at_start[0] * at_start[3]) / b
        square += tips.masses[0] * at_start[0] ** 2 + tips.masses[1] * at_end[0] ** 2
    order, sign = _TURNED[ends.right]
    return amplitudes * math.copysign(1.0 / math.sqrt(square), sign * at_end[order])


def shapes(ends: Ends, b: np.ndarray, x: np.ndarray, tips: Tips = BARE) -> np.ndarray:
    """Modes with roots b (modes,) at places x (points,) in [0, 1], of unit modal mass; (points, modes)."""
    found = np.empty((x.size, b.size))
    for k, root in enumerate(b):
        found[:, k] = _terms(float(root), x, 0) @ _mode(ends, float(root), tips)
    for end, kind in ((0.0, ends.left), (1.0, ends.right)):
        if 0 in ENDS[kind]:
            found[x == end] = 0.0
    return found


def participation(ends: Ends, b: np.ndarray, tips: Tips = BARE) -> np.ndarray:
    """Loads on the modes with roots b by a unit acceleration of both ends, (modes,).

    They are the integrals of the modes, and the masses at the ends times their displacements.
    """
    found = np.empty(b.size)
    for k, root in enumerate(b.tolist()):
        cosine, sine, left, right = _mode(ends, root, tips)
        decaying = -math.expm1(-root) * (left + right)
        found[k] = (cosine * math.sin(root) + sine * (1.0 - math.cos(root)) + decaying) / root
    if tips != BARE:
        found += np.array(tips.masses) @ shapes(ends, b, np.array([0.0, 1.0]), tips)
    return found


def rigid_participation(ends: Ends) -> np.ndarray:
    """Loads on the rigid-body modes by that acceleration, (0 to 2,)."""
    return np.asarray(rigid_lines(ends) @ [1.0, 0.5])


def sag(ends: Ends, x: np.ndarray, tips: Tips = BARE) -> np.ndarray:
    """Displacements at places x by a unit acceleration of both ends, as of `compliance`, (points,).

    The compliance is a polynomial of the fifth degree at most on either side of a place.
    """
    nodes, weights = np.polynomial.legendre.leggauss(4)
    found = np.zeros(x.size)
    for k, place in enumerate(x.tolist()):
        for low, length in ((0.0, place), (place, 1.0 - place)):
            within = low + 0.5 * length * (1.0 + nodes)
            found[k] += 0.5 * length * float(weights @ _deflection(ends, place, within, tips))
        if tips != BARE:
            found[k] += float(np.array(tips.masses) @ _deflection(ends, place, np.array([0.0, 1.0]), tips))
    return found


def compliance(ends: Ends, x: np.ndarray, tips: Tips = BARE) -> np.ndarray:
    """Displacements at places x by unit forces at places x, (points, points).

    Of a beam with rigid-body modes it is what all other modes contribute: the force and the inertia that it
    causes are in balance, and the displacement has no part along rigid-body modes.
    """
    return np.array([_deflection(ends, float(place), x, tips) for place in x]).T


def _deflection(ends: Ends, place: float, x: np.ndarray, tips: Tips) -> np.ndarray:
    """Displacements at x by a unit force at a place: a ramp^3/6, minus the inertia, plus a cubic."""
    lines = rigid_lines(ends) if tips == BARE else np.empty((0, 2))
    inertia = (lines[:, 0] + lines[:, 1] * place) @ lines  # a line: what rigid-body modes take of the force
    rows, right = [], []
    shares = (tips.springs[0], -tips.springs[1])
    for end, kind, share in zip((0.0, 1.0), ends, shares, strict=True):
        at = np.array([end])
        for order in ENDS[kind]:
            row, own = _power_slopes(end, order), float(_particular(at, place, inertia, order)[0])
            if order == 3 and share:
                own += share * float(_particular(at, place, inertia, 0)[0])
                row = [a + share * c for a, c in zip(row, _power_slopes(end, 0), strict=True)]
            rows.append(row)
            right.append(-own)
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
