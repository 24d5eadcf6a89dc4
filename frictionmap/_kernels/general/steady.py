"""The steady state of one cell: periods are followed until Newton's method finds the state that returns."""

import math
from typing import NamedTuple

import numpy as np

from ..compiler import entry, kernel
from ..compiler.packed import packed
from ..structure.newton import solve_linear, spectral_radius
from .follow import BEFORE, FOLLOWED, STUCK, follow
from .pattern import begin, stop_exactly
from .problem import SECTION, Row, Work, make_row, make_work, padded, set_channels, set_row, state_size
from .record import FORCES, NOTHING, RANGES, STEPS, Record, clear_record, join_slips, make_record, mirror
from .return_map import (
    Return,
    fill_newton,
    go_round,
    make_return,
    motion_size,
    neutral_rows,
    put_state,
    return_distance,
    take_state,
    take_step,
)
from .series import factor_held
from .single_mass import solve_single
from .single_tables import Single, make_single, set_single

REPEATS, NO_REPEAT, CHATTERS, UNDETERMINED = 0, 1, 2, 3

#: States that are kept, one per return to the section: periods up to half as many are recognised.
RING = 33

#: Largest distance from an earlier state at which Newton's method is tried, where the start matters, and
#: largest distance of its result.
_NEAR = 1e-2
_SAME = 5e-2

#: Newton steps at most, and the largest part of the distance before that may be left after each.
_MOST_STEPS = 12
_LESS = 0.5

#: Largest step, over the size of the motion: beyond, the equations are singular (an undamped resonance).
_LARGEST = 1e10

#: A step below this is the last one: the next would be of the size of its square.  `measure` looks after it.
_LAST = 1e-7

#: A steady state that is back to this share of its size after a part of its period has that period.
_RETURNED = 1e-9

#: Largest error of a measured state, which is its distance from the one that it returns to, over the share
#: of a disturbance that a return takes away; and measurements until then.
_MEASURED = 1e-12
_MOST_REPEATED = 2

#: Friction of a contact that is held, and attempts of Newton's method after which contacts are held.
WITHOUT_LIMIT = 1e200
_CREEPS = 6

#: A multiplier above this is not that of a motion that attracts.
_STABLE = 1.0 + 1e-9
_STABLE_PRECISION = 0.01


class Ring(NamedTuple):
    """The last states at the section."""

    states: np.ndarray  # (RING, 3, ...)
    senses: np.ndarray  # (RING, N)
    count: np.ndarray  # (1,) states kept so far
    friction: np.ndarray  # (2, N) friction of contacts while they are held


class Tools(NamedTuple):
    """The memory that steady states are found in."""

    row: Row
    work: Work
    memory: Return
    ring: Ring
    record: Record
    single: Single


class Steady(NamedTuple):
    """The steady state of a cell."""

    status: int
    halves: int  # half periods after which it returns
    cycles: float  # periods followed


@entry
def make_ring(problem):
    """Allocate the kept states."""
    contacts, modes = problem.chi.shape
    return Ring(
        np.zeros((RING, 3, padded(max(modes, contacts)))), np.zeros((RING, contacts), np.int64),
        np.zeros(1, np.int64), np.zeros((2, contacts)),
    )  # fmt: skip


@entry
def make_tools(problem, masses, most):
    """Allocate the memory, for a record of `most` steps; `masses` (n, m): see `make_record`."""
    return Tools(
        make_row(problem), make_work(problem), make_return(problem), make_ring(problem),
        make_record(problem, masses, most), make_single(problem, masses.shape[0]),
    )  # fmt: skip


@kernel
def _keep(memory, ring):
    """Keep the state at the section."""
    slot = ring.count[0] % RING
    for part in range(3):
        for i in range(memory.start.shape[1]):
            ring.states[slot, part, i] = memory.start[part, i]
    for j in range(memory.senses.size):
        ring.senses[slot, j] = memory.senses[j]
    ring.count[0] += 1


