"""The map of T Fig. 3.12, cell by cell: what the thesis says of it, its edges, both ways to make it."""

import math

import numpy as np
import pytest
from conftest import ROOT
from outputs import OUTPUTS

import frictionmap as fm
from frictionmap import regimes
from frictionmap.files.config import load_config

BASE = fm.System(contact="joined-base-wall")


@pytest.fixture(scope="module")
def published():
    """The map of T Fig. 3.12 with every output."""
    config = load_config(ROOT / "configs" / "fig-3-12.toml")
    return fm.sweep(config.system, config.r, config.beta, config.mu, outputs=OUTPUTS)


def test_published_map_rows_at_the_edges(published):
    """r = 0, r = 1 and beta = 0 of T Fig. 3.12 come out right."""
    assert published.sizes == {"mu": 2, "r": 126, "beta": 401}
    still = published.sel(r=0.0)
    assert np.all(still.regime == regimes.PERMANENT_STICKING)
    assert np.all(still.contact_amplitude == 0.0)
    linear = published.sel(beta=0.0).isel(r=slice(1, None))
    assert np.all(linear.regime == regimes.CONTINUOUS)
    r = linear.r.values
    with np.errstate(divide="ignore"):
        expected = r**2 / np.abs((1.0 - r) * (1.0 + r))
    np.testing.assert_allclose(linear.contact_amplitude, np.stack([expected, expected]), rtol=1e-15)
    resonant = published.sel(r=1.0, mu=1.0)
    below = resonant.beta.values < math.pi / 4
    assert np.all(np.isinf(resonant.contact_amplitude.values[below]))
    assert np.all(resonant.regime.values[below] == regimes.CONTINUOUS)
    between = ~below & (resonant.beta.values < 1.0)
    assert np.all(resonant.regime.values[between] == regimes.STICK_SLIP)
    assert np.all(resonant.stops_per_cycle.values[between] == 2.0)
    assert np.all(resonant.regime.values[resonant.beta.values >= 1.0] == regimes.PERMANENT_STICKING)


def test_published_map_is_resolved(published):
    """mu = 1: every cell but the marginal column r = 1/2 has status 0; no NaN without a status."""
    smooth = published.sel(mu=1.0)
    marginal = smooth.status == regimes.MARGINAL
    assert set(np.unique(smooth.status)) == {regimes.RESOLVED, regimes.MARGINAL}
    assert np.unique(smooth.r.values[np.nonzero(marginal.values)[0]]).tolist() == [0.5]
    assert not np.any(smooth.regime == regimes.UNRESOLVED)
    assert not np.any(np.isnan(smooth.contact_amplitude))
    rough = published.sel(mu=1.5)
    assert int((rough.status == regimes.IRREGULAR).sum()) <= 8
    assert not np.any(rough.regime == regimes.UNRESOLVED)
    nan = np.isnan(published.contact_amplitude) & (published.status == regimes.RESOLVED)
    assert not bool(nan.any())


def test_published_map_agrees_with_the_thesis(published):
    """T 3.6.2: two stops predominate, more are rare; one stop only for mu > 1, around r = 1/2."""
    smooth, rough = published.sel(mu=1.0), published.sel(mu=1.5)
    stops = smooth.stops_per_cycle.values[smooth.regime.values == regimes.STICK_SLIP]
    assert (stops == 2.0).mean() > 0.99
    assert set(np.unique(stops)) <= {2.0, 4.0}
    one = rough.stops_per_cycle == 1.0
    assert bool(one.any())
    assert float(np.abs(rough.r.values[np.nonzero(one.values)[0]] - 0.5).max()) < 0.16
    # "the direct transition from the continuous to the permanent sticking regime" for mu = 1.5
    column = rough.sel(r=1.0).regime.values
    change = np.flatnonzero(np.diff(column))
    assert column[change].tolist() == [regimes.CONTINUOUS]
    assert column[change + 1].tolist() == [regimes.PERMANENT_STICKING]


def test_skip_exact_and_none_agree(published):
    """T Fig. 3.12, mu = 1, cell by cell, but at r = 1/2 below beta_lim.

    There, undamped at r = 1/(2n), a continuum of asymmetric motions exists, T(3.33); the duration of a stop
    dies like n^-1/2, and marching shows stops that the steady state does not have: status marginal.
    """
    exact = published.sel(mu=[1.0])
    none = fm.sweep(BASE, exact.r.values, exact.beta.values, 1.0, skip="none", outputs=OUTPUTS)
    marginal = (none.status == regimes.MARGINAL).values
    columns = np.unique(none.r.values[np.nonzero(marginal)[1]])
    assert columns.tolist() == [0.5]
    assert np.all(none.beta.values[np.nonzero(marginal)[2]] < none.beta_lim.sel(r=0.5).item())
    slow = (none.status == regimes.NOT_REACHED).values
    # next to the undamped resonance a motion from rest needs more than 2,000 periods for beta = 0.01
    assert slow.sum() <= 4
    assert np.all(np.abs(none.r.values[np.nonzero(slow)[1]] - 1.0) < 0.05)
    decided = ~(marginal | slow)
    for name in ("regime", "stops_per_cycle", "period"):
        np.testing.assert_array_equal(exact[name].values[decided], none[name].values[decided], name)
    np.testing.assert_allclose(
        exact.contact_amplitude.values[decided], none.contact_amplitude.values[decided], rtol=1e-11
    )


def test_closed_form_cells_are_not_integrated(published):
    """skip = "exact", mu = 1: outside the strip nothing is integrated, and inside everything is."""
    smooth = published.sel(mu=1.0)
    strip = (smooth.beta >= smooth.beta_lim) & (smooth.beta < smooth.beta_stick) & (smooth.beta > 0.0)
    np.testing.assert_array_equal((smooth.origin != 0).values, strip.transpose("r", "beta").values)
