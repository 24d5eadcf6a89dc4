"""Fill the open cells of a structure's map one by one."""

import math
from typing import NamedTuple

import numpy as np

from ..regimes import CONTINUOUS, PERMANENT_STICKING
from .continuous import orbit_phase
from .floquet import asymmetry, continuous_multiplier, orbit_multiplier
from .jit import entry, kernel
from .oscillators import make_scratch
from .returns import HALVES, make_workspace
from .structure import make_structure
from .structure_cycle import Friction, fitting_memory, steady_structure
from .structure_history import (
    continuous_phase,
    largest_displacements,
    orbit_phases,
    phase_columns,
)
from .sweep import FINE_STEPS, store

# Columns of a table of steady states; the state at the anchor follows.
REGIME, SLIDES, COS, SIN, SIGN, NET, AMPLITUDE, ANCHOR = 0, 1, 2, 3, 4, 5, 6, 7


class Starts(NamedTuple):
    """Starting states at every r: of the free modes, velocities in t = tau/r, and the load's phase."""

    place: np.ndarray  # (n_r, n)
    velocity: np.ndarray  # (n_r, n)
    cos: np.ndarray  # (n_r,)
    sin: np.ndarray
    moving: bool


@kernel
def put_start(st, starts, i, state):
    """Set the state to the start at the i-th frequency; the load's phase (cos, sin) there."""
    for j in range(st.n):
        state[0, j] = starts.place[i, j]
        state[1, j] = starts.velocity[i, j] / st.rate
    return starts.cos[i], starts.sin[i]


@entry
def _continuous(fine, orbit, i, friction, shapes, re, im, out, m, j, work, scratch):
    """What was asked for beyond `sweep.store`, of the continuous orbit."""
    if out.asymmetry.size:
        out.asymmetry[m, i, j] = 0.0
    if out.multiplier.size:
        out.multiplier[m, i, j] = continuous_multiplier(
            fine, orbit, i, friction.beta, friction.mu_beta, work, scratch
        )
    if out.amplitude.size:
        v_abs = orbit.v_abs[i]
        if math.isinf(v_abs):
            out.amplitude[m, i, j, :] = math.inf
            return
        rows = np.empty((1, phase_columns(fine.n)))
        phase = orbit_phase(v_abs, orbit.v_arg[i], orbit.u[i], friction.beta)
        continuous_phase(fine, orbit, i, friction.beta, phase, rows, work)
        largest_displacements(
            fine, friction.beta, shapes, re, im, rows, 1, out.amplitude[m, i, j], work, scratch
        )


@kernel
def _note(st, found, state, row):
    """Note a steady state: what it is, and the state, load phase, sign and force at its anchor."""
    row[REGIME] = found.regime
    row[SLIDES] = found.events
    row[COS] = found.cos
    row[SIN] = found.sin
    row[SIGN] = found.sign
    row[NET] = found.net
    row[AMPLITUDE] = found.z if found.regime == PERMANENT_STICKING else found.amplitude
    for j in range(st.n):
        row[ANCHOR + j] = state[0, j]
        row[ANCHOR + st.n + j] = state[1, j]


@entry
def fill_details(
    first, last, rows, ends, low, beta, mu, lim, r, model, loads, orbit, shapes, re, im, held, steps, out,
    anchors
):  # fmt: skip
    """What was asked for beyond `sweep.store`, of the cells that `fill_structures` filled.

    shapes, re, im : what the displacements of the masses are made of, see `structure_history`
    held : (n_r, n_dof) phasors of the displacements with the contact held
    """
    n = model.modes.shape[1]
    work = make_workspace(n)
    scratch = make_scratch(n)
    state = np.empty((2, n))
    n_r = r.size
    k = np.searchsorted(ends, first, side="right")
    i = -1
    for cell in range(first, last):
        while cell >= ends[k]:
            k += 1
        m = rows[k] // n_r
        if rows[k] % n_r != i:
            i = rows[k] % n_r
            st = make_structure(model, loads, i, r[i], steps)
            fine = make_structure(model, loads, i, r[i], max(steps, FINE_STEPS))
        j = low[rows[k]] + cell - (ends[k - 1] if k > 0 else 0)
        row = anchors[cell - first]
        count = int(row[SLIDES])
        friction = Friction(beta[j], mu[m] * beta[j], lim[m, i])
        if row[REGIME] == PERMANENT_STICKING:
            for d in range(out.amplitude.shape[3]):
                out.amplitude[m, i, j, d] = abs(held[i, d]) + abs(shapes.lift[d] * row[AMPLITUDE])
        elif row[REGIME] == CONTINUOUS and count == 0:
            _continuous(fine, orbit, i, friction, shapes, re[i], im[i], out, m, j, work, scratch)
        elif count > 0:
            for d in range(n):
                state[0, d] = row[ANCHOR + d]
                state[1, d] = row[ANCHOR + n + d]
            if out.multiplier.size:
                out.multiplier[m, i, j] = orbit_multiplier(
                    st, friction.beta, friction.mu_beta, row[NET], state, row[COS], row[SIN], count, work,
                    scratch,
                )  # fmt: skip
            if out.amplitude.size or out.asymmetry.size:
                phases = np.empty((2 * count, phase_columns(n)))
                count = orbit_phases(
                    st, friction.beta, friction.mu_beta, state, row[COS], row[SIN], row[SIGN], row[NET],
                    count, phases, work, scratch,
                )  # fmt: skip
                if out.amplitude.size:
                    largest_displacements(
                        fine, friction.beta, shapes, re[i], im[i], phases, count, out.amplitude[m, i, j],
                        work, scratch,
                    )  # fmt: skip
                if out.asymmetry.size:
                    out.asymmetry[m, i, j] = asymmetry(
                        st, friction.beta, phases, count, row[AMPLITUDE], work, scratch
                    )


