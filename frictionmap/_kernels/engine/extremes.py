"""Largest displacement of each mass, and largest force to the ground, in a steady state.

Every such quantity is linear in the state, hence a polynomial within a scan step.  Phases are those of a
maximum: a quantity that is largest at a minimum has its maximum half a period later, in the mirror image, if
the motion is symmetric.
"""

import math
from typing import NamedTuple

import numpy as np

from ..compiler import kernel
from ..structure.oscillators import COLUMNS, OW, OZ, bounds, derivatives, expand, step_on, watch, watch_load
from ..structure.state import FEEDTHROUGH_COS, FEEDTHROUGH_SIN
from .segment_table import COS, LENGTH, SENSE, SIN, STOP_Z, Z_END, take_start

#: Columns of the result: the largest modulus and its load phase; for a modulus held during a stop, the load
#: phases at which the stop begins and ends.
VALUE, PHASE, PHASE_BEGIN, PHASE_END = 0, 1, 2, 3
FOUND = 4

#: Shortest interval, as a share of a scan step, that is still divided, and the overlap of scan steps: the
#: error of stopping there is of third order in it.
_SHORTEST = 1e-6


#: Newton step after which the next one would be rounding error.
_NEXT = 1e-9


class OutputMatrices(NamedTuple):
    """Rows that map the state to displacements (the masses first) and to the transmitted force; velocities in
    t = tau/r.
    """

    free: np.ndarray  # (rows, 2n) coefficients of the free oscillators (q, p)
    held: np.ndarray  # (rows, 2m) coefficients of the held oscillators (y, p)
    static_shape: np.ndarray  # (rows,) response to a unit displacement of the held contact
    friction: np.ndarray  # (rows,) coefficient of the friction force while the contact slides


class UncoupledResponse(NamedTuple):
    """Response of the modes that the contact does not excite, and of the base; phasors (n_r, rows)."""

    sliding: np.ndarray
    held: np.ndarray


@kernel
def turned_half(angle, value):
    """Load phase in (-pi, pi] of the maximum of a quantity that has this value at a load phase."""
    if value < 0.0:
        angle += math.pi
    angle -= 2.0 * math.pi * math.ceil((angle - math.pi) / (2.0 * math.pi))
    return math.pi if angle <= -math.pi else angle + 0.0  # not -0.0


@kernel
def largest_in_contact(table, out):
    """Find the largest modulus of z, and when; z turns only at the ends of slides, and stops hold it there.

    Parameters
    ----------
    table : (segments, columns) segment table
    out : (FOUND,) filled with modulus and load phases
    """
    out[VALUE] = -1.0
    for k in range(table.shape[0]):
        row = table[k]
        if row[SENSE] > 0.0 and abs(row[Z_END]) > out[VALUE]:
            out[VALUE] = abs(row[Z_END])
            end = turned_half(math.atan2(row[SIN], row[COS]) + row[LENGTH], row[Z_END])
            out[PHASE], out[PHASE_BEGIN], out[PHASE_END] = end, math.nan, math.nan
            if k + 1 < table.shape[0] and table[k + 1, SENSE] == 0.0:
                out[PHASE], out[PHASE_BEGIN], out[PHASE_END] = math.nan, end, end + table[k + 1, LENGTH]


@kernel
def set_watch(st, outputs, k, beta, phasor, row, slides, n, table):
    """Fill a table of the n oscillators of a segment, whose watched sum is the k-th row of `outputs`.

    Parameters
    ----------
    st : StructureAtFrequency
    outputs : OutputMatrices; k : its row
    beta : kinetic friction force
    phasor : complex response of the row that the contact does not influence
    row : (columns,) row of the segment table
    slides : whether the segment is a slide
    n : number of oscillators
    table : (n + 1, COLUMNS) table of `oscillators` to fill

    Returns
    -------
    (friction, offset) : friction force on the oscillators, and the constant part of the row
    """
    source = st.free if slides else st.held
    yc, ys = phasor.real, -phasor.imag
    for i in range(n + 1):
        for column in range(COLUMNS):
            table[i, column] = source[i, column]
    for i in range(n):
        if slides:
            of_q, of_p = outputs.free[k, i], outputs.free[k, n + i]
            yc -= of_p * st.modes[FEEDTHROUGH_COS, i]
            ys -= of_p * st.modes[FEEDTHROUGH_SIN, i]
        else:
            of_q, of_p = outputs.held[k, i], outputs.held[k, n + i]
            yc -= of_p * st.held_feedthrough[0, i]
            ys -= of_p * st.held_feedthrough[1, i]
        table[i, OZ], table[i, OW] = of_q, of_p * st.rate
    watch_load(table, yc, ys)
    if slides:
        return beta, outputs.friction[k] * beta
    return 0.0, outputs.static_shape[k] * row[STOP_Z]


