"""Cells of a map, row by row.

Where the start does not matter, a cell starts from the steady state of its neighbour.
"""

import math
from typing import NamedTuple

import numpy as np

from ...regimes import (
    CLOSED_FORM,
    CONTINUOUS,
    INTEGRATED,
    IRREGULAR,
    NOT_REACHED,
    ONE_WAY_SLIDING,
    PERIODIC_ORBIT,
    PERMANENT_STICKING,
    RESOLVED,
    STICK_SLIP,
    TOO_MANY_EVENTS,
)
from ..compiler import entry, kernel, late_kernel
from ..compiler.lending import made
from ..compiler.packed import packed
from ..extrapolation import CELLS, reaches, weight
from .counts import (
    COUNT_ROWS,
    CROSSINGS,
    MOVED,
    RELEASE_ORDER,
    REVERSALS,
    SLIPS,
    STOPS,
    STOPS_ERROR,
    STUCK,
    STUCK_ERROR,
    TURNS,
)
from .laws.contact import regime_of
from .laws.kinds import has_force
from .laws.speed import has_law
from .places import fill_needs, keep_held, place_after_start, place_at_start
from .problem import padded, varies
from .record import HIGH, LEAST_SLIP, LOW, NOTHING, OF_FRICTION, OF_WALL, RANGES, RANGES_ALONE
from .return_map import copy_motion, copy_state, forget_factors, from_rest, steady_period
from .series import Friction
from .steady import (
    AT_ZERO,
    AVERAGED,
    LED,
    NO_REPEAT,
    REPEATS,
    Workspace,
    begin_row,
    fit_row,
    is_unique,
    make_workspace,
    solve_from,
)

#: A steady state with a larger multiplier may be one of a continuum: the result depends on the initial state.
_ISOLATED = 1.0 - 1e-9


#: Contacts of a row that stick permanently: not known yet, some slip after the start, none does
#: in this cell and those after it, at the place 0 or where they begin.
_UNKNOWN, _SOME_SLIP, _STAYS, _STAYS_AWAY = 0, 1, 2, 3


#: Numbers of a contact that are stored, per period of the load: counted ones; standard errors of averages;
#: least slip, sliding distance, works of friction and of a wall at constant velocity; displacement by drift;
#: break points of a law that are passed.
NUMBERS = (
    "stops", "turns", "stuck", "slips", "reversals", "stops_error", "stuck_error",
    "least_slip", "distance", "work_friction", "work_wall", "drift", "crossings",
)  # fmt: skip
(
    _STOPS, _TURNS, _STUCK, _SLIPS, _REVERSALS, _STOPS_ERROR, _STUCK_ERROR,
    _LEAST_SLIP, _DISTANCE, _WORK_FRICTION, _WORK_WALL, _DRIFT, _CROSSINGS,
) = range(len(NUMBERS))  # fmt: skip
_SEGMENTS = len(NUMBERS)


#: Cells in which the places of contacts at rest are looked for: none, those in which others move, all.
NO_PLACES, SOME_PLACES, ALL_PLACES = 0, 1, 2


class Grid(NamedTuple):
    """Friction of a grid: kinetic friction of contact j is kinetic[j, 0] beta + kinetic[j, 1], ..."""

    beta: np.ndarray  # (n_r, n_beta) increasing; those of a map are the same at every r
    kinetic: np.ndarray  # (N, 2)
    static: np.ndarray  # (n_mu, N, 2)
    stuck_from: np.ndarray  # (n_mu, n_r) index of the first cell that is proved to stick permanently
    starts: np.ndarray  # (n_r, 3, m) initial states, see `from_rest`
    places: int  # see NO_PLACES
    cycles: float
    tolerance: float
    multipliers: bool  # whether they are wanted


class Trail(NamedTuple):
    """The steady states of the last cells of a row, latest first, to begin the next one from."""

    states: np.ndarray  # (CELLS, 3, ...)
    senses: np.ndarray  # (N,) the pattern of all of them
    beta: np.ndarray  # (CELLS,)
    count: np.ndarray  # (1,) int: how many there are


class RowMemory(NamedTuple):
    """The memory that rows are filled in."""

    workspace: Workspace
    trail: Trail
    friction: Friction


class Cells(NamedTuple):
    """Results, (n_mu, n_r, n_beta) and one number per contact or mass."""

    regime: np.ndarray
    status: np.ndarray
    origin: np.ndarray
    cycles: np.ndarray
    period: np.ndarray
    multiplier: np.ndarray
    release_order: np.ndarray  # 1 where releasing contacts all at once would make a difference
    unique: np.ndarray  # 1 where no other steady state can be
    contact_regime: np.ndarray  # (..., N)
    numbers: np.ndarray  # (len(NUMBERS), ..., N), and a row for the share of time in every segment of a law
    lowest: np.ndarray  # (..., N + n)
    highest: np.ndarray


