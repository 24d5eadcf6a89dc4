"""The state after one or more half periods, and the state that returns: Newton's method."""

import math
from typing import NamedTuple

import numpy as np

from ..compiler import entry, kernel, late_kernel
from .counts import FIRST_SENSE, LAST_SENSE, MOVED, REVERSALS
from .follow import FOLLOWED, follow, follow_to_section
from .laws.coupled import is_coupled, solve_springs
from .laws.kinds import has_force, holding_stiffness, keeps_force, state_size
from .laws.speed import count_rows, has_law
from .loops import begin, factor_independent
from .pattern import BOX_ROWS
from .problem import MANY, SIZE, F, H, P, Q, is_rigid, moves_alone, padded
from .record import NOTHING
from .row import normal_at_section
from .series import solve_held
from .tangent import identity

#: Bits that coordinates are rounded to before a steady state is found anew.  Newton's method then takes two
#: steps; and of states that differ by rounding errors, 2^-50, hardly one in 10^9 is rounded to another one.
#: The second number is for the few that a turn near the section keeps from being found from there.
BITS = (16, 26)

#: Values of `Return.kept`: there must not be factors, since derivatives of the steady state itself are wanted
#: after Newton's method; there are none yet.
NEVER_KEPT, NONE_KEPT = 0, -1

#: Share of the square of a row of places, outside the span of others, that is rounding error.
_DEPENDENT = 1e-20


class Return(NamedTuple):
    """Memory for the return map."""

    start: np.ndarray  # (3, ...) the state at the section
    senses: np.ndarray  # (N,) the pattern there
    end: np.ndarray  # (3, ...) the state on return, with the sign of `halves`
    end_senses: np.ndarray  # (N,)
    matrix: np.ndarray  # (size, size)
    right: np.ndarray  # (size,)
    factors: np.ndarray  # (size + 1, size) those of an earlier matrix, see `orbits`; (1, 0): none are kept
    rows: np.ndarray  # (size,) int: the order of its rows
    kept: np.ndarray  # (1,) int: half periods that `factors` are of; NONE_KEPT, or NEVER_KEPT
    box: np.ndarray  # scratch of `follow`
    counts: np.ndarray  # counters of the last way
    way: np.ndarray  # (m,) displacement of the rigid-body modes on the last way, without a sign; else 0
    tied: np.ndarray  # (m + 1, N) scratch, see `_tie_rigid`


@entry
def make_return(problem):
    """Allocate the memory of the return map."""
    contacts, modes = problem.chi.shape
    size = state_size(problem)
    kept = size if contacts >= MANY else 0
    shape = (3, padded(max(modes, contacts)))
    return Return(
        np.zeros(shape), np.zeros(contacts, np.int64), np.zeros(shape), np.zeros(contacts, np.int64),
        np.zeros((size, size)), np.zeros(size), np.zeros((kept + 1, kept)), np.zeros(kept, np.int64),
        np.zeros(1, np.int64), np.zeros((BOX_ROWS, contacts)),
        np.zeros((count_rows(problem), contacts)), np.zeros(modes), np.zeros((modes + 1, contacts)),
    )  # fmt: skip


@kernel
def steady_period(halves):
    """Periods of the load after which a motion repeats that returns, mirrored if odd, after half periods."""
    return halves if halves % 2 == 1 else halves // 2


@kernel
def base_halves(problem):
    """Half periods between returns to the section: one where half periods of the load mirror each other.

    Where friction depends on the speed, and there may be several steady states, the motion itself decides
    where contacts come to rest: half a period would mirror the place.
    """
    return 1 if problem.symmetric and not has_law(problem) else 2


@kernel
def unique_halves(problem):
    """The same where there is one steady state: it is its own mirror image."""
    return 1 if problem.symmetric else 2


@kernel
def copy_state(state, into):
    """Copy a state at the section."""
    for part in range(3):
        for i in range(state.shape[1]):
            into[part, i] = state[part, i]


@kernel
def copy_motion(state, senses, into, into_senses):
    """Copy a state at the section and its pattern."""
    copy_state(state, into)
    for j in range(senses.size):
        into_senses[j] = senses[j]


@kernel
def put_state(state, senses, motion):
    """Set the state and the pattern of a motion."""
    copy_motion(state, senses, motion.state, motion.sense)
    for j in range(senses.size):
        motion.fresh[j] = 0


