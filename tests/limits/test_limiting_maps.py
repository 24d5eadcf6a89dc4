"""Maps that must be alike, cells on a boundary, ratios at the ends of what doubles hold."""

from fractions import Fraction

import numpy as np
from outputs import OUTPUTS

import frictionmap as fm
from frictionmap import regimes

BASE = fm.System(contact="joined-base-wall")


def test_moving_start_with_mu_1_gives_the_same_regimes():
    """theory.md 6: for mu = 1 the regime does not depend on the start."""
    r = np.linspace(0.11, 2.5, 40)
    beta = np.linspace(0.01, 1.1, 40)
    for skip in ("exact", "none"):
        rest = fm.sweep(fm.System(damping_ratios=0.02), r, beta, 1.0, skip=skip, outputs=OUTPUTS)
        moving = fm.sweep(
            fm.System(damping_ratios=0.02), r, beta, 1.0, skip=skip, start="moving", outputs=OUTPUTS
        )
        both = (rest.status == 0) & (moving.status == 0)
        assert float(both.mean()) > 0.999
        np.testing.assert_array_equal(rest.regime.where(both), moving.regime.where(both))
        np.testing.assert_allclose(
            rest.contact_amplitude.where(both & (rest.regime > 0)),
            moving.contact_amplitude.where(both & (rest.regime > 0)),
            rtol=1e-9,
        )


def test_joined_base_wall_is_the_fixed_wall_scaled():
    """Undamped: the cell (r, beta) with a joined base-wall is the cell (r, beta/r^2) with a fixed wall."""
    for r in (0.3, 0.7, 1.0, 1.6):
        beta = np.linspace(0.05, 1.1, 30)
        wall = fm.sweep(fm.System(), [r], beta, [1.0, 1.5], outputs=OUTPUTS)
        base = fm.sweep(BASE, [r], beta * r**2, [1.0, 1.5], outputs=OUTPUTS)
        np.testing.assert_array_equal(wall.regime.values, base.regime.values)
        np.testing.assert_array_equal(wall.stops_per_cycle.values, base.stops_per_cycle.values)
        np.testing.assert_allclose(
            wall.contact_amplitude.values * r**2, base.contact_amplitude.values, rtol=1e-9
        )


def test_ties_with_beta_stick_stick():
    """beta = r^2/mu, exactly representable, sticks; the double below it does not."""
    for r, mu in ((0.5, 1.0), (1.5, 1.0), (0.75, 1.5), (2.0, 2.0), (1.25, 1.25)):
        tie = float(Fraction(r) ** 2 / Fraction(mu))
        for skip in ("exact", "none"):
            ds = fm.sweep(BASE, [r], [np.nextafter(tie, 0.0), tie], mu, skip=skip, outputs=OUTPUTS)
            below, at = ds.regime.values[0, 0]
            assert at == regimes.PERMANENT_STICKING, (r, mu, skip)
            if mu == 1.0:
                assert below == regimes.STICK_SLIP, (r, mu, skip)


def test_fixed_wall_at_rest_frequency():
    """r = 0: linear at beta = 0, stuck at or above beta_stick, and in between stick-slip without a count."""
    ds = fm.sweep(fm.System(), [0.0], [0.0, 0.5, 1.0], 1.0, outputs=OUTPUTS)
    assert ds.regime.values.ravel().tolist() == [
        regimes.CONTINUOUS, regimes.STICK_SLIP, regimes.PERMANENT_STICKING
    ]  # fmt: skip
    assert ds.status.values.ravel().tolist() == [0, regimes.QUASI_STATIC, 0]
    assert ds.contact_amplitude.values[0, 0, 0] == 1.0
    assert np.isnan(ds.stops_per_cycle.values[0, 0, 1])


def test_extreme_ratios_end_with_an_answer():
    """Tiny and huge frequency ratios, friction near its bounds, heavy damping: a regime or a status."""
    for zeta in (0.0, 1e-6, 1.0, 20.0):
        ds = fm.sweep(
            fm.System(damping_ratios=zeta),
            [1e-3, 1e-2, 30.0, 1e4, 1e8],
            [1e-12, 1e-3, 0.3, 1.0 - 1e-12, 1.0, 50.0],
            [1.0, 1.0 + 1e-12, 3.0],
            cycles=20,
            outputs=OUTPUTS,
        )
        assert not np.any(ds.status == regimes.NOT_COMPUTED)
        resolved = ds.status == regimes.RESOLVED
        assert np.all((ds.regime != regimes.UNRESOLVED).where(resolved, True))
        assert np.all(np.isfinite(ds.contact_amplitude).where(resolved, True))


def test_a_cell_alone_is_resolved_as_in_a_map():
    """Without damping a motion may take longer than allowed to settle; for mu = 1 it has one steady state."""
    system = fm.System("joined-base-wall")
    r, beta = 0.3125763125763126, np.linspace(0.0, 4.0, 4096)[:10]
    outputs = ["regime", "stops_per_cycle", "contact_amplitude", "status"]
    alone = fm.sweep(system, [r], beta[9:], outputs=outputs)
    row = fm.sweep(system, [r], beta, outputs=outputs).isel(beta=[9])
    assert alone.status.item() == row.status.item() == 0
    assert alone.stops_per_cycle.item() == row.stops_per_cycle.item() == 2.0
    np.testing.assert_allclose(alone.contact_amplitude, row.contact_amplitude, rtol=1e-11)
