"""Belts of constant speed and shakers of constant acceleration: closed forms in SI units."""

import math

import numpy as np
import pytest

import frictionmap as fm
from frictionmap import InputError, load_config
from frictionmap.regimes import ONE_WAY_SLIDING

#: 3 N/mm, 4 kg, 1 N s/m.
K, M, C = 3000.0, 4.0, 1.0
UNITS = fm.Units(mass="4 kg", stiffness="3 N/mm", load="10 N")
ZETA = C / (2.0 * math.sqrt(K * M))
HERTZ = np.array([1.0, 2.5, 4.0, 6.0, 12.0])
OMEGA = 2.0 * math.pi * HERTZ
TEXTS = [f"{one} Hz" for one in HERTZ]


def test_a_belt_of_constant_speed_slides_one_way_above_the_speed_of_the_mass():
    """A constant friction force moves the centre only: the speed is omega |X| of the linear response."""
    speed = OMEGA * 10.0 / np.abs(K - OMEGA**2 * M + 1j * OMEGA * C)
    for v in (0.02, 0.05, 0.1, 0.2):
        system, units = fm.system_in_units(UNITS, damping_ratios=ZETA, wall_velocity=f"{v} m/s")
        ds = fm.sweep(system, TEXTS, ["4 N"], units=units)
        one_way = ds.regime.values[0, :, 0] == ONE_WAY_SLIDING
        np.testing.assert_array_equal(one_way, v > speed)
    assert speed.min() < 0.05 < speed.max()  # one speed slides one way at some frequencies only


def test_the_least_speed_of_the_belt_is_that_of_the_mass():
    system, units = fm.system_in_units(UNITS, damping_ratios=ZETA, wall_velocity="0.2 m/s")
    ds = fm.boundaries(system, TEXTS, units=units)
    load_speed = OMEGA * 10.0 / K
    speed = OMEGA * 10.0 / np.abs(K - OMEGA**2 * M + 1j * OMEGA * C)
    np.testing.assert_allclose(ds.wall_velocity_lim.values * load_speed, speed, rtol=1e-12)


def acceleration(**keys):
    units = fm.Units(mass="4 kg", stiffness="3 N/mm", base_acceleration="2 m/s^2")
    return fm.system_in_units(units, excitation="base", **keys)


def test_a_mass_on_the_shaken_base_sticks_where_friction_exceeds_its_inertia():
    """At rest on the base: F = m a, the same at all frequencies."""
    system, units = acceleration(contact="joined-base-wall", damping_reference="base", damping_ratios=ZETA)
    ds = fm.boundaries(system, TEXTS, units=units)
    np.testing.assert_allclose(ds.beta_stick_N.values[0], M * 2.0, rtol=1e-12)
    np.testing.assert_allclose(ds.attrs["force_scale_N"], M * 2.0, rtol=1e-15)


def test_a_mass_held_to_the_ground_feels_the_spring_of_the_base():
    """F = k Y = k a/omega^2, without damping relative to the base."""
    system, units = acceleration()
    ds = fm.boundaries(system, TEXTS, units=units)
    np.testing.assert_allclose(ds.beta_stick_N.values[0], K * 2.0 / OMEGA**2, rtol=1e-12)


def test_the_response_without_friction_is_the_linear_one():
    system, units = acceleration(damping_reference="base", damping_ratios=ZETA)
    ds = fm.curves(system, TEXTS, [0.0], units=units, quantities=["first_harmonic", "amplitude"])
    y = 2.0 / OMEGA**2
    expected = np.abs((K + 1j * OMEGA * C) * y / (K - OMEGA**2 * M + 1j * OMEGA * C))
    np.testing.assert_allclose(ds.first_harmonic_amplitude_m.values[0, :, 0, 0], expected, rtol=1e-12)
    np.testing.assert_allclose(ds.amplitude_m.values[0, :, 0, 0], expected, rtol=1e-12)


