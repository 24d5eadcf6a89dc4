"""A rigid contact: a constraint holds it; its force jumps where a slide ends, and at a release for mu > 1.

What follows a jump is decided for all contacts at once, see `pattern`.
"""

from ....regimes import CONTINUOUS, ONE_WAY_SLIDING, STICK_SLIP
from ...compiler import kernel
from ..counts import NEAREST_STOP, STOPS, TURNS
from ..crossings import slope_at, value_at
from ..problem import force_row, normal_row
from .kinds import has_constraint

#: Loads within this share of their limit are at it together, for contacts with mu = 1.
_AT_LIMIT = 1e-11


@kernel
def jumps(friction, j, side):
    """Whether forces jump at an event of a contact."""
    return side == 0 or friction.static[j] > friction.kinetic[j]


@kernel
def change_phase(problem, friction, motion, x, contact, side):
    """Let a contact with mu = 1 slide on at the limit of its load, with all that are at theirs and go on."""
    for j in range(motion.sense.size):
        if not has_constraint(problem, j) or motion.sense[j] != 0 or friction.static[j] > friction.kinetic[j]:
            continue
        force, nu = force_row(problem, j), normal_row(problem, j)
        load = value_at(motion.series, force, x)
        sign = side if j == contact else (1 if load > 0.0 else -1)
        limit = friction.static[j] * value_at(motion.series, nu, x)
        rate = sign * slope_at(motion.series, force, x) - friction.static[j] * slope_at(motion.series, nu, x)
        if j == contact or (sign * load >= limit * (1.0 - _AT_LIMIT) and rate > 0.0):
            motion.sense[j] = sign
            motion.fresh[j] = 2
            motion.segment[j] = 0


@kernel
def count(counts, j, old, new, share):
    """Count a stop, or a turn with this share of the friction in the force that would hold the contact."""
    if new == 0:
        counts[STOPS, j] += 1.0
    elif old != 0:
        counts[TURNS, j] += 1.0
        counts[NEAREST_STOP, j] = max(counts[NEAREST_STOP, j], share)


@kernel
def moving_regime(problem, counts, j):
    """Regime of a contact that moves in the steady state."""
    if counts[STOPS, j] > 0.0:
        return STICK_SLIP
    if problem.belt[j] != 0.0 and counts[TURNS, j] == 0.0:
        return ONE_WAY_SLIDING
    return CONTINUOUS