@kernel
def take_state(motion, state, senses, sign):
    """Copy the state and the pattern of a motion, with a sign."""
    for part in range(3):
        for i in range(state.shape[1]):
            state[part, i] = sign * motion.state[part, i]
    for j in range(senses.size):
        senses[j] = motion.sense[j] if sign > 0.0 else -motion.sense[j]


@kernel
def forget_places(problem, state):
    """Set the places of rigid-body modes to 0: motions that differ in them alone are the same."""
    for m in range(problem.squares.size):
        if is_rigid(problem, m):
            state[Q, m] = 0.0


@kernel
def go_round(problem, row, friction, halves, motion, memory, record, derive):
    """Follow the motion from `memory.start` over some half periods, to `memory.end`.

    After an odd number of them the signs are those of the mirrored motion.

    Parameters
    ----------
    problem, row, friction : Problem, Row, Friction
    halves : number of half periods
    motion, memory, record : Motion, Return, Record
    derive : whether the derivatives are carried on

    Returns
    -------
    int : code of `follow`
    """
    put_state(memory.start, memory.senses, motion)
    for part in range(memory.counts.shape[0]):
        for j in range(motion.sense.size):
            memory.counts[part, j] = 0.0
    for j in range(motion.sense.size):
        memory.counts[LAST_SENSE, j] = memory.counts[FIRST_SENSE, j] = memory.senses[j]
    if derive:
        identity(problem, motion)
    code, count = FOLLOWED, row.intervals[0]
    for half in range(halves):
        if code == FOLLOWED:
            code = follow(
                problem, row, friction, half % 2 * count, count, motion, memory.box, memory.counts, record,
                derive,
            )  # fmt: skip
    sign = -1.0 if halves % 2 == 1 else 1.0
    for j in range(motion.sense.size):  # the first slip follows the last one of the time before
        if memory.counts[FIRST_SENSE, j] * (sign * memory.counts[LAST_SENSE, j]) < 0.0:
            memory.counts[REVERSALS, j] += 1.0
    for m in range(problem.squares.size):
        memory.way[m] = motion.state[Q, m] - memory.start[Q, m] if is_rigid(problem, m) else 0.0
    take_state(motion, memory.end, memory.end_senses, sign)
    forget_places(problem, memory.end)
    return code


@kernel
def _start(problem, row, friction, state, motion, memory):
    """Set the initial state, and decide its pattern; see `from_rest`.

    Returns
    -------
    (determined, tau) : whether the contacts determine their forces; phase
    """
    for m in range(problem.push.shape[0]):
        motion.state[Q, m] = state[Q, m]
        motion.state[P, m] = row.numbers[H] * state[P, m]
    for j in range(problem.spring.size):
        motion.state[F, j] = 0.0
    tau = state[2, 0] if state.shape[0] == 3 else 0.0
    return begin(problem, row, friction, tau, motion, memory.box), tau


@kernel
def begins_held(problem, row, friction, state, motion, memory):
    """Whether no contact moves at the start."""
    determined, _ = _start(problem, row, friction, state, motion, memory)
    moving = 0
    for j in range(motion.sense.size):
        moving += abs(motion.sense[j])
    return determined and moving == 0


@kernel
def from_rest(problem, row, friction, state, motion, memory, record, what):
    """Follow a motion from its start to the section.

    Parameters
    ----------
    problem, row, friction : Problem, Row, Friction
    state : (2, m) modes and their velocities q' at tau = 0, or (3, m), at the phase state[2, 0]; elastic
        contacts begin without force
    motion, memory, record : Motion, Return, Record
    what : NOTHING or FORCES, what is recorded
    """
    record.active[0] = what
    determined, tau = _start(problem, row, friction, state, motion, memory)
    if determined:
        follow_to_section(problem, row, friction, tau, motion, memory.box, memory.counts, record)
    record.active[0] = NOTHING
    take_state(motion, memory.start, memory.senses, 1.0)
    forget_places(problem, memory.start)


@kernel
def raster(size, bits):
    """Distance of the values that coordinates of this size are rounded to."""
    return math.ldexp(1.0, math.frexp(size)[1] - bits) if size > 0.0 else 1.0


@kernel
def rounded(value, step):
    """The multiple of a power of two that is next to a value."""
    return step * math.floor(value / step + 0.5)


