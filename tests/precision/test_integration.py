"""Displacements from velocities and accelerations: harmonics exactly, and the noise that is left."""

import numpy as np
import pytest
from records import Truth, filtered, places, rates, steady

import frictionmap as fm

F = 1.3
PHASORS = np.array([0.0, 1.8, 0.1j, -0.05, 0.02])
TIME = np.arange(0.0, 7.3, 0.01)


def signal(time, order, f=F):
    n = np.arange(PHASORS.size)
    turn = np.exp(2j * np.pi * f * np.multiply.outer(time, n))
    return (turn @ (PHASORS * (2j * np.pi * f * n) ** order)).real


@pytest.mark.parametrize(
    ("unit", "order", "size"),
    [
        ("m", 0, 1e3),
        ("mm/s", 1, 1.0),
        ("m/s", 1, 1e3),
        ("m/s^2", 2, 1e3),
        ("mm/s^2", 2, 1.0),
        ("g", 2, 9806.65),
    ],
)
def test_harmonics_are_integrated_exactly(unit, order, size):
    """No whole cycles, an offset and a drift, and steps that differ."""
    time = TIME + 0.003 * np.random.default_rng(1).uniform(-1.0, 1.0, TIME.size)
    drifting = signal(time, order) / size + (0.3 + 0.1 * time if order else 0.0)
    found = fm.identify.displacements(time, signal(time, 0), drifting, x_unit=unit)
    np.testing.assert_allclose(found.x, signal(time, 0), atol=1e-8)
    np.testing.assert_allclose(found.base, signal(time, 0), rtol=1e-14)
    assert found.noise[0] == 0.0
    assert found.noise[1] < 1e-8


@pytest.mark.parametrize("order", [1, 2])
def test_noise_of_displacements(order):
    """White noise of a rate 1/h from half the frequency on: 2 h s^2 int df/(2 pi f)^2k, k the order."""
    h, sigma, f = 0.005, 3.0, 0.5
    time = np.arange(0.0, 200.0, h)
    noise = np.random.default_rng(2).normal(0.0, sigma, time.size)
    unit = ("mm/s", "mm/s^2")[order - 1]
    found = fm.identify.displacements(time, signal(time, 0, f), signal(time, order, f) + noise, x_unit=unit)
    power = 2.0 * h * sigma**2 / (2.0 * np.pi) ** (2 * order) * (0.5 * f) ** (1 - 2 * order) / (2 * order - 1)
    size = np.std(signal(time, 0, f))
    # about 200 lines between f/2 and f have most of it
    assert found.noise[1] == pytest.approx(np.sqrt(power) / size, rel=0.15)
    assert np.std(found.x - signal(time, 0, f)) == pytest.approx(np.sqrt(power), rel=0.15)


def test_a_motion_that_stops():
    """An acceleration that jumps, behind a filter against aliasing."""
    truth = Truth(3.13, 0.01, 0.8, 1.0, 0.0, 1.001, (0.0, 1.8j, 0.02), rate=100.0, length=7.3)
    motion = steady(truth)
    time = np.arange(int(truth.rate * truth.length) + 1) / truth.rate
    acceleration = filtered(truth, lambda t: rates(truth, motion, t)[1], time)
    x = places(truth, motion, time)
    found = fm.identify.displacements(time, x, acceleration, x_unit="mm/s^2").x
    # harmonics above the 39th, some x_F (f_n/f)^2/n^3 each
    assert np.abs(found - x - (found - x).mean()).max() < 2e-3


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            {"x_unit": "N"},
            "x_unit must be one of mm, m, um, in, cm, ft, m/s, mm/s, cm/s, in/s, m/s\\^2, .*; got 'N'",
        ),
        ({"base_unit": "s"}, "base_unit must be one of mm"),
        ({"unit": "g"}, "unit must be one of mm, m, um, in, cm, ft; got 'g'"),
    ],
)
def test_bad_units(arguments, message):
    with pytest.raises(fm.InputError, match=message):
        fm.identify.displacements(TIME, signal(TIME, 0), signal(TIME, 2), **arguments)


def test_too_few_cycles():
    with pytest.raises(fm.InputError, match="time must span at least 2 cycles"):
        fm.identify.displacements(TIME[:100], signal(TIME, 0)[:100], signal(TIME, 2)[:100], x_unit="g")


def test_clipped_accelerations_are_refused():
    """A clipped displacement is left to `record`."""
    clipped = np.clip(signal(TIME, 2), -80.0, 80.0)
    with pytest.raises(fm.InputError, match=r"cannot integrate x: it is clipped, \d+\.\d% of the samples"):
        fm.identify.displacements(TIME, signal(TIME, 0), clipped, x_unit="mm/s^2")
    found = fm.identify.displacements(
        TIME, np.clip(signal(TIME, 0), -1.5, 1.5), signal(TIME, 2), x_unit="mm/s^2"
    )
    np.testing.assert_array_equal(found.base, np.clip(signal(TIME, 0), -1.5, 1.5))
