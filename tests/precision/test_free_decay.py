"""Free decays: the model against marching, estimates against truths and their Cramer-Rao bounds."""

import json

import mpmath as mp
import numpy as np
import pytest
from decays import Truth, marched, synthetic

import frictionmap as fm
from frictionmap.identify.decay.motion import (
    PARAMETERS,
    Decay,
    amplitudes,
    displacement,
    displacement_and_slopes,
    envelope,
)

MIXED = Truth(3.086, 0.012, 0.15, 12.0, -0.02, -0.4, 250.0, 6.0, 0.03)
COULOMB = Truth(3.086, 0.0, 0.35, 9.0, -0.031, 0.2, 250.0, 4.0, 0.02)
VISCOUS = Truth(5.2, 0.02, 0.0, 4.0, -0.01, 0.0, 500.0, 5.0, 0.02)
SHORT = Truth(2.0, 0.004, 1.1, 7.3, -0.03, 0.0, 200.0, 3.0, 0.02)

#: Cramer-Rao bounds of f_n [Hz], zeta and x_F [mm], computed apart from the package.
BOUNDS = {
    MIXED: (5.0119e-5, 3.1051e-5, 1.9613e-4),
    COULOMB: (9.6249e-5, 6.7583e-5, 3.8305e-4),
    VISCOUS: (7.7862e-5, 3.2755e-5, 5.8570e-5),
}


def decay_of(truth):
    return Decay(*truth[: len(PARAMETERS)])


# The model


@pytest.mark.parametrize(
    ("truth", "mu"), [(COULOMB, 1.0), (MIXED, 1.0), (SHORT, 1.3), (MIXED._replace(X0=-5.0, zeta=0.2), 1.0)]
)
def test_the_motion_is_that_of_the_equation(truth, mu):
    time = np.sort(np.random.default_rng(3).uniform(truth.t0, truth.length, 400))
    expected, half_cycles = marched(truth, mu, time)
    # 25 half cycles at 1e-12 a step: some 1e-10
    np.testing.assert_allclose(displacement(decay_of(truth), half_cycles, time), expected, atol=1e-9)


@pytest.mark.parametrize(("zeta", "x_F", "X0", "n"), [("0.012", "0.15", "12", 24), ("0", "0.35", "9", 13)])
def test_turning_points_to_the_last_digits(zeta, x_F, X0, n):
    with mp.workdps(40):
        zeta, x_F, height = mp.mpf(zeta), mp.mpf(x_F), mp.mpf(X0)
        q = mp.exp(-mp.pi * zeta / mp.sqrt(1 - zeta**2))
        expected = [float(height)]
        for _ in range(n):
            height = q * height - (1 + q) * x_F
            expected.append(float(height))
        decay = Decay(1.0, float(zeta), float(x_F), float(X0), 0.0, 0.0)
    # each step rounds by some 1e-16 of at most 12 mm
    np.testing.assert_allclose(amplitudes(decay, n), expected, atol=n * 12.0 * 4.5e-16)


@pytest.mark.parametrize("zeta", [0.0, 1e-300, 1e-12, 0.012, 0.3])
@pytest.mark.parametrize("x_F", [0.0, 0.15])
def test_the_envelope_passes_through_all_turning_points(zeta, x_F):
    """By T(4.2) with viscous damping, step by step in 40 digits; the steps round as those above do."""
    with mp.workdps(40):
        root = mp.sqrt(1 - mp.mpf(zeta) ** 2)
        q, height, expected = mp.exp(-mp.pi * mp.mpf(zeta) / root), mp.mpf(12), []
        for _ in range(25):
            expected.append(float(height))
            height = q * height - (1 + q) * mp.mpf(x_F)
        times = [float(mp.mpf(j) / (2 * mp.mpf(3.1) * root) - mp.mpf(0.02)) for j in range(25)]
    found = envelope(Decay(3.1, zeta, x_F, -12.0, -0.02, 0.4), np.array(times))
    np.testing.assert_allclose(found, expected, atol=25 * 12.0 * 4.5e-16)


