"""The steady state of one cell: periods are followed until Newton's method finds the state that returns.

Where the start matters (mu > 1), a motion may take many periods to return, or never return: its averages are
then the result.
"""

import math
from typing import NamedTuple

import numpy as np

from ..compiler import entry, kernel, late_kernel
from ..long_periods import WINDOW, enough_cycles, first_search, next_search
from .approach import STABLE, STABLE_PRECISION, try_return
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
from .creep import end_creep, find_crept, find_held, find_rest, keep_friction, restore_friction
from .follow import FOLLOWED
from .laws.speed import has_law, is_certified, rate_under
from .orbits import (
    AVERAGED,
    CHATTERS,
    MEASURED,
    NEARBY,
    NO_REPEAT,
    REPEATS,
    RETURNED,
    Steady,
    any_drifts,
    any_rests,
    improve_by_part,
    kept_error,
    largest_multiplier,
    newton,
    newton_kept,
)
from .parts import has_parts
from .places import (
    Places,
    fill_flexibility,
    find_rests,
    hold_orbit,
    keep_orbit,
    keep_orbit_anew,
    make_places,
    settle_places,
    stop_contacts,
)
from .problem import Motion, Row, is_free
from .record import (
    NOTHING,
    RANGES,
    RANGES_ALONE,
    STEPS,
    Record,
    clear_record,
    join_slips,
    keep_drift,
    make_record,
    mirror,
)
from .recurrence import (
    Ring,
    find_long_recurrence,
    find_recurrence,
    go_back,
    go_back_cycles,
    keep,
    make_ring,
    take_orbit,
)
from .return_map import (
    BITS,
    NONE_KEPT,
    Return,
    allow_factors,
    base_halves,
    copy_motion,
    forget_factors,
    from_rest,
    go_round,
    has_factors,
    is_motion,
    keeps_factors,
    make_return,
    return_distance,
    round_state,
    steady_period,
    take_end,
    unique_halves,
)
from .row import intervals_of, make_motion, make_row, set_row, set_row_with
from .single_mass import solve_single
from .single_tables import Single, fits_row, forget_row, make_single

#: Measurements until the error is below MEASURED; and all, until the state returns and no contact drifts.
_MOST_REPEATED = 2
_MOST_MEASURED = 10

#: Where contacts at rest are: anywhere; at the place 0 (for mu = 1); where the motion leads from its
#: start.  In the last two cases the bits of a steady state do not depend on the way to it (for mu = 1).
ANYWHERE, AT_ZERO, LED = 0, 1, 2

#: Attempts to find a steady state from the one that it is rounded to.
_MOST_ROUNDED = 3

#: Returns of many contacts that are followed before Newton's method is tried: they take less time than one
#: with its derivatives, and bring the events into their order.
_FIRST_WAIT = 8

#: Attempts of Newton's method after which contacts that creep are held.
_CREEPS = 6

#: Periods within which it is known, where the start matters, that contacts creep to where they rest, or not:
#: a few times those that decide it, see `places`.
_CREEP_CYCLES = 64.0


class Workspace(NamedTuple):
    """The memory that steady states are found in."""

    row: Row
    motion: Motion
    memory: Return
    ring: Ring
    record: Record
    single: Single
    course: Course
    places: Places
    needs: np.ndarray  # (N,) static friction with which no contact slips from the start on


@entry
def make_workspace(problem, masses, most):
    """Allocate the memory, for a record of `most` steps; `masses` (n, m): see `make_record`."""
    return Workspace(
        make_row(problem), make_motion(problem), make_return(problem), make_ring(problem),
        make_record(problem, masses, most), make_single(problem, masses.shape[0]),
        make_course(problem, masses), make_places(problem), np.zeros(problem.spring.size),
    )  # fmt: skip


@kernel
def _go_on(problem, friction, halves, workspace):
    """Follow the motion from one return to the section to the next; return the code of `follow`."""
    memory = workspace.memory
    code = go_round(
        problem, workspace.row, friction, halves, workspace.motion, memory, workspace.record, False
    )
    take_end(memory)
    keep(memory, workspace.ring)
    return code


@kernel
def _go_first(problem, friction, halves, workspace):
    """Follow a motion of many contacts before Newton's method is tried; the periods followed, 0 where the
    motion could not be: it is as before then.
    """
    memory, ring = workspace.memory, workspace.ring
    if not keeps_factors(memory) or memory.kept[0] != NONE_KEPT:
        return 0.0
    copy_motion(memory.start, memory.senses, ring.orbit, ring.orbit_senses)
    for _ in range(_FIRST_WAIT):
        if _go_on(problem, friction, halves, workspace) != FOLLOWED:
            take_orbit(memory, ring)
            return 0.0
    return 0.5 * halves * _FIRST_WAIT


