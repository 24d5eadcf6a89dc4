"""What a damper test shows, what it lacks, and what it cannot show; data from springs that are marched."""

from collections.abc import Mapping

import numpy as np
import pytest
import xarray as xr

from benchmarks.measures.coverage.loops import CASES, TESTS, Actuator, Damper, marched, measured
from frictionmap.errors import InputError
from frictionmap.identify import loop
from frictionmap.identify.loop.descent import descend
from frictionmap.identify.loop.shape import reversals, shape_fit
from frictionmap.identify.signals.turning_points import turns
from frictionmap.identify.statistics.least_squares import Problem

PLAIN = ["friction", "contact_stiffness", "offset"]
SINE = TESTS["sine"]._replace(rate=100.0)
PLAY = TESTS["play, and friction that depends on the direction"]
STATIC = TESTS["static friction"]
LAW = TESTS["speed law, rising frequency"]


def fitted(
    test: Damper, free: list[str], seed: int = 1, known: Mapping[str, float] | None = None
) -> xr.Dataset:
    time, moved, force = measured(np.random.default_rng(seed), test, test.truth)
    return loop(time, force, displacement=moved, free=free, law_speeds=test.speeds, known=known)


def verdict_of(ds: xr.Dataset) -> str:
    return str(ds["verdict"].attrs["flag_meanings"]).split()[int(ds["verdict"])]


def deviations(ds: xr.Dataset, truth: Mapping[str, float]) -> dict[str, float]:
    """Errors over standard errors."""
    rows = {name: ds.sel(parameter=name) for name in truth}
    return {
        name: float((row["estimate"] - truth[name]) / row["standard_error"]) for name, row in rows.items()
    }


@pytest.mark.parametrize("stiffness", [0.7, 1.0])
def test_the_marched_force_dissipates_the_area_of_the_loop(stiffness: float) -> None:
    """A spring in series with a slider, moved by A: 4 F (A - F/kt) per cycle."""
    truth = {"friction": 60.0, "contact_stiffness": 150.0 * stiffness}
    test = Damper(truth, Actuator(2.0, 1.0), (0.0, 0.0), rate=400.0, length=3.0)
    _, u, force = measured(np.random.default_rng(0), test, truth)
    cycle = slice(400, 801)  # after the first slip
    wanted = 4.0 * 60.0 * (2.0 - 60.0 / truth["contact_stiffness"])
    # the trapezoidal rule misses 1e-4 of it at the corners
    assert np.trapezoid(force[cycle], u[cycle]) == pytest.approx(wanted, rel=1e-3)
    assert np.abs(force).max() == pytest.approx(60.0, rel=1e-12)


@pytest.mark.parametrize("seed", [1, *(pytest.param(k, marks=pytest.mark.slow) for k in (2, 3))])
def test_forces_that_drop_at_break_away_hold_the_truth(seed: int) -> None:
    """The sample at which a branch breaks away hops: a plain descent ends beside the least sum."""
    short = LAW._replace(length=3.2)
    ds = fitted(short, list(short.truth), seed)
    assert max(abs(one) for one in deviations(ds, short.truth).values()) < 4.0
    # a single sample on the wrong side would leave 30 N
    assert float(ds["sigma_force"]) < 1.15 * short.noise[1]


@pytest.mark.parametrize("seed", [0, *(pytest.param(k, marks=pytest.mark.slow) for k in (1, 2, 3))])
def test_static_friction_is_in_its_interval(seed: int) -> None:
    short = STATIC._replace(length=5.0)
    ds = fitted(short, list(short.truth), seed)
    mu = ds.sel(parameter="mu")
    lower, upper = float(mu["lower"]), float(mu["upper"])
    assert lower <= 1.25 <= upper
    assert np.isnan(float(mu["standard_error"]))
    # the spring's force changes by kt du = 0.14 F between two samples here
    assert upper - lower < 0.14
    assert verdict_of(ds) == "peak"
    others = {name: value for name, value in short.truth.items() if name != "mu"}
    assert max(abs(one) for one in deviations(ds, others).values()) < 4.0


def test_small_reversals_are_turning_points() -> None:
    """Of ten deviations of the noise: too little for samples, enough for the motion that they show."""
    time = np.arange(800) / 200.0
    u = 2.0 * np.cos(1.4 * np.pi * time + 0.3) + 0.3 * np.cos(9.8 * np.pi * time + 0.5)
    noisy = u + np.random.default_rng(2).normal(0.0, 0.002, time.size)
    layout, _ = shape_fit(time, noisy, 0)
    wanted = len(turns(u, 0.01))
    assert reversals(time, noisy, 0).size < wanted
    assert layout.branches == wanted + 1


