"""Phasors of records: recovered exactly, with errors as their scatter, and what cannot be determined."""

import numpy as np
import pytest

import frictionmap as fm
from frictionmap.identify.signals.phasors import (
    _checked_harmonics,
    amplitude_and_lag,
    changes,
    phasors_of,
    ratio_error,
)

PHASORS = np.array([[0.2, 1.8, 0.02j, 0.001], [-0.1, 1.5 - 1.2j, 0.1, 0.3 + 0.1j]])
DRIFT = np.array([0.001, -0.02])


def record(time, f=1.003, noise=(0.0, 0.0), seed=0):
    """Base and mass, phases counted from the middle of the record."""
    t = time - 0.5 * (time[0] + time[-1])
    n = np.arange(PHASORS.shape[1])
    exact = (np.exp(2j * np.pi * f * np.multiply.outer(t, n)) @ PHASORS.T).real + t[:, None] * DRIFT
    return exact + np.random.default_rng(seed).normal(size=exact.shape) * noise


@pytest.mark.parametrize("length", [2.3, 10.0, 33.7])
def test_exact_records_give_their_phasors_back(length):
    """Whole cycles are not needed, nor times that are equally spaced and begin at zero."""
    time = 5.0 + np.delete(np.arange(int(250 * length)) / 250.0, slice(100, 160))
    found = phasors_of(time, record(time))
    assert found.frequency == pytest.approx(1.003, rel=1e-11)
    np.testing.assert_allclose(found.values[:, :4], PHASORS, atol=1e-9)
    np.testing.assert_allclose(found.values[:, 4:], 0.0, atol=1e-9)
    np.testing.assert_allclose(found.drift, DRIFT, atol=1e-9)
    ratio = PHASORS[1, 1] / PHASORS[0, 1]
    np.testing.assert_allclose(amplitude_and_lag(found), [abs(ratio), -np.angle(ratio)], atol=1e-9)


def test_errors_are_those_of_many_records():
    """Scatter over 120 seeds is known to 6.5 %: four of its errors are allowed."""
    time = np.arange(1200) / 250.0
    fits = [phasors_of(time, record(time, noise=(0.003, 0.01), seed=seed)) for seed in range(120)]
    lags = np.array([amplitude_and_lag(fit) for fit in fits])
    scatter = {
        "frequency": (np.std([fit.frequency for fit in fits]), fits[0].frequency_error),
        "drift": (np.std([fit.drift[1] for fit in fits]), fits[0].drift_errors[1]),
        "amplitude ratio": (np.std(np.log(lags[:, 0])), ratio_error(fits[0])),
        "lag": (np.std(lags[:, 1]), ratio_error(fits[0])),
        "harmonic 3": (np.std([fit.values[1, 3].real for fit in fits]), fits[0].errors[1, 3]),
    }
    for name, (seen, stated) in scatter.items():
        assert seen / stated == pytest.approx(1.0, abs=0.26), name


def test_a_steady_record_does_not_change_and_another_one_does():
    time = np.arange(2500) / 250.0
    steady = record(time, noise=(0.003, 0.01))
    assert (changes(time, steady, phasors_of(time, steady)) < 13.8).all()  # chance makes more in 1 of 1000
    grown = steady * (1.0 + 0.002 * np.subtract.outer(time, [0.0, 5.0]) * [0.0, 1.0])
    base, mass = changes(time, grown, phasors_of(time, grown))
    assert base < 13.8 < mass
    assert changes(time[:600], steady[:600], phasors_of(time[:600], steady[:600])).size == 0


@pytest.mark.parametrize(
    ("time", "message"),
    [
        (np.arange(400) / 250.0, "time must span at least 2 cycles of the base; got 1.6"),
        (np.arange(100) / 5.0, "5 samples per cycle, 8 needed"),
    ],
)
def test_too_little_is_refused(time, message):
    with pytest.raises(fm.InputError, match=message):
        phasors_of(time, record(time))


def test_a_gap_leaves_too_few_samples():
    with pytest.raises(fm.InputError, match="time must have more samples than unknowns, 21; got 9"):
        _checked_harmonics(np.append(np.arange(8), 125) / 50.0, 1.0)