def test_the_envelope_is_straight_under_friction_alone_and_exponential_without_it():
    time = np.linspace(-0.02, 3.0, 50)
    straight = 12.0 - 4.0 * 0.15 * 3.1 * (time + 0.02)
    np.testing.assert_allclose(envelope(Decay(3.1, 0.0, 0.15, 12.0, -0.02, 0.4), time), straight, atol=1e-13)
    falling = 12.0 * np.exp(-0.02 * 2.0 * np.pi * 3.1 * (time + 0.02))
    np.testing.assert_allclose(envelope(Decay(3.1, 0.02, 0.0, 12.0, -0.02, 0.4), time), falling, atol=1e-13)


def test_turning_points_of_the_reference(measured):
    for row in json.loads((measured / "exact.json").read_text())["exact_values"]["decay_extrema"]:
        n = len(row["extrema"]) - 1
        found = amplitudes(Decay(1.0, row["zeta"], row["x_F"], row["X0"], 0.0, 0.0), n)
        signs = np.sign(row["X0"]) * (-1.0) ** np.arange(n + 1)
        np.testing.assert_allclose(signs * found, row["extrema"], atol=2e-14)


@pytest.mark.parametrize("truth", [MIXED, COULOMB, SHORT._replace(X0=-7.3)])
@pytest.mark.parametrize("n", [3, 200])
def test_slopes_are_those_of_the_motion(truth, n):
    """Against central differences of step h: their error is some h^2, rounding 1e-14/h."""
    time = np.random.default_rng(5).uniform(truth.t0 + 0.01, 2.0, 300)
    slopes = displacement_and_slopes(decay_of(truth), n, time)[1]
    h = 1e-6
    for k in range(len(PARAMETERS)):
        above, below = list(decay_of(truth)), list(decay_of(truth))
        above[k] += h
        below[k] -= h
        difference = (displacement(Decay(*above), n, time) - displacement(Decay(*below), n, time)) / (2.0 * h)
        np.testing.assert_allclose(slopes[:, k], difference, atol=2e-8 * max(1.0, np.abs(difference).max()))


def test_held_before_it_is_let_go():
    decay = decay_of(MIXED._replace(t0=0.5))
    assert (displacement(decay, 24, np.array([0.0, 0.3, 0.5])) == decay.X0 + decay.centre).all()


# Estimates


@pytest.mark.parametrize("truth", BOUNDS, ids=["mixed", "coulomb", "viscous"])
def test_estimates_reach_the_cramer_rao_bound(truth):
    ds = fm.identify.free_decay(*synthetic(truth, seed=11))
    for name, bound in zip(("f_n", "zeta", "x_F"), BOUNDS[truth], strict=True):
        one = ds.sel(parameter=name)
        assert abs(float(one.estimate) - getattr(truth, name)) < 4.0 * bound
        # the scatter of a residual is known to 1/sqrt(2 n), below 3 % here
        assert float(one.standard_error) == pytest.approx(bound, rel=0.1)


KINDS = ("decay-coulomb", "decay-mixed", "decay-viscous", "decay-noisy", "decay-short")


@pytest.mark.parametrize("folder", ["visible-1", "visible-2"])
@pytest.mark.parametrize("kind", KINDS)
def test_synthetic_measurements(measured, folder, kind):
    truth = json.loads((measured / folder / "truth.json").read_text())[kind]
    time, x = np.loadtxt(measured / folder / f"{kind}.csv", delimiter=",", skiprows=1, unpack=True)
    ds = fm.identify.free_decay(time, x)
    for name, tolerance in truth["tolerance"].items():
        one = ds.sel(parameter=name)
        assert abs(float(one.estimate) - truth[name]) < tolerance, name
        assert 0.8 < float(one.standard_error) / truth["crb"][name] < 1.25, name
        assert np.isfinite([one.lower, one.upper]).all()
    if truth["rest"] is not None:
        assert int(ds.half_cycles) == truth["half_cycles"]
        assert float(ds.rest) == pytest.approx(truth["rest"], abs=truth["tolerance"]["X0"])
        assert float(ds.mu_lower) < truth["mu"] < float(ds.mu_upper)
    correlation = float(ds.correlation.sel(parameter="zeta", parameter2="x_F"))
    assert correlation == pytest.approx(truth["corr_zeta_xF"], abs=0.01)


