"""Maps and responses of structures: 40-digit values, a slow independent reference, invariants."""

import math
from itertools import pairwise

import numpy as np
import pytest
from kernels import callable_kernel
from outputs import OUTPUTS as PLAIN
from structures import chain, random_chain

import frictionmap as fm
from benchmarks.references.naive import Motion, Structure, naive_steady_state
from frictionmap import regimes
from frictionmap._kernels import closed_form
from frictionmap._kernels.engine import segment_table
from frictionmap._kernels.engine.time_history import Samples, sample_segments
from frictionmap._kernels.structure import oscillators
from frictionmap._kernels.structure.newton import make_workspace
from frictionmap._kernels.structure.oscillators import COLUMNS, WW, WZ, ZW, ZZ, D, K, make_scratch
from frictionmap._kernels.structure.state import make_structure
from frictionmap.model.held_structure import held_structure
from frictionmap.single.cells import Cells
from frictionmap.single.motion import MotionRequest, _find

decay = callable_kernel(closed_form.decay)
fill_steps = callable_kernel(oscillators.fill_steps)

OUTPUTS = (*PLAIN, "multiplier", "asymmetry", "amplitude")

#: 22-digit steady states from rest, 40-digit event-driven marching; for a checkout without the reference.
TABLE = (
    # contact, load, gamma, kappa, zeta, mu, r, beta, stops, Z, share stuck, max |x_k|
    (
        ("wall", 2), 1, (1, 1, 1), (1, 1, 1), 0.05, 1.5, 0.729, 0.2015, 2, 0.3280714247568952322,
        0.2390331774950027, (0.48443392, 0.32807142, 0.78835606),
    ),
    (
        ("wall", 1), 1, (1,) * 5, (1,) * 5, 0.1, 2.0, 0.46, 0.2021, 2, 0.5048697237111875156,
        0.3231489956378937, (0.50486972, 0.21815491, 0.49068378, 0.87180679, 1.11253659),
    ),
    (
        ("base", 1), 1, (1, 1), (1, 1), 0.05, 1.5, 0.694, 0.6161, 2, 1.399391216573382855,
        0.1866522580385208, (1.12259371, 1.90836551),
    ),
    (
        ("base", 2), 1, (1, 0.8, 1.7), (1, 2, 0.6), 0.05, 1.15, 0.538, 1.556, 2, 0.4948353736745304359,
        0.3661118447780609, (0.90973029, 0.59699059, 3.14977355),
    ),
    (
        ("masses", 1, 2), 1, (1, 0.5), (1, 0.5), 0.05, 1.0, 0.504, 0.1887, 2, 0.140032063676292020,
        0.5273551344871521, (1.60426693, 1.61364053),
    ),
)  # fmt: skip


def steady(system, r, beta, mu=1.0, **settings):
    """One cell of a map with every output, as plain numbers."""
    ds = fm.sweep(system, [r], [beta], [mu], outputs=OUTPUTS, threads=1, **settings)
    return {name: ds[name].values[0, 0, 0] for name in OUTPUTS}


def compare(found, stops, amplitude, stuck, masses):
    """Tolerances of the reference: its masses' maxima are sampled, to some 1e-8."""
    assert found["stops_per_cycle"] == stops
    assert found["contact_amplitude"] == pytest.approx(amplitude, rel=1e-9)
    assert found["stuck_fraction"] == pytest.approx(stuck, abs=1e-7)
    assert found["amplitude"] == pytest.approx(masses, abs=1e-7 * max(masses))


@pytest.mark.plain
@pytest.mark.parametrize("row", TABLE)
@pytest.mark.parametrize("settings", [{}, {"skip": "none"}, {"steady": "marched"}, {"steps": 7}])
def test_table(row, settings):
    contact, load, gamma, kappa, zeta, mu, r, beta, *expected = row
    system = chain({"contact": contact, "load": load, "gamma": gamma, "kappa": kappa}, zeta)
    compare(steady(system, r, beta, mu, **settings), *expected)


