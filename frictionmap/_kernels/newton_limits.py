"""Limits of Newton's method on the return map, of one mass and of structures, and its end."""

import math

from .compiler import kernel

MAX_NEWTON = 16  # steps

#: Steps below this share of the motion are rounding error, 2^-53; the second number: of many masses, whose
#: steps solve linear equations and have the rounding error of some operations.
ROUNDING, ROUNDING_OF_MANY = 1e-16, 1e-15

#: Newton steps below this share of the motion must shrink quadratically.
NEAR_END = 1e-6

#: Longest slide of an orbit, in periods of the slower of oscillator and load; no resolved orbit has a longer
#: one.
LONGEST_SLIDE = 100.0


@kernel
def next_step_negligible(move, last, miss, scale, tolerance):
    """Whether the next Newton step would be rounding error, quadratic convergence being expected.

    Where the step is much larger than the difference that it removes, it amplifies rounding error, and
    convergence cannot be predicted.
    """
    expected = move * (move / last) ** 2 if last < math.inf else move
    return expected <= ROUNDING * scale and ROUNDING * move <= tolerance * miss
