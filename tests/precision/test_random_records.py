"""Random records: their statistics and spectra against the densities and their integrals.

Standard errors follow from the records themselves, which are independent of each other; 4.5 of them are
exceeded once in 150,000 times, and seeds are fixed.
"""

import math

import numpy as np
import pytest
from scipy.integrate import quad

from frictionmap import InputError
from frictionmap.motions.generators import kept_share
from frictionmap.motions.origins import end_velocity
from frictionmap.motions.record import Record

SIGMAS = 4.5

KINDS = {
    "white": {},
    "kanai-tajimi": {"frequency": 2.5, "damping": 0.6},
    "clough-penzien": {"frequency": 2.5, "damping": 0.6, "filter_frequency": 0.3, "filter_damping": 0.5},
    "davenport": {"wind_speed": 30.0},
    "table": {"frequency": [0.5, 2.0, 6.0], "density": [0.2, 1.0, 0.0]},
}


def density(kind, f):
    """One-sided, over Hz, as the literature writes them."""
    if kind == "white":
        return 1.0
    if kind == "davenport":
        x = 1200.0 * f / 30.0
        return 4.0 * x**2 / (1.0 + x**2) ** (4.0 / 3.0) / f
    if kind == "table":
        return np.interp(f, [0.5, 2.0, 6.0], [0.2, 1.0, 0.0], left=0.0, right=0.0)
    q, a, p, b = f / 2.5, 0.6, f / 0.3, 0.5
    ground = (1 + 4 * a**2 * q**2) / ((1 - q**2) ** 2 + 4 * a**2 * q**2)
    if kind == "kanai-tajimi":
        return ground
    return ground * p**4 / ((1 - p**2) ** 2 + 4 * b**2 * p**2)


def within(found, expected):
    """Means of independent numbers agree with what is expected, within their standard errors."""
    error = found.std(axis=0, ddof=1) / math.sqrt(len(found))
    assert np.all(np.abs(found.mean(axis=0) - expected) < SIGMAS * error)
    return error


def attenuation(x, interpolation):
    """What interpolation keeps of the amplitude of a harmonic, measured on one through 4000 samples."""
    n, m = 4000, 64
    k = round(x * n)
    record = Record(np.cos(2 * np.pi * k * np.arange(n + 1) / n), 1.0, interpolation=interpolation)
    s = (np.arange(m) + 0.5) / m
    pieces = record.pieces
    values = pieces.terms[:n] @ s ** np.arange(6)[:, np.newaxis]
    t = pieces.times[:n, np.newaxis] + s
    return abs((values * np.exp(-2j * np.pi * k * t / n)).mean() * 2) / np.sinc(x / m)


@pytest.mark.parametrize("kind", KINDS)
def test_variance_is_the_integral_of_the_density(kind):
    """Of samples, each line over its share that linear interpolation keeps."""
    dt, count = 0.02, 400
    records = Record.generate(
        kind, 20.0, dt, seed=11, count=count, level=None if kind == "table" else 3.0, unit="m/s^2",
        **KINDS[kind],
    )  # fmt: skip
    level = 1.0 if kind == "table" else 3.0
    lowest = 0.5 / (2 * 1001 * dt)  # line 0 and the half line beside it are left out
    points = [0.5, 2.0, 6.0] if kind == "table" else [0.1, 0.3, 2.5]
    expected, _ = quad(
        lambda f: level * density(kind, f) / np.sinc(f * dt) ** 4, lowest, 12.5, points=points, limit=400
    )
    values = np.array([record.values for record in records])
    error = within((values**2).mean(axis=1), expected)
    assert error < 0.03 * expected
    assert records[0].quantity == "acceleration"


def test_the_process_is_gaussian():
    """Mean 0, kurtosis 3, also of a narrow band, where random phases alone would give less."""
    made = Record.generate(
        "table",
        50.0,
        0.05,
        seed=5,
        count=4000,
        frequency=[0.99, 1.0, 1.01],
        density=[0.0, 1.0, 0.0],
        unit="g",
    )
    values = np.array([record.values[::10] for record in made])
    variance = (values**2).mean()
    within(values.mean(axis=1), 0.0)
    within((values**4).mean(axis=1) / variance**2, 3.0)
    # one line alone: a Rayleigh amplitude, whose kurtosis is 3; of a random phase it is 1.5
    assert (values**4).mean() / variance**2 > 2.8


