"""Means, variances and peaks of stationary motions, with errors that hold."""

import re

import numpy as np
import pytest
import xarray as xr

import frictionmap as fm
from frictionmap import stationary


def _white(seed, count, dt):
    """Samples of white noise of intensity 2 D, D = 1."""
    return np.sqrt(2.0 / dt) * np.random.default_rng(seed).standard_normal(count)


def test_a_block_under_white_noise():
    """Caughey and Dienes 1961: E abs(v) = D/D1, E v^2 = 2 D^2/D1^2; the record's own bias is -s^2/2."""
    dt, samples = 0.02, 100_000
    system = fm.System(matrices={"M": [[1.0]], "K": [[0.0]]}, frequency_scale=1.0)
    record = fm.Record(_white(1, samples, dt), dt, quantity="force")
    v = fm.history(system, record, beta=1.0, after=0.0).v.squeeze(drop=True)
    found, modulus = stationary(v, start=40.0), stationary(abs(v), start=40.0)
    bias = 1.0 - 0.5 * dt  # s^2 = D1^2 dt/D
    assert abs(float(modulus["mean"]) - bias) < 3.0 * float(modulus.mean_error)
    assert abs(float(found.variance) - 2.0 * bias) < 3.0 * float(found.variance_error)
    assert abs(float(found["mean"])) < 3.0 * float(found.mean_error)
    assert float(modulus.mean_error) < 0.09
    assert float(found.variance_error) < 0.4


def test_a_linear_oscillator_under_white_noise():
    """Variance D/(2 zeta) of x, D of v; linear interpolation takes less than 0.2 % off."""
    dt, zeta = 0.1, 0.1
    record = fm.Record(_white(2, 60_000, dt), dt, quantity="force")
    ds = fm.history(fm.System(damping_ratios=zeta), record, beta=0.0, after=0.0)
    for name, exact in (("x", 1.0 / (4.0 * zeta) * 2.0), ("v", 1.0 / (2.0 * zeta))):
        found = stationary(ds[name].squeeze(drop=True), start=50.0)
        assert abs(float(found.variance) - exact) < 3.0 * float(found.variance_error)
        assert float(found.variance_error) < 0.06 * exact


def _processes(count, size, dt):
    """Ornstein-Uhlenbeck processes of variance 1 and correlation time 1, exact at their samples."""
    rng = np.random.default_rng(0)
    keep = np.exp(-dt)
    found = np.empty((size, count))
    found[0] = rng.standard_normal(count)
    pushes = np.sqrt(1.0 - keep**2) * rng.standard_normal((size, count))
    for k in range(1, size):
        found[k] = keep * found[k - 1] + pushes[k]
    return xr.DataArray(found, dims=("time", "record"), coords={"time": dt * np.arange(size)})


def test_errors_hold_as_often_as_stated():
    """Of 400 processes; Student's quantile for 19 degrees of freedom at 95 % is 2.093."""
    dt = 0.05
    found = stationary(_processes(400, 20_001, dt))
    lower = (2.0 + np.exp(-dt)) / 3.0  # of the squares of straight lines between samples
    for name, exact in (("mean", 0.0), ("variance", lower)):
        inside = abs(found[name] - exact) < 2.093 * found[f"{name}_error"]
        assert 0.915 <= float(inside.mean()) <= 0.98, name
    again = stationary(_processes(400, 20_001, dt), window=10.0)
    truth = float(again.peak.mean())  # 400 times as long, so 20 times as exact
    inside = abs(again.peak - truth) < 1.99 * again.peak_error
    assert 0.9 <= float(inside.mean()) <= 0.98
    assert float((abs(found.batch_correlation) < 2.0 / np.sqrt(20)).mean()) > 0.9


def test_straight_lines_are_integrated_exactly():
    time = np.array([0.0, 0.5, 0.5, 1.7, 2.0, 4.0])
    line = xr.DataArray(3.0 * time - 1.0, dims="time", coords={"time": time})
    found = stationary(line, batches=4, window=2.0)
    means = 3.0 * np.array([0.5, 1.5, 2.5, 3.5]) - 1.0
    assert float(found["mean"]) == pytest.approx(5.0, rel=1e-14)
    assert float(found.mean_error) == pytest.approx(means.std(ddof=1) / 2.0, rel=1e-13)
    assert float(found.variance) == pytest.approx(9.0 * 16.0 / 12.0 + float(found.mean_error) ** 2, rel=1e-13)
    with pytest.raises(fm.InputError, match="window must fit twice"):
        stationary(line, window=3.0)


NOISE = fm.Record.generate("white", "60 s", "0.02 s", rms="2 m/s^2", unit="m/s^2", seed=3, count=2)
SHAKEN = {
    "system": fm.System(excitation="base", damping_reference="base", contact="joined-base-wall"),
    "units": fm.Units(natural_frequency="1.5 Hz"), "after": 0.0,
}  # fmt: skip
AVERAGES = {"start": "10 s", "window": 2.5, "batches": 10}


def test_statistics_of_histories_are_those_of_each_motion():
    """In ratios and in SI units, with and without samples, of several motions and of one."""
    friction = ["0.02 g", "0.05 g"]
    both = fm.history(record=NOISE, beta=friction, statistics=AVERAGES, **SHAKEN)
    less = fm.history(record=NOISE, beta=friction, statistics=AVERAGES, samples="none", **SHAKEN)
    assert "time" not in less.dims
    assert "x_max_m" in less
    for of, si in (("x", "m"), ("v", "m_s"), ("acceleration", "m_s2"), ("z", "m")):
        own = both[f"{of}_{si}"].isel(record=1, scale=0, mu=0, beta=1)
        direct = stationary(own, start=10.0, window=2.5, batches=10)
        squared = {"m": "m2", "m_s": "m2_s2", "m_s2": "m2_s4"}[si]
        for end, unit in (("mean", si), ("mean_error", si), ("variance", squared), ("peak_error", si)):
            for ds in (both, less):
                found = ds[f"{of}_{end}_{unit}"].isel(record=1, scale=0, mu=0, beta=1)
                np.testing.assert_allclose(found, direct[end], rtol=1e-9, atol=1e-15)
        np.testing.assert_array_equal(less[f"{of}_batch_correlation"], both[f"{of}_batch_correlation"])
    assert both.x_variance_m2.attrs["units"] == "m2"
    one = fm.history(record=NOISE[1], beta="0.05 g", statistics=AVERAGES, **SHAKEN)
    direct = stationary(one.friction.squeeze(drop=True), start=10.0, window=2.5, batches=10)
    np.testing.assert_allclose(one.friction_variance.item(), direct.variance, rtol=1e-9)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"begin": 3.0}, "unknown key 'statistics.begin'; valid: start, window, batches"),
        ({"start": 61.0}, "statistics.start must be <= 60"),
        ({"window": "40 s"}, "statistics.window must fit twice into the time after start; got 40"),
        ({"batches": 3}, "statistics.batches must be >= 4; got 3"),
        (True, "statistics must be a table of start, window, batches; got True"),
    ],
)
def test_statistics_that_are_none_are_refused(given, said):
    with pytest.raises(fm.InputError, match=re.escape(said)):
        fm.history(record=NOISE[0], beta="0.05 g", statistics=given, **SHAKEN)
