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
    assert ds.sizes == {"mu": 1, "wall_speed": 4, "beta": 1, "dof": 1}
    cell = ds.isel(mu=0, beta=0)
    cycle, sliding = 1 << fm.regimes.STICK_SLIP_CYCLE, 1 << fm.regimes.STEADY_SLIDING
    assert cell.regime.values.tolist() == [fm.regimes.STICK_SLIP_CYCLE] * 3 + [fm.regimes.STEADY_SLIDING]
    assert cell.also_reachable.values.tolist() == [cycle, cycle, cycle | sliding, sliding]
    assert (cell.growth > 0.0).values.tolist() == [True, True, False, False]
    periods = [9.597492758505735, 7.198913805721023, 6.4346228336091125]
    assert cell.cycle_period.values[:3] == pytest.approx(periods, rel=1e-12)
    assert cell.x_max.values[1, 0] == pytest.approx(1.2341840785926574, rel=1e-11)
    assert cell.x_min.values[1, 0] == pytest.approx(0.2151323896425577, rel=1e-11)
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
        ({"wall_velocity": 0.2}, r"contacts\[1\]\.wall_velocity"),
        ({"stiffness": 2.0}, r"contacts\[1\]\.stiffness"),
        ({"normal_load": {1: 0.5}}, r"contacts\[1\]\.normal_load"),
    ],
)
def test_other_contacts_are_refused(contact, named):
    with pytest.raises(fm.InputError, match=named):
        fm.sweep(one_mass(**contact), wall_speed=[0.1], beta=[1.0])


def test_other_systems_are_refused():
    free = fm.System(mass_ratios=[1, 1], stiffness_ratios=[0, 1])
    with pytest.raises(fm.InputError, match="of a free structure"):
        fm.sweep(free, wall_speed=[0.1], beta=[1.0])
    with pytest.raises(fm.InputError, match="excitation"):
        fm.sweep(fm.System(excitation="base"), wall_speed=[0.1], beta=[1.0])


@pytest.mark.parametrize(
    ("load", "named"),
    [
        ({"load_harmonics": {1: [1.0]}}, "load_harmonics"),
        ({"waveform": "square"}, "waveform"),
        ({"load": [1.0]}, "load"),
        ({"load_offset": [0.4]}, "load_offset"),
    ],
)
def test_loads_are_refused(load, named):
    with pytest.raises(fm.InputError, match=f"^cannot use {named} without a load"):
        fm.sweep(fm.System(**load), wall_speed=[0.1], beta=[1.0])


def test_own_friction_of_the_contact():
    """`force` and `ratio` scale the friction, `mu` the drop: the same motions as by the grid."""
    grid = fm.sweep(one_mass(law=STRIBECK), wall_speed=[0.3, 0.7], beta=[0.8], mu=[1.2])
    for contact, beta, mu in (
        ({"force": 0.8}, 0.1, 1.2),
        ({"ratio": 2.0}, 0.4, 1.2),
        ({"mu": 1.2}, 0.8, 1.0),
        ({"wall_speed": 0.3}, 0.8, 1.2),
    ):
        own = fm.sweep(one_mass(law=STRIBECK, **contact), wall_speed=[0.3, 0.7], beta=[beta], mu=[mu])
        for name in ("regime", "cycle_period", "x_max", "cycle_speed_lim"):
            assert own[name].values == pytest.approx(grid[name].values, rel=1e-14), (contact, name)


def test_a_belt_that_runs_backwards_mirrors_the_motion():
    ahead = fm.sweep(one_mass(law=STRIBECK), wall_speed=[0.3], beta=[1.0])
    back = fm.sweep(one_mass(law=STRIBECK, wall_speed=-1.0), wall_speed=[0.3], beta=[1.0])
    assert back.x_max.values == -ahead.x_min.values
    assert back.x_min.values == -ahead.x_max.values
    assert back.cycle_period.values == ahead.cycle_period.values


def test_limits_of_sliding_are_where_its_growth_changes_sign():
    """Also on a break point, where half a turn is in either segment."""
    system, v = one_mass(law=STRIBECK), np.array([0.1, 0.2, 0.4, 0.6, 0.9, 1.2, 1.3])
    limit = fm.boundaries(system, wall_speed=v, beta=[1.0]).beta_sliding_lim.values
    assert np.isinf(limit).tolist() == [False] * 6 + [True]  # at 1.2 delta = -1 is reached first
    for k, one in enumerate(limit[:6]):
        near = fm.sweep(system, wall_speed=v[k : k + 1], beta=[one * (1 - 1e-6), one * (1 + 1e-6)])
        assert (near.growth.values.ravel() > 0.0).tolist() == [False, True]


def test_speeds_above_which_sliding_is_stable():
    beta = [0.01, 0.2, 1.0, 2.0]
    ds = fm.boundaries(one_mass(law=STRIBECK), wall_speed=[0.1], beta=beta)
    assert ds.sliding_speed_lim.values.tolist() == [0.0, 0.2, 0.6, 1.2]
    dense = fm.sweep(one_mass(law=STRIBECK), wall_speed=np.arange(1, 150) / 100.0, beta=beta)
    for k, limit in enumerate(ds.sliding_speed_lim.values):
        unstable = dense.wall_speed.values[dense.growth.values[0, :, k] > 0.0]
        assert unstable.max(initial=0.0) == pytest.approx(limit, abs=0.011)


def test_threads_do_not_change_a_bit():
    ds = [
        fm.sweep(one_mass(law=STRIBECK), wall_speed=[0.1, 0.5, 0.9], beta=[0.5, 1.0], threads=threads)
        for threads in (1, 3)
    ]
    assert ds[0].drop_attrs().identical(ds[1].drop_attrs())


@pytest.mark.parametrize(
    "unused", [{"r": [0.5]}, {"outputs": ["regime"]}, {"axes": {"damping_ratios": [0.1]}}]
)
def test_arguments_of_loads_are_refused(unused):
    with pytest.raises(fm.InputError, match="with wall_speed"):
        fm.sweep(one_mass(), wall_speed=[0.1], beta=[1.0], **unused)


def test_a_belt_at_rest_is_refused():
    with pytest.raises(fm.InputError, match="must be > 0"):
        fm.sweep(one_mass(), wall_speed=[0.0, 0.1], beta=[1.0])