@pytest.mark.parametrize("interpolation", ["linear", "cubic", "hold"])
def test_the_spectrum_between_samples(interpolation):
    """Harmonics of the interpolated record have the density, although interpolation lowers them."""
    dt, n, count = 0.05, 512, 1500
    made = Record.generate(
        "white", n * dt, dt, seed=2, count=count, level=2.0, unit="g", interpolation=interpolation
    )
    window = np.hanning(n)
    bins = np.array([26, 51, 77, 102, 120])  # f dt = 0.05 to 0.234
    values = np.array([record.values[:n] for record in made])
    found = np.abs(np.fft.rfft(values * window)[:, bins]) ** 2
    found *= 2 * dt / (window**2).sum()  # one-sided density of the samples
    kept = np.array([attenuation(k / n, interpolation) for k in bins])
    within(found * kept**2, 2.0)


@pytest.mark.parametrize("interpolation", ["linear", "cubic", "hold"])
def test_what_interpolation_keeps(interpolation):
    for x in (0.01, 0.05, 0.1, 0.2, 0.25):
        assert kept_share(np.array(x), interpolation) == pytest.approx(
            attenuation(x, interpolation), rel=1e-4
        )


def test_what_straight_lines_keep():
    for x, share in ((0.05, 0.992), (0.1, 0.968), (0.25, 0.811)):
        assert attenuation(x, "linear") == pytest.approx(share, abs=5e-4)


def test_nothing_above_a_quarter_of_the_rate():
    (record,) = Record.generate("white", 400.0, 0.1, level=1.0, seed=9)
    window = np.blackman(record.values.size)
    power = np.abs(np.fft.rfft(record.values * window)) ** 2
    x = np.fft.rfftfreq(record.values.size)
    assert power[x > 0.255].max() < 1e-6 * power[x < 0.24].mean()


def test_records_of_a_seed_do_not_depend_on_their_number():
    few, many = (Record.generate("white", 10, 0.05, level=1.0, seed=4, count=count) for count in (2, 5))
    for one, other in zip(few, many, strict=False):
        np.testing.assert_array_equal(one.values, other.values)
    all_values = [record.values.tobytes() for record in many]
    assert len(set(all_values)) == 5
    others = Record.generate("white", 10, 0.05, level=1.0, seed=5, count=5)
    assert not set(all_values) & {record.values.tobytes() for record in others}


def test_records_are_independent():
    values = np.array([r.values for r in Record.generate("white", 20, 0.05, level=1.0, seed=1, count=800)])
    within((values[::2] * values[1::2]).mean(axis=1), 0.0)
    # the end of a record does not know its beginning, as it would within one period
    within(values[:, 0] * values[:, -1], 0.0)


def test_rms_and_peak():
    made = Record.generate(
        "kanai-tajimi", 20, 0.02, seed=3, count=400, rms="0.1 g", unit="m/s^2", **KINDS["kanai-tajimi"]
    )
    expected, _ = quad(lambda f: density("kanai-tajimi", f), 0.5 / (2002 * 0.02), 12.5, points=[2.5])
    kept, _ = quad(
        lambda f: density("kanai-tajimi", f) / np.sinc(f * 0.02) ** 4, 0.5 / (2002 * 0.02), 12.5, points=[2.5]
    )
    values = np.array([record.values for record in made])
    within((values**2).mean(axis=1), 0.980665**2 * kept / expected)
    for record in Record.generate("white", 20, 0.02, seed=3, count=4, peak="0.4 g", unit="g"):
        assert np.abs(record.values * record.scale).max() == pytest.approx(0.4, rel=1e-15)


