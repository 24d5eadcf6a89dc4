"""The kernels as plain Python give what they give compiled; quick enough to run with NUMBA_DISABLE_JIT=1."""

import numpy as np
import pytest

import frictionmap as fm
from frictionmap import regimes
from frictionmap.model.settings import OUTPUTS as EVERY

pytestmark = pytest.mark.plain

OUTPUTS = EVERY[: EVERY.index("multiplier")]  # that of the masses would take the code for structures


@pytest.mark.parametrize("contact", ["fixed-wall", "joined-base-wall"])
@pytest.mark.parametrize("zeta", [0.0, 0.1, 1.0, 2.0])
def test_small_map(contact, zeta):
    """Every regime, every origin; what is known of each cell without integration holds."""
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
