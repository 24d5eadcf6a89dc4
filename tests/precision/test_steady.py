"""Steady states against 40-digit values, a slow independent reference, and each other."""

import math

import numpy as np
import pytest

import frictionmap as fm
from benchmarks.measures.own_entry import own_entry
from benchmarks.peers.body import load_in_contact
from benchmarks.references.naive import naive_steady_state
from benchmarks.references.settled import settle
from frictionmap import regimes
from frictionmap._kernels.one_mass.events import after_slide, slide
from frictionmap._kernels.one_mass.scan_step import step_constants
from frictionmap._kernels.taylor_series import MAX_TERMS
from frictionmap.files.summary import describe_response


@own_entry
def follow(step, b, mu_b, slides, work):
    """States at which the first 200 and the last slides of a motion from rest begin."""
    states = np.empty((201, 3))
    _, z, c, s, force, _ = after_slide(b, mu_b, 0.0, 1.0, 0.0)
    for k in range(slides):
        _, z, c, s = slide(step, b, z, 0.0, step.stiffness * force, c, s, 1e4, work)
        _, z, c, s, force, _ = after_slide(b, mu_b, z, c, s)
        row = min(k, 200)
        states[row, 0] = z
        states[row, 1] = c
        states[row, 2] = s
    return states


CONTACT = {"wall": "fixed-wall", "base": "joined-base-wall"}
ALL = ("regime", "stops_per_cycle", "contact_amplitude", "stuck_fraction", "period", "origin", "status")


def cell(contact, r, beta, mu=1.0, zeta=0.0, **settings):
    """One cell of a map, as plain numbers."""
    system = fm.System(contact=CONTACT[contact], damping_ratios=zeta)
    ds = fm.sweep(system, [r], [beta], [mu], threads=1, outputs=ALL, **settings)
    return {name: ds[name].values.item() for name in ALL}


@pytest.mark.parametrize("steady", ["solved", "marched"])
@pytest.mark.parametrize("skip", ["exact", "none"])
def test_reference_rows(steady_rows, steady, skip):
    """Rows with status ok: stops equal, Z to 1e-10 relative, share stuck to 1e-9; stuck rows stuck."""
    seen = 0
    for row in steady_rows:
        contact = row["system"].removeprefix("sdof-")
        found = cell(
            contact, float(row["r"]), float(row["beta"]), float(row["mu"]), float(row["zeta"]),
            steady=steady, skip=skip,
        )  # fmt: skip
        if row["status"] == "stuck":
            assert found["regime"] == regimes.PERMANENT_STICKING, row
        if row["status"] != "ok":
            continue
        seen += 1
        assert found["stops_per_cycle"] == row["stops"], row
        assert found["contact_amplitude"] == pytest.approx(float(row["Z"]), rel=1e-10), row
        # float32 in the dataset: its rounding comes first
        assert found["stuck_fraction"] == pytest.approx(float(row["stuck_fraction"]), abs=6e-8), row
    assert seen >= 50


def test_share_stuck_of_reference_rows(steady_rows):
    """The share of time stuck to 1e-9, from the events of the response (maps store it in float32)."""
    for row in steady_rows:
        if row["status"] != "ok":
            continue
        system = fm.System(
            contact=CONTACT[row["system"].removeprefix("sdof-")], damping_ratios=float(row["zeta"])
        )
        ds = fm.response(system, float(row["r"]), float(row["beta"]), float(row["mu"]), points=2)
        tau = np.append(ds.event_tau.values, ds.event_tau.values[:1] + 2.0 * np.pi * int(ds.period))
        stuck = np.diff(tau)[ds.event_direction.values == 0].sum() / (2.0 * np.pi * int(ds.period))
        assert stuck == pytest.approx(float(row["stuck_fraction"]), abs=1e-9), row
        assert float(ds.contact_amplitude) == pytest.approx(float(row["Z"]), rel=1e-10), row


