"""Sizes of steady states that a design is about."""

from typing import NamedTuple

import numpy as np

#: The loss of normal force over the preload, the largest of all contacts: above 1 a contact opens.
SEPARATION = "separation"


class Wanted(NamedTuple):
    """A size: "amplitude", "first_harmonic", "contact", "transmitted_force" or `SEPARATION`."""

    quantity: str
    row: int  # of the mass
    contact: int  # counted from 0


class Sizes(NamedTuple):
    """Steady states from one start, arrays of one shape."""

    size: np.ndarray  # NaN where none was found
    regime: np.ndarray
    stops: np.ndarray  # per cycle, the most of all contacts
    status: np.ndarray
