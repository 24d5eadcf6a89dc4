"""Contacts that come to rest: springs between ends at rest, contacts at the edge of their limits, and the
multipliers of several contacts at rest.
"""

import numpy as np
import pytest

import frictionmap as fm

OUTPUTS = (
    "regime", "status", "stops_per_cycle", "turns_per_cycle", "stuck_fraction", "contact_peak_to_peak",
    "multiplier",
)  # fmt: skip


def solved(system, r, beta, **further):
    """One row of a map, mu = 1."""
    return fm.sweep(system, [r], np.atleast_1d(beta), outputs=OUTPUTS, **further).isel(mu=0, r=0)


def agree(found, wanted):
    """Every variable of two rows is the same, up to rounding."""
    for name in ("status", "contact_regime", "stops_per_cycle", "turns_per_cycle", "slips_per_cycle"):
        if name in wanted:
            np.testing.assert_array_equal(found[name], wanted[name], err_msg=name)
    wanted_size = float(wanted.contact_peak_to_peak.max())
    np.testing.assert_allclose(
        found.contact_peak_to_peak, wanted.contact_peak_to_peak, rtol=0.0, atol=1e-11 * wanted_size
    )
    for name in ("stuck_fraction", "elastic_fraction"):  # float32
        if name in wanted:
            np.testing.assert_allclose(found[name], wanted[name], rtol=0.0, atol=2e-7, err_msg=name)


# springs between ends at rest

BESIDE = fm.System(
    damping_ratios=0.05, contacts=[fm.Contact(), fm.Contact("fixed-wall", 1, stiffness=2.0, ratio=0.15)]
)
TWO = {"mass_ratios": [1.0, 1.0], "stiffness_ratios": [1.0, 1.0], "damping_ratios": 0.05}
JOINT = fm.System(
    contacts=[
        fm.Contact("fixed-wall", 1),
        fm.Contact("fixed-wall", 2, ratio=0.6),
        fm.Contact("between-masses", (1, 2), stiffness=2.0, ratio=0.15),
    ],
    **TWO,
)
#: Two springs beside a rigid contact that turns without a stop: all velocities are zero at one instant.
TURNING = fm.System(
    mass_ratios=[1.0, 2.252], stiffness_ratios=[1.0, 0.632], damping_ratios=0.01,
    load_harmonics={1: [-0.738, -0.216], 2: [0.614, 0.059]},
    contacts=[
        fm.Contact("fixed-wall", 2, ratio=0.114, stiffness=2.004),
        fm.Contact("fixed-wall", 2, ratio=0.411, stiffness=0.701),
        fm.Contact("fixed-wall", 2, ratio=0.318), fm.Contact("fixed-wall", 1),
    ],
)  # fmt: skip


def test_every_cell_with_an_elastic_and_a_rigid_contact_has_an_answer():
    for system in (BESIDE, JOINT):
        ds = fm.sweep(system, np.linspace(0.2, 1.6, 15), np.linspace(0.05, 0.95, 19), outputs=["status"])
        assert (ds.status == 0).all()


@pytest.mark.parametrize(
    ("system", "r"), [(BESIDE, 0.5), (BESIDE, 1.1), (JOINT, 0.2), (JOINT, 0.9), (TURNING, 1.5576)]
)
def test_a_cell_is_the_same_alone(system, r):
    beta = np.array([0.19356632082000985, 0.4, 0.5, 0.85])
    row = solved(system, r, beta)
    assert (row.status == 0).all()
    for k, one in enumerate(beta):
        agree(solved(system, r, one).isel(beta=0), row.isel(beta=k))


def test_springs_that_stop_with_a_turning_contact_slip_once_each_way():
    cell = solved(TURNING, 1.5576, 0.19356632082000985).isel(beta=0)
    assert cell.turns_per_cycle.values[2] == 2.0
    assert cell.stops_per_cycle.values[2] == 0.0
    assert cell.slips_per_cycle.values[0] == 2.0
    assert float(cell.multiplier) < 1.0