@pytest.mark.parametrize("skip", ["exact", "none"])
def test_reference_rows(all_steady, skip):
    """Rows with status ok, one mass included: stops equal, Z to 1e-9, masses to 1e-7; stuck ones stuck."""
    systems, rows = all_steady
    seen = 0
    for row in rows:
        system = chain(systems[row["system"]], float(row["zeta"]))
        found = steady(system, float(row["r"]), float(row["beta"]), float(row["mu"]), skip=skip)
        if row["status"] == "stuck":
            assert found["regime"] == regimes.PERMANENT_STICKING, row
        if row["status"] == "ok":
            seen += 1
            masses = [float(x) for x in row["X"]]
            compare(found, row["stops"], float(row["Z"]), float(row["stuck_fraction"]), masses)
    assert seen > 90


def change_over_a_period(entry, zeta, system, r, beta, mu):
    """Largest change of the state over a period of the steady state, followed by the slow reference."""
    found = fm.response(system, r, beta, mu, points=4)
    structure = Structure(zeta=zeta, r=r, **entry)
    motion = Motion(structure, beta, mu, 400)
    x, v = found.x.values[:, 0], found.v.values[:, 0].copy()
    if found.direction[0] == 0:  # it recognises a stop by a velocity of exactly zero
        v -= structure.to_contact * (structure.velocity_row @ np.concatenate((x, v, [1.0, 0.0, 0.0])))
    motion.begin(x, v)
    for _ in range(int(found.period)):
        motion.period()
    return np.abs(motion.state() - np.concatenate((x, v))).max() / np.abs(x).max()


@pytest.mark.slow
def test_unconverged_reference_rows(all_steady):
    """Rows that marching in 40-digit arithmetic left unfinished are solved: the state returns to 1e-12.

    One of them, mu = 2, has period 11, longer than the marching knew; its stops were not counted.
    """
    systems, rows = all_steady
    long = []
    for row in rows:
        if row["status"] != "unconverged":
            continue
        entry = systems[row["system"]]
        zeta, *cell = (float(row[name]) for name in ("zeta", "r", "beta", "mu"))
        system = chain(entry, zeta)
        found = steady(system, *cell)
        assert found["status"] == regimes.RESOLVED, row
        if found["period"] > 8:
            long.append(row["residual"])
        else:
            assert found["stops_per_cycle"] == row["stops"], row
        entry = {name: entry[name] for name in ("contact", "load")} | {
            name: tuple(map(float, entry[name])) for name in ("gamma", "kappa")
        }
        assert change_over_a_period(entry, zeta, system, *cell) < 1e-12, row
    assert long == ["1.83"]


def test_solved_states_return():
    """Steady states of random chains return after their period to 1e-12, followed by the slow reference."""
    rng = np.random.default_rng(21)
    seen = 0
    while seen < 30:
        zeta = float(rng.choice([0.0, 0.01, 0.3, 1.7]))
        system, entry = random_chain(rng, zeta)
        mu, r = float(rng.choice([1.0, 1.0, 1.2, 2.0])), float(rng.uniform(0.2, 2.0))
        beta = float(rng.uniform(0.02, 0.99)) * fm.boundaries(system, [r]).beta_stick.item()
        found = steady(system, r, beta, mu)
        if found["status"] == regimes.RESOLVED and found["regime"] == regimes.STICK_SLIP:
            seen += 1
            change = change_over_a_period(entry, zeta, system, r, beta, mu)
            assert change < 1e-12 * max(1.0, 1.0 / found["amplitude"].max()), (entry, zeta, r, beta, mu)


@pytest.mark.slow
def test_random_cells_against_the_slow_reference():
    """100 random damped cells: nothing in common with the reference but the equations of motion."""
    rng = np.random.default_rng(11)
    compared = 0
    for _ in range(100):
        zeta = float(rng.choice([0.03, 0.1, 0.5, 1.0, 1.7]))
        system, entry = random_chain(rng, zeta)
        mu = float(rng.choice([1.0, 1.2, 2.0]))
        r = float(rng.uniform(0.2, 2.0))
        beta = float(rng.uniform(0.02, 1.05)) * fm.boundaries(system, [r]).beta_stick.item()
        slow = naive_steady_state(zeta=zeta, r=r, beta=beta, mu=mu, cycles=600, tol=1e-10, **entry)
        found = steady(system, r, beta, mu)
        cell = (entry, zeta, mu, r, beta)
        if slow.status == "stuck":
            assert found["regime"] == regimes.PERMANENT_STICKING, cell
        if slow.status != "ok":
            continue
        compared += 1
        assert found["stops_per_cycle"] == slow.stops, cell
        # the reference waits until its state repeats to 1e-10: slow modes may still be on their way
        assert found["contact_amplitude"] == pytest.approx(slow.Z, rel=1e-7, abs=1e-8 * max(slow.X)), cell
        assert found["amplitude"] == pytest.approx(slow.X, abs=1e-5 * max(slow.X)), cell
        assert found["stuck_fraction"] == pytest.approx(slow.stuck_fraction, abs=1e-4), cell
    assert compared > 70


