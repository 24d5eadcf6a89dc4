"""Pulses, sweeps and scales of records, against the formulas, and motions under sweeps by quadrature."""

import math

import mpmath
import numpy as np
import pytest

import frictionmap as fm
from frictionmap import InputError
from frictionmap.motions.record import Record
from frictionmap.motions.scaling import friction_ratio, friction_ratios, motion_scales, scale_of

#: Rounding of a sum of terms ...
ERROR = 4e-15

#: ... and of the phase in double precision, as these tests compute it, over the phase.
PHASE = 4e-16


def between(record, count):
    """Times between the samples, and the values of the record there by its polynomials."""
    pieces = record.pieces
    x = np.linspace(0.0, 1.0, count)
    times = pieces.times[:-1, np.newaxis] + x * pieces.steps[:, np.newaxis]
    return times, pieces.terms @ x ** np.arange(pieces.terms.shape[1])[:, np.newaxis]


def test_half_sine():
    record = Record.pulse("half-sine", 3.0, 0.7)
    times, values = between(record, 9)
    error = np.abs(values - 3.0 * np.sin(math.pi * times / 0.7)).max() / 3.0
    assert error < ERROR


def test_ricker():
    record = Record.pulse("ricker", -2.0, 5.0)
    times, values = between(record, 9)
    f = 13.0 / (math.pi * 5.0)
    a = math.pi * f * (times - 2.5)
    assert np.abs(values + 2.0 * (1 - 2 * a * a) * np.exp(-a * a)).max() < 2.0 * ERROR
    assert np.abs(record.values[[0, -1]]).max() < 2e-16
    assert record.values.sum() * record.duration / record.values.size < 1e-12  # no net impulse


@pytest.mark.parametrize(("start", "stop"), [(0.6, 1.4), (1.4, 0.6), (1.0, 1.0)])
def test_linear_sweep(start, stop):
    record = Record.sweep(start, stop, 90.0, amplitude=2.0)
    times, values = between(record, 5)
    phase = start * times + 0.5 * (stop - start) / 90.0 * times**2
    assert np.abs(values - 2.0 * np.sin(phase)).max() < 2.0 * PHASE * phase.max()


@pytest.mark.parametrize(("rise", "fall"), [(7.0, 0.0), (0.0, 11.0), (7.0, 11.0), (20.0, 20.0)])
def test_the_amplitude_rises_and_falls(rise, fall):
    record = Record.sweep(0.5, 2.0, 40.0, rise=rise, fall=fall)
    times, values = between(record, 5)
    share = np.minimum(times / rise if rise else 1.0, (40.0 - times) / fall if fall else 1.0).clip(0.0, 1.0)
    phase = (0.5 + 0.5 * 1.5 / 40.0 * times) * times
    error = np.abs(values - share**2 * (3.0 - 2.0 * share) * np.sin(phase)).max()
    assert error < 2 * PHASE * phase.max()
    assert record.duration == pytest.approx(40.0, rel=1e-15)


def test_a_scaled_sweep_reaches_its_peak_between_samples():
    record = Record.sweep(1.0, 1.0, 2.0).scaled_to(3.0)
    assert (record.values * record.scale).max() < 3.0
    assert between(record, 2001)[1].max() == pytest.approx(3.0, rel=1e-6)


#: Systems of one mass without friction, and x'' + damping x' + x = load.
ZETA = 0.03
SWEEPS = {
    "linear": {"start": 0.6, "stop": 1.4},
    "down": {"start": 1.4, "stop": 0.6},
    "log": {"start": 0.2, "stop": 5.0, "law": "log"},
    "ramps": {"start": 0.6, "stop": 1.4, "rise": 9.0, "fall": 13.0},
    "sine": {"start": 0.9, "stop": 0.9},
}
LENGTH = 40.0


def wave_of(sweep):
    """The sweep as a function for mpmath."""
    growth = mpmath.mpf(sweep["stop"]) / sweep["start"]
    rise, fall = sweep.get("rise", 0.0), sweep.get("fall", 0.0)

    def amplitude(t):
        shares = [mpmath.mpf(1)] + ([t / rise] if rise else []) + ([(LENGTH - t) / fall] if fall else [])
        s = min(shares)
        return s * s * (3 - 2 * s)

    def wave(t):
        if sweep.get("law") == "log":
            rate = mpmath.log(growth) / LENGTH
            phase = sweep["start"] / rate * mpmath.expm1(rate * t)
        else:
            phase = (sweep["start"] + mpmath.mpf(sweep["stop"] - sweep["start"]) / (2 * LENGTH) * t) * t
        return amplitude(t) * mpmath.sin(phase)

    return wave