@kernel
def round_state(problem, row, friction, memory, bits):
    """Round the coordinates of the state in `memory.start` to `bits`; forces of contacts that slip are given.

    What is zero up to rounding errors becomes zero: displacements and velocities have one size, and forces
    that of a displacement of this size.  No force exceeds the friction, mu = 1.
    """
    size = 0.0
    for part in range(2):
        for i in range(memory.start.shape[1]):
            size = max(size, abs(memory.start[part, i]))
    step = raster(size, bits)
    for part in range(2):
        for i in range(memory.start.shape[1]):
            if part == P and i < problem.squares.size and moves_alone(problem, i):
                continue  # its velocity is that of its load, and no return corrects it
            memory.start[part, i] = rounded(memory.start[part, i], step)
    for j in range(memory.senses.size):
        if memory.senses[j] == 0 and has_force(problem, j):
            force = rounded(memory.start[F, j], raster(holding_stiffness(problem, j) * size, bits))
            limit = friction.kinetic[j] * normal_at_section(problem, row, j)
            memory.start[F, j] = min(max(force, -limit), limit)


@kernel
def take_end(memory):
    """Begin the next way where the last one ended."""
    copy_motion(memory.end, memory.end_senses, memory.start, memory.senses)


@kernel
def motion_size(problem, row, memory):
    """Size of the states, the unit of `return_distance`."""
    size = row.numbers[SIZE]
    for m in range(problem.push.shape[0]):
        for part in range(2):
            size = max(size, abs(memory.start[part, m]), abs(memory.end[part, m]))
    return size


@kernel
def largest_difference(row, senses, state, other):
    """Largest difference of two states with a pattern, in displacements and velocities of the modes."""
    off = 0.0
    for i in range(state.shape[1]):
        for part in range(2):
            off = max(off, abs(state[part, i] - other[part, i]))
    for j in range(senses.size):
        if senses[j] == 0:  # else its force is given
            off = max(off, row.yields[j] * abs(state[F, j] - other[F, j]))
    return off


@kernel
def is_motion(row, memory, state, senses):
    """Whether the state in `memory.start` is this one, with this pattern."""
    for j in range(senses.size):
        if memory.senses[j] != senses[j]:
            return False
    return largest_difference(row, senses, memory.start, state) == 0.0


@kernel
def return_distance(problem, row, memory):
    """Largest change of the state, over its size; infinite if the pattern changed."""
    for j in range(memory.senses.size):
        if memory.senses[j] != memory.end_senses[j]:
            return math.inf
    off = largest_difference(row, memory.senses, memory.end, memory.start)
    return off / motion_size(problem, row, memory)


@kernel
def _place_column(problem, row, motion, b):
    """Fill motion.watched with what a displacement of mode b moves in the contacts listed by `factor_held`.

    It is the motion with the least kinetic energy that displaces these contacts as much: its Gram matrix is
    their mobility.
    """
    modes, contacts = problem.push.shape[0], problem.spring.size
    right = motion.solve[contacts]
    for a in range(motion.held[contacts]):
        right[a] = problem.chi[motion.held[a], b]
    solve_held(motion, right)
    for m in range(modes):
        motion.watched[m] = 0.0
        for a in range(motion.held[contacts]):
            motion.watched[m] += row.reaction[motion.held[a], m] * right[a]


@kernel
def _tie_rigid(problem, memory):
    """Fill memory.tied with orthonormal rows that span the places of contacts at rest under rigid-body modes.

    Returns
    -------
    int : the number of rigid-body modes that move a contact at rest; the rows of the others are 0
    """
    modes, contacts = problem.push.shape[0], problem.spring.size
    count = 0
    for m in range(modes):
        whole = 0.0
        for j in range(contacts):
            moves = is_rigid(problem, m) and memory.counts[MOVED, j] == 0.0
            memory.tied[m, j] = problem.chi[j, m] if moves else 0.0
            whole += memory.tied[m, j] ** 2
        if whole == 0.0:
            continue
        count += 1
        _leave_out(memory, m, m)
        rest = 0.0
        for j in range(contacts):
            rest += memory.tied[m, j] ** 2
        scale = 1.0 / math.sqrt(rest) if rest > _DEPENDENT * whole else 0.0
        for j in range(contacts):
            memory.tied[m, j] *= scale
    return count


@kernel
def _leave_out(memory, at, rows):
    """Take the parts along the first rows of memory.tied from row `at`, twice against rounding errors."""
    contacts = memory.senses.size
    for _ in range(2):
        for m in range(rows):
            part = 0.0
            for j in range(contacts):
                part += memory.tied[m, j] * memory.tied[at, j]
            for j in range(contacts):
                memory.tied[at, j] -= part * memory.tied[m, j]