@entry
def fill_closed_details(
    first, last, low, high, beta, mu, lim, r, model, loads, orbit, shapes, re, im, held, steps, out
):  # fmt: skip
    """What was asked for beyond `sweep.store`, of the cells that `sweep.fill_closed_form` fills."""
    n = model.modes.shape[1]
    work = make_workspace(n)
    scratch = make_scratch(n)
    n_r = r.size
    for row in range(first, last):
        m = row // n_r
        i = row % n_r
        if low[row] > 0 and r[i] > 0.0:
            fine = make_structure(model, loads, i, r[i], max(steps, FINE_STEPS))
            for j in range(low[row]):
                friction = Friction(beta[j], mu[m] * beta[j], lim[m, i])
                _continuous(fine, orbit, i, friction, shapes, re[i], im[i], out, m, j, work, scratch)
        for j in range(high[row], beta.size):
            for k in range(out.amplitude.shape[3]):
                out.amplitude[m, i, j, k] = abs(held[i, k])


@entry
def fill_structures(
    first, last, rows, ends, low, beta, mu, lim, r, model, loads, orbit, marginal, starts, steps, limits, out,
    anchors, stop,
):  # fmt: skip
    """Cells first..last-1 of the list of open cells; arguments as in `sweep.fill_integrated`.

    anchors : (last - first, ANCHOR + 2n), the steady state of each for `fill_details`; or (0, 0)
    """
    n = model.modes.shape[1]
    memory = np.empty((0, 0))
    work = make_workspace(n)
    scratch = make_scratch(n)
    state = np.empty((2, n))
    start = first
    n_r = r.size
    k = np.searchsorted(ends, first, side="right")
    cell = first
    while cell < last:
        row = rows[k]
        m = row // n_r
        i = row % n_r
        begin = ends[k - 1] if k > 0 else 0
        st = make_structure(model, loads, i, r[i], steps)
        fine = make_structure(model, loads, i, r[i], max(steps, FINE_STEPS))
        memory = fitting_memory(st, memory)
        until = min(last, ends[k])
        work.anchored[HALVES] = 0.0  # the last row's orbits are no neighbours
        while cell < until:
            if stop[0] != 0:
                return
            j = low[row] + cell - begin
            c, s = put_start(st, starts, i, state)
            friction = Friction(beta[j], mu[m] * beta[j], lim[m, i])
            found = steady_structure(
                st, fine, orbit, i, marginal[i], friction, mu[m] == 1.0,
                starts.moving, state, c, s, limits, stop, memory, work, scratch,
            )  # fmt: skip
            store(out, m, i, j, found, 1.0)
            if anchors.size:
                _note(st, found, state, anchors[cell - start])
            cell += 1
        k += 1


@entry
def one_structure(
    beta, mu, lim, r, model, loads, orbit, marginal, starts, steps, limits, state
):  # fmt: skip
    """The steady state of one open cell at the only frequency; `state` (2, n) becomes an anchor of it."""
    n = model.modes.shape[1]
    st = make_structure(model, loads, 0, r, steps)
    fine = make_structure(model, loads, 0, r, max(steps, FINE_STEPS))
    c, s = put_start(st, starts, 0, state)
    found = steady_structure(
        st, fine, orbit, 0, marginal, Friction(beta, mu * beta, lim), mu == 1.0, starts.moving, state,
        c, s, limits, np.zeros(1, dtype=np.uint8),
        fitting_memory(st, np.empty((0, 0))), make_workspace(n), make_scratch(n),
    )  # fmt: skip
    for j in range(n):
        state[1, j] *= st.rate
    return found
