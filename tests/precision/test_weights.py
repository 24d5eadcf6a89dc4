"""Errors of estimates whose weights follow from their own residuals."""

import numpy as np
import pytest

from frictionmap.identify.statistics.least_squares import Problem, Solution, errors
from frictionmap.identify.statistics.weights import estimated_weights, freedom_by_kind

#: Two kinds of samples, twelve each.
KIND = np.repeat([0, 1], 12)


def problem_of(slopes, data):
    n = slopes.shape[1]
    none = np.full(n, -np.inf)
    return Problem(lambda v: (slopes @ v - data, slopes), np.ones(n, dtype=bool), none, none, -none)


def solved(slopes, data):
    values = np.linalg.lstsq(slopes, data, rcond=None)[0]
    return Solution(values, slopes @ values - data, slopes, np.zeros(values.size, dtype=bool))


def test_a_mean_of_two_samples():
    """Meier (Biometrics 9, 1953): the variance of a weighted mean grows by 1 + 4 sum p (1 - p)/n."""
    sigma = np.where(KIND == 0, 1.0, 2.0)
    slopes = (1.0 / sigma)[:, np.newaxis]
    best = solved(slopes, np.linspace(-1.0, 1.0, KIND.size))
    p = np.array([0.8, 0.2])  # of the information
    n = 12.0 - p  # the one unknown takes so much of the residuals
    np.testing.assert_allclose(freedom_by_kind(best, np.array([True]), KIND), n)
    both = estimated_weights(problem_of(slopes, best.residual), best, KIND, np.array([True, True]))
    np.testing.assert_allclose(both.larger**2, 1.0 + 4.0 * np.sum(p * (1.0 - p) / n))
    np.testing.assert_allclose(both.freedom, 1.0 / np.sum(p**2 / n))
    one = estimated_weights(problem_of(slopes, best.residual), best, KIND, np.array([True, False]))
    np.testing.assert_allclose(one.larger**2, 1.0 + 4.0 * 0.16 / n[0])
    none = estimated_weights(problem_of(slopes, best.residual), best, KIND, np.array([False, False]))
    np.testing.assert_array_equal(none.larger, 1.0)
    np.testing.assert_allclose(none.freedom, 23.0)  # samples less unknowns


@pytest.mark.parametrize("scale", [(1.0, 1.0), (1.0, 5.0)])
def test_intervals_with_estimated_weights_hold_the_truth(scale):
    """Of 10,000 fits of 24 points of two unknown variances 94.2 and 95.1 % hold it, 2 % less without."""
    rng = np.random.default_rng(7)
    x = rng.normal(size=(KIND.size, 4))
    sigma = np.array(scale)[KIND]
    inside, plain = 0, 0
    trials = 2000
    for _ in range(trials):
        data = rng.normal(0.0, sigma)
        size = np.ones(2)
        for _ in range(8):
            weight = 1.0 / size[KIND]
            best = solved(x * weight[:, np.newaxis], data * weight)
            left = freedom_by_kind(best, np.ones(4, dtype=bool), KIND)
            size *= np.sqrt(np.bincount(KIND, best.residual**2) / left)
        task = problem_of(best.slopes, data * weight)
        scaling = estimated_weights(task, best, KIND, np.array([True, True]))
        for found, allowed in ((errors(task, best), False), (errors(task, best, scaling=scaling), True)):
            held = int(((found.lower <= 0.0) & (found.upper >= 0.0)).sum())
            inside, plain = inside + held * allowed, plain + held * (not allowed)
    assert 0.935 < inside / (4 * trials) < 0.965
    assert plain < inside - 0.01 * 4 * trials