@pytest.mark.parametrize("name", SWEEPS)
@pytest.mark.parametrize("quantity", ["force", "acceleration", "velocity", "displacement"])
def test_a_linear_oscillator_by_quadrature(name, quantity):
    """x at the end is an integral of the sweep times the impulse response, or that by parts."""
    sweep = SWEEPS[name]
    if quantity == "displacement" and name != "ramps":
        pytest.skip("a displacement has ramps at both ends")
    base = {} if quantity == "force" else {"excitation": "base", "damping_reference": "base"}
    kind = "fixed-wall" if quantity == "force" else "joined-base-wall"
    system = fm.System(damping_ratios=ZETA, contacts=[fm.Contact(kind)], **base)
    record = Record.sweep(duration=LENGTH, quantity=quantity, **sweep)
    ds = fm.history(system, record, beta=0.0, after=0.0)
    with mpmath.workdps(25):
        zeta, wave = mpmath.mpf(ZETA), wave_of(sweep)
        s = mpmath.sqrt(1 - zeta**2)
        impulses = [lambda t: mpmath.exp(-zeta * t) * mpmath.sin(s * t) / s]
        for _ in range(2):
            impulses.append(lambda t, one=impulses[-1]: mpmath.diff(one, t))
        order = {"velocity": 1, "displacement": 2}.get(quantity, 0)
        # by parts: of a velocity v(0) = 0 and h(0) = 0; of a displacement u = u' = 0 at both ends
        corners = sorted({0, sweep.get("rise", 0), LENGTH - sweep.get("fall", 0), LENGTH, *range(2, 40, 2)})
        x = mpmath.quad(lambda t: wave(t) * impulses[order](LENGTH - t), corners)
        sign = 1 if quantity == "force" else -1
        expected = float(sign * x)
    largest = float(abs(ds.x).max())
    assert ds.x.values.ravel()[-1] == pytest.approx(expected, abs=2e-14 * largest)


@pytest.mark.parametrize(("rate", "up", "down"), [(1e-3, 0.809, 0.822), (3e-4, 0.936, 0.944)])
def test_sweeps_through_resonance(rate, up, down):
    """Peaks over that of the steady motion, 15.45004, with zeta = 0.02 and beta = 0.3 from r = 0.6 to 1.4."""
    system = fm.System(damping_ratios=0.02)
    for ends, expected in (((0.6, 1.4), up), ((1.4, 0.6), down)):
        record = Record.sweep(*ends, 0.8 / rate, quantity="force")
        ds = fm.history(system, record, beta=0.3, samples="none", after=0.0)
        assert ds.amplitude.item() / 15.45004 == pytest.approx(expected, abs=1e-3)


@pytest.mark.parametrize(("r", "beta"), [(0.8, 0.35), (1.3, 0.2)])
def test_a_long_sine_is_the_steady_state_without_an_error_of_samples(r, beta):
    system = fm.System(damping_ratios=0.1)
    steady = fm.response(system, r, beta)
    cycles = 60
    sine = Record.sweep(r, r, cycles * 2.0 * math.pi / r, quantity="force")
    ds = fm.history(system, sine, beta=beta, after=0)
    last = ds.sel(time=slice((cycles - 1) * 2.0 * math.pi / r, None))
    # extremes are where the mass stops, at events, which have samples
    assert float(abs(last.x).max()) == pytest.approx(steady.amplitude.item(), rel=1e-12)


def test_a_spectrum_under_a_sweep_is_that_of_histories():
    record = Record.sweep(0.3, 2.0, 90.0, rise=10.0)
    ds = fm.spectrum([record], period=[3.0, 2 * math.pi, 15.0], friction=[0.05, 0.3], damping=0.05)
    base = {"excitation": "base", "damping_reference": "base"}
    for k, period in enumerate(ds.period.values):
        w = 2 * math.pi / period
        slow = Record.sweep(0.3 / w, 2.0 / w, 90.0 * w, rise=10.0 * w, amplitude=w**-2)
        system = fm.System(damping_ratios=0.05, contacts=[fm.Contact("joined-base-wall")], **base)
        one = fm.history(system, slow, beta=ds.beta.values / w**2, samples="none")
        np.testing.assert_allclose(ds.amplitude.values[0, 0, 0, k], one.amplitude.values.ravel(), rtol=1e-11)
        np.testing.assert_array_equal(ds.stops.values[0, 0, 0, k], one.stops.values.ravel())


