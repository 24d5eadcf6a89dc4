"""Cycles of structures on belts without a load: another program's cycles, the equations, the engine of one
mass, limits of sliding.
"""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import frictionmap as fm
from frictionmap._kernels.general.series import Friction
from frictionmap.no_load.belts import belts_of
from frictionmap.no_load.structure import Ride
from frictionmap.no_load.structure_map import motions_of, sliding_of

LAW = {"speed": [0.0, 0.3, 0.8], "factor": [1.0, 0.75, 0.65], "slope": 0.05}


def contact_of(row):
    """A contact of a reference table."""
    places = np.flatnonzero(row["c"])
    return fm.Contact(
        "fixed-wall" if places.size == 1 else "between-masses",
        [int(place) + 1 for place in places],
        force=row["beta"],
        mu=row["mu"],
        law={
            "speed": [one[0] for one in row["law"]],
            "factor": [one[1] for one in row["law"]],
            "slope": row["slope_end"],
        },
        wall_speed=row.get("wall_speed") or 0.0,
    )


def cycle_of(row):
    """The cycle of a row of a reference table, from its start."""
    matrices = {name: np.array(row[name], float) for name in "MCK"}
    system = fm.System(
        matrices=matrices, contacts=[contact_of(one) for one in row["contacts"]], frequency_scale=1.0
    )
    belts = belts_of(system)
    speed = next(abs(one["wall_speed"]) for one in row["contacts"] if one.get("wall_speed"))
    sliding = sliding_of(system, belts, speed, 1.0, 1.0)
    start = np.array(row["start"] or np.zeros(2 * system.n))
    ride = Ride(system, belts, speed, 1.0)
    return ride.end_of(Friction(sliding.kinetic, sliding.static), sliding, *np.split(start, 2))


@pytest.mark.reference
def test_cycles_of_another_program(reference_table):
    """All rows with friction over speed and no load: counts exactly, the rest to 1e-10."""
    table = reference_table("laws.json")
    rows = [one for one in table["A"] + table["examples"] if (one["law"], one["load"]) == ("A", "none")]
    assert len(rows) >= 13
    for row in rows:
        cycle = cycle_of(row)
        assert cycle.period == pytest.approx(row["period"], rel=1e-10)
        for name, field in (
            ("stops", "stops"), ("turns", "turns"), ("break_point_crossings", "crossings")
        ):  # fmt: skip
            assert getattr(cycle, field).tolist() == row[name]
        for name, field in (
            ("x_max", "highest"), ("x_min", "lowest"), ("stuck_fraction", "stuck"),
            ("z_max", "contact_highest"), ("z_min", "contact_lowest"),
        ):  # fmt: skip
            assert getattr(cycle, field) == pytest.approx(np.array(row[name]), rel=1e-10, abs=1e-12), name
        assert cycle.multiplier == pytest.approx(row["multiplier"], rel=1e-9, abs=1e-7)


#: Two masses, two contacts, the first on a belt: computed by two other programs.
ROW = {
    "M": [[1.0, 0.0], [0.0, 0.94]],
    "C": [[0.18312731494271978, -0.05452609036560117], [-0.05452609036560118, 0.11290572324411083]],
    "K": [[1.82, -0.82], [-0.82, 0.82]],
    "contacts": [
        {
            "c": [0.0, 1.0], "beta": 0.993, "mu": 1.0, "slope_end": 0.03, "wall_speed": 0.197,
            "law": [[0.0, 1.0], [0.1537, 0.9824], [0.3293, 0.9345], [0.5269, 0.8838], [0.7684, 0.8548],
                    [1.1416, 0.8479]],
        },
        {
            "c": [1.0, 0.0], "beta": 0.167, "mu": 1.0, "slope_end": 0.094,
            "law": [[0.0, 1.0], [0.1516, 0.9763], [0.3248, 0.9115], [0.5197, 0.843], [0.7578, 0.8038],
                    [1.1259, 0.7944]],
        },
    ],
    "start": None,
}  # fmt: skip


def test_a_cycle_with_a_contact_that_rests_between():
    cycle = cycle_of(ROW)
    assert cycle.period == pytest.approx(6.765710144691605, rel=1e-13)
    assert cycle.stops.tolist() == [1.0, 2.0]
    assert cycle.stuck == pytest.approx([0.09413316405824416, 0.48398112542782284], rel=1e-12)
    assert cycle.highest == pytest.approx([0.9604699637222941, 2.3314541984662536], rel=1e-13)
    assert cycle.multiplier == pytest.approx(0.7119310184953374, rel=1e-11)


