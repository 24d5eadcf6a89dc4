"""An elastic contact: a spring and a slider in series, |f| <= beta nu(tau).

Its force is a coordinate of the state, which never jumps.  While the slider slips it is the friction; else it
changes with the displacement in the contact.  A slip ends where the slider stops, y' = 0.
"""

from ....regimes import ONE_WAY_SLIDING, STICK_SLIP
from ...compiler import kernel
from ..counts import FIRST_SENSE, LAST_SENSE, REVERSALS, SLIPS, STUCK
from ..crossings import value_at
from ..problem import F, R, normal_row, varies
from .coulomb import comes_to_rest
from .kinds import has_force


@kernel
def force_weight(problem, row, j):
    """Weight of a change of the force beside changes of the modes.

    It is the displacement of a mode that moves the contact as far as the spring and the structure under this
    force.
    """
    square = row.numbers[R] * row.numbers[R]
    flexibility, share = 0.0, 0.0
    for m in range(problem.squares.size):
        flexibility += problem.chi[j, m] * problem.chi[j, m] / (problem.squares[m] + square)
        share = max(share, abs(problem.chi[j, m]))
    return flexibility / ((1.0 + problem.spring[j] * flexibility) * share) if share > 0.0 else 0.0


@kernel
def limit_at(problem, friction, motion, x, j):
    """Largest force at x of the present step."""
    return friction.kinetic[j] * value_at(motion.series, normal_row(problem, j), x)


@kernel
def _end_slip(problem, friction, motion, x, j):
    """Let the slider rest."""
    motion.state[F, j] = motion.sense[j] * limit_at(problem, friction, motion, x, j)
    motion.fresh[j] = 2 * motion.sense[j]
    motion.sense[j] = 0


@kernel
def end_slips(problem, friction, motion, x):
    """End the slips of all elastic contacts whose sliders stop at x of the present step."""
    for j in range(motion.sense.size):
        if has_force(problem, j) and motion.sense[j] != 0 and comes_to_rest(problem, friction, motion, x, j):
            _end_slip(problem, friction, motion, x, j)


@kernel
def change_phase(problem, friction, motion, x, contact, side):
    """Begin a slip, or end it with those of all other contacts that stop slipping at x.

    Elements of a bank slip together, and so do contacts of a symmetric structure.
    """
    if side != 0:
        motion.state[F, contact] = side * limit_at(problem, friction, motion, x, contact)
        motion.sense[contact] = side
        motion.fresh[contact] = max(0, side * motion.fresh[contact] - 1)  # the force's zeros less one of y'
        return
    _end_slip(problem, friction, motion, x, contact)
    end_slips(problem, friction, motion, x)


@kernel
def ends_rest(problem, motion, j):
    """Whether the contacts that keep both ends of a spring at rest are all held."""
    tied = False
    for i in range(motion.sense.size):
        if problem.ties[j, i]:
            tied = True
            if motion.sense[i] != 0:
                return False
    return tied


@kernel
def rest_springs(problem, friction, motion, order):
    """Bring springs to rest between ends that are at rest now, and let those go whose ends are not any more.

    Between ends at rest the velocity is zero for as long as they rest, and the force constant: neither is
    watched, because what is computed of them is rounding error.  A slip ends with the motion of the ends.
    A force that is at its limit when an end lets go either slips on or falls; which of them is decided by the
    first term of the velocity that is not zero.

    Parameters
    ----------
    problem, friction : Problem, Friction
    motion : Motion; senses, forces and `fresh` of the springs are set
    order : number of leading terms of the velocities that are zero where ends begin to move: 1 after a jump
        of a force, else 2
    """
    for j in range(motion.sense.size):
        if varies(problem, j):  # its slider slips between ends at rest, too
            continue
        rests = ends_rest(problem, motion, j)
        limit = friction.kinetic[j]
        if rests and motion.sense[j] != 0:
            motion.state[F, j] = motion.sense[j] * limit
            motion.sense[j] = 0
        if rests:
            motion.fresh[j] = 0
        elif motion.idle[j] and abs(motion.state[F, j]) >= limit:  # beyond it by rounding error
            sign = 1 if motion.state[F, j] > 0.0 else -1
            motion.state[F, j] = sign * limit
            motion.fresh[j] = sign * (1 + order)
        motion.idle[j] = rests


@kernel
def count(counts, j, new):
    """Count the begin of a slip, and whether its sense is that of the last one."""
    if new == 0:
        return
    counts[SLIPS, j] += 1.0
    if counts[LAST_SENSE, j] * new < 0.0:
        counts[REVERSALS, j] += 1.0
    counts[LAST_SENSE, j] = new
    if counts[FIRST_SENSE, j] == 0.0:
        counts[FIRST_SENSE, j] = new


@kernel
def moving_regime(problem, counts, j):
    """Regime of a contact that slips in the steady state."""
    if counts[STUCK, j] == 0.0 and problem.belt[j] != 0.0:
        return ONE_WAY_SLIDING
    return STICK_SLIP
