"""The spring in a contact as an unknown of `forced` and `record`: motions found without the package."""

import functools

import numpy as np
import pytest
import springs

import frictionmap as fm
from benchmarks.references.shaken import Rig, steady
from frictionmap.general.first_harmonics import steady_phasors
from frictionmap.identify.response.balance import balanced_phasors, stick_friction

#: Frequencies [Hz] over f_n, and what is fitted.
RATIOS = np.array([0.65, 0.8, 0.93, 1.06, 1.2, 1.5, 2.0])
FREE = ["beta", "f_n", "zeta", "contact_stiffness"]
OF_RECORD = ["f_n", "zeta", "x_F", "contact_stiffness", "offset_x"]

#: A record: stick-slip at a third of the natural frequency, with a second harmonic and an offset.
RIG = Rig(3.13, 0.01, 0.9, 1.0, -0.1, 1.001, (0.0, 1.82 * np.exp(0.7j), 0.02 * np.exp(2.0j)), spring=3.0)


@functools.cache
def table(spring, betas, zeta=0.01, wall_moves=False, f_n=3.1):
    """Frequency, lag [deg], amplitude and set of every friction at every ratio, marched."""
    found = [
        steady(Rig(1.0, zeta, beta, 1.0, 0.0, r, (0.0, 1.0), wall_moves, spring=spring)).first_harmonic()
        for beta in betas
        for r in RATIOS
    ]
    sets = np.repeat(np.arange(1, len(betas) + 1), RATIOS.size)
    return np.tile(f_n * RATIOS, len(betas)), -np.degrees(np.angle(found)), np.abs(found), sets


def blurred(data, seed, lag_error=0.7, amplitude_error=0.01):
    """The same with normal errors."""
    f, lag, ratio, sets = data
    rng = np.random.default_rng(seed)
    return (
        f, lag + lag_error * rng.normal(size=f.size),
        ratio * np.exp(amplitude_error * rng.normal(size=f.size)), sets,
    )  # fmt: skip


def fitted(data, **more):
    f, lag, ratio, sets = data
    return fm.identify.forced(f, lag, ratio, sets=sets, **({"free": FREE} | more))


def sampled(rig, seed=None, length=8.0, rate=80.0):
    """Times, base and mass of a record, with errors of a seed."""
    time = np.arange(int(rate * length)) / rate
    base = (np.exp(2j * np.pi * rig.f * np.outer(time, np.arange(len(rig.base)))) @ np.array(rig.base)).real
    x = steady(rig).places(time)
    if seed is None:
        return time, base, x
    rng = np.random.default_rng(seed)
    return time, base + rng.normal(0.0, 0.003, time.size), x + rng.normal(0.0, 0.01, time.size)


def of(ds, name):
    return ds.sel(parameter=name)


def estimates(ds, names):
    return ds.estimate.sel(parameter=names).values


@pytest.mark.parametrize("truth", [(0.65, 0.5, 0.03, 3.0), (1.2, 0.8, 0.03, 1.0), (2.0, 0.1, 0.1, 0.5)])
def test_first_harmonics_are_those_integrated(truth):
    """Of the package, and of the motions from which the other tests are made."""
    r, beta, zeta, kt = truth
    expected = springs.first_harmonic(springs.Truth(*truth))
    system = fm.System(excitation="base", damping_reference="base", damping_ratios=zeta, contact_stiffness=kt)
    found, regime = steady_phasors(system, np.array([r]), np.array([beta]))
    assert found[0, 0] == pytest.approx(expected, abs=1e-9)
    assert regime[0] == fm.regimes.STICK_SLIP
    marched = steady(Rig(1.0, zeta, beta, 1.0, 0.0, r, (0.0, 1.0), spring=kt))
    assert marched.settled
    assert marched.first_harmonic() == pytest.approx(expected, abs=1e-8)


#: One mass under a force, from an independent program: r, zeta, beta, kt, real and imaginary part of X_1.
FIRST_HARMONICS = [
    (1.525, 0.05, 1.09078, 10.0, 0.1177040552434, -0.01116733004972),
    (1.103, 0.01, 0.198853, 100.0, -4.073214068082, -1.517039958476),
    (1.061, 0.05, 0.169604, 0.3, -3.444092391461, -4.410680788984),
    (1.075, 0.01, 0.547908, 30.0, -2.606145811616, -3.323881663516),
    (2.073, 0.05, 0.0244838, 0.1, -0.3096951621368, -0.02202755919691),
    (0.398, 0.01, 0.510759, 1.0, 0.567544726666, -0.1007884337154),
    (0.309, 0.05, 0.375061, 10.0, 0.8663271248275, -0.4275169206505),
    (0.669, 0.01, 0.280658, 0.3, 1.244495862363, -0.13084598513),
    (1.391, 0.05, 0.596948, 100.0, -0.3170749545076, -0.492538208684),
    (1.513, 0.01, 0.241965, 0.3, -0.9706163169891, -0.07998250464234),
    (0.52, 0.05, 0.329264, 3.0, 0.9788968849969, -0.5162816505599),
]


