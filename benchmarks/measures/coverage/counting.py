"""Rows of the table from trials: coverage of the intervals, refusals, warnings, times."""

from collections import Counter

import numpy as np
from scipy.stats import binom

from ...report.record import spread
from .case import Estimate, Trial

#: Stated coverage of the intervals, and the share of counts that the band around it holds by chance.
STATED, BAND = 0.95, 0.95

#: A count that chance makes so rarely falls short of the stated coverage, whatever the number of rows.
RARE = 1e-3


def band(trials: int) -> tuple[float, float]:
    """Smallest and largest coverage of BAND of all counts, if every interval contains its true value with
    STATED.
    """
    low, high = binom.interval(BAND, trials, STATED)
    return float(low) / trials, float(high) / trials


def row(trials: list[Trial]) -> dict:
    """Summarise the trials of a case."""
    answered = [trial for trial in trials if trial.refusal is None]
    names = list(dict.fromkeys(name for trial in answered for name in trial.estimates))
    return {
        "seeds": len(trials),
        "refused": len(trials) - len(answered),
        "refusals": dict(Counter(trial.refusal for trial in trials if trial.refusal).most_common()),
        "warned": sum(bool(trial.warnings) for trial in answered),
        "warnings": dict(Counter(words for trial in answered for words in trial.warnings).most_common()),
        "processor seconds a fit": spread([trial.seconds for trial in trials]),
        "parameters": {name: _parameter(name, answered) for name in names},
    }


def _parameter(name: str, answered: list[Trial]) -> dict:
    """Coverage of one parameter over the fits that estimate it, and its errors over the stated ones."""
    found: list[tuple[int, Estimate]] = [
        (trial.seed, trial.estimates[name]) for trial in answered if name in trial.estimates
    ]
    inside = sum(one.inside for _, one in found)
    with_error = [(abs(one.deviation), seed) for seed, one in found if np.isfinite(one.deviation)]
    bounded = [one.of_bound for _, one in found if np.isfinite(one.of_bound)]
    worst, seed = max(with_error, default=(None, None))
    low, high = band(len(found))
    return {
        "fits": len(found),
        "inside": inside,
        "coverage": inside / len(found),
        "band": [low, high],
        "below the band": inside / len(found) < low,
        "short": bool(binom.cdf(inside, len(found), STATED) < RARE),
        "error over standard error": {
            "median": float(np.median([one for one, _ in with_error])) if with_error else None,
            "worst": worst,
            "seed of the worst": seed,
        },
        "standard error over Cramer-Rao bound": float(np.median(bounded)) if bounded else None,
        "seeds outside": [seed for seed, one in found if not one.inside][:20],
    }
