"""Steady motion of one mass with friction on a base that moves with several harmonics, and its derivatives.

    x'' = -w^2 (x - offset_x - y) - 2 zeta w (x' - y') - w^2 x_F s,   w = 2 pi f_n,   s = sgn(x' or x' - y')

The mass rubs on a wall that stands still or moves with the base y; the damper acts relative to the base or to
the ground.  In q = x - offset_x, less y where the wall moves, all four are one oscillator, r = f/f_n:

    r^2 q'' + 2 zeta r q' + q + x_F sgn(q') = Re sum_n G_n e^{i n tau}
    wall still: G_n = Y_n (1 + 2 i n zeta r), moving: G_n = (n r)^2 Y_n,   relative to the base
    wall still: G_n = Y_n,   moving: G_n = ((n r)^2 - 2 i n zeta r) Y_n,   relative to the ground

With a spring in the contact kt (q - p) takes the place of x_F sgn(q'), and p moves only where that is +-x_F.

The channels may differ in time and gain: x then follows the base as it was `delay` before, times `gain`,
which is a base G Y_n e^{-i n w_b d}, w_b = 2 pi f.  Lengths such as x_F are then in the unit of x: those in
the unit of the base are x_F/G.
"""

from typing import NamedTuple

import numpy as np

from ...general.one_mass import steady_motion
from ..parameters import ALIKE, CHANNELS, CONTACT_STIFFNESS, STIFFEST
from ..signals.phasors import Phasors, harmonics_at

PARAMETERS = ("f_n", "zeta", "x_F", "mu", *CHANNELS, "offset_x")
F_N, ZETA, X_F, MU, DELAY, GAIN, OFFSET = range(len(PARAMETERS))

#: Of a contact with a spring mu is 1, and the spring has its place; its compliance, k1/kt, stands for it.
LAW = MU
WITH_SPRING = (*PARAMETERS[:MU], CONTACT_STIFFNESS, *PARAMETERS[MU + 1 :])

CONTACTS = ("fixed-wall", "joined-base-wall")

#: Harmonics of the base that move the mass.
BASE_HARMONICS = 5

#: Cycles after which a motion that has not repeated is given up.
_CYCLES = 150

#: What is fitted cannot be below; see `inner`.
FLOOR = np.array([-np.inf, 0.0, 0.0, 0.0, -np.inf, -np.inf, -np.inf])
_FLOOR_WITH_SPRING = np.array([-np.inf, 0.0, 0.0, STIFFEST, -np.inf, -np.inf, -np.inf])

#: Steps of the difference quotients, of (mu - 1)^2 their square: steady states are exact to some 1e-12.
_STEP = 1e-5


class Shaken(NamedTuple):
    """One mass on its base, and the phases at which it is looked at."""

    contact: str
    damping_reference: str
    frequency: float  # Hz, of the base
    base: np.ndarray  # complex harmonics 0, 1, ...
    start: tuple[float, float]  # x and dx/dtau at tau = 0, from which a steady state is looked for
    phases: np.ndarray  # increasing, in [0, 2 pi)
    order: np.ndarray  # of the samples by phase
    elastic: bool = False  # whether the contact has a spring

    @property
    def names(self) -> tuple[str, ...]:
        """The parameters."""
        return WITH_SPRING if self.elastic else PARAMETERS

    @property
    def floor(self) -> np.ndarray:
        """What is fitted cannot be below."""
        return _FLOOR_WITH_SPRING if self.elastic else FLOOR


class Motion(NamedTuple):
    """A steady state."""

    places: np.ndarray  # x of every sample
    repeats: bool
    stops: int  # a cycle; slips of a contact with a spring
    stuck: float  # share of the cycle in which the contact does not slip
    turn_load: float  # the least load over stiffness at a turn without a stop; infinite if there is none


def shaken(
    contact: str, damping_reference: str, phasors: Phasors, time: np.ndarray, elastic: bool = False
) -> Shaken:
    """The mass on the base of a record, at these times."""
    base = phasors.values[0, : BASE_HARMONICS + 1]
    angle = 2.0 * np.pi * phasors.frequency * (time - phasors.middle)
    folded = np.mod(angle, 2.0 * np.pi)
    folded[folded == 2.0 * np.pi] = 0.0  # a tiny negative angle is rounded up
    order = np.argsort(folded, kind="stable")
    phases = folded[order]
    mass = phasors.values[1]
    start = (float(mass.sum().real), float((1j * np.arange(mass.size) * mass).sum().real))
    return Shaken(contact, damping_reference, phasors.frequency, base, start, phases, order, elastic)


def moved(mass: Shaken, change: np.ndarray) -> Shaken:
    """Change the motion of the base."""
    return mass._replace(base=mass.base + change)


