"""Free decays seen by accelerometers, vibrometers and angle sensors: against motions and filters integrated.

The reference integrates the equation of motion and those of the filters together; it shares no code with the
closed forms.
"""

import json
import tomllib

import numpy as np
import pytest
from decays import Truth, marched_signal, synthetic

import frictionmap as fm
from frictionmap.identify.decay.measured import measured_and_slopes
from frictionmap.identify.decay.motion import Decay
from frictionmap.identify.decay.sensor import Filter, sensor_of
from frictionmap.identify.rigs.configuration import identify, load_rig

TRUTH = Truth(3.1, 0.012, 0.25, 9.0, -0.03, 0.0, 300.0, 3.2, 0.0)
ROUTES = [(low_pass, coupling) for low_pass in (None, (1, 25.0), (2, 40.0)) for coupling in (None, 0.4)]

#: Noise, in the unit of the signal, a few percent of what a turning point changes.
NOISE = {"mm": 0.02, "deg": 0.02, "mm/s": 0.8, "m/s^2": 0.03, "g": 0.003}
ORDERS = {"mm": 0, "deg": 0, "mm/s": 1, "m/s^2": 2, "g": 2}
SCALES = {"mm": 1.0, "deg": 1.0, "mm/s": 1.0, "m/s^2": 1e-3, "g": 1e-3 / 9.80665}


def record(unit, low_pass=None, coupling=None, offset=0.0, seed=1, truth=TRUTH):
    """A noisy record of a sensor that was released with the mass."""
    time = np.arange(int(truth.rate * truth.length)) / truth.rate
    clean = SCALES[unit] * marched_signal(truth, ORDERS[unit], time, low_pass, coupling)
    return time, clean + offset + np.random.default_rng(seed).normal(0.0, NOISE[unit], time.size)


def keys(low_pass, coupling):
    """The arguments that describe filters."""
    result = {}
    if low_pass:
        result["filter"] = {"kind": "low-pass", "order": low_pass[0], "frequency_Hz": low_pass[1]}
    if coupling:
        result["ac_coupling_Hz"] = coupling
    return result


def off(ds, name, value):
    """Standard errors between an estimate and a value."""
    one = ds.sel(parameter=name)
    return float((one.estimate - value) / one.standard_error)


def near(ds, truth=TRUTH, names=("f_n", "zeta", "x_F", "X0", "t0")):
    return all(abs(off(ds, name, getattr(truth, name))) < 4.0 for name in names)


@pytest.mark.parametrize("order", [0, 1, 2])
@pytest.mark.parametrize(("low_pass", "coupling"), ROUTES)
def test_what_a_sensor_shows_is_what_integration_gives(order, low_pass, coupling):
    """Released within the record, so that the filters' states are known; jumps are between the samples."""
    truth = TRUTH._replace(t0=0.0711, x_F=0.8)
    time = np.arange(640) / 250.0
    sensor = sensor_of(order, 1.0, Filter(*low_pass) if low_pass else None, coupling)
    decay = Decay(*truth[:5], 0.0)
    found = measured_and_slopes(sensor, decay, 5, time)[0]
    expected = marched_signal(truth, order, time, low_pass, coupling)
    assert np.ptp(expected[-20:]) < 1e-3 * np.ptp(expected) or coupling  # it has come to rest
    np.testing.assert_allclose(found, expected, atol=1e-7 * np.abs(expected).max())


@pytest.mark.parametrize("order", [0, 1, 2])
@pytest.mark.parametrize(("low_pass", "coupling"), ROUTES)
@pytest.mark.parametrize("zeta", [0.0, 0.03])
def test_slopes_are_differences(order, low_pass, coupling, zeta):
    sensor = sensor_of(order, 0.7, Filter(*low_pass) if low_pass else None, coupling)
    decay = Decay(3.1, zeta, 0.8, -9.0, 0.0711, 0.4)
    time = np.arange(160) / 62.5
    slopes = measured_and_slopes(sensor, decay, 5, time)[1]
    for index, value in enumerate(decay):
        step = 1e-6 * max(1.0, abs(value))
        ends = [
            measured_and_slopes(sensor, decay._replace(**{decay._fields[index]: value + one}), 5, time)[0]
            for one in (step, -step)
        ]
        expected = (ends[0] - ends[1]) / (2.0 * step)
        # 1e-10 of rounding over the step, and its square
        np.testing.assert_allclose(slopes[:, index], expected, atol=1e-6 * np.abs(slopes[:, index]).max())