def elastic_share(z, stiffness, limit):
    """Share of the time in which a slider rests whose end has the motion z (samples of a period)."""
    force, rests = 0.0, 0
    for cycle in range(3):
        for change in np.diff(z, append=z[0]):
            wanted = force + stiffness * change
            force = min(limit, max(-limit, wanted))
            rests += cycle == 2 and force == wanted
    return rests / z.size


def test_a_slider_next_to_a_mass_that_the_base_carries_has_settled():
    """The force of the spring alone shows whether it has: the mass has the motion of the base."""
    motion = {1: 0.531 + 0.116j, 3: -1.058 + 0.974j}
    system = fm.System(
        damping_ratios=0.01, excitation="base", load_harmonics=motion,
        contacts=[
            fm.Contact("fixed-wall", 1, ratio=0.084, stiffness=0.336),
            fm.Contact("fixed-wall", 1, ratio=0.297, stiffness=10.637),
            fm.Contact("joined-base-wall", 1),
        ],
    )  # fmt: skip
    beta = np.array([12.570747, 13.772723, 26.260701, 26.81659, 35.598293, 59.59357, 66.749935])
    row = solved(system, 0.292, beta)
    tau = np.linspace(0.0, 2.0 * np.pi, 40000, endpoint=False)
    z = sum((value * np.exp(1j * n * tau)).real for n, value in motion.items())
    for k, one in enumerate(beta):
        wanted = elastic_share(z, 10.637, 0.297 * one)
        # a slip begins and ends up to a sample off
        assert row.elastic_fraction.values[k, 1] == pytest.approx(wanted, abs=8.0 / tau.size)


# multipliers

THREE = {"mass_ratios": [1.0] * 3, "stiffness_ratios": [1.0] * 3, "damping_ratios": 0.02}


def test_three_contacts_stick_for_mu_above_one():
    contacts = [
        fm.Contact("fixed-wall", 2), fm.Contact("between-masses", (1, 2)),
        fm.Contact("between-masses", (2, 3)),
    ]  # fmt: skip
    system = fm.System(contacts=contacts, **THREE)
    ds = fm.sweep(system, [0.3, 0.5, 0.8, 1.2], [0.777, 1.538, 7.69], 1.3, outputs=OUTPUTS, skip="none")
    np.testing.assert_allclose(ds.beta_stick, 1.0 / 1.3, rtol=1e-12)
    assert (ds.status == 0).all()
    assert (ds.regime == 0).all()
    assert (ds.multiplier < 1e-12).all()  # nothing moves that a disturbance could


@pytest.mark.parametrize("pairs", [[(1, 2), (2, 3)], [(1, 3), (1, 2)]])
@pytest.mark.parametrize("mu", [1.0, 1.2])
def test_masses_that_contacts_hold_together_are_one_mass(pairs, mu):
    """Its multipliers are those of the engine of one mass, on the same wall."""
    joints = [fm.Contact("between-masses", pair, force=1e3) for pair in pairs]
    chain = fm.System(contacts=[fm.Contact("fixed-wall", 1), *joints], **THREE)
    ones = np.ones(3)
    mass, damping = ones @ chain.modes.mass @ ones, ones @ chain.modes.damping @ ones
    one = fm.System(damping_ratios=damping / (2.0 * np.sqrt(mass)))
    r, beta = np.array([0.2, 0.31, 0.45]), np.array([0.2, 0.5, 0.7])
    found = fm.sweep(chain, r, beta, mu, outputs=OUTPUTS).isel(mu=0)
    names = ("regime", "multiplier", "stops_per_cycle", "contact_amplitude")
    wanted = fm.sweep(one, r * np.sqrt(mass), beta, mu, outputs=names).isel(mu=0)
    assert (wanted.regime == 1).any()
    np.testing.assert_array_equal(found.stops_per_cycle[..., 0], wanted.stops_per_cycle)
    np.testing.assert_allclose(found.contact_peak_to_peak[..., 0], 2.0 * wanted.contact_amplitude, rtol=1e-9)
    np.testing.assert_allclose(found.multiplier, wanted.multiplier, rtol=1e-6, atol=1e-7)


