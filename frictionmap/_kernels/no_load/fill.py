"""Portraits of all cells; the fastest belt with a stick-slip cycle."""

import math

import numpy as np

from ..compiler import entry, kernel
from .cycles import MOST_CYCLES, Search
from .orbit import NUMBERS, STOP, Belt
from .portrait import put_portrait, slip_from_release

#: Belt speeds tried, over the largest speed of the friction: octaves to either side, and speeds in an octave.
_OCTAVES, _IN_AN_OCTAVE = 30, 16

#: Octaves above it if nothing damps the last segment: a drop d of the friction changes the velocity of the
#: slip by d^2/v^2 of it, which must stay above rounding errors.
_UNDAMPED_OCTAVES = 12


@entry
def fill_portraits(speeds, factors, slopes, zeta, mu, v, beta, found):
    """Fill the portraits of all cells of a grid.

    Parameters
    ----------
    speeds, factors, slopes : (K,) segments of the law
    zeta : damping ratio
    mu, v, beta : axes; v > 0
    found : Portraits over (mu, v, beta)
    """
    critical = np.empty(4 * speeds.size + 4)
    cycles, damping = np.empty(MOST_CYCLES), np.empty(MOST_CYCLES)
    search = Search(np.empty((3, NUMBERS)), critical, cycles, damping, np.empty(1, np.int64))
    for m in range(mu.size):
        for i in range(v.size):
            for b in range(beta.size):
                belt = Belt(speeds, factors, slopes, zeta, beta[b], mu[m], v[i])
                put_portrait(belt, found, (m, i, b), search)


@kernel
def _has_cycle(speeds, factors, slopes, zeta, beta, mu, v, turns):
    """Whether there is a stick-slip cycle.

    Parameters
    ----------
    speeds, factors, slopes : (K,) segments of the law
    zeta, beta, mu, v : damping ratio, friction and its ratio, belt speed
    turns : (2, NUMBERS)
    """
    belt = Belt(speeds, factors, slopes, zeta, beta, mu, v)
    return slip_from_release(belt, turns[0], turns[1]) == STOP


@entry
def fill_cycle_speeds(speeds, factors, slopes, zeta, mu, beta, found):
    """Fill the largest belt speed with a stick-slip cycle, (n_mu, n_beta): 0 if none, infinite if any.

    Speeds are tried from the largest one down; between one without a cycle and the next with one, the limit
    is found by bisection.

    Parameters
    ----------
    speeds, factors, slopes : (K,) segments of the law
    zeta : damping ratio
    mu, beta : axes
    found : (n_mu, n_beta)
    """
    turns = np.empty((2, NUMBERS))
    for m in range(mu.size):
        for b in range(beta.size):
            scale = max(beta[b] * mu[m], speeds[-1])
            above, found[m, b] = math.inf, 0.0
            damped = zeta + 0.5 * beta[b] * slopes[-1] > 0.0
            top = _OCTAVES if damped else _UNDAMPED_OCTAVES
            for j in range(top * _IN_AN_OCTAVE, -_OCTAVES * _IN_AN_OCTAVE - 1, -1):
                v = scale * 2.0 ** (j / _IN_AN_OCTAVE)
                if v > 0.0 and _has_cycle(speeds, factors, slopes, zeta, beta[b], mu[m], v, turns):
                    found[m, b] = math.inf if above == math.inf else v
                    break
                above = v
            low, high = found[m, b], above
            while 0.0 < low < math.inf:
                v = 0.5 * (low + high)
                if v == low or v == high:
                    break
                if _has_cycle(speeds, factors, slopes, zeta, beta[b], mu[m], v, turns):
                    low = v
                else:
                    high = v
            found[m, b] = low
