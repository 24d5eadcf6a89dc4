"""Contacts that close a loop: permanent sticking against linear programs over the cycle, and motions."""

from itertools import combinations

import numpy as np
import pytest
from general_systems import KINDS
from scipy.optimize import linprog

import frictionmap as fm
from frictionmap.general import loops
from frictionmap.general.held import half_range, independent_contacts

PAIRS = [(1, 2), (2, 3), (1, 3)]


def program(mass, stiffness, damping, w, load, r, limits):
    """Least scale for which forces within scale times the limits exist at every phase (720 of them)."""
    n, count = w.shape
    dynamic = stiffness - r * r * mass + 1j * r * damping
    kept = np.linalg.svd(w)[0][:, np.linalg.matrix_rank(w) :]  # motions that all contacts allow
    x = kept @ np.linalg.solve(kept.T @ dynamic @ kept, kept.T @ load)
    f = load - dynamic @ x  # = W F
    worst = 0.0
    for tau in np.linspace(0.0, np.pi, 720, endpoint=False):
        bounds = np.hstack((np.vstack((np.eye(count), -np.eye(count))), -np.tile(limits, 2)[:, np.newaxis]))
        one = linprog(
            [*np.zeros(count), 1.0], A_ub=bounds, b_ub=np.zeros(2 * count),
            A_eq=np.hstack((w, np.zeros((n, 1)))), b_eq=(f * np.exp(1j * tau)).real,
            bounds=[(None, None)] * (count + 1),
        )  # fmt: skip
        assert one.status == 0
        worst = max(worst, one.fun)
    return worst


def test_a_triangle():
    """Three unit masses, zeta 0.02: the cut of mass 1 decides."""
    system = fm.System(
        contacts=[fm.Contact("between-masses", pair) for pair in PAIRS], mass_ratios=[1, 1, 1],
        stiffness_ratios=[1, 1, 1], damping_ratios=0.02,
    )  # fmt: skip
    ds = fm.boundaries(system, [0.5], [1.0, 1.25])
    assert ds.beta_stick.values.ravel() == pytest.approx(0.992677024995 / np.array([1.0, 1.25]), abs=1e-12)
    assert set(ds.data_vars) == {"beta_stick"}


@pytest.mark.parametrize("seed", range(4))
def test_random_loops_against_linear_programs(seed):
    """Four masses; a triangle and two walls: two loops."""
    rng = np.random.default_rng(seed)
    mass, k = np.diag(rng.uniform(0.5, 2.0, 4)), rng.uniform(0.5, 2.0, 4)
    stiffness = np.diag(k + np.append(k[1:], 0.0)) - np.diag(k[1:], 1) - np.diag(k[1:], -1)
    damping = 0.05 * stiffness
    given, mus = rng.uniform(0.3, 1.5, 5), rng.uniform(1.0, 1.5, 5)
    places = [("between-masses", pair) for pair in PAIRS] + [("fixed-wall", (1,)), ("fixed-wall", (3,))]
    contacts = [
        fm.Contact(kind, at, ratio=b, mu=m) for (kind, at), b, m in zip(places, given, mus, strict=True)
    ]
    system = fm.System(
        contacts=contacts, matrices={"M": mass, "K": stiffness, "C": damping}, frequency_scale=1.0,
        load=rng.normal(size=4) + 1j * rng.normal(size=4),
    )  # fmt: skip
    w = system.general.vectors.T
    wanted = program(mass, stiffness, damping, w, np.array(system.load), 0.7, given * mus)
    found = fm.boundaries(system, [0.7]).beta_stick.item()
    assert wanted <= found * (1.0 + 1e-9)
    assert found == pytest.approx(wanted, rel=2e-5)  # 720 phases


def test_reference_loops(reference_table):
    for row in reference_table("contacts.json")["redundant"]:
        contacts = [
            fm.Contact(KINDS[kind], masses, ratio=ratio, mu=mu)
            for (kind, *masses), ratio, mu in zip(row["contacts"], row["ray"], row["mu"], strict=True)
        ]
        given = {key: np.array(row[name]) for key, name in (("M", "M"), ("K", "K"), ("C", "C1"))}
        system = fm.System(matrices=given, frequency_scale=1.0, contacts=contacts, load_mass=row["load"])
        assert fm.boundaries(system, [row["r"]]).beta_stick.item() == pytest.approx(
            row["scale_stick"], rel=1e-10
        )


