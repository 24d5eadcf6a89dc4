"""Two masses from a sweep: the closed form, estimates against truths, what cannot be determined."""

import json
import re

import numpy as np
import pytest
from sweeps import F_K1M1, FREQUENCIES, GAMMA, KAPPA, amplitudes, responses

import frictionmap as fm
from frictionmap.identify.chain.two_masses import ratio_slopes, ratios


def test_ratios_of_a_known_structure():
    """Natural frequencies of M and K lead back to gamma and kappa."""
    K = np.array([[1.0 + KAPPA, -KAPPA], [-KAPPA, KAPPA]])
    f1, f2 = np.sqrt(np.linalg.eigvals(np.diag([1.0, 1.0 / GAMMA]) @ K)[[0, 1]]) * F_K1M1
    f1, f2 = sorted((f1, f2))
    found = ratios(np.sqrt(KAPPA / GAMMA) * F_K1M1, f1, f2)
    np.testing.assert_allclose(found, [F_K1M1, GAMMA, KAPPA], rtol=1e-13)


def test_ratios_of_the_reference(measured):
    for row in json.loads((measured / "exact.json").read_text())["exact_values"]["appendix_a"]:
        found = ratios(row["f0"], row["f1"], row["f2"])
        np.testing.assert_allclose(found, [row["f_k1m1"], row["gamma"], row["kappa"]], rtol=1e-12)


def test_slopes_of_the_ratios():
    at = np.array([3.1, 1.8, 4.9])
    for k, slope in enumerate(ratio_slopes(*at).T):
        step = 1e-6 * np.eye(3)[k]
        difference = (np.log(ratios(*(at + step))) - np.log(ratios(*(at - step)))) / 2e-6
        np.testing.assert_allclose(slope, difference, rtol=1e-7)


def test_exact_amplitudes_give_the_structure_back():
    ds = fm.identify.sweep(FREQUENCIES, amplitudes(FREQUENCIES))
    found = ds.estimate.sel(parameter=["f_k1m1", "gamma", "kappa"])
    np.testing.assert_allclose(found, [F_K1M1, GAMMA, KAPPA], rtol=1e-7)


def test_errors_are_those_of_many_sweeps():
    """Standard errors with 2 % given: the scatter over 24 seeds is known to 15 %."""
    exact = amplitudes(FREQUENCIES)
    found, stated = [], []
    for seed in range(24):
        noise = np.random.default_rng(seed).normal(0.0, 0.02, exact.size)
        ds = fm.identify.sweep(FREQUENCIES, exact * np.exp(noise), sigma_amplitude=0.02)
        found.append(ds.estimate.values)
        stated.append(ds.standard_error.values)
    scatter = np.std(found, axis=0, ddof=1)
    np.testing.assert_allclose(scatter / np.median(stated, axis=0), 1.0, atol=0.35)


@pytest.mark.parametrize("folder", ["visible-1", "visible-2"])
def test_synthetic_sweeps(measured, folder):
    truth = json.loads((measured / folder / "truth.json").read_text())["sweep-two-storey"]
    f, x = np.loadtxt(measured / folder / "sweep-two-storey.csv", delimiter=",", skiprows=1, unpack=True)
    ds = fm.identify.sweep(f, x, sigma_amplitude=0.02)
    for name, tolerance in truth["tolerance"].items():
        one = ds.sel(parameter=name)
        assert abs(float(one.estimate) - truth[name]) < tolerance, name
        assert 0.8 < float(one.standard_error) / truth["crb"][name] < 1.25, name
    assert ds.verdict.flag_meanings.split()[int(ds.verdict)] == "two_frequencies_found"


def test_errors_that_are_too_small_are_reported():
    x = amplitudes(FREQUENCIES) * np.exp(np.random.default_rng(1).normal(0.0, 0.05, FREQUENCIES.size))
    ds = fm.identify.sweep(FREQUENCIES, x, sigma_amplitude=0.01)
    assert ds.verdict.flag_meanings.split()[int(ds.verdict)] == "scatter_beyond_errors"