# fixed wall and joined base-wall, computed with references/naive.py at tolerance 1e-13 to ten digits
SMALL_TABLE = [
    ("wall", 0.3, 0.5, 1.0, 0.0, 2, 0.8256157755),
    ("wall", 0.303, 0.76, 1.5, 0.0, None, 0.0),
    ("base", 0.52, 0.06, 1.5, 0.0, 1, None),
]


@pytest.mark.parametrize(("contact", "r", "beta", "mu", "zeta", "stops", "amplitude"), SMALL_TABLE)
def test_small_table(contact, r, beta, mu, zeta, stops, amplitude):
    found = cell(contact, r, beta, mu, zeta)
    if stops is None:
        assert found["regime"] == regimes.PERMANENT_STICKING
    else:
        assert found["stops_per_cycle"] == stops
    if amplitude is not None:
        assert found["contact_amplitude"] == pytest.approx(amplitude, rel=1e-9, abs=1e-300)


def test_coexistence_depends_on_the_start():
    """theory.md 6: fixed wall, mu = 1.5: sticking from rest, sliding from a moving start."""
    assert cell("wall", 0.9, 0.7, 1.5)["regime"] == regimes.PERMANENT_STICKING
    assert cell("wall", 0.9, 0.7, 1.5, start="moving")["regime"] == regimes.CONTINUOUS
    assert cell("wall", 0.303, 0.76, 1.5)["regime"] == regimes.PERMANENT_STICKING
    sliding = cell("wall", 0.303, 0.76, 1.5, start="moving")
    assert sliding["stops_per_cycle"] == 2
    assert sliding["contact_amplitude"] == pytest.approx(0.853, abs=5e-4)


def test_dip_of_the_velocity_in_the_first_scan_step():
    """Joined base-wall, r = 0.48, beta = 0.07, mu = 1: a scan that looks at step ends only errs by 6e-5."""
    amplitudes = [cell("base", 0.48, 0.07, steps=steps)["contact_amplitude"] for steps in (4, 24, 96, 500)]
    slow = naive_steady_state(contact=("base", 1), r=0.48, beta=0.07, mu=1.0, points=800, cycles=4000)
    assert slow.status == "ok"
    assert amplitudes == pytest.approx([slow.Z] * 4, rel=1e-10)


@pytest.mark.parametrize("zeta", [0.0, 0.05, 1.0, 2.0])
def test_scan_steps_do_not_change_the_answer(zeta):
    """Events are certain and exact whatever the number of scan steps."""
    rng = np.random.default_rng(7)
    r = np.sort(rng.uniform(0.05, 2.5, 12))
    beta = np.sort(rng.uniform(0.01, 1.0, 12))
    system = fm.System(damping_ratios=zeta)
    fine = fm.sweep(system, r, beta, [1.0, 1.4], steps=200, outputs=ALL)
    for steps in (2, 3, 7, 24):
        ds = fm.sweep(system, r, beta, [1.0, 1.4], steps=steps, outputs=ALL)
        settled = (ds.status == 0) & (fine.status == 0)
        assert float(settled.mean()) > 0.97
        same = (ds.stops_per_cycle == fine.stops_per_cycle) | np.isnan(fine.stops_per_cycle)
        assert bool(same.where(settled, True).all())
        np.testing.assert_allclose(
            ds.contact_amplitude.where(settled), fine.contact_amplitude.where(settled), rtol=1e-10
        )


def _random_maps(count):
    """Small maps in and around the open strip, mu = 1 to 2, zeta = 0 to 2, both contacts."""
    rng = np.random.default_rng(20211)
    for _ in range(count):
        contact = ("wall", "base")[int(rng.integers(2))]
        zeta = float(rng.choice([0.0, 0.01, 0.1, rng.uniform(0.0, 1.0), rng.uniform(1.0, 2.0)]))
        mu = float(rng.choice([1.0, 1.0, 1.2, 1.5, 2.0, rng.uniform(1.0, 2.0)]))
        system = fm.System(contact=CONTACT[contact], damping_ratios=zeta)
        r = np.sort(rng.uniform(0.08, 2.5, 3))
        ends = fm.boundaries(system, r, mu).isel(mu=0)
        stick = rng.choice(ends.beta_stick.values, 6)
        yield contact, system, r, np.sort(rng.uniform(0.0, 1.05, 6) * stick), mu, ends


