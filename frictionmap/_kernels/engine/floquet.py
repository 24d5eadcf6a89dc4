"""Stability and symmetry of a steady state: Floquet multipliers, and deviation from antiperiodicity."""

import math

import numpy as np

from ..compiler import entry, kernel
from ..continuous_motion import orbit_phase
from ..event_codes import REVERSE, EventSequence
from ..spectral_radius import spectral_radius
from ..structure.events import slide_on
from ..structure.newton import copy_state, return_map
from ..structure.sliding_orbit import orbit_state
from .periods import half_periods
from .segment_table import CONTACT_FORCE, COS, EVENT, LENGTH, SENSE, SIN, Z_END, take_start
from .time_history import Samples, sample_segments

#: Samples of z per half period of the excitation.
_SAMPLES = 256


@kernel
def _multiplier(st, beta, mu_beta, c, s, sequence, halves, work, scratch):
    """Largest modulus of the multipliers over the steady period, from work.middle in a slide.

    Parameters
    ----------
    st : StructureAtFrequency
    beta, mu_beta : kinetic and static friction force
    c, s : cosine and sine of the load phase of work.middle
    sequence : EventSequence of one recurrence
    halves : half periods of one recurrence
    work, scratch : Workspace, Scratch; work.middle is the (2, n) state on the orbit

    Returns
    -------
    float : NaN if the events do not fit the sequence
    """
    if not return_map(st, beta, mu_beta, work.middle, c, s, sequence, halves, True, work, scratch):
        return math.nan
    radius = spectral_radius(work.flow, 2 * st.n, work.square, 0.0)
    return radius * radius if halves % 2 == 1 else radius


@entry
def orbit_multiplier(st, beta, mu_beta, table, work, scratch):
    """Largest modulus of the Floquet multipliers of the periodic orbit of a segment table."""
    events = np.empty(table.shape[0])
    slides = 0
    time = 0.0
    for k in range(table.shape[0]):
        time += table[k, LENGTH]
        if table[k, SENSE] > 0.0:
            events[slides] = table[k, EVENT]
            slides += 1
    take_start(st, table[0], work)
    copy_state(work.moved, work.middle, st.n)
    # from the middle of the first slide
    c, s = table[0, COS], table[0, SIN]
    half = 0.5 * table[0, LENGTH] / st.h
    sequence = EventSequence(events, np.int64(0), slides)
    _, _, c, s, _ = slide_on(st, beta, table[0, CONTACT_FORCE], work.middle, c, s, half, scratch)
    return _multiplier(st, beta, mu_beta, c, s, sequence, half_periods(time), work, scratch)


@kernel
def continuous_multiplier(st, orbit, i, beta, mu_beta, work, scratch):
    """Largest modulus of the Floquet multipliers of the continuous orbit, which turns once per half period.

    Parameters
    ----------
    st : StructureAtFrequency
    orbit : Continuous; i : index of the frequency
    beta, mu_beta : kinetic and static friction force
    work, scratch : Workspace, Scratch
    """
    v_abs = orbit.v_abs[i]
    if math.isinf(v_abs):
        return math.nan
    phase = orbit_phase(v_abs, orbit.v_arg[i], orbit.u[i], beta)
    # in the middle of the rising half
    c, s = math.sin(phase), -math.cos(phase)
    orbit_state(st, orbit, i, beta, phase, c, s, work.middle)
    work.events[0] = REVERSE
    once = np.int64(1)  # not a literal, which would be compiled for itself
    sequence = EventSequence(work.events, np.int64(0), once)
    return _multiplier(st, beta, mu_beta, c, s, sequence, once, work, scratch)


@kernel
def _least_difference(z, halves):
    """Least over odd m of the largest |z(tau + m pi) + z(tau)|; `z` has _SAMPLES values per half period."""
    least = math.inf
    # m and halves - m give the same pairs
    for m in range(1, halves // 2 + 1, 2):
        most = 0.0
        for j in range(z.size):
            most = max(most, abs(z[j] + z[(j + m * _SAMPLES) % z.size]))
        least = min(least, most)
    return least


@entry
def asymmetry(st, beta, table, work, scratch):
    """Deviation of the motion of a segment table from its mirror image, relative to the amplitude of z.

    It is the least over odd m of the largest |z(tau + m pi) + z(tau)|, and 0 for a motion that recurs after
    an odd number of half periods.
    """
    total = amplitude = 0.0
    for k in range(table.shape[0]):
        total += table[k, LENGTH]
        amplitude = max(amplitude, abs(table[k, Z_END]))
    halves = half_periods(total)
    if halves % 2 == 1:
        return 0.0
    size = halves * _SAMPLES
    tau = np.empty(size)
    for j in range(size):
        tau[j] = total * j / size
    z = np.zeros(size)
    samples = Samples(
        np.empty((st.n, size)), np.empty((st.n, size)), z, np.empty(size), np.empty(size, dtype=np.int8)
    )  # fmt: skip
    sample_segments(st, beta, table, tau, samples, work, scratch)
    return _least_difference(z, halves) / amplitude
