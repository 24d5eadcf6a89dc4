"""Pulses, sweeps and scales of records, against the formulas."""

import math

import numpy as np
import pytest

import frictionmap as fm
from frictionmap import InputError
from frictionmap.motions.record import Record
from frictionmap.motions.scaling import friction_ratio, friction_ratios, motion_scales, scale_of

#: What the guide says of pulses and sweeps, and rounding.
ERROR = 1e-9


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
    assert 0.3 * ERROR < error < ERROR  # dense enough, and no denser


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
    assert np.abs(values - 2.0 * np.sin(phase)).max() < 2.0 * ERROR


@pytest.mark.parametrize(("start", "stop"), [(0.5, 20.0), (20.0, 0.5), (5.0, 5.0)])
def test_logarithmic_sweep_in_hertz(start, stop):
    record = Record.sweep(f"{start} Hz", stop, "3 s", law="log", amplitude="0.4 g", unit="m/s^2")
    times, values = between(record, 5)
    growth = math.log(stop / start) / 3.0
    cycles = start * (np.expm1(growth * times) / growth if growth else times)
    assert np.abs(values - 0.4 * 9.80665 * np.sin(2 * math.pi * cycles)).max() < 0.4 * 9.80665 * ERROR


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
        (lambda: Record.sweep(1, 2, 1e9), "duration must need at most 1e.07 samples"),
        (lambda: Record.sweep(1, 2, 1, quantity="displacement"), "cannot use a sweep of displacement"),
        (lambda: Record([0, 0], 0.1).scaled_to(1), "all its samples are 0"),
        (lambda: Record([0, 1], 0.1).scaled_to(0), "peak must be > 0"),
        (lambda: Record([0, 1], 0.1, slopes=[0, 1]), "cannot use slopes with acceleration and .linear."),
        (lambda: Record([0, 1], 0.1, interpolation="cubic", slopes=[0, 1, 2]), "slopes must have as many"),
    ],
)
def test_refused_formulas(make, message):
    with pytest.raises(InputError, match=message):
        make()
