"""The kernels as plain Python give what they give compiled; quick enough to run with NUMBA_DISABLE_JIT=1."""

import numpy as np
import pytest
from outputs import OUTPUTS

import frictionmap as fm
from frictionmap import regimes

pytestmark = pytest.mark.plain


@pytest.mark.parametrize("contact", ["fixed-wall", "joined-base-wall"])
@pytest.mark.parametrize("zeta", [0.0, 0.1, 1.0, 2.0])
def test_small_map(contact, zeta):
    """Every regime, every origin; the regime proved without integration holds in each cell."""
    system = fm.System(contact=contact, damping_ratios=zeta)
    ds = fm.sweep(system, [0.0, 0.3, 0.7, 1.0, 2.0], [0.0, 0.1, 0.5, 0.9, 5.0], [1.0, 1.5], outputs=OUTPUTS)
    smooth = ds.sel(mu=1.0)
    stuck = (smooth.beta >= smooth.beta_stick).transpose("r", "beta")
    np.testing.assert_array_equal((smooth.regime == regimes.PERMANENT_STICKING).values, stuck.values)
    running = ((smooth.beta < smooth.beta_lim).transpose("r", "beta") & ~stuck).values
    assert np.all(smooth.regime.values[running] == regimes.CONTINUOUS)
    assert not np.any(ds.status == regimes.NOT_COMPUTED)


def test_response():
    ds = fm.response(fm.System(damping_ratios=0.1), 0.3, 0.5, points=40)
    assert int(ds.stops_per_cycle) == 2
    assert float(np.abs(ds.z).max()) == pytest.approx(float(ds.contact_amplitude), rel=1e-6)


@pytest.mark.parametrize("contact", ["fixed-wall", "joined-base-wall"])
def test_response_curves(contact):
    """Every regime, with dampers and held oscillators: works balance, and an FFT finds the harmonics."""
    chain = {"mass_ratios": [1.0, 0.8], "stiffness_ratios": [1.0, 1.3], "damping_ratios": [0.1, 1.2]}
    system = fm.System(contact, **chain)
    quantities = ["amplitude", "energy", "harmonics", "transmitted_force"]
    ds = fm.curves(system, [0.4, 0.9], [0.0, 0.2, 0.45], 1.2, quantities=quantities, harmonics=3)
    np.testing.assert_allclose(ds.work_input, ds.work_friction + ds.work_damping, rtol=1e-12)
    motion = fm.response(system, 0.4, 0.2, 1.2, points=200)
    third = np.fft.rfft(motion.x.values[:, :-1])[:, 3] / 100.0
    found = ds.displacement_harmonic.isel(mu=0, r=0, beta=1, harmonic=3).values
    np.testing.assert_allclose(found[:, 0] + 1j * found[:, 1], third, atol=1e-5)
