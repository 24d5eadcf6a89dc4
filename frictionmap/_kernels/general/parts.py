"""Rings whose sectors move alike, one after the other: the state after a part of half a period.

A part later every sector is where another one was.  The return map is then that over a part, with the state
turned to the sectors that follow from it, q(tau) = T q(tau + pi/parts).  Its fixed point is the steady state.
"""

from ..compiler import kernel, late_kernel
from .counts import MOVED
from .follow import FOLLOWED, follow
from .laws.kinds import state_size
from .problem import F, P, Q
from .return_map import go_round, put_state
from .tangent import identity


@kernel
def has_parts(problem, halves):
    """Whether the return map over these half periods has a root."""
    return halves == 1 and problem.parts > 1


@kernel
def _turn_state(problem, motion, memory):
    """Turn the state and the pattern in `motion` into the end of a way."""
    turn = problem.turn
    for part in range(2):
        for m in range(problem.push.shape[0]):
            found = 0.0
            for k in range(problem.push.shape[0]):
                found += turn.modes[m, k] * motion.state[part, k]
            memory.end[part, m] = found
    for j in range(motion.sense.size):
        other, sign = turn.contacts[j], turn.signs[j]
        memory.end[F, j] = sign * motion.state[F, other]
        memory.end_senses[j] = int(sign) * motion.sense[other]


@kernel
def _turn_rows(problem, motion, first):
    """Turn the rows first.. of the derivatives, of displacements or velocities of modes, with the sign of a
    half period.
    """
    modes, size = problem.push.shape[0], motion.tangent.shape[1]
    scratch = motion.onward[1]
    for m in range(modes):
        for i in range(size):
            scratch[m, i] = 0.0
        for k in range(modes):
            share = problem.turn.modes[m, k]
            for i in range(size if share != 0.0 else 0):
                scratch[m, i] -= share * motion.tangent[first + k, i]
    for m in range(modes):
        for i in range(size):
            motion.tangent[first + m, i] = scratch[m, i]


@kernel
def _turn_tangent(problem, motion):
    """Turn the derivatives, with the sign of a half period."""
    modes, size = problem.push.shape[0], motion.tangent.shape[1]
    _turn_rows(problem, motion, 0)
    _turn_rows(problem, motion, modes)
    if state_size(problem) == 2 * modes:
        return
    scratch = motion.onward[1]
    for j in range(motion.sense.size):
        for i in range(size):
            scratch[j, i] = -problem.turn.signs[j] * motion.tangent[2 * modes + problem.turn.contacts[j], i]
    for j in range(motion.sense.size):
        for i in range(size):
            motion.tangent[2 * modes + j, i] = scratch[j, i]


@kernel
def _move_alike(problem, counts):
    """Contacts that follow from each other move in half a period if one of them does in a part of it."""
    for _ in range(problem.parts):
        for j in range(counts.shape[1]):
            counts[MOVED, j] = max(counts[MOVED, j], counts[MOVED, problem.turn.contacts[j]])


@late_kernel(int)
def go_part(problem, row, friction, motion, memory, record, derive):
    """`go_round` over a part of half a period; its derivatives get the sign of half a period.

    Parameters
    ----------
    problem, row, friction, motion, memory, record, derive : see `go_round`
    """
    put_state(memory.start, memory.senses, motion)
    for part in range(memory.counts.shape[0]):
        for j in range(motion.sense.size):
            memory.counts[part, j] = 0.0
    if derive:
        identity(problem, motion)
    count = row.intervals[0] // problem.parts
    code = follow(problem, row, friction, 0, count, motion, memory.box, memory.counts, record, derive)
    for part in (Q, P, F):
        for i in range(memory.end.shape[1]):
            memory.end[part, i] = 0.0
    _turn_state(problem, motion, memory)
    _move_alike(problem, memory.counts)
    if derive and code == FOLLOWED:
        _turn_tangent(problem, motion)
    return code


@kernel
def go_on(problem, row, friction, halves, motion, memory, record, derive):
    """`go_round`, or `go_part` where the map over these half periods has a root.

    Parameters
    ----------
    problem, row, friction, halves, motion, memory, record, derive : see `go_round`

    Returns
    -------
    (code, halves) : code of `follow`; half periods followed
    """
    if has_parts(problem, halves):
        return go_part(problem, row, friction, motion, memory, record, derive), 1.0 / problem.parts
    return go_round(problem, row, friction, halves, motion, memory, record, derive), float(halves)