@kernel
def _last_kept(memory, ring):
    """Go back to the last state kept."""
    slot = (ring.count[0] - 1) % RING
    for part in range(3):
        for i in range(memory.start.shape[1]):
            memory.start[part, i] = ring.states[slot, part, i]
    for j in range(memory.senses.size):
        memory.senses[j] = ring.senses[slot, j]


@kernel
def _distance_back(row, memory, ring, back):
    """Distance of the last state kept from the one `back` before it, over its size."""
    now, then = (ring.count[0] - 1) % RING, (ring.count[0] - 1 - back) % RING
    for j in range(memory.senses.size):
        if ring.senses[now, j] != ring.senses[then, j]:
            return math.inf
    off = 0.0
    size = row.numbers[2]
    for part in range(2):
        for i in range(memory.start.shape[1]):
            off = max(off, abs(ring.states[now, part, i] - ring.states[then, part, i]))
            size = max(size, abs(ring.states[now, part, i]))
    return off / size


@kernel
def _recurrence(row, memory, ring, base):
    """Number of half periods after which the motion is nearly back; 0 if it is not."""
    most = min(ring.count[0], RING) - 1
    for back in range(1, most + 1):
        if _distance_back(row, memory, ring, back) < _NEAR:
            return back * base
    return 0


@kernel
def _radius_of_two(matrix):
    """Largest modulus of the eigenvalues of a (2, 2) matrix."""
    mean = 0.5 * (matrix[0, 0] + matrix[1, 1])
    half = 0.5 * (matrix[0, 0] - matrix[1, 1])
    square = half * half + matrix[0, 1] * matrix[1, 0]
    if square >= 0.0:
        return abs(mean) + math.sqrt(square)
    return math.sqrt(mean * mean - square)


@kernel
def _multiplier(problem, halves, precision, work, memory):
    """Largest modulus of the multipliers, without those of contacts that rest; see `spectral_radius`."""
    size = state_size(problem)
    fill_newton(problem, halves, work, memory)
    if halves % 2 == 1:  # a place where a contact rests becomes its mirror image
        neutral_rows(problem, memory, memory.matrix, -1.0)
    for a in range(size):
        for b in range(size):
            memory.matrix[a, b] = (1.0 if a == b else 0.0) - memory.matrix[a, b]
    if size == 2:
        return _radius_of_two(memory.matrix)
    return spectral_radius(memory.matrix, size, work.tangent, precision)


@kernel
def _newton(problem, row, friction, halves, tolerance, work, memory, record):
    """Find the state that returns after some half periods, from the one in `memory.start`.

    Parameters
    ----------
    problem, row, friction : Problem, Row, Friction
    halves : number of half periods
    tolerance : largest change of the state over a return, over its size
    work, memory, record : Work, Return, Record

    Returns
    -------
    (status, cycles) : REPEATS or NO_REPEAT; periods followed
    """
    last = math.inf
    cycles = 0.0
    size = state_size(problem)
    for _ in range(_MOST_STEPS):
        code = go_round(problem, row, friction, halves, work, memory, record, True)
        cycles += 0.5 * halves
        if code != FOLLOWED:
            return NO_REPEAT, cycles
        distance = return_distance(problem, row, memory)
        if distance == 0.0:
            return REPEATS, cycles
        if not distance < _LESS * last:
            if distance <= tolerance:
                return REPEATS, cycles
            return NO_REPEAT, cycles
        last = distance
        fill_newton(problem, halves, work, memory)
        if not solve_linear(memory.matrix, memory.right, size):
            return NO_REPEAT, cycles
        step = take_step(problem, row, memory)
        if not step <= _LARGEST:
            return NO_REPEAT, cycles
        if step <= max(tolerance, _LAST):
            return REPEATS, cycles
    return NO_REPEAT, cycles


@kernel
def _least_period(problem, row, friction, halves, base, work, memory, record):
    """Smallest number of half periods after which a steady state returns, and the periods followed for it.

    Parameters
    ----------
    problem, row, friction : Problem, Row, Friction
    halves : half periods after which it returns
    base : smallest number that is possible
    work, memory, record : Work, Return, Record
    """
    cycles = 0.0
    for shorter in range(base, halves, base):
        if halves % shorter == 0:
            go_round(problem, row, friction, shorter, work, memory, record, False)
            cycles += 0.5 * shorter
            if return_distance(problem, row, memory) <= _RETURNED:
                return shorter, cycles
    return halves, cycles


