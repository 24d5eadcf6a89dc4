"""A slow wander of the measured zero: found in the residuals, and described by polynomials of time.

The lag-1 correlation of residuals does not see a wander that is smaller than the noise, although it moves the
place of rest, and with it x_F, by many standard errors.  Legendre polynomials up to degree d follow d/pi
cycles in a record, roughly.
"""

import numpy as np
from numpy.polynomial import legendre
from scipy.special import chdtri

from .correlation import long_inflation
from .decay_fit import Fit, fit_decay, rounding_variance
from .decay_problem import DRIFT, Record, problem
from .turning_points import TurningPoints

#: Terms for each cycle of the decay: they follow what is slower than a quarter of its frequency.
_TERMS_PER_CYCLE = np.pi / 4.0

#: Terms at least and at most, and samples for each.
_FEWEST_TERMS, _MOST_TERMS, _SAMPLES_PER_TERM = 4, 16, 10

#: What a term must lower the sum by, in variances of a sample, to be of use (Akaike 1974).
_WORTH = 2.0

#: A wander is found if chance makes one as large in this share of all records.
_CHANCE = 1e-3

#: Another number of half cycles can change the number of terms; so many fits with such terms at most.
_PASSES = 2


def fit_with_wander(record: Record, points: TurningPoints) -> tuple[Record, list[Fit]]:
    """Fits as by `fit_decay`, with the terms of a wander as further unknowns if the residuals show one.

    The record that is returned holds these terms.
    """
    fits = fit_decay(record, points)
    for _ in range(_PASSES):
        terms = _wander_terms(record, fits[0])
        if terms.shape[1] == record.terms:
            break
        record = record._replace(wander=terms)
        fits = fit_decay(record, points)
    return record, fits


def _wander_terms(record: Record, fit: Fit) -> np.ndarray:
    """Slow functions of time, shape (samples, terms), that the residuals of a decay follow; perhaps none."""
    basis = polynomials(record, _most_terms(record, fit))
    wide = record._replace(wander=basis)
    named = len(record.names)
    values = np.concatenate((fit.solution.values[:named], np.zeros(basis.shape[1])))
    residual, slopes = problem(wide, fit.n, values).residuals(values)
    fitted = wide.free & np.concatenate((~fit.solution.at_bound[:named], np.ones(basis.shape[1], dtype=bool)))
    directions = np.linalg.qr(slopes[:, fitted])[0]
    shares = directions.T @ residual
    left = residual - directions @ shares
    variance = float(left @ left) / (left.size - shares.size) * long_inflation(left) ** 2
    variance = max(variance, rounding_variance(record))
    gains = np.cumsum(shares[-basis.shape[1] :] ** 2)
    terms = np.arange(1, basis.shape[1] + 1)
    best = int(np.argmax(gains / variance - _WORTH * terms))
    found = gains[best] / variance > chdtri(terms[best], _CHANCE)
    return basis[:, : best + 1 if found else 0]


def _most_terms(record: Record, fit: Fit) -> int:
    """Terms that are slower than the decay."""
    cycles = float(np.ptp(record.time)) * fit.decay.f_n
    most = min(_MOST_TERMS, record.time.size // _SAMPLES_PER_TERM)
    return int(np.clip(np.ceil(_TERMS_PER_CYCLE * cycles), min(_FEWEST_TERMS, most), most))


def polynomials(record: Record, terms: int) -> np.ndarray:
    """Legendre polynomials over a record, shape (samples, terms), above the degree of the named unknowns."""
    time = record.time
    lowest = 2 if DRIFT in record.names else 1
    scaled = 2.0 * (time - time[0]) / np.ptp(time) - 1.0
    return legendre.legvander(scaled, lowest + terms - 1)[:, lowest:]