@pytest.mark.parametrize(("r", "zeta", "beta", "kt", "real", "imaginary"), FIRST_HARMONICS)
def test_first_harmonics_of_an_independent_program(r, zeta, beta, kt, real, imaginary):
    system = fm.System(damping_ratios=zeta, contact_stiffness=kt)
    found = steady_phasors(system, np.array([r]), np.array([beta]))[0][0, 0]
    assert found == pytest.approx(complex(real, imaginary), rel=1e-10)


def test_a_contact_that_does_not_slip_and_one_without_friction_are_linear():
    """X = V/(1 - r^2 + kt + 2 i zeta r), and without kt, by the equation of motion."""
    r, zeta, kt = np.array([0.5, 1.7]), 0.05, 3.0
    system = fm.System(excitation="base", damping_reference="base", damping_ratios=zeta, contact_stiffness=kt)
    push = 1.0 + 2j * zeta * r
    for beta, spring in ((0.0, 0.0), (50.0, kt)):
        found = steady_phasors(system, r, np.full(2, beta))[0][:, 0]
        np.testing.assert_allclose(found, push / (1.0 + spring - r**2 + 2j * zeta * r), rtol=1e-12)


def test_harmonic_balance_is_near_and_exact_where_nothing_slips():
    """The start of the fit: a few per cent off where the contact slips."""
    rigid = fm.System(excitation="base", damping_reference="base", damping_ratios=0.02)
    r, kt = np.array([0.65, 0.8, 1.2, 1.5, 2.0]), 2.0
    elastic = fm.System(
        excitation="base", damping_reference="base", damping_ratios=0.02, contact_stiffness=kt
    )
    limit = stick_friction(rigid, r, kt)
    np.testing.assert_allclose(limit, fm.boundaries(elastic, r).beta_noslip.values.ravel(), rtol=1e-10)
    for share, tolerance in ((1.5, 1e-8), (0.6, 0.1), (0.2, 0.1)):
        exact = steady_phasors(elastic, r, share * limit)[0][:, 0]
        found = balanced_phasors(rigid, r, share * limit, kt)[:, 0]
        np.testing.assert_allclose(found, exact, atol=tolerance * np.abs(exact).max())


@pytest.mark.parametrize(
    ("spring", "wall_moves", "betas"),
    [(0.5, False, (0.3, 0.6)), (3.0, False, (0.4, 0.9)), (20.0, False, (0.3, 0.7)), (3.0, True, (0.3, 0.6))],
)
def test_exact_tables_give_the_truth_back(spring, wall_moves, betas):
    """The marched motions settle to 1e-9."""
    contact = "joined-base-wall" if wall_moves else "fixed-wall"
    system = fm.System(contact=contact, excitation="base", damping_reference="base")
    ds = fitted(table(spring, betas, wall_moves=wall_moves), system=system)
    assert ds.parameter.values.tolist() == ["beta_1", "beta_2", "f_n", "zeta", "contact_stiffness"]
    np.testing.assert_allclose(ds.estimate, [*betas, 3.1, 0.01, spring], rtol=2e-6)


def test_a_contact_between_two_masses():
    """Under a force, both masses measured; data from response curves, which find harmonics in another way."""
    structure = {"mass_ratios": [1.0, 0.8], "stiffness_ratios": [1.0, 0.7], "contact": "between-masses",
                 "contact_masses": [1, 2], "damping_ratios": 0.02}  # fmt: skip
    r = np.array([0.4, 0.55, 0.7, 0.9, 1.1, 1.3, 1.5])
    curves = fm.curves(
        fm.System(**structure, contact_stiffness=2.0), r, [0.5], quantities=["first_harmonic"]
    ).isel(mu=0, beta=0)
    lags = {k: np.degrees(curves.first_harmonic_phase.sel(dof=k).values) for k in (1, 2)}
    sizes = {k: curves.first_harmonic_amplitude.sel(dof=k).values for k in (1, 2)}
    ds = fm.identify.forced(
        5.0 * r, lags, sizes, system=fm.System(**structure), free=["beta", "f_n", "contact_stiffness"]
    )
    np.testing.assert_allclose(
        estimates(ds, ["beta", "f_n", "contact_stiffness"]), [0.5, 5.0, 2.0], rtol=1e-7
    )