@kernel
def _store_numbers(problem, numbers, m, i, b, counts, halves, record):
    """Store the numbers of every contact.

    Parameters
    ----------
    problem : Problem
    numbers : see `Cells`
    m, i, b : indices of mu, r and beta
    counts : counters of `follow`, over the half periods measured
    halves : number of these
    record : Record
    """
    period = 0.5 * halves
    for j in range(problem.spring.size):
        moved = counts[MOVED, j] != 0.0
        slips_throughout = moved and has_force(problem, j) and counts[STUCK, j] == 0.0
        numbers[_STOPS, m, i, b, j] = counts[STOPS, j] / period
        numbers[_TURNS, m, i, b, j] = counts[TURNS, j] / period
        numbers[_STUCK, m, i, b, j] = counts[STUCK, j] / (math.pi * halves) if moved else 1.0
        numbers[_SLIPS, m, i, b, j] = 1.0 if slips_throughout else counts[SLIPS, j] / period
        numbers[_REVERSALS, m, i, b, j] = counts[REVERSALS, j] / period
        numbers[_STOPS_ERROR, m, i, b, j] = counts[STOPS_ERROR, j]
        numbers[_STUCK_ERROR, m, i, b, j] = counts[STUCK_ERROR, j]
        numbers[_LEAST_SLIP, m, i, b, j] = record.slips[LEAST_SLIP, j] if moved else 0.0
        numbers[_DISTANCE, m, i, b, j] = record.distance[j] / period
        numbers[_WORK_FRICTION, m, i, b, j] = record.works[OF_FRICTION, j] / period
        numbers[_WORK_WALL, m, i, b, j] = record.works[OF_WALL, j] / period
        numbers[_DRIFT, m, i, b, j] = record.drift[j] / period
        numbers[_CROSSINGS, m, i, b, j] = counts[CROSSINGS, j] / period
        for k in range(problem.law.count[j] if has_law(problem) and not has_force(problem, j) else 0):
            numbers[_SEGMENTS + k, m, i, b, j] = counts[COUNT_ROWS + k, j] / (math.pi * halves)


@kernel
def _store_motion(problem, out, m, i, b, counts, halves, record):
    """Store what was measured of a steady state, and the regimes.

    Parameters
    ----------
    problem : Problem
    out : Cells
    m, i, b, counts, halves, record : see `_store_numbers`
    """
    _store_numbers(problem, out.numbers, m, i, b, counts, halves, record)
    contacts = problem.spring.size
    least, most = CONTINUOUS + 2, PERMANENT_STICKING
    differs = False
    for j in range(contacts):
        regime = regime_of(problem, counts, j)
        least, most = min(least, regime), max(most, regime)
        out.contact_regime[m, i, b, j] = regime
        differs = differs or counts[RELEASE_ORDER, j] != 0.0
    out.release_order[m, i, b] = 1 if differs else 0
    for k in range(out.lowest.shape[3]):
        out.lowest[m, i, b, k] = record.ranges[LOW, k]
        out.highest[m, i, b, k] = record.ranges[HIGH, k]
    out.regime[m, i, b] = STICK_SLIP
    if most == PERMANENT_STICKING:
        out.regime[m, i, b] = PERMANENT_STICKING
    elif least >= CONTINUOUS:
        out.regime[m, i, b] = ONE_WAY_SLIDING if contacts == 1 and least == ONE_WAY_SLIDING else CONTINUOUS


@entry
def store_motion(problem, out, counts, halves, record):
    """Store one steady state in the only cell of `out`; see `_store_motion`."""
    _store_motion(packed(problem), packed(out), 0, 0, 0, counts, halves, packed(record))


@kernel
def _store(problem, out, m, i, b, found, measured, counts, record):
    """Store a solved cell.

    Parameters
    ----------
    problem : Problem
    out : Cells
    m, i, b : indices of mu, r and beta
    found : Steady
    measured : half periods measured, multiplier
    counts, record : counters of `follow`, Record
    """
    halves, multiplier = measured
    out.cycles[m, i, b] = math.ceil(found.cycles)
    if found.status == AVERAGED:
        out.status[m, i, b] = IRREGULAR
        out.origin[m, i, b] = INTEGRATED
        _store_motion(problem, out, m, i, b, counts, found.halves, record)
        return
    if found.status != REPEATS:
        out.status[m, i, b] = NOT_REACHED if found.status == NO_REPEAT else TOO_MANY_EVENTS
        out.origin[m, i, b] = INTEGRATED
        return
    out.status[m, i, b] = RESOLVED
    out.origin[m, i, b] = PERIODIC_ORBIT
    out.period[m, i, b] = steady_period(found.halves)
    out.multiplier[m, i, b] = multiplier
    _store_motion(problem, out, m, i, b, counts, halves, record)