def corrected(mass: Shaken, delay: float, gain: float) -> Shaken:
    """The base that the mass follows: as it was `delay` [s] before, times `gain`."""
    if (delay, gain) == (ALIKE["delay"], ALIKE["gain"]):  # to the bit
        return mass
    turn = 2.0 * np.pi * mass.frequency * delay * np.arange(mass.base.size)
    return mass._replace(base=gain * mass.base * np.exp(-1j * turn))


def contact_harmonics(mass: Shaken, x: np.ndarray) -> np.ndarray:
    """Harmonics of q without the offset, for a mass with harmonics x."""
    result = x.copy()
    if mass.contact == "joined-base-wall":
        result[: mass.base.size] -= mass.base
    return result


def load_harmonics(mass: Shaken, f_n: float, zeta: float) -> np.ndarray:
    """G_n of the oscillator in q."""
    n = np.arange(mass.base.size)
    turn = n * mass.frequency / f_n
    moves, relative = mass.contact == "joined-base-wall", mass.damping_reference == "base"
    spring = turn**2 if moves else np.ones(n.size)
    damper = 2j * zeta * turn * (int(relative) - int(moves))
    return mass.base * (spring + damper)


def motion(mass: Shaken, values: np.ndarray) -> Motion:
    """The steady state for f_n > 0, zeta >= 0, x_F >= 0, mu >= 1 (or a compliance >= 0), and any others."""
    f_n, zeta, friction, law, delay, gain, offset = (float(value) for value in values)
    mass = corrected(mass, delay, gain)
    mu, spring = (1.0, 1.0 / law if law > 0.0 else 0.0) if mass.elastic else (law, 0.0)
    moves = mass.contact == "joined-base-wall"
    q = mass.start[0] - offset - (float(mass.base.sum().real) if moves else 0.0)
    rate = (1j * np.arange(mass.base.size) * mass.base).sum().real if moves else 0.0
    found = steady_motion(
        mass.frequency / f_n, zeta, friction, mu, load_harmonics(mass, f_n, zeta),
        (q, mass.start[1] - float(rate)), mass.phases, _CYCLES, spring,
    )  # fmt: skip
    by_sample = np.empty(mass.phases.size)
    by_sample[mass.order] = found.places + offset + (harmonics_at(mass.base, mass.phases) if moves else 0.0)
    return Motion(by_sample, found.repeats, found.stops, found.stuck, found.turn_load)


def inner(values: np.ndarray, elastic: bool = False) -> np.ndarray:
    """Convert parameters to fitted variables, with (mu - 1)^2 for mu; compliances are fitted as they are.

    After a stop the mass leaves with an acceleration in proportion to mu - 1, but later by as much: at mu = 1
    the motion does not change with mu to first order.
    """
    result = values.copy()
    if not elastic:
        result[MU] = (values[MU] - 1.0) ** 2
    return result


def outer(values: np.ndarray, elastic: bool = False) -> np.ndarray:
    """Convert fitted variables to parameters."""
    result = values.copy()
    if not elastic:
        result[MU] = 1.0 + np.sqrt(max(float(values[MU]), 0.0))
    return result


def places_and_slopes(mass: Shaken, fitted: np.ndarray, free: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """x of every sample and its derivatives by what is fitted, shape (samples, parameters).

    Below its floor a parameter has no motion: there the places go on as a straight line.
    """
    floor, elastic = mass.floor, mass.elastic
    if elastic and not free[LAW]:  # a rigid contact may be held
        floor = np.where(np.arange(floor.size) == LAW, 0.0, floor)
    valid = np.maximum(fitted, floor)
    places = motion(mass, outer(valid, elastic)).places
    slopes = np.zeros((places.size, fitted.size))
    slopes[:, OFFSET] = 1.0  # the whole motion is moved
    unit = float(np.abs(mass.base[1:]).max())
    of_law = valid[LAW] if elastic else _STEP
    steps = _STEP * np.array([valid[F_N], 1.0, unit, of_law, 1.0 / mass.frequency, 1.0, unit])
    for index in np.flatnonzero(free[:OFFSET]):
        step = np.zeros(fitted.size)
        step[index] = steps[index]
        middle = np.maximum(valid, floor + step)
        ahead, behind = (motion(mass, outer(at, elastic)).places for at in (middle + step, middle - step))
        slopes[:, index] = (ahead - behind) / (2.0 * steps[index])
    return places + slopes @ (fitted - valid), slopes


def base_slopes(mass: Shaken, values: np.ndarray) -> np.ndarray:
    """Derivatives of x by the real parts of the base's harmonics, then by the imaginary ones."""
    columns = []
    step = _STEP * float(np.abs(mass.base[1:]).max())
    for part in (1.0, 1j):
        for n in range(mass.base.size):
            change = np.zeros(mass.base.size, dtype=complex)
            change[n] = part * step
            ahead, behind = (motion(moved(mass, side * change), values).places for side in (1.0, -1.0))
            columns.append((ahead - behind) / (2.0 * step))
    return np.stack(columns, axis=1)
