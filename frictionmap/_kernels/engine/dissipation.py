"""Sliding distance, and work of the dampers, of a steady state."""

import math
from typing import NamedTuple

import numpy as np

from ..compiler import kernel
from ..structure.oscillators import advance, expand
from ..structure.state import FEEDTHROUGH_COS, FEEDTHROUGH_SIN, contact_displacement
from .segment_table import COS, LENGTH, SENSE, SIN, Z_END, take_start


@kernel
def sliding_distance(st, table, work):
    """Distance that the contact slides in the segments of a table."""
    total = 0.0
    for k in range(table.shape[0]):
        if table[k, SENSE] > 0.0:
            _, _, state = take_start(st, table[k], work)
            total += abs(table[k, Z_END] - contact_displacement(st, state, table[k, COS], table[k, SIN]))
    return total


class Dampers(NamedTuple):
    """Damping of the participating modes as k dashpots; velocities in t = tau/r."""

    weights: np.ndarray  # (k,) power over velocity squared
    displacement: np.ndarray  # (k, 2n) rows map the free oscillators (q, p) to dashpot displacements
    free: np.ndarray  # (k, 2n) rows map them to dashpot velocities
    held: np.ndarray  # (k, 2m) rows map the held oscillators to dashpot velocities
    base: np.ndarray  # (k,) share of the base motion in each dashpot's displacement


@kernel
def _speed(st, dampers, slides, i, c, s, series, out):
    """Compute the Taylor coefficients of the i-th dashpot's velocity in tau over a scan step.

    Parameters
    ----------
    st : StructureAtFrequency
    dampers : Dampers; i : index of the dashpot
    slides : whether the segment is a slide
    c, s : cosine and sine of the load phase at the start of the step
    series : (terms + 1, n) Taylor coefficients of the oscillators
    out : (terms,) filled with the coefficients
    """
    n, m = st.n, st.m
    rows = dampers.free if slides else dampers.held
    count = n if slides else m
    yc, ys = 0.0, -dampers.base[i]
    for k in range(count):
        rate = rows[i, count + k]
        yc -= rate * (st.modes[FEEDTHROUGH_COS, k] if slides else st.held_feedthrough[0, k]) / st.r
        ys -= rate * (st.modes[FEEDTHROUGH_SIN, k] if slides else st.held_feedthrough[1, k]) / st.r
    c_j, s_j = c, s
    c_next, s_next = -s * st.h, c * st.h
    for j in range(st.terms):
        out[j] = yc * c_j + ys * s_j
        fall = -st.h * st.h / ((j + 1.0) * (j + 2.0))
        c_j, c_next = c_next, fall * c_j
        s_j, s_next = s_next, fall * s_j
    for k in range(count):
        share, rate = rows[i, k], rows[i, count + k]
        if share != 0.0 or rate != 0.0:
            for j in range(st.terms):
                out[j] += share * series[j, k] / st.r
                out[j] += rate * ((j + 1.0) * series[j + 1, k] / st.h)


@kernel
def integral_of_square(p, terms, last):
    """Integral of the square of a polynomial over [0, last]."""
    total, power = 0.0, last
    for j in range(2 * terms - 1):
        pairs = 0.0
        for k in range(max(0, j - terms + 1), min(j + 1, terms)):
            pairs += p[k] * p[j - k]
        total += pairs * power / (j + 1.0)
        power *= last
    return total


@kernel
def viscous_work(st, beta, dampers, table, work, scratch):
    """Work of the dampers of the participating modes: the sum of weight r int velocity^2 dtau over the table.

    It is integrated along the motion, independently of the energy balance, which can therefore check it.
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
            for i in range(dampers.weights.size):
                _speed(st, dampers, slides, i, c, s, scratch.series, scratch.watched)
                rate = dampers.weights[i] * st.r
                total += rate * st.h * integral_of_square(scratch.watched, st.terms, last)
            advance(scratch.series, n, st.terms, last, state)
    return total
