"""Periodic orbits of a structure: Newton's method on its return map, with the exact derivative.

The map takes the state in the middle of an upward slide to the state at the same load phase some half periods
later (mirrored after an odd number).  Its derivative is linear flow between events and a jump (saltation) at
each event: a stop removes the contact's share of the velocities; a turn, or the end of a stop, adds the jump
of the friction force times the time shift of the event.
"""

import math
from typing import NamedTuple

import numpy as np

from ..closed_form import decay
from ..compiler import entry, inner_kernel, kernel
from ..compiler.vectors import LANES, filled, load, store
from ..event_codes import GRAZING, REVERSE, STOP_THEN_BACK, STOP_THEN_ON, STUCK
from ..newton_limits import MAX_NEWTON, NEAR_END, ROUNDING_OF_MANY, next_step_negligible
from .events import NO_RELEASE, UNDER_WAY, after_slide, slide_on
from .oscillators import AT_LIMIT, COLUMNS, FELL, OMEGA, OW, OZ, ZETA, make_state, padded
from .state import PUSH, SPEED, SPEED_RATE, STATIC_SHAPE, Z_RATE, Z, energy

#: Largest number of events recorded by `follow_events`.
LONGEST_SEQUENCE = 64

#: Columns of `Workspace.anchored`: half periods per recurrence (0: no orbit), load phase, sign of the slide,
#: number of slides, beta, and beta of the previous orbit, NaN if that is anchored at another phase.
HALVES, PHASE_COS, PHASE_SIN, SIDE, SLIDES, BETA, EARLIER_BETA = 0, 1, 2, 3, 4, 5, 6
ANCHORED = 7

_TURN = 2.0 * math.pi


class Workspace(NamedTuple):
    """Work arrays of the kernels, for n free modes and m held oscillators."""

    held: np.ndarray  # (2, padded(m)) state in a stop
    middle: np.ndarray  # (2, padded(n)) unknown of Newton's method
    moved: np.ndarray  # (2, padded(n)) its image under the return map
    flow: np.ndarray  # (2n, padded(2n)) derivative of the state with respect to the unknown
    stopped: np.ndarray  # (2m + 1, padded(2n)) derivative of the held state in a stop; last row: of z
    square: np.ndarray  # (2n, 2n)
    step: np.ndarray  # (2n,)
    start: np.ndarray  # (2, padded(n)) first guess of Newton's method
    anchor: np.ndarray  # (2, padded(n))
    table: np.ndarray  # (n + 1, COLUMNS)
    events: np.ndarray  # (LONGEST_SEQUENCE,) event codes of a sequence
    trial: np.ndarray  # (2, padded(n))
    solved: np.ndarray  # (2, padded(n)) middle of a slide of the orbit solved for last
    earlier: np.ndarray  # (2, padded(n)) middle of a slide of the orbit before that
    anchored: np.ndarray  # (ANCHORED,)


@entry
def make_workspace(n):
    """Allocate a workspace for n free modes."""
    m = n - 1
    return Workspace(
        make_state(m), make_state(n), make_state(n), np.zeros((2 * n, padded(2 * n))),
        np.zeros((2 * m + 1, padded(2 * n))), np.zeros((2 * n, 2 * n)), np.zeros(2 * n),
        make_state(n), make_state(n), np.zeros((n + 1, COLUMNS)), np.zeros(LONGEST_SEQUENCE),
        make_state(n), make_state(n), make_state(n), np.zeros(ANCHORED),
    )  # fmt: skip


@kernel
def copy_state(source, target, n):
    """Copy a (2, n) state."""
    for i in range(n):
        target[0, i] = source[0, i]
        target[1, i] = source[1, i]


@kernel
def free_motion(table, n, time, rows, columns):
    """Propagate derivatives by the free motion of n oscillators over `time` in t = tau/r.

    Row i holds a coordinate, row n + i its velocity in t; `columns` is a multiple of LANES.
    """
    width = rows.shape[1]
    for i in range(n):
        omega = table[i, OMEGA]
        q, e = decay(table[i, ZETA], omega * time)
        d = e + 2.0 * table[i, ZETA] * q
        q_over = q / omega
        q_times = q * omega
        for first in range(0, columns, LANES):
            of_z, of_v = i * width + first, (n + i) * width + first
            z = load(rows, of_z)
            v = load(rows, of_v)
            store(d * z + q_over * v, rows, of_z)
            store(e * v - q_times * z, rows, of_v)


