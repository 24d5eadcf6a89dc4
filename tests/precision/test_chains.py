"""Chains of masses from sweeps: the model against M, K and C, chains recovered, what cannot be determined."""

import re

import numpy as np
import pytest
from sweeps import natural_frequencies, responses

import frictionmap as fm
from frictionmap.identify.chain.inverse import chain_of
from frictionmap.identify.chain.response import response_and_slopes

MASSES, SPRINGS = [1.0, 1.3, 0.7, 0.9, 1.1], [1.0, 0.8, 1.2, 0.6, 1.4]
ZETA = [0.01, 0.02, 0.015, 0.03, 0.012]
F_K1M1 = 3.0


def unknowns(n, zeta=ZETA):
    return np.array([*np.log([F_K1M1, *MASSES[1:n], *SPRINGS[1:n]]), *zeta[:n]])


def chain(n):
    return MASSES[:n], SPRINGS[:n]


def band(n, samples=27):
    """Frequencies from well below the first natural frequency to well above the last one."""
    natural = natural_frequencies(*chain(n), F_K1M1)
    return np.linspace(0.3 * natural[0], 1.4 * natural[-1], samples * n)


# The model


@pytest.mark.parametrize("base_damping", [False, True])
@pytest.mark.parametrize("n", [1, 2, 3, 5])
def test_responses_are_those_of_the_matrices(n, base_damping):
    f = band(n)
    expected = responses(f, *chain(n), ZETA[:n], F_K1M1, base_damping)
    found, _ = response_and_slopes(unknowns(n), f, base_damping)
    np.testing.assert_allclose(found, expected, atol=1e-12 * np.abs(expected).max())


@pytest.mark.parametrize("base_damping", [False, True])
@pytest.mark.parametrize("n", [1, 2, 4])
def test_slopes_are_those_of_the_response(n, base_damping):
    """Against central differences of step h: their error is some h^2 over the squared width of a peak."""
    at, f, h = unknowns(n), band(n), 1e-6
    _, slopes = response_and_slopes(at, f, base_damping)
    for k in range(at.size):
        step = h * np.eye(at.size)[k]
        above, below = (response_and_slopes(at + s, f, base_damping)[0] for s in (step, -step))
        difference = (above - below) / (2.0 * h)
        np.testing.assert_allclose(slopes[:, :, k], difference, atol=1e-6 * np.abs(difference).max())


@pytest.mark.parametrize("n", [1, 2, 3, 5])
def test_peaks_and_zeros_of_the_first_mass_give_the_chain_back(n):
    """Zeros are the natural frequencies of the rest when mass 1 is held: masses 2 to n on spring 2."""
    masses, springs = chain(n)
    zeros = np.zeros(0)
    if n > 1:
        first = F_K1M1 * np.sqrt(springs[1] / masses[1])
        zeros = natural_frequencies(
            np.divide(masses[1:], masses[1]), np.divide(springs[1:], springs[1]), first
        )
    found = chain_of(natural_frequencies(masses, springs, F_K1M1), zeros)
    np.testing.assert_allclose(found, unknowns(n)[: 2 * n - 1], atol=1e-11)


# Estimates


@pytest.mark.parametrize(
    ("n", "measured"),
    [(1, "first"), (2, "first"), (2, "all"), (3, "first and last"), (3, "all"), (4, "first")],
)
def test_exact_amplitudes_give_the_chain_back(n, measured):
    f = band(n)
    X = np.abs(responses(f, *chain(n), np.zeros(n), F_K1M1))
    which = {"first": [1], "first and last": [1, n], "all": range(1, n + 1)}[measured]
    ds = fm.identify.sweep(f, {mass: X[:, mass - 1] for mass in which}, masses=n)
    expected = [F_K1M1, *MASSES[1:n], *SPRINGS[1:n]]
    np.testing.assert_allclose(ds.estimate[-len(expected) :], expected, rtol=1e-7)


