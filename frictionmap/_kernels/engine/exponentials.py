"""The motion in a phase as a sum of exponentials, from which harmonics and works follow in closed form."""

import math

from ..jit import entry, kernel
from ..structure.oscillators import F1, FC, FS, OMEGA, ZETA, D, K
from .phase_table import COS, SENSE, SIN, STATE

#: Columns of the sums, complex, one row an oscillator.  With theta = tau since the start of the phase its
#: coordinate is Re(LOAD e^{i theta} + REST + FREE e^{RATE theta} + OTHER e^{OTHER_RATE theta}); where the two
#: rates are equal, at critical damping, OTHER is that of theta e^{RATE theta}.
LOAD, REST, FREE, RATE, OTHER, OTHER_RATE = 0, 1, 2, 3, 4, 5
COLUMNS = 6


@kernel
def _fill_free(zeta, rate, place, speed, out):
    """The free motion from a place and a speed, per tau; `rate` is the frequency per tau."""
    root = math.sqrt(abs(1.0 - zeta) * (1.0 + zeta))
    if zeta < 1.0:
        s = complex(-zeta * rate, root * rate)
        out[FREE] = complex(place, (place * s.real - speed) / s.imag)
        out[RATE] = s
        out[OTHER] = 0.0
        out[OTHER_RATE] = s.conjugate()
        return
    slow, fast = -rate / (zeta + root), -rate * (zeta + root)
    out[RATE], out[OTHER_RATE] = slow, fast
    if root == 0.0:
        out[FREE], out[OTHER] = place, speed - slow * place
    else:
        out[FREE] = (speed - fast * place) / (slow - fast)
        out[OTHER] = (slow * place - speed) / (slow - fast)


@entry
def fill_exponentials(st, beta, row, out):
    """The sums of a phase, a row of the table of phases: `out` (n, COLUMNS), complex; how many oscillators.

    Free modes in a slide, held oscillators in a stop.  An undamped one that the load drives at its own
    frequency grows with theta and is no such sum: its LOAD is infinite.
    """
    slides = row[SENSE] > 0.0
    n = st.n if slides else st.m
    table = st.free if slides else st.held
    phase = complex(row[COS], row[SIN])
    for i in range(n):
        stiffness = complex(table[i, K] - st.h * st.h, st.h * table[i, D])
        force = complex(table[i, FC], -table[i, FS])
        load = 0j
        if force != 0j:
            load = force / stiffness * phase if stiffness != 0j else complex(math.inf, 0.0)
        rest = table[i, F1] * beta / table[i, K] if slides else 0.0
        out[i, LOAD] = load
        out[i, REST] = rest
        place = row[STATE + i] - rest - load.real
        speed = row[STATE + n + i] / st.r + load.imag
        _fill_free(table[i, ZETA], table[i, OMEGA] / st.r, place, speed, out[i])
    return n
