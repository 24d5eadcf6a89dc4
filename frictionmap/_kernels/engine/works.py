"""Sliding distance and the work of the dampers in a steady state, from its table of phases."""

import math

from ..jit import kernel
from ..structure.oscillators import advance, expand
from ..structure.state import DAMPING, W, place
from .phase_table import COS, LENGTH, SENSE, SIN, Z_END, take_start


@kernel
def sliding_distance(st, table, work):
    """The way that the contact slides in a table of phases."""
    total = 0.0
    for k in range(table.shape[0]):
        if table[k, SENSE] > 0.0:
            _, _, state = take_start(st, table[k], work)
            total += abs(table[k, Z_END] - place(st, state))
    return total


@kernel
def _speed(st, base, slides, i, c, s, series, out):
    """Coefficients over a scan step of q_i' in tau, and of what the dampers see of the base beside it."""
    n, m = st.n, st.m
    yc, ys = 0.0, -base[i]
    if not slides:
        for k in range(m):
            yc -= st.to_free[n + i, m + k] * st.direct[0, k] / st.r
            ys -= st.to_free[n + i, m + k] * st.direct[1, k] / st.r
    c_j, s_j = c, s
    c_next, s_next = -s * st.h, c * st.h
    for j in range(st.terms):
        total = yc * c_j + ys * s_j
        if slides:
            total += (j + 1.0) * series[j + 1, i] / st.h
        else:
            for k in range(m):
                total += st.to_free[n + i, k] * series[j, k] / st.r
                total += st.to_free[n + i, m + k] * ((j + 1.0) * series[j + 1, k] / st.h)
        out[j] = total
        fall = -st.h * st.h / ((j + 1.0) * (j + 2.0))
        c_j, c_next = c_next, fall * c_j
        s_j, s_next = s_next, fall * s_j


@kernel
def integral_of_square(p, terms, last):
    """int p^2 over [0, last] of a polynomial."""
    total, power = 0.0, last
    for j in range(2 * terms - 1):
        pairs = 0.0
        for k in range(max(0, j - terms + 1), min(j + 1, terms)):
            pairs += p[k] * p[j - k]
        total += pairs * power / (j + 1.0)
        power *= last
    return total


@kernel
def viscous_work(st, beta, base, table, work, scratch):
    """The work of the dampers of the modes that the contact sees, sum of 2 zeta w r int q'^2 over the table.

    Integrated along the motion, so that the balance of works is a test of it.
    base : (n,) share of the base's velocity in what the dampers see
    """
    total = 0.0
    for k in range(table.shape[0]):
        row = table[k]
        slides, n, state = take_start(st, row, work)
        oscillators = st.free if slides else st.held
        angle = math.atan2(row[SIN], row[COS])
        for step in range(int(math.ceil(row[LENGTH] / st.h))):
            last = min(1.0, row[LENGTH] / st.h - step)
            c, s = math.cos(angle + step * st.h), math.sin(angle + step * st.h)
            expand(oscillators, n, beta if slides else 0.0, state, c, s, st.h, st.terms, scratch.series)
            for i in range(st.n):
                _speed(st, base, slides, i, c, s, scratch.series, scratch.watched)
                rate = 2.0 * st.modes[DAMPING, i] * st.modes[W, i] * st.r
                total += rate * st.h * integral_of_square(scratch.watched, st.terms, last)
            advance(scratch.series, n, st.terms, last, state)
    return total