@late_kernel(None)
def _keep_free_places(problem, row, motion, memory, matrix, weight):
    """Add weight U L to the equations as `keep_places` does, where rigid-body modes move contacts at rest.

    L are those sums of places that no rigid-body mode changes: with L = P z and an orthogonal projector P,
    L U = P, and the equations without the rigid-body modes are regular.
    """
    modes, contacts = problem.push.shape[0], problem.spring.size
    left = memory.tied[modes]
    for b in range(2 * modes + contacts):
        elastic = b >= 2 * modes and keeps_force(problem, motion, b - 2 * modes)
        if not (elastic or (b < modes and not is_rigid(problem, b))):
            continue
        for j in range(contacts):
            left[j] = 0.0
            if b < modes and memory.counts[MOVED, j] == 0.0:
                left[j] = problem.chi[j, b]
        if elastic:
            left[b - 2 * modes] = -1.0 / holding_stiffness(problem, b - 2 * modes)
        _leave_out(memory, modes, modes)
        right = motion.solve[contacts]
        for a in range(motion.held[contacts]):
            right[a] = left[motion.held[a]]
        solve_held(motion, right)
        for m in range(modes):
            motion.watched[m] = 0.0
            for a in range(motion.held[contacts]):
                motion.watched[m] += row.reaction[motion.held[a], m] * right[a]
            matrix[m, b] += weight * motion.watched[m]
        for j in range(contacts):
            if keeps_force(problem, motion, j):
                rest = left[j]
                for m in range(modes):
                    rest -= problem.chi[j, m] * motion.watched[m]
                matrix[2 * modes + j, b] -= weight * holding_stiffness(problem, j) * rest


@late_kernel(None)
def _keep_coupled_places(problem, motion, memory, matrix, weight):
    """Add weight U L as `keep_places` does, of coupled contacts.

    L are the places y = g - F f of those at rest, or those sums of them that no rigid-body mode changes; U
    changes their forces alone, and so their places by F_RR.
    """
    modes, contacts = problem.push.shape[0], problem.spring.size
    left, right = memory.tied[modes], motion.grip[contacts]
    tied, count = _tie_rigid(problem, memory) > 0, motion.springs[contacts]
    for b in range(2 * modes + contacts):
        i = b - 2 * modes
        if b < modes:
            moves = not is_rigid(problem, b)  # else it moves none of them, or the sums leave it out
        else:
            moves = i >= 0 and memory.senses[i] == 0  # the force of a slip is given
        if not moves:
            continue
        for j in range(contacts):
            left[j] = 0.0
            if memory.counts[MOVED, j] == 0.0:
                left[j] = problem.chi[j, b] if i < 0 else -problem.coupling.flexibility[j, i]
        if tied:
            _leave_out(memory, modes, modes)
        for a in range(count):
            right[a] = left[motion.springs[a]]
        solve_springs(motion, right)
        for a in range(count):
            matrix[2 * modes + motion.springs[a], b] -= weight * right[a]


@kernel
def _fix(memory, i, size):
    """Leave coordinate i as it is in a Newton step."""
    for a in range(size):
        memory.matrix[i, a] = memory.matrix[a, i] = 0.0
    memory.matrix[i, i] = 1.0
    memory.right[i] = 0.0


@kernel
def fix_rigid(problem, memory):
    """Leave the places of rigid-body modes as they are, and velocities that only the load determines."""
    modes, size = problem.push.shape[0], state_size(problem)
    for m in range(modes):
        if is_rigid(problem, m):
            _fix(memory, m, size)
            if moves_alone(problem, m):
                _fix(memory, modes + m, size)


