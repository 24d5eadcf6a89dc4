"""`sweep` over belt speeds without a load: closed forms of constant friction, known cycles, refusals."""

import numpy as np
import pytest

import frictionmap as fm

STRIBECK = {"speed": [0.0, 0.2, 0.6, 1.2], "factor": [1.0, 0.8, 0.7, 0.68], "slope": 0.08}


def one_mass(**contact):
    return fm.System(damping_ratios=0.03, contacts=[fm.Contact(**contact)])


def test_cycles_of_a_falling_law():
    """Periods and extremes by two other programs; steady sliding is unstable up to 0.6."""
    ds = fm.sweep(one_mass(law=STRIBECK), wall_speed=[0.1, 0.3, 0.7, 1.2], beta=[1.0])
    assert ds.sizes == {"mu": 1, "wall_speed": 4, "beta": 1}
    cell = ds.isel(mu=0, beta=0)
    cycle, sliding = 1 << fm.regimes.STICK_SLIP_CYCLE, 1 << fm.regimes.STEADY_SLIDING
    assert cell.regime.values.tolist() == [fm.regimes.STICK_SLIP_CYCLE] * 3 + [fm.regimes.STEADY_SLIDING]
    assert cell.also_reachable.values.tolist() == [cycle, cycle, cycle | sliding, sliding]
    assert (cell.growth > 0.0).values.tolist() == [True, True, False, False]
    periods = [9.597492758505735, 7.198913805721023, 6.4346228336091125]
    assert cell.cycle_period.values[:3] == pytest.approx(periods, rel=1e-12)
    assert cell.x_max.values[1] == pytest.approx(1.2341840785926574, rel=1e-11)
    assert cell.x_min.values[1] == pytest.approx(0.2151323896425577, rel=1e-11)
    assert float(cell.cycle_speed_lim) == pytest.approx(1.124273429839, rel=1e-11)
    assert float(ds.beta_slope_lim) == float(ds.beta_slope_certificate) == pytest.approx(0.06, rel=1e-15)


def test_undamped_constant_friction():
    """T = 2 a/v + 2 pi - 2 arctan(a/v) with the drop a = (mu - 1) beta."""
    system, v = fm.System(), np.array([0.2, 0.5])
    ds = fm.sweep(system, wall_speed=v, beta=[1.0], mu=[1.5])
    a = 0.5
    expected = 2 * a / v + 2 * np.pi - 2 * np.arctan(a / v)
    assert ds.cycle_period.values[0, :, 0] == pytest.approx(expected, rel=1e-14)
    assert ds.stuck_fraction.values[0, :, 0] == pytest.approx(2 * a / v / expected, rel=1e-13)


def test_speeds_with_units():
    units = fm.Units(natural_frequency="1 Hz", load="10 N", stiffness="100 N/m")
    ds = fm.sweep(one_mass(law=STRIBECK), wall_speed=["0.2 m/s"], beta=["3 N"], units=units)
    assert ds.wall_speed.values * 2 * np.pi * 0.1 == pytest.approx([0.2], rel=1e-15)
    assert ds.beta.values.tolist() == [0.3]


@pytest.mark.parametrize(
    ("contact", "named"),
    [
        ({"wall_speed": 0.2}, "wall_speed or wall_velocity of the contact"),
        ({"stiffness": 2.0}, "stiffness"),
        ({"force": 0.3}, "force"),
        ({"mu": 1.2}, "mu of the contact"),
        ({"ratio": 2.0}, "ratio"),
        ({"normal_load": {1: 0.5}}, "normal_load"),
    ],
)
def test_other_contacts_are_refused(contact, named):
    with pytest.raises(fm.InputError, match=named):
        fm.sweep(one_mass(**contact), wall_speed=[0.1], beta=[1.0])


def test_other_systems_are_refused():
    two = fm.System(mass_ratios=[1, 1], stiffness_ratios=[1, 1])
    with pytest.raises(fm.InputError, match="of 2 masses"):
        fm.sweep(two, wall_speed=[0.1], beta=[1.0])
    with pytest.raises(fm.InputError, match="excitation"):
        fm.sweep(fm.System(excitation="base"), wall_speed=[0.1], beta=[1.0])


@pytest.mark.parametrize(
    "unused", [{"r": [0.5]}, {"outputs": ["regime"]}, {"axes": {"damping_ratios": [0.1]}}]
)
def test_arguments_of_loads_are_refused(unused):
    with pytest.raises(fm.InputError, match="with wall_speed"):
        fm.sweep(one_mass(), wall_speed=[0.1], beta=[1.0], **unused)


def test_a_belt_at_rest_is_refused():
    with pytest.raises(fm.InputError, match="must be > 0"):
        fm.sweep(one_mass(), wall_speed=[0.0, 0.1], beta=[1.0])


def test_pictures_are_refused():
    ds = fm.sweep(one_mass(), wall_speed=[0.1, 0.2], beta=[1.0])
    with pytest.raises(fm.InputError, match="there is no picture of them yet"):
        ds.frictionmap.plot()
