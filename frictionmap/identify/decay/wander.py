"""A slow wander of the measured zero: found in the residuals, and described by polynomials of time.

The lag-1 correlation of residuals does not see a wander that is smaller than the noise, although it moves the
place of rest, and with it x_F, by many standard errors.  Legendre polynomials up to degree d follow d/pi
cycles in a record, roughly.
"""

from typing import NamedTuple

import numpy as np
from scipy.special import chdtrc

from ..signals.turning_points import TurningPoints
from ..statistics.correlation import long_inflation
from .fit import DecayFit, fit_decay, refit, rounding_variance
from .problem import Record, polynomials, problem

#: Terms for each cycle of the decay: they follow what is slower than a quarter of its frequency.
_TERMS_PER_CYCLE = np.pi / 4.0

#: Terms at least and at most, and samples for each.
_FEWEST_TERMS, _MOST_TERMS, _SAMPLES_PER_TERM = 4, 16, 10

#: What a term must lower the sum by, in variances of a sample, to be of use (Akaike 1974).
_WORTH = 2.0

#: Terms beyond the best number, and terms in all: the wander does not end where the noise covers it.
_MARGIN, _LEAST = 2, 8

#: A wander is found if chance makes one as large in this share of all records.
_FOUND = 1e-3

#: It is not excluded if chance makes one as large in no more than this share.
_NOT_EXCLUDED = 0.05

#: Maximum number of fits with terms: another number of half cycles can change the number of terms.
_PASSES = 2


class Search(NamedTuple):
    """Fits of a record that noise cannot distinguish."""

    record: Record  # with the terms of a wander, if one is found
    fits: list[DecayFit]  # the best one first
    doubted: Record | None  # with the terms of a wander that is neither found nor excluded
    also: list[DecayFit]  # fits of that


class _Wander(NamedTuple):
    """Slow wander seen in the residuals."""

    basis: np.ndarray  # shape (samples, terms)
    chance: float  # the probability that white noise shows as much


def search(record: Record, points: TurningPoints) -> Search:
    """Fits as by `fit_decay`, with the terms of a wander as further unknowns if the residuals show one."""
    fits = fit_decay(record, points)
    wander = _wander(record, fits[0])
    for _ in range(_PASSES):
        if wander.chance >= _FOUND or wander.basis.shape[1] == record.terms:
            break
        record = record._replace(wander=wander.basis)
        fits = fit_decay(record, points)
        wander = _wander(record, fits[0])
    if record.terms or wander.chance >= _NOT_EXCLUDED:
        return Search(record, fits, None, [])
    doubted = record._replace(wander=wander.basis)
    return Search(record, fits, doubted, [refit(doubted, fit) for fit in fits])


def _wander(record: Record, fit: DecayFit) -> _Wander:
    """Slow functions of time that the residuals of a decay follow best."""
    basis = polynomials(record.time, record.names, _most_terms(record, fit))
    wide = record._replace(wander=basis)
    steady = record.steady
    values = np.concatenate((fit.solution.values[:steady], np.zeros(basis.shape[1])))
    residual, slopes = problem(wide, fit.n, values).residuals(values)
    fitted = wide.free & np.concatenate(
        (~fit.solution.at_bound[:steady], np.ones(basis.shape[1], dtype=bool))
    )
    directions = np.linalg.qr(slopes[:, fitted])[0]
    shares = directions.T @ residual
    left = residual - directions @ shares
    variance = float(left @ left) / (record.counted - shares.size) * long_inflation(left) ** 2
    gains = np.cumsum(shares[-basis.shape[1] :] ** 2) / max(variance, rounding_variance(record))
    best = int(np.argmax(gains - _WORTH * np.arange(gains.size)))
    return _Wander(basis[:, : max(best + 1 + _MARGIN, _LEAST)], float(chdtrc(best + 1, gains[best])))


def _most_terms(record: Record, fit: DecayFit) -> int:
    """Terms that are slower than the decay."""
    cycles = float(np.ptp(record.time)) * fit.decay.f_n
    most = min(_MOST_TERMS, record.time.size // _SAMPLES_PER_TERM)
    return int(np.clip(np.ceil(_TERMS_PER_CYCLE * cycles), min(_FEWEST_TERMS, most), most))