@kernel
def _search(st, table, n, friction, offset, row, state, scratch, out):
    """Update the largest modulus of the watched sum of a table over one segment.

    Scan steps in which the sum may exceed the largest value so far at a turning point are expanded, and so
    are the first and the last.  The steps overlap slightly, so that rounding hides no turning point between
    them.

    Parameters
    ----------
    st : StructureAtFrequency
    table : (n + 1, COLUMNS) table of `oscillators`
    n : number of oscillators
    friction : friction force on the oscillators
    offset : constant part of the sum
    row : (columns,) row of the segment table
    state : (2, n) state at the start of the segment; advanced to its end
    scratch : Scratch
    out : (FOUND,) largest modulus and its load phase, updated
    """
    angle = math.atan2(row[SIN], row[COS])
    c, s = row[COS], row[SIN]
    length = row[LENGTH] / st.h
    done = 0.0
    value, slope, _, _ = derivatives(table, friction, state, c, s)
    while done < length:
        first, last = done == 0.0, length <= done + 1.0
        bend, _, _, _, _, _ = bounds(table, friction, state, c, s)
        step_on(table, n, friction, state, scratch.next, c, s)
        c1, s1 = math.cos(angle + (done + 1.0) * st.h), math.sin(angle + (done + 1.0) * st.h)
        value1, slope1, _, _ = derivatives(table, friction, state, c1, s1)
        straight = slope * slope1 > 0.0 and abs(slope) + abs(slope1) >= bend
        low = max(abs(value + offset), abs(value1 + offset)) + 0.125 * bend <= out[VALUE]
        if first or last or not (straight or low):
            expand(table, n, friction, scratch.next, c, s, st.h, st.terms, scratch.series)
            watch(table, c, s, scratch.series, scratch.watched)
            scratch.watched[0] += offset
            begin, end = 0.0 if first else -_SHORTEST, length - done if last else 1.0 + _SHORTEST
            most, x = _largest_modulus(scratch.watched, st.terms, begin, end, first, last, out[VALUE])
            if abs(most) > out[VALUE]:
                out[VALUE], out[PHASE] = abs(most), turned_half(angle + (done + x) * st.h, most)
        value, slope, c, s = value1, slope1, c1, s1
        done += 1.0


@kernel
def largest_moduli(st, beta, outputs, uncoupled, i, skipped, table, out, work, scratch):
    """Find the largest modulus, and its load phase, of the rows of `outputs` over a segment table.

    Parameters
    ----------
    st : StructureAtFrequency
    beta : kinetic friction force
    outputs : OutputMatrices
    uncoupled : UncoupledResponse; i : index of the frequency
    skipped : row to leave out, or -1
    table : (segments, columns) segment table
    out : (rows, FOUND) filled with moduli and load phases
    work, scratch : Workspace, Scratch
    """
    for k in range(outputs.static_shape.size):
        if k == skipped:
            continue
        for column in range(FOUND):
            out[k, column] = math.nan
        out[k, VALUE] = -1.0
        for j in range(table.shape[0]):
            row = table[j]
            slides, n, state = take_start(st, row, work)
            watched = work.table[: n + 1]
            phasor = uncoupled.sliding[i, k] if slides else uncoupled.held[i, k]
            force, offset = set_watch(st, outputs, k, beta, phasor, row, slides, n, watched)
            _search(st, watched, n, force, offset, row, state, scratch, out[k])


@kernel
def _polynomial(p, terms, x):
    """Evaluate a polynomial and its first two derivatives at x."""
    value = slope = bend = 0.0
    for k in range(terms - 1, -1, -1):
        bend = bend * x + 2.0 * slope
        slope = slope * x + value
        value = value * x + p[k]
    return value, slope, bend


@kernel
def _derivative_bounds(p, terms):
    """Bounds over [0, 1] on the moduli of the second and third derivative of a polynomial."""
    second = third = 0.0
    for k in range(2, terms):
        size = k * (k - 1.0) * abs(p[k])
        second += size
        third += (k - 2.0) * size
    return second, third


@kernel
def _turning_point(p, terms, low, high, slope_low):
    """Return (value, x) at the only turning point of a polynomial in [low, high], by safeguarded Newton
    iteration.
    """
    x = 0.5 * (low + high)
    while True:
        value, slope, bend = _polynomial(p, terms, x)
        if slope * slope_low > 0.0:
            low = x
        else:
            high = x
        new = x - slope / bend if bend != 0.0 else low - 1.0
        if abs(new - x) < _NEXT or high - low < _SHORTEST * _NEXT:
            return value, min(max(new, low), high)
        x = new if low < new < high else 0.5 * (low + high)


@kernel
def _largest_modulus(p, terms, begin, end, opens, closes, most):
    """Return (value, x) of the largest modulus of a polynomial over [begin, end] above `most`; value 0 if
    there is none.

    Ends of the segment count where the modulus falls from them or rises to them.  Other nodes do not count:
    next to a turning point their modulus is the same to rounding, at a different time.

    An interval of length l exceeds its larger end by at most l^2/8 max |p''|.  It holds no turning point
    where the slopes at its ends differ by less than a turning point requires, and at most one where the
    second derivative keeps its sign.

    Parameters
    ----------
    p : (terms,) coefficients
    terms : number of coefficients
    begin, end : interval, within [0, 1] except for the overlap
    opens, closes : whether the segment begins or ends in this interval
    most : modulus to exceed
    """
    second, third = _derivative_bounds(p, terms)
    best, x_best = 0.0, begin
    a, length = begin, end - begin
    value_a, slope_a, bend_a = _polynomial(p, terms, begin)
    if opens and value_a * slope_a <= 0.0 and abs(value_a) > most:
        best, most = value_a, abs(value_a)
    while a < end:
        b = min(a + length, end)
        value, slope, bend = _polynomial(p, terms, b)
        size = b - a
        low = max(abs(value_a), abs(value)) + 0.125 * size * size * second <= most
        straight = slope_a * slope > 0.0 and abs(slope_a) + abs(slope) >= size * second
        if not (low or straight or second == 0.0):
            bent = bend_a * bend > 0.0 and abs(bend_a) + abs(bend) > size * third
            if not bent and size > _SHORTEST:
                length = 0.5 * size
                continue
            if slope_a * slope <= 0.0:
                turn, x = _turning_point(p, terms, a, b, slope_a)
                if abs(turn) > most:
                    best, x_best, most = turn, x, abs(turn)
        a, value_a, slope_a, bend_a = b, value, slope, bend
        length = end - a
    if closes and value_a * slope_a >= 0.0 and abs(value_a) > most:
        best, x_best = value_a, end
    return best, x_best