def random_chain(rng):
    """A chain of up to four masses on walls, with joints and springs."""
    n = int(rng.integers(2, 5))
    masses = rng.permutation(n)[: rng.integers(1, n + 1)] + 1
    contacts = [fm.Contact("fixed-wall", int(k), ratio=float(rng.uniform(0.3, 1.5))) for k in masses[:2]]
    if n > 2 and not {1, 2} <= set(masses[:2].tolist()):
        contacts.append(fm.Contact("between-masses", (1, 2), ratio=float(rng.uniform(0.3, 1.5))))
    spring = {"ratio": float(rng.uniform(0.1, 0.6)), "stiffness": float(np.exp(rng.uniform(-1.0, 3.0)))}
    contacts.append(fm.Contact("between-masses", (1, n), **spring))
    load = {1: rng.normal(size=n), 2: 0.4 * rng.normal(size=n)}
    return fm.System(
        mass_ratios=[1.0, *rng.uniform(0.5, 2.0, n - 1)], damping_ratios=0.02, contacts=contacts,
        stiffness_ratios=[1.0, *rng.uniform(0.5, 2.0, n - 1)], load_harmonics=load,
    )  # fmt: skip


def test_no_multiplier_is_above_one_for_mu_one():
    """The energy of a difference of two motions never grows; 1e-9 is far above its rounding error."""
    rng = np.random.default_rng(7)
    for _ in range(12):
        system = random_chain(rng)
        r, beta = np.sort(rng.uniform(0.3, 2.0, 2)), np.sort(rng.uniform(0.05, 2.5, 6))
        ds = fm.sweep(system, r, beta, outputs=OUTPUTS)
        assert (ds.status == 0).all()
        assert float(ds.multiplier.max()) < 1.0 + 1e-9


# contacts at the edge of their limits

VARYING = fm.System(
    contacts=[fm.Contact(), fm.Contact("fixed-wall", 2, ratio=0.5, normal_load={1: 0.4j})],
    load_harmonics={1: [1.0, 0.0], 2: [0.6, 0.0]}, **TWO,
)  # fmt: skip
CHAIN = fm.System(
    mass_ratios=[1.0, 0.635, 0.492], stiffness_ratios=[1.0, 0.527, 2.027], damping_ratios=0.02,
    load_harmonics={1: [0.916, 0.226, 1.676], 4: [0.364, -0.439, -0.343]},
    contacts=[
        fm.Contact("between-masses", (1, 3)), fm.Contact("fixed-wall", 1, ratio=1.5),
        fm.Contact("between-masses", (1, 2), ratio=0.74),
    ],
)  # fmt: skip

#: System, r, beta, and the contact that decides, from 0: at the edge its load is just within its friction.
EDGES = [
    (CHAIN, 0.4478, 1.9059452175336677, 0),
    (CHAIN, 1.2492, 1.805968008069008, 0),
    (VARYING, 0.2, 0.9, 1),
    (VARYING, 0.2, 0.925, 1),
    (VARYING, 1.2, 0.9, 1),
    (VARYING, 1.9, 0.625, 1),
    (VARYING, 2.4, 0.5, 1),
    (VARYING, 2.4, 0.45, 1),
]


def held_gap(system, r, beta, j):
    """Friction of a contact less what it needs to rest: from the force that holds it while others move."""
    own = system.contacts[j]
    held = [fm.Contact(c.kind, c.masses, ratio=c.ratio) for c in system.contacts]
    held[j] = fm.Contact(own.kind, own.masses, force=1e4)
    for k, contact in enumerate(system.contacts):
        if k != j and contact.normal_load is not None:
            held[k] = contact
    kept = {"mass_ratios", "stiffness_ratios", "damping_ratios", "load_harmonics"}
    other = fm.System(contacts=held, **{name: getattr(system, name) for name in kept})
    ds = fm.response(other, r=r, beta=beta, mu=1.0, points=4001)
    force = ds.friction.isel(contact=j).values
    tau = ds.tau.values
    nu = 1.0 + sum((value * np.exp(1j * n * tau)).real for n, value in (own.normal_load or {}).items())
    limit = own.ratio * beta * nu
    return (force + limit).min() - (force - limit).max()


