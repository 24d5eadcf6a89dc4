"""Friction over the sliding speed in steady states: known values, limiting cases, a twin with fixed steps."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import frictionmap as fm
from frictionmap._kernels.general.counts import CROSSINGS, STOPS
from frictionmap._kernels.general.series import Friction
from frictionmap.general.boundaries import friction_lines
from frictionmap.general.problem import problem_of
from frictionmap.general.recorded import Memory, recorded_state

FALLING = {"speed": [0.0, 0.5], "factor": [1.0, 0.7], "slope": 0.1}
STRIBECK = {"speed": [0.0, 0.2, 0.6], "factor": [1.0, 0.75, 0.8], "slope": 0.15}

#: Rows of laws.json in which the motion from rest reaches another one of several steady states.
SEVERAL = "one of several steady states of this system"


def one_mass(law, zeta=0.05, **contact):
    return fm.System(damping_ratios=zeta, contacts=[fm.Contact(law=law, **contact)])


def chain(first, second, damping=None):
    """Two masses with a contact each."""
    m, k = np.diag([1.0, 1.3]), np.array([[2.0, -1.0], [-1.0, 1.2]])
    c = 0.04 * k if damping is None else damping
    return fm.System(
        matrices={"M": m, "K": k, "C": c}, contacts=[first, second],
        load_harmonics={1: [1.0, 0.3j], 3: [0.2, 0.0]}, frequency_scale=1.0, stiffness_scale=1.0,
    )  # fmt: skip


def ends(ds):
    middle, half = ds["midpoint"].values, 0.5 * ds["peak_to_peak"].values
    return np.concatenate((np.atleast_1d(middle - half), np.atleast_1d(middle + half)))


@pytest.mark.parametrize(
    ("r", "largest", "stops", "stuck", "crossings"),
    [(0.8, 2.168194338787, 0, 0.0, 4), (0.4, 1.141329788750, 2, 0.348192466119, 4)],
)
def test_known_steady_states_of_one_mass(r, largest, stops, stuck, crossings):
    """Values of two programs that share no code with this one, to the digits that are known."""
    cell = fm.response(one_mass(FALLING), r, 0.5)
    assert float(cell.amplitude[0]) == pytest.approx(largest, abs=1e-12)
    assert float(cell.stops_per_cycle) == stops
    assert float(cell.stuck_fraction) == pytest.approx(stuck, abs=1e-7)  # a 32-bit number
    assert float(cell.segment_crossings) == crossings


def naive(r, beta, mu, law, zeta, wall, periods=60, steps=2**13):
    """Lowest and highest displacement of one mass by fixed steps with a clipped impulse of friction."""
    h, x, v, tau = 2.0 * np.pi / steps, 0.0, 0.0, 0.0
    low, high = np.inf, -np.inf
    for k in range(periods * steps):
        rate = (np.cos(tau + 0.5 * h) - x - 0.5 * h * v - 2.0 * zeta * r * v) / r**2
        free = v + h * rate - wall / r
        slides = abs(v - wall / r) > 1e-14
        limit = h * beta / r**2 * (float(law(r * abs(v - wall / r))) if slides else mu)
        new = free - np.clip(free, -limit, limit) + wall / r
        x += 0.5 * h * (v + new)
        v, tau = new, (k + 1) * h
        if k >= (periods - 1) * steps:
            low, high = min(low, x), max(high, x)
    return low, high


@pytest.mark.parametrize(
    ("r", "beta", "mu", "wall"), [(0.45, 0.4, 1.0, 0.0), (0.7, 0.3, 1.0, 0.25), (0.35, 0.5, 1.2, 0.0)]
)
def test_a_twin_with_fixed_steps_has_the_same_motion(r, beta, mu, wall):
    """The twin is of first order: its error is about the angle of a step, 8e-4."""
    law = fm.Contact(law=STRIBECK).law
    cell = fm.response(one_mass(STRIBECK, 0.1, wall_speed=wall), r, beta, mu)
    assert ends(cell) == pytest.approx(naive(r, beta, mu, law, 0.1, wall), abs=3e-3)


@pytest.mark.parametrize("mu", [1.0, 1.3])
@pytest.mark.parametrize("r", [0.31, 0.8, 1.6])
def test_break_points_beyond_all_speeds_change_nothing(r, mu):
    law = {"speed": [0.0, 50.0, 60.0], "factor": [1.0, 1.0, 0.5]}
    own, other = (
        chain(fm.Contact(masses=1, law=one), fm.Contact("between-masses", [1, 2], ratio=0.4))
        for one in (law, None)
    )
    with_law, without = (fm.response(one, r, 0.3, mu) for one in (own, other))
    assert ends(with_law) == pytest.approx(ends(without), abs=1e-11)
    assert with_law.stops_per_cycle.values.tolist() == without.stops_per_cycle.values.tolist()
    assert with_law.work_friction.values == pytest.approx(without.work_friction.values, abs=1e-11)


@pytest.mark.parametrize("slope", [0.3, 0.05])
@pytest.mark.parametrize("r", [0.31, 0.8, 1.6])
def test_one_rising_segment_is_viscous_damping(r, slope):
    """f = beta (sgn w + a r w): the dashpot beta a in the contact."""
    beta, k = 0.3, np.array([[2.0, -1.0], [-1.0, 1.2]])
    second = fm.Contact("between-masses", [1, 2], force=0.1)
    law = {"speed": [0.0], "factor": [1.0], "slope": slope}
    own = chain(fm.Contact(masses=1, force=beta, law=law), second)
    other = chain(fm.Contact(masses=1, force=beta), second, 0.04 * k + beta * slope * np.diag([1.0, 0.0]))
    found, expected = (fm.response(one, r, 1.0) for one in (own, other))
    assert ends(found) == pytest.approx(ends(expected), abs=1e-11)
    assert float(found.multiplier) == pytest.approx(float(expected.multiplier), abs=1e-9)


def test_a_break_point_between_equal_slopes_changes_nothing():
    one = {"speed": [0.0, 0.8], "factor": [1.0, 0.6], "slope": 0.0}
    two = {"speed": [0.0, 0.3, 0.8], "factor": [1.0, 0.85, 0.6], "slope": 0.0}
    for r in (0.4, 0.9):
        found, expected = (fm.response(one_mass(law, 0.2), r, 0.4) for law in (two, one))
        assert ends(found) == pytest.approx(ends(expected), abs=1e-12)
        assert float(found.segment_crossings) == float(expected.segment_crossings) + 4.0


def test_the_order_of_contacts_does_not_matter():
    first, second = (
        fm.Contact(masses=1, force=0.3, law=STRIBECK, wall_speed=0.2),
        fm.Contact("between-masses", [1, 2], force=0.2, law=FALLING),
    )
    found, other = (fm.response(chain(*pair), 0.7, 1.0) for pair in ((first, second), (second, first)))
    assert ends(found) == pytest.approx(ends(other), abs=1e-12)
    assert found.segment_crossings.values.tolist() == other.segment_crossings.values[::-1].tolist()


def test_a_belt_that_runs_the_other_way_mirrors_the_motion():
    there, back = (fm.response(one_mass(STRIBECK, 0.1, wall_speed=wall), 0.7, 0.4) for wall in (0.3, -0.3))
    low, high = ends(there)
    assert ends(back) == pytest.approx((-high, -low), abs=1e-12)


def test_works_balance():
    system = chain(
        fm.Contact(masses=1, force=0.3, law=STRIBECK, wall_speed=0.2),
        fm.Contact("between-masses", [1, 2], force=0.2, law=FALLING),
    )
    cell = fm.response(system, 0.7, 1.0)
    given = float(cell.work_input) + float(cell.work_wall.sum())
    assert given == pytest.approx(float(cell.work_friction.sum() + cell.work_damping), rel=1e-11)


@pytest.mark.parametrize("r", [0.35, 0.6, 0.95, 1.4])
def test_both_starts_agree_where_the_steady_state_is_unique(r):
    """beta |a| = 0.95 c, the damping of one mass: C1 + beta a c c^T > 0 (Q)."""
    law = {"speed": [0.0, 0.4, 1.0], "factor": [1.0, 0.9, 0.85], "slope": 0.0}
    system = one_mass(law, 0.1)
    beta = 0.95 * 0.2 / 0.25
    found = [fm.response(system, r, beta, solver=fm.Solver(start=start)) for start in ("rest", "moving")]
    assert ends(found[0]) == pytest.approx(ends(found[1]), abs=1e-11)


def test_a_map_has_the_cells_of_single_motions():
    law = fm.Contact(law=STRIBECK, wall_speed=0.2)
    system = fm.System(damping_ratios=0.1, contacts=[law])
    ds = fm.sweep(system, [0.4, 0.9], [0.1, 0.4, 3.0], outputs=["peak_to_peak", "segment_crossings"])
    for i, r in enumerate((0.4, 0.9)):
        for b, beta in enumerate((0.1, 0.4, 3.0)):
            cell = fm.response(system, r, beta)
            assert ds.peak_to_peak[0, i, b, 0] == pytest.approx(float(cell.peak_to_peak[0]), abs=1e-11)
    assert "beta_lim" not in ds


def from_rest(m, k, c, load, r, beta, law, periods):
    """Displacements of two masses after some periods, by Runge-Kutta; friction on the second one, mu = 1."""

    def acceleration(tau, y, sense):
        push = (load * np.exp(1j * tau)).real - k @ y[:2] - r * c @ y[2:]
        if sense == 0:
            return np.array([push[0] / m[0] / r**2, 0.0]), push[1]
        force = sense * beta * float(law(r * abs(y[3])))
        return (push - [0.0, force]) / m / r**2, force

    def stops(tau, y, sense):
        return sense * y[3] if sense else beta - abs(acceleration(tau, y, 0)[1])

    stops.terminal, stops.direction = True, -1
    tau, y, sense, end = 0.0, np.zeros(4), 0, 2.0 * np.pi * periods
    while tau < end:
        part = solve_ivp(
            lambda t, y, s: np.concatenate((y[2:], acceleration(t, y, s)[0])), (tau, end), y, method="DOP853",
            events=stops, args=(sense,), rtol=1e-9, atol=1e-11, max_step=0.1,
        )  # fmt: skip
        tau, y = float(part.t[-1]), part.y[:, -1]
        y[3] = 0.0 if sense else y[3]  # the end of the last part is the one that is returned
        holding = acceleration(tau, y, 0)[1]
        slips = sense == 0 or abs(holding) > beta
        sense = int(np.sign(holding)) if slips else 0
    return y[:2]


@pytest.mark.parametrize(("r", "beta"), [(0.6, 0.8), (0.5, 0.8), (0.7, 0.9), (0.8, 0.9)])
def test_a_contact_comes_to_rest_where_the_motion_from_rest_leaves_it(r, beta):
    """The place has its own sign: which steady state is reached depends on the initial state."""
    m, k = np.array([1.0, 1.3]), np.array([[2.0, -1.0], [-1.0, 1.2]])
    load, contact = np.array([1.0, 0.3j]), fm.Contact(masses=2, law=FALLING)
    system = fm.System(
        matrices={"M": np.diag(m), "K": k, "C": 0.1 * k}, contacts=[contact], load_harmonics={1: load},
        frequency_scale=1.0, stiffness_scale=1.0,
    )  # fmt: skip
    found = from_rest(m, k, 0.1 * k, load, r, beta, contact.law, 12)
    cell = fm.response(system, r, beta)
    assert float(cell.stuck_fraction) == 1.0
    assert float(cell.midpoint[1]) == pytest.approx(found[1], abs=1e-6)
    assert abs(found[1]) > 0.01


@pytest.mark.parametrize(("law", "mu"), [(FALLING, 1.0), (FALLING, 2.0), (None, 2.0)])
def test_a_mass_at_its_limit_stays_at_rest(law, mu):
    """mu beta is the load: it holds, as |f| <= mu beta at rest, and rounding must not decide."""
    system = fm.System(
        matrices={"M": np.eye(1), "K": np.eye(1), "C": 0.06 * np.eye(1)}, contacts=[fm.Contact(law=law)],
        load_harmonics={1: [1.0], 3: [0.25j]}, frequency_scale=1.0, stiffness_scale=1.0,
    )  # fmt: skip
    r = np.linspace(0.1, 2.0, 20)
    beta = float(fm.boundaries(system, r, [mu]).beta_stick.max())
    ds = fm.sweep(system, r, [beta], mu=[mu], outputs=["regime", "contact_amplitude"])
    assert (ds.regime == fm.regimes.PERMANENT_STICKING).all()
    assert float(ds.contact_amplitude.max()) == 0.0
    curves = fm.curves(system, r, [beta], mu=[mu])
    assert float(curves.contact_amplitude.max()) == 0.0
    for one in r[::5]:
        cell = fm.response(system, one, beta, mu)
        assert float(cell.regime) == fm.regimes.PERMANENT_STICKING
        assert float(cell.amplitude[0]) < 1e-12  # accelerations that cancel, over r^2


def reference_system(row):
    """System of a row of laws.json, its friction as forces."""
    contacts = []
    for one in row["contacts"]:
        vector = np.array(one["c"])
        masses = np.flatnonzero(vector)
        law = None
        if "law" in one:
            speed, factor = zip(*one["law"], strict=True)
            law = {"speed": speed, "factor": factor, "slope": one["slope_end"]}
        contacts.append(
            fm.Contact(
                "fixed-wall" if masses.size == 1 else "between-masses", (masses + 1).tolist(),
                force=one["beta"], mu=one["mu"], law=law,
                wall_speed=one.get("wall_speed", 0.0) * float(vector[masses[-1]]),
            )
        )  # fmt: skip
    loads = {int(n): [complex(*one) for one in load] for n, load in row["loads"].items()}
    matrices = {name: np.array(row[name], dtype=float) for name in "MCK"}
    return fm.System(
        matrices=matrices, contacts=contacts, load_harmonics=loads, frequency_scale=1.0, stiffness_scale=1.0
    )


@pytest.mark.reference
def test_reference_motions(reference_table):
    """Motions from rest of random systems, by two programs that agree to 5e-13."""
    table = reference_table("laws.json")
    rows = [*table["A"], *(row for row in table["examples"] if row["law"] == "A")]
    rows = [row for row in rows if row["load"] != "none" and row.get("note") != SEVERAL]
    assert len(rows) >= 20
    for row in rows:
        cell = fm.response(reference_system(row), row["r"], 1.0)
        period = row["period"]
        assert float(cell.period) == period
        assert ends(cell) == pytest.approx((*row["x_min"], *row["x_max"]), abs=1e-10)
        stops, crossings = (
            np.nan_to_num(np.atleast_1d(cell[name])) for name in ("stops_per_cycle", "segment_crossings")
        )
        assert (stops * period).tolist() == row["stops"]
        laws = ["law" in one for one in row["contacts"]]
        assert (crossings * period)[laws].tolist() == np.array(row["break_point_crossings"])[laws].tolist()
        assert np.atleast_1d(cell.work_friction) * period == pytest.approx(row["work"], abs=1e-10)
        assert np.atleast_1d(cell.stuck_fraction) == pytest.approx(row["stuck_fraction"], abs=1e-7)
        assert float(cell.multiplier) == pytest.approx(row["multiplier"], abs=1e-10)


def from_state(system, r, x, rate, tau):
    """The steady state that the motion from a state at a phase reaches: extremes, period, counters."""
    problem, modal = problem_of(system.at_frequency(r), np.array([r]), 1.0)
    kinetic, static = friction_lines(system, np.array([1.0]))
    start = np.zeros((3, x.size))
    start[0], start[1], start[2] = modal.phi.T @ modal.mass @ x, modal.phi.T @ modal.mass @ rate, tau
    found = recorded_state(
        problem,
        0,
        Friction(kinetic.sum(axis=1), static[0].sum(axis=1)),
        start,
        (2000, 1e-12),
        Memory(problem, modal.phi, 64),
    )
    return found.record.ranges[:, kinetic.shape[0] :], found.found.halves // 2, found.counts


@pytest.mark.reference
def test_reference_motions_from_other_starts(reference_table):
    """Of several steady states the listed one is that of the motion from the listed start."""
    rows = [row for row in reference_table("laws.json")["A"] if row.get("note") == SEVERAL]
    assert len(rows) >= 4
    for row in rows:
        begin = row["start"]
        ranges, period, counts = from_state(
            reference_system(row), row["r"], np.array(begin["x"]), np.array(begin["dx_dtau"]), begin["tau"]
        )
        assert period == row["period"]
        assert ranges.ravel() == pytest.approx((*row["x_min"], *row["x_max"]), abs=1e-10)
        assert counts[STOPS].tolist() == row["stops"]
        assert counts[CROSSINGS].tolist() == row["break_point_crossings"]


def slopes_of(system):
    ds = fm.boundaries(system, [0.5])
    return float(ds.beta_slope_lim), float(ds.beta_slope_certificate)


def two_masses(**more):
    """Two masses whose damping is not proportional, a contact on the second one."""
    k, c = np.array([[2.4, -1.1], [-1.1, 1.3]]), np.array([[0.2, -0.05], [-0.05, 0.1]])
    contact = fm.Contact(masses=2, law=FALLING, **more)
    return fm.System(
        matrices={"M": np.diag([1.0, 1.6]), "K": k, "C": c}, contacts=[contact],
        load_harmonics={1: [0.5, 1.0]}, frequency_scale=1.0, stiffness_scale=1.0,
    )  # fmt: skip


def test_the_damping_of_one_mass_limits_the_slope():
    """2 zeta + beta g' > 0."""
    assert slopes_of(one_mass(FALLING, 0.04)) == pytest.approx((0.08, 0.08), rel=1e-12)