@pytest.mark.parametrize(
    ("name", "free", "wanted"),
    [
        ("sine", [*PLAIN, "mu"], "friction"),
        pytest.param("sine", PLAIN, "friction", marks=pytest.mark.slow),
        pytest.param("sine", [*PLAIN, "backlash"], "friction", marks=pytest.mark.slow),
        ("play, and friction that depends on the direction", [*PLAIN, "backlash", "asymmetry"], "backlash"),
        ("nearly rigid contact", [*PLAIN, "parallel_stiffness"], "rigid"),
    ],
)
def test_verdicts(name: str, free: list[str], wanted: str) -> None:
    test = TESTS[name]
    test = test._replace(truth={**test.truth, **test.bounded})
    assert verdict_of(fitted(test, free)) == wanted


def test_verdict_of_a_speed_law_and_of_none() -> None:
    short = LAW._replace(length=3.2)
    assert verdict_of(fitted(short, list(short.truth))) == "speed_dependent"
    flat = short._replace(truth={**short.truth, "factor_1": 1.0, "factor_2": 1.0})
    assert verdict_of(fitted(flat, list(flat.truth))) == "friction"


@pytest.mark.parametrize(
    ("test", "missing"),
    [
        (PLAY._replace(truth={**PLAY.truth, "asymmetry": 0.0}), "backlash"),
        (STATIC._replace(length=5.0), "mu"),
        (SINE._replace(truth={**SINE.truth, "parallel_stiffness": 25.0}), "parallel_stiffness"),
        (SINE._replace(truth={**SINE.truth, "drift": 0.5}), "drift"),
    ],
)
def test_what_is_not_fitted_is_named(test: Damper, missing: str) -> None:
    ds = fitted(test, PLAIN)
    assert f"{missing} would explain more of the force: add {missing} to free" in ds.attrs["warnings"]


def test_a_good_fit_has_no_warnings() -> None:
    ds = fitted(SINE, PLAIN)
    assert ds.attrs["warnings"] == ""
    assert 0.8 < float(ds["reduced_chi_square_force"]) < 1.25
    # 5 standard deviations of the correlation of 640 white samples
    assert abs(float(ds["residual_correlation_force"])) < 5.0 / np.sqrt(640.0)


@pytest.mark.slow
def test_friction_that_grows_is_no_constant() -> None:
    time, u, force = measured(np.random.default_rng(3), SINE, SINE.truth)
    grown = 2.0 + (force - 2.0) * (1.0 + 0.02 * (time / time[-1] - 0.5))
    # by two thirds of 2 % from the middle of the first third to that of the last
    assert (
        "friction is not constant: in the last third of the test it differs by +1."
        in (loop(time, grown, displacement=u).attrs["warnings"])
    )


@pytest.mark.slow
def test_few_samples_and_speeds_of_the_slider_are_warned_of() -> None:
    few = fitted(SINE._replace(rate=20.0, length=12.8), PLAIN)
    assert "17 samples between two turning points: at least 20 are needed" in few.attrs["warnings"]
    # F g' u''/(kt u') is 0.17 cot(phase) below 15 mm/s, with F g' = 3.3 N s/mm, and 0.02 cot(phase) above
    soft = LAW._replace(
        truth={**LAW.truth, "contact_stiffness": 40.0, "factor_1": 0.5}, actuator=Actuator(8.0, 0.3)
    )
    assert "the contact slips at a speed that differs by" in fitted(soft, list(soft.truth)).attrs["warnings"]


@pytest.mark.parametrize(
    ("test", "more", "words"),
    [
        (SINE._replace(truth={**SINE.truth, "parallel_stiffness": 6.0, "mass": 4.0}, length=4.0),
         ["parallel_stiffness", "mass"], "identify parallel_stiffness and mass together: not identifiable"),
        (TESTS["triangle"], ["mass"], "cannot identify mass: not identifiable, no sample depends on it"),
        (SINE._replace(length=1.5), [], "the contact slips in 2 branches of the motion, 3 needed"),
    ],
)  # fmt: skip
def test_what_a_test_cannot_show_is_refused(test: Damper, more: list[str], words: str) -> None:
    with pytest.raises(InputError, match=words):
        fitted(test, [*PLAIN, *more], seed=0)


def test_without_slip_a_known_spring_leaves_stiffness_and_a_bound() -> None:
    truth = {"friction": 120.0, "contact_stiffness": 400.0, "parallel_stiffness": 25.0, "offset": 2.0}
    test = SINE._replace(truth=truth, actuator=Actuator(0.12, 0.6))
    ds = fitted(test, PLAIN, known={"parallel_stiffness": 25.0})
    assert verdict_of(ds) == "no_slip"
    assert abs(deviations(ds, {"contact_stiffness": 400.0})["contact_stiffness"]) < 4.0
    # kt times half the range of the displacement
    assert float(ds.sel(parameter="friction")["lower"]) == pytest.approx(400.0 * 0.12, rel=0.02)
    assert float(ds.sel(parameter="parallel_stiffness")["estimate"]) == 25.0


