"""Records of steady motion: estimates against truths, errors against their scatter, knowledge of mu."""

import json

import numpy as np
import pytest
from records import Truth, places, steady, synthetic

import frictionmap as fm

PARAMETERS = ["f_n", "zeta", "x_F", "mu", "offset_x"]

#: Stick-slip at a third of the natural frequency, 1.1 % of second harmonic in the base, two stops a cycle.
RIG = Truth(3.13, 0.0055, 0.8372, 1.0, -0.1, 1.001, (0.0, 1.82 * np.exp(0.7j), 0.02 * np.exp(2.0j)))


def fit(truth, motion, seed, **arguments):
    time, base, x = synthetic(truth, motion, seed)
    return fm.identify.record(
        time, base, x, contact=truth.contact, damping_reference=truth.damping_reference, **arguments
    )


def off(ds, truth):
    """Estimates less truths, in standard errors; 0 of what was held."""
    exact = np.array([truth.f_n, truth.zeta, truth.x_F, truth.mu, truth.offset_x])
    error = ds.standard_error.sel(parameter=PARAMETERS).values
    distance = ds.estimate.sel(parameter=PARAMETERS).values - exact
    return distance / np.where(error > 0.0, error, np.inf)


@pytest.fixture(scope="module")
def motion():
    """The steady motion of the rig, integrated."""
    return steady(RIG)


@pytest.mark.parametrize("folder", ["visible-1", "visible-2"])
def test_synthetic_records(measured, folder):
    truth = json.loads((measured / folder / "truth.json").read_text())["record-stick-slip"]
    time, base, x = np.loadtxt(
        measured / folder / "record-stick-slip.csv", delimiter=",", skiprows=1, unpack=True
    )
    ds = fm.identify.record(time, base, x, damping_reference="base", known={"mu": 1.0})
    for name, tolerance in truth["tolerance"].items():
        one = ds.sel(parameter=name)
        assert abs(float(one.estimate) - truth[name]) < tolerance, name
        assert 0.8 < float(one.standard_error) / truth["crb"][name] < 1.25, name
    for name in ("beta", "lag_deg", "amplitude_ratio"):
        one = ds.sel(parameter=name)
        assert abs(float(one.estimate) - truth[name]) < 4.0 * float(one.standard_error), name
    assert float(ds.stops_per_cycle) == 2.0


def random_truth(seed):
    """One mass of some kind on a base with a second and a third harmonic and a mean."""
    rng = np.random.default_rng(seed)
    contact = rng.choice(["fixed-wall", "joined-base-wall"], p=[0.7, 0.3])
    f_n, r, mu = rng.uniform(2.0, 6.0), 10.0 ** rng.uniform(-0.6, 0.2), rng.choice([1.0, 1.2])
    base = rng.uniform(0.5, 3.0)
    load = base * (1.0 if contact == "fixed-wall" else r**2)
    turn = np.exp(1j * rng.uniform(0.0, 2.0 * np.pi, 3))
    harmonics = base * np.array([0.02, *([1.0, 0.011, 0.003] * turn)])
    return Truth(
        f_n, rng.uniform(0.002, 0.05), rng.uniform(0.15, 0.65) * load / mu, mu, rng.uniform(-0.3, 0.3),
        r * f_n, tuple(harmonics), str(contact), str(rng.choice(["base", "ground"])),
    )  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(10))
def test_records_of_other_rigs(seed):
    """One of 40 normal deviates is beyond 4.5 in one of 4000 such tests."""
    truth = random_truth(seed)
    integrated = steady(truth, 200, 1e-6)  # far below the noise
    assert integrated.change < 1e-5
    ds = fit(truth, integrated, seed, known={"mu": truth.mu})
    assert (np.abs(off(ds, truth)) < 4.5).all(), off(ds, truth)
    assert float(ds.stops_per_cycle) == integrated.stops
    assert float(ds.residual_rms) == pytest.approx(truth.noise_x, rel=0.08)