@late_kernel(Steady)
def _find_unique(problem, friction, cycles, tolerance, workspace):
    """Find the steady state where every motion reaches it; see `find`."""
    memory, ring, base = workspace.memory, workspace.ring, unique_halves(problem)
    spent = _go_first(problem, friction, base, workspace)
    wait = 0
    pause = 0
    while pause == 0 or spent < cycles:
        if wait == 0:
            status, more = find_rest(problem, friction, base, tolerance, workspace)
            spent += more
            pause += 1
            wait = pause
            if status != REPEATS and pause in (_CREEPS, 2 * _CREEPS):
                status, more = find_held(problem, friction, base, tolerance, workspace)
                spent += more
            if status == REPEATS:
                end_creep(problem, friction, memory, workspace.record, ring)
                return Steady(REPEATS, base, spent)
            go_back(memory, ring, 0)
        code = _go_on(problem, friction, base, workspace)
        spent += 0.5 * base
        if code != FOLLOWED:
            return Steady(1 + code, 0, spent)
        wait = max(wait - 1, 0)
    return Steady(NO_REPEAT, 0, spent)


@late_kernel(int)
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


@late_kernel((int, float))
def _creep_to_rest(problem, friction, tolerance, workspace):
    """Find the steady state that a motion goes to, ever more slowly, in which some contacts creep.

    With these held it has a steady state that attracts.  The motion must go to a place of rest in it.

    Returns
    -------
    (status, cycles) : REPEATS, with a friction without limit of the contacts at rest, or NO_REPEAT, with the
        motion as before; periods followed
    """
    row, motion, memory = workspace.row, workspace.motion, workspace.memory
    places, ring = workspace.places, workspace.ring
    status, cycles = find_crept(problem, friction, tolerance, workspace)
    if status == REPEATS:
        contraction = largest_multiplier(problem, row, 2, STABLE_PRECISION, motion, memory)
        rests = find_rests(problem, memory, 2, places)  # without one, no motion is compared with the state
        restore_friction(friction, ring.friction)
        fill_flexibility(problem, places)
        if rests > 0 and contraction <= STABLE and keep_orbit(problem, friction, 2, workspace):
            go_back(memory, ring, 0)
            known, more = settle_places(problem, friction, 2, _CREEP_CYCLES, workspace)
            cycles += more
            if known:
                return REPEATS, cycles
        restore_friction(friction, ring.friction)
    go_back(memory, ring, 0)
    return NO_REPEAT, cycles