@pytest.mark.plain
@pytest.mark.parametrize("contact", ["fixed-wall", "joined-base-wall"])
@pytest.mark.parametrize("zeta", [0.0, 0.03, 1.0, 2.0])
@pytest.mark.parametrize("start", ["rest", "moving"])
def test_one_mass_by_the_code_for_many(contact, zeta, start):
    """Both kernels give the same map; asking for the amplitude of the mass takes the one for structures."""
    rng = np.random.default_rng(5)
    system = fm.System(contact=contact, damping_ratios=zeta)
    grid = {
        "r": np.sort(rng.uniform(0.1, 2.5, 12)),
        "beta": np.sort(rng.uniform(0.0, 1.5 if contact == "fixed-wall" else 4.0, 12)),
        "mu": [1.0, 1.5],
    }
    one = fm.sweep(system, **grid, start=start, outputs=PLAIN)
    many = fm.sweep(system, **grid, start=start, outputs=OUTPUTS)
    both = ((one.status == 0) & (many.status == 0)).values
    assert both.mean() > 0.97
    np.testing.assert_array_equal(one.regime.values[both], many.regime.values[both])
    for name in ("stops_per_cycle", "contact_amplitude", "stuck_fraction"):
        np.testing.assert_allclose(many[name].values[both], one[name].values[both], rtol=1e-6, atol=1e-9)
    z = one.contact_amplitude.values[both]
    np.testing.assert_allclose(many.contact_amplitude.values[both], z, rtol=1e-10, atol=1e-12)
    if contact == "fixed-wall":
        np.testing.assert_allclose(many.amplitude.values[..., 0][both], z, rtol=1e-10, atol=1e-12)


def held_cases():
    """Frequencies, damping ratios and participations; critical damping leaves nearly real pairs of roots."""
    w, chi = np.array([0.4, 1.1, 1.7, 2.6]), np.array([0.7, -0.4, 1.1, 0.2])
    for zeta in (0.0, 0.02, 0.7, 1.0, 1.5, [0.1, 1.0, 3.0, 0.0]):
        yield w, np.broadcast_to(np.asarray(zeta, dtype=float), w.shape).copy(), chi
    yield np.array([1.0, 2.0]), np.array([0.9999996, 0.9999996]), np.array([1.0, 1.0])
    gamma = (
        1.0,
        0.5043345433309722,
        4.132522213002301,
        1.0611386323347798,
        4.122176074441159,
        0.318155182948,
    )
    kappa = (1.0, 0.53451269100158, 1.040433105848468, 4.321235096920506, 1.2894117514999355, 2.04761613668)
    modes = chain({"contact": ("base", 1), "load": 1, "gamma": gamma, "kappa": kappa}, 1.0).modes
    yield modes.w, modes.zeta, modes.chi


@pytest.mark.parametrize("case", list(held_cases()))
def test_held_structure(case):
    """Its motions leave the contact alone, obey the equations of motion, and are all there are."""
    w, zeta, chi = case
    held = held_structure(w, zeta, chi)
    n, m = w.size, w.size - 1
    assert np.max(np.abs(held.to_held @ held.to_free - np.eye(2 * m))) < 1e-12
    assert np.max(np.abs(chi @ held.to_free[:n])) < 1e-13
    assert np.max(np.abs(chi @ held.to_free[n:])) < 1e-13
    # y'' = -omega^2 y - 2 zeta omega y' in every column: u'' + 2 zeta w u' + w^2 u is along chi
    flow = np.block(
        [
            [np.zeros((m, m)), np.eye(m)],
            [-np.diag(held.omega**2), -np.diag(2.0 * held.zeta * held.omega)],
        ]
    )
    u, v = held.to_free[:n], held.to_free[n:]
    rate = held.to_free @ flow
    np.testing.assert_allclose(rate[:n], v, atol=1e-12)
    left = rate[n:] + (2.0 * zeta * w)[:, np.newaxis] * v + (w**2)[:, np.newaxis] * u
    along = np.outer(chi, chi @ left) / (chi @ chi)
    np.testing.assert_allclose(left, along, atol=1e-11)
    assert chi @ held.static_shape == pytest.approx(1.0, rel=1e-14)


