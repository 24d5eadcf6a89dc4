"""Forced responses: friction, frequency and damping from lags and amplitudes against truths."""

import json

import numpy as np
import pytest
import xarray as xr
from responses import Truth, table

import frictionmap as fm
from frictionmap.cli import main

WALL = Truth(3.086, 0.004, (0.2, 0.4, 0.5), (0.65, 0.7, 0.85, 0.93, 1.06, 1.2, 1.5, 2.0))


def fitted(truth, seed, sigma_phase=0.7, sigma_amplitude=0.01, **more):
    sets, f, lag, ratio = table(truth, seed, sigma_phase, sigma_amplitude)
    return fm.identify.forced(f, lag, ratio, sets=sets, **({"known": {"mu": 1.0}} | more))


def estimate(ds, name):
    return float(ds.estimate.sel(parameter=name))


def test_exact_data_give_the_truth_back():
    ds = fitted(WALL, 1, 0.0, 0.0)
    np.testing.assert_allclose(ds.estimate, [*WALL.beta, WALL.f_n, WALL.zeta, 1.0], rtol=1e-6)
    np.testing.assert_allclose(ds.model, ds.data, rtol=1e-7)
    assert not any(np.isnan(ds[name]).any() for name in ds.data_vars if ds[name].dtype.kind == "f")


@pytest.mark.parametrize("kind", [
    "curves-wall", "curves-base-wall", "curves-stick-slip", "phases-wall", "phases-two-storey",
])  # fmt: skip
@pytest.mark.parametrize("folder", ["visible-1", "visible-2"])
def test_synthetic_responses(measured, tmp_path, folder, kind):
    """Through the command: within the tolerance, and with the errors of the Cramer-Rao bound."""
    truth = json.loads((measured / folder / "truth.json").read_text())[kind]
    path = tmp_path / "fit.nc"
    assert main(["identify", str(measured / folder / f"{kind}.toml"), "-o", str(path), "--quiet"]) == 0
    truths = truth | {f"beta_{k}": one for k, one in enumerate(np.ravel(truth["beta"]), start=1)}
    with xr.open_dataset(path) as ds:
        for name, tolerance in truth["tolerance"].items():
            one = ds.sel(parameter=name)
            assert abs(float(one.estimate) - truths[name]) < tolerance, name
            assert 0.8 < float(one.standard_error) / truth["crb"][name] < 1.25, name


@pytest.mark.slow
def test_intervals_hold_the_truth():
    """95 % intervals of 100 seeds: 90 to 99 % hold it, of every parameter."""
    names = ["beta_1", "beta_2", "beta_3", "f_n", "zeta"]
    truth = np.array([*WALL.beta, WALL.f_n, WALL.zeta])
    inside = np.zeros(truth.size)
    for seed in range(100):
        ds = fitted(WALL, seed, sigma_phase=0.7, sigma_amplitude=0.01).sel(parameter=names)
        inside += (ds.lower.values <= truth) & (truth <= ds.upper.values)
    assert 450 <= inside.sum() <= 495, inside