@pytest.mark.parametrize("unit", ["mm/s", "m/s^2", "g"])
@pytest.mark.parametrize(("low_pass", "coupling"), [(None, None), ((1, 25.0), None), ((2, 25.0), 0.4)])
def test_friction_of_a_velocity_or_an_acceleration(unit, low_pass, coupling):
    offset = 0.0 if coupling else 5.0 * NOISE[unit]
    time, x = record(unit, low_pass, coupling, offset)
    ds = fm.identify.free_decay(time, x, unit=unit, **keys(low_pass, coupling))
    assert near(ds)
    assert abs(off(ds, "offset", offset)) < 4.0
    assert ds.unit.values.tolist() == ["Hz", "1", "mm", "mm", "s", unit]
    # no error is inflated: they are those of white noise
    assert float(ds.error_inflation) == 1.0
    assert np.sqrt(float(ds.reduced_chi_square)) == pytest.approx(NOISE[unit], rel=0.1)
    over_mass = TRUTH.x_F * 1e-3 * (2.0 * np.pi * TRUTH.f_n) ** 2
    error = float(ds.friction_over_mass_standard_error)
    assert abs(float(ds.friction_over_mass) - over_mass) < 4.0 * error
    assert "rest" not in ds
    assert "shows neither the centre nor the final position" in ds.warnings


@pytest.mark.parametrize("unit", ["mm", "m/s^2"])
def test_a_filter_that_is_not_named_changes_the_friction(unit):
    """The keys do something: a low-pass at 8 f_n takes percents of x_F."""
    quiet = np.random.default_rng(5).normal(0.0, 0.05 * NOISE[unit], int(TRUTH.rate * TRUTH.length))
    time = np.arange(quiet.size) / TRUTH.rate
    x = quiet + SCALES[unit] * marched_signal(TRUTH, ORDERS[unit], time, (2, 25.0), 0.4)
    named = fm.identify.free_decay(time, x, unit=unit, **keys((2, 25.0), 0.4))
    assert near(named, names=("f_n", "zeta", "x_F"))
    assert float(named.standard_error.sel(parameter="x_F")) < 0.002 * TRUTH.x_F
    ignored = fm.identify.free_decay(time, x, unit=unit, known={"f_n": TRUTH.f_n})
    assert abs(float(ignored.estimate.sel(parameter="x_F")) / TRUTH.x_F - 1.0) > 0.005


def test_the_state_of_an_ac_coupling_is_unknown():
    """It had a steady signal of a second long before, of which the record shows the decay."""
    time, x = record("m/s^2", None, 0.4)
    left = 2.0 * np.exp(-2.0 * np.pi * 0.4 * time)
    ds = fm.identify.free_decay(time, x + left, unit="m/s^2", ac_coupling_Hz=0.4)
    assert near(ds)


def test_angles():
    time, x = record("deg", offset=1.7)
    ds = fm.identify.free_decay(time, x, unit="deg")
    assert near(ds)
    assert abs(off(ds, "offset", 1.7)) < 4.0
    assert ds.unit.values.tolist() == ["Hz", "1", "deg", "deg", "s", "deg"]
    assert ds["rest"].attrs["units"] == "deg"
    radians = fm.identify.free_decay(time, np.radians(x), unit="rad")
    np.testing.assert_allclose(
        np.degrees(radians.estimate.sel(parameter=["x_F", "X0"])),
        ds.estimate.sel(parameter=["x_F", "X0"]),
        rtol=1e-6,
    )