def gauss_samples(system, r, beta, mu):
    """Weights, times, velocities of the masses and of the contact, friction: Gauss points in every phase."""
    solver = fm.Solver()
    cells = Cells(system, np.array([r]), np.array([beta]), np.array([mu]), solver)
    request = MotionRequest(system, r, beta, mu, solver, 2)
    rows = _find(request, cells).table
    found = cells.structure_arrays
    x, weight = np.polynomial.legendre.leggauss(12)
    begins = np.concatenate(([0.0], np.cumsum(rows[:, segment_table.LENGTH])))
    panels = [np.linspace(left, right, 41) for left, right in pairwise(begins)]
    left = np.concatenate([edges[:-1] for edges in panels])[:, np.newaxis]
    width = np.concatenate([np.diff(edges) for edges in panels])[:, np.newaxis]
    since = (left + 0.5 * width * (1.0 + x)).ravel()
    n = found.participating.size
    st = make_structure(found.model, found.loads, 0, r, 24.0)
    coordinates, velocities = np.empty((2, n, since.size))
    z, friction = np.empty((2, since.size))
    samples = Samples(coordinates, velocities, z, friction, np.empty(since.size, dtype=np.int8))
    sample_segments(st, beta, rows, since, samples, make_workspace(n), make_scratch(n))
    sign = rows[0, segment_table.SIGN]
    tau = since + math.atan2(sign * rows[0, segment_table.SIN], sign * rows[0, segment_table.COS])
    relative = found.outputs.free[:, : velocities.shape[0]] @ velocities  # to the base, if it moves
    return (0.5 * width * weight).ravel(), tau, relative, friction


@pytest.mark.plain
@pytest.mark.parametrize("case", range(20))
def test_energy_over_a_period(case):
    """Work of the load = friction work + damping work, to 1e-10.

    Seen from the base the load on a joined base-wall is p - (K - r^2 M + i r C) ones, and the wall at rest.
    """
    rng = np.random.default_rng(case)
    system, _ = random_chain(rng, float(rng.choice([0.02, 0.3, 1.0, 1.4])))
    r = float(rng.uniform(0.3, 2.0))
    beta = float(rng.uniform(0.05, 0.8)) * fm.boundaries(system, [r]).beta_stick.item()
    weight, tau, v, friction = gauss_samples(system, r, beta, 1.2)
    modes = system.modes
    dynamic = modes.stiffness - r**2 * modes.mass + 1j * r * modes.damping
    phasor = modes.load + 1j * r * modes.load_rate - modes.base_motion * dynamic.sum(axis=1)
    load = (phasor[:, np.newaxis] * np.exp(1j * tau)).real
    work = weight @ np.sum(load * v, axis=0)
    rubbed = weight @ (friction * (modes.contact @ v))
    damped = weight @ (r * np.einsum("it,ij,jt->t", v, modes.damping, v))
    assert rubbed > 0.0
    assert damped > 0.0
    assert work == pytest.approx(rubbed + damped, rel=1e-10)


