"""The coverage benchmark: its truths are those of other generators, and its counts can fail."""

import json

import decays
import numpy as np
import pytest
import records
import responses
from conftest import ROOT
from scipy.interpolate import CubicSpline
from shaken_masses import STEP, TURN, base_motion, marched

import frictionmap as fm
from benchmarks.measures import coverage
from benchmarks.measures.coverage import counting, disturbances
from benchmarks.measures.coverage import decays as made_decays
from benchmarks.measures.coverage import histories as made_histories
from benchmarks.measures.coverage import sensors as made_sensors
from benchmarks.measures.coverage.case import Estimate, Made, Trial, attempt, cramer_rao
from benchmarks.references.chains import chain, continuous
from benchmarks.references.shaken import Rig, steady
from benchmarks.report.quoted_coverage import coverage_lines


@pytest.mark.parametrize("decay", [made_decays.HEAVY, made_decays.WITH_GAP, made_decays.NOISY])
def test_decays_are_those_marched_from_the_equation_of_motion(decay):
    truth = decays.Truth(*decay[:6], decay.rate, decay.length, 0.0)
    time = np.arange(60) / 15.0
    wanted, count = decays.marched(truth, decay.mu, time)
    assert made_decays.half_cycles(decay) == count
    np.testing.assert_allclose(made_decays.places(decay, count, time), wanted, atol=1e-8)


@pytest.mark.parametrize("order", [0, 1, 2])
@pytest.mark.parametrize("low_pass", [None, (1, 12.0), (2, 20.0)])
def test_signals_of_sensors_are_those_marched_with_their_filters(order, low_pass):
    decay = made_decays.Decay(2.0, 0.01, 0.4, -6.0, 0.1, 0.0)
    truth = decays.Truth(*decay[:6], 0.0, 0.0, 0.0)
    time = np.arange(300) / 75.0
    for coupling in (None, 0.2):
        found = made_sensors.seen(decay, made_sensors.Route(order, low_pass, coupling), time)
        wanted = decays.marched_signal(truth, order, time, low_pass, coupling)
        scale = 6.0 * (4.0 * np.pi) ** order
        # the reference interpolates its steps, which are long while the mass is at rest
        np.testing.assert_allclose(found, wanted, atol=1e-7 * scale)


def test_a_wander_with_an_ac_coupling_is_no_reason_to_refuse():
    """Its polynomials hide the offset, not friction and damping."""
    names = [case.name for case in coverage.KINDS["free_decay"]]
    found = coverage.trial(("free_decay", names.index("acceleration, AC coupling"), 18))
    assert found.refusal is None
    assert any("a polynomial of time with" in words for words in found.warnings)
    for name in ("f_n", "zeta", "x_F"):
        assert abs(found.estimates[name].deviation) < 4.0


@pytest.mark.parametrize(("contact", "friction"), [("fixed-wall", 0.7), ("joined-base-wall", 0.08)])
def test_shaken_motions_are_those_integrated(contact, friction):
    base = (0.02, 1.82 * np.exp(0.7j), 0.02 * np.exp(2.0j))
    truth = records.Truth(3.13, 0.06, friction, 1.2, -0.1, 1.0, base, contact, "ground")
    wanted = records.steady(truth, cycles=100, accuracy=1e-9)
    found = steady(Rig(*truth[:7], contact == "joined-base-wall", False))
    assert found.settled
    assert found.stops == wanted.stops > 0
    time = np.linspace(0.0, 1.0, 200)
    np.testing.assert_allclose(found.places(time), records.places(truth, wanted, time), atol=1e-7)


@pytest.mark.parametrize("r", [0.7, 1.3])
def test_continuous_motions_are_those_of_one_mass_and_of_the_marched_one(r):
    beta, zeta = 0.3, 0.02
    found = continuous(chain([1.0], [1.0], [zeta], True), 0, False, r, beta)
    assert found[0] == pytest.approx(responses.continuous(r, beta, zeta), rel=1e-10)
    marched = steady(Rig(1.0, zeta, beta, 1.0, 0.0, r, (0.0, 1.0)))
    assert marched.first_harmonic() == pytest.approx(found[0], rel=1e-6)