def test_samples_next_to_jumps_are_left_out():
    """One on each side of the jumps; with mask_s so many as fit into it; none of a filtered signal."""
    time, x = record("m/s^2")
    ds = fm.identify.free_decay(time, x, unit="m/s^2")
    halves = int(ds.half_cycles)
    assert time.size - ds.sizes["sample"] == 2 * halves == int(ds.samples_left_out)
    jumps = TRUTH.t0 + np.arange(1, halves + 1) * 0.5 / (TRUTH.f_n * np.sqrt(1.0 - TRUTH.zeta**2))
    nearest = np.abs(np.subtract.outer(ds.time.values, jumps)).min(axis=1)
    assert nearest.min() > 0.9 / TRUTH.rate
    masked = fm.identify.free_decay(time, x, unit="m/s^2", mask_s=[0.02, 0.01])
    assert int(masked.samples_left_out) == pytest.approx(0.03 * TRUTH.rate * halves, abs=halves)
    time, x = record("m/s^2", (1, 25.0))
    assert "samples_left_out" not in fm.identify.free_decay(time, x, unit="m/s^2", **keys((1, 25.0), None))


def test_a_filter_of_linear_phase_is_masked():
    """An average over 20 ms, with the gain 1 at f_n, smears the jumps and nothing else."""
    time = np.arange(960) / 300.0
    fine = np.arange(-400, 24400) / 7500.0
    clean = 1e-3 * marched_signal(TRUTH, 2, fine)
    weights = np.hanning(151)
    weights /= np.sum(weights * np.cos(2.0 * np.pi * TRUTH.f_n * (np.arange(151) - 75) / 7500.0))
    x = np.convolve(clean, weights, "same")[400 : 400 + 25 * 960 : 25]
    x += np.random.default_rng(3).normal(0.0, 0.01, time.size)
    ds = fm.identify.free_decay(time, x, unit="m/s^2", mask_s=(0.01, 0.01))
    assert near(ds, names=("f_n", "zeta", "x_F"))
    assert np.sqrt(float(ds.reduced_chi_square)) == pytest.approx(0.01, rel=0.1)
    smeared = fm.identify.free_decay(time, x, unit="m/s^2")
    # nearly the same noise, and with it what is left of the jumps beyond one sample
    assert float(smeared.reduced_chi_square) > 1.05 * float(ds.reduced_chi_square)


def test_release_within_the_record_of_an_accelerometer():
    truth = TRUTH._replace(t0=0.2011)
    time, x = record("m/s^2", truth=truth)
    assert near(fm.identify.free_decay(time, x, unit="m/s^2"), truth)


def test_a_displacement_through_a_low_pass():
    """It still shows the centre; an AC coupling hides it."""
    time, x = record("mm", (1, 25.0), offset=1.3)
    ds = fm.identify.free_decay(time, x, unit="mm", **keys((1, 25.0), None))
    assert near(ds)
    assert abs(off(ds, "centre", 1.3)) < 4.0
    time, x = record("mm", None, 0.4)
    coupled = fm.identify.free_decay(time, x, unit="mm", ac_coupling_Hz=0.4)
    assert near(coupled)
    assert "offset" in coupled.parameter
    assert "rest" not in coupled


def test_the_likelihood_of_a_filtered_signal_is_largest_at_the_estimate():
    """It falls like the parabola of the inverse covariance."""
    time, x = record("m/s^2", (2, 25.0), 0.4)
    ds = fm.identify.free_decay(time, x, unit="m/s^2", **keys((2, 25.0), 0.4))
    function = fm.identify.log_likelihood(ds)
    assert function.names == ("f_n", "zeta", "x_F", "X0", "t0", "offset")
    best, scale = ds.estimate.values, ds.standard_error.values
    weights = np.linalg.inv(ds.correlation.values)
    for index in range(best.size):
        step = np.where(np.arange(best.size) == index, 0.3, 0.0)
        fall = 0.5 * 0.09 * weights[index, index]
        assert function(best) - function(best + step * scale) == pytest.approx(fall, rel=0.02)


