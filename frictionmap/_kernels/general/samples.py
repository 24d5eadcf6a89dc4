"""Displacements of a recorded motion at given phases, and their first harmonics."""

import math

from ..compiler import entry
from .crossings import value_at
from .problem import SECTION
from .record import NODES, WEIGHTS


@entry
def fill_samples(series, patterns, count, at, h, period, phases, places):
    """Fill the values of one series of the steps of a recorded motion.

    Parameters
    ----------
    series, patterns : steps of a `Record`
    count : number of steps
    at : row of the series
    h : length of an interval of the load
    period : periods of the load that the steps cover
    phases : (n,) phases of the load
    places : (n,) filled
    """
    whole = 2.0 * math.pi * period
    last = patterns.shape[1] - 1
    k = 0
    begin = 0.0
    for i in range(phases.size):
        since = (phases[i] - SECTION) % whole
        if since < begin:
            k, begin = 0, 0.0
        while k < count - 1 and since >= begin + patterns[k, last] * h:
            begin += patterns[k, last] * h
            k += 1
        places[i] = value_at(series[k], at, (since - begin) / h)


@entry
def fill_phasors(series, patterns, count, h, phasors):
    """Fill the first harmonics X of series of a recorded motion, x = Re X e^{i tau} + ...

    Parameters
    ----------
    series, patterns : steps of a `Record`, of whole periods of the load
    count : number of steps
    h : length of an interval of the load
    phasors : (2, n) filled with the real and imaginary parts of the first n series
    """
    last = patterns.shape[1] - 1
    for part in range(2):
        for m in range(phasors.shape[1]):
            phasors[part, m] = 0.0
    begin = 0.0
    for k in range(count):
        end = patterns[k, last]
        for i in range(NODES.size):
            x = end * NODES[i]
            tau = SECTION + begin + x * h
            weight = end * h * WEIGHTS[i]
            for m in range(phasors.shape[1]):
                value = weight * value_at(series[k], m, x)
                phasors[0, m] += value * math.cos(tau)
                phasors[1, m] -= value * math.sin(tau)
        begin += end * h
    for part in range(2):
        for m in range(phasors.shape[1]):
            phasors[part, m] *= 2.0 / begin
