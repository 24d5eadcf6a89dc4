"""Cells of a map: whole runs of cells by closed form, the open cells one by one."""

import math
from typing import NamedTuple

import numpy as np

from ...regimes import CLOSED_FORM, CONTINUOUS, IRREGULAR, NOT_REACHED, PERMANENT_STICKING, RESOLVED
from ..compiler import entry, kernel
from ..compiler.packed import packed
from ..continuous_motion import continuous_amplitude
from .further import requested_at, write_continuous, write_orbit, write_stuck
from .march import steady_state
from .measure import measure
from .motion import at_frequency, contact_at, forget_neighbour, start
from .records import continuous_cell, known_orbit, quasi_static_cell, stuck_cell
from .segment_table import segment_columns

#: Number of open cells of a row after which the search from the neighbour's orbit starts anew.  Jobs begin
#: only there and at the start of rows, so that no result depends on how the map is divided into jobs.
RESTART = 256

#: Where a motion with mu = 1 does not settle, its steady state is followed from that of this share of the
#: friction, in this number of steps.
_FROM, _STEPS = 0.75, 8


class Axes(NamedTuple):
    """Axes of a map."""

    mu: np.ndarray
    r: np.ndarray
    beta: np.ndarray


class OpenCells(NamedTuple):
    """Cells that no closed form decides."""

    rows: np.ndarray  # (k,) the (mu, r) rows with open cells
    ends: np.ndarray  # (k,) cumulative number of open cells of these rows
    low: np.ndarray  # (n_mu n_r,) index in beta of the first open cell of each row
    high: np.ndarray  # (n_mu n_r,) index after the last one


class ClosedForm(NamedTuple):
    """Quantities that the closed forms need at every r; arrays of shape (n_r,)."""

    load: np.ndarray  # unit of force and displacement, the load amplitude
    v_abs: np.ndarray
    u: np.ndarray
    g: np.ndarray
    marginal: np.ndarray  # bool


@kernel
def _fill(values, m, i, first, last, value):
    """Fill a part of a row of an output; one that is not requested has size 0."""
    if values.size:
        for j in range(first, last):
            values[m, i, j] = value


@kernel
def store(out, m, i, first, last, cell, load):
    """Write the requested outputs of a cell to some cells of a row.

    Parameters
    ----------
    out : named tuple of arrays (n_mu, n_r, n_beta, ...), one for every output
    m, i : indices of mu and r
    first, last : cells first..last-1 are written
    cell : Cell
    load : unit of force and displacement
    """
    _fill(out.regime, m, i, first, last, cell.regime)
    _fill(out.stops_per_cycle, m, i, first, last, cell.stops)
    _fill(out.contact_amplitude, m, i, first, last, cell.amplitude * load)
    _fill(out.stuck_fraction, m, i, first, last, cell.stuck)
    _fill(out.stops_per_cycle_error, m, i, first, last, cell.stops_error)
    _fill(out.stuck_fraction_error, m, i, first, last, cell.stuck_error)
    _fill(out.period, m, i, first, last, cell.period)
    _fill(out.origin, m, i, first, last, cell.origin)
    _fill(out.cycles, m, i, first, last, math.ceil(cell.cycles))
    _fill(out.status, m, i, first, last, cell.status)


@kernel
def _store_continuous(out, m, i, last, axes, closed):
    """Write the requested outputs of the first cells of a row, which are in continuous motion."""
    load = closed.load[i]
    # without friction, which the first cell may be, no motion forms a continuum
    first = 1 if last > 0 and axes.beta[0] == 0.0 else 0
    store(out, m, i, 0, first, continuous_cell(0.0, False, CLOSED_FORM, 0.0), load)
    store(out, m, i, first, last, continuous_cell(0.0, closed.marginal[i], CLOSED_FORM, 0.0), load)
    if out.contact_amplitude.size:
        for j in range(last):
            amplitude = continuous_amplitude(closed.v_abs[i], closed.u[i], closed.g[i], axes.beta[j] / load)
            out.contact_amplitude[m, i, j] = amplitude * load


@kernel
def _fill_closed_row(row, cells, axes, closed, out, further):
    """Fill the cells of one row that closed forms decide; see `fill_closed`."""
    further = packed(further)
    m = row // axes.r.size
    i = row % axes.r.size
    low, high, end = cells.low[row], cells.high[row], axes.beta.size
    load = closed.load[i]
    _store_continuous(out, m, i, low, axes, closed)
    if axes.r[i] > 0.0:
        for j in range(low):
            write_continuous(further, m, j, axes.beta[j])
    else:
        store(out, m, i, low, high, quasi_static_cell(), load)
    store(out, m, i, high, end, stuck_cell(CLOSED_FORM, RESOLVED, 0.0, 0.0, 1.0), load)
    for j in range(high, end):
        write_stuck(further, m, j)


@entry
def fill_closed(first, last, cells, axes, closed, out, requested):
    """Fill the cells that closed forms decide: continuous motion below the open cells, permanent sticking
    above them.

    At r = 0, where no motion can be followed, the open cells are filled too.

    Parameters
    ----------
    first, last : rows first..last-1 of the (mu, r) grid
    cells : OpenCells
    axes : Axes
    closed : ClosedForm
    out : named tuple of arrays (n_mu, n_r, n_beta, ...), one for every output
    requested : Requested, see `further`
    """
    cells, axes, closed, out = packed(cells), packed(axes), packed(closed), packed(out)
    for row in range(first, last):
        further = requested_at(requested, row % axes.r.size)
        _fill_closed_row(row, cells, axes, closed, out, further)