def test_elastic_spectra_take_sweeps_in_their_time():
    record = Record.sweep(0.3, 2.0, 90.0)
    ds = fm.spectrum([record], period=[3.0], friction=[0.3], damping=0.05, contact_stiffness=5.0)
    w = 2 * math.pi / 3.0
    slow = Record.sweep(0.3 / w, 2.0 / w, 90.0 * w, amplitude=w**-2)
    contact = fm.Contact("joined-base-wall", stiffness=5.0)
    system = fm.System(
        damping_ratios=0.05, contacts=[contact], excitation="base", damping_reference="base"
    )  # fmt: skip
    one = fm.history(system, slow, beta=0.3 / w**2, samples="none")
    assert ds.amplitude.item() == pytest.approx(one.amplitude.item(), rel=1e-11)


@pytest.mark.parametrize(("start", "stop"), [(0.5, 20.0), (20.0, 0.5), (5.0, 5.0)])
def test_logarithmic_sweep_in_hertz(start, stop):
    record = Record.sweep(f"{start} Hz", stop, "3 s", law="log", amplitude="0.4 g", unit="m/s^2")
    times, values = between(record, 5)
    growth = math.log(stop / start) / 3.0
    cycles = start * (np.expm1(growth * times) / growth if growth else times)
    phase = 2 * math.pi * cycles
    error = np.abs(values / (0.4 * 9.80665) - np.sin(phase)).max()
    assert error < 2 * PHASE * phase.max()


def test_rectangle_and_triangle_are_exact():
    times, values = between(Record.pulse("rectangle", 2.0, 3.0), 4)
    np.testing.assert_array_equal(values, [[2.0] * 4, [0.0] * 4])
    np.testing.assert_array_equal(times[0], [0, 1, 2, 3])
    for rise, corners in ((0.25, [[0, 0], [1, 2], [4, 0]]), (0.0, [[0, 2], [4, 0]]), (1.0, [[0, 0], [4, 2]])):
        record = Record.pulse("triangle", 2.0, 4.0, rise=rise)
        np.testing.assert_array_equal(np.transpose([record.times, record.values]), corners)


def test_scaled_to_a_peak():
    record = Record([0.0, -0.2, 0.1], 0.01, unit="g")
    for peak in (0.5, "4.903325 m/s^2"):
        scaled = record.scaled_to(peak)
        assert np.abs(scaled.values * scaled.scale).max() == pytest.approx(0.5, rel=1e-15)
        assert scaled.unit == "g"
    turned = Record([0.0, -0.2, 0.1], 0.01, scale=-3.0).scaled_to(0.5)
    assert (turned.values * turned.scale).max() == pytest.approx(0.5, rel=1e-15)


@pytest.mark.parametrize(
    ("quantity", "unit", "si", "power"),
    [("acceleration", "g", 9.80665, 2), ("velocity", "cm/s", 0.01, 1), ("displacement", "mm", 1e-3, 0)],
)
def test_a_base_needs_the_frequency_alone(quantity, unit, si, power):
    """The motion under the record in its units is that of x'' + omega^2 x = -u'' in SI units, for any P."""
    record = Record([0.0, 1.0, 0.0], 0.01, quantity=quantity, unit=unit)
    w = 2 * math.pi * 2.5
    system = fm.System()
    free = motion_scales(fm.Units(natural_frequency="2.5 Hz"), system)
    loaded = motion_scales(fm.Units(natural_frequency="2.5 Hz", load="20 N", stiffness="3 N/mm"), system)
    for scales, length in ((free, 1 / w**2), (loaded, 20 / 3000)):
        scale = scale_of(record, scales)
        assert scale.time == pytest.approx(w, rel=1e-15)
        assert scale.value == pytest.approx(si / (length * w**power), rel=1e-15)
    # friction of 0.05 g is the same share of a base acceleration of 1 g, whatever P is
    one = scale_of(Record([0.0, 1.0], 0.01, unit="g"), free).value
    assert friction_ratio("0.05 g", "friction", free) / one == pytest.approx(0.05, rel=1e-15)
    assert friction_ratio("0.05 g", "friction", loaded) == pytest.approx(
        0.05 * 9.80665 / (20 / 3000 * w**2), rel=1e-15
    )
    assert friction_ratio("5 N", "friction", loaded) == 0.25