@pytest.mark.slow
def test_intervals_have_their_nominal_coverage():
    """Of 16 intervals fewer than 12 hold it in one of 1,200 cases; `benchmarks coverage` asks it of 400."""
    seeds = 16
    names = ["f_n", "zeta", "x_F", "X0", "t0", "centre"]
    truths = np.array([getattr(MIXED, name) for name in names])
    held, scaled = [], []
    for seed in range(seeds):
        ds = fm.identify.free_decay(*synthetic(MIXED, seed))
        held.append((ds.lower.values <= truths) & (truths <= ds.upper.values))
        scaled.append((ds.estimate.values - truths) / ds.standard_error.values)
    assert (np.sum(held, axis=0) >= 12).all()
    # the scatter of 16 normal deviates is 1, give or take 0.18
    np.testing.assert_allclose(np.sqrt(np.mean(np.square(scaled), axis=0)), 1.0, atol=0.4)


def test_a_bound_on_zeta_is_reported():
    """Without viscous damping half of all fits would have it below zero."""
    flags = []
    for seed in range(8):
        ds = fm.identify.free_decay(*synthetic(COULOMB, seed)).sel(parameter="zeta")
        flags.append(int(ds.at_bound))
        assert float(ds.estimate) >= 0.0 == float(ds.lower)
        assert (float(ds.estimate) == 0.0) == bool(ds.at_bound)
        assert float(ds.upper) > 0.0
    assert 0 < sum(flags) < 8


@pytest.mark.parametrize(
    ("truth", "found"),
    [
        (MIXED, "both_found"),
        (COULOMB, "friction_found"),
        (VISCOUS, "viscous_damping_found"),
        (VISCOUS._replace(zeta=0.0), "neither_found"),
    ],
)
def test_verdict(truth, found):
    verdict = fm.identify.free_decay(*synthetic(truth, seed=2)).verdict
    assert verdict.flag_meanings.split()[int(verdict)] == found


def test_the_linear_decrement_is_right_without_damping_and_wrong_with_it():
    """T(4.3): a maximum is 4 x_F below the one before if zeta = 0."""
    exact = fm.identify.free_decay(*synthetic(COULOMB, 1))
    assert float(exact.linear_decrement) == pytest.approx(COULOMB.x_F, abs=0.005)
    mixed = fm.identify.free_decay(*synthetic(MIXED, 1))
    assert float(mixed.linear_decrement) > 1.5 * MIXED.x_F


def test_the_linear_decrement_takes_every_pair_of_maxima():
    """T(4.3) and what follows (4.2): from the first maximum in the record to the last one that it left.

    The first one, at t0 < 0, is not in it; the one at which the mass rests is no turning point.
    """
    q = np.exp(-np.pi * MIXED.zeta / np.sqrt(1.0 - MIXED.zeta**2))
    heights = [MIXED.X0]
    while heights[-1] > MIXED.x_F:
        heights.append(q * heights[-1] - (1.0 + q) * MIXED.x_F)
    maxima = np.array(heights[2:-1:2])
    expected = np.mean(maxima[:-1] - maxima[1:]) / 4.0
    assert expected == pytest.approx(0.2450, abs=1e-4)
    ds = fm.identify.free_decay(*synthetic(MIXED._replace(noise=1e-4), 1))
    assert float(ds.linear_decrement) == pytest.approx(expected, abs=1e-4)


@pytest.mark.parametrize(
    ("truth", "mu", "seed"),
    [
        (Truth(5.5577, 0.00215, 0.058705, -3.54844, -0.00025, 1.1903, 292.83, 2.524, 0.08078), 1.3345, 18),
        (Truth(2.38278, 0.02629, 0.5217, 9.1799, -0.00968, -1.4152, 151.36, 1.5016, 0.07806), 1.078, 308),
        (Truth(8.47412, 0.0, 0.199445, -10.703, -0.01284, 0.00261, 324.28, 1.6095, 0.0704), 1.3878, 334),
        (Truth(2.25655, 0.0, 0.783792, 8.53337, -0.08176, -0.98198, 99.73, 1.1079, 0.02789), 1.599, 392),
    ],
)
def test_a_better_sum_counts_more_than_a_motion_that_can_be(truth, mu, seed):
    """Of 400 random decays these ended at residuals of 9 to 60 times the noise, as a worse n could be."""
    ds = fm.identify.free_decay(*synthetic(truth, seed, mu))
    count = ds.sizes["sample"] - 6
    # a variance from so many residuals is known to sqrt(2/count)
    assert float(ds.reduced_chi_square) / truth.noise**2 == pytest.approx(1.0, abs=4.0 * np.sqrt(2.0 / count))
    for name in ("f_n", "zeta", "x_F"):
        one = ds.sel(parameter=name)
        assert abs(float(one.estimate) - getattr(truth, name)) < 5.0 * float(one.standard_error) + 1e-12


