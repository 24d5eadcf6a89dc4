"""How many half periods of the excitation a time is, and how many periods a motion takes to recur."""

import math

from ..compiler import kernel


@kernel
def half_periods(time):
    """Number of half periods of the excitation nearest to a time in tau."""
    return int(math.floor(time / math.pi + 0.5))


@kernel
def full_period(halves):
    """Excitation periods of a motion that recurs after `halves` half periods, as its mirror image if odd."""
    return halves if halves % 2 == 1 else halves // 2
