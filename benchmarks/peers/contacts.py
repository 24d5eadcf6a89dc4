"""Problem of the solvers for several contacts and periodic loads: bodies, cells, outcomes, the load.

Equal masses and springs, Coulomb contacts, a load of several harmonics on mass 1:

    r^2 x'' + r C1 x' + K x + W f = e_1 p(tau),   p = Re sum p_n e^{i n tau},   z = W^T x

with f_j = beta_j sgn(z_j') in a slide of contact j, and |f_j| <= beta_j while it sticks: static and kinetic
friction are equal.
"""

import math
from cmath import phase
from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from .body import Body, matrices
from .peer import Peer

#: Harmonics up to which a loop in Python is faster than arrays.
_FEW = 8


class ContactBody(NamedTuple):
    """Chain of equal masses and springs with contacts: of a mass with a wall, (A,), or of two, (A, B)."""

    contacts: tuple[tuple[int, ...], ...]
    load: Mapping[int, complex]  # phasor by order of the harmonic
    masses: int = 1
    zeta: float = 0.0

    @property
    def structure(self) -> tuple[np.ndarray, np.ndarray]:
        """K and C1, (masses, masses) each."""
        return matrices(Body(self.masses, zeta=self.zeta))

    @property
    def vectors(self) -> np.ndarray:
        """W, (masses, contacts)."""
        w = np.zeros((self.masses, len(self.contacts)))
        for j, masses in enumerate(self.contacts):
            w[masses[-1] - 1, j] = 1.0
            if len(masses) == 2:
                w[masses[0] - 1, j] = -1.0
        return w


class ContactCell(NamedTuple):
    """One steady state to find."""

    r: float
    beta: tuple[float, ...]  # of each contact


class ContactOutcome(NamedTuple):
    """Results of the last period, per contact; a range is max z - min z."""

    stops: tuple[float, ...]
    ranges: tuple[float, ...]


class ContactPeer(Peer):
    """A solver, made for one body; see `peer.Peer`."""

    def __init__(self, body: ContactBody) -> None:
        self.body = body  # type: ignore[assignment]

    def run(self, cell: ContactCell, cycles: int) -> ContactOutcome:  # type: ignore[override]
        """March `cycles` periods of the load from rest at tau = 0; raise RuntimeError if that fails."""
        raise NotImplementedError


def load_function(load: Mapping[int, complex]) -> Callable[[float], float]:
    """Return p as a function of tau, in the form that is faster for this number of harmonics."""
    terms = [(n, abs(value), phase(value)) for n, value in load.items()]
    if len(terms) <= _FEW:
        cos = math.cos
        return lambda tau: sum([size * cos(n * tau + angle) for n, size, angle in terms])
    orders, sizes, angles = np.array(terms).T
    return lambda tau: float(sizes @ np.cos(orders * tau + angles))


def load_samples(load: Mapping[int, complex], tau: np.ndarray) -> np.ndarray:
    """Values of p at phases tau."""
    return sum((value * np.exp(1j * n * tau)).real for n, value in load.items()) + np.zeros_like(tau)


def largest_difference(one: Sequence[float], other: Sequence[float]) -> float:
    """Largest difference of the ranges of two outcomes, over the largest range of the second."""
    return float(np.abs(np.subtract(one, other)).max() / np.max(other))
