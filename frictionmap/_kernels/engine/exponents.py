"""Largest Lyapunov exponent of irregular motions, from the exact derivative of the motion.

A small disturbance is carried along: it moves linearly between events and jumps at each (`structure.newton`).
Its size is the energy norm, brought back to 1 at every event.
"""

import math
from typing import NamedTuple

import numpy as np

from ...regimes import IRREGULAR
from ..compiler import entry, kernel
from ..compiler.packed import packed
from ..compiler.vectors import LANES
from ..event_codes import GRAZING
from ..logs import mean_and_error
from ..structure.events import NO_RELEASE, UNDER_WAY, after_slide, slide_on
from ..structure.newton import Workspace, free_motion, make_workspace, through_event
from ..structure.oscillators import FELL, Scratch, make_scratch, padded
from ..structure.state import StructureAtFrequency, W, make_structure
from .records import TURN, stops_at, turns_at


class ExponentWorkspace(NamedTuple):
    """The structure at one frequency, and the memory of its motions."""

    st: StructureAtFrequency
    work: Workspace
    scratch: Scratch
    tangent: np.ndarray  # (2n, padded(2n)) the disturbance, in the first column


@kernel
def _rescaled(st, tangent):
    """Bring a disturbance to the size 1; return the logarithm of its size, NaN where it has vanished."""
    n = st.n
    square = 0.0
    for i in range(n):
        square += (st.modes[W, i] * tangent[i, 0]) ** 2 + tangent[n + i, 0] ** 2
    size = math.sqrt(square)
    if not size > 0.0:
        for i in range(n):
            tangent[i, 0] = 1.0 / (st.modes[W, i] * math.sqrt(float(n)))
            tangent[n + i, 0] = 0.0
        return math.nan
    for i in range(2 * n):
        tangent[i, 0] /= size
    return math.log(size)


@kernel
def _follow_growth(st, beta, mu_beta, state, phase, moves, growth, tangent, work, scratch):
    """Follow a motion and a disturbance of it, and fill the growth of its logarithm in every cycle.

    Parameters
    ----------
    st : StructureAtFrequency
    beta, mu_beta : kinetic and static friction force
    state : (2, padded(n)) initial state, overwritten
    phase : (cos, sin) of the load there
    moves : whether the initial state has a velocity
    growth : (cycles, 1) filled; NaN in cycles that cannot be used
    tangent : (2n, padded(2n)) initial disturbance in the first column, overwritten
    work, scratch : Workspace, Scratch

    Returns
    -------
    bool : whether the motion was followed to the end
    """
    end = TURN * growth.shape[0]
    c, s = phase
    force = UNDER_WAY
    time = 0.0
    slides = moves
    while time < end:
        if slides:
            steps, code, c, s, _ = slide_on(st, beta, force, state, c, s, (end - time) / st.h + 1.0, scratch)
            if code != FELL:
                return time + steps * st.h >= end
            time += steps * st.h
            free_motion(st.free, st.n, steps * st.h / st.r, tangent, LANES)
        slides = True
        event, c, s, force, wait, load, slope = after_slide(
            st, beta, mu_beta, state, work.held, c, s, end - time, scratch
        )
        if event == NO_RELEASE:
            return True
        if event == GRAZING:  # so does a start from rest that the load pushes upwards: nothing jumps
            continue
        if not (stops_at(event) or turns_at(event)):
            return False
        through_event(st, beta, mu_beta, event, load, wait, slope, tangent, work.stopped, LANES)
        time += wait
        cycle = int(time / TURN)
        more = _rescaled(st, tangent)
        if cycle < growth.shape[0]:
            growth[cycle, 0] += more
    return True


@kernel
def _exponent(growth):
    """Mean growth per cycle over the last two thirds of the cycles, without those that cannot be used."""
    count = 0
    for k in range(growth.shape[0] // 3, growth.shape[0]):
        if growth[k, 0] == growth[k, 0]:  # a number
            growth[count, 0] = growth[k, 0]
            count += 1
    return mean_and_error(growth, 0, 0, count)


@kernel
def _fill_exponent(place, axes, starts, moves, out, growth, workspace):
    """Fill the exponent of one cell.

    Parameters
    ----------
    place : indices of mu, r and beta
    axes, starts, moves, out : see `fill_exponents`
    growth : (cycles, 1) zeros
    workspace : ExponentWorkspace
    """
    workspace = packed(workspace)
    st, work, scratch, tangent = workspace.st, workspace.work, workspace.scratch, workspace.tangent
    m, i, j = place
    state = work.middle
    for k in range(st.n):
        state[0, k] = starts.coordinates[i, k]
        state[1, k] = starts.velocity[i, k] / st.rate
        tangent[k, 0] = tangent[st.n + k, 0] = 1.0
    beta = axes.beta[j]
    _rescaled(st, tangent)
    phase = (starts.cos[i], starts.sin[i])
    if _follow_growth(st, beta, axes.mu[m] * beta, state, phase, moves, growth, tangent, work, scratch):
        found = _exponent(growth)
        out.lyapunov_exponent[m, i, j] = found.value
        out.lyapunov_exponent_error[m, i, j] = found.error


@entry
def fill_exponents(row, axes, common, starts, moves, out, cancel):
    """Fill the exponents of the irregular cells of a row, whose motions are followed once more.

    Parameters
    ----------
    row : of the (mu, r) grid
    axes : Axes
    common : Common
    starts : Starts at every frequency
    moves : whether these have a velocity
    out : named tuple of arrays (n_mu, n_r, n_beta, ...), one for every output
    cancel : (1,) set by another thread to end the computation
    """
    m, i = row // axes.r.size, row % axes.r.size
    if not np.any(out.status[m, i] == IRREGULAR):
        return
    st = make_structure(common.model, common.loads, i, axes.r[i], common.steps)
    n = st.n
    workspace = ExponentWorkspace(st, make_workspace(n), make_scratch(n), np.zeros((2 * n, padded(2 * n))))
    for j in range(axes.beta.size):
        if cancel[0] != 0:
            return
        if out.status[m, i, j] == IRREGULAR:
            growth = np.zeros((out.cycles[m, i, j], 1))
            _fill_exponent((m, i, j), axes, starts, moves, out, growth, workspace)
