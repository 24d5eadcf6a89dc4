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


@pytest.mark.parametrize(
    ("formula", "slope"),
    [
        ("exponential", lambda y: -np.exp(-y)),
        ("gauss", lambda y: -2.0 * y * np.exp(-y * y)),
        ("hyperbolic", lambda y: -1.0 / (1.0 + y) ** 2),
        ("lorentz", lambda y: -2.0 * y / (1.0 + y * y) ** 2),
    ],
)
def test_growth_follows_the_slope_of_a_formula(formula, slope):
    """g' = (1 - q) s'(V/V_s)/V_s + k, growth = -zeta - beta g'/2 below critical damping."""
    law = {"formula": formula, "kinetic": 0.6, "speed": 0.3, "viscous": 0.02}
    v = np.linspace(0.05, 1.5, 40)
    ds = fm.sweep(one_mass(law=law), wall_speed=v, beta=[0.5, 1.0])
    rises = 0.4 / 0.3 * slope(v / 0.3) + 0.02
    for b, beta in enumerate((0.5, 1.0)):
        expected = -0.03 - 0.5 * beta * rises
        assert ds.growth.values[0, :, b] == pytest.approx(expected, rel=1e-12, abs=1e-14)
        assert ds.growth_frequency.values[0, :, b] == pytest.approx(np.sqrt(1.0 - expected**2), rel=1e-12)
        last = float(ds.sliding_speed_lim[b])
        rise = 0.4 / 0.3 * slope(last / 0.3) + 0.02
        assert beta * rise == pytest.approx(-0.06, rel=1e-12)
        assert not (ds.growth.values[0, v > last, b] > 0.0).any()
    stable = (ds.also_reachable.values & (1 << fm.regimes.STEADY_SLIDING)) != 0
    assert (stable == (ds.growth.values < 0.0)).all()
    fall = -rises[rises < 0.0]
    assert ds.beta_sliding_lim.values[rises < 0.0] == pytest.approx(0.06 / fall, rel=1e-12)


def test_cells_in_which_break_points_decide_are_marked():
    """A coarse polygon has a wrong slope: its motions near the limit of stability are not the formula's."""
    law = {"formula": "exponential", "kinetic": 0.75, "speed": 0.3, "error": 0.03}
    ds = fm.sweep(one_mass(law=law), wall_speed=np.linspace(0.3, 1.0, 36), beta=[1.0])
    marked = ds.status.values == fm.regimes.BREAK_POINTS
    assert 0 < marked.sum() < marked.size
    polygon = one_mass(
        law=fm.FrictionLaw(*[getattr(fm.Contact(law=law).law, k) for k in ("speed", "factor")])
    )
    own = fm.sweep(polygon, wall_speed=ds.wall_speed.values, beta=[1.0])
    assert (marked == ((own.growth.values < 0.0) != (ds.growth.values < 0.0))).all()


def test_a_law_of_a_formula_is_written_as_one():
    law = {"formula": "gauss", "kinetic": 0.7, "speed": 0.2, "viscous": 0.05, "error": 0.004}
    made = fm.Contact(law=law).law
    assert made.as_keys() == law
    assert fm.Contact(law=made.as_keys()).law == made


def test_undamped_masses_squeal_at_every_speed_at_which_friction_falls():
    law = {"formula": "hyperbolic", "kinetic": 0.7, "speed": 0.2}
    ds = fm.boundaries(fm.System(contacts=[fm.Contact(law=law)]), wall_speed=[0.1], beta=[0.0, 1.0])
    assert ds.sliding_speed_lim.values.tolist() == [0.0, np.inf]
    rises = fm.System(contacts=[fm.Contact(law=law | {"viscous": 0.1})])
    ds = fm.boundaries(rises, wall_speed=[0.1], beta=[1.0])
    assert 0.3 / 0.2 / (1.0 + float(ds.sliding_speed_lim[0]) / 0.2) ** 2 == pytest.approx(0.1, rel=1e-12)