#: Three stops a cycle, and with mu free another minimum with two and no damping.
TWO_MINIMA = Truth(
    5.8933003, 0.013694872, 0.05243839, 1.0, -0.10178918, 1.280448176,
    (0.02445044, -0.17200323 - 2.29228553j, 0.00223244 - 0.02518729j, 0.00542241 - 0.00426085j),
    "joined-base-wall", "ground",
)  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("truth", [TWO_MINIMA, *(random_truth(seed) for seed in (3, 6))])
def test_with_one_more_unknown_no_fit_is_worse(truth):
    """The minimum that is found with mu free is no higher than that with mu held where it is."""
    integrated = steady(truth, 200, 1e-6)
    held = fit(truth, integrated, 75, known={"mu": truth.mu})
    free = fit(truth, integrated, 75)
    assert float(free.residual_rms) < float(held.residual_rms) * (1.0 + 1e-4)


@pytest.mark.slow
def test_errors_are_those_of_many_records(motion):
    """Scatter over 12 seeds is known to 21 %; `benchmarks coverage` counts the intervals of 400."""
    fits = [fit(RIG, motion, seed, known={"mu": 1.0}) for seed in range(12)]
    names = ["f_n", "zeta", "x_F", "offset_x", "beta", "lag_deg", "amplitude_ratio"]
    values = np.array([ds.estimate.sel(parameter=names).values for ds in fits])
    stated = np.array([ds.standard_error.sel(parameter=names).values for ds in fits])
    np.testing.assert_allclose(values.std(axis=0, ddof=1) / np.median(stated, axis=0), 1.0, atol=0.5)
    exact = [RIG.f_n, RIG.zeta, RIG.x_F, RIG.offset_x, RIG.x_F / abs(RIG.base[1])]
    inside = np.abs(values[:, :5] - exact) < 1.96 * stated[:, :5]
    assert 0.88 < inside.mean() <= 1.0


def test_mu_of_a_mass_that_sticks():
    truth = RIG._replace(mu=1.25)
    ds = fit(truth, steady(truth), 3)
    assert (np.abs(off(ds, truth)) < 4.0).all()
    mu = ds.sel(parameter="mu")
    assert 0.0 < float(mu.standard_error) < 0.02
    assert 1.0 < float(mu.lower) < float(mu.estimate) < float(mu.upper)


def test_mu_of_one_is_on_its_bound_or_near(motion):
    """(mu - 1)^2 is determined: the interval begins at 1."""
    for seed in range(3):
        ds = fit(RIG, motion, seed)
        mu = ds.sel(parameter="mu")
        assert float(mu.lower) == 1.0
        assert 1.0 < float(mu.upper) < 1.12
        assert (np.abs(off(ds, RIG)[[0, 1, 2, 4]]) < 4.0).all()


def test_mu_of_a_mass_that_never_sticks_is_an_interval():
    """Up to its end nothing changes, beyond it the integrated motion is another one."""
    truth = RIG._replace(f=2.6, x_F=0.5, zeta=0.02)
    moving = steady(truth)
    ds = fit(truth, moving, 1)
    mu = ds.sel(parameter="mu")
    assert (float(mu.estimate), float(mu.lower), int(mu.at_bound), int(mu.known)) == (1.0, 1.0, 1, 0)
    assert (np.abs(off(ds, truth)[[0, 1, 2, 4]]) < 4.0).all()
    assert float(ds.stops_per_cycle) == 0.0
    assert "mu cannot be determined" in ds.warnings
    assert ds.verdict.flag_meanings.split()[int(ds.verdict)] == "continuous"
    time = np.linspace(0.0, 1.0 / truth.f, 50)
    first, below, above = (
        places(truth, steady(truth._replace(mu=static), start=moving.state.copy()), time)
        for static in (1.0, 0.98 * float(mu.upper), 1.02 * float(mu.upper))
    )
    np.testing.assert_allclose(below, first, atol=1e-8)
    assert np.abs(above - first).max() > 1e-2


def test_exact_samples_give_the_parameters_back(motion):
    ds = fit(RIG._replace(noise_x=0.0, noise_y=0.0), motion, 0, known={"mu": 1.0})
    exact = [RIG.f_n, RIG.zeta, RIG.x_F, RIG.mu, RIG.offset_x]
    np.testing.assert_allclose(ds.estimate.sel(parameter=PARAMETERS), exact, atol=1e-6)