# Drift and outliers


def test_a_drift_is_reported_and_does_not_change_the_estimates():
    drift = 0.08  # mm/s: half a millimetre over the record, 16 times the noise
    time, x = synthetic(MIXED, 21)
    ds = fm.identify.free_decay(time, x + drift * time, drift=True)
    assert ds.parameter.values[-1] == "drift"
    assert ds.unit.values[-1] == "mm/s"
    truth = dict(zip(PARAMETERS, MIXED, strict=False)) | {"drift": drift}
    for name, value in truth.items():
        one = ds.sel(parameter=name)
        assert abs(float(one.estimate) - value) < 4.0 * float(one.standard_error), name
    for name, bound in zip(("f_n", "zeta", "x_F"), BOUNDS[MIXED], strict=True):
        assert float(ds.standard_error.sel(parameter=name)) < 1.3 * bound  # one unknown more
    without = fm.identify.free_decay(time, x + drift * time)
    assert float(without.residual_rms) > 2.0 * float(ds.residual_rms)


def test_outliers_have_little_weight():
    """One sample in 50 is off by 30 times the noise: least squares is pulled, soft_l1 is not."""
    names = ["f_n", "zeta", "x_F"]
    truth = [MIXED.f_n, MIXED.zeta, MIXED.x_F]
    pulled, soft = [], []
    for seed in range(6):
        time, x = synthetic(MIXED, seed)
        rng = np.random.default_rng([seed, 1])
        hit = rng.choice(x.size, x.size // 50, replace=False)
        x[hit] += 30.0 * MIXED.noise * rng.choice([-1.0, 1.0], hit.size)
        for loss, scaled in (("linear", pulled), ("soft_l1", soft)):
            ds = fm.identify.free_decay(time, x, loss=loss).sel(parameter=names)
            scaled.append((ds.estimate.values - truth) / np.array(BOUNDS[MIXED]))
            if loss == "soft_l1":
                ratio = ds.standard_error.values / np.array(BOUNDS[MIXED])
                # the shoulders of the cost and the hits take a little more than the bound
                assert (ratio > 0.9).all()
                assert (ratio < 1.5).all()
    assert np.sqrt(np.mean(np.square(soft))) < 1.6
    assert np.sqrt(np.mean(np.square(pulled))) > 2.0 * np.sqrt(np.mean(np.square(soft)))


def test_without_outliers_both_costs_agree():
    """Of normal noise the soft cost is nearly as efficient: estimates differ by parts of their error."""
    time, x = synthetic(COULOMB, 5)
    linear, soft = (fm.identify.free_decay(time, x, loss=loss) for loss in ("linear", "soft_l1"))
    difference = np.abs(linear.estimate - soft.estimate)
    assert (difference < 0.6 * linear.standard_error).all()
    ratio = (soft.standard_error / linear.standard_error).values
    assert (ratio > 0.97).all()
    assert (ratio < 1.15).all()


# Records as they come


def test_a_record_may_begin_with_the_mass_held():
    truth = MIXED._replace(t0=0.8)
    time = np.arange(1700) / 250.0
    x, half_cycles = marched(truth, 1.0, time)
    ds = fm.identify.free_decay(time, x + np.random.default_rng(4).normal(0.0, 0.03, x.size))
    assert int(ds.half_cycles) == half_cycles
    assert abs(float(ds.estimate.sel(parameter="x_F")) - truth.x_F) < 4.0 * BOUNDS[MIXED][2]
    assert abs(float(ds.estimate.sel(parameter="t0")) - 0.8) < 2e-4


def test_times_need_not_be_uniform():
    time, x = synthetic(MIXED, 8)
    kept = np.sort(np.random.default_rng(8).choice(time.size, 900, replace=False))
    ds = fm.identify.free_decay(time[kept], x[kept])
    widened = np.sqrt(time.size / 900)
    for name, bound in zip(("f_n", "zeta", "x_F"), BOUNDS[MIXED], strict=True):
        assert abs(float(ds.estimate.sel(parameter=name)) - getattr(MIXED, name)) < 4.0 * widened * bound


def test_units_are_those_of_the_data():
    time, x = synthetic(COULOMB, 6)
    in_mm = fm.identify.free_decay(time, x, base=1.75, stiffness=1191.0)
    in_m = fm.identify.free_decay(time, 1e-3 * x, unit="m", base=1.75e-3, stiffness=1191.0)
    lengths = [
        name for name, unit in zip(in_m.parameter.values, in_m.unit.values, strict=True) if unit == "m"
    ]
    assert lengths == ["x_F", "X0", "centre"]
    scale = np.where(np.isin(in_m.parameter.values, lengths), 1e-3, 1.0)
    # both end at the same sum of squares, to what the search leaves: far below a standard error
    error = np.abs(in_m.estimate.values / scale - in_mm.estimate.values)
    assert (error < 1e-3 * in_mm.standard_error.values).all()
    assert float(in_m.beta) == pytest.approx(float(in_mm.beta), rel=1e-6)
    assert float(in_mm.beta) == pytest.approx(0.2, abs=0.002)
    assert float(in_mm.friction_force) == pytest.approx(1191.0 * 0.35e-3, abs=0.002)
    assert float(in_m.friction_force) == pytest.approx(float(in_mm.friction_force), rel=1e-6)


def test_what_is_known_is_held():
    ds = fm.identify.free_decay(*synthetic(MIXED, 9), known={"zeta": 0.012, "centre": -0.4})
    assert ds.estimate.sel(parameter=["zeta", "centre"]).values.tolist() == [0.012, -0.4]
    assert ds.standard_error.sel(parameter=["zeta", "centre"]).values.tolist() == [0.0, 0.0]
    one = ds.sel(parameter="x_F")
    assert abs(float(one.estimate) - 0.15) < 4.0 * float(one.standard_error)
    # most of its error was that of zeta: sqrt(1 - 0.945^2) is a third
    assert float(one.standard_error) < 0.5 * BOUNDS[MIXED][2]


def test_coloured_residuals_make_errors_larger():
    """Samples that repeat 0.8 of the one before count as a ninth of them: errors are three times as large."""
    rng = np.random.default_rng(10)
    time, x = synthetic(MIXED._replace(noise=0.0), 0)
    noise = np.empty(x.size)
    noise[0] = rng.normal()
    for k in range(1, x.size):
        noise[k] = 0.8 * noise[k - 1] + 0.6 * rng.normal()
    ds = fm.identify.free_decay(time, x + 0.03 * noise)
    assert float(ds.residual_correlation) == pytest.approx(0.8, abs=0.06)
    assert float(ds.error_inflation) == pytest.approx(3.0, abs=0.6)
    assert "does not explain the data down to the noise" in ds.warnings


def test_a_viscous_decay_into_the_noise_is_not_at_rest():
    truth = Truth(18.0, 0.043, 0.0, 15.0, -0.002, 1.3, 1500.0, 1.33, 0.008)
    ds = fm.identify.free_decay(*synthetic(truth, 12))
    assert int(ds.at_rest) == 0
    one = ds.sel(parameter="zeta")
    assert abs(float(one.estimate) - truth.zeta) < 4.0 * float(one.standard_error)


def test_the_first_turning_point_is_the_last_one_before_the_record():
    """Also where noise makes one up at the beginning."""
    truth = Truth(13.6, 0.021, 0.0, -12.4, -0.0104, -0.15, 1741.0, 1.72, 0.73)
    for seed in range(50, 58):
        ds = fm.identify.free_decay(*synthetic(truth, seed))
        assert abs(float(ds.estimate.sel(parameter="t0")) - truth.t0) < 0.002
