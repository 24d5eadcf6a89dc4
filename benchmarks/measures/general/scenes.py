"""Systems that are measured, as the package and as the other solvers define them.

All are chains of equal masses and springs with the load on mass 1 and mu = 1.  E1 and E2 are common examples:
two masses with contacts of mass 1 with a wall and between the masses; five masses with contacts of masses 1
and 5 with walls and between masses 2 and 3.
"""

import cmath
import math
from collections.abc import Mapping
from typing import NamedTuple

import frictionmap as fm

from ...peers.contacts import ContactBody

ONE = "one mass, one harmonic"
TWO = "one mass, two harmonics"
SQUARE = "one mass, square wave of 50 harmonics"
FIVE = "five masses, three harmonics"
E1 = "two masses, two contacts (E1)"
E2 = "five masses, three contacts (E2)"
ELASTIC = "one mass, elastic contact, kt = 3"


class Scene(NamedTuple):
    """Chain with contacts, its load on mass 1, and where its cells lie."""

    body: ContactBody
    ratios: tuple[float, ...]  # friction of each contact over beta
    stiffness: float | None = None  # of the contacts; None: rigid
    frequencies: tuple[float, float] = (0.25, 1.5)

    def system(self) -> fm.System:
        """The system as the package defines it, always in the form of general systems."""
        body = self.body
        ones = [1.0] * body.masses
        contacts = [
            fm.Contact(
                "fixed-wall" if len(masses) == 1 else "between-masses", masses, ratio=ratio,
                stiffness=self.stiffness,
            )
            for masses, ratio in zip(body.contacts, self.ratios, strict=True)
        ]  # fmt: skip
        return fm.System(
            contacts=contacts, mass_ratios=ones, stiffness_ratios=ones, damping_ratios=body.zeta,
            load_harmonics={n: [value, *[0.0] * (body.masses - 1)] for n, value in body.load.items()},
        )  # fmt: skip

    def forces(self, beta: float) -> tuple[float, ...]:
        """Friction of each contact."""
        return tuple(ratio * beta for ratio in self.ratios)


def square_wave(highest: int) -> Mapping[int, complex]:
    """Harmonics of a square wave between -1 and 1 with a maximum at tau = 0."""
    return {n: complex(4.0 / (math.pi * n) * (1.0 if n % 4 == 1 else -1.0)) for n in range(1, highest + 1, 2)}


def _turned(size: float, degrees: float) -> complex:
    return cmath.rect(size, math.radians(degrees))


_ONE_HARMONIC = {1: 1.0 + 0.0j}
_TWO_HARMONICS = {1: 1.0 + 0.0j, 2: _turned(0.6, -70.0)}
_THREE_HARMONICS = {1: 1.0 + 0.0j, 2: _turned(0.4, 40.0), 3: _turned(0.3, -100.0)}

SCENES = {
    ONE: Scene(ContactBody(((1,),), _ONE_HARMONIC, 1, 0.05), (1.0,)),
    TWO: Scene(ContactBody(((1,),), _TWO_HARMONICS, 1, 0.05), (1.0,)),
    SQUARE: Scene(ContactBody(((1,),), square_wave(50), 1, 0.05), (1.0,)),
    FIVE: Scene(ContactBody(((3,),), _THREE_HARMONICS, 5, 0.05), (1.0,)),
    E1: Scene(ContactBody(((1,), (1, 2)), _ONE_HARMONIC, 2, 0.01), (1.0, 0.3)),
    E2: Scene(ContactBody(((1,), (2, 3), (5,)), _ONE_HARMONIC, 5, 0.01), (1.0, 0.5, 0.25)),
    ELASTIC: Scene(ContactBody(((1,),), _ONE_HARMONIC, 1, 0.01), (1.0,), 3.0),
}


def many_contacts(count: int) -> fm.System:
    """Eight masses with a contact of each of the first `count` with a wall.

    Loads of different phase act on all masses, so that no contact is behind another.
    """
    ones = [1.0] * 8
    return fm.System(
        contacts=[fm.Contact("fixed-wall", k) for k in range(1, count + 1)], mass_ratios=ones,
        stiffness_ratios=ones, damping_ratios=0.02,
        load_harmonics={1: [_turned(1.0, 75.0 * k) for k in range(8)]},
    )  # fmt: skip