@kernel
def _store_stuck(problem, out, m, i, b):
    """Store a cell that closed forms prove to stick permanently; its displacements beside those of the
    structure held at the place 0, which are added elsewhere, are 0.
    """
    out.regime[m, i, b] = PERMANENT_STICKING
    out.status[m, i, b] = RESOLVED
    out.origin[m, i, b] = CLOSED_FORM
    out.period[m, i, b] = 1
    out.release_order[m, i, b] = 0
    for j in range(out.contact_regime.shape[3]):
        out.contact_regime[m, i, b, j] = PERMANENT_STICKING
        for k in range(_SEGMENTS):
            out.numbers[k, m, i, b, j] = 1.0 if k == _STUCK else 0.0
        for k in range(problem.law.count[j] if has_law(problem) and not has_force(problem, j) else 0):
            out.numbers[_SEGMENTS + k, m, i, b, j] = 0.0
    for k in range(out.lowest.shape[3]):
        out.lowest[m, i, b, k] = out.highest[m, i, b, k] = 0.0


@kernel
def _stays(problem, grid, m, i, b, friction, workspace, place):
    """Whether no contact slips from the start on, in a cell that sticks permanently.

    Parameters
    ----------
    problem, grid, m, i, b, friction, workspace, place : see `_place_stuck`
    """
    needs = workspace.needs
    changes = fit_row(problem, i, friction, workspace)
    # where a normal load varies, what is kept depends on the friction
    for j in range(needs.size):
        changes = changes or varies(problem, j)
    if place == _UNKNOWN or changes:
        if not keep_held(problem, friction, grid.tolerance, workspace):
            return True
        fill_needs(problem, friction, grid.starts[i], workspace)
    _set_friction(grid, m, i, b, friction)
    stays = True
    for j in range(needs.size):
        stays = stays and friction.static[j] >= needs[j]
    return stays


@late_kernel(int)
def _place_stuck(problem, grid, m, i, b, friction, workspace, place, out):
    """Store the displacements at the places to which the start leads in a cell that sticks permanently.

    Parameters
    ----------
    problem, grid : Problem, Grid
    m, i, b : indices of mu, r and beta
    friction, workspace : Friction, replaced; Workspace
    place : _UNKNOWN, _SOME_SLIP, _STAYS or _STAYS_AWAY, of the cells of the row before this one
    out : Cells

    Returns
    -------
    int : _SOME_SLIP, _STAYS or _STAYS_AWAY
    """
    if place == _STAYS:
        return _STAYS
    state, shift = grid.starts[i], out.lowest[m, i, b]
    _set_friction(grid, m, i, b, friction)
    if place == _STAYS_AWAY or _stays(problem, grid, m, i, b, friction, workspace, place):
        if not place_at_start(problem, friction, state, workspace, shift):
            return _STAYS
        place = _STAYS_AWAY
    else:
        if not place_after_start(problem, friction, state, grid.cycles, workspace, shift):
            out.status[m, i, b] = NOT_REACHED
            for k in range(shift.size):
                shift[k] = math.nan
        place = _SOME_SLIP
    for k in range(shift.size):
        out.highest[m, i, b, k] = shift[k]
    return place


@kernel
def _set_friction(grid, m, i, b, friction):
    """Set the friction of every contact in a cell."""
    for j in range(friction.kinetic.size):
        friction.kinetic[j] = grid.kinetic[j, 0] * grid.beta[i, b] + grid.kinetic[j, 1]
        friction.static[j] = grid.static[m, j, 0] * grid.beta[i, b] + grid.static[m, j, 1]


@entry
def make_trail(problem):
    """Allocate the memory of the last cells."""
    contacts, modes = problem.chi.shape
    return Trail(
        np.zeros((CELLS, 3, padded(max(modes, contacts)))), np.zeros(contacts, np.int64), np.zeros(CELLS),
        np.zeros(1, np.int64),
    )  # fmt: skip