def test_without_a_unit_frequencies_are_over_omega_1():
    """The same record in seconds and in 1/omega_1 = 1/(2 pi) s: f Hz is the ratio f."""
    (one,) = Record.generate("kanai-tajimi", 20.0, 0.02, rms=1.0, unit="g", **KINDS["kanai-tajimi"])
    turn = 2 * math.pi
    (other,) = Record.generate("kanai-tajimi", 20.0 * turn, 0.02 * turn, rms=1.0, **KINDS["kanai-tajimi"])
    np.testing.assert_allclose(one.values, other.values, rtol=0, atol=1e-12)


def test_envelopes():
    (plain,) = Record.generate("white", 50, 0.05, level=1.0)
    t = plain.times
    (trapezoid,) = Record.generate(
        "white", 50, 0.05, level=1.0, envelope={"kind": "trapezoid", "rise": 4.0, "fall": 10.0}
    )
    factor = np.minimum(1.0, np.minimum(t / 4.0, (50.0 - t) / 10.0))
    np.testing.assert_allclose(trapezoid.values, plain.values * factor, rtol=0, atol=1e-13)
    (jennings,) = Record.generate("white", 50, 0.05, level=1.0, envelope="jennings")  # type B is of 50 s
    factor = np.where(t < 4, (t / 4) ** 2, np.where(t < 15, 1.0, np.exp(-0.0992 * (t - 15))))
    np.testing.assert_allclose(jennings.values, plain.values * factor, rtol=0, atol=1e-13)


def test_a_base_without_its_mean_comes_to_rest():
    (plain,), (record,) = (
        Record.generate("white", 50, 0.05, level=1.0, envelope="trapezoid", **more)
        for more in ({}, {"baseline": "mean"})
    )
    np.testing.assert_allclose(record.values, plain.values - plain.values.mean(), rtol=0, atol=1e-14)
    assert record.note == f"the mean, {plain.values.mean():.6g}, is taken off"
    assert abs(end_velocity(record)) < 1e-2 < abs(end_velocity(plain))


SOIL = {"frequency": 2.5, "damping": 0.6}


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"kind": "pink", "level": 1}, "kind must be one of white, kanai-tajimi"),
        ({"kind": "white"}, "level must be given, or rms, or peak"),
        ({"kind": "white", "level": 1, "peak": 1}, "cannot use peak with level"),
        ({"kind": "white", "level": 1, "damping": 0.1}, "unknown key 'damping' of kind white; valid: none"),
        ({"kind": "kanai-tajimi", "level": 1, "frequency": 1}, "damping must be given for kind"),
        ({"kind": "kanai-tajimi", "level": 1, **SOIL, "damping": 0}, "damping must be > 0"),
        ({"kind": "kanai-tajimi", "level": 1, **SOIL, "frequency": "2 Hz"}, "frequency must be a number"),
        ({"kind": "davenport", "level": 1, "wind_speed": 30}, "unit must be given for kind dav"),
        ({"kind": "table", "frequency": [1, 2], "density": [1]}, "density must have as many values"),
        ({"kind": "table", "frequency": [2, 1], "density": [1, 1]}, "frequency must be increasing"),
        ({"kind": "table", "frequency": [1, 2], "density": [1, -1]}, "density must be >= 0"),
        ({"kind": "white", "level": 1, "dt": 0}, "dt must be > 0"),
        ({"kind": "white", "level": 1, "dt": 100}, r"duration must be 1 to 1e\+08 times dt"),
        ({"kind": "white", "level": 1, "seed": -1}, "seed must be >= 0"),
        ({"kind": "white", "level": 1, "seed": 2**64}, "seed must be <"),
        ({"kind": "white", "level": 1, "count": 0}, "count must be >= 1"),
        ({"kind": "white", "level": 1, "envelope": "box"}, "envelope.kind must be one of trapezoid"),
        ({"kind": "white", "level": 1, "envelope": {"kind": "jennings", "fall": 1}}, "key 'envelope.fall'"),
        ({"kind": "white", "level": 1, "envelope": {"kind": "jennings", "rise": 11}}, "envelope must rise"),
        ({"kind": "white", "level": 1, "interpolation": "square"}, "interpolation must be one of"),
    ],
)  # fmt: skip
def test_refused(arguments, message):
    with pytest.raises(InputError, match=message):
        Record.generate(**{"duration": 10.0, "dt": 0.05, **arguments})