def chain(zeta=0.03, **contact):
    return fm.System(
        mass_ratios=[1, 1.5], stiffness_ratios=[1, 0.8], damping_ratios=zeta,
        contacts=[fm.Contact(masses=[2], law=LAW, **contact)],
    )  # fmt: skip


class Equations:
    """The equations of motion of a structure with one contact, by a Runge-Kutta method."""

    def __init__(self, system, v, beta, mu):
        modes = system.modes
        self.m, self.c, self.k = modes.mass, modes.damping, modes.stiffness
        self.vector, self.v, self.beta, self.mu = np.array([0.0, 1.0]), v, beta, mu
        self.law = fm.FrictionLaw(**LAW)

    def rates(self, sense):
        def rates(_, y):
            x, u = np.split(y, 2)
            free = -self.k @ x - self.c @ u
            slides = sense * self.beta * float(self.law(abs(u[1] - self.v)))
            force = slides if sense else self.load(y)
            return np.concatenate((u, np.linalg.solve(self.m, free - self.vector * force)))

        return rates

    def load(self, y):
        """Force that holds the contact."""
        x, u = np.split(y, 2)
        solved = np.linalg.solve(self.m, self.vector)
        return solved @ (-self.k @ x - self.c @ u) / (solved @ self.vector)

    def follow(self, y, time):
        """Samples of the motion from a state that slides backwards over the belt."""
        begun, sense, states, times = 0.0, -1, [], []
        while begun < time:
            if sense == 0:
                events = [lambda _, y: self.mu * self.beta - abs(self.load(y))]
            else:
                events = [lambda _, y, s=sense: s * (y[3] - self.v)]
            events[0].terminal, events[0].direction = True, -1
            run = solve_ivp(
                self.rates(sense), (begun, time), y, "DOP853", events=events, rtol=1e-11, atol=1e-13,
                max_step=0.05,
            )  # fmt: skip
            states.append(run.y)
            times.append(run.t)
            begun, y = run.t[-1], run.y[:, -1]
            if run.status != 1:
                break
            if sense == 0:
                sense = int(np.sign(self.load(y)))
            else:
                y[3] = self.v
                load = self.load(y)
                sense = 0 if abs(load) <= self.mu * self.beta else int(np.sign(load))
        return np.concatenate(times), np.concatenate(states, axis=1)


@pytest.mark.parametrize(("v", "beta", "mu"), [(0.3, 0.6, 1.0), (0.5, 0.8, 1.2), (0.75, 0.35, 1.0)])
def test_cycles_by_integration_of_the_equations(v, beta, mu):
    system = chain()
    belts = belts_of(system)
    sliding = sliding_of(system, belts, v, beta, mu)
    ride = Ride(system, belts, v, beta)
    cycle = motions_of(ride, sliding, system, belts)["release"]
    assert cycle.regime in (fm.regimes.STICK_SLIP_CYCLE, fm.regimes.CYCLE_WITHOUT_STOPS)
    equations = Equations(system, v, beta, mu)
    x = ride.modal.phi @ cycle.state[0]
    u = ride.modal.phi @ cycle.state[1] / ride.h
    assert cycle.senses.tolist() == [-1]
    times, states = equations.follow(np.concatenate((x, u)), cycle.period)
    assert times[-1] == pytest.approx(cycle.period, rel=1e-12)
    assert states[:, -1] == pytest.approx(states[:, 0], abs=3e-9)
    # of samples at most 0.05 apart, whose accelerations are below 3
    assert states[:2].max(axis=1) == pytest.approx(cycle.highest, abs=1e-3)
    assert states[:2].min(axis=1) == pytest.approx(cycle.lowest, abs=1e-3)


