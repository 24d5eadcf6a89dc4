"""When a motion under no load has ended for all contacts.

With all contacts held, the energy E of the vibration about the place of rest never grows, and the force in
contact i stays within G_i sqrt(2 E) of its value there: if no contact can be overloaded, none ever moves.
"""

import math
from typing import NamedTuple

import numpy as np

from ..compiler import kernel
from ..general.problem import F, H, P, Q


class Bed(NamedTuple):
    """The structure with all contacts held, under no load; s is the state q - shift, q', f."""

    vibration: np.ndarray  # (V, 2 m + N) e = vibration s, with 2 E = |e|^2
    forces: np.ndarray  # (N, 2 m + N) forces in the contacts at the place of rest
    gains: np.ndarray  # (N,) G
    active: np.ndarray  # (1,) int: whether it is defined
    shift: np.ndarray  # (m,) modes that a constant load holds: by dampers to the ground, if the base moves on


@kernel
def _product(row, motion, weights, shift):
    """Sum of weights (2 m + N) times the state s; see `Bed`."""
    contacts = motion.sense.size
    modes = (weights.size - contacts) // 2
    sum_ = 0.0
    for m in range(modes):
        place = motion.state[Q, m] - shift[m]
        sum_ += weights[m] * place + weights[modes + m] * motion.state[P, m] / row.numbers[H]
    for j in range(contacts):
        sum_ += weights[2 * modes + j] * motion.state[F, j]
    return sum_


@kernel
def is_asleep(row, friction, motion, bed):
    """Whether no contact ever moves again."""
    if bed.active[0] == 0:
        return False
    for j in range(motion.sense.size):
        if motion.sense[j] != 0:
            return False
    square = 0.0
    for i in range(bed.vibration.shape[0]):
        part = _product(row, motion, bed.vibration[i], bed.shift)
        square += part * part
    size = math.sqrt(square)
    for j in range(motion.sense.size):
        force = abs(_product(row, motion, bed.forces[j], bed.shift))
        if force + size * bed.gains[j] > friction.static[j]:
            return False
    return True