def _settled(contact, zeta, r, beta, mu):
    load, phase = load_in_contact(CONTACT[contact], r, zeta)
    return settle(r, zeta, load, phase, beta, mu, 4000, 1e-12)


@pytest.mark.slow
def test_random_cells_against_an_event_exact_reference():
    """4,320 random cells, three ways: stops equal everywhere but within 1e-6 of a boundary; Z, share stuck.

    The reference is event-exact and has nothing but the equation of motion in common with the package.  Cells
    that it cannot settle within 4,000 periods count as neither; they are few.
    """
    compared = 0
    for contact, system, r, beta, mu, ends in _random_maps(240):
        ways = [
            fm.sweep(system, r, beta, mu, threads=1, outputs=ALL, **settings).isel(mu=0)
            for settings in ({}, {"steady": "marched"}, {"skip": "none"})
        ]
        for i, j in np.ndindex(r.size, beta.size):
            reference = _settled(contact, system.zeta, r[i], beta[j], mu)
            edges = ends.beta_lim.values[i], ends.beta_stick.values[i]
            if not reference.period or min(abs(beta[j] / edge - 1.0) for edge in edges) < 1e-6:
                continue
            compared += 1
            for ds in ways:
                found = {name: ds[name].values[i, j].item() for name in ALL}
                where = (contact, system.zeta, r[i], beta[j], mu, found, reference)
                if math.isnan(reference.stops):
                    assert found["regime"] == regimes.PERMANENT_STICKING, where
                    continue
                if found["status"] == regimes.MARGINAL:
                    continue  # the steady state depends on the start there
                assert found["status"] == regimes.RESOLVED, where
                stops = pytest.approx(reference.stops, rel=1e-6)  # of a float32: 4 stops in 3 periods
                assert found["stops_per_cycle"] == stops, where
                assert found["contact_amplitude"] == pytest.approx(reference.amplitude, rel=2e-9), where
                assert found["stuck_fraction"] == pytest.approx(reference.stuck_fraction, abs=2e-7), where
    assert compared >= 4200


def test_both_references_agree():
    """What the random cells are compared with, against a slow one that shares not even its series."""
    compared = 0
    for contact, system, r, beta, mu, _ in _random_maps(40):
        zeta = system.zeta
        one = _settled(contact, zeta, r[0], beta[3], mu)
        other = naive_steady_state(
            contact=(contact, 1), r=r[0], beta=beta[3], mu=mu, zeta=zeta, points=60, cycles=300, tol=1e-10
        )
        if other.status == "stuck":
            assert math.isnan(one.stops)
        if other.status != "ok" or other.margin < 1e-6 or not one.period:
            continue
        compared += 1
        assert one.stops == pytest.approx(other.stops, rel=1e-6)
        # the slow one settles to 1e-10, and a slow approach makes that ten times as much
        assert one.amplitude == pytest.approx(other.Z, rel=1e-8, abs=1e-9)
        assert one.stuck_fraction == pytest.approx(other.stuck_fraction, abs=1e-6)
    assert compared >= 25


def test_marginal_continuum_is_named():
    """Undamped, r = 1/2, below beta_lim: T(3.33). Marching shows stops that die like n^-1/2; no answer."""
    system = fm.System()
    for skip, regime in (("exact", regimes.CONTINUOUS), ("none", regimes.UNRESOLVED)):
        ds = fm.sweep(system, [0.5], [0.05, 0.1, 0.2, 0.3], [1.0], skip=skip, outputs=ALL)
        assert np.all(ds.status == regimes.MARGINAL)
        assert np.all(ds.regime == regime)


