"""Design questions where friction depends on the speed: closed forms, a linear damper, and all starts."""

import numpy as np
import pytest

import frictionmap as fm
from frictionmap.files.designs import describe_design
from frictionmap.general.certificate import sure_slopes

FALLING = {"speed": [0.0, 0.4, 1.0], "factor": [1.0, 0.7, 0.6], "slope": 0.05}
GENTLE = {"speed": [0.0, 0.4, 1.0], "factor": [1.0, 0.95, 0.93], "slope": 0.05}


def one_mass(law, zeta=0.1, **more):
    return fm.System(damping_ratios=zeta, contacts=[fm.Contact("fixed-wall", [1], law=law, **more)])


def test_friction_that_holds_outweighs_the_load_at_every_speed():
    """One mass: beta g(V) + 2 zeta V >= 1 at all V; at rest 1/mu is enough."""
    ds = fm.design.stuck(one_mass(FALLING), [0.5, 1.5], mu=1.25)
    v, g = np.array(FALLING["speed"]), np.array(FALLING["factor"])
    assert ds.beta.item() == pytest.approx(((1.0 - 0.2 * v) / g).max(), rel=1e-9)
    assert ds.beta_stuck_some_starts.item() == pytest.approx(0.8, rel=1e-9)
    assert ds.beta_unique.item() == 0.0
    fine = np.linspace(0.0, 6.0, 6001)
    total = ds.beta.item() * np.interp(fine, v, g) + 0.2 * fine  # the rise beyond the last point adds to it
    assert total.min() == pytest.approx(1.0, abs=1e-6)


def test_damping_that_outweighs_the_fall_lets_the_load_itself_decide():
    ds = fm.design.stuck(one_mass(GENTLE), [0.5, 1.5])
    assert ds.beta.item() == pytest.approx(1.0, rel=1e-9)
    assert ds.beta_unique.item() == pytest.approx(1.6, rel=1e-9)
    assert "warnings" not in ds.attrs


@pytest.mark.parametrize("mu", [1.0, 1.25])
def test_every_large_motion_comes_to_rest_with_that_friction(mu):
    """Two contacts, one of them with a falling law: from rest and from a large motion."""
    contacts = [
        fm.Contact("fixed-wall", [1], law=FALLING, ratio=0.6),
        fm.Contact("between-masses", [1, 2], ratio=0.8),
    ]
    system = fm.System(
        contacts=contacts, mass_ratios=[1, 1], stiffness_ratios=[1, 1], damping_ratios=0.1, load_mass=2
    )
    slopes = sure_slopes(system)
    left = system.modes.damping - slopes[0] * np.diag([1.0, 0.0])
    assert slopes[1] == 0.0
    assert np.linalg.eigvalsh(left)[0] == pytest.approx(0.0, abs=1e-9)
    beta = fm.design.stuck(system, [0.4, 1.8], mu=mu).beta.item()
    for start in ("rest", "moving"):
        ds = fm.sweep(system, np.linspace(0.4, 1.8, 15), [1.001 * beta], mu=[mu], start=start)
        assert (ds.regime == 0).all()
    below = fm.sweep(system, np.linspace(0.4, 1.8, 15), [0.3 * beta], mu=[mu], start="moving")
    assert (below.regime != 0).any()


def test_margins_and_what_has_no_limit():
    system = one_mass(FALLING)
    ds = fm.design.margin(system, 0.8, 0.6)
    assert ds.margin_beta_stick.item() == pytest.approx(1.0 / 0.6 - 1.0, rel=1e-9)
    assert "beta_lim" not in ds
    assert "not proved to be the same from every start" in ds.attrs["warnings"]
    assert any(line.startswith("one steady state, proved, up to") for line in describe_design(ds))
    with pytest.raises(fm.InputError, match=r"contacts\[1\]\.law: .*compute a map of stops_per_cycle"):
        fm.design.no_stop(system, [0.5, 1.5])


@pytest.mark.slow
def test_a_viscous_slope_is_a_damper_at_the_answer():
    """One segment: friction beta (1 + a V), as constant friction beside the damper beta a."""
    rise, zeta = 0.3, 0.05
    system = one_mass({"speed": [0.0], "factor": [1.0], "slope": rise}, zeta)
    ds = fm.design.at_most(system, [0.7, 1.4], 4.0, beta=[0.05, 0.8])
    assert np.isinf(ds.beta_unique.item())
    assert "warnings" not in ds.attrs
    edge = ds.interval_begin.values[0]
    plain = fm.System(damping_ratios=zeta + 0.5 * edge * rise)
    r = np.linspace(0.9, 1.1, 2001)
    assert fm.sweep(plain, r, [edge]).contact_amplitude.max() == pytest.approx(4.0, rel=1e-5)


@pytest.mark.slow
def test_the_least_peak_counts_the_larger_of_both_starts():
    chain = {"mass_ratios": [1, 1], "stiffness_ratios": [1, 1], "damping_ratios": 0.03}
    system = fm.System(contacts=[fm.Contact("fixed-wall", [2], law=GENTLE)], **chain)
    ds = fm.design.least_peak(system, [0.5, 1.8], beta=[0.7, 1.5])
    assert ds.beta.item() > ds.beta_unique.item() > 0.0
    assert "larger response" in ds.attrs["warnings"]

    def largest(beta, start):
        r = np.linspace(0.5, 1.8, 300)
        found = fm.sweep(system, r, [beta], start=start, outputs=["regime", "amplitude"])
        return np.nanmax(found.amplitude.sel(dof=1).values)

    for share in (0.9, 1.0, 1.1):
        seen = max(largest(share * ds.beta.item(), start) for start in ("rest", "moving"))
        if share == 1.0:
            assert ds.peak.values[0] == pytest.approx(seen, rel=3e-3)
            assert ds.peak.values[0] >= seen * (1.0 - 1e-9)
        else:
            assert seen > ds.peak.values[0] * (1.0 + 1e-3)