@inner_kernel
def _at_contact(st, coordinate_row, rate, rows, first):
    """Eight columns of derivatives at the contact, by two rows of `st.modes`: Z or SPEED, and its rate."""
    n, width = st.n, rows.shape[1]
    out = filled(0.0)
    for i in range(n):
        out = out + st.modes[coordinate_row, i] * load(rows, i * width + first)
        out = out + st.modes[rate, i] * load(rows, (n + i) * width + first)
    return out


@inner_kernel
def _kick(st, share, flow, first):
    """Subtract `share` of an impulse at the contact from the velocities of eight columns."""
    n, width = st.n, flow.shape[1]
    for i in range(n):
        place = (n + i) * width + first
        store(load(flow, place) - st.modes[PUSH, i] * share, flow, place)


@inner_kernel
def _into_stop(st, flow, stopped, first):
    """Derivatives of the held state at the start of a stop, and of z, from those of the free state."""
    n, m, width = st.n, st.m, flow.shape[1]
    z = _at_contact(st, Z, Z_RATE, flow, first)
    store(z, stopped, 2 * m * width + first)
    for k in range(2 * m):
        of_k = k if k < m else padded(m) - m + k
        out = filled(0.0)
        for i in range(n):
            a = st.into_held[i, of_k]
            b = st.into_held[n + i, of_k]
            u = load(flow, i * width + first)
            v = load(flow, (n + i) * width + first)
            out = out + (a * u + b * v - (a * st.modes[STATIC_SHAPE, i]) * z)
        store(out, stopped, k * width + first)


@inner_kernel
def _out_of_stop(st, flow, stopped, first):
    """Derivatives of the free state at the end of a stop, from those of the held state and of z; return
    those of the load.
    """
    n, m, width = st.n, st.m, flow.shape[1]
    z = load(stopped, 2 * m * width + first)
    pull = st.stiffness * z
    for k in range(m):
        y = load(stopped, k * width + first)
        p = load(stopped, (m + k) * width + first)
        pull = pull + (st.held[k, OZ] * y + (st.held[k, OW] / st.rate) * p)
    for i in range(2 * n):
        of_i = i if i < n else padded(n) - n + i
        out = (st.modes[STATIC_SHAPE, i] if i < n else 0.0) * z
        for k in range(2 * m):
            out = out + st.into_free[k, of_i] * load(stopped, k * width + first)
        store(out, flow, i * width + first)
    return pull


@kernel
def through_event(st, beta, mu_beta, code, contact_load, wait, slope, flow, stopped, columns):
    """Propagate the derivative through an event that ended an upward slide; see `events.after_slide`.

    Parameters
    ----------
    st : StructureAtFrequency
    beta, mu_beta : kinetic and static friction force
    code : event code
    contact_load : load in the contact at the end of the slide
    wait : duration of the stop in tau
    slope : dload/dx at the end of the stop
    flow : (2n, width) derivative of the state, updated
    stopped : (2m + 1, width) work array, the derivative during the stop
    columns : number of columns that are used, a multiple of LANES
    """
    # a stop removes the contact's velocity, a turn 2 beta/(load + beta) of it
    share = (2.0 * beta / (contact_load + beta) if code == REVERSE else 1.0) / st.inverse_mass
    for first in range(0, columns, LANES):
        _kick(st, share * _at_contact(st, SPEED, SPEED_RATE, flow, first), flow, first)
    if code != REVERSE:
        for first in range(0, columns, LANES):
            _into_stop(st, flow, stopped, first)
        free_motion(st.held, st.m, wait / st.r, stopped, columns)
        # the stop ends where the load reaches mu beta: earlier by the excess of the load over its rate
        jump = (mu_beta - beta) / (slope * st.rate)
        if code == STOP_THEN_ON:
            jump = -jump
        for first in range(0, columns, LANES):
            _kick(st, jump * _out_of_stop(st, flow, stopped, first), flow, first)
    if code == REVERSE or code == STOP_THEN_BACK:
        for i in range(2 * st.n):
            for first in range(i * flow.shape[1], i * flow.shape[1] + columns, LANES):
                store(-1.0 * load(flow, first), flow, first)


