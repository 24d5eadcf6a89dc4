"""Fill the cells of a map: whole runs of cells by closed form, the open ones one by one."""

import math
from typing import NamedTuple

import numpy as np

from ..regimes import CLOSED_FORM, RESOLVED
from .continuous import Oscillator
from .cycle import (
    COUNT,
    HISTORY_ROWS,
    NEIGHBOUR,
    continuous_cell,
    history_length,
    quasi_static_cell,
    solve_cell,
    stuck_cell,
)
from .jit import entry, kernel
from .phases import MAX_TERMS, step_constants


class Frequencies(NamedTuple):
    """What depends on r only; arrays of shape (n_r,)."""

    r: np.ndarray
    load: np.ndarray  # amplitude A of the load in the contact
    phase: np.ndarray  # its phase ahead of cos(tau)
    v_abs: np.ndarray
    v_arg: np.ndarray
    u: np.ndarray
    g: np.ndarray
    marginal: np.ndarray  # bool; see Oscillator


class Outputs(NamedTuple):
    """Cell variables, shape (n_mu, n_r, n_beta); one that was not asked for has shape (0, 0, 0)."""

    regime: np.ndarray
    stops_per_cycle: np.ndarray
    contact_amplitude: np.ndarray
    stuck_fraction: np.ndarray
    period: np.ndarray
    origin: np.ndarray
    cycles: np.ndarray
    status: np.ndarray
    multiplier: np.ndarray
    asymmetry: np.ndarray
    also_reachable: np.ndarray
    sliding_limit: np.ndarray  # (n_mu, n_r)
    amplitude: np.ndarray  # has the masses for a fourth dimension


@kernel
def store(out, m, i, j, cell, load):
    if out.regime.size:
        out.regime[m, i, j] = cell.regime
    if out.stops_per_cycle.size:
        out.stops_per_cycle[m, i, j] = cell.stops
    if out.contact_amplitude.size:
        out.contact_amplitude[m, i, j] = cell.amplitude * load
    if out.stuck_fraction.size:
        out.stuck_fraction[m, i, j] = cell.stuck
    if out.period.size:
        out.period[m, i, j] = cell.period
    if out.origin.size:
        out.origin[m, i, j] = cell.origin
    if out.cycles.size:
        out.cycles[m, i, j] = math.ceil(cell.cycles)
    if out.status.size:
        out.status[m, i, j] = cell.status


@kernel
def _oscillator(frequencies, zeta, i):
    return Oscillator(
        frequencies.r[i], zeta, frequencies.v_abs[i], frequencies.v_arg[i],
        frequencies.u[i], frequencies.g[i], frequencies.marginal[i],
    )  # fmt: skip


#: The moving start, in units of the motion that the load alone sustains: energy amplitude, and the cap
#: on that motion near resonance.  Of 25 starts tried on 4,000 cells where sliding and sticking coexist
#: this one slid on in the largest share, 95 %.
_MOVING = 1.5
_MOVING_CAP = 10.0

#: Scan steps per fastest period for bounds over a whole orbit: their slack is of second order in the step.
FINE_STEPS = 64.0

_BELOW_ONE = 0.9999999999999999  # the double before 1


@kernel
def start_state(oscillator, phase, moving):
    """(z, z', cos, sin) of the normalised oscillator at the start.

    At rest: z = z' = 0 at tau = 0.  Moving: z = 0 at 1.5 times the speed that gives the amplitude (in
    energy) of the motion without friction, that amplitude taken as 10 at most, while the load falls
    through zero.
    """
    if not moving:
        return 0.0, 0.0, math.cos(phase), math.sin(phase)
    size = _MOVING * min(oscillator.v_abs, _MOVING_CAP) * max(1.0, oscillator.r)
    return 0.0, size / oscillator.r, 0.0, 1.0


