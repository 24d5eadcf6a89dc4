"""Time history of a steady state, sampled from its segment table."""

import math
from typing import NamedTuple

import numpy as np

from ..compiler import entry, kernel
from ..compiler.packed import packed
from ..structure.newton import copy_state
from ..structure.oscillators import advance, expand
from ..structure.state import contact_displacement, held_load, release
from .segment_table import BEGIN, COS, LENGTH, SENSE, SIGN, SIN, STOP_Z, take_start


class Samples(NamedTuple):
    """A motion at k times."""

    coordinates: np.ndarray  # (n, k) coordinates of the free oscillators
    velocities: np.ndarray  # (n, k) their derivatives in tau
    z: np.ndarray  # (k,)
    friction: np.ndarray  # (k,)
    sense: np.ndarray  # (k,) int8


@kernel
def _sample(st, beta, table, tau, samples, work, scratch):
    """Fill the samples; the parameters are those of `sample_segments`.

    Parameters
    ----------
    st, beta, table, tau, samples, work, scratch : see `sample_segments`
    """
    st, samples, work, scratch = packed(st), packed(samples), packed(work), packed(scratch)
    z, friction = samples.z, samples.friction
    j = 0
    for k in range(table.shape[0]):
        row = table[k]
        begin = row[BEGIN]
        end = begin + row[LENGTH]
        slides, n, current = take_start(st, row, work)
        oscillators = st.free if slides else st.held
        force = beta if slides else 0.0
        angle = math.atan2(row[SIN], row[COS])
        node = 0.0
        expand(oscillators, n, force, current, row[COS], row[SIN], st.h, st.terms, scratch.series)
        while j < tau.size and tau[j] < end:
            while tau[j] - begin > node + st.h:
                advance(scratch.series, n, st.terms, 1.0, current)
                node += st.h
                expand(
                    oscillators, n, force, current, math.cos(angle + node), math.sin(angle + node), st.h,
                    st.terms, scratch.series,
                )  # fmt: skip
            x = (tau[j] - begin - node) / st.h
            advance(scratch.series, n, st.terms, x, scratch.next)
            c, s = math.cos(angle + tau[j] - begin), math.sin(angle + tau[j] - begin)
            if slides:
                copy_state(scratch.next, work.start, n)
                z[j] = row[SIGN] * contact_displacement(st, work.start, c, s)
                friction[j] = row[SIGN] * beta
            else:
                release(st, scratch.next, row[STOP_Z], c, s, work.start)
                z[j] = row[SIGN] * row[STOP_Z]
                friction[j] = -row[SIGN] * held_load(st, scratch.next, row[STOP_Z], c, s)
            samples.sense[j] = int(row[SIGN] * row[SENSE])
            for i in range(st.n):
                samples.coordinates[i, j] = row[SIGN] * work.start[0, i]
                samples.velocities[i, j] = row[SIGN] * work.start[1, i] / st.h
            j += 1


@entry
def sample_segments(st, beta, table, tau, samples, work, scratch):
    """Fill `samples` with the motion at given times.

    Parameters
    ----------
    st : StructureAtFrequency
    beta : kinetic friction force
    table : (segments, columns) segment table
    tau : (k,) increasing times >= 0 since the first segment began
    samples : Samples
    work, scratch : Workspace, Scratch
    """
    _sample(st, beta, table, tau, samples, work, scratch)