@late_kernel(Steady)
def _find_from_start(problem, friction, cycles, tolerance, workspace):
    """Find the steady state where it depends on the start; see `find`.

    The motion is compared with its last states at every return, and at times, ever more rarely, with those
    of up to 256 periods ago.
    """
    row, memory, ring = workspace.row, workspace.memory, workspace.ring
    record, course, base = workspace.record, workspace.course, base_halves(problem)
    enough = enough_cycles(cycles)
    logged_from = 2 * int(min(enough, cycles) / 3.0)
    search = first_search()
    halves = 0  # followed, without those of Newton's method
    spent = 0.0
    wait = 0
    pause = 0
    while 0.5 * halves < cycles:
        tried = find_recurrence(row, memory, ring, base) if wait == 0 else 0
        due = halves >= search and halves % 2 == 0
        if due:
            search = next_search(halves)
            longer = find_long_recurrence(row, memory, ring, base)
            tried = longer if longer > 0 else tried
        # half a period later, the section has the mirror image of the motion
        if tried > 0 and (halves % 2 == 0 or (tried % 2 == 1 and not any_rests(memory.counts))):
            found = try_return(problem, friction, tried, tolerance, workspace)
            spent += found.cycles
            if found.status == REPEATS:
                if halves % 2 == 0 or not any_rests(memory.counts):
                    return Steady(REPEATS, found.halves, spent + 0.5 * halves)
                restore_friction(friction, ring.friction)  # what rests was at its mirror image
                go_back(memory, ring, 0)
            else:
                pause += 1
                wait = pause
        if due and not is_free(problem):
            status, more = _creep_to_rest(problem, friction, tolerance, workspace)
            spent += more
            if status == REPEATS:
                return Steady(REPEATS, 2, spent + 0.5 * halves)
        if due and 0.5 * halves >= enough:
            averaged = _averages(halves // 2, 0.5 * halves >= 2.0 * enough, memory, record, course)
            if averaged > 0:
                return Steady(AVERAGED, averaged, 0.5 * halves)
        if halves == logged_from:
            begin_course(halves // 2, memory, record, course)
        if halves >= logged_from:
            code = follow_cycle(problem, friction, halves // 2, workspace)
            halves += 2
        else:
            code = _go_on(problem, friction, base, workspace)
            halves += base
        if code != FOLLOWED:
            return Steady(1 + code, 0, spent + 0.5 * halves)
        wait = max(wait - 1, 0)
    averaged = _averages(halves // 2, True, memory, record, course)
    return Steady(AVERAGED if averaged > 0 else NO_REPEAT, averaged, 0.5 * halves)


@kernel
def find(problem, friction, cycles, tolerance, workspace):
    """Find the steady state that the motion from `workspace.memory.start` reaches.

    Parameters
    ----------
    problem, friction : Problem, Friction
    cycles : periods to follow at most
    tolerance : largest change of the state over a return, over its size
    workspace : Workspace after `begin_row`; `memory.start` is replaced by the steady state; where averages
        are found, they are in `memory.counts` and `record`

    Returns
    -------
    Steady
    """
    workspace.ring.count[0] = 0
    keep(workspace.memory, workspace.ring)
    if is_unique(problem, friction):
        return _find_unique(problem, friction, cycles, tolerance, workspace)
    return _find_from_start(problem, friction, cycles, tolerance, workspace)


@kernel
def _refine(problem, friction, halves, count, workspace):
    """Bring the state in `memory.start` nearer to the one that returns.

    That is done by Newton's method; where a contact at the edge of its limits misleads it, by the motion.

    Parameters
    ----------
    problem, friction, halves, workspace : see `measure`
    count : returns that the motion is followed for
    """
    row, motion, memory, record = workspace.row, workspace.motion, workspace.memory, workspace.record
    status, _ = find_rest(problem, friction, halves, MEASURED, workspace)
    if status != REPEATS:
        for _ in range(count):
            if go_round(problem, row, friction, halves, motion, memory, record, False) == FOLLOWED:
                take_end(memory)


@kernel
def measure(problem, friction, halves, workspace, what):
    """Follow the steady state in `memory.start` once more, into `record` and `memory.counts`.

    Where it does not quite return, or a contact only touches its limits, it is solved once more.

    Parameters
    ----------
    problem, friction : Problem, Friction
    halves : half periods after which it returns
    workspace : Workspace
    what : NOTHING, RANGES, RANGES_ALONE, STEPS or FORCES, what is kept; STEPS and FORCES of whole periods

    Returns
    -------
    (followed, multiplier) : half periods followed, 0 where the motion could not be; the largest modulus of
        the multipliers over the steady period, NaN where NOTHING is kept, or the error of the state follows
        from parts of half a period, or from derivatives that were kept
    """
    row, motion, memory, record = workspace.row, workspace.motion, workspace.memory, workspace.record
    alone = what == RANGES_ALONE
    what = RANGES if alone else what
    both = halves if halves % 2 == 0 or what == NOTHING or what == RANGES else 2 * halves
    root = has_parts(problem, both) and what != NOTHING
    multiplier = math.nan
    found = False
    for count in range(1, _MOST_MEASURED + 1):
        alone = alone and not root and has_factors(memory, both)
        derives = what != NOTHING and not root and not alone
        off = improve_by_part(problem, row, friction, motion, memory, record) if root else 0.0
        clear_record(record)
        record.active[0] = what
        code = go_round(problem, row, friction, both, motion, memory, record, derives)
        record.active[0] = NOTHING
        if code != FOLLOWED:
            return 0, math.nan
        if root and any_rests(memory.counts):
            root = False
            continue
        most = MEASURED
        if alone:
            off = kept_error(problem, row, both, memory)
            if off != off:
                alone = False
                continue
        elif derives:
            multiplier = largest_multiplier(problem, row, both, 0.0, motion, memory)
            most *= min(1.0, abs(1.0 - multiplier))
        enough = most if count < _MOST_REPEATED else max(most, RETURNED)
        returns = max(return_distance(problem, row, memory), off) <= enough
        found = returns and not any_drifts(problem, memory.counts, both)
        if found:
            break
        _refine(problem, friction, halves, count, workspace)
    if not found:
        return 0, math.nan
    join_slips(record, both)
    keep_drift(problem, memory.way, both, record)
    if both % 2 == 1:
        mirror(record)
    return both, multiplier ** (steady_period(halves) * 2.0 / both)


@kernel
def begin_row(problem, i, workspace):
    """Fill the constants of r[i]."""
    set_row(problem, i, workspace.row)
    forget_row(workspace.single)
    forget_factors(workspace.memory)


@kernel
def fit_row(problem, i, friction, workspace):
    """Divide the period at r[i] as the friction of a cell wants it, whatever other cells there are; whether
    the units of states change.
    """
    intervals = intervals_of(rate_under(problem, i, friction))
    changes = intervals != workspace.row.intervals[0]
    if changes:
        set_row_with(problem, i, intervals, workspace.row)
    return changes


@kernel
def is_unique(problem, friction):
    """Whether the velocities of the steady state do not depend on the start: mu = 1 in all contacts, and
    friction does not depend on the speed, or damping outweighs its fall.
    """
    unique = is_certified(problem, friction)
    for j in range(friction.static.size):
        unique = unique and friction.static[j] <= friction.kinetic[j]
    return unique


@kernel
def _is_rounded_to(problem, row, friction, bits, memory, places):
    """Whether the state in `memory.start` is rounded to the one in `places.orbit`; else it is rounded, and
    stays in `memory.end` as it was.
    """
    copy_motion(memory.start, memory.senses, memory.end, memory.end_senses)
    round_state(problem, row, friction, memory, bits)
    same = is_motion(row, memory, places.orbit, places.senses)
    if same:
        take_end(memory)
    return same


@late_kernel((bool, float))
def find_from_rounded(problem, friction, tolerance, bits, workspace):
    """Find the steady state near the one in `memory.start` from the state that it is itself rounded to.

    The first steps show what it is rounded to, unless it is next to the edge of that.

    Parameters
    ----------
    problem, friction, tolerance, workspace : see `find`; if it is not found, `memory.start` is another state
    bits : see `round_state`

    Returns
    -------
    (found, cycles) : whether it was found; periods followed
    """
    row, motion, memory, places = workspace.row, workspace.motion, workspace.memory, workspace.places
    halves, spent, goal, rounded = unique_halves(problem), 0.0, NEARBY, False
    round_state(problem, row, friction, memory, bits)
    for _ in range(_MOST_ROUNDED):
        copy_motion(memory.start, memory.senses, places.orbit, places.senses)
        forget_factors(memory)
        if not stop_contacts(problem, row, motion, memory):
            return False, spent
        for last in (goal, tolerance):
            status, cycles = newton(problem, row, friction, halves, last, motion, memory, workspace.record)
            spent += cycles
            if status != REPEATS:
                return False, spent
            rounded = _is_rounded_to(problem, row, friction, bits, memory, places)
            if last == tolerance or not rounded:
                break
        if rounded:
            return True, spent
        goal = tolerance
    take_end(memory)
    return True, spent


@kernel
def _find_anew(problem, friction, tolerance, workspace, by_tables, attempts):
    """Find the steady state near the one in `memory.start`, with bits that do not depend on the way to it.

    Parameters
    ----------
    problem, friction, tolerance, workspace : see `find`
    by_tables : whether the tables of one mass can be used
    attempts : how many of BITS are tried beside them

    Returns
    -------
    (found, cycles, multiplier) : whether it was found, else `memory.start` is as before; periods followed; of
        a state that the tables measured, see `solve_single`, else NaN
    """
    row, memory, ring, spent = workspace.row, workspace.memory, workspace.ring, 0.0
    copy_motion(memory.start, memory.senses, ring.orbit, ring.orbit_senses)
    if by_tables:
        found, spent, multiplier = solve_single(
            problem, row, workspace.single, friction.kinetic[0], memory, workspace.record, BITS[0]
        )
        if found:
            return True, spent, multiplier
        take_orbit(memory, ring)
    for attempt in range(attempts):
        found, cycles = find_from_rounded(problem, friction, tolerance, BITS[attempt], workspace)
        spent += cycles
        if found:
            return True, spent, math.nan
        take_orbit(memory, ring)
    return False, spent, math.nan


@late_kernel(Steady)
def _settle(problem, friction, state, found, cycles, tolerance, workspace, settled):
    """Give the contacts at rest the places to which the motion leads from its start.

    Parameters
    ----------
    problem, friction : Problem, Friction
    state : (2, m) modes and their velocities q' at tau = 0
    found : Steady, the one in `workspace.memory.start`
    cycles, tolerance : see `find`
    workspace : Workspace after `find_rests`
    settled : AT_ZERO or LED, see `solve_from`

    Returns
    -------
    Steady
    """
    row, motion, memory, record = workspace.row, workspace.motion, workspace.memory, workspace.record
    places, ring = workspace.places, workspace.ring
    halves = found.halves if found.halves % 2 == 0 else 2 * found.halves
    if not is_unique(problem, friction):  # the motion is near the steady state, and stays if not moved
        fill_flexibility(problem, places)
        if not keep_orbit(problem, friction, halves, workspace):
            take_orbit(memory, ring)
            return found
        go_back(memory, ring, 0)
        _, more = settle_places(problem, friction, halves, cycles, workspace)
        return Steady(REPEATS, halves, found.cycles + more)
    kept, spent = False, found.cycles
    for bits in BITS:
        if not kept:
            take_orbit(memory, ring)
            kept, more = keep_orbit_anew(problem, friction, halves, tolerance, bits, workspace)
            spent += more
    if not kept:  # rounding takes away what hardly moves
        take_orbit(memory, ring)
        kept = keep_orbit(problem, friction, halves, workspace)
    if not kept:
        return Steady(NO_REPEAT, 0, spent)
    if settled == AT_ZERO:
        hold_orbit(friction, memory, places)
        return Steady(REPEATS, halves, spent)
    from_rest(problem, row, friction, state, motion, memory, record, NOTHING)
    known, more = settle_places(problem, friction, halves, cycles, workspace)
    return Steady(REPEATS if known else NO_REPEAT, halves, spent + more)


@kernel
def _locate(problem, friction, cycles, tolerance, workspace, by_tables):
    """Find a steady state from `workspace.memory.start`.

    Parameters
    ----------
    problem, friction, cycles, tolerance, workspace : see `solve_from`
    by_tables : whether the tables of one mass can be used
    """
    row, memory, record = workspace.row, workspace.memory, workspace.record
    if by_tables:
        located, spent, _ = solve_single(
            problem, row, workspace.single, friction.kinetic[0], memory, record, 0
        )
        if located:
            return Steady(REPEATS, unique_halves(problem), spent)
    return find(problem, friction, cycles, tolerance, workspace)


@kernel
def _settled(problem, friction, state, found, cycles, tolerance, workspace, settled, by_tables, anew):
    """Give a steady state the places of its contacts at rest, and bits that do not depend on the way to it.

    Parameters
    ----------
    problem, friction, state, cycles, tolerance, workspace, settled : see `solve_from`
    found : Steady, the one in `workspace.memory.start`
    by_tables : whether the tables of one mass can be used
    anew : whether it was found by `_find_anew`

    Returns
    -------
    Steady, multiplier : the latter if the tables measured it, else NaN
    """
    row, memory, ring, places = workspace.row, workspace.memory, workspace.ring, workspace.places
    unique = is_unique(problem, friction)
    copy_motion(memory.start, memory.senses, ring.orbit, ring.orbit_senses)
    if not unique:  # the last way was not over the whole period
        go_round(problem, row, friction, found.halves, workspace.motion, memory, workspace.record, False)
    restore_friction(friction, places.limits)
    if not problem.loops and find_rests(problem, memory, found.halves, places) > 0 and not is_free(problem):
        return _settle(problem, friction, state, found, cycles, tolerance, workspace, settled), math.nan
    if anew or not unique:
        return found, math.nan
    _, spent, multiplier = _find_anew(problem, friction, tolerance, workspace, by_tables, len(BITS))
    return Steady(REPEATS, found.halves, found.cycles + spent), multiplier


@late_kernel((bool, float))
def _find_by_kept(problem, friction, tolerance, workspace):
    """Find the steady state near the one in `memory.start` by the derivatives of the last cell.

    Parameters
    ----------
    problem, friction, tolerance, workspace : see `find`

    Returns
    -------
    (found, cycles) : whether it was found, else `memory.start` is as before; periods followed
    """
    row, motion, memory, places = workspace.row, workspace.motion, workspace.memory, workspace.places
    copy_motion(memory.start, memory.senses, places.orbit, places.senses)
    status, spent = newton_kept(
        problem, row, friction, memory.kept[0], tolerance, motion, memory, workspace.record, False
    )
    if status != REPEATS:
        copy_motion(places.orbit, places.senses, memory.start, memory.senses)
    return status == REPEATS, spent


@kernel
def solve_from(problem, friction, state, cycles, tolerance, workspace, what, settled, near):
    """Find and measure the steady state that the motion from a state at tau = 0 reaches.

    It is looked for from the state in `workspace.memory.start`, on which it does not depend for mu = 1.

    Parameters
    ----------
    problem, friction : Problem, Friction; contacts at rest get a friction without limit
    state : (2, m) modes and their velocities q' at tau = 0
    cycles, tolerance : see `find`
    workspace : Workspace after `begin_row`
    what : see `measure`
    settled : ANYWHERE, AT_ZERO or LED, where contacts at rest are; those of a free structure are anywhere
    near : whether the state in `workspace.memory.start` is likely to be near the steady one

    Returns
    -------
    Steady, half periods measured, multiplier
    """
    row, places = workspace.row, workspace.places
    base, unique = unique_halves(problem), is_unique(problem, friction)
    tables = (what == RANGES or what == RANGES_ALONE) and unique and not has_law(problem)
    by_tables = tables and fits_row(problem, row, workspace.single, base)
    keep_friction(friction, places.limits)
    allow_factors(workspace.memory, unique)
    anew, spent, multiplier = False, 0.0, math.nan
    known = False
    if near and settled != ANYWHERE and unique and workspace.memory.kept[0] > 0:
        known, spent = _find_by_kept(problem, friction, tolerance, workspace)
    elif not near:
        forget_factors(workspace.memory)  # a state from rest does not depend on other cells
    if near and settled != ANYWHERE and unique and not known:
        anew, spent, multiplier = _find_anew(
            problem, friction, tolerance, workspace, by_tables, 0 if by_tables else 1
        )
    if anew and by_tables:
        return Steady(REPEATS, base, spent), base, multiplier
    found = Steady(REPEATS, base, spent)
    if not anew and not known:
        found = _locate(problem, friction, cycles, tolerance, workspace, by_tables)
        found = Steady(found.status, found.halves, found.cycles + spent)
    if found.status == REPEATS and settled != ANYWHERE:
        found, multiplier = _settled(
            problem, friction, state, found, cycles, tolerance, workspace, settled, by_tables, anew
        )
        if not math.isnan(multiplier):
            return found, base, multiplier
    if found.status != REPEATS:
        return found, 0, math.nan
    halves, multiplier = measure(problem, friction, found.halves, workspace, what)
    if halves == 0:
        found = Steady(CHATTERS, 0, found.cycles)
    return found, halves, multiplier


@kernel
def _one(problem, i, friction, state, limits, workspace, settled):
    """Find the steady state of one cell, and record it.

    Parameters
    ----------
    problem, i, friction, state, settled : see `one_steady_state`
    limits : cycles, tolerance
    workspace : Workspace

    Returns
    -------
    Steady, half periods, multiplier
    """
    row, motion, memory, record = workspace.row, workspace.motion, workspace.memory, workspace.record
    cycles, tolerance = limits
    begin_row(problem, i, workspace)
    fit_row(problem, i, friction, workspace)
    from_rest(problem, row, friction, state, motion, memory, record, NOTHING)
    found, halves, multiplier = solve_from(
        problem, friction, state, cycles, tolerance, workspace, STEPS, LED if settled else ANYWHERE, False
    )
    if found.status == REPEATS:
        return found, halves, multiplier
    halves = 2
    if found.status == AVERAGED:  # the first phase shown is a maximum of the load, after the first section
        halves = 2 * (WINDOW + 1)
        go_back_cycles(problem, memory, workspace.ring, WINDOW + 1)
    clear_record(record)
    record.active[0] = STEPS
    go_round(problem, row, friction, halves, motion, memory, record, False)
    if found.status == AVERAGED:
        take_window(workspace.course, memory.counts, record)
    return found, halves, multiplier


@entry
def one_steady_state(problem, i, friction, state, cycles, tolerance, workspace, settled):
    """Find the steady state of one cell, with the series of its steps.

    Parameters
    ----------
    problem, i : Problem, lent, index of r
    friction : Friction, lent
    state : see `from_rest`
    cycles, tolerance : see `find`
    workspace : Workspace, lent; its content does not matter
    settled : whether the places of contacts at rest are wanted, else any at which they can rest

    Returns
    -------
    Steady, half periods that the steps cover (two if there is no steady state, WINDOW periods and one before
    them if there are averages), multiplier
    """
    return _one(problem, i, friction, state, (cycles, tolerance), workspace, settled)