@pytest.mark.parametrize(("system", "r", "beta", "j"), EDGES)
def test_a_contact_at_the_edge_of_its_limits_rests_or_slides_both_ways(system, r, beta, j):
    cell = solved(system, r, beta).isel(beta=0)
    assert int(cell.status) == 0
    rests = held_gap(system, r, beta, j) > 0.0
    assert (int(cell.contact_regime[j]) == 0) == rests
    moving = cell.contact_regime.values != 0
    assert ((cell.stops_per_cycle + cell.turns_per_cycle).values[moving] >= 2.0).all()
    agree(solved(system, r, beta, start="moving").isel(beta=0), cell)


def test_next_to_partial_sticking_the_start_does_not_matter():
    """Contacts that slide by less than 1e-6 of the motion, and a spring that hardly slips."""
    system = fm.System(
        mass_ratios=[1.0, 0.864, 1.113], stiffness_ratios=[1.0, 0.564, 0.392], damping_ratios=0.05,
        load_harmonics={1: [1.0, 0.0, 0.0]},
        contacts=[
            fm.Contact("fixed-wall", 2, ratio=0.102, stiffness=9.226),
            fm.Contact("between-masses", (1, 2), ratio=0.117, stiffness=14.666),
            fm.Contact("fixed-wall", 3, ratio=0.303), fm.Contact("fixed-wall", 2, ratio=1.26),
            fm.Contact("fixed-wall", 1),
        ],
    )  # fmt: skip
    for beta in (0.3760053560683906, 0.37, 0.38):
        cell = solved(system, 0.6176, beta)
        assert (cell.status == 0).all()
        agree(solved(system, 0.6176, beta, start="moving"), cell)


def test_held_contacts_do_not_drift_where_the_cells_of_a_map_lie_close():
    """The polynomial through close cells takes their rounding errors far beyond them."""
    system = fm.System(
        mass_ratios=[1.0, 1.185, 2.124], stiffness_ratios=[1.0, 1.348, 2.526], damping_ratios=0.1,
        load_harmonics={1: [0.085, -0.42, 0.489]},
        contacts=[
            fm.Contact("fixed-wall", 2, ratio=0.188, stiffness=0.425),
            fm.Contact("fixed-wall", 3, ratio=0.504, stiffness=3.677), fm.Contact("between-masses", (1, 3)),
        ],
    )  # fmt: skip
    close = 0.1062280324 * (1.0 + np.array([-1e-5, -1e-6, -1e-7, 2e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2]))
    beta = np.concatenate((close, [0.26361, 0.266006, 0.266246]))
    row = solved(system, 0.904, beta)
    for k in (-1, -2, -3):
        agree(solved(system, 0.904, beta[k]).isel(beta=0), row.isel(beta=k))


# response curves of contacts that stick permanently

PULLED = {"load_harmonics": {1: [1.0, 0.2j], 2: [0.0, 0.4]}, "load_offset": [0.3, -0.1], **TWO}
ALL_AT_REST = [
    fm.System(contacts=[fm.Contact("fixed-wall", 1), fm.Contact("between-masses", (1, 2), stiffness=3.0)],
              **PULLED),
    fm.System(contact_masses=[2], contact_stiffness=3.0, **PULLED),
    fm.System(contacts=[fm.Contact("joined-base-wall", 1, stiffness=2.0)], excitation="base",
              damping_reference="base", load_harmonics={1: 1.0, 3: 0.3}, **TWO),
]  # fmt: skip


