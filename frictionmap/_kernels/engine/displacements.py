"""The largest displacements of the masses in a steady state, from its table of phases."""

import math
from typing import NamedTuple

import numpy as np

from ..jit import entry, kernel
from ..structure.oscillators import advance, expand
from .phase_table import COS, LENGTH, PLACE, SIN, take_start


class Shapes(NamedTuple):
    """Displacements of the masses."""

    free: np.ndarray  # (n_dof, n) of the free modes
    held: np.ndarray  # (n_dof, 2m) of the held oscillators (y, p)
    lift: np.ndarray  # (n_dof,) of a unit displacement of the contact


@kernel
def _of_mass(st, shapes, mass, slides, i, n):
    """What a mass has of the i-th oscillator's coordinate and of its change in a step."""
    if slides:
        return shapes.free[mass, i], 0.0
    return shapes.held[mass, i], shapes.held[mass, n + i] * st.rate


@entry
def largest_displacements(st, beta, shapes, re, im, table, out, work, scratch):
    """max |x_k| of every mass over the table's phases, `out` (n_dof,).

    re, im : (n_dof,) phasor of what moves with the load alone: modes that the contact does not see, the base.

    Every scan step in which a mass turns is searched, by Newton's method on the series; `st` with fine
    steps, so that no mass turns twice in one.
    """
    for mass in range(out.size):
        out[mass] = 0.0
    h = st.h
    terms = st.terms
    watched = scratch.watched
    for k in range(table.shape[0]):
        row = table[k]
        slides, n, current = take_start(st, row, work)
        oscillators = st.free if slides else st.held
        force = beta if slides else 0.0
        level = 0.0 if slides else row[PLACE]
        angle = math.atan2(row[SIN], row[COS])
        steps = int(math.ceil(row[LENGTH] / h))
        for step in range(steps):
            last = min(1.0, row[LENGTH] / h - step)
            c, s = math.cos(angle + step * h), math.sin(angle + step * h)
            expand(oscillators, n, force, current, c, s, h, terms, scratch.series)
            for mass in range(out.size):
                yc, ys = re[mass], -im[mass]
                offset = 0.0
                if not slides:
                    offset = shapes.lift[mass] * level
                    for i in range(n):
                        yc -= shapes.held[mass, n + i] * st.direct[0, i]
                        ys -= shapes.held[mass, n + i] * st.direct[1, i]
                c_k, s_k = c, s
                c_next, s_next = -s * h, c * h
                for j in range(terms):
                    total = yc * c_k + ys * s_k
                    for i in range(n):
                        oz, ow = _of_mass(st, shapes, mass, slides, i, n)
                        total += oz * scratch.series[j, i] + ow * ((j + 1.0) * scratch.series[j + 1, i])
                    watched[j] = total
                    fall = -h * h / ((j + 1.0) * (j + 2.0))
                    c_k, c_next = c_next, fall * c_k
                    s_k, s_next = s_next, fall * s_k
                watched[0] += offset
                out[mass] = max(out[mass], _largest(watched, terms, last))
            advance(scratch.series, n, terms, last, current)


@kernel
def _at(p, terms, x):
    """A polynomial, its slope and its bend at x."""
    value = slope = bend = 0.0
    for k in range(terms - 1, -1, -1):
        bend = bend * x + 2.0 * slope
        slope = slope * x + value
        value = value * x + p[k]
    return value, slope, bend


@kernel
def _largest(p, terms, last):
    """Largest modulus over [0, last] of a polynomial that turns once there, or not at all."""
    left, slope0, _ = _at(p, terms, 0.0)
    right, slope1, _ = _at(p, terms, last)
    best = max(abs(left), abs(right))
    if slope0 * slope1 < 0.0:
        low, high = 0.0, last
        x = last * slope0 / (slope0 - slope1)
        for _ in range(60):
            value, slope, bend = _at(p, terms, x)
            best = max(best, abs(value))
            if slope * slope0 > 0.0:
                low = x
            else:
                high = x
            new = x - slope / bend if bend != 0.0 else 0.5 * (low + high)
            if not low < new < high:
                new = 0.5 * (low + high)
            if abs(new - x) < 1e-9:  # an extreme is flat: what is left is of second order
                break
            x = new
    return best