@pytest.mark.parametrize("mu", [1.0, 1.3])
def test_motions_under_any_base_are_those_integrated(mu):
    """The same base, a spline through samples, by DOP853 between events, whose errors grow at these."""
    fine, zeta = 20, 0.012
    time = np.arange(241) * STEP
    spline, every = CubicSpline(time, base_motion(time)), np.arange(240 * fine + 1) * STEP / fine
    wanted = marched(time, spline(time), 3.1, zeta, 0.8, mu, (0.0, 0.0))
    w = TURN * 3.1
    load = spline(every) + 2.0 * zeta / w * spline(every, 1)
    march = made_histories.March(made_histories.Mass(w, zeta, 0.8, mu), STEP / fine, load).run()
    changes = np.flatnonzero(np.diff(march.side))
    assert changes.size > 10
    assert set(march.side) == {-1.0, 0.0, 1.0}
    np.testing.assert_allclose(march.u[::fine], wanted, atol=1e-6)
    inside = np.setdiff1d(np.arange(1, every.size - 1), np.concatenate((changes, changes + 1)))
    slopes = (march.v[inside + 1] - march.v[inside - 1]) * fine / (2.0 * STEP)
    found = made_histories.accelerations(march)[inside]
    np.testing.assert_allclose(found, slopes, atol=1e-3 * np.abs(found).max())


def test_a_motion_that_stops_is_not_continuous():
    assert continuous(chain([1.0], [1.0], [0.004], True), 0, False, 0.3, 0.6) is None


def test_a_wander_has_no_mean_and_outliers_are_few_and_far():
    rng, time = np.random.default_rng(1), np.arange(4000) / 100.0
    zero = disturbances.wander(rng, time, 0.02)
    assert abs(zero.mean()) < 1e-12
    far = disturbances.outliers(rng, 100_000, 0.02)
    assert set(np.unique(far)) == {-0.2, 0.0, 0.2}
    assert 0.018 < np.mean(far != 0.0) < 0.022


def test_the_bound_of_a_straight_line():
    """Variances of the least squares of a + b t are s^2/n and s^2/sum(t^2) for centred times."""
    t = np.linspace(-1.0, 1.0, 101)
    bound = cramer_rao(lambda values: values[0] + values[1] * t, {"a": 3.0, "b": -2.0}, 0.1)
    assert bound["a"] == pytest.approx(0.1 / np.sqrt(101))
    assert bound["b"] == pytest.approx(0.1 / np.sqrt(np.sum(t**2)))


def trials(inside, outside, refused=0):
    found = [
        Trial(seed, 0.1, None, (), {"f_n": Estimate(seed < inside, 1.0 if seed < inside else 3.0, 1.0)})
        for seed in range(inside + outside)
    ]
    return found + [Trial(900 + k, 0.1, "x must decay", (), {}) for k in range(refused)]


def test_counts_of_intervals():
    assert counting.band(400) == pytest.approx((0.9275, 0.97), abs=0.0026)
    good, low, short = (
        counting.row(trials(*one))["parameters"]["f_n"] for one in ((381, 19), (369, 31), (360, 40))
    )
    assert (good["coverage"], good["below the band"], good["short"]) == (381 / 400, False, False)
    assert (low["below the band"], low["short"]) == (True, False)
    assert (short["below the band"], short["short"]) == (True, True)
    assert short["error over standard error"]["worst"] == 3.0
    assert short["seeds outside"][0] == 360


def test_refusals_are_counted_and_quoted():
    content = {
        "kinds": {
            "free_decay": {"a case": counting.row(trials(90, 5, 5)), "refused": counting.row(trials(0, 0, 3))}
        }
    }
    text = "\n".join(coverage_lines(content))
    assert "| `free_decay` | a case | 100 | 5 | 0 | 94.7 % | 94.7 % (f_n) |" in text
    assert 'Refused: 5 of 100 of `free_decay`, a case, with "x must decay".' in text
    assert "| refused | 3 | 3 | 0 | - | - | - | - |" in text


def test_a_fit_that_fails_is_kept_by_name():
    def refuse():
        raise fm.InputError("x must move; got 3.5")

    def fail():
        raise ZeroDivisionError("by 0")

    assert attempt(Made({}, refuse), 1).refusal == "x must move; got #"
    assert attempt(Made({}, fail), 1).refusal == "ZeroDivisionError: by #"


def test_every_kind_meets_every_condition_that_it_can():
    def names(kind):
        return " ".join(case.name for case in coverage.KINDS[kind] if case.seeds >= 400)

    for kind in ("free_decay", "record"):
        for word in ("noise only", "gap", "drift", "wander", "outliers", "clipped", "zeta 0."):
            assert word in names(kind)
    for kind in ("forced", "sweep"):  # tables have no time
        for word in ("noise only", "outliers", "zeta 0."):
            assert word in names(kind)


def test_the_kept_table_has_all_cases_and_no_interval_that_falls_short():
    """`short`: as few intervals hold their truth as chance makes in fewer than one of 1,000 counts."""
    kept = json.loads((ROOT / "benchmarks" / "results" / "coverage.json").read_text(encoding="utf-8"))[
        "kinds"
    ]
    for kind, cases in coverage.KINDS.items():
        for case in cases:
            row = kept[kind][case.name]
            assert row["seeds"] in (case.seeds, round(coverage.SHARE * case.seeds)), (kind, case.name)
            assert not [name for name, one in row["parameters"].items() if one["short"]], (kind, case.name)
