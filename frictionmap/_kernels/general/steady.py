"""The steady state of one cell: periods are followed until Newton's method finds the state that returns.

Where the start matters (mu > 1), a motion may take many periods to return, or never return: its averages are
then the result.
"""

import math
from typing import NamedTuple

from ..compiler import entry, kernel
from ..compiler.packed import packed
from ..long_periods import WINDOW, enough_cycles, first_search, next_search
from .approach import try_return
from .course import (
    Course,
    begin_course,
    follow_cycle,
    make_course,
    set_window,
    take_window,
    window_is_stationary,
    window_stops,
)
from .follow import FOLLOWED, STUCK, follow_to_section
from .orbits import AVERAGED, MEASURED, NO_REPEAT, REPEATS, Steady, largest_multiplier, newton
from .pattern import begin, stop_exactly
from .problem import SECTION, Row, Work, make_row, make_work, set_channels, set_row
from .record import FORCES, NOTHING, RANGES, STEPS, Record, clear_record, join_slips, make_record, mirror
from .return_map import (
    Return,
    base_halves,
    go_round,
    make_return,
    put_state,
    return_distance,
    steady_period,
    take_end,
    take_state,
)
from .returns import (
    Ring,
    go_back,
    go_back_cycles,
    keep,
    long_recurrence,
    make_ring,
    recurrence,
)
from .series import factor_held
from .single_mass import solve_single
from .single_tables import Single, fits_row, forget_row, make_single

#: Measurements until the error is below MEASURED.
_MOST_REPEATED = 2

#: Friction of a contact that is held, and attempts of Newton's method after which contacts are held.
WITHOUT_LIMIT = 1e200
_CREEPS = 6


class Tools(NamedTuple):
    """The memory that steady states are found in."""

    row: Row
    work: Work
    memory: Return
    ring: Ring
    record: Record
    single: Single
    course: Course