@kernel
def _write_further(further, motion, contact, found, m, j, beta):
    """Write the further outputs of an open cell.

    Parameters
    ----------
    further : RequestedAtFrequency
    motion : a kind of motion, at the anchor of the steady state
    contact : Contact
    found : Cell
    m, j : indices of mu and beta
    beta : friction ratio
    """
    if found.regime == PERMANENT_STICKING:
        write_stuck(further, m, j)
    elif found.slides > 0:
        write_orbit(further.table, further, motion, contact, found, m, j, beta)
    elif found.regime == CONTINUOUS:
        write_continuous(further, m, j, beta)


@kernel
def _row_of(cells, cell):
    """Find the row of an open cell in the list of rows, by bisection."""
    low, high = 0, cells.ends.size
    while low < high:
        middle = (low + high) // 2
        if cells.ends[middle] <= cell:
            low = middle + 1
        else:
            high = middle
    return low


@kernel
def _settled_cell(motion, system, place, beta, mu, limits, moving, cancel):
    """Find the steady state of an open cell; return its contact, and the cell.

    Where the start does not matter (mu = 1), but the motion takes longer than allowed to settle, Newton's
    method finds its steady state from those at less friction.

    Parameters
    ----------
    motion : a kind of motion
    system, limits, moving, cancel : see `fill_open`
    place : indices of mu and r
    beta, mu : of the cell
    """
    m, i = place
    contact = contact_at(system, m, i, beta, mu)
    found = steady_state(motion, contact, start(motion, system, i, contact, moving), moving, limits, cancel)
    if mu == 1.0 and (found.status == IRREGULAR or found.status == NOT_REACHED):
        forget_neighbour(motion)
        for k in range(_STEPS + 1):
            share = _FROM + (1.0 - _FROM) * k / _STEPS
            contact = contact_at(system, m, i, share * beta, mu)
            found = steady_state(
                motion, contact, start(motion, system, i, contact, moving), moving, limits, cancel
            )
    return contact, found


@kernel
def _fill_cells(place, low, positions, axes, system, motion, limits, moving, out, further, cancel):
    """Fill open cells of one row; stop soon after cancel[0] is set.

    Parameters
    ----------
    place : indices of mu and r
    low : index of the first open cell of the row
    positions : range of cells, counted from there
    axes, system, limits, moving, out, cancel : see `fill_open`
    motion : a kind of motion
    further : RequestedAtFrequency
    """
    motion, further = packed(motion), packed(further)
    m, i = place
    for position in range(positions[0], positions[1]):
        if cancel[0] != 0:
            return
        if position % RESTART == 0:
            forget_neighbour(motion)
        j = low + position
        beta, mu = axes.beta[j], axes.mu[m]
        contact, found = _settled_cell(motion, system, place, beta, mu, limits, moving, cancel)
        store(out, m, i, j, j + 1, found, motion.load)
        motion.scratch.left[0] = math.inf  # the orbit is known, so following it ends
        _write_further(further, motion, contact, found, m, j, beta)


@entry
def fill_open(first, last, cells, axes, system, limits, moving, out, requested, cancel):
    """Fill cells first..last-1 of the list of open cells; stop soon after cancel[0] is set.

    Parameters
    ----------
    first, last : range of open cells; the search from neighbours starts anew at `first`, see RESTART
    cells, axes : OpenCells, Axes
    system : a system over the map, see `motion`
    limits : Limits
    moving : whether the initial state is the moving start; else the contact starts at rest
    out : named tuple of arrays (n_mu, n_r, n_beta, ...), one for every output
    requested : Requested, see `further`
    cancel : (1,) set by another thread to end the computation
    """
    cells, axes, system, out = packed(cells), packed(axes), packed(system), packed(out)
    n_r = axes.r.size
    k = _row_of(cells, first)
    cell = first
    while cell < last:
        row = cells.rows[k]
        m = row // n_r
        i = row % n_r
        begin = cells.ends[k - 1] if k > 0 else 0
        positions = cell - begin, min(last, cells.ends[k]) - begin
        _fill_cells(
            (m, i), cells.low[row], positions, axes, system, at_frequency(system, i), limits, moving, out,
            requested_at(requested, i), cancel,
        )  # fmt: skip
        cell = cells.ends[k]
        k += 1


@kernel
def _find_cell(system, motion, beta, mu, limits, moving, cancel):
    """Find the steady state of the cell of `one_cell`; return its contact, and the cell.

    Parameters
    ----------
    system, beta, mu, limits, moving, cancel : see `one_cell`, `fill_open`
    motion : a kind of motion
    """
    system, motion = packed(system), packed(motion)
    forget_neighbour(motion)
    contact, found = _settled_cell(motion, system, (0, 0), beta, mu, limits, moving, cancel)
    if found.slides > 0:
        motion.scratch.left[0] = math.inf  # the orbit is known, so following it ends
    return contact, found


@kernel
def _fill_table(motion, contact, found, table):
    """Fill the segment table of the periodic orbit of a cell; return the number of its rows."""
    orbit = known_orbit(found.contact_state, found.event, found.sign, found.slides)
    return measure(packed(motion), contact, orbit, table).segments


@entry
def one_cell(system, beta, mu, limits, moving):
    """Find the steady state of one open cell of a system at one frequency, and its segment table.

    Returns (cell, table); the table has no rows where the contact sticks or a closed form gives the motion.
    """
    motion = at_frequency(system, 0)
    contact, found = _find_cell(system, motion, beta, mu, limits, moving, np.zeros(1, dtype=np.uint8))
    table = np.empty((2 * found.slides, segment_columns(system.modes)))
    return found, table[: _fill_table(motion, contact, found, table)]