@kernel
def _remember(memory, beta, trail):
    """Keep the steady state of a cell, and those before it if they have the same pattern."""
    same = True
    for j in range(memory.senses.size):
        same = same and memory.senses[j] == trail.senses[j]
    trail.count[0] = min(trail.count[0] + 1, CELLS) if same else 1
    for k in range(trail.count[0] - 1, 0, -1):
        trail.beta[k] = trail.beta[k - 1]
        copy_state(trail.states[k - 1], trail.states[k])
    trail.beta[0] = beta
    copy_motion(memory.start, memory.senses, trail.states[0], trail.senses)


@kernel
def _begin_ahead(beta, trail, memory):
    """Begin where the steady states of the last cells point: at the polynomial in beta through them."""
    count = trail.count[0]
    if not reaches(trail.beta, count, beta):
        return
    for part in range(3):
        for i in range(memory.start.shape[1]):
            memory.start[part, i] = 0.0
    for k in range(count):
        share = weight(trail.beta, count, k, beta)
        for part in range(3):
            for i in range(memory.start.shape[1]):
                memory.start[part, i] += share * trail.states[k, part, i]


@kernel
def _where(grid):
    """Where contacts at rest are, see `solve_from`."""
    return AT_ZERO if grid.places == NO_PLACES else LED


@kernel
def _solve_cell(problem, grid, m, i, b, friction, workspace, trail):
    """Find the steady state of a cell: from where the last cells point, if that leads to it, or from rest.

    Parameters
    ----------
    problem, grid : Problem, Grid
    m, i, b : indices of mu, r and beta
    friction, workspace, trail : Friction, filled with that of the cell; Workspace, Trail

    Returns
    -------
    Steady, half periods measured, multiplier
    """
    state, row, memory = grid.starts[i], workspace.row, workspace.memory
    what = RANGES if grid.multipliers else RANGES_ALONE
    _set_friction(grid, m, i, b, friction)
    if fit_row(problem, i, friction, workspace):
        trail.count[0] = 0
        forget_factors(memory)
    if trail.count[0] > 0 and is_unique(problem, friction):
        _begin_ahead(grid.beta[i, b], trail, memory)
        found, halves, multiplier = solve_from(
            problem, friction, state, grid.cycles, grid.tolerance, workspace, what, _where(grid), True
        )
        if found.status == REPEATS and not multiplier >= _ISOLATED:
            return found, halves, multiplier
        _set_friction(grid, m, i, b, friction)
    from_rest(problem, row, friction, state, workspace.motion, memory, workspace.record, NOTHING)
    return solve_from(
        problem, friction, state, grid.cycles, grid.tolerance, workspace, what, _where(grid), False
    )


@kernel
def _fill_rows(first, last, problem, grid, out, memory, cancel):
    """Fill rows; see `fill_rows`.

    Parameters
    ----------
    first, last, problem, grid, out, memory, cancel : see `fill_rows`
    """
    workspace, trail, friction = memory.workspace, memory.trail, memory.friction
    n_r = problem.r.size
    for index in range(first, last):
        m, i = index // n_r, index % n_r
        if problem.r[i] == 0.0:
            continue
        begin_row(problem, i, workspace)
        trail.count[0] = 0
        place = _UNKNOWN if grid.places == ALL_PLACES else _STAYS
        for b in range(grid.beta.shape[1]):
            if cancel[0] != 0:
                return
            if b >= grid.stuck_from[m, i]:
                _store_stuck(problem, out, m, i, b)
                place = _place_stuck(problem, grid, m, i, b, friction, workspace, place, out)
                continue
            found, halves, multiplier = _solve_cell(problem, grid, m, i, b, friction, workspace, trail)
            if found.status == REPEATS:
                _remember(workspace.memory, grid.beta[i, b], trail)
            else:
                trail.count[0] = 0
            _store(
                problem, out, m, i, b, found, (halves, multiplier), workspace.memory.counts, workspace.record
            )


def make_row_memory(problem, masses):
    """Allocate the memory of `fill_rows`; `masses` (n, m): see `make_workspace`."""
    contacts = problem.spring.size
    return RowMemory(
        made(make_workspace, problem, masses, 0), made(make_trail, problem),
        Friction(np.empty(contacts), np.empty(contacts)),
    )  # fmt: skip


@entry
def fill_rows(first, last, problem, grid, out, memory, cancel):
    """Fill rows first..last-1 of the (mu, r) grid; stop soon after cancel[0] is set.

    Parameters
    ----------
    first, last : range of rows; no row depends on another
    problem, grid : Problem, Grid, lent
    out : Cells, unresolved, lent
    memory : RowMemory, lent; its content does not matter
    cancel : (1,) set by another thread to end the computation
    """
    _fill_rows(first, last, problem, grid, out, memory, cancel)