def test_responses_obey_the_equations():
    """x' is the derivative of x, and M x'' + C x' + K x + c f = p cos(tau) between events, by differences."""
    rng = np.random.default_rng(2)
    for _ in range(6):
        system, _ = random_chain(rng, float(rng.choice([0.0, 0.05, 1.2])) or 0.04)
        r = float(rng.uniform(0.4, 1.8))
        beta = 0.4 * fm.boundaries(system, [r]).beta_stick.item()
        ds = fm.response(system, r, beta, 1.2, points=8000)
        modes = system.modes
        tau, x, v = ds.tau.values, ds.x.values, ds.v.values
        h = tau[1] - tau[0]
        # differences of fourth order, where the five points lie in one phase
        same = (ds.direction.values[:-4] == ds.direction.values[4:]) & (
            ds.direction.values[:-4] == ds.direction.values[2:-2]
        )
        inside = np.flatnonzero(same) + 2

        def slope(y, inside=inside, h=h):
            return (y[:, :-4] - 8 * y[:, 1:-3] + 8 * y[:, 3:-1] - y[:, 4:])[:, inside - 2] / (12 * h)

        np.testing.assert_allclose(slope(x), v[:, inside], atol=1e-9 * np.abs(v).max())
        force = (
            r**2 * modes.mass @ slope(v) + r * modes.damping @ v[:, inside] + modes.stiffness @ x[:, inside]
            + np.outer(modes.contact, ds.friction.values[inside])
        )  # fmt: skip
        load = ((modes.load + 1j * r * modes.load_rate)[:, np.newaxis] * np.exp(1j * tau[inside])).real
        off = np.abs(force - load).max(axis=0)
        # an event between two samples of one phase (a slide that passes into the next) spoils a few
        assert np.quantile(off, 0.99) < 1e-7 * max(1.0, np.abs(load).max())
        z = modes.contact @ x - modes.base_motion * np.cos(tau)
        np.testing.assert_allclose(z, ds.z.values, atol=1e-12 * max(1.0, np.abs(x).max()))
        assert float(ds.contact_amplitude) == pytest.approx(np.abs(z).max(), rel=1e-5)


def test_undamped_map():
    """T Fig. 6.7, mu = 1, coarse: all resolved but r = 0, the held resonance r = 1, and r = 1/2 and 1/4.

    The natural frequencies differ by 1, which is 2 r and 4 r there: a continuum.
    """
    system = fm.System(mass_ratios=[1, 1], stiffness_ratios=[1, 1])
    r, beta = np.arange(51) / 20.0, np.arange(25) / 20.0  # a tie with beta_stick = 1 is one to the bit
    ds = fm.sweep(system, r, beta, outputs=PLAIN)
    unresolved = (ds.status != 0).any("beta").squeeze("mu")
    assert set(ds.r.values[unresolved.values]) <= {0.0, 0.25, 0.5, 1.0}
    smooth = ds.squeeze("mu")
    known = (smooth.r > 0.0) & (smooth.status == 0)
    stuck = (smooth.beta >= smooth.beta_stick).broadcast_like(smooth.regime) & known
    assert bool((smooth.regime.where(stuck, 0) == regimes.PERMANENT_STICKING).all())


def test_neighbours_help_and_change_nothing():
    """mu = 1: cells solved from their neighbours and cells solved alone are the same, undamped too."""
    for zeta in (0.0, 0.02):
        system = fm.System(
            contact_masses=[2], mass_ratios=[1, 2, 0.5], stiffness_ratios=[1, 0.5, 2], damping_ratios=zeta
        )
        r, beta = np.linspace(0.11, 2.4, 12), np.linspace(0.01, 1.5, 60)
        ds = fm.sweep(system, r, beta, outputs=PLAIN).squeeze("mu")
        solved = (ds.origin == regimes.PERIODIC_ORBIT).values
        assert np.mean(ds.cycles.values[solved] == 0.0) > 0.5  # most: nothing was followed
        for i, j in np.argwhere(solved)[::7]:
            alone = steady(system, r[i], beta[j])
            marched = steady(system, r[i], beta[j], steady="marched", cycles=20000)
            cell = ds.isel(r=i, beta=j)
            for other in (alone, marched):
                if other["status"] == regimes.RESOLVED:
                    assert cell.stops_per_cycle == other["stops_per_cycle"], (zeta, r[i], beta[j])
                    close = pytest.approx(other["contact_amplitude"], rel=1e-6, abs=1e-10)
                    assert float(cell.contact_amplitude) == close, (zeta, r[i], beta[j])


def test_continua_of_two_modes_are_named():
    """Two equal masses, w = (sqrt(5) -+ 1)/2: pairs at r = 1/2, and T(6.3.2) sqrt(5)/2 and sqrt(5)/4.

    There the continuous motion has a multiplier of modulus 1: a vibration of both modes that its turns leave
    alone.
    """
    system = fm.System(mass_ratios=[1, 1], stiffness_ratios=[1, 1])
    r = np.array([0.25, 0.5, math.sqrt(5.0) / 4.0, math.sqrt(5.0) / 2.0])
    for places, marginal in ((r, True), (r * (1.0 + 1e-6), False), (r + 0.01, False)):
        beta = 0.5 * fm.boundaries(system, places).beta_lim.values.min()
        ds = fm.sweep(system, places, [beta], outputs=("regime", "status", "multiplier"))
        assert bool((ds.regime == regimes.CONTINUOUS).all())
        assert bool(((ds.status == regimes.MARGINAL) == marginal).all())
        if marginal:
            np.testing.assert_allclose(ds.multiplier.values, 1.0, atol=1e-11)
    assert bool((ds.multiplier < 0.9999).all())


