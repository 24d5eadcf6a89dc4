"""Extremes, works and distances of a steady motion, and its steps."""

import numpy as np

from ..compiler import kernel
from ..general.crossings import NONE, first_zero, next_turn, value_at
from ..general.problem import LONG, TERMS
from .problem import ELASTIC, SMOOTH, D, F, W, Z, observed_row, watch_row
from .series import is_held, spring_force

#: Gauss points in [0, 1] and their weights: products of two series of TERMS terms are integrated to rounding,
#: whose terms beyond the 32nd are negligible.
_LEGENDRE = np.polynomial.legendre.leggauss(16)
_NODES = 0.5 * (_LEGENDRE[0] + 1.0)
_WEIGHTS = 0.5 * _LEGENDRE[1]


@kernel
def clear_record(record):
    """Begin a record."""
    for k in range(record.low.size):
        record.low[k], record.high[k] = np.inf, -np.inf
    for j in range(record.work.size):
        record.work[j] = record.belt_work[j] = record.distance[j] = 0.0
    for s in range(record.spring_force.size):
        record.spring_force[s] = 0.0
    record.count[0] = 0


@kernel
def _widen(record, at, value):
    """Take a value into a range."""
    record.low[at] = min(record.low[at], value)
    record.high[at] = max(record.high[at], value)


@kernel
def _range_of(problem, motion, at, end, into):
    """Take the extremes of a series in a step into a range: its ends, and where its slope is zero."""
    series, record, row = motion.series, motion.record, watch_row(problem)
    _widen(record, into, series[at, 0])
    _widen(record, into, value_at(series, at, end))
    first = 1
    while first < TERMS and series[at, first] == 0.0:
        first += 1
    if first == TERMS:
        return
    sign = 1.0 if series[at, first] > 0.0 else -1.0
    for k in range(TERMS):
        series[row, k] = sign * (k + first) * series[at, k + first] if k + first < LONG else 0.0
    series[row, TERMS] = 0.0
    x = first_zero(series, row)
    while x < end:
        _widen(record, into, value_at(series, at, x))
        sign = -sign
        x = next_turn(series, at, x, sign, series, row) if x > 0.0 else NONE


@kernel
def integral_of_product(series, a, b, end):
    """Integral over [0, end] of the product of two series."""
    sum_ = 0.0
    for i in range(_NODES.size):
        x = end * _NODES[i]
        sum_ += _WEIGHTS[i] * value_at(series, a, x) * value_at(series, b, x)
    return end * sum_


@kernel
def _put_contact(problem, row, cell, motion, j, end):
    """Add the works and the distance of a contact in a step, and its normal force to the range."""
    contacts, series, record = problem.law.size, motion.series, motion.record
    z, w, f = Z * contacts + j, W * contacts + j, F * contacts + j
    rows = problem.observed.shape[0]
    _range_of(problem, motion, z, end, rows + j)
    if motion.open[j] != 0:
        _widen(record, rows + contacts + j, 0.0)
    elif problem.presses[j]:
        at = watch_row(problem) + 1
        for k in range(LONG):
            series[at, k] = problem.pressed[j] * series[D * contacts + j, k]
        series[at, 0] += cell.preload[j]
        _range_of(problem, motion, at, end, rows + contacts + j)
    else:
        _widen(record, rows + contacts + j, cell.preload[j])
    if motion.open[j] != 0 or problem.law[j] == SMOOTH:
        return
    elastic, held = problem.law[j] == ELASTIC, is_held(problem, motion, j)
    if held and not elastic and row.belt[j] == 0.0 and problem.moved[j] == 0.0:
        return
    record.work[j] += integral_of_product(series, f, w, end)
    if row.belt[j] != 0.0:
        total = 0.0
        for k in range(TERMS - 1, -1, -1):
            total = total * end + series[f, k] / (k + 1.0)
        record.belt_work[j] -= total * end * row.belt[j]
    if not held:
        way = value_at(series, z, end) - series[z, 0] - row.belt[j] * end
        if elastic:
            way -= (value_at(series, f, end) - series[f, 0]) / problem.spring[j]
        record.distance[j] += abs(way)


@kernel
def _keep_step(problem, motion, tau, end):
    """Keep the terms of a step."""
    record, modes = motion.record, problem.squares.size
    k, contacts = record.count[0], problem.law.size
    if k < record.steps.shape[0]:
        for n in range(LONG):
            for i in range(modes):
                record.steps[k, n, i] = motion.terms.moves[n, i]
            for j in range(contacts):
                record.steps[k, n, modes + j] = motion.terms.force[n, j] if n < TERMS else 0.0
        record.steps[k, LONG, 0] = tau
        record.steps[k, LONG, 1] = end
        for j in range(contacts):
            record.patterns[k, j] = motion.sense[j]
            record.patterns[k, contacts + j] = motion.open[j]
        for s in range(motion.piece.size):
            record.patterns[k, 2 * contacts + s] = motion.piece[s]
    record.count[0] = k + 1


@kernel
def record_step(problem, row, cell, motion, tau, end):
    """Record the present step from its beginning at tau to x = end; the series are there, all of them."""
    record, contacts = motion.record, problem.law.size
    rows, springs = problem.observed.shape[0], problem.along.shape[0]
    first = observed_row(problem)
    for k in range(rows):
        _range_of(problem, motion, first + springs + k, end, k)
    for j in range(contacts):
        _put_contact(problem, row, cell, motion, j, end)
    for s in range(springs):
        at = rows + 2 * contacts + s
        low, high = record.low[at], record.high[at]
        record.low[at], record.high[at] = np.inf, -np.inf
        _range_of(problem, motion, first + s, end, at)
        for stretched in (record.low[at], record.high[at]):
            force = abs(spring_force(problem, s, motion.piece[s], stretched))
            record.spring_force[s] = max(record.spring_force[s], force)
        record.low[at], record.high[at] = min(low, record.low[at]), max(high, record.high[at])
    _keep_step(problem, motion, tau, end)