def test_a_known_spring_is_held_however_it_is_given():
    data = table(3.0, (0.5,))
    rigid = fm.System(excitation="base", damping_reference="base")
    elastic = fm.System(excitation="base", damping_reference="base", contact_stiffness=3.0)
    for more in ({"system": rigid, "known": {"contact_stiffness": 3.0}}, {"system": elastic}):
        ds = fitted(data, free=None, **more)
        np.testing.assert_allclose(estimates(ds, ["beta", "f_n", "zeta"]), [0.5, 3.1, 0.01], rtol=1e-6)
        spring = of(ds, "contact_stiffness")
        assert (int(spring.known), float(spring.standard_error)) == (1, 0.0)
        assert float(spring.estimate) == pytest.approx(3.0, rel=1e-15)
        assert float(spring.lower) == float(spring.upper) == float(spring.estimate)
        assert "contact stiffness 3" in ds.attrs["system"]


def test_without_a_word_the_contact_is_rigid():
    ds = fitted(blurred(table(0.0, (0.4,)), 1), free=None, known={"mu": 1.0})
    assert ds.parameter.values.tolist() == ["beta", "f_n", "zeta", "mu"]
    listed = fitted(blurred(table(0.0, (0.4,)), 1), free=["beta", "f_n", "zeta"], known={"mu": 1.0})
    np.testing.assert_array_equal(listed.estimate, ds.estimate)


def test_intervals_of_a_table_hold_the_truth():
    """Errors of 4 s.e. are rarer than 1 in 10,000; `benchmarks coverage` counts the intervals."""
    exact, truth = table(3.0, (0.4, 0.9)), np.array([0.4, 0.9, 3.1, 0.01, 3.0])
    for seed in range(3):
        ds = fitted(blurred(exact, seed), sigma_phase=0.7, sigma_amplitude=0.01)
        assert (np.abs(ds.estimate.values - truth) < 4.0 * ds.standard_error.values).all()
        assert "contact_stiffness" not in ds.warnings
        spring = of(ds, "contact_stiffness")
        assert float(spring.lower) < float(spring.estimate) < float(spring.upper) < 3.5


@pytest.mark.slow
def test_a_spring_that_the_data_do_not_determine():
    """Far from sticking, and with a rigid contact: an interval without an upper end, no standard error."""
    for data, least in ((table(3.0, (0.02, 0.05)), 0.0), (table(0.0, (0.3,)), 20.0)):
        ds = fitted(blurred(data, 2), sigma_phase=0.7, sigma_amplitude=0.01, stiffness=2000.0)
        spring = of(ds, "contact_stiffness")
        assert least < float(spring.lower) <= float(spring.estimate) <= 1e4 < float(spring.upper) == np.inf
        assert np.isnan(spring.standard_error)
        assert float(ds.spring_stiffness_lower) == pytest.approx(2000.0 * float(spring.lower))
        assert "spring_stiffness" not in ds
        assert "the data do not determine contact_stiffness: any value from" in ds.warnings
        assert "or hold contact_stiffness" in ds.warnings
        others = ds.drop_sel(parameter="contact_stiffness")
        assert np.isfinite(others.standard_error).all()


def test_a_mass_that_the_spring_holds_leads_a_base_with_a_damper():
    """By up to 4 deg here, which is no mistake in the data."""
    data = table(3.0, (0.5, 1.2), zeta=0.05)
    assert data[1].min() < -2.0
    ds = fitted(data, sigma_phase=0.1, sigma_amplitude=0.01)
    np.testing.assert_allclose(ds.estimate, [0.5, 1.2, 3.1, 0.05, 3.0], rtol=2e-6)
    with pytest.raises(fm.InputError, match="must be 0 to 180 deg for the loaded mass"):
        fitted(data, free=None, sigma_phase=0.1, sigma_amplitude=0.01)


def test_stiffness_in_newtons_per_metre():
    ds = fitted(table(3.0, (0.4, 0.9)), stiffness=2000.0)
    assert float(ds.spring_stiffness) == pytest.approx(6000.0, rel=1e-5)
    assert ds.spring_stiffness.attrs["units"] == "N/m"
    error = float(of(ds, "contact_stiffness").standard_error)
    assert float(ds.spring_stiffness_standard_error) == pytest.approx(2000.0 * error)


