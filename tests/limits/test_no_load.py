"""One mass on a belt without a load, and steady sliding of structures: closed forms and the equations."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from frictionmap import regimes
from frictionmap.general.slopes import limits_of
from frictionmap.no_load.one_mass import cycle_speed_limits, portraits
from frictionmap.no_load.sliding import growth_of_sliding

FLAT = (np.zeros(1), np.ones(1), np.zeros(1))


def law_of(points, slope):
    """Segments of a law through points (speed, factor), with the slope beyond the last."""
    speeds, factors = np.array(points, float).T
    return speeds, factors, np.append(np.diff(factors) / np.diff(speeds), slope)


#: Falls, rises; falls to nearly nothing just above a speed.
STRIBECK = law_of([(0, 1), (0.2, 0.8), (0.6, 0.7), (1.2, 0.68)], 0.08)
STEP = law_of([(0, 1), (0.5, 0.99), (0.6, 0.05)], 0.0)


def cell(law, zeta, v, beta=1.0, mu=1.0):
    """Portrait of one cell as numbers by their names."""
    found = portraits(law, zeta, [mu], [v], [beta])
    return {name: values.item() for name, values in found._asdict().items()}


def factor(law, speed):
    """Friction over that at speed 0, by interpolation."""
    speeds, factors, slopes = law
    inside = np.interp(speed, speeds, factors)
    return inside + slopes[-1] * max(speed - speeds[-1], 0.0)


class Simulation:
    """The equation of motion by a Runge-Kutta method, with switching of its own."""

    def __init__(self, law, zeta, v, beta, mu):
        self.law, self.zeta, self.v, self.beta, self.mu = law, zeta, v, beta, mu
        self.release = mu * beta - 2.0 * zeta * v

    def _rates(self, side):
        def rates(_, y):
            pull = -side * self.beta * factor(self.law, side * (y[1] - self.v))
            return [y[1], pull - y[0] - 2.0 * self.zeta * y[1]]

        return rates

    def _leg(self, y, side, turn):
        """Integrate to w = 0, or to the next maximum (turn -1) or minimum (1)."""

        def extreme(_, y):
            return y[1]

        def touch(_, y):
            return y[1] - self.v

        extreme.terminal, extreme.direction = turn != 0, turn
        touch.terminal, touch.direction = True, -side
        return solve_ivp(
            self._rates(side), (0.0, 60.0), y, "DOP853", events=(extreme, touch), rtol=1e-11, atol=1e-13,
            max_step=0.2,
        )  # fmt: skip

    def turn(self, y):
        """Next maximum after one, the time until then, and the place of a stop before it."""
        run = self._leg(y, -1, 1)
        if not run.t_events[0].size:
            return None, 0.0, None
        time, place = run.t[-1], None
        run = self._leg(run.y[:, -1], -1, -1)
        for _ in range(20):
            time += run.t[-1]
            if not run.t_events[1].size:
                return (run.y[0, -1] if run.t_events[0].size else None), time, place
            x = run.y[0, -1]
            load = x + 2.0 * self.zeta * self.v
            if load < -self.mu * self.beta:
                run = self._leg([x, self.v], 1, 0)
                time += run.t[-1]
                x = run.y[0, -1]
                load = x + 2.0 * self.zeta * self.v
            if load <= self.mu * self.beta:
                time += (self.release - x) / self.v
                x, place = self.release, x
            # a stop ends with w < 0, however little
            run = self._leg([x, self.v * (1.0 - 1e-12)], -1, -1)
        raise AssertionError("chatters")


# zeta, rho: a flat law has a stick-slip cycle where (mu - 1) beta/v >= rho
@pytest.mark.parametrize(
    ("zeta", "rho"),
    [(0.01, 0.365064706943), (0.05, 0.910669990890), (0.1, 1.470117789187), (0.2, 2.724989235560)],
)
def test_the_fastest_belt_of_constant_friction(zeta, rho):
    w = np.sqrt(1.0 - zeta**2)
    time = (2.0 * np.pi - np.arctan2(rho * w, 1.0 - zeta * rho)) / w
    assert 1.0 - 2.0 * zeta * rho + rho**2 == pytest.approx(np.exp(2.0 * zeta * time), rel=1e-11)
    found = cycle_speed_limits(FLAT, zeta, np.array([1.5]), np.array([1.0, 3.0]))
    assert 0.5 * np.array([1.0, 3.0]) / found[0] == pytest.approx(rho, rel=2e-11)
    limit = found[0, 0]
    assert cell(FLAT, zeta, limit * (1 - 1e-7), mu=1.5)["regime"] == regimes.STICK_SLIP_CYCLE
    above = cell(FLAT, zeta, limit * (1 + 1e-7), mu=1.5)
    assert (above["regime"], above["reachable"]) == (regimes.STEADY_SLIDING, 1 << regimes.STEADY_SLIDING)


@pytest.mark.parametrize(
    ("delta", "period", "width"),
    [
        (-0.02, 6.3228501899050, 2.1299214338956),
        (-0.05, 6.4394748901052, 2.3420067714393),
        (-0.1, 6.7368371917651, 2.7489860011084),
    ],
)
@pytest.mark.parametrize("v", [0.02, 0.1])
def test_the_cycle_on_one_falling_segment_is_proportional_to_the_belt(delta, period, width, v):
    # at mu = 1 the stick lasts rho of abs(delta), by reversal of time
    found = cell(law_of([(0, 1), (4, 1 + 8 * delta)], 0.0), 0.0, v)
    assert found["regime"] == regimes.STICK_SLIP_CYCLE
    assert found["period"] == pytest.approx(period, rel=1e-11)
    assert (found["highest"] - found["lowest"]) / v == pytest.approx(width, rel=1e-11)
    h, w = abs(delta), np.sqrt(1.0 - delta**2)
    rho = found["stuck"] * found["period"]
    time = (2.0 * np.pi - np.arctan2(rho * w, 1.0 - h * rho)) / w
    assert found["period"] == pytest.approx(time + rho, rel=1e-12)


def test_undamped_constant_friction_with_a_drop():
    mu, v, beta = 1.5, 0.2, 1.0
    found = cell(FLAT, 0.0, v, beta, mu)
    a = (mu - 1.0) * beta
    assert found["period"] == pytest.approx(2 * a / v + 2 * np.pi - 2 * np.arctan(a / v), rel=1e-14)
    assert found["highest"] == pytest.approx(beta + np.hypot(a, v), rel=1e-14)
    assert cycle_speed_limits(FLAT, 0.0, np.array([mu]), np.array([beta]))[0, 0] == np.inf


# period, share of stick, extremes, crossings of break points: computed by two other programs
@pytest.mark.parametrize(
    ("v", "period", "stuck", "highest", "lowest", "knots"),
    [
        (0.1, 9.597492758505735, 0.516340686218782, 1.0778690400685835, 0.48777300100648774, 2),
        (0.3, 7.198913805721023, 0.3223367234407021, 1.2341840785926574, 0.2151323896425577, 4),
        (0.7, 6.4346228336091125, 0.15957279832785679, 1.564960359837079, -0.09525532599747344, 6),
    ],
)
def test_stick_slip_cycles_of_a_falling_law(v, period, stuck, highest, lowest, knots):
    found = cell(STRIBECK, 0.03, v)
    assert found["period"] == pytest.approx(period, rel=1e-12)
    assert found["stuck"] == pytest.approx(stuck, rel=1e-11)
    assert (found["highest"], found["lowest"]) == pytest.approx((highest, lowest), rel=1e-11)
    assert (found["stops"], found["knots"], found["multiplier"]) == (1.0, knots, 0.0)


def test_portrait_of_a_falling_law():
    assert cycle_speed_limits(STRIBECK, 0.03, np.ones(1), np.ones(1))[0, 0] == pytest.approx(
        1.124273429839, rel=1e-11
    )
    found = cell(STRIBECK, 0.03, 0.7)
    assert found["reachable"] == 1 << 4 | 1 << 5
    assert found["threshold"] - factor(STRIBECK, 0.7) == pytest.approx(0.160049872841, abs=1e-11)
    assert found["growth"] == pytest.approx(-(0.03 - 0.01 / 0.6), rel=1e-12)
    inside = [cell(STRIBECK, 0.03, v) for v in (0.19, 0.21, 0.59, 0.61)]
    assert [one["growth"] > 0.0 for one in inside] == [True, True, True, False]
    assert np.isnan(inside[0]["threshold"])


def test_at_a_break_point_each_half_turn_counts():
    first, second = 0.03 - 0.125, 0.03 - 0.01 / 0.6  # below and above the break point 0.6
    found = cell(STRIBECK, 0.03, 0.6)
    times = [np.pi / np.sqrt(1.0 - one**2) for one in (first, second)]
    assert found["growth"] == pytest.approx(-(first * times[0] + second * times[1]) / sum(times), rel=1e-12)
    assert found["frequency"] == pytest.approx(2.0 * np.pi / sum(times), rel=1e-14)


def test_a_cycle_that_overtakes_the_belt_and_never_sticks():
    # friction acts only at speeds below 0.6 over the belt: it drives the mass at 0.4 < x' < 1 and brakes it
    # at x' > 1, so weak friction has a cycle that goes through w = 0 without a stop
    zeta, v, beta = 1e-4, 1.0, 0.02
    found = cell(STEP, zeta, v, beta)
    assert (found["regime"], found["stops"]) == (regimes.CYCLE_WITHOUT_STOPS, 0.0)
    simulation = Simulation(STEP, zeta, v, beta, 1.0)
    highest, period, place = simulation.turn([found["highest"], 0.0])
    assert place is None
    assert highest == pytest.approx(found["highest"], abs=1e-9)
    assert period == pytest.approx(found["period"], rel=1e-9)
    assert found["highest"] > v  # the largest velocity exceeds the belt's
    assert 0.0 < found["multiplier"] < 1.0


def random_systems(count):
    """Laws, damping, belt speeds, beta and mu of all kinds."""
    rng = np.random.default_rng(20)
    for k in range(count):
        many = rng.integers(1, 4)
        speeds = np.concatenate(([0.0], np.cumsum(rng.uniform(0.1, 0.6, many))))
        factors = np.concatenate(([1.0], rng.uniform(0.3, 1.0, many)))
        law = law_of(np.column_stack((speeds, factors)), rng.choice([0.0, 0.1]))
        zeta, beta = rng.choice([0.02, 0.05, 0.1]), rng.uniform(0.2, 1.5)
        yield law, zeta, rng.uniform(0.05, 1.2), beta, (1.0 if k % 3 else rng.uniform(1.05, 1.4))


@pytest.mark.slow
@pytest.mark.parametrize("system", list(random_systems(20)))
def test_simulations_end_as_predicted(system):
    law, zeta, v, beta, mu = system
    found = cell(law, zeta, v, beta, mu)
    simulation, steady = Simulation(law, zeta, v, beta, mu), beta * factor(law, v)
    assert found["status"] == regimes.RESOLVED
    for start in (steady + 0.02 * v, steady + 0.7 * v, steady + 3.0 * (v + beta)):
        x, stopped = start, False
        for _ in range(200):
            following, time, place = simulation.turn([x, 0.0])
            if following is None or abs(following - x) < 1e-7:
                break
            if following - steady < 0.01 * min(v, start - steady):
                break
            if place is not None and stopped:
                break
            stopped = place is not None
            x = following
        if place is not None:
            assert found["reachable"] & 1 << regimes.STICK_SLIP_CYCLE
            assert (following, time) == pytest.approx((found["highest"], found["period"]), rel=1e-8)
        elif following is None or following - steady < 0.01 * min(v, start - steady):
            assert found["reachable"] & 1 << regimes.STEADY_SLIDING
        else:
            assert abs(following - x) < 1e-7
            assert found["reachable"] & 1 << regimes.CYCLE_WITHOUT_STOPS


def matrices():
    """A chain of three masses, damped."""
    mass = np.diag([1.0, 1.4, 0.7])
    stiffness = np.array([[2.2, -1.2, 0.0], [-1.2, 2.0, -0.8], [0.0, -0.8, 0.8]])
    return mass, 0.03 * mass + 0.04 * stiffness, stiffness


@pytest.mark.parametrize("k", [0, 1, 2])
def test_the_limit_of_a_falling_slope(k):
    mass, damping, stiffness = matrices()
    vector = np.eye(3)[k]
    found = limits_of(mass, damping, stiffness, vector)
    at, above, below = (
        growth_of_sliding(mass, damping, stiffness, vector[None], np.array([-found.limit * share]))
        for share in (1.0, 1.001, 0.999)
    )
    assert abs(at.growth) < 1e-14
    assert above.growth > 0.0 > below.growth
    assert at.frequency == pytest.approx(found.frequency, rel=1e-12)
    assert found.certificate <= found.limit


def test_the_limit_of_one_mass_is_its_damping():
    found = limits_of(np.eye(1), np.array([[0.1]]), np.eye(1), np.ones(1))
    assert (found.limit, found.frequency, found.certificate) == pytest.approx((0.1, 1.0, 0.1), rel=1e-14)
    assert limits_of(np.eye(1), np.zeros((1, 1)), np.eye(1), np.ones(1)).limit == 0.0


def reference_portrait(one, zeta, v):
    """Portrait of a row of laws.json."""
    return cell(law_of(one["law"], one["slope_end"]), zeta, v, one["beta"], one["mu"])


@pytest.mark.reference
def test_reference_cycles_of_one_mass(reference_table):
    """Cycles by two programs that agree to 1e-12."""
    table = reference_table("laws.json")
    rows = [row for row in (*table["A"], *table["examples"]) if row["law"] == "A" and row["load"] == "none"]
    rows = [row for row in rows if row["masses"] == 1]
    assert len(rows) >= 3
    for row in rows:
        (one,) = row["contacts"]
        found = reference_portrait(one, 0.5 * row["C"][0][0], one["wall_speed"])
        assert found["period"] == pytest.approx(row["period"], rel=1e-12)
        extremes = row["x_max"][0], row["x_min"][0]
        assert (found["highest"], found["lowest"]) == pytest.approx(extremes, abs=1e-11)
        assert [found["stops"]] == row["stops"]
        assert found["stuck"] == pytest.approx(row["stuck_fraction"][0], abs=1e-11)
        assert [found["knots"]] == row["break_point_crossings"]
        assert found["multiplier"] == pytest.approx(row["multiplier"], abs=1e-11)


@pytest.mark.reference
def test_reference_speeds_of_the_fastest_belt(reference_table):
    """The largest belt speed with a stick-slip cycle, by two programs."""
    for row in reference_table("laws.json")["cycle_speed"]:
        one, zeta = row["contact"], row["zeta"]
        law = law_of(one["law"], one["slope_end"])
        found = cycle_speed_limits(law, zeta, np.array([one["mu"]]), np.array([one["beta"]])).item()
        assert found == pytest.approx(row["cycle_speed_lim"], rel=1e-11)
        growth = reference_portrait(one, zeta, found)["growth"]
        assert (growth < 0.0) == row["steady_sliding_stable_there"]


def test_a_search_that_would_not_end_has_a_status():
    """Neither friction nor damping at large speeds: nothing bounds the cycles there, as the status shows."""
    found = cell(law_of([(0, 1), (5, 0)], 0.0), 0.0, 0.02)
    assert (found["regime"], found["status"]) == (regimes.STICK_SLIP_CYCLE, regimes.NOT_REACHED)
    assert found["period"] == pytest.approx(6.7368371917651, rel=1e-11)


def test_cycles_about_sliding_that_small_motions_leave_without_oscillation():
    """delta <= -1 in the band of steady sliding: the cycle lies within what would be its first vibrations."""
    speeds = [0.0, 0.3206545956513897, 0.8081545911513008, 1.0581718977763648, 1.5429847334582727, 2.0]
    factors = [1.0, 0.4919488384619021, 1.0390923402832564, 0.4642211885313451, 0.6826301470842421, 1.0]
    law, v, beta, mu = law_of(list(zip(speeds, factors, strict=True)), 0.0), 0.85, 1.4, 1.47
    found = cell(law, 0.3, v, beta, mu)
    assert found["growth"] > 1.0
    assert found["frequency"] == 0.0
    assert found["regime"] == regimes.CYCLE_WITHOUT_STOPS
    assert found["reachable"] == 1 << regimes.CYCLE_WITHOUT_STOPS
    simulation = Simulation(law, 0.3, v, beta, mu)
    x = found["highest"] + 0.1
    for _ in range(4):
        x, time, stop = simulation.turn([x, 0.0])
    assert stop is None
    assert x == pytest.approx(found["highest"], rel=1e-8)
    assert time == pytest.approx(found["period"], rel=1e-8)