def test_just_above_beta_lim():
    """Next to beta_lim a stop is shorter than rounding resolves, and marching creeps; 40-digit values."""
    found = cell("wall", 0.3, 0.046342464513956357, zeta=0.2)  # 1.0e-14 above beta_lim
    assert (found["regime"], found["stops_per_cycle"]) == (regimes.STICK_SLIP, 2.0)
    found = cell("wall", 0.1, 0.010102000000000002)
    assert (found["status"], found["stops_per_cycle"]) == (regimes.RESOLVED, 2.0)
    assert found["contact_amplitude"] == pytest.approx(1.01010101007651, rel=1e-14)
    # everywhere above it, for every damping: stick-slip, and few cells left over
    rng = np.random.default_rng(1)
    unresolved = cells = 0
    for zeta in (0.0, 0.01, 0.2, 3.0):
        for r in rng.uniform(0.05, 3.0, 20):
            system = fm.System(damping_ratios=zeta)
            lim = fm.boundaries(system, [r]).beta_lim.item()
            ds = fm.sweep(system, [r], lim * (1.0 + 10.0 ** -np.arange(14.0, 0.0, -1.0)), outputs=ALL)
            status = ds.status.values.ravel()
            assert np.all(ds.regime.values.ravel()[status == regimes.RESOLVED] == regimes.STICK_SLIP)
            unresolved += np.count_nonzero(status)
            cells += status.size
    assert unresolved < 0.01 * cells


def test_thousands_of_stops_in_a_period():
    """Undamped at low frequency, beta = 1/2: slides half of the time, to 1 - beta, one stop a free period."""
    for r in (1e-2, 1e-3, 1e-4):
        found = cell("wall", r, 0.5)
        assert (found["status"], found["period"]) == (regimes.RESOLVED, 1)
        assert found["stops_per_cycle"] == pytest.approx(0.5 / r)
        assert found["contact_amplitude"] == pytest.approx(0.5, rel=20.0 * r * r)


def test_no_drift_after_a_million_cycles():
    """An event is as exact at cycle 10^6 as at cycle 1."""
    system = fm.System()
    # found by no return (the marginal continuum), so that it is followed to the end
    ds = fm.sweep(system, [0.5], [0.2], [1.0], skip="none", cycles=1_000_000, outputs=("cycles", "status"))
    assert ds.cycles.item() >= 1_000_000
    # the load's phase does not accumulate: the times of a stop are those of the first cycles
    step = step_constants(0.3, 0.0, 24.0)
    work = np.empty(MAX_TERMS)
    states = follow(step, 0.5, 0.5, 2_000_000, work)
    np.testing.assert_allclose(states[-1], states[100], rtol=0.0, atol=4e-16 * 8)


def test_undamped_resonance():
    """r = 1, zeta = 0: unbounded below pi/4, finite above; propagation there is exact."""
    for contact in ("wall", "base"):
        for skip in ("exact", "none"):
            found = cell(contact, 1.0, 0.5, skip=skip)
            assert found["regime"] == regimes.CONTINUOUS
            assert math.isinf(found["contact_amplitude"])
        above = cell(contact, 1.0, 0.9)
        slow = naive_steady_state(contact=(contact, 1), r=1.0, beta=0.9, mu=1.0)
        assert slow.status == "ok"
        assert above["stops_per_cycle"] == slow.stops
        assert above["contact_amplitude"] == pytest.approx(slow.Z, rel=1e-9)


@pytest.mark.parametrize("offset", [10.0**-k for k in range(1, 17)])
def test_next_to_resonance_nothing_is_lost(offset):
    """Stick-slip amplitude is smooth through r = 1: no digit is lost to 1/(1 - r^2)."""
    middle = cell("wall", 1.0, 0.9)["contact_amplitude"]
    low, high = (cell("wall", 1.0 + sign * offset, 0.9)["contact_amplitude"] for sign in (-1.0, 1.0))
    # the mean of both sides differs from the middle by the curvature, of order one
    assert 0.5 * (low + high) == pytest.approx(middle, rel=10.0 * offset**2 + 2e-14)


