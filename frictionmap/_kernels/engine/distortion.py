"""Integral of the square of a steady motion without its mean and first harmonic."""

import math

from ..compiler import kernel
from ..structure.oscillators import advance, expand, watch
from .dissipation import integral_of_square
from .extremes import set_watch
from .segment_table import COS, LENGTH, SIGN, SIN, take_start


@kernel
def distortion_square(st, beta, outputs, uncoupled, i, k, mean, first, table, work, scratch):
    """Integral of (x - X_0 - Re X_1 e^{i tau})^2 over a segment table, x being the k-th row of `outputs`.

    Mean and first harmonic are subtracted before squaring, so that a small remainder is not the difference of
    large numbers.

    Parameters
    ----------
    st : StructureAtFrequency
    beta : kinetic friction force
    outputs : OutputMatrices; k : its row
    uncoupled : UncoupledResponse; i : index of the frequency
    mean, first : X_0, and X_1 (complex)
    table : (segments, columns) segment table
    work, scratch : Workspace, Scratch
    """
    total = 0.0
    for j in range(table.shape[0]):
        row = table[j]
        slides, n, state = take_start(st, row, work)
        watched = work.table[: n + 1]
        phasor = (uncoupled.sliding[i, k] if slides else uncoupled.held[i, k]) - first
        force, offset = set_watch(st, outputs, k, beta, phasor, row, slides, n, watched)
        # mirroring changes the sign of the mean; the load changes sign too, and with it the first harmonic
        offset -= row[SIGN] * mean
        angle, length = math.atan2(row[SIN], row[COS]), row[LENGTH] / st.h
        for step in range(int(math.ceil(length))):
            last = min(1.0, length - step)
            c, s = math.cos(angle + step * st.h), math.sin(angle + step * st.h)
            expand(watched, n, force, state, c, s, st.h, st.terms, scratch.series)
            watch(watched, c, s, scratch.series, scratch.watched)
            scratch.watched[0] += offset
            total += st.h * integral_of_square(scratch.watched, st.terms, last)
            advance(scratch.series, n, st.terms, last, state)
    return total