def test_cells_are_those_of_a_map_at_one_displacement():
    """At one frequency both are one system: F/(k Y) with Y = a/omega^2."""
    r, beta = np.array([0.4, 0.8, 1.7]), np.array([0.1, 0.4, 0.8])
    keys = {"excitation": "base", "damping_ratios": 0.03}
    ds = fm.sweep(fm.System(base_control="acceleration", **keys), r, beta)
    for i, one in enumerate(r):
        row = fm.sweep(fm.System(**keys), [one], beta * one**2)
        np.testing.assert_array_equal(ds.regime.values[:, [i]], row.regime.values)
        np.testing.assert_array_equal(ds.stops_per_cycle.values[:, [i]], row.stops_per_cycle.values)
        np.testing.assert_allclose(
            ds.contact_amplitude.values[:, [i]] * one**2, row.contact_amplitude.values, rtol=1e-10
        )
        np.testing.assert_allclose(ds.beta_stick.values[:, [i]] * one**2, row.beta_stick.values, rtol=1e-12)


@pytest.mark.parametrize(
    "keys", [{"wall_speed": 0.4}, {"excitation": "base", "base_control": "acceleration"}]
)
def test_any_number_of_threads_and_any_cut_give_the_same_bits(keys):
    system = fm.System(damping_ratios=0.02, **keys)
    r, beta = np.linspace(0.3, 1.8, 5), np.array([0.2, 0.7])
    whole = fm.sweep(system, r, beta, threads=3)
    alone = fm.sweep(system, r[2:3], beta, threads=1)
    for name in alone.data_vars:
        if "r" in whole[name].dims:
            np.testing.assert_array_equal(whole[name].isel(r=[2]).values, alone[name].values)


@pytest.mark.parametrize(
    "keys",
    [
        {"wall_speed": 0.4},
        pytest.param({"excitation": "base", "base_control": "acceleration"}, marks=pytest.mark.slow),
    ],
)
def test_every_question_and_motion_is_that_of_the_frequency(keys):
    system = fm.System(damping_ratios=0.05, **keys)
    ds = fm.response(system, 0.7, 0.3)
    cell = fm.sweep(system, [0.7], [0.3])
    assert float(ds.contact_amplitude) == pytest.approx(cell.contact_amplitude.item(), rel=1e-12)
    found = fm.design.least_peak(system, [0.4, 1.6], beta=[0.05, 1.0])
    at = fm.sweep(system, found.peak_r.values[:1], [float(found.beta)], outputs=["amplitude"])
    assert found.peak.values[0] == pytest.approx(at.amplitude.item(), rel=1e-9)


def test_a_configuration_with_a_constant_acceleration(tmp_path):
    path = tmp_path / "shaker.toml"
    path.write_text("""\
[system]
contact = "joined-base-wall"
masses = ["4 kg"]
springs = ["3 N/mm"]
[units]
base_acceleration = "0.3 g"
[grid]
r = ["2 Hz", "5 Hz"]
beta = ["1 N", "3 N"]
""")
    config = load_config(path)
    assert config.system.base_control == "acceleration"
    ds = fm.sweep(config)
    again = tmp_path / "again.toml"
    again.write_text(ds.attrs["config"])
    assert load_config(again).system == config.system


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: fm.sweep(fm.System(wall_speed=0.3), [0.0, 1.0], [0.5]), r"^r must be > 0 for a wall_speed"),
        (lambda: fm.System(wall_speed=0.3, wall_velocity=0.3), "^cannot use wall_speed with wall_velocity"),
        (lambda: fm.System(contact="joined-base-wall", wall_speed=0.3), "^wall_speed must be 0 for joined"),
        (lambda: fm.System(base_control="acceleration"), "^base_control must be displacement without base"),
        (
            lambda: fm.sweep(
                fm.System(excitation="base"), [1.0], [0.5],
                units=fm.Units(natural_frequency="4 Hz", base_acceleration="1 g"),
            ),
            r"^cannot use units\.base_acceleration with base_control = 'displacement'",
        ),
    ],
)  # fmt: skip
def test_refusals(call, message):
    with pytest.raises(InputError, match=message):
        call()