def test_one_mass_as_a_structure():
    """Two engines without common parts; the exact portrait of one mass is complete."""
    system = fm.System(damping_ratios=0.03, contacts=[fm.Contact(law=LAW)])
    belts = belts_of(system)
    speeds, betas = [0.1, 0.4, 0.7, 1.1], [0.35, 0.8, 1.5]
    exact = fm.sweep(system, wall_speed=speeds, beta=betas, mu=[1.0, 1.4])
    for (m, i, b), regime in np.ndenumerate(exact.regime.values):
        sliding = sliding_of(system, belts, speeds[i], betas[b], float(exact.mu[m]))
        cycle = motions_of(Ride(system, belts, speeds[i], 1.5), sliding, system, belts)["release"]
        cell = exact.isel(mu=m, wall_speed=i, beta=b)
        assert cycle.regime == regime
        assert sliding.growth == pytest.approx(float(cell.growth), rel=1e-12, abs=1e-14)
        assert cycle.period == pytest.approx(float(cell.cycle_period), rel=1e-12, nan_ok=True)
        assert cycle.stuck[0] == pytest.approx(float(cell.stuck_fraction), rel=1e-11, abs=1e-12)
        assert cycle.highest == pytest.approx(cell.x_max.values, rel=1e-11)
        assert cycle.lowest == pytest.approx(cell.x_min.values, rel=1e-11)


def test_maps_of_structures():
    ds = fm.sweep(chain(), wall_speed=[0.2, 0.6, 1.1], beta=[0.05, 0.4, 0.8], mu=[1.0, 1.2], threads=1)
    assert ds.x_max.dims == ("mu", "wall_speed", "beta", "dof")
    assert ds.stops_per_cycle.dims == ("mu", "wall_speed", "beta")
    assert not ds.status.values.any()
    regime = ds.regime.values
    assert {4, 5} <= set(regime.ravel().tolist())
    assert ((ds.growth.values > 0.0) <= (regime != fm.regimes.STEADY_SLIDING)).all()
    again = fm.sweep(chain(), wall_speed=[0.2, 0.6, 1.1], beta=[0.05, 0.4, 0.8], mu=[1.0, 1.2], threads=2)
    assert ds.drop_attrs().identical(again.drop_attrs())
    back = fm.sweep(chain(wall_speed=-1.0), wall_speed=[0.2, 0.6, 1.1], beta=[0.05, 0.4, 0.8], mu=[1.0, 1.2])
    assert back.x_max.values == pytest.approx(-ds.x_min.values, rel=1e-9, abs=1e-12)
    assert back.cycle_period.values == pytest.approx(ds.cycle_period.values, rel=1e-9, nan_ok=True)


def test_sliding_of_a_structure_loses_stability_at_its_limit():
    system = chain()
    limits = fm.boundaries(system, wall_speed=[0.1, 0.5, 1.0], beta=[0.5])
    assert np.isinf(limits.beta_sliding_lim.values).tolist() == [False, False, True]
    for v, limit in zip([0.1, 0.5], limits.beta_sliding_lim.values, strict=False):
        growth = [sliding_of(system, belts_of(system), v, limit * f, 1.0).growth for f in (0.9999, 1.0001)]
        assert growth[0] < 0.0 < growth[1]


def test_several_contacts_of_which_one_is_on_the_belt():
    contacts = [
        fm.Contact(masses=[2], law=LAW, wall_speed=1.0),
        fm.Contact(masses=[1], force=0.1),
    ]
    system = fm.System(
        mass_ratios=[1, 1.5], stiffness_ratios=[1, 0.8], damping_ratios=0.03, contacts=contacts
    )
    ds = fm.sweep(system, wall_speed=[0.2, 1.2], beta=[0.8])
    assert ds.stops_per_cycle.dims == ("mu", "wall_speed", "beta", "contact")
    assert ds.regime.values.ravel().tolist() == [fm.regimes.STICK_SLIP_CYCLE, fm.regimes.STEADY_SLIDING]
    assert ds.stuck_fraction.values[0, 1, 0].tolist() == [0.0, 1.0]
    assert ds.stops_per_cycle.values[0, 0, 0, 0] == 1.0
    with pytest.raises(fm.InputError, match="several contacts"):
        fm.boundaries(system, wall_speed=[0.2], beta=[0.8])
    with pytest.raises(fm.InputError, match="no belt moves"):
        fm.sweep(
            fm.System("between-masses", (1, 2), mass_ratios=[1, 1], stiffness_ratios=[1, 1]),
            wall_speed=[0.2], beta=[0.8],
        )  # fmt: skip


