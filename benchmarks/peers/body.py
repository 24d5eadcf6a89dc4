"""Problem of every solver: bodies with one Coulomb contact, cells, and the results of a run.

Equal masses and springs, unit friction force in the contact, tau the phase of the load, ' = d/dtau:

    r^2 x'' + r C1 x' + K x + c f = e_l cos(tau),        f = beta sgn(z') in a slide,  z = c.x

One mass in the relative displacement z of its contact, which may be with a wall that moves with the base:

    r^2 z'' + 2 zeta r z' + z + beta sgn(z') = Re(F e^{i tau})

    F = 1                       contact with a fixed wall
    F = r^2 - 2 i zeta r        contact with a wall that moves with the base
"""

import math
from typing import NamedTuple

import numpy as np

TWO_PI = 2 * math.pi
SLIDE_END = -1e-13  # velocity along the slide at which it has ended, see `heyoka.OneMassHeyoka`

#: A stop shorter than this is not counted where stops are integrated: rounding makes such.
SHORTEST_STOP = 1e-9


class Body(NamedTuple):
    """Equal masses and springs; contact of one mass with a wall, load on one mass, modal damping.

    `wall` is "fixed-wall" or, for one mass, "joined-base-wall"; masses are counted from 1.
    """

    masses: int = 1
    contact: int = 1
    load: int = 1
    zeta: float = 0.0
    wall: str = "fixed-wall"


class Cell(NamedTuple):
    """One point of a map."""

    r: float
    beta: float
    mu: float = 1.0


class Outcome(NamedTuple):
    """Results of the last periods of a run; `stops` (per period) is nan if the contact sticks permanently."""

    stops: float
    Z: float


STUCK = Outcome(math.nan, 0.0)


def load_in_contact(wall: str, r: float, zeta: float) -> tuple[float, float]:
    """Return the amplitude and the phase of the load F in the contact of one mass."""
    if not r > 0:
        raise ValueError(f"r must be positive, not {r!r}")
    if wall == "fixed-wall":
        return 1.0, 0.0
    if wall == "joined-base-wall":
        return math.hypot(r * r, 2 * zeta * r), math.atan2(-2 * zeta * r, r * r)
    raise ValueError(f"contact must be 'fixed-wall' or 'joined-base-wall', not {wall!r}")


def matrices(body: Body) -> tuple[np.ndarray, np.ndarray]:
    """K and C1 with M = 1, (masses, masses) each, by numpy alone."""
    n = body.masses
    stiffness = 2.0 * np.eye(n) - np.eye(n, k=1) - np.eye(n, k=-1)
    stiffness[-1, -1] = 1.0
    squares, phi = np.linalg.eigh(stiffness)
    return stiffness, (phi * (2.0 * body.zeta * np.sqrt(squares))) @ phi.T