def random_graph(rng):
    """W (n, N) of contacts between two to four masses and a wall, with loops."""
    n = int(rng.integers(2, 5))
    pairs = list(combinations(range(n + 1), 2))
    count = int(rng.integers(n + 1, min(len(pairs), n + 4) + 1))
    w = np.zeros((n + 1, count))
    for j, k in enumerate(rng.permutation(len(pairs))[:count]):
        w[list(pairs[k]), j] = -1.0, 1.0
    return w[1:]


@pytest.mark.parametrize("orders", [(1,), (1, 3)])
def test_the_worst_cut_from_instants(orders):
    """Against all elementary vectors; some friction is not the grid's, and may not grow with it."""
    rng = np.random.default_rng(len(orders))
    for case in range(12):
        w = random_graph(rng)
        count, held = w.shape[1], independent_contacts(w)
        forces = {n: np.zeros(count, dtype=complex) for n in orders}
        for force in forces.values():
            force[held] = rng.normal(size=len(held)) + 1j * rng.normal(size=len(held))
        own, slope = rng.uniform(0.0, 0.2, count) * (rng.random(count) < 0.3), rng.uniform(0.2, 1.5, count)
        slope[rng.integers(count)] *= case % 3 > 0
        vectors = loops.elementary_vectors(w)
        needed = half_range({n: (force @ vectors.T)[np.newaxis] for n, force in forces.items()})[0]
        with np.errstate(divide="ignore", invalid="ignore"):
            rest = np.maximum(needed - np.abs(vectors) @ own, 0.0)
            wanted = np.where(rest > 0.0, rest / (np.abs(vectors) @ slope), 0.0).max()
        assert loops._worst_cut(w, forces, own, slope) == pytest.approx(wanted, rel=1e-12)


def ring(sectors, friction, ground=(), factors=None, load_factors=None, engine_order=1, second=False, **disk):
    """A ring of blades on a disk, in contact with their neighbours, and with the ground; see `RINGS`."""
    from scipy.linalg import eigh

    n = sectors
    md, kb, kg, kc = (disk.get(name, default) for name, default in DISK.items())
    own = np.ones(2 * n) if factors is None else np.array(factors)
    mass = np.diag(np.append(np.ones(n), np.full(n, md)) * own)
    stiffness = np.diag(np.append(np.full(n, kb), np.full(n, kb + kg + 2.0 * kc)))
    for j in range(n):
        for a, b, k in ((j, n + j, kb), (n + j, n + (j + 1) % n, kc)):
            stiffness[a, b] -= k
            stiffness[b, a] -= k
    squares, phi = eigh(stiffness, mass)
    damping = mass @ phi @ np.diag(2.0 * 0.03 * np.sqrt(squares)) @ phi.T @ mass
    pairs = [(j + 1, (j + 1) % n + 1) for j in range(n)]
    contacts = [
        fm.Contact("between-masses", sorted(pair), ratio=b) for pair, b in zip(pairs, friction, strict=True)
    ]
    contacts += [fm.Contact("fixed-wall", j + 1, ratio=b) for j, b in enumerate(ground)]
    turn = np.exp(2j * np.pi * np.arange(n) / n)
    load = np.zeros((2, 2 * n), dtype=complex)
    load[0, :n] = turn**engine_order * (1.0 if load_factors is None else np.array(load_factors))
    load[1, :n] = 0.3 * np.exp(0.7j) * turn**2 * second
    size, phase = np.abs(load), np.degrees(np.angle(load))
    harmonics = [
        {"n": q + 1, "mass": k + 1, "amplitude": size[q, k], "phase_deg": phase[q, k]}
        for q, k in np.argwhere(load).tolist()
    ]
    given = {"M": mass, "K": stiffness, "C": damping}
    return fm.System(matrices=given, frequency_scale=1.0, contacts=contacts, load_harmonics=harmonics)


DISK = {"md": 2.0, "kb": 1.0, "kg": 0.5, "kc": 1.5}

OUTPUTS = (
    "contact_peak_to_peak", "stops_per_cycle", "turns_per_cycle", "stuck_fraction", "sliding_distance",
    "contact_regime",
)  # fmt: skip

#: sectors, friction, r: ranges of the contacts, stuck fraction, sliding distance, from two other programs.
RINGS = [
    (3, 0.465, 0.64, 1.396689773220818, 0.15817596594661913, 2.793379546441642),
]


