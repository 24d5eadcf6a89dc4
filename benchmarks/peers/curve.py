"""Problem of the programs that follow response curves by harmonic balance: one mass, its contact, a curve.

    r^2 z'' + 2 zeta r z' + z + f = cos(tau)

f is the force of a slider, abs(f) <= beta, rigid or behind a spring; the wall of the contact is at rest.  The
programs choose the frequencies of the curve themselves.
"""

from typing import NamedTuple

import numpy as np

from .harmonic_balance import amplitudes
from .peer import Peer

#: Seconds that a curve may take.
LIMIT = 30

#: Samples per period: so many per period of the highest harmonic, and so many at least.
_SAMPLES, _LEAST_SAMPLES = 32, 128


class Rig(NamedTuple):
    """One mass with a contact, and the range of r."""

    zeta: float
    beta: float
    stiffness: float | None  # of the contact over k_1; None: rigid
    frequencies: tuple[float, float]


class Curve(NamedTuple):
    """A curve as it was followed, and how long that took."""

    seconds: float  # without imports, compilation, start and input
    r: np.ndarray  # (points,)
    harmonics: np.ndarray  # (points, h) z_1, z_3, ... of z = Re sum z_n e^{i n tau}
    failed: int  # steps that did not converge

    @property
    def amplitudes(self) -> np.ndarray:
        """Largest abs(z) of every point."""
        orders = np.arange(1.0, 2.0 * self.harmonics.shape[1], 2.0)
        return amplitudes(orders, np.hstack((self.harmonics.real, self.harmonics.imag)))

    @property
    def arrived(self) -> float:
        """Frequency up to which the curve was followed."""
        return float(self.r.max(initial=-np.inf))


class CurvePeer(Peer):
    """A program, made for one rig."""

    limit = LIMIT
    most = 15  # highest harmonic

    def __init__(self, rig: Rig) -> None:
        self.rig = rig

    def samples(self, highest: int) -> int:
        """Samples per period for the odd harmonics up to `highest`."""
        return max(_LEAST_SAMPLES, _SAMPLES * highest)

    def curve(self, highest: int) -> Curve:
        """Follow the curve from low to high frequency; raise RuntimeError if the program fails."""
        raise NotImplementedError