def test_a_held_contact_whose_load_repeats():
    """Undamped, r = 1/5 of the held frequency: a load that lets go in no period of both never will."""
    system = fm.System(mass_ratios=[1, 1], stiffness_ratios=[1, 1])
    for start in ("rest", "moving"):
        found = steady(system, 0.2, 0.98, mu=1.5, start=start)
        assert found["status"] in (regimes.RESOLVED, regimes.IRREGULAR)
        found = steady(system, 0.2, 0.96, start=start, skip="none")
        assert found["status"] == regimes.RESOLVED


def test_threads_and_steps_change_nothing():
    """Same bits for any number of threads; the same answers for any number of scan steps."""
    system = fm.System(
        contact_masses=[2], mass_ratios=[1, 2, 0.5], stiffness_ratios=[1, 0.5, 2], damping_ratios=0.02
    )
    grid = {"r": np.linspace(0.05, 2.5, 40), "beta": np.linspace(0.0, 2.0, 70), "mu": [1.0, 1.4]}
    one = fm.sweep(system, **grid, outputs=OUTPUTS, threads=1)
    two = fm.sweep(system, **grid, outputs=OUTPUTS, threads=2)
    for name in OUTPUTS:
        np.testing.assert_array_equal(one[name].values, two[name].values, err_msg=name)
    for steps in (5, 60):
        other = fm.sweep(system, **grid, outputs=OUTPUTS, steps=steps)
        both = ((one.status == 0) & (other.status == 0)).values
        assert both.mean() > 0.99
        same = (one.stops_per_cycle == other.stops_per_cycle) | one.stops_per_cycle.isnull()
        assert np.mean(same.values[both]) > 0.999  # with mu > 1 two steady states may lie close together
        close = np.isclose(one.contact_amplitude, other.contact_amplitude, rtol=1e-8, atol=1e-10)
        assert np.mean(close[both]) > 0.999


def test_a_stiff_link_acts_as_one_mass():
    """Two masses on a link of stiffness 1e6, its mode damped critically, move as one of their sum."""
    two = fm.System(mass_ratios=[1.0, 2.0], stiffness_ratios=[1.0, 1e6], damping_ratios=[0.03, 1.0])
    one = fm.System(damping_ratios=0.03)
    for r, beta in ((0.3, 0.5), (0.7, 0.6), (1.4, 0.3)):
        r_two = r / math.sqrt(3.0)
        linked, single = steady(two, r_two, beta, 1.2), steady(one, r, beta, 1.2)
        # at a turn the link lets the contact's own mass rest for as long as the link takes to relax
        assert linked["stuck_fraction"] == pytest.approx(single["stuck_fraction"], abs=2e-3)
        assert linked["contact_amplitude"] == pytest.approx(single["contact_amplitude"], rel=2e-3)


def test_scaling_and_renumbering():
    """Units of force, mass and stiffness, and the order of the masses, change nothing."""
    mass = np.diag([1.0, 0.7, 1.9])
    stiffness = np.array([[2.3, -1.3, 0.0], [-1.3, 1.9, -0.6], [0.0, -0.6, 0.6]])
    plain = fm.System(
        matrices={"M": mass, "K": stiffness}, contact_masses=[2], load_mass=3, damping_ratios=0.05,
        frequency_scale=1.0,
    )  # fmt: skip
    other = fm.System(
        matrices={"M": 250.0 * mass, "K": 4000.0 * stiffness}, contact_masses=[2], load_mass=3,
        damping_ratios=0.05, frequency_scale=4.0, stiffness_scale=4000.0,
    )  # fmt: skip
    order = [2, 0, 1]
    turned = fm.System(
        matrices={"M": mass[np.ix_(order, order)], "K": stiffness[np.ix_(order, order)]}, contact_masses=[3],
        load_mass=1, damping_ratios=0.05, frequency_scale=1.0,
    )  # fmt: skip
    for r, beta, mu in ((0.5, 0.2, 1.0), (0.9, 0.1, 1.5), (1.6, 0.3, 1.2)):
        a, b, c = (steady(system, r, beta, mu) for system in (plain, other, turned))
        for name in ("regime", "stops_per_cycle"):
            np.testing.assert_array_equal(a[name], b[name])
            np.testing.assert_array_equal(a[name], c[name])
        assert b["amplitude"] == pytest.approx(a["amplitude"], rel=1e-9)
        assert c["amplitude"] == pytest.approx(a["amplitude"][order], rel=1e-9)


