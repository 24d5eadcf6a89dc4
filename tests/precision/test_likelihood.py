"""Likelihoods for samplers: against the normal density, and a Metropolis run against standard errors."""

import re

import numpy as np
import pytest
import xarray as xr
from decays import Truth, synthetic
from sweeps import responses

import frictionmap as fm

MIXED = Truth(3.086, 0.012, 0.15, 12.0, -0.02, -0.4, 250.0, 6.0, 0.03)
NAMES = ("f_n", "zeta", "x_F", "X0", "t0", "centre")


def normal(residual, sigma):
    return float(np.sum(-0.5 * (residual / sigma) ** 2 - np.log(sigma) - 0.5 * np.log(2.0 * np.pi)))


def test_a_decay_has_normal_errors_about_its_motion():
    time, x = synthetic(MIXED, 3)
    ds = fm.identify.free_decay(time, x)
    function = fm.identify.log_likelihood(ds)
    assert function.names == NAMES
    for scale in (0.0, 1.0, -2.0):
        theta = ds.estimate.values + scale * ds.standard_error.values * [0.3, 0.1, -0.1, 0.5, 0.2, 0.4]
        motion = synthetic(Truth(*theta, *MIXED[6:])._replace(noise=0.0), 0)[1]
        expected = normal(motion - x, ds.sigma.values)
        assert function(theta) == pytest.approx(expected, abs=1e-6 * x.size)


def test_what_is_held_is_no_argument(tmp_path):
    time, x = synthetic(MIXED, 4)
    ds = fm.identify.free_decay(time, x, known={"zeta": 0.012}, drift=True)
    function = fm.identify.log_likelihood(ds)
    assert function.names == ("f_n", "x_F", "X0", "t0", "centre", "drift")
    best = ds.estimate.sel(parameter=list(function.names)).values
    assert function(best) == pytest.approx(normal(ds.residual.values, ds.sigma.values), rel=1e-12)
    assert function(best * [1, -1, 1, 1, 1, 1]) == -np.inf
    ds.to_netcdf(tmp_path / "decay.nc")
    with xr.open_dataset(tmp_path / "decay.nc") as stored:
        assert fm.identify.log_likelihood(stored)(best) == function(best)


@pytest.mark.parametrize("damping", ["ground", "base"])
def test_a_sweep_has_normal_errors_of_logarithms_and_lags(damping):
    f = np.linspace(0.5, 8.0, 60)
    X = responses(f, [1.0, 0.9], [1.0, 1.2], [0.01, 0.02], 3.0, damping == "base")
    rng = np.random.default_rng(6)
    amplitude = np.abs(X[:, 0]) * np.exp(rng.normal(0.0, 0.02, f.size))
    lag = rng.normal(0.0, 0.02, f.size) - np.angle(X[:, 0])
    ds = fm.identify.sweep(
        f, amplitude, np.degrees(lag), damping=damping, sigma_amplitude=0.02, sigma_phase=np.degrees(0.02)
    )
    function = fm.identify.log_likelihood(ds)
    assert function.names == ("f_k1m1", "gamma", "kappa", "zeta_1", "zeta_2")
    theta = np.array([3.002, 0.903, 1.198, 0.0102, 0.0197])
    model = responses(f, [1.0, theta[1]], [1.0, theta[2]], theta[3:], theta[0], damping == "base")[:, 0]
    turned = np.angle(np.exp(1j * (-np.angle(model) - lag)))
    expected = normal(np.concatenate((np.log(np.abs(model) / amplitude), turned)), np.full(2 * f.size, 0.02))
    assert function(theta) == pytest.approx(expected, abs=1e-6)
    assert function(theta * [1, 1, 1, 1, -1]) == -np.inf
    assert function(theta * [1, -1, 1, 1, 1]) == -np.inf


def test_a_sampler_finds_the_standard_errors():
    """Metropolis with the best step for six normal parameters, 2.38/sqrt(6): some 20 steps are one sample."""
    ds = fm.identify.free_decay(*synthetic(MIXED, 5))
    function, rng = fm.identify.log_likelihood(ds), np.random.default_rng(7)
    deviation = ds.standard_error.values
    root = np.linalg.cholesky(ds.correlation.values) * deviation[:, np.newaxis] * 2.38 / np.sqrt(6.0)
    theta = ds.estimate.values.copy()
    level, chain = function(theta), []
    for _ in range(12_000):
        other = theta + root @ rng.normal(size=6)
        found = function(other)
        if np.log(rng.uniform()) < found - level:
            theta, level = other, found
        chain.append(theta)
    scatter = np.std(chain[1000:], axis=0)
    # of 550 independent samples the scatter is known to 3 %
    np.testing.assert_allclose(scatter / deviation, 1.0, atol=0.12)
    correlation = np.corrcoef(np.transpose(chain[1000:]))
    assert correlation[1, 2] == pytest.approx(float(ds.correlation[1, 2]), abs=0.03)


@pytest.mark.parametrize(
    ("theta", "message"),
    [
        ([1.0, 2.0], "theta must be 6 numbers: f_n, zeta, x_F, X0, t0, centre; got [1.0, 2.0]"),
        (["a"] * 6, "theta must be 6 numbers"),
    ],
)
def test_bad_thetas(theta, message):
    function = fm.identify.log_likelihood(fm.identify.free_decay(*synthetic(MIXED, 3)))
    with pytest.raises(fm.InputError, match=re.escape(message)):
        function(theta)
    assert function([np.nan] * 6) == -np.inf


def test_datasets_without_a_likelihood():
    ds = fm.identify.free_decay(*synthetic(MIXED, 3))
    with pytest.raises(fm.InputError, match="cannot evaluate the likelihood: ds has no variable sigma"):
        fm.identify.log_likelihood(ds.drop_vars("sigma"))
    with pytest.raises(fm.InputError, match="ds is neither of a free decay nor of a sweep"):
        fm.identify.log_likelihood(ds.drop_vars("half_cycles"))
    with pytest.raises(fm.InputError, match=r"ds must be a dataset of estimates; got 3"):
        fm.identify.log_likelihood(3)
    with pytest.raises(fm.InputError, match="sigma is not > 0"):
        fm.identify.log_likelihood(ds.assign(sigma=0.0 * ds.sigma))
