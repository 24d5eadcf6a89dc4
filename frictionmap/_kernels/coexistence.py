"""Which regimes a cell can end in, from a fixed set of starts; and how far in beta a sliding motion reaches.

For mu > 1 the start decides (theory.md 6).  The starts: rest; a large sliding motion; the steady states of
the neighbours in beta, upwards and downwards, as in a slow sweep of the friction; and, by their closed
forms, the continuous orbit below beta_lim and the contact held from beta_stick on.  A regime counts where a
motion from such a start settles in it: what is found is stable.
"""

import math

import numpy as np

from ..regimes import CONTINUOUS, NOT_COMPUTED, PERMANENT_STICKING, STICK_SLIP
from .continuous import orbit_phase
from .jit import entry, kernel
from .oscillators import make_scratch
from .returns import HALVES, copy_state, make_workspace
from .structure import make_structure
from .structure_cycle import Friction, fitting_memory, steady_structure
from .structure_orbit import orbit_state
from .structure_sweep import put_start
from .sweep import FINE_STEPS

#: Halvings of the step of the grid in which a sliding motion ends.
_HALVINGS = 30


@kernel
def _bit(regime):
    """Flag of a regime: 1 for permanent sticking, 2 for stick-slip, 4 for continuous; 0 where unresolved."""
    if regime == PERMANENT_STICKING:
        return 1
    if regime == STICK_SLIP:
        return 2
    return 4 if regime == CONTINUOUS else 0


@kernel
def _keep(st, orbit, i, beta, found, state, held):
    """Whether `found` slides; then `held` becomes a state of it, and (cos, sin) the load's phase there."""
    if found.regime == STICK_SLIP and found.events > 0:
        copy_state(state, held, st.n)
        return True, found.cos, found.sin
    if found.regime == CONTINUOUS and not math.isinf(orbit.v_abs[i]):
        if found.events > 0:
            copy_state(state, held, st.n)
            return True, found.cos, found.sin
        phase = orbit_phase(orbit.v_abs[i], orbit.v_arg[i], orbit.u[i], beta)
        c, s = -math.cos(phase), -math.sin(phase)
        orbit_state(st, orbit, i, beta, phase, c, s, held)
        return True, c, s
    return False, 0.0, 0.0


@entry
def fill_reachable(
    first, last, beta, mu, lim, stick, r, model, loads, orbit, marginal, rest, moving, steps, limits,
    reachable, sliding_limit, stop,
):  # fmt: skip
    """Rows first..last-1 of (mu, r): `reachable` (n_mu, n_r, n_beta) flags, `sliding_limit` (n_mu, n_r)."""
    n = model.modes.shape[1]
    memory = np.empty((0, 0))
    work = make_workspace(n)
    scratch = make_scratch(n)
    state = np.empty((2, n))
    kept = np.empty((2, n))
    farthest = np.empty((2, n))
    n_r = r.size
    for row in range(first, last):
        m = row // n_r
        i = row % n_r
        unique = mu[m] == 1.0
        for j in range(beta.size):
            if beta[j] < lim[m, i] or beta[j] == 0.0:
                reachable[m, i, j] |= 4
            if beta[j] >= stick[m, i] and beta[j] > 0.0:
                reachable[m, i, j] |= 1
        if unique:
            sliding_limit[m, i] = stick[m, i]
        if r[i] == 0.0:
            for j in range(beta.size):
                if reachable[m, i, j] == 0:
                    reachable[m, i, j] = 2
            continue
        st = make_structure(model, loads, i, r[i], steps)
        fine = make_structure(model, loads, i, r[i], max(steps, FINE_STEPS))
        memory = fitting_memory(st, memory)
        work.anchored[HALVES] = 0.0  # the last row's orbits are no neighbours
        best, c_best, s_best = 0.0, 0.0, 0.0
        # 0: rest, 1: moving, 2: upwards from the neighbour below, 3: downwards from the one above
        for start in range(1 if unique else 4):
            slides, c0, s0 = False, 0.0, 0.0
            for k in range(beta.size):
                j = beta.size - 1 - k if start == 3 else k
                if beta[j] == 0.0 or (unique and reachable[m, i, j] != 0):
                    continue
                if stop[0] != 0:
                    return
                c, s = c0, s0
                if start < 2:
                    source = rest if start == 0 else moving
                    c, s = put_start(st, source, i, state)
                elif slides:
                    copy_state(kept, state, n)
                else:
                    # nothing slid below (above): a large motion shows whether anything does here
                    if not reachable[m, i, j] & 6:
                        continue
                    c, s = put_start(st, moving, i, state)
                friction = Friction(beta[j], mu[m] * beta[j], lim[m, i])
                moves = start == 1 or (start >= 2 and not slides)
                found = steady_structure(
                    st, fine, orbit, i, marginal[i], friction, unique, moves, state, c, s, limits, stop,
                    memory, work, scratch,
                )  # fmt: skip
                if found.status == NOT_COMPUTED:
                    return
                reachable[m, i, j] |= _bit(found.regime)
                slides, c0, s0 = _keep(st, orbit, i, beta[j], found, state, kept)
                if slides and beta[j] >= best:
                    best, c_best, s_best = beta[j], c0, s0
                    copy_state(kept, farthest, n)
        if unique:
            continue
        sliding_limit[m, i] = lim[m, i]  # up to there the continuous orbit exists
        for j in range(beta.size):
            if reachable[m, i, j] & 6:  # a motion that does not repeat slides too
                sliding_limit[m, i] = max(sliding_limit[m, i], beta[j])
        if not best > 0.0:
            continue
        # follow the motion on from the largest beta at which it slid
        low = high = best
        for j in range(beta.size - 1, -1, -1):
            if beta[j] > best:
                high = beta[j]
        for _ in range(_HALVINGS):
            middle = 0.5 * (low + high)
            if not low < middle < high:
                break
            copy_state(farthest, state, n)
            found = steady_structure(
                st, fine, orbit, i, marginal[i], Friction(middle, mu[m] * middle, lim[m, i]), unique, False,
                state, c_best, s_best, limits, stop, memory, work, scratch,
            )  # fmt: skip
            if found.status == NOT_COMPUTED:
                return
            goes_on, c, s = _keep(st, orbit, i, middle, found, state, farthest)
            if goes_on:
                low = middle
                c_best, s_best = c, s
            else:
                high = middle
        sliding_limit[m, i] = max(sliding_limit[m, i], low)