@entry
def normalised_friction(beta, load, mu, stick):
    """(b, mu b) of a cell.

    The division rounds, so where beta ties with beta_stick it could decide against the comparison
    that the closed form makes; the comparison is made once, on beta, and holds here too.
    """
    b = beta / load
    mu_b = mu * b
    if (mu_b >= 1.0) == (beta >= stick):
        return b, mu_b
    mu_b = 1.0 if beta >= stick else _BELOW_ONE
    return mu_b / mu, mu_b


@entry
def fill_closed_form(first, last, low, high, beta, frequencies, zeta, out):
    """Cells below `low` are continuous and those from `high` on stuck, in (mu, r) rows first..last-1.

    The cells between belong to `fill_integrated`, except at r = 0, where no integration is possible.
    """
    n_r = frequencies.r.size
    for row in range(first, last):
        m = row // n_r
        i = row % n_r
        oscillator = _oscillator(frequencies, zeta, i)
        load = frequencies.load[i]
        for j in range(low[row]):
            store(out, m, i, j, continuous_cell(oscillator, beta[j] / load, CLOSED_FORM, 0.0), load)
        if oscillator.r == 0.0:
            for j in range(low[row], high[row]):
                store(out, m, i, j, quasi_static_cell(), load)
        for j in range(high[row], beta.size):
            store(out, m, i, j, stuck_cell(CLOSED_FORM, RESOLVED, 0.0, 0.0, 1.0), load)


@entry
def fill_integrated(
    first, last, rows, ends, low, beta, mu, lim, stick, frequencies, zeta, steps, limits, moving,
    out, stop,
):  # fmt: skip
    """Cells first..last-1 of the list of open cells; ends soon after stop[0] is set.

    Parameters
    ----------
    rows : (k,) the (mu, r) rows that have open cells
    ends : (k,) number of open cells up to and with each of them
    low : first open cell in beta, by row
    lim, stick : (n_mu, n_r) b_lim over the load amplitude, and beta_stick
    steps : scan steps per period of the fastest part of the motion
    """
    history = np.empty((HISTORY_ROWS, 0))
    neighbour = np.zeros(NEIGHBOUR)
    work = np.empty(MAX_TERMS)
    n_r = frequencies.r.size
    k = np.searchsorted(ends, first, side="right")
    cell = first
    while cell < last:
        row = rows[k]
        m = row // n_r
        i = row % n_r
        begin = ends[k - 1] if k > 0 else 0
        oscillator = _oscillator(frequencies, zeta, i)
        step = step_constants(oscillator.r, zeta, steps)
        fine = step_constants(oscillator.r, zeta, max(steps, FINE_STEPS))
        z, v, c, s = start_state(oscillator, frequencies.phase[i], moving)
        load = frequencies.load[i]
        if history.shape[1] != history_length(oscillator.r):  # no longer either: what it holds decides
            history = np.empty((HISTORY_ROWS, history_length(oscillator.r)))
        until = min(last, ends[k])
        neighbour[COUNT] = 0.0  # the last row's orbits are no neighbours
        while cell < until:
            if stop[0] != 0:
                return
            j = low[row] + cell - begin
            b, mu_b = normalised_friction(beta[j], load, mu[m], stick[m, i])
            found = solve_cell(
                step, fine, oscillator, b, mu_b, lim[m, i], z, v, c, s, limits, stop, history, neighbour, work
            )
            store(out, m, i, j, found, load)
            cell += 1
        k += 1


@entry
def integrate_one(beta, mu, lim, stick, load, phase, oscillator, step, fine, limits, moving):
    """The steady state of one open cell; arguments as in `fill_integrated`, for this cell."""
    z, v, c, s = start_state(oscillator, phase, moving)
    b, mu_b = normalised_friction(beta, load, mu, stick)
    history = np.empty((HISTORY_ROWS, history_length(oscillator.r)))
    work = np.empty(MAX_TERMS)
    stop = np.zeros(1, dtype=np.uint8)
    return solve_cell(
        step, fine, oscillator, b, mu_b, lim, z, v, c, s, limits, stop, history, np.zeros(NEIGHBOUR), work
    )