@kernel
def _far(problem, row, memory, ring):
    """Distance of the state found from the last state kept, over its size."""
    slot = (ring.count[0] - 1) % RING
    off = 0.0
    for part in range(2):
        for i in range(problem.push.shape[0]):
            off = max(off, abs(ring.states[slot, part, i] - memory.start[part, i]))
    return off / motion_size(problem, row, memory)


@kernel
def _attracts(problem, row, halves, work, memory, ring):
    """Whether the steady state found is stable, and the one that the motion goes to.

    Parameters
    ----------
    problem, row : Problem, Row
    halves : half periods after which it returns
    work, memory, ring : Work, Return, Ring
    """
    if _multiplier(problem, halves, _STABLE_PRECISION, work, memory) > _STABLE:
        return False
    return _far(problem, row, memory, ring) <= _SAME


@kernel
def _hold_some(problem, row, friction, share, work, memory, kept):
    """Hold the contacts that were stuck for more than a share of the last way; how many.

    Parameters
    ----------
    problem, row, friction : Problem, Row, Friction
    share : of the time followed
    work, memory : Work, Return; `memory.start` is changed
    kept : (2, N) filled with the friction before
    """
    whole = 0.0
    for j in range(memory.senses.size):
        whole = max(whole, memory.counts[STUCK, j])
    put_state(memory.start, memory.senses, work)
    count = 0
    for j in range(memory.senses.size):
        kept[0, j], kept[1, j] = friction.kinetic[j], friction.static[j]
        if whole > 0.0 and memory.counts[STUCK, j] > share * whole:
            friction.kinetic[j] = friction.static[j] = WITHOUT_LIMIT
            work.sense[j] = 0
            count += 1
    if count > 0:
        work.clock[0] = math.nan
        set_channels(problem, row, SECTION, 0, work)
        if not factor_held(problem, row, work):
            return 0
        stop_exactly(problem, row, work)
        take_state(work, memory.start, memory.senses, 1.0)
    return count


@kernel
def _let_go(friction, kept):
    """Give the contacts the friction back that they had."""
    for j in range(friction.kinetic.size):
        friction.kinetic[j], friction.static[j] = kept[0, j], kept[1, j]


@kernel
def _can_rest(problem, row, friction, work, memory, record, kept):
    """Whether half the range of the force of every contact held is within its friction (contacts.md 2).

    Parameters
    ----------
    problem, row, friction : Problem, Row, Friction, with contacts held
    work, memory, record : Work, Return, Record
    kept : (2, N) the friction of the contacts
    """
    clear_record(record)
    record.active[0] = FORCES
    go_round(problem, row, friction, 2, work, memory, record, False)
    record.active[0] = NOTHING
    for j in range(memory.senses.size):
        if friction.kinetic[j] == WITHOUT_LIMIT:
            for d in range(problem.push.shape[1]):
                if problem.normal[j, d] != 0.0:
                    return False
            if 0.5 * (record.forces[1, j] - record.forces[0, j]) > kept[0, j]:
                return False
    return True


@kernel
def _by_holding(problem, row, friction, base, tolerance, work, memory, ring, record):
    """Find the steady state of contacts that creep: held, they rest, or show where to begin.

    A contact whose load hardly exceeds its limit slides ever less each cycle, and no motion gets to the end
    of that.  Where it rests, `friction` is such that it does; its place depends on the start.

    Parameters
    ----------
    problem, row, friction : Problem, Row, Friction
    base : half periods of the return map
    tolerance : see `find`
    work, memory, ring, record : Work, Return, Ring, Record

    Returns
    -------
    (found, cycles) : whether the state in `memory.start` is the steady state; periods followed
    """
    kept = ring.friction
    cycles = 0.0
    for share in (0.98, 0.5):
        _last_kept(memory, ring)
        go_round(problem, row, friction, 2, work, memory, record, False)
        cycles += 1.0
        if _hold_some(problem, row, friction, share, work, memory, kept) == 0:
            continue
        status, more = _newton(problem, row, friction, base, tolerance, work, memory, record)
        cycles += more
        if status == REPEATS and _can_rest(problem, row, friction, work, memory, record, kept):
            return True, cycles + 1.0
        _let_go(friction, kept)
        if status == REPEATS:
            status, more = _newton(problem, row, friction, base, tolerance, work, memory, record)
            cycles += more
            if status == REPEATS:
                return True, cycles
    return False, cycles