@pytest.mark.parametrize(("n", "damping"), [(1, "ground"), (2, "base"), (3, "ground"), (5, "base")])
def test_lags_determine_the_damping(n, damping):
    f = band(n, 40)
    X = responses(f, *chain(n), ZETA[:n], F_K1M1, damping == "base")
    which = sorted({1, (n + 1) // 2, n})
    amplitude = {mass: np.abs(X[:, mass - 1]) for mass in which}
    lag = {mass: -np.degrees(np.angle(X[:, mass - 1])) for mass in which}
    ds = fm.identify.sweep(f, amplitude, lag, masses=n, damping=damping)
    found = ds.estimate.sel(parameter=[f"zeta_{k}" for k in range(1, n + 1)])
    np.testing.assert_allclose(found, ZETA[:n], rtol=1e-7)


def test_frequencies_and_a_mass_leave_two_chains():
    """The second mass moves alike in both; f0^2 are the roots of (u - f1^2)(f2^2 - u) = gamma u^2.

    Rounding decides which of them is stated, and which is the one that fits as well.
    """
    f = band(2)
    X = responses(f, *chain(2), ZETA[:2], F_K1M1)[:, 1]
    ds = fm.identify.sweep(f, {2: np.abs(X)}, {2: -np.degrees(np.angle(X))}, known={"gamma": MASSES[1]})
    f1, f2 = natural_frequencies(*chain(2), F_K1M1)
    true = F_K1M1 * np.sqrt(SPRINGS[1] / MASSES[1])
    other = f1 * f2 / (true * np.sqrt(1.0 + MASSES[1]))
    assert bool(ds.known.sel(parameter="gamma"))
    assert not ds.known.sel(parameter=["f0", "f1", "f2", "f_k1m1", "kappa"]).any()
    found = ds.estimate.sel(parameter=["f0", "f1", "f2"]).values
    f0 = min(true, other, key=lambda one: abs(one - found[0]))
    np.testing.assert_allclose(found, [f0, f1, f2], rtol=1e-6)
    unstated = f1 * f2 / (other if f0 == true else true)
    assert f"the data fit f_k1m1 {unstated:.4g}" in ds.warnings


def test_frequencies_may_come_in_any_order_and_twice():
    f = band(2)
    x = np.abs(responses(f, *chain(2), [0.0, 0.0], F_K1M1)[:, 0])
    x *= np.exp(np.random.default_rng(3).normal(0.0, 0.02, x.size))
    twice = np.concatenate((f, f)), np.concatenate((x, x))
    order = np.random.default_rng(4).permutation(twice[0].size)
    once = fm.identify.sweep(f, x, sigma_amplitude=0.02)
    mixed = fm.identify.sweep(twice[0][order], twice[1][order], sigma_amplitude=0.02)
    np.testing.assert_allclose(mixed.estimate, once.estimate, rtol=1e-8)


@pytest.mark.slow
def test_errors_of_three_masses_are_those_of_many_sweeps():
    """Squares of scaled deviations over 40 seeds are 1, give or take 0.22; 95 % lie in the intervals."""
    f = band(3)
    X = responses(f, *chain(3), ZETA[:3], F_K1M1)
    truth = np.array([F_K1M1, *MASSES[1:3], *SPRINGS[1:3], *ZETA[:3]])
    deviations, held = [], []
    for seed in range(40):
        noise = np.random.default_rng(seed).normal(0.0, 0.02, (2, *X.shape))
        amplitude, lag = np.abs(X) * np.exp(noise[0]), np.degrees(noise[1] - np.angle(X))
        ds = fm.identify.sweep(
            f, {1: amplitude[:, 0], 3: amplitude[:, 2]}, {1: lag[:, 0], 3: lag[:, 2]}, masses=3
        )
        deviations.append((ds.estimate.values - truth) / ds.standard_error.values)
        held.append((ds.lower.values <= truth) & (truth <= ds.upper.values))
    np.testing.assert_allclose(np.mean(np.square(deviations), axis=0), 1.0, atol=0.7)
    assert np.mean(held) == pytest.approx(0.95, abs=0.04)


def test_the_relative_cost_is_that_of_the_thesis():
    """T(6.16): at its least, no small change of the three frequencies makes it less."""
    f = band(2)
    x = np.abs(responses(f, *chain(2), [0.0, 0.0], F_K1M1)[:, 0])
    x *= np.exp(np.random.default_rng(7).normal(0.0, 0.05, x.size))
    ds = fm.identify.sweep(f, x, cost="relative")
    at = ds.estimate.sel(parameter=["f0", "f1", "f2"]).values

    def cost(f0, f1, f2):
        model = (f1 * f2 / f0) ** 2 * (f0**2 - f**2) / ((f1**2 - f**2) * (f2**2 - f**2))
        return np.sum((x - np.abs(model)) ** 2 / x**2)

    least = cost(*at)
    assert float(np.sum(ds.residual**2)) == pytest.approx(least, rel=1e-8)
    for step in np.vstack((np.eye(3), -np.eye(3))) * 1e-4:
        assert cost(*(at + step)) > least
    assert cost(*fm.identify.sweep(f, x).estimate.values[:3]) > least


def test_outliers_of_a_sweep_have_little_weight():
    """Two amplitudes of 54 are twice and half what they are: 35 times the noise."""
    f = band(2)
    exact = np.abs(responses(f, *chain(2), [0.0, 0.0], F_K1M1)[:, 0])
    truth = np.array([F_K1M1, MASSES[1], SPRINGS[1]])
    names = ["f_k1m1", "gamma", "kappa"]
    pulled, soft = [], []
    for seed in range(6):
        x = exact * np.exp(np.random.default_rng(seed).normal(0.0, 0.02, f.size))
        bound = fm.identify.sweep(f, x).standard_error.sel(parameter=names).values
        x[[8 + seed, 30 - seed]] *= [2.0, 0.5]
        for loss, scaled in (("linear", pulled), ("soft_l1", soft)):
            ds = fm.identify.sweep(f, x, loss=loss).sel(parameter=names)
            scaled.append((ds.estimate.values - truth) / bound)
    assert np.sqrt(np.mean(np.square(soft))) < 1.8
    assert np.sqrt(np.mean(np.square(pulled))) > 2.0 * np.sqrt(np.mean(np.square(soft)))
    assert (ds.standard_error.values < 2.0 * bound).all()


# What cannot be determined


@pytest.mark.parametrize(
    ("n", "mass", "known", "message"),
    [
        (2, 2, {}, "cannot identify f_k1m1, gamma, kappa separately: mass 2 does not determine them; fix 1"),
        (
            3, 3, {"mass_ratio_2": 1.3},
            "cannot identify f_k1m1, mass_ratio_3, stiffness_ratio_2, stiffness_ratio_3 separately: mass 3",
        ),
    ],
)  # fmt: skip
def test_parameters_that_a_mass_does_not_determine_are_named(n, mass, known, message):
    f = band(n)
    X = np.abs(responses(f, *chain(n), np.zeros(n), F_K1M1))
    with pytest.raises(fm.InputError, match=re.escape(message)):
        fm.identify.sweep(f, {mass: X[:, mass - 1]}, masses=n, known=known)


def test_another_chain_that_fits_as_well_is_reported():
    """Of mass 2 with gamma known: f_k1m1^2 and f0^2 (1 + gamma) have their sum and product only."""
    gamma, kappa = MASSES[1], SPRINGS[1]
    f = band(2)
    x = np.abs(responses(f, *chain(2), [0.0, 0.0], F_K1M1)[:, 1])
    ds = fm.identify.sweep(f, {2: x}, known={"gamma": gamma})
    other = F_K1M1 * np.sqrt(kappa / gamma * (1.0 + gamma))
    pair = sorted([F_K1M1, other])
    found = float(ds.estimate.sel(parameter="f_k1m1"))
    told = float(re.search(r"the data fit f_k1m1 ([\d.]+)", ds.warnings)[1])
    assert sorted([found, told]) == pytest.approx(pair, rel=1e-4)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"amplitude_ratio": {3: [1.0] * 54}}, "a mass in amplitude_ratio must be <= 2; got 3"),
        ({"amplitude_ratio": {}}, "amplitude_ratio must have at least one mass; got none"),
        ({"amplitude_ratio": {2: [1.0]}}, "amplitude_ratio of mass 2 must be 54 numbers, one per frequency"),
        ({"phase_lag": [np.nan] * 54}, "phase_lag of mass 1 must be finite; got nan at index 0"),
        ({"sigma_phase": 1.0}, "cannot use sigma_phase without phase_lag: there are no lags"),
        ({"phase_lag": [0.0] * 54, "sigma_phase": 1.0}, "sigma_amplitude and sigma_phase must both be given"),
        ({"masses": 6}, "masses must be <= 5; got 6"),
        ({"masses": 3}, "amplitude_ratio must have three peaks for three frequencies; got two peaks"),
        ({"damping": "both"}, "damping must be one of ground, base; got 'both'"),
        ({"cost": "squares"}, "cost must be one of logarithmic, relative; got 'squares'"),
        ({"known": {"zeta_1": 0.1}}, "known must be one of f_k1m1, gamma, kappa; got 'zeta_1'"),
        (
            {"known": {"f_k1m1": 3.0, "gamma": 1.0, "kappa": 1.0}},
            "known must leave at least one parameter free",
        ),
    ],
)
def test_bad_chains(arguments, message):
    f = band(2)
    x = np.abs(responses(f, *chain(2), [0.0, 0.0], F_K1M1)[:, 0])
    with pytest.raises(fm.InputError, match=re.escape(message)):
        fm.identify.sweep(f, **{"amplitude_ratio": x} | arguments)
