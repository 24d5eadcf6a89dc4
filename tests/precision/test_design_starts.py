"""Design questions at mu > 1: what holds for every start, by an independent program from many starts."""

import numpy as np
import pytest

import frictionmap as fm
from benchmarks.references.naive import naive_steady_state

ONE = {"damping_ratios": 0.01}
LISTED = {"contacts": [fm.Contact("fixed-wall", 1)], **ONE}


def starts(count, seed=1):
    random = np.random.default_rng(seed)
    return [(random.normal(size=1) * 1.5, random.normal(size=1) * 1.5) for _ in range(count)]


def marched(r, beta, start):
    return naive_steady_state(zeta=0.01, r=r, beta=beta, mu=1.5, start=start, cycles=1500, points=100)


@pytest.mark.parametrize("keys", [ONE, LISTED])
def test_friction_that_holds_whatever_the_start(keys):
    """One mass on a wall carries the load 1: kinetic friction of 1 is enough for every start."""
    ds = fm.design.stuck(fm.System(**keys), [0.4, 0.6], mu=1.5)
    assert ds.beta.item() == 1.0
    assert ds.beta_stuck_some_starts.item() == pytest.approx(2.0 / 3.0, rel=1e-15)
    assert (ds.beta_stuck_of_r == 1.0).all()


def test_less_friction_does_not_hold_from_all_starts():
    """Between beta_stick and the friction that holds motions go on with two stops per cycle."""
    states = [marched(0.5, 0.8, start) for start in starts(12)]
    assert sum(state.status == "ok" and state.stops == 2.0 for state in states) >= 4
    assert marched(0.5, 0.8, "rest").status == "stuck"
    for r in (0.4, 0.5, 0.6):
        assert all(marched(r, 1.0001, start).status == "stuck" for start in starts(8))


def test_structures_are_held_by_their_kinetic_friction():
    """mu beta_stick, theory.md 6; with contacts of their own mu each counts with its own."""
    chain = {"mass_ratios": [1, 1], "stiffness_ratios": [1, 1], "damping_ratios": 0.03}
    band = [0.3, 1.2]
    for contacts in (
        [fm.Contact("fixed-wall", 2)],
        [fm.Contact("fixed-wall", 1), fm.Contact("fixed-wall", 2, ratio=0.5, mu=2.0)],
        [fm.Contact("fixed-wall", 2, normal_load={2: 0.4})],
    ):
        alike = [fm.Contact("fixed-wall", one.masses[0], ratio=one.ratio, mu=1.0, normal_load=one.normal_load)
                 for one in contacts]  # fmt: skip
        ds = fm.design.stuck(fm.System(contacts=contacts, **chain), band, mu=1.4)
        equal = fm.design.stuck(fm.System(contacts=alike, **chain), band)
        assert ds.beta.item() == pytest.approx(equal.beta.item(), rel=1e-12)
        assert ds.beta_stuck_some_starts.item() < ds.beta.item()
        assert "beta_stuck_some_starts" not in equal


@pytest.fixture(scope="module")
def without_stops():
    return {
        name: fm.design.no_stop(fm.System(**keys), [0.4, 0.6], mu=1.5)
        for name, keys in (("one", ONE), ("listed", LISTED))
    }


def test_friction_without_a_stop_whatever_the_start(without_stops):
    """Stops go on below beta_lim: at r = 0.4 one per cycle from rest, and two from x = 2.1, x' = 2."""
    for ds in without_stops.values():
        assert ds.beta_no_stop_some_starts.item() == pytest.approx(0.1163107871, rel=1e-9)
        assert ds.at_r.item() == 0.4
        assert 0.111 < ds.beta.item() < 0.1135
    from_rest = marched(0.4, 0.116194, "rest")
    assert (from_rest.status, from_rest.stops) == ("ok", 1.0)
    moving = marched(0.4, 0.1135, ([2.1], [2.0]))
    assert (moving.status, moving.stops) == ("ok", 2.0)


def test_no_start_stops_with_that_friction(without_stops):
    beta = 0.999 * without_stops["one"].beta.item()
    for r in (0.4, 0.405, 0.42, 0.5, 0.6):
        states = [marched(r, beta, start) for start in ("rest", *starts(10 if r < 0.41 else 3, seed=3))]
        assert all(state.status == "ok" and state.stops == 0.0 for state in states)


def test_an_asymmetric_motion_decides_at_half_the_natural_frequency():
    """T(3.6.2): around r = 1/2 a motion with one stop per cycle exists far below beta_lim."""
    ds = fm.design.no_stop(fm.System(**ONE), [0.48, 0.6], mu=1.5)
    assert ds.at_r.item() == pytest.approx(0.5035, abs=0.003)
    assert ds.beta.item() < 0.96 * ds.beta_no_stop_some_starts.item()
    r, beta = ds.at_r.item(), ds.beta.item()
    states = [marched(r, 1.004 * beta, start) for start in starts(6)]
    assert any(state.stops == 1.0 for state in states)
    assert all(marched(r, 0.996 * beta, start).stops == 0.0 for start in starts(6))


def test_mu_1_has_one_answer():
    ds = fm.design.no_stop(fm.System(**ONE), [0.4, 0.6])
    assert "beta_no_stop_some_starts" not in ds
    assert fm.boundaries(fm.System(**ONE), [ds.at_r.item()]).beta_lim.item() == ds.beta.item()


def test_a_limit_is_kept_up_to_friction_that_holds():
    """Above beta_stick sliding motions exist: a range without end begins where those keep the limit, too."""
    system, band = fm.System(damping_ratios=0.05), [0.4, 0.6]
    ds = fm.design.at_most(system, band, 0.3, mu=1.5)
    assert (ds.interval_end.values, ds.beta.item(), str(ds.kind.values)) == ([np.inf], 1.0, "threshold")
    assert ds.beta_stuck_some_starts.item() == pytest.approx(2.0 / 3.0, rel=1e-12)
    begin = ds.interval_begin.values[0]
    assert begin > 0.8
    r = np.linspace(*band, 60)
    for start in ("rest", "moving"):
        found = fm.sweep(system, r, [1.001 * begin, 0.5 * (begin + 1.0), 1.0], 1.5, start=start,
                         outputs=["amplitude"])  # fmt: skip
        assert found.amplitude.max() <= 0.3
    below = fm.sweep(system, r, [0.99 * begin], 1.5, start="moving", outputs=["amplitude"])
    assert below.amplitude.max() > 0.3