@kernel
def find(problem, row, friction, cycles, tolerance, work, memory, ring, record):
    """Find the steady state that the motion from `memory.start` reaches.

    Parameters
    ----------
    problem, row, friction : Problem, Row, Friction
    cycles : periods to follow at most
    tolerance : largest change of the state over a return, over its size
    work, memory, ring, record : Work, Return, Ring, Record; `memory.start` is replaced by the steady state

    Returns
    -------
    Steady
    """
    base = 1 if problem.symmetric else 2
    unique = True
    for j in range(memory.senses.size):
        unique = unique and friction.static[j] <= friction.kinetic[j]
    ring.count[0] = 0
    _keep(memory, ring)
    spent = 0.0
    wait = 0
    pause = 0
    while spent < cycles:
        halves = 0
        if wait == 0:
            halves = base if unique else _recurrence(row, memory, ring, base)
        if halves > 0:
            status, more = _newton(problem, row, friction, halves, tolerance, work, memory, record)
            spent += more
            if status == REPEATS and (unique or _attracts(problem, row, halves, work, memory, ring)):
                least, more = _least_period(problem, row, friction, halves, base, work, memory, record)
                return Steady(REPEATS, least, spent + more)
            pause += 1
            wait = pause
            if unique and pause in (_CREEPS, 2 * _CREEPS):
                settled, more = _by_holding(
                    problem, row, friction, base, tolerance, work, memory, ring, record
                )
                spent += more
                if settled:
                    return Steady(REPEATS, base, spent)
            _last_kept(memory, ring)
        code = go_round(problem, row, friction, base, work, memory, record, False)
        spent += 0.5 * base
        if code != FOLLOWED:
            return Steady(1 + code, 0, spent)
        for part in range(3):
            for i in range(memory.start.shape[1]):
                memory.start[part, i] = memory.end[part, i]
        for j in range(memory.senses.size):
            memory.senses[j] = memory.end_senses[j]
        _keep(memory, ring)
        wait = max(wait - 1, 0)
    return Steady(NO_REPEAT, 0, spent)


@kernel
def steady_period(halves):
    """Periods of the load after which a motion repeats that returns, mirrored if odd, after half periods."""
    return halves if halves % 2 == 1 else halves // 2


@kernel
def measure(problem, row, friction, halves, work, memory, record, what):
    """Follow the steady state once more, into `record` and `memory.counts`.

    Where it does not quite return, it is solved once more.

    Parameters
    ----------
    problem, row, friction : Problem, Row, Friction
    halves : half periods after which it returns
    work, memory, record : Work, Return, Record
    what : NOTHING, RANGES, STEPS or FORCES, what is kept; STEPS and FORCES are kept of whole periods

    Returns
    -------
    (followed, multiplier) : half periods followed, and the largest modulus of the multipliers over the steady
        period, NaN where NOTHING is kept
    """
    both = halves if halves % 2 == 0 or what == NOTHING or what == RANGES else 2 * halves
    multiplier = math.nan
    for repeat in range(_MOST_REPEATED):
        clear_record(record)
        record.active[0] = what
        go_round(problem, row, friction, both, work, memory, record, what != NOTHING)
        record.active[0] = NOTHING
        most = _MEASURED
        if what != NOTHING:
            multiplier = _multiplier(problem, both, 0.0, work, memory)
            most *= min(1.0, abs(1.0 - multiplier))
        if return_distance(problem, row, memory) <= most or repeat == _MOST_REPEATED - 1:
            break
        _newton(problem, row, friction, halves, _MEASURED, work, memory, record)
    join_slips(record, both)
    if both % 2 == 1:
        mirror(record)
    return both, multiplier ** (steady_period(halves) * 2.0 / both)