@kernel
def keep_places(problem, row, motion, memory, matrix, weight):
    """Add weight U L, with L U = 1: L are the places that the return map keeps, of contacts that rest.

    They are z of rigid contacts, and z - f/k of springs.  L J = L and L U = 1 leave every other multiplier of
    J - U L as it is, and make those of L zero; they leave L d = 0 for a Newton step d.  U displaces the rigid
    contacts at rest, without a change of the springs' L, and changes the springs' forces.

    Parameters
    ----------
    problem, row : Problem, Row
    motion : Motion; its pattern and the factors of its held contacts are replaced
    memory : Return
    matrix : (size, size)
    weight : 1.0 or -1.0
    """
    modes, contacts = problem.push.shape[0], problem.spring.size
    for j in range(contacts):
        motion.sense[j] = 1 if memory.counts[MOVED, j] != 0.0 else 0
    factor_independent(problem, row, motion, memory.box)  # as when all of them were held
    if is_coupled(problem):
        _keep_coupled_places(problem, motion, memory, matrix, weight)
        return
    if _tie_rigid(problem, memory) > 0:
        _keep_free_places(problem, row, motion, memory, matrix, weight)
        return
    for b in range(modes):
        _place_column(problem, row, motion, b)
        for m in range(modes):
            matrix[m, b] += weight * motion.watched[m]
        for j in range(contacts):
            if keeps_force(problem, motion, j):
                left = problem.chi[j, b]
                for m in range(modes):
                    left -= problem.chi[j, m] * motion.watched[m]
                matrix[2 * modes + j, b] -= weight * holding_stiffness(problem, j) * left
    for j in range(contacts):
        if keeps_force(problem, motion, j):
            matrix[2 * modes + j, 2 * modes + j] += weight


@kernel
def fill_newton(problem, row, halves, motion, memory):
    """Fill the linear equations of a Newton step; the derivatives are in `motion.tangent`.

    The pattern in `motion` is replaced.
    """
    modes = problem.push.shape[0]
    contacts = memory.senses.size
    size = state_size(problem)
    sign = -1.0 if halves % 2 == 1 else 1.0
    for a in range(size):
        for b in range(size):
            memory.matrix[a, b] = -sign * motion.tangent[a, b]
        memory.matrix[a, a] += 1.0
    for j in range(contacts):
        if size > 2 * modes and not has_force(problem, j):  # its force is no coordinate
            for a in range(size):
                memory.matrix[2 * modes + j, a] = 0.0
                memory.matrix[a, 2 * modes + j] = 0.0
            memory.matrix[2 * modes + j, 2 * modes + j] = 1.0
    if halves % 2 == 0:
        keep_places(problem, row, motion, memory, memory.matrix, 1.0)
    fill_right(problem, memory)
    fix_rigid(problem, memory)


@kernel
def fill_right(problem, memory):
    """Fill the right side of the equations of a Newton step: what a return changes."""
    modes = problem.push.shape[0]
    for m in range(modes):
        memory.right[m] = memory.end[Q, m] - memory.start[Q, m]
        memory.right[modes + m] = memory.end[P, m] - memory.start[P, m]
    for j in range(state_size(problem) - 2 * modes):
        memory.right[2 * modes + j] = memory.end[F, j] - memory.start[F, j]


@kernel
def keeps_factors(memory):
    """Whether derivatives may serve for several Newton steps."""
    return memory.rows.size > 0 and memory.kept[0] != NEVER_KEPT


@kernel
def has_factors(memory, halves):
    """Whether derivatives over these half periods are kept."""
    return keeps_factors(memory) and memory.kept[0] == halves


@kernel
def forget_factors(memory):
    """Begin with new derivatives, so that a result does not depend on what came before."""
    if memory.kept[0] != NEVER_KEPT:
        memory.kept[0] = NONE_KEPT


@kernel
def allow_factors(memory, allowed):
    """Decide whether derivatives may serve for several Newton steps; those that are kept stay."""
    if not allowed:
        memory.kept[0] = NEVER_KEPT
    elif memory.kept[0] == NEVER_KEPT:
        memory.kept[0] = NONE_KEPT


@kernel
def step_size(problem, row, memory):
    """Largest part of the solution in `memory.right`, over the size of the motion."""
    modes = problem.push.shape[0]
    step = 0.0
    for m in range(modes):
        step = max(step, abs(memory.right[m]), abs(memory.right[modes + m]))
    for j in range(memory.senses.size):
        if has_force(problem, j) and memory.senses[j] == 0:
            step = max(step, row.yields[j] * abs(memory.right[2 * modes + j]))
    return step / motion_size(problem, row, memory)


@kernel
def take_step(problem, row, memory):
    """Add the solution in `memory.right` to the state at the section; its largest part over the size."""
    modes = problem.push.shape[0]
    step = step_size(problem, row, memory)
    for m in range(modes):
        memory.start[Q, m] += memory.right[m]
        memory.start[P, m] += memory.right[modes + m]
    for j in range(memory.senses.size):
        if has_force(problem, j):
            memory.start[F, j] += memory.right[2 * modes + j]
    return step