def test_descent_finds_least_sums() -> None:
    def curved(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Rosenbrock's valley, whose least sum is 0.01 at (1, 1)."""
        x, y = values
        return np.array([10.0 * (y - x**2), 1.0 - x, 0.1]), np.array([[-20.0 * x, 10.0], [-1.0, 0.0], [0, 0]])

    unbounded = np.full(2, np.inf)
    task = Problem(curved, np.ones(2, dtype=bool), -unbounded, -unbounded, unbounded)
    found = descend(task, np.array([-1.2, 1.0]), 200)
    # ends where a step gains less than 1e-6 of 0.01/3: within 1e-4 of the place, on slopes of one
    np.testing.assert_allclose(found.values, 1.0, atol=5e-4)
    held = descend(task._replace(free=np.array([False, True])), np.array([-1.2, 1.0]), 200)
    np.testing.assert_allclose(held.values, [-1.2, 1.44], atol=1e-4)
    above = descend(task._replace(lowest=np.array([-np.inf, 1.5])), np.array([-1.2, 2.0]), 200)
    assert above.values[1] > 1.5


@pytest.mark.parametrize(
    ("changed", "warnings"),
    [
        ({"mu": 1.1}, "mu would explain more of the force: add mu to free"),
        pytest.param({"factor_1": 1.2, "factor_2": 1.4}, "", marks=pytest.mark.slow),
        pytest.param({}, "", marks=pytest.mark.slow),
    ],
)
def test_static_friction_with_a_speed_law(changed: dict[str, float], warnings: str) -> None:
    """The contact breaks away at max(mu, g(V)) F."""
    short = LAW._replace(truth={**LAW.truth, **changed}, length=3.2)
    ds = fitted(short, [name for name in short.truth if name != "mu"])
    assert ds.attrs["warnings"] == warnings
    others = {name: value for name, value in short.truth.items() if name != "mu"}
    assert max(abs(one) for one in deviations(ds, others).values()) < 4.0


@pytest.mark.slow
def test_noise_of_turning_points_is_no_slip() -> None:
    """With this noise a fit whose displacement is held slips for some samples at the extremes, at 48 N."""
    test = SINE._replace(actuator=Actuator(0.12, 0.6))
    assert verdict_of(fitted(test, PLAIN, seed=10)) == "no_slip"


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(2))
def test_slip_near_the_extremes_is_found(seed: int) -> None:
    """F/kt is 0.3 mm."""
    test = SINE._replace(actuator=Actuator(0.33, 0.6))
    ds = fitted(test, PLAIN, seed)
    assert float(ds["slip_share"]) < 0.3
    assert verdict_of(ds) == "friction"
    assert max(abs(one) for one in deviations(ds, test.truth).values()) < 4.0


@pytest.mark.parametrize("seed", [0, pytest.param(1, marks=pytest.mark.slow)])
def test_a_first_branch_that_is_held_by_static_friction(seed: int) -> None:
    """It ends 0.398 mm from its beginning: more than F/kt, less than mu F/kt, 0.32 and 0.4 mm."""
    rng, fine = np.random.default_rng(seed), np.arange(17000) / 3400.0
    u, v, _ = Actuator(2.0, 0.6).motion(np.arccos(-0.801), fine, 5.0)
    force = marched(STATIC.truth, None, u, v)[::20] + 2.0
    noise = [rng.normal(0.0, one, force.size) for one in STATIC.noise]
    ds = loop(fine[::20], force + noise[1], displacement=u[::20] + noise[0], free=list(STATIC.truth))
    assert ds.attrs["warnings"] == ""
    others = {name: value for name, value in STATIC.truth.items() if name != "mu"}
    assert max(abs(one) for one in deviations(ds, others).values()) < 4.0
    assert float(ds.sel(parameter="mu")["lower"]) > 0.99 * 0.398 / 0.32


@pytest.mark.slow
def test_play_that_the_data_hardly_separate() -> None:
    """Without play, friction by direction and offset have the same effect: the normal matrix is singular."""
    name = "play, and friction that depends on the direction"
    place = list(TESTS).index(name)
    made = CASES[place].make(np.random.default_rng([5, place, 56]))
    ds = made.fit()
    for parameter, truth in made.truth.items():
        one = ds.sel(parameter=parameter)
        assert abs(float(one["estimate"]) - truth) < 4.0 * float(one["standard_error"])