@pytest.mark.parametrize("system", ALL_AT_REST)
def test_harmonics_of_a_structure_with_contacts_at_rest_solve_its_equations(system):
    """(K - n^2 r^2 M + i n r C) X_n + W F_n = p_n, F_n = k_t Z_n of springs, and the works balance."""
    r, modes, general = 0.7, system.modes, system.contact_system
    ds = fm.curves(system, [r], [50.0], harmonics=3).isel(mu=0, r=0, beta=0)
    assert int(ds.status) == 0
    x, z, f = (
        np.atleast_2d(ds[f"{name}_harmonic"].values @ [1.0, 1j])
        for name in ("displacement", "contact", "friction")
    )
    works = {name: float(ds[f"work_{name}"].sum()) for name in ("input", "friction", "damping")}
    given = 0.0
    for n in range(4):
        u = general.base.get(n, 0.0)
        # base motion acts through the spring and the dashpot of the first mass
        load = (general.forces.get(n, 0.0) + u * (modes.stiffness + 1j * n * r * modes.damping).sum(axis=1)
                + (general.offset if n == 0 else 0.0))  # fmt: skip
        dynamic = modes.stiffness - (n * r) ** 2 * modes.mass + 1j * n * r * modes.damping
        assert np.abs(dynamic @ x[:, n] + general.vectors.T @ f[:, n] - load).max() < 1e-13
        rigid = ~general.elastic
        assert np.abs(z[rigid, n]).max(initial=0.0) < 1e-13 or n == 0
        if n:
            moved = general.vectors @ x[:, n] - u * np.array([group.base for group in general.groups])
            kt = np.array([group.stiffness or np.inf for group in general.groups])
            assert np.abs(moved - np.where(rigid, 0.0, f[:, n] / kt)).max() < 1e-13
            rate = 1j * n * (x[:, n] - u)
            given += np.pi * r * (rate.conj() @ modes.damping @ rate).real
    assert works["friction"] == 0.0
    assert works["input"] == works["damping"] == pytest.approx(given, rel=1e-12)
    np.testing.assert_array_equal(ds.sliding_distance, 0.0)
    if general.elastic.any():
        assert np.nanmax(np.abs(ds.slips_per_cycle)) == 0.0
    tau = np.linspace(0.0, 2.0 * np.pi, 200_001)
    waves = np.exp(1j * np.outer(np.arange(4), tau))
    lags = np.atleast_1d(ds.phase_lag)
    for row, lag, amplitude in zip(x, lags, ds.amplitude.values, strict=True):
        motion = (row @ waves).real
        k = int(np.argmax(np.abs(motion)))
        assert abs(motion[k]) == pytest.approx(amplitude, rel=1e-9)
        if np.ptp(motion) > 1e-12:
            apart = lag - tau[k] - (np.pi if motion[k] < 0.0 else 0.0)
            assert abs(np.angle(np.exp(1j * apart))) < 1e-4
        else:  # a mass that its contact holds
            assert np.isnan(lag)


@pytest.mark.parametrize("mu", [1.0, 1.0001, 1.3])
def test_masses_held_from_the_start_keep_their_distance(mu):
    """Mass 1 moves with the base, x1 = cos(tau), and holds mass 2, which was at 0: x2 = cos(tau) - 1."""
    system = fm.System(
        mass_ratios=[1.0, 0.7], stiffness_ratios=[1.0, 1.3], damping_ratios=0.02, excitation="base",
        contacts=[fm.Contact("joined-base-wall", 1, mu=mu), fm.Contact("between-masses", (1, 2), ratio=0.5)],
    )  # fmt: skip
    ds = fm.sweep(
        system, np.linspace(0.2, 1.4, 9), [30.0], outputs=["regime", "midpoint", "contact_midpoint"]
    )
    assert (ds.regime == fm.regimes.PERMANENT_STICKING).all()
    np.testing.assert_allclose(ds.midpoint.values.reshape(-1, 2), [[0.0, -1.0]] * 9, atol=1e-11)
    first = fm.response(system, 0.2, 30.0).x[:, 0]
    np.testing.assert_allclose(first, [1.0, 0.0], atol=1e-11)
