"""Sizes of steady states that a design is about."""

from typing import NamedTuple

import numpy as np


class Wanted(NamedTuple):
    """A size: "amplitude", "first_harmonic", "contact" or "transmitted_force"."""

    quantity: str
    row: int  # of the mass
    contact: int  # counted from 0


class Sizes(NamedTuple):
    """Steady states from one start, arrays of one shape."""

    size: np.ndarray  # NaN where none was found
    regime: np.ndarray
    stops: np.ndarray  # per cycle, the most of all contacts
    status: np.ndarray