def test_forces_where_the_mass_is_given():
    """With P/m1 = 1 m/s^2 a mass of 40 kg makes P = 40 N."""
    scales = motion_scales(fm.Units(natural_frequency="2.5 Hz", mass="40 kg"), fm.System())
    assert scale_of(Record([0, 1], 0.1, quantity="force", unit="kN"), scales).value == pytest.approx(25.0)
    np.testing.assert_allclose(friction_ratios(["10 N", "0.25 m/s^2", 0.25], "friction", scales), 0.25)


def test_without_a_unit_nothing_is_scaled():
    assert scale_of(Record([0, 1], 0.1), motion_scales(None, fm.System())) == (1.0, 1.0)


FREQUENCY = fm.Units(natural_frequency="2.5 Hz")
LOAD = fm.Units(natural_frequency="2.5 Hz", load="20 N")


@pytest.mark.parametrize(
    ("units", "record", "message"),
    [
        (None, Record([0, 1], 0.1, unit="g"), "cannot convert seconds to.*give units.natural_freq"),
        (FREQUENCY, Record([0, 1], 0.1, quantity="force", unit="N"), "give units.stiffness"),
        (LOAD, Record([0, 1], 0.1, unit="g"), "units.load alone does not state it; give units.stiffness"),
    ],
)
def test_missing_reference_values(units, record, message):
    with pytest.raises(InputError, match=message):
        scale_of(record, motion_scales(units, fm.System()))


@pytest.mark.parametrize(
    ("value", "units", "message"),
    [
        ("5 N", FREQUENCY, "cannot convert friction = '5 N' to ratios.*give units.stiffness"),
        (
            "5 mm",
            FREQUENCY,
            "friction must be a number, or one with a unit of force or.*mm is a unit of length",
        ),
        ("-1 g", FREQUENCY, "friction must be >= 0; got '-1 g'"),
        (-1.0, FREQUENCY, "friction must be >= 0"),
        ("1 g", None, "cannot convert friction = 1 g to ratios.*give units.natural_frequency"),
    ],
)
def test_refused_friction(value, units, message):
    with pytest.raises(InputError, match=message):
        friction_ratio(value, "friction", motion_scales(units, fm.System()))


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Record.pulse("box", 1, 1), "kind must be one of rectangle, triangle, half-sine, ricker"),
        (lambda: Record.pulse("ricker", 1, 0), "duration must be > 0"),
        (lambda: Record.pulse("ricker", 1, "2 s"), "duration must be a number in a record without a unit"),
        (lambda: Record.pulse("triangle", 1, 1, rise=2), "rise must be <= 1"),
        (lambda: Record.pulse("ricker", 1, 1, quantity="displacement"), "cannot use a ricker pulse of displ"),
        (lambda: Record.pulse("rectangle", 1, 1, quantity="velocity"), "cannot use a rectangle pulse of vel"),
        (lambda: Record.pulse("triangle", 1, 1, rise=0, quantity="velocity"), "rise must be > 0 and < 1"),
        (lambda: Record.pulse("ricker", "1 mm", 1, unit="g"), "amplitude must be .*mm is a unit of length"),
        (lambda: Record.pulse("ricker", 1, 1, unit="mm"), "unit must be one of m/s"),
        (lambda: Record.sweep(0, 1, 1), "start must be > 0"),
        (lambda: Record.sweep(1, "2 mm", 1, unit="g"), "stop must be .*mm is a unit of length"),
        (lambda: Record.sweep(1, 2, 1, law="cubic"), "law must be one of linear, log"),
        (lambda: Record.sweep(1, 2, 1e9), "duration must need at most 2e.06 samples"),
        (lambda: Record.sweep(1, 2, 1, quantity="displacement"), "rise must be > 0 for a displacement"),
        (lambda: Record.sweep(1, 2, 9, quantity="displacement", rise=1), "fall must be > 0 for a displac"),
        (lambda: Record.sweep(1, 2, 9, rise=5, fall=6), "fall must be <= duration - rise, 4; got 6"),
        (lambda: Record.sweep(1, 2, 9, rise=10), "rise must be <= duration, 9; got 10"),
        (lambda: Record.sweep(1, 2, 9, fall=-1), "fall must be >= 0"),
        (lambda: Record([0, 0], 0.1).scaled_to(1), "all its samples are 0"),
        (lambda: Record([0, 1], 0.1).scaled_to(0), "peak must be > 0"),
    ],
)
def test_refused_formulas(make, message):
    with pytest.raises(InputError, match=message):
        make()
