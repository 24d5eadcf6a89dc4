"""Free decays under friction that falls with the speed: what they show of it, and what they do not."""

import re

import numpy as np
import pytest
from decays import simulate_falling

import frictionmap as fm

TIME = np.arange(0.0, 10.0, 0.005)
F_N = 3.0
OMEGA = 2.0 * np.pi * F_N


def fitted(place, seed, noise=0.01):
    return fm.identify.free_decay(TIME, place + np.random.default_rng(seed).normal(0.0, noise, TIME.size))


def test_a_slope_is_damping():
    """F (1 + a V) with the damping ratio zeta is F alone with zeta + x_F omega_n a/2."""
    zeta, friction, slope = 0.012, 0.2, -0.002
    place = simulate_falling(TIME, OMEGA, zeta, friction, slope)
    ds = fitted(place, 1)
    found, error = ds.estimate.sel(parameter="zeta").item(), ds.standard_error.sel(parameter="zeta").item()
    assert abs(found - (zeta + 0.5 * friction * OMEGA * slope)) < 4.0 * error
    assert "friction falls" not in ds.attrs["warnings"]


@pytest.mark.parametrize("zeta", [0.0, pytest.param(0.003, marks=pytest.mark.slow)])
def test_a_fall_that_outweighs_damping_is_named_with_its_least_slope(zeta):
    friction, slope = 0.25, -0.003
    ds = fitted(simulate_falling(TIME, OMEGA, zeta, friction, slope), 2)
    words = ds.attrs["warnings"]
    assert words.startswith("friction falls with the speed, by at least ")
    least = float(re.search(r"at least ([\d.]+) % per mm/s", words).group(1))
    assert least == pytest.approx(100.0 * (-slope - 2.0 * zeta / (friction * OMEGA)), rel=0.06)


@pytest.mark.parametrize("seed", range(5))
def test_constant_friction_without_damping_does_not_fall(seed):
    """The best sum is negative in half of the records, by less than noise makes it."""
    ds = fitted(simulate_falling(TIME, OMEGA, 0.0, 0.1, 0.0), seed)
    assert "friction falls" not in ds.attrs["warnings"]
