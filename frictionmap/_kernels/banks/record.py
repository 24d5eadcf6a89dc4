"""Extremes, works and distances of a steady motion, and its steps."""

import numpy as np

from ..compiler import kernel
from ..general.crossings import NONE, first_zero, next_turn, value_at
from ..general.problem import LONG, TERMS, WIDTH
from .step import friction


@kernel
def clear_record(record):
    """Begin a record."""
    for k in range(record.low.size):
        record.low[k], record.high[k] = np.inf, -np.inf
    for j in range(record.work.size):
        record.work[j] = record.distance[j] = 0.0
    record.count[0] = 0


@kernel
def _widen(record, at, value):
    """Take a value into a range."""
    record.low[at] = min(record.low[at], value)
    record.high[at] = max(record.high[at], value)


@kernel
def _take_range(watch, record, end, into):
    """Take the extremes of the series in the first row up to `end` into a range; the others are scratch."""
    _widen(record, into, watch[0, 0])
    _widen(record, into, value_at(watch, 0, end))
    first = 1
    while first < TERMS and watch[0, first] == 0.0:
        first += 1
    if first == TERMS:
        return
    sign = 1.0 if watch[0, first] > 0.0 else -1.0
    for k in range(WIDTH):
        at = k + first
        watch[1, k] = sign * at * watch[0, at] if at < LONG and k < TERMS else 0.0
    x = first_zero(watch, 1)
    while x < end:
        _widen(record, into, value_at(watch, 0, x))
        sign = -sign
        x = next_turn(watch, 0, x, sign, watch, 1) if x > 0.0 else NONE


@kernel
def _record_rows(problem, motion, count, end):
    """Take the extremes of the rows observed."""
    for n in range(problem.observed.shape[0]):
        for k in range(WIDTH):
            total = 0.0
            if k < count:
                for i in range(problem.squares.size):
                    total += problem.observed[n, i] * motion.moves[k, i]
            motion.watch[0, k] = total
        _take_range(motion.watch, motion.record, end, n)


@kernel
def _keep_step(problem, cell, motion, tau, length, count, end):
    """Keep the terms of a step; arguments as of `record_step`.

    Parameters
    ----------
    problem, cell, motion : Problem, Cell, Motion
    tau, length, count, end : see `record_step`
    """
    record, modes, contacts = motion.record, problem.squares.size, problem.moved.size
    at = record.count[0]
    record.count[0] = at + 1
    if at >= record.steps.shape[0]:
        return
    for k in range(LONG):
        for i in range(modes):
            record.steps[at, k, i] = motion.moves[k, i] if k < count else 0.0
        for j in range(contacts):
            rank = problem.first[j] + j + motion.now.level[j]
            record.steps[at, k, modes + j] = problem.left[rank] * motion.z[j, k] if k < count else 0.0
    for j in range(contacts):
        record.steps[at, 0, modes + j] = friction(problem, cell, motion, j, motion.z[j, 0])
        record.patterns[at, j] = motion.now.level[j]
        record.patterns[at, contacts + j] = motion.now.sense[j]
    record.times[at, 0], record.times[at, 1], record.times[at, 2] = tau, length, end


@kernel
def record_step(problem, cell, motion, tau, length, count, end):
    """Record the present step.

    Parameters
    ----------
    problem, cell, motion : Problem, Cell, Motion with the series of the step
    tau, length, count : phase at its beginning, length and number of terms of the series
    end : part x of it that is the step
    """
    record, rows = motion.record, problem.observed.shape[0]
    _record_rows(problem, motion, count, end)
    for j in range(problem.moved.size):
        before, after = motion.z[j, 0], value_at(motion.z, j, end)
        _widen(record, rows + j, before)
        _widen(record, rows + j, after)
        if motion.now.level[j] > 0:
            way = abs(after - before)
            record.work[j] += cell.slid[problem.first[j] + j + motion.now.level[j]] * way
            record.distance[j] += way
    _keep_step(problem, cell, motion, tau, length, count, end)