@kernel
def return_map(st, beta, mu_beta, state, c, s, sequence, halves, derive, work, scratch):
    """Follow the state for `halves` half periods through a sequence of events, in place.

    Parameters
    ----------
    st : StructureAtFrequency
    beta, mu_beta : kinetic and static friction force
    state : (2, n) state within a slide; replaced by the state after `halves` half periods
    c, s : cosine and sine of its load phase
    sequence : EventSequence
    halves : half periods of the excitation
    derive : whether to fill work.flow with the derivative
    work, scratch : Workspace, Scratch

    Returns
    -------
    bool : whether the events fit the sequence
    """
    columns = work.flow.shape[1]
    if derive:
        for i in range(2 * st.n):
            for j in range(columns):
                work.flow[i, j] = 1.0 if i == j else 0.0
    whole = math.pi * halves
    limit = whole / st.h + 1.0
    c0, s0 = c, s
    odd = halves % 2 == 1
    mirrored = False
    time = 0.0
    contact_force = UNDER_WAY
    events = sequence.events
    for m in range(sequence.count):
        n, end, c, s, _ = slide_on(st, beta, contact_force, state, c, s, limit, scratch)
        if end != FELL:
            return False
        time += n * st.h
        if derive:
            free_motion(st.free, st.n, n * st.h / st.r, work.flow, columns)
        code, c, s, contact_force, wait, pull, slope = after_slide(
            st, beta, mu_beta, state, work.held, c, s, whole, scratch
        )
        if code != int(events[(sequence.first + m) % events.size]):
            return False
        if not (code == REVERSE or code == STOP_THEN_BACK or code == STOP_THEN_ON):
            return False
        time += wait
        if code != STOP_THEN_ON:
            mirrored = not mirrored
        if derive:
            through_event(st, beta, mu_beta, code, pull, wait, slope, work.flow, work.stopped, columns)
    if mirrored != odd:
        return False
    # the remaining time, as exactly as the load phase gives it
    remaining = math.atan2(s0 * c - c0 * s, c0 * c + s0 * s)
    remaining += _TURN * math.floor((whole - time - remaining) / _TURN + 0.5)
    if not remaining > 0.0:
        return False
    n, end, c, s, _ = slide_on(st, beta, contact_force, state, c, s, remaining / st.h, scratch)
    if end != AT_LIMIT:
        return False
    if derive:
        free_motion(st.free, st.n, remaining / st.r, work.flow, columns)
    return True


@kernel
def follow_events(st, beta, mu_beta, state, c, s, halves, work, scratch):
    """Follow the motion for `halves` half periods and record its events in work.events.

    Parameters
    ----------
    st : StructureAtFrequency
    beta, mu_beta : kinetic and static friction force
    state : (2, n) state within a slide; replaced by the final state
    c, s : cosine and sine of its load phase
    halves : half periods of the excitation
    work, scratch : Workspace, Scratch

    Returns
    -------
    int : number of events; 0 if there are too many, or if they do not lead back into a slide in the same
        direction (mirrored after an odd number of half periods)
    """
    whole = math.pi * halves
    mirrored = False
    time = 0.0
    contact_force = UNDER_WAY
    count = 0
    while True:
        n, end, c, s, _ = slide_on(st, beta, contact_force, state, c, s, (whole - time) / st.h, scratch)
        time += n * st.h
        if end == AT_LIMIT:
            return count if mirrored == (halves % 2 == 1) else 0
        if end != FELL or count == work.events.size:
            return 0
        code, c, s, contact_force, wait, _, _ = after_slide(
            st, beta, mu_beta, state, work.held, c, s, whole, scratch
        )
        time += wait
        if code == GRAZING or code == STUCK or code == NO_RELEASE or not time < whole:
            return 0
        if code != STOP_THEN_ON:
            mirrored = not mirrored
        work.events[count] = code
        count += 1