def test_unseen_modes():
    """Two equal pendants on one mass: the mode in which they swing against each other is not seen."""
    mass = np.diag([1.0, 0.5, 0.5])
    stiffness = np.array([[3.0, -1.0, -1.0], [-1.0, 1.0, 0.0], [-1.0, 0.0, 1.0]])
    system = fm.System(matrices={"M": mass, "K": stiffness}, frequency_scale=1.0, load_mass=1)
    assert np.sum(system.modes.chi == 0.0) == 1
    found = steady(system, 0.8, 0.3)
    assert found["status"] == regimes.RESOLVED
    assert found["amplitude"][1] == pytest.approx(found["amplitude"][2], rel=1e-12)
    single = fm.System(mass_ratios=[1.0, 1.0], stiffness_ratios=[1.0, 2.0])
    alone = steady(single, 0.8, 0.3)
    assert found["contact_amplitude"] == pytest.approx(alone["contact_amplitude"], rel=1e-9)


@pytest.mark.plain
@pytest.mark.parametrize("zeta", [0.0, 0.3, 1.0, 2.0])
def test_decay_is_what_the_oscillators_do(zeta):
    """The step's map against the closed form T(B.8)."""
    table = np.zeros((2, COLUMNS))
    turn = 0.2
    table[0, K], table[0, D] = turn**2, 2.0 * zeta * turn
    fill_steps(table, 0.1, 20)
    q, e = decay(zeta, turn)
    expected = [e + 2.0 * zeta * q, q / turn, -q * turn, e]
    assert [table[0, column] for column in (ZZ, ZW, WZ, WW)] == pytest.approx(expected, rel=1e-14)


def test_special_frequencies():
    """At and next to natural and held frequencies and their sub-multiples: no hole without a status."""
    for zeta, allowed in (
        (0.01, {0}),
        (0.0, {0, regimes.MARGINAL, regimes.NOT_REACHED, regimes.IRREGULAR}),
    ):
        system = fm.System(
            contact_masses=[2], mass_ratios=[1, 0.7, 1.6], stiffness_ratios=[1, 1.3, 0.6], damping_ratios=zeta
        )
        places = np.concatenate((system.modes.w, system.modes.held_frequencies()))
        off = np.array([0.0, 1e-12, -1e-12, 1e-9, -1e-9, 1e-6, -1e-6, 1e-3, -1e-3])
        r = np.unique(np.multiply.outer(np.divide.outer(places, [1, 2, 3, 4]), 1.0 + off))
        ds = fm.sweep(system, r, [0.1, 0.4, 0.9], outputs=(*PLAIN, "amplitude"), cycles=1000)
        status = ds.status.values
        assert set(np.unique(status)) <= allowed
        assert np.mean(status == 0) > 0.95
        good = status == 0
        assert np.all(ds.regime.values[good] >= 0)
        assert not np.any(np.isnan(ds.contact_amplitude.values[good]))
        assert not np.any(np.isnan(ds.amplitude.values[good]))
        # 1e-12 apart nothing jumps, but for what a pole of that width does
        if zeta > 0.0:
            near = np.flatnonzero(np.diff(r) < 3e-12 * r[1:])
            z = ds.contact_amplitude.values[0]
            np.testing.assert_allclose(z[near], z[near + 1], rtol=1e-8, atol=1e-9)


def test_very_low_frequencies_are_refused():
    with pytest.raises(fm.InputError, match="r must be 0, or >= "):
        fm.boundaries(fm.System(mass_ratios=[1, 1], stiffness_ratios=[1, 1]), [1e-9])