def test_energy_over_a_steady_period():
    """Work of the load in the contact = friction work + damping work over a steady period."""
    for zeta, contact, r, beta, mu in (
        (0.0, "fixed-wall", 0.3, 0.5, 1.0),
        (0.05, "fixed-wall", 0.8, 0.3, 1.0),
        (0.1, "joined-base-wall", 1.4, 1.0, 1.3),
        (0.0, "joined-base-wall", 0.44, 0.04, 1.5),
    ):
        system = fm.System(contact=contact, damping_ratios=zeta)
        ds = fm.response(system, r, beta, mu, points=40000)
        tau = ds.tau.values
        z_rate = ds.v.values[0] + system.base_motion * np.sin(tau)
        load = (system.contact_load(np.array(r)) * np.exp(1j * tau)).real
        # z' = 0 at every event: the integrands are continuous, and trapezoids good to h^2
        work = np.trapezoid(load * z_rate, tau)
        damping = np.trapezoid(2.0 * zeta * r * z_rate**2, tau)
        slid = np.abs(np.diff(np.append(ds.event_z.values, ds.event_z.values[:1]))).sum()
        assert work == pytest.approx(beta * slid + damping, abs=3e-8)
        assert slid > 0.0


@pytest.mark.parametrize(
    ("contact", "r", "beta", "mu", "zeta"),
    [
        ("fixed-wall", 0.3, 0.5, 1.0, 0.0),
        ("fixed-wall", 0.07, 0.4, 1.0, 0.02),
        ("fixed-wall", 0.9, 0.2, 1.5, 0.0),
        ("joined-base-wall", 0.52, 0.06, 1.5, 0.0),
        ("joined-base-wall", 0.48, 0.07, 1.0, 0.0),
        ("joined-base-wall", 2.0, 3.0, 1.2, 0.3),
        ("joined-base-wall", 0.44, 0.04, 1.5, 0.0),
        ("fixed-wall", 0.6, 0.3, 1.0, 1.0),
        ("fixed-wall", 0.6, 0.3, 1.0, 3.0),
        ("fixed-wall", 0.9, 0.0, 1.0, 0.1),
        ("fixed-wall", 0.33, 0.015, 1.0, 0.0),
    ],
)
def test_response_satisfies_the_equation_of_motion(contact, r, beta, mu, zeta):
    """Differences of the sampled motion satisfy r^2 x'' + 2 zeta r x' + x + friction = cos(tau)."""
    system = fm.System(contact=contact, damping_ratios=zeta)
    ds = fm.response(system, r, beta, mu, points=20000)
    tau, x, v = ds.tau.values, ds.x.values[0], ds.v.values[0]
    h = tau[1]
    acceleration = (v[2:] - v[:-2]) / (2.0 * h)
    velocity = (x[2:] - x[:-2]) / (2.0 * h)
    same = (ds.direction.values[2:] == ds.direction.values[1:-1]) & (
        ds.direction.values[1:-1] == ds.direction.values[:-2]
    )
    residual = (
        r**2 * acceleration + 2.0 * zeta * r * v[1:-1] + x[1:-1] + ds.friction.values[1:-1]
        - np.cos(tau[1:-1])
    )  # fmt: skip
    fastest = max(1.0, 1.0 / r, 2.0 * zeta / r)
    bound = 20.0 * (h * fastest) ** 2 * max(1.0, np.abs(x).max())
    assert same.mean() > 0.99
    assert np.abs(residual[same]).max() < bound * max(1.0, r**2)
    assert np.abs(velocity - v[1:-1])[same].max() < bound * fastest
    # friction: the kinetic force against the motion, and at most mu times that in a stop
    sliding = ds.direction.values != 0
    np.testing.assert_allclose(
        ds.friction.values[sliding], beta * ds.direction.values[sliding], rtol=1e-12, atol=1e-15
    )
    assert np.abs(ds.friction.values).max() <= mu * beta * (1.0 + 1e-12) + 1e-15
    assert x[0] == pytest.approx(x[-1], rel=1e-11, abs=1e-13)