def test_coverage_of_intervals():
    """Of 30 intervals of a velocity through an AC coupling at least 24 hold the truth: 95 % give fewer in
    one of 10^4 trials."""
    truth = TRUTH._replace(length=2.6, rate=150.0)
    time = np.arange(int(truth.rate * truth.length)) / truth.rate
    clean = marched_signal(truth, 1, time, None, 0.4)
    held = 0
    for seed in range(10):
        x = clean + np.random.default_rng([7, seed]).normal(0.0, 0.8, time.size)
        ds = fm.identify.free_decay(time, x, unit="mm/s", ac_coupling_Hz=0.4)
        for name in ("f_n", "zeta", "x_F"):
            one = ds.sel(parameter=name)
            held += bool(one.lower <= getattr(truth, name) <= one.upper)
    assert held >= 24


def test_a_displacement_without_filters_is_fitted_as_ever():
    """The keys of sensors at None are no keys."""
    time, x = synthetic(TRUTH._replace(noise=0.02, centre=0.3), 4)
    plain = fm.identify.free_decay(time, x)
    ds = fm.identify.free_decay(time, x, filter=None, ac_coupling_Hz=None, mask_s=None)
    np.testing.assert_array_equal(ds.estimate, plain.estimate)
    assert "sensor" not in ds.attrs


def test_an_unknown_argument_is_no_filter():
    time, x = synthetic(TRUTH._replace(noise=0.02), 4)
    with pytest.raises(TypeError, match="unexpected keyword argument 'ac_coupling'"):
        fm.identify.free_decay(time, x, ac_coupling=0.3)


def test_what_a_slow_coupling_hides_is_refused():
    """A coupling of 1e-4 Hz answers within 3.2 s with a + b t and next to nothing else: offset and drift."""
    time, x = record("m/s^2")
    slow = {"unit": "m/s^2", "ac_coupling_Hz": 1e-4}
    with pytest.raises(fm.InputError, match="cannot identify offset and drift: not identifiable beside"):
        fm.identify.free_decay(time, x, drift=True, **slow)
    held = fm.identify.free_decay(time, x, drift=True, known={"drift": 0.0}, **slow)
    plain = fm.identify.free_decay(time, x, unit="m/s^2")
    for name in ("f_n", "x_F"):  # the coupling does not act within the record
        assert abs(off(held, name, float(plain.estimate.sel(parameter=name)))) < 0.1


SETS = ["acc-plain", "acc-lp1", "acc-lp2", "acc-ac", "acc-mask", "vel", "vel-ac", "angle"]


@pytest.mark.parametrize("name", SETS)
def test_reference_sets(reference_path, name):
    """Estimates within four standard errors of the truth, errors as an estimator that shares no code."""
    folder = reference_path("identification-2")
    path = folder / f"decay-{name}.toml"
    truth = json.loads((folder / "truth.json").read_text())[path.stem]
    assert tomllib.loads(path.read_text())["fit"]["free"] == ["f_n", "zeta", "x_F"]
    ds = _identified(path)
    for parameter, expected in truth["parameters"].items():
        if parameter in truth["not_judged"]:
            continue
        assert abs(off(ds, parameter, expected["truth"])) < truth["tolerance_in_standard_errors"]
        ratio = float(ds.standard_error.sel(parameter=parameter)) / expected["standard_error"]
        assert 0.8 < ratio < 1.25


def _identified(path):
    return identify(load_rig(path))


def test_the_reported_decay_of_an_accelerometer(cases):
    """f_n = 5 Hz, zeta = 0.01, x_F = 0.3 mm, X0 = 10 mm, in a column x_g that no key names."""
    ds = _identified(cases / "free-decay-acceleration" / "decay.toml")
    truth = Truth(5.0, 0.01, 0.3, 10.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    for name in ("f_n", "zeta", "x_F", "X0"):
        one = ds.sel(parameter=name)
        assert float(one.lower) <= getattr(truth, name) <= float(one.upper)
