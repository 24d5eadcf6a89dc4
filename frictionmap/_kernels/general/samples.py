"""Displacements of a recorded motion at given phases."""

import math

from ..compiler import entry
from .crossings import value_at
from .problem import SECTION


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