def test_the_slope_at_which_steady_sliding_loses_stability():
    """Eigenvalues on both sides of the limit; the certificate is where C - b c c^T becomes singular."""
    system = two_masses()
    limit, certificate = slopes_of(system)
    m, c, k = (getattr(system.modes, name) for name in ("mass", "damping", "stiffness"))
    for share, stable in ((1.0 - 1e-6, True), (1.0 + 1e-6, False)):
        fallen = c - share * limit * np.diag([0.0, 1.0])
        inverse = np.linalg.inv(m)
        first = np.block([[np.zeros((2, 2)), np.eye(2)], [-inverse @ k, -inverse @ fallen]])
        assert (np.linalg.eigvals(first).real.max() < 0.0) == stable
    assert abs(np.linalg.det(c - certificate * np.diag([0.0, 1.0]))) < 1e-14
    assert certificate < limit


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_one_way_sliding_begins_at_the_wall_speed_limit(sense):
    limit = float(fm.response(two_masses(wall_speed=sense), 0.8, 0.3).wall_speed_lim)
    regimes = [
        float(fm.response(two_masses(wall_speed=sense * share * limit), 0.8, 0.3).segment_crossings)
        for share in (1.0 + 1e-4, 1.0 - 1e-4)
    ]
    assert regimes[0] == 0.0
    assert regimes[1] > 0.0


@pytest.mark.reference
def test_reference_slopes(reference_table):
    """Limits of random structures, by two programs."""
    for row in reference_table("laws.json")["critical_slope"]:
        vector = np.array(row["c"])
        masses = (np.flatnonzero(vector) + 1).tolist()
        kind = "fixed-wall" if len(masses) == 1 else "between-masses"
        matrices = {name: np.array(row[name], dtype=float) for name in "MCK"}
        system = fm.System(
            matrices=matrices, contacts=[fm.Contact(kind, masses, law=FALLING)], frequency_scale=1.0,
            stiffness_scale=1.0, load_harmonics={1: np.ones(vector.size)},
        )  # fmt: skip
        assert slopes_of(system) == pytest.approx((row["beta_slope"], row["certificate"]), rel=1e-11)
