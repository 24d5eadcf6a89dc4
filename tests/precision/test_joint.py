"""Decays and records fitted together: shared parameters against truths, errors against single fits."""

import functools

import numpy as np
import pytest
from decays import Truth as Decay
from decays import synthetic as decay
from records import Truth, steady, synthetic

import frictionmap as fm

SHAKEN = Truth(
    3.13, 0.0055, 0.8372, 1.0, -0.1, 1.001, (0.0, 1.82 * np.exp(0.7j), 0.02 * np.exp(2.0j)), rate=100.0,
    length=8.0,
)  # fmt: skip
LESS = SHAKEN._replace(x_F=0.6, offset_x=0.2, f=0.9)
LET_GO = Decay(3.13, 0.0055, 0.2, 9.0, -0.03, 0.1, 200.0, 4.0, 0.02)

settled = functools.lru_cache(steady)


def shaken(truth, seed=1):
    return synthetic(truth, settled(truth), seed)


def fit(*data, **arguments):
    return fm.identify.joint(list(data), damping_reference="base", **arguments)


def off(ds, exact):
    """Estimates less truths, in standard errors."""
    names = list(exact)
    distance = ds.estimate.sel(parameter=names).values - np.array(list(exact.values()))
    return distance / ds.standard_error.sel(parameter=names).values


@pytest.fixture(scope="module")
def three():
    """A decay and two records, each with its own friction."""
    return fit(decay(LET_GO, 1), shaken(SHAKEN), shaken(LESS, 2), stiffness=1000.0)


def test_estimates_are_near_the_truth(three):
    exact = {
        "f_n": 3.13, "zeta": 0.0055, "x_F_1": 0.2, "x_F_2": 0.8372, "x_F_3": 0.6, "X0_1": 9.0, "t0_1": -0.03,
        "centre_1": 0.1, "offset_x_2": -0.1, "offset_x_3": 0.2,
    }  # fmt: skip
    assert set(three.parameter.values) == {*exact, "mu"}
    assert (np.abs(off(three, exact)) < 4.0).all(), off(three, exact)
    assert three.verdict.flag_meanings.split()[int(three.verdict)] == "friction_found"
    mu = three.sel(parameter="mu")
    assert float(mu.estimate) == float(mu.lower) == 1.0 < float(mu.upper) < 1.1
    assert np.isnan(mu.standard_error)


def test_results_of_each_measurement(three):
    assert float(three.friction_force_2) == pytest.approx(1.0 * float(three.estimate.sel(parameter="x_F_2")))
    assert float(three.beta_3) == pytest.approx(0.6 / 1.82, rel=0.01)
    assert float(three.stops_per_cycle_2) == settled(SHAKEN).stops
    assert float(three.base_frequency_3) == pytest.approx(0.9, abs=0.001)
    for label, noise in (("1", LET_GO.noise), ("2", SHAKEN.noise_x), ("3", LESS.noise_x)):
        assert float(three[f"residual_rms_{label}"]) == pytest.approx(noise, rel=0.1)
        chosen = three.isel(sample=three["set"].values == label)
        assert float(chosen.sigma[0]) == pytest.approx(noise, rel=0.1)
        np.testing.assert_allclose(chosen.model - chosen.data, chosen.residual, atol=1e-12)


def test_a_joint_fit_has_smaller_errors_than_each_alone(three):
    alone = fm.identify.record(*shaken(SHAKEN), damping_reference="base")
    for name, own in (("f_n", "f_n"), ("zeta", "zeta"), ("x_F", "x_F_2")):
        error = float(three.standard_error.sel(parameter=own))
        assert error < float(alone.standard_error.sel(parameter=name)), name
    assert float(three.upper.sel(parameter="mu")) < float(alone.upper.sel(parameter="mu"))