@entry
def make_tools(problem, masses, most):
    """Allocate the memory, for a record of `most` steps; `masses` (n, m): see `make_record`."""
    return Tools(
        make_row(problem), make_work(problem), make_return(problem), make_ring(problem),
        make_record(problem, masses, most), make_single(problem, masses.shape[0]),
        make_course(problem, masses),
    )  # fmt: skip


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
    """Whether half the range of the force of every contact held is within its friction (theory.md 11).

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
        go_back(memory, ring, 0)
        go_round(problem, row, friction, 2, work, memory, record, False)
        cycles += 1.0
        if _hold_some(problem, row, friction, share, work, memory, kept) == 0:
            continue
        status, more = newton(problem, row, friction, base, tolerance, work, memory, record)
        cycles += more
        if status == REPEATS and _can_rest(problem, row, friction, work, memory, record, kept):
            return True, cycles + 1.0
        _let_go(friction, kept)
        if status == REPEATS:
            status, more = newton(problem, row, friction, base, tolerance, work, memory, record)
            cycles += more
            if status == REPEATS:
                return True, cycles
    return False, cycles


@kernel
def _go_on(problem, row, friction, base, work, memory, ring, record):
    """Follow the motion from one return to the section to the next; return the code of `follow`.

    Parameters
    ----------
    problem, row, friction : Problem, Row, Friction
    base : half periods of the return map
    work, memory, ring, record : Work, Return, Ring, Record
    """
    code = go_round(problem, row, friction, base, work, memory, record, False)
    take_end(memory)
    keep(memory, ring)
    return code


@kernel
def _find_unique(problem, row, friction, cycles, tolerance, work, memory, ring, record):
    """Find the steady state where every motion reaches it; see `find`.

    Parameters
    ----------
    problem, row, friction, cycles, tolerance, work, memory, ring, record : see `find`
    """
    base = base_halves(problem)
    spent = 0.0
    wait = 0
    pause = 0
    while spent < cycles:
        if wait == 0:
            status, more = newton(problem, row, friction, base, tolerance, work, memory, record)
            spent += more
            if status == REPEATS:
                return Steady(REPEATS, base, spent)
            pause += 1
            wait = pause
            if pause in (_CREEPS, 2 * _CREEPS):
                settled, more = _by_holding(
                    problem, row, friction, base, tolerance, work, memory, ring, record
                )
                spent += more
                if settled:
                    return Steady(REPEATS, base, spent)
            go_back(memory, ring, 0)
        code = _go_on(problem, row, friction, base, work, memory, ring, record)
        spent += 0.5 * base
        if code != FOLLOWED:
            return Steady(1 + code, 0, spent)
        wait = max(wait - 1, 0)
    return Steady(NO_REPEAT, 0, spent)


@kernel
def _averages(followed, at_last, memory, record, course):
    """Take the averages of a motion as its result, if it stops, and they are stationary or it is the last
    occasion; return the half periods that they are of, else 0.
    """
    set_window(followed, course)
    if not window_stops(course):
        return 0
    if at_last or window_is_stationary(course):
        return take_window(course, memory.counts, record)
    return 0


@kernel
def _find_from_start(problem, row, friction, cycles, tolerance, work, memory, ring, record, course):
    """Find the steady state where it depends on the start; see `find`.

    The motion is compared with its last states at every return, and at times, ever more rarely, with those
    of up to 256 periods ago.

    Parameters
    ----------
    problem, row, friction, cycles, tolerance, work, memory, ring, record, course : see `find`
    """
    base = base_halves(problem)
    enough = enough_cycles(cycles)
    logged_from = 2 * int(min(enough, cycles) / 3.0)
    search = first_search()
    halves = 0  # followed, without those of Newton's method
    spent = 0.0
    wait = 0
    pause = 0
    while 0.5 * halves < cycles:
        tried = recurrence(row, memory, ring, base) if wait == 0 else 0
        due = halves >= search and halves % 2 == 0
        if due:
            search = next_search(halves)
            longer = long_recurrence(row, memory, ring, base)
            tried = longer if longer > 0 else tried
        if tried > 0:
            found = try_return(problem, row, friction, tried, tolerance, work, memory, ring, record)
            spent += found.cycles
            if found.status == REPEATS:
                return Steady(REPEATS, found.halves, spent + 0.5 * halves)
            pause += 1
            wait = pause
        if due and 0.5 * halves >= enough:
            averaged = _averages(halves // 2, 0.5 * halves >= 2.0 * enough, memory, record, course)
            if averaged > 0:
                return Steady(AVERAGED, averaged, 0.5 * halves)
        if halves == logged_from:
            begin_course(halves // 2, memory, record, course)
        if halves >= logged_from:
            code = follow_cycle(problem, row, friction, halves // 2, work, memory, ring, record, course)
            halves += 2
        else:
            code = _go_on(problem, row, friction, base, work, memory, ring, record)
            halves += base
        if code != FOLLOWED:
            return Steady(1 + code, 0, spent + 0.5 * halves)
        wait = max(wait - 1, 0)
    averaged = _averages(halves // 2, True, memory, record, course)
    return Steady(AVERAGED if averaged > 0 else NO_REPEAT, averaged, 0.5 * halves)


@kernel
def find(problem, row, friction, cycles, tolerance, work, memory, ring, record, course):
    """Find the steady state that the motion from `memory.start` reaches.

    Parameters
    ----------
    problem, row, friction : Problem, Row, Friction
    cycles : periods to follow at most
    tolerance : largest change of the state over a return, over its size
    work, memory, ring, record, course : Work, Return, Ring, Record, Course; `memory.start` is replaced by the
        steady state; where averages are found, they are in `memory.counts` and `record`

    Returns
    -------
    Steady
    """
    unique = True
    for j in range(memory.senses.size):
        unique = unique and friction.static[j] <= friction.kinetic[j]
    ring.count[0] = 0
    keep(memory, ring)
    if unique:
        return _find_unique(problem, row, friction, cycles, tolerance, work, memory, ring, record)
    return _find_from_start(problem, row, friction, cycles, tolerance, work, memory, ring, record, course)


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
        most = MEASURED
        if what != NOTHING:
            multiplier = largest_multiplier(problem, both, 0.0, work, memory)
            most *= min(1.0, abs(1.0 - multiplier))
        if return_distance(problem, row, memory) <= most or repeat == _MOST_REPEATED - 1:
            break
        newton(problem, row, friction, halves, MEASURED, work, memory, record)
    join_slips(record, both)
    if both % 2 == 1:
        mirror(record)
    return both, multiplier ** (steady_period(halves) * 2.0 / both)


@kernel
def begin_row(problem, i, tools):
    """Fill the constants of r[i]."""
    set_row(problem, i, tools.row)
    forget_row(tools.single)


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
    base = base_halves(problem)
    if friction.static[0] <= friction.kinetic[0] and fits_row(problem, row, tools.single, base):
        solved, spent, multiplier = solve_single(
            problem, row, tools.single, friction.kinetic[0], memory, record
        )
        if solved:
            return Steady(REPEATS, base, spent), base, multiplier
    found = find(problem, row, friction, cycles, tolerance, work, memory, tools.ring, record, tools.course)
    if found.status != REPEATS:
        return found, 0, math.nan
    halves, multiplier = measure(problem, row, friction, found.halves, work, memory, record, what)
    return found, halves, multiplier


@kernel
def from_rest(problem, row, friction, state, work, memory, record):
    """Follow a motion from its start to the section.

    Parameters
    ----------
    problem, row, friction : Problem, Row, Friction
    state : (2, m) modes and their velocities q' at tau = 0, or (3, m), at the phase state[2, 0]; elastic
        contacts begin without force
    work, memory, record : Work, Return, Record
    """
    for m in range(problem.push.shape[0]):
        work.state[0, m] = state[0, m]
        work.state[1, m] = row.numbers[0] * state[1, m]
    for j in range(problem.spring.size):
        work.state[2, j] = 0.0
    record.active[0] = NOTHING
    tau = state[2, 0] if state.shape[0] == 3 else 0.0
    if begin(problem, row, friction, tau, work, memory.law):
        follow_to_section(problem, row, friction, tau, work, memory.law, memory.counts, record)
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
    found = find(problem, row, friction, cycles, tolerance, work, memory, tools.ring, record, tools.course)
    halves, multiplier = 2, math.nan
    if found.status == REPEATS:
        halves, multiplier = measure(problem, row, friction, found.halves, work, memory, record, STEPS)
        return found, halves, multiplier
    if found.status == AVERAGED:  # the first phase shown is a maximum of the load, after the first section
        halves = 2 * (WINDOW + 1)
        go_back_cycles(problem, memory, tools.ring, WINDOW + 1)
    clear_record(record)
    record.active[0] = STEPS
    go_round(problem, row, friction, halves, work, memory, record, False)
    if found.status == AVERAGED:
        take_window(tools.course, memory.counts, record)
    return found, halves, multiplier


@entry
def one_steady_state(problem, i, friction, state, cycles, tolerance, masses, most):
    """Find the steady state of one cell, with the series of its steps.

    Parameters
    ----------
    problem, i : Problem, index of r
    friction : Friction
    state : see `from_rest`
    cycles, tolerance : see `find`
    masses : (n, m) displacement of the masses per mode
    most : number of steps that are kept

    Returns
    -------
    Steady, half periods that the steps cover (two if there is no steady state, WINDOW periods and one before
    them if there are averages), multiplier, counts (see `follow`), Record, h
    """
    tools = make_tools(problem, masses, most)
    found, halves, multiplier = _one(problem, i, friction, state, cycles, tolerance, tools)
    return found, halves, multiplier, tools.memory.counts, tools.record, tools.row.numbers[0]
