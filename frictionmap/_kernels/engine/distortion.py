"""What is left of a steady motion when its mean and its first harmonic are taken away, by its square."""

import math

from ..jit import kernel
from ..structure.oscillators import advance, expand, watch
from .dissipation import integral_of_square
from .extremes import set_watch
from .segment_table import COS, LENGTH, SIGN, SIN, take_start


@kernel
def distortion_square(st, beta, outputs, uncoupled, i, k, mean, first, table, work, scratch):
    """int (x - X_0 - Re X_1 e^{i tau})^2 dtau over a table of phases, x the k-th row of `outputs`.

    What is small is not left over from what is large: mean and first harmonic go before the square is taken.
    Eleven arguments: of a structure, of a frequency, of a row.
    """
    total = 0.0
    for j in range(table.shape[0]):
        row = table[j]
        slides, n, state = take_start(st, row, work)
        watched = work.table[: n + 1]
        phasor = (uncoupled.sliding[i, k] if slides else uncoupled.held[i, k]) - first
        force, offset = set_watch(st, outputs, k, beta, phasor, row, slides, n, watched)
        # in a mirror image the mean changes its sign; so does the load, and with it the first harmonic
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