@pytest.mark.parametrize(("n", "beta", "r", "wanted", "stuck", "distance"), RINGS)
@pytest.mark.parametrize("start", ["rest", "moving"])
def test_a_tuned_ring(n, beta, r, wanted, stuck, distance, start):
    ds = fm.sweep(ring(n, [1.0] * n), [r], [beta], outputs=OUTPUTS, start=start)
    assert ds.contact_peak_to_peak.values.ravel() == pytest.approx(wanted, abs=1e-10)
    assert ds.stuck_fraction.values.ravel() == pytest.approx(stuck, abs=1e-10)
    assert ds.sliding_distance.values.ravel() == pytest.approx(distance, abs=1e-10)
    assert (ds.stops_per_cycle == 2.0).all()
    assert (ds.turns_per_cycle == 0.0).all()
    assert ds.beta_stick.item() == pytest.approx(0.5, rel=1e-12)


def of_row(given):
    """The ring of a row of the reference."""
    n, friction = given["sectors"], given["beta"]
    return ring(
        n, friction[:n], friction[n:], given["mass_factors"], given.get("load_factors"),
        given["engine_order"], given.get("second_order", False), **{name: given[name] for name in DISK},
    )  # fmt: skip


def test_reference_rings(reference_table):
    """Rings of 3, 6 and 12 sectors, with further contacts to the ground: nullity up to 6."""
    count = 0
    for row in reference_table("continuous.json")["rows"]:
        if not row["kind"].startswith("ring"):
            continue
        given, wanted = row["given"], row["expect"]
        ds = fm.sweep(of_row(given), [given["r"]], [1.0], outputs=OUTPUTS)
        assert ds.status.item() == fm.regimes.RESOLVED, row["id"]
        largest = max(wanted["contact_peak_to_peak"])
        rests = ds.contact_regime.values.ravel() == fm.regimes.PERMANENT_STICKING
        for name, key, size in (
            ("contact_peak_to_peak", "contact_peak_to_peak", largest),
            ("stuck_fraction", "stuck_fraction", 1.0), ("sliding_distance", "sliding_distance", largest),
        ):  # fmt: skip
            found = ds[name].values.ravel()
            assert found == pytest.approx(wanted[key], abs=1e-10 * size), (row["id"], name)
        for name in ("stops_per_cycle", "turns_per_cycle"):
            counted = np.where(rests, 0.0, ds[name].values.ravel())
            assert counted.tolist() == wanted[name], (row["id"], name)
        if "ratios" in given and not given["second_order"]:
            scale = ds.beta_stick.item() * given["beta"][0] / given["ratios"][0]
            assert scale == pytest.approx(given["beta_stick_scale"], rel=1e-10), row["id"]
        count += 1
    assert count == 14


def test_a_ring_with_a_frictionless_contact_is_a_chain():
    """Whichever of its contacts has none."""
    r, beta = 0.64, [0.4, 0.3, 0.5, 0.45]
    for j in range(4):
        friction = [b if k != j else 0.0 for k, b in enumerate(beta)]
        closed = ring(4, friction)
        opened = fm.System(
            matrices={"M": closed.modes.mass, "K": closed.modes.stiffness, "C": closed.modes.damping},
            frequency_scale=1.0, load_harmonics=closed.load_harmonics,
            contacts=[one for k, one in enumerate(closed.contacts) if k != j],
        )  # fmt: skip
        found = fm.sweep(closed, [r], [1.0], outputs=["peak_to_peak"]).peak_to_peak.values.ravel()
        wanted = fm.sweep(opened, [r], [1.0], outputs=["peak_to_peak"]).peak_to_peak.values.ravel()
        assert found == pytest.approx(wanted, abs=1e-11 * wanted.max())


def test_forces_that_are_not_determined():
    """They are NaN; the sums on the masses, and all works, are not."""
    ds = fm.response(ring(3, [1.0] * 3), 0.64, 0.465)
    stuck = (ds.direction == 0).values
    unknown = np.isnan(ds.friction.values)
    assert (unknown == (stuck & (stuck.sum(axis=0) == 3))).all()
    for j in range(3):
        known = ~unknown[j] & (stuck[j] == 0)
        assert np.abs(ds.friction.values[j, known]) == pytest.approx(0.465, abs=1e-12)
    on_blades = ds.friction_on_mass.values[:3]
    assert np.isfinite(on_blades).all()
    assert on_blades.sum(axis=0) == pytest.approx(0.0, abs=1e-12)
    lost = ds.work_damping.item() + ds.work_friction.sum().item()
    assert ds.work_input.item() == pytest.approx(lost, rel=1e-11)