@kernel
def solve_linear(matrix, right, n):
    """Solve matrix x = right in place, x in `right`; False if the matrix is singular."""
    for k in range(n):
        pivot = k
        for i in range(k + 1, n):
            if abs(matrix[i, k]) > abs(matrix[pivot, k]):
                pivot = i
        if matrix[pivot, k] == 0.0 or matrix[pivot, k] != matrix[pivot, k]:
            return False
        if pivot != k:
            for j in range(n):
                matrix[k, j], matrix[pivot, j] = matrix[pivot, j], matrix[k, j]
            right[k], right[pivot] = right[pivot], right[k]
        for i in range(k + 1, n):
            factor = matrix[i, k] / matrix[k, k]
            if factor != 0.0:
                for j in range(k, n):
                    matrix[i, j] -= factor * matrix[k, j]
                right[i] -= factor * right[k]
    for k in range(n - 1, -1, -1):
        for j in range(k + 1, n):
            right[k] -= matrix[k, j] * right[j]
        right[k] /= matrix[k, k]
    return True


@kernel
def newton_step(st, beta, mu_beta, c, s, sequence, halves, work, scratch):
    """Compute a Newton step from work.middle, into work.moved.

    Parameters
    ----------
    st : StructureAtFrequency
    beta, mu_beta : kinetic and static friction force
    c, s : cosine and sine of the load phase of work.middle
    sequence : EventSequence of one recurrence
    halves : half periods of one recurrence
    work, scratch : Workspace, Scratch; work.middle is the (2, n) state

    Returns
    -------
    (size, miss) : energy norms of the step, infinite if there is none, and of the difference after one
        recurrence
    """
    n = st.n
    size = 2 * n
    copy_state(work.middle, work.moved, n)
    if not return_map(st, beta, mu_beta, work.moved, c, s, sequence, halves, True, work, scratch):
        return math.inf, 0.0
    for i in range(n):
        work.moved[0, i] -= work.middle[0, i]
        work.moved[1, i] -= work.middle[1, i]
        work.step[i] = work.moved[0, i]
        work.step[n + i] = work.moved[1, i] * st.rate
    miss = energy(st, work.moved)
    for i in range(size):
        for j in range(size):
            work.square[i, j] = (1.0 if i == j else 0.0) - work.flow[i, j]
    if not solve_linear(work.square, work.step, size):
        return math.inf, miss
    for i in range(n):
        work.moved[0, i] = work.step[i]
        work.moved[1, i] = work.step[n + i] / st.rate
    return energy(st, work.moved), miss


@kernel
def solve_return(st, beta, mu_beta, c, s, sequence, halves, tolerance, work, scratch):
    """Solve the return map for its fixed point by Newton's method.

    Parameters
    ----------
    st : StructureAtFrequency
    beta, mu_beta : kinetic and static friction force
    c, s : cosine and sine of the load phase of work.middle
    sequence : EventSequence of one recurrence
    halves : half periods of one recurrence
    tolerance : largest Newton step, relative to the motion
    work, scratch : Workspace, Scratch; work.middle is the first guess and becomes the solution, (2, n)

    Returns
    -------
    bool : whether a solution was found
    """
    n = st.n
    last = math.inf
    for _ in range(MAX_NEWTON):
        move, miss = newton_step(st, beta, mu_beta, c, s, sequence, halves, work, scratch)
        if not move < math.inf:
            return False
        scale = energy(st, work.middle)
        if move <= tolerance * scale and move >= 0.5 * last:
            return True  # converged to rounding
        if move > 0.25 * last and tolerance * scale < move < NEAR_END * scale:
            return False  # not quadratic: the map only touches the identity there
        for i in range(n):
            work.middle[0, i] += work.moved[0, i]
            work.middle[1, i] += work.moved[1, i]
        if move <= ROUNDING_OF_MANY * scale or next_step_negligible(move, last, miss, scale, tolerance):
            return True
        last = move
    return False