@pytest.mark.parametrize("case", [{"r": 1.0, "beta": 0.3}, {"r": 1.0, "beta": 0.0}])
def test_no_response_where_the_motion_is_unbounded(case):
    with pytest.raises(fm.NoSteadyState, match="without bound"):
        fm.response(fm.System(), **case)


def test_response_refuses_rest_of_time():
    with pytest.raises(fm.InputError, match="r must be > 0"):
        fm.response(fm.System(), 0.0, 0.5)


@pytest.mark.parametrize(
    ("contact", "r", "beta", "mu", "start", "outputs"),
    [
        ("joined-base-wall", 0.39, 0.0225, 1.5, "rest", ["regime"]),
        ("joined-base-wall", 0.39, 0.0225, 1.5, "moving", ["regime"]),
        ("joined-base-wall", 0.39, 0.0225, 1.5, "moving", ["amplitude"]),
    ],
)
def test_a_window_of_a_motion_that_does_not_repeat(contact, r, beta, mu, start, outputs):
    """Eight periods that obey the equation of motion, said to be a part; the scalars are the map's."""
    system = fm.System(contact)
    settings = {"start": start, "cycles": 300, "outputs": outputs}
    ds = fm.response(system, r, beta, mu, points=8000, **settings)
    assert int(ds.status) == regimes.IRREGULAR
    assert int(ds.period) == 0
    assert "irregular" in ds.attrs["comment"]
    assert "irregular" in describe_response(ds)
    assert "irregular" in fm.plot_response(ds)[0].figure.get_suptitle()
    tau, x, v = ds.tau.values, ds.x.values[0], ds.v.values[0]
    assert tau[-1] == pytest.approx(16.0 * np.pi)
    assert abs(x[-1] - x[0]) > 1e-6  # it does not come back
    acceleration = (v[2:] - v[:-2]) / (2.0 * tau[1])
    same = (ds.direction.values[2:] == ds.direction.values[1:-1]) & (
        ds.direction.values[1:-1] == ds.direction.values[:-2]
    )
    off = r**2 * acceleration + x[1:-1] + ds.friction.values[1:-1] - np.cos(tau[1:-1])
    assert np.abs(off[same]).max() < 1e-4
    inside = ds.event_tau.values
    assert np.all(np.diff(inside) >= 0.0)
    assert 0.0 <= inside[0] < inside[-1] <= tau[-1]
    for at, sense in zip(inside, ds.event_direction.values, strict=True):
        k = np.searchsorted(tau, at)
        assert sense in ds.direction.values[k : k + 2]
    cell = fm.sweep(
        system,
        [r],
        [beta],
        mu,
        **(settings | {"outputs": [*outputs, "stops_per_cycle", "contact_amplitude"]}),
    )
    for name in ("stops_per_cycle", "contact_amplitude"):
        assert float(ds[name]) == cell[name].item()
    assert np.abs(ds.z.values).max() <= cell.contact_amplitude.item() * (1.0 + 1e-12)


def test_response_reports_its_status():
    assert int(fm.response(fm.System(), 0.3, 0.5).status) == regimes.RESOLVED
    assert int(fm.response(fm.System(), 0.5, 0.1).status) == regimes.MARGINAL
    assert int(fm.response(fm.System(), 0.5, 0.1, outputs=["amplitude"]).status) == regimes.MARGINAL
    assert int(fm.response(fm.System(), 0.5, 2.0).status) == regimes.RESOLVED
