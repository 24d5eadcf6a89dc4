"""Stability and symmetry of a steady state: its Floquet multipliers, and how far from antiperiodic it is."""

import math

import numpy as np

from .continuous import orbit_phase
from .events import REVERSE
from .follow import after_slide, slide_on
from .jit import entry, kernel
from .orbits import half_periods, longest_slide
from .oscillators import FELL
from .returns import copy_state, return_map, spectral_radius
from .structure_history import sample_phases
from .structure_orbit import orbit_state

#: Samples of z in half a period of the excitation for its asymmetry.
_SAMPLES = 256


@kernel
def _around(st, beta, mu_beta, c, s, codes, count, halves, work, scratch):
    """Largest modulus over the steady period from work.middle in a slide; nan if it does not fit."""
    if not return_map(st, beta, mu_beta, work.middle, c, s, codes, 0, count, halves, True, work, scratch):
        return math.nan
    radius = spectral_radius(work.flow, 2 * st.n, work.square)
    return radius * radius if halves % 2 == 1 else radius


@entry
def orbit_multiplier(st, beta, mu_beta, net, state, c, s, count, work, scratch):
    """Largest modulus of the multipliers of the orbit that returns to an anchor after `count` slides."""
    copy_state(state, work.moved, st.n)
    codes = np.empty(count)
    limit = longest_slide(st, st.r)
    time = 0.0
    first = 0.0
    c1, s1, push = c, s, net
    for k in range(count):
        steps, end, c1, s1, _ = slide_on(st, beta, push, work.moved, c1, s1, limit, scratch)
        if end != FELL:
            return math.nan
        if k == 0:
            first = steps
        code, c1, s1, push, wait, _, _ = after_slide(
            st, beta, mu_beta, work.moved, work.held, c1, s1, limit * st.h, scratch
        )
        codes[k] = code
        time += steps * st.h + wait
    if not time < math.inf:
        return math.nan
    copy_state(state, work.middle, st.n)
    _, _, c, s, _ = slide_on(st, beta, net, work.middle, c, s, 0.5 * first, scratch)
    halves = half_periods(time)
    return _around(st, beta, mu_beta, c, s, codes, count, halves, work, scratch)


@kernel
def continuous_multiplier(st, orbit, i, beta, mu_beta, work, scratch):
    """The same of the continuous orbit, which turns once in half a period."""
    v_abs = orbit.v_abs[i]
    if math.isinf(v_abs):
        return math.nan
    phase = orbit_phase(v_abs, orbit.v_arg[i], orbit.u[i], beta)
    # in the middle of the rising half
    c, s = math.sin(phase), -math.cos(phase)
    orbit_state(st, orbit, i, beta, phase, c, s, work.middle)
    work.codes[0] = REVERSE
    return _around(st, beta, mu_beta, c, s, work.codes, 1, 1, work, scratch)


@kernel
def _least_difference(z, halves):
    """Least over odd m of the largest |z(tau + m pi) + z(tau)|; `z` has _SAMPLES in each of `halves` pi."""
    least = math.inf
    # m and halves - m make the same pairs
    for m in range(1, halves // 2 + 1, 2):
        most = 0.0
        for j in range(z.size):
            most = max(most, abs(z[j] + z[(j + m * _SAMPLES) % z.size]))
        least = min(least, most)
    return least


@entry
def asymmetry(st, beta, rows, count, amplitude, work, scratch):
    """How far the motion in a table of phases is from a mirror image of itself, over the amplitude.

    The least over odd m of the largest |z(tau + m pi) + z(tau)|; 0 if it returns mirrored, that is after an
    odd number of half periods.
    """
    total = 0.0
    for k in range(count):
        total += rows[k, 0]
    halves = half_periods(total)
    if halves % 2 == 1:
        return 0.0
    size = halves * _SAMPLES
    tau = np.empty(size)
    for j in range(size):
        tau[j] = total * j / size
    z = np.zeros(size)
    sample_phases(
        st, beta, rows, count, tau, np.empty((st.n, size)), np.empty((st.n, size)), z, np.empty(size),
        np.empty(size, dtype=np.int8), work, scratch,
    )  # fmt: skip
    return _least_difference(z, halves) / amplitude
