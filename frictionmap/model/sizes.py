"""Sizes of steady states that a design is about."""

from collections.abc import Callable
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


def sizes_of_points(
    on_grid: Callable[[dict[str, np.ndarray]], Sizes], r: np.ndarray, beta: np.ndarray, mu: float
) -> Sizes:
    """Sizes at points r and beta, (k,), as those of rows of a grid with a beta of their own.

    on_grid : sizes over the axes mu, r (n_r,) and beta (n_r, 1)
    """
    points, back = np.unique(np.stack((r, beta)), axis=1, return_inverse=True)
    axes = {"mu": np.array([mu]), "r": points[0], "beta": points[1, :, np.newaxis]}
    return Sizes(*(values[back.ravel(), 0] for values in on_grid(axes)))
