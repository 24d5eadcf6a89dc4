"""A steady state of a structure in time: its phases, samples along them, the largest displacements."""

import math
from typing import NamedTuple

import numpy as np

from .events import REVERSE, STOP_THEN_BACK, STOP_THEN_ON
from .follow import after_slide, slide_on
from .jit import entry, kernel
from .orbits import longest_slide
from .oscillators import advance, expand
from .returns import copy_state
from .structure import held_load, hold, place, release
from .structure_cycle import SHORTEST_STOP
from .structure_orbit import orbit_state

# Columns of a table of phases: slides and the stops between them, with the state at the start of each,
# mirrored where SIGN = -1.
LENGTH = 0  # in tau
SENSE = 1  # 1 for a slide (upwards, mirrored or not), 0 for a stop
SIGN = 2
COS = 3
SIN = 4
PLACE = 5  # z of a stop
Z_END = 6  # z at the end
STATE = 7  # 2n of a slide, or 2m of a stop: coordinates, and velocities in t = tau/r


class Shapes(NamedTuple):
    """Displacements of the masses."""

    free: np.ndarray  # (n_dof, n) of the free modes
    held: np.ndarray  # (n_dof, 2m) of the held oscillators (y, p)
    lift: np.ndarray  # (n_dof,) of a unit displacement of the contact


@kernel
def phase_columns(n):
    """Columns of a table of phases."""
    return STATE + 2 * n


@kernel
def _write(st, rows, k, length, sense, sign, c, s, at, z_end, state, n):
    rows[k, LENGTH] = length
    rows[k, SENSE] = sense
    rows[k, SIGN] = sign
    rows[k, COS] = c
    rows[k, SIN] = s
    rows[k, PLACE] = at
    rows[k, Z_END] = z_end
    for i in range(n):
        rows[k, STATE + i] = state[0, i]
        rows[k, STATE + n + i] = state[1, i] * st.rate


@entry
def orbit_phases(st, beta, mu_beta, state, c, s, sign, net, count, rows, work, scratch):
    """The phases of a steady state from an anchor on, `count` slides and their stops; how many there are.

    `state` becomes the state at the end.
    """
    limit = longest_slide(st, st.r)
    k = 0
    for _ in range(count):
        copy_state(state, work.start, st.n)
        c0, s0 = c, s
        n, _, c, s, _ = slide_on(st, beta, net, state, c, s, limit, scratch)
        z = place(st, state)
        _write(st, rows, k, n * st.h, 1.0, sign, c0, s0, math.nan, z, work.start, st.n)
        k += 1
        hold(st, state, z, c, s, work.held)
        c0, s0 = c, s
        copy_state(work.held, work.moved, st.m)
        code, c, s, net, wait, _, _ = after_slide(
            st, beta, mu_beta, state, work.held, c, s, limit * st.h, scratch
        )
        if (code == STOP_THEN_BACK or code == STOP_THEN_ON) and wait > SHORTEST_STOP:
            _write(st, rows, k, wait, 0.0, sign, c0, s0, z, z, work.moved, st.m)
            k += 1
        if code == REVERSE or code == STOP_THEN_BACK:
            sign = -sign
    return k


@entry
def continuous_phase(st, orbit, i, beta, phase, rows, work):
    """The rising half of the continuous orbit, a table of one phase."""
    c, s = -math.cos(phase), -math.sin(phase)
    orbit_state(st, orbit, i, beta, phase, c, s, work.start)
    z = place(st, work.start)
    _write(st, rows, 0, math.pi, 1.0, 1.0, c, s, math.nan, -z, work.start, st.n)


@kernel
def _begin(st, row, work):
    """Whether a phase slides, and the number of its oscillators; into work.moved (or held) their state."""
    slides = row[SENSE] > 0.0
    n = st.n if slides else st.m
    target = work.moved if slides else work.held
    for i in range(n):
        target[0, i] = row[STATE + i]
        target[1, i] = row[STATE + n + i] / st.rate
    return slides, n


@entry
def sample_phases(st, beta, rows, count, tau, coordinates, velocities, z, friction, sense, work, scratch):
    """The motion at times `tau` >= 0, increasing, from the start of the table's first phase.

    coordinates, velocities: (n, tau.size) of the free modes, velocities in tau; z, friction, sense:
    (tau.size,).
    """
    begin = 0.0
    j = 0
    for k in range(count):
        row = rows[k]
        end = begin + row[LENGTH]
        slides, n = _begin(st, row, work)
        current = work.moved if slides else work.held
        table = st.free if slides else st.held
        force = beta if slides else 0.0
        angle = math.atan2(row[SIN], row[COS])
        node = 0.0
        expand(table, n, force, current, row[COS], row[SIN], st.h, st.terms, scratch.series)
        while j < tau.size and tau[j] < end:
            while tau[j] - begin > node + st.h:
                advance(scratch.series, n, st.terms, 1.0, current)
                node += st.h
                expand(
                    table, n, force, current, math.cos(angle + node), math.sin(angle + node), st.h, st.terms,
                    scratch.series,
                )  # fmt: skip
            x = (tau[j] - begin - node) / st.h
            advance(scratch.series, n, st.terms, x, scratch.next)
            c, s = math.cos(angle + tau[j] - begin), math.sin(angle + tau[j] - begin)
            if slides:
                copy_state(scratch.next, work.start, n)
                z[j] = row[SIGN] * place(st, work.start)
                friction[j] = row[SIGN] * beta
            else:
                release(st, scratch.next, row[PLACE], c, s, work.start)
                z[j] = row[SIGN] * row[PLACE]
                friction[j] = -row[SIGN] * held_load(st, scratch.next, row[PLACE], c, s)
            sense[j] = int(row[SIGN] * row[SENSE])
            for i in range(st.n):
                coordinates[i, j] = row[SIGN] * work.start[0, i]
                velocities[i, j] = row[SIGN] * work.start[1, i] / st.h
            j += 1
        begin = end


@kernel
def _of_mass(st, shapes, mass, slides, i, n):
    """What a mass has of the i-th oscillator's coordinate and of its change in a step."""
    if slides:
        return shapes.free[mass, i], 0.0
    return shapes.held[mass, i], shapes.held[mass, n + i] * st.rate


@kernel
def largest_displacements(st, beta, shapes, re, im, rows, count, out, work, scratch):
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
    for k in range(count):
        row = rows[k]
        slides, n = _begin(st, row, work)
        current = work.moved if slides else work.held
        table = st.free if slides else st.held
        force = beta if slides else 0.0
        level = 0.0 if slides else row[PLACE]
        angle = math.atan2(row[SIN], row[COS])
        steps = int(math.ceil(row[LENGTH] / h))
        for step in range(steps):
            last = min(1.0, row[LENGTH] / h - step)
            c, s = math.cos(angle + step * h), math.sin(angle + step * h)
            expand(table, n, force, current, c, s, h, terms, scratch.series)
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