@pytest.mark.parametrize("change", [{}, {"spring": 20.0}, {"x_F": 0.3, "wall_moves": True, "f": 2.2}])
def test_exact_records_give_the_truth_back(change):
    """Samples of the marched motion; the noise level is that of rounding."""
    rig = RIG._replace(**change)
    contact = "joined-base-wall" if rig.wall_moves else "fixed-wall"
    ds = fm.identify.record(
        *sampled(rig), contact=contact, damping_reference="base", free=OF_RECORD, stiffness=1000.0
    )
    exact = [rig.f_n, rig.zeta, rig.x_F, rig.spring, rig.offset]
    np.testing.assert_allclose(estimates(ds, OF_RECORD), exact, rtol=1e-5, atol=1e-6)
    assert float(ds.slips_per_cycle) == steady(rig).stops
    assert float(ds.spring_stiffness) == pytest.approx(1000.0 * rig.spring, rel=1e-5)


def test_records_with_errors():
    exact = np.array([RIG.f_n, RIG.zeta, RIG.x_F, RIG.spring, RIG.offset])
    for seed in range(3):
        ds = fm.identify.record(*sampled(RIG, seed), damping_reference="base", free=OF_RECORD)
        found = ds.sel(parameter=OF_RECORD)
        assert (np.abs(found.estimate.values - exact) < 4.0 * found.standard_error.values).all()
        assert ds.verdict.flag_meanings.split()[int(ds.verdict)] == "spring_found"
        assert float(ds.residual_rms) == pytest.approx(0.01, rel=0.08)


def test_a_known_spring_of_a_record():
    known = {"contact_stiffness": RIG.spring, "f_n": RIG.f_n, "mu": 1.0}
    ds = fm.identify.record(*sampled(RIG, 1), damping_reference="base", known=known)
    assert ds.known.sel(parameter=OF_RECORD).values.tolist() == [1, 0, 0, 1, 0]
    friction = of(ds, "x_F")
    assert abs(float(friction.estimate) - RIG.x_F) < 4.0 * float(friction.standard_error)
    rigid = fm.identify.record(
        *sampled(RIG, 1), damping_reference="base", known={"f_n": RIG.f_n, "mu": 1.0},
        free=["zeta", "x_F", "offset_x"],
    )  # fmt: skip
    assert float(rigid.model_error) > 3.0 > float(ds.model_error)  # the spring is missed


@pytest.mark.slow
def test_a_record_of_a_rigid_contact():
    """The estimate is a rigid contact or a spring that the data do not tell from one."""
    ds = fm.identify.record(*sampled(RIG._replace(spring=0.0), 1), damping_reference="base", free=OF_RECORD)
    spring = of(ds, "contact_stiffness")
    assert 20.0 < float(spring.lower) <= float(spring.estimate) <= 1e4 < float(spring.upper) == np.inf
    assert np.isnan(spring.standard_error)
    assert "the data do not determine contact_stiffness: any value from" in ds.warnings
    assert ds.verdict.flag_meanings.split()[int(ds.verdict)] == "spring_not_determined"
    exact = [RIG.f_n, RIG.zeta, RIG.x_F]
    found = ds.sel(parameter=["f_n", "zeta", "x_F"])
    assert (found.lower.values <= exact).all()
    assert (exact <= found.upper.values).all()


def test_a_record_without_slip():
    rig = RIG._replace(x_F=8.0)
    assert steady(rig).stops == 0
    with pytest.raises(fm.InputError, match=r"cannot identify x_F and offset_x: the contact of the fitted"):
        fm.identify.record(*sampled(rig, 1), damping_reference="base", free=OF_RECORD)


def test_curves_have_the_place_at_which_a_contact_comes_to_rest():
    """It slips after the start alone: the amplitude in curves is that of maps and of the motion in time."""
    system = fm.System(damping_ratios=0.02, contact_stiffness=3.0)
    beta = 1.02 * float(fm.boundaries(system, [0.8]).beta_noslip[0])
    motion = fm.response(system, r=0.8, beta=beta)
    assert abs(float(motion.midpoint[0])) > 0.01 * float(motion.peak_to_peak[0])
    curves = fm.curves(system, r=[0.8], beta=[beta])
    whole = fm.sweep(system, [0.8], [beta], solver=fm.Solver(outputs=("amplitude", "contact_amplitude")))
    for found in (curves, whole):
        assert float(found.amplitude.item()) == pytest.approx(float(motion.amplitude[0]), rel=1e-10)
        assert float(found.contact_amplitude.item()) == pytest.approx(
            float(motion.contact_amplitude), rel=1e-10
        )