def test_an_undamped_structure_with_constant_friction_is_marginal():
    """Small vibrations last: whether the contact stops depends on the start."""
    system = fm.System(mass_ratios=[1, 1], stiffness_ratios=[1, 1], contact_masses=[2])
    ds = fm.sweep(system, wall_speed=[0.5], beta=[0.5])
    assert ds.growth.values == 0.0
    assert ds.status.values == fm.regimes.MARGINAL


def test_random_laws_by_both_engines():
    """One mass as such and as a structure: steep laws, strong damping, decays within a turn."""
    rng = np.random.default_rng(11)
    seen = set()
    for _ in range(24):
        speed = np.concatenate(([0.0], np.cumsum(rng.uniform(0.05, 0.5, rng.integers(1, 6)))))
        factor = np.concatenate(([1.0], rng.uniform(0.4, 1.1, speed.size - 1)))
        law = fm.FrictionLaw(speed, factor, float(rng.choice([0.0, 0.05, 0.3])))
        zeta, mu = float(rng.choice([0.005, 0.05, 0.3])), [1.0, 1.4]
        system = fm.System(damping_ratios=zeta, contacts=[fm.Contact(law=law)])
        belts = belts_of(system)
        speeds, betas = np.sort(rng.uniform(0.02, 2.0, 2)), np.sort(rng.uniform(0.05, 2.0, 2))
        exact = fm.sweep(system, wall_speed=speeds, beta=betas, mu=mu)
        for (m, i, b), regime in np.ndenumerate(exact.regime.values):
            sliding = sliding_of(system, belts, speeds[i], betas[b], mu[m])
            ends = motions_of(Ride(system, belts, speeds[i], betas[-1]), sliding, system, belts)
            cell = exact.isel(mu=m, wall_speed=i, beta=b)
            assert ends["release"].regime == regime
            assert ends["release"].period == pytest.approx(float(cell.cycle_period), rel=1e-9, nan_ok=True)
            assert all(int(cell.also_reachable) >> end.regime & 1 for end in ends.values())
            seen |= {end.regime for end in ends.values()}
    assert seen == {4, 5, 6}


def test_structures_by_their_modes_are_the_same():
    contacts = [fm.Contact(masses=[2], law=LAW), fm.Contact("between-masses", [1, 2], ratio=0.3)]
    ratios = (0.02, 0.03)
    chain = {"mass_ratios": [1.0, 0.7], "stiffness_ratios": [1.0, 1.4], "damping_ratios": ratios}
    for own in (contacts[:1], contacts):
        whole = fm.System(**chain, contacts=own)
        modes = fm.Modes(whole.modes.w, ratios, whole.modes.phi, ["low", "top"])
        modal = fm.System(modes=modes, contacts=own, frequency_scale=1.0)
        grid = {"wall_speed": [0.05, 0.2, 1.5], "beta": [0.1, 0.6], "mu": [1.0, 1.3]}
        expected, found = (fm.sweep(one, **grid) for one in (whole, modal))
        assert len(set(expected.regime.values.ravel())) > 1
        # averages of motions that do not repeat depend on all digits
        done = expected.status == 0
        assert (found.status == expected.status).all()
        assert int(done.sum()) >= 10
        for name in expected.data_vars:
            of_cells = {"mu", "wall_speed", "beta"} <= set(expected[name].dims)
            pair = [one[name].where(done) if of_cells else one[name] for one in (found, expected)]
            within = 1e-5 if name == "multiplier" else 1e-10  # one that is 0 is the root of rounding error
            np.testing.assert_allclose(*pair, rtol=1e-9, atol=within, err_msg=name)
        assert found.point_name.values.tolist() == ["low", "top"]
    top = fm.System(
        modes=fm.Modes(whole.modes.w, ratios, whole.modes.phi[1:], ["top"]),
        contact_masses=["top"], contacts=None, frequency_scale=1.0,
    )  # fmt: skip
    one = fm.System(**chain, contact_masses=[2])
    at = {"wall_speed": 0.2, "beta": 0.5, "mu": 1.4}
    expected, found = (fm.response(system, **at) for system in (one, top))
    for name in ("x", "v"):
        np.testing.assert_allclose(found[name][0], expected[name][1], rtol=0.0, atol=1e-9)
    np.testing.assert_allclose(found.friction, expected.friction, rtol=0.0, atol=1e-9)