def test_second_starts_of_random_rings():
    """Detuned rings with contacts to the ground: motions from rest and from far away end alike."""
    rng = np.random.default_rng(24)
    for n in (3, 5, 9):
        system = ring(n, rng.uniform(0.2, 0.6, n), rng.uniform(0.1, 0.4, n), rng.uniform(0.95, 1.05, 2 * n))
        found = [
            fm.sweep(system, [0.7], [0.7], outputs=["peak_to_peak"], start=start).peak_to_peak.values.ravel()
            for start in ("rest", "moving")
        ]
        assert found[0] == pytest.approx(found[1], abs=1e-12 * found[0].max())


@pytest.mark.parametrize("r", [0.3, 1.1])
def test_masses_that_a_held_loop_joins_go_on_moving(r):
    """Three masses on one spring, joined by three contacts, are one mass 3: 2/|1 - 3 r^2| from end to end."""
    system = fm.System(
        contacts=[fm.Contact("between-masses", pair) for pair in PAIRS], mass_ratios=[1, 1, 1],
        stiffness_ratios=[1, 1, 1], load_mass=2,
    )  # fmt: skip
    wanted = 2.0 / abs(1.0 - 3.0 * r * r)
    ds = fm.sweep(system, [r], [5.0], outputs=["regime", "peak_to_peak"])
    assert ds.regime.item() == 0
    assert ds.peak_to_peak.values.ravel() == pytest.approx([wanted] * 3, rel=1e-12)
    motion = fm.response(system, r, 5.0, points=4)  # tau = 0 is an extreme, and so is the middle
    assert np.ptp(motion.v.values, axis=1) == pytest.approx([wanted] * 3, rel=1e-12)
    assert motion.v.values[:, 1] == pytest.approx([-0.5 * np.sign(1.0 - 3.0 * r * r) * wanted] * 3, rel=1e-12)


def test_a_loop_at_rest_on_moving_sectors():
    """Sectors of a ring under order 0 move alike: contacts between them rest, each is on its own spring."""
    sector = {
        "count": 4, "mass": [[1.0]], "stiffness": [[1.3]], "engine_order": 0,
        "coupling": [{"masses": [1, 1], "stiffness": 0.6}],
    }  # fmt: skip
    between = fm.Contact("between-masses", [1, "next.1"])
    keys = {"sectors": sector, "load_mass": 1, "damping_ratios": 0.08}
    ring, r, w = fm.ring(contacts=[between], **keys), 0.4, np.sqrt(1.3)
    found = fm.sweep(ring, [r], [0.3], outputs=["peak_to_peak"]).peak_to_peak.values.ravel()
    s = r * w  # r is over the first natural frequency, that of sectors in phase
    assert found == pytest.approx([2.0 / abs(1.3 - s * s + 0.16j * w * s)] * 4, rel=1e-12)
    ground = fm.Contact("fixed-wall", [1], ratio=0.5)
    found = fm.sweep(
        fm.ring(contacts=[between, ground], **keys),
        [r],
        [0.3],
        outputs=["peak_to_peak", "contact_peak_to_peak"],
    )
    grounded = found.contact_peak_to_peak.values.ravel()[4:]
    assert found.peak_to_peak.values.ravel() == pytest.approx(grounded, rel=1e-12)
    assert grounded.min() > 1.0


def test_forces_that_leave_their_limits_after_others_begin_to_slide():
    """All contacts reach their limits together; the outer mass pulls the inner ones away only later."""
    contacts = [
        fm.Contact("fixed-wall", 2), fm.Contact("between-masses", [2, 3]), fm.Contact("fixed-wall", 1),
        fm.Contact("between-masses", [1, 2]),
    ]  # fmt: skip
    system = fm.System(
        contacts=contacts, mass_ratios=[1, 1, 1], stiffness_ratios=[1, 1, 1], damping_ratios=0.05,
        load_mass=3,
    )  # fmt: skip
    names = ["status", "regime", "peak_to_peak"]
    rest, moving = (fm.sweep(system, [1.3], [0.05], start=one, outputs=names) for one in ("rest", "moving"))
    assert rest.status.item() == moving.status.item() == 0
    assert rest.peak_to_peak.values == pytest.approx(moving.peak_to_peak.values, rel=1e-9)