@pytest.mark.slow
def test_records_alone_share_frequency_and_damping():
    ds = fit(shaken(SHAKEN), shaken(LESS, 2), labels=["a", "b"], known={"mu": 1.0})
    exact = {"f_n": 3.13, "zeta": 0.0055, "x_F_a": 0.8372, "x_F_b": 0.6}
    assert (np.abs(off(ds, exact)) < 4.0).all(), off(ds, exact)
    for truth, label in ((SHAKEN, 1), (LESS, 2)):
        alone = fm.identify.record(*shaken(truth, label), damping_reference="base", known={"mu": 1.0})
        for name in ("f_n", "zeta"):
            assert float(ds.standard_error.sel(parameter=name)) < float(
                alone.standard_error.sel(parameter=name)
            )


@pytest.mark.slow
def test_static_friction_that_records_share():
    truths = SHAKEN._replace(mu=1.2), LESS._replace(mu=1.2)
    ds = fit(decay(LET_GO, 1), *(shaken(truth, 3) for truth in truths))
    assert abs(off(ds, {"mu": 1.2})[0]) < 4.0
    assert float(ds.lower.sel(parameter="mu")) > 1.0


@pytest.mark.slow
def test_intervals_hold_the_truth():
    """Of 4 intervals fewer than 3 hold it in one of 70 cases; `benchmarks coverage` asks it of 100."""
    exact = {"f_n": 3.13, "zeta": 0.0055, "mu": 1.0, "x_F_1": 0.2, "x_F_2": 0.8372, "offset_x_2": -0.1}
    values = np.array(list(exact.values()))
    held = []
    for seed in range(4):
        ds = fit(decay(LET_GO, seed), shaken(SHAKEN, seed)).sel(parameter=list(exact))
        held.append((ds.lower.values <= values) & (ds.upper.values >= values))
    assert (np.sum(held, axis=0) >= 3).all()


def test_outliers_and_drift_in_one_of_them():
    time, base, x = shaken(SHAKEN)
    rng = np.random.default_rng(3)
    x = x + 0.03 * (time - 4.0) + np.where(rng.uniform(size=x.size) < 0.02, 0.5, 0.0)
    ds = fit(decay(LET_GO, 1), (time, base, x), loss="soft_l1", known={"mu": 1.0})
    exact = {"f_n": 3.13, "zeta": 0.0055, "x_F_1": 0.2, "x_F_2": 0.8372}
    assert (np.abs(off(ds, exact)) < 4.0).all(), off(ds, exact)
    assert "2: x drifts by 0.03" in ds.warnings


def test_what_is_held():
    ds = fit(decay(LET_GO, 1), shaken(SHAKEN), known={"f_n": 3.13, "zeta": 0.0055, "mu": 1.0})
    assert ds.known.sel(parameter=["f_n", "zeta", "mu"]).values.tolist() == [1, 1, 1]
    assert ds.standard_error.sel(parameter=["f_n", "zeta", "mu"]).values.tolist() == [0.0, 0.0, 0.0]
    assert (np.abs(off(ds, {"x_F_1": 0.2, "x_F_2": 0.8372})) < 4.0).all()


@pytest.mark.parametrize(
    ("data", "arguments", "message"),
    [
        (1, {}, "data must be two or more measurements, each .time, x. of a decay or .*; got 1$"),
        ([1], {}, "data must be two or more measurements"),
        ([([0.0], [1.0]), 3], {"labels": ["a", "b"]}, "data a: "),
        ([decay(LET_GO, 1), 3], {}, "data 2 must be .time, x. of a decay or .*; got 3$"),
        ([decay(LET_GO, 1)] * 2, {"labels": ["a", "a"]}, "labels must be 2 different names"),
        ([decay(LET_GO, 1)] * 2, {"known": {"beta": 1.0}}, "known must be one of f_n, zeta, mu, .*'beta'"),
        ([decay(LET_GO, 1)] * 2, {"known": {"mu": 0.5}}, "known.mu must be >= 1; got 0.5"),
        ([decay(LET_GO, 1)] * 2, {"loss": "l1"}, "loss must be one of linear, soft_l1; got 'l1'"),
    ],
)  # fmt: skip
def test_bad_arguments(data, arguments, message):
    with pytest.raises(fm.InputError, match=message):
        fm.identify.joint(data, **arguments)