@kernel
def begin_row(problem, i, tools):
    """Fill the constants of r[i], and the tables of one mass where they apply."""
    set_row(problem, i, tools.row)
    set_single(problem, tools.row, tools.single, 1 if problem.symmetric else 2)


@kernel
def solve(problem, friction, cycles, tolerance, tools, what):
    """Find and measure the steady state of a cell, from the state in `tools.memory.start`.

    Parameters
    ----------
    problem, friction : Problem, Friction
    cycles, tolerance : see `find`
    tools : Tools after `begin_row`
    what : NOTHING or RANGES, see `measure`

    Returns
    -------
    Steady, half periods measured, multiplier
    """
    row, work, memory, record = tools.row, tools.work, tools.memory, tools.record
    if tools.single.fits[0] != 0 and friction.static[0] <= friction.kinetic[0]:
        solved, spent, multiplier = solve_single(
            problem, row, tools.single, friction.kinetic[0], memory, record
        )
        if solved:
            halves = 1 if problem.symmetric else 2
            return Steady(REPEATS, halves, spent), halves, multiplier
    found = find(problem, row, friction, cycles, tolerance, work, memory, tools.ring, record)
    if found.status != REPEATS:
        return found, 0, math.nan
    halves, multiplier = measure(problem, row, friction, found.halves, work, memory, record, what)
    return found, halves, multiplier


@kernel
def from_rest(problem, row, friction, state, work, memory, record):
    """Follow a motion from tau = 0 to the section.

    Parameters
    ----------
    problem, row, friction : Problem, Row, Friction
    state : (2, m) modes and their velocities q' at tau = 0; elastic contacts begin without force
    work, memory, record : Work, Return, Record
    """
    for m in range(problem.push.shape[0]):
        work.state[0, m] = state[0, m]
        work.state[1, m] = row.numbers[0] * state[1, m]
    for j in range(problem.spring.size):
        work.state[2, j] = 0.0
    record.active[0] = NOTHING
    if begin(problem, row, friction, 0.0, work, memory.law):
        follow(problem, row, friction, BEFORE, work, memory.law, memory.counts, record, False)
    take_state(work, memory.start, memory.senses, 1.0)


@kernel
def _one(problem, i, friction, state, cycles, tolerance, tools):
    """Find the steady state of one cell, and record it.

    Parameters
    ----------
    problem, i, friction, state, cycles, tolerance : see `one_steady_state`
    tools : Tools

    Returns
    -------
    Steady, half periods, multiplier
    """
    problem, friction, tools = packed(problem), packed(friction), packed(tools)
    row, work, memory, record = tools.row, tools.work, tools.memory, tools.record
    set_row(problem, i, row)
    from_rest(problem, row, friction, state, work, memory, record)
    found = find(problem, row, friction, cycles, tolerance, work, memory, tools.ring, record)
    halves, multiplier = 2, math.nan
    if found.status == REPEATS:
        halves, multiplier = measure(problem, row, friction, found.halves, work, memory, record, STEPS)
    else:
        record.active[0] = STEPS
        go_round(problem, row, friction, halves, work, memory, record, False)
    return found, halves, multiplier


@entry
def one_steady_state(problem, i, friction, state, cycles, tolerance, masses, most):
    """Find the steady state of one cell, with the series of its steps.

    Parameters
    ----------
    problem, i : Problem, index of r
    friction : Friction
    state : (2, m) modes and their velocities q' at tau = 0
    cycles, tolerance : see `find`
    masses : (n, m) displacement of the masses per mode
    most : number of steps that are kept

    Returns
    -------
    Steady, half periods that the steps cover (two if there is no steady state), multiplier, counts (see
    `follow`), Record, h
    """
    tools = make_tools(problem, masses, most)
    found, halves, multiplier = _one(problem, i, friction, state, cycles, tolerance, tools)
    return found, halves, multiplier, tools.memory.counts, tools.record, tools.row.numbers[0]
