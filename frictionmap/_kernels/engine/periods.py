"""How many half periods of the excitation a time is, and how many periods a motion takes to recur."""

import math

from ..compiler import kernel

#: Half periods of the excitation per unit of tau.
_PER_HALF_PERIOD = 1.0 / math.pi


@kernel
def half_periods(time):
    """Number of half periods of the excitation nearest to a time in tau."""
    return int(math.floor(time * _PER_HALF_PERIOD + 0.5))


@kernel
def full_period(halves):
    """Excitation periods of a motion that recurs after `halves` half periods, as its mirror image if odd."""
    return halves if halves % 2 == 1 else halves // 2