def test_one_peak():
    f = np.linspace(0.5, 7.75, 30)
    with pytest.raises(fm.InputError, match="must have two peaks for two frequencies; got one peak"):
        fm.identify.sweep(f, 1.0 / abs(1.0 - (f / 3.1) ** 2))


@pytest.mark.parametrize(
    ("frequency", "amplitude", "message"),
    [
        (
            [1.0, 2.0, 3.0],
            [1.0, 2.0, 1.0],
            "frequency must have more values than unknowns, 3; got 3",
        ),
        ([-1.0, 2.0], [1.0, 2.0], "frequency must be finite and > 0; got -1.0 at index 0"),
        ([1.0, 2.0], [1.0, 0.0], "amplitude_ratio of mass 1 must be finite and > 0; got 0.0 at index 1"),
        ([1.0, 2.0], [1.0], "amplitude_ratio of mass 1 must be 2 numbers, one per frequency"),
    ],
)
def test_bad_sweeps(frequency, amplitude, message):
    with pytest.raises(fm.InputError, match=message):
        fm.identify.sweep(frequency, amplitude)


def test_amplitudes_and_lags_have_errors_of_their_own():
    """Amplitudes with 5 %, lags with 0.3 deg: the weight of each follows from its own residuals."""
    f = np.linspace(0.5, 8.0, 80)
    X = responses(f, [1.0, GAMMA], [1.0, KAPPA], [0.02, 0.02], F_K1M1)[:, 0]
    noise = np.random.default_rng(2).normal(size=(2, f.size))
    amplitude, lag = np.abs(X) * np.exp(0.05 * noise[0]), 0.3 * noise[1] - np.degrees(np.angle(X))
    ds = fm.identify.sweep(f, amplitude, lag)
    of_lags = ds.quantity.values == 1
    # deviations of 80 numbers are known to 8 %
    np.testing.assert_allclose(ds.sigma.values[~of_lags], 0.05, rtol=0.25)
    np.testing.assert_allclose(ds.sigma.values[of_lags], np.radians(0.3), rtol=0.25)
    given = fm.identify.sweep(f, amplitude, lag, sigma_amplitude=0.05, sigma_phase=0.3)
    np.testing.assert_allclose(ds.standard_error, given.standard_error, rtol=0.25)
    assert np.abs((ds.estimate - given.estimate) / given.standard_error).max() < 0.5


def beside_a_sample(seed):
    """A sweep with 2 % noise of random masses and springs; their truth, f_k1m1, gamma and kappa."""
    rng = np.random.default_rng([3, 0, seed])
    truth = rng.uniform(2.0, 5.0), *rng.uniform(0.7, 1.4, 2)
    ratios = (np.linspace(0.2, 0.56, 6), np.linspace(0.68, 1.58, 14), np.linspace(1.75, 2.6, 6))
    f = truth[0] * np.concatenate(ratios)
    exact = amplitudes(f, truth[1], truth[2], truth[0])
    return truth, f, exact * np.exp(rng.normal(0.0, 0.02, f.size))


def test_resonances_next_to_a_sample():
    """Searches stop at the sample next to a resonance: the other side of it has the least sum.

    The second resonance lies 0.4 mHz below a sample; on the wrong side of others f1 is 50 errors off.
    """
    truth, *data = beside_a_sample(28)
    ds = fm.identify.sweep(*data).sel(parameter=["f_k1m1", "gamma", "kappa"])
    assert float(ds.reduced_chi_square) < 2.0 * 0.02**2
    assert np.abs((ds.estimate - truth) / ds.standard_error).max() < 4.0


def test_fits_on_both_sides_of_a_sample_are_reported():
    """The second resonance is so near to a sample that noise makes its other side the better one."""
    truth, *data = beside_a_sample(299)
    ds = fm.identify.sweep(*data)
    found = re.search(r"the data fit f_k1m1 ([\d.]+), gamma ([\d.]+), kappa ([\d.]+)", ds.warnings)
    assert found is not None
    errors = ds.standard_error.sel(parameter=["f_k1m1", "gamma", "kappa"])
    assert np.abs((np.array(found.groups(), dtype=float) - truth) / errors).max() < 4.0
