"""Limiting cases of general systems: where they equal systems with one contact under one harmonic load, which
have an engine of their own, and where two of them must agree.
"""

from dataclasses import replace

import numpy as np
import pytest
from general_systems import KINDS

import frictionmap as fm
from frictionmap.design.responses import Response, Responses
from frictionmap.general.problem import problem_of
from frictionmap.general.starts import initial_states
from frictionmap.model.general import in_general_form
from frictionmap.solvers.choose import engine_of
from frictionmap.solvers.general import GeneralEngine

OUTPUTS = [
    "regime",
    "stops_per_cycle",
    "contact_amplitude",
    "amplitude",
    "stuck_fraction",
    "period",
    "status",
]


def agree(general, plain, tolerance=1e-10):
    """Every cell of two maps has the same answer; where both were resolved."""
    both = (general.status == 0).values & (plain.status == 0).values if "status" in plain else True
    for name in ("regime", "stops_per_cycle", "period"):
        a, b = general[name].values, plain[name].values
        same = (a == b) | (np.isnan(a) & np.isnan(b))
        where = np.argwhere(~(same | ~np.asarray(both)))
        assert not len(where), (name, where[:3].tolist())
    moving = (plain.regime.values > 0) & both
    a, b = general.contact_amplitude.values[moving], plain.contact_amplitude.values[moving]
    assert np.abs(a - b).max() <= tolerance * np.abs(b).max()
    assert np.abs(general.stuck_fraction - plain.stuck_fraction).values[moving].max() < 1e-6
    a, b = general.amplitude.values[moving], plain.amplitude.values[moving]
    assert np.abs(a - b).max() <= tolerance * np.abs(b).max()


CHAIN = {"mass_ratios": [1.0, 0.8, 1.7], "stiffness_ratios": [1.0, 2.0, 0.6], "damping_ratios": 0.03}
ONE_CONTACT = [
    ("fixed-wall", (1,), {"damping_ratios": 0.05}),
    ("joined-base-wall", (1,), {"damping_ratios": 0.05}),
    ("joined-base-wall", (1,), {"damping_ratios": 0.05, "damping_reference": "base"}),
    ("fixed-wall", (2,), CHAIN),
    ("between-masses", (1, 3), {**CHAIN, "load_mass": 2}),
    ("joined-base-wall", (2,), CHAIN),
]


SEVERAL = (*OUTPUTS, "multiplier")


def multipliers_agree(found, wanted):
    """Over the steady period, half-wave symmetric or not; next to 0 they are known to rounding error."""
    a, b = found.multiplier.values, wanted.multiplier.values
    both = np.isfinite(a) & np.isfinite(b)
    assert both.sum() > 20
    assert np.allclose(a[both], b[both], rtol=1e-6, atol=1e-7)


@pytest.mark.parametrize(("kind", "masses", "system"), ONE_CONTACT)
def test_one_rigid_contact_is_that_of_the_other_engine(kind, masses, system):
    plain = fm.System(kind, masses, **system)
    general = fm.System(contacts=[fm.Contact(kind, masses)], **system)
    r, beta = np.linspace(0.23, 2.2, 9), np.linspace(0.02, 1.6, 9)
    for mu in (1.0, 1.4):
        found, wanted = (fm.sweep(one, r, beta, mu, outputs=SEVERAL) for one in (general, plain))
        agree(found, wanted)
        multipliers_agree(found, wanted)
    limits, wanted = fm.boundaries(general, r, [1.0, 1.4]), fm.boundaries(plain, r, [1.0, 1.4])
    assert np.allclose(limits.beta_stick, wanted.beta_stick, rtol=1e-11, atol=1e-12)
    assert np.allclose(limits.beta_lim, wanted.beta_lim, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize(
    ("kind", "masses", "system"),
    [*ONE_CONTACT, ("fixed-wall", (2,), {**CHAIN, "excitation": "base", "damping_reference": "base"})],
)
def test_the_moving_start_is_that_of_the_other_engine(kind, masses, system):
    """At mu = 2, where the result depends on the initial state in many cells."""
    plain = fm.System(kind, masses, **system)
    general = fm.System(contacts=[fm.Contact(kind, masses)], **system)
    r, beta = np.linspace(0.23, 2.2, 9), np.linspace(0.02, 1.6, 9)
    for mu in (1.4, 2.0):
        found, wanted = (
            fm.sweep(one, r, beta, mu, outputs=OUTPUTS, start="moving") for one in (general, plain)
        )
        agree(found, wanted)
        np.testing.assert_array_equal(found.regime, wanted.regime)


def test_harmonics_and_works_are_those_of_the_other_engine():
    plain = fm.System("fixed-wall", (2,), **CHAIN)
    general = fm.System(load_harmonics={1: [1.0, 0.0, 0.0]}, contact_masses=(2,), **CHAIN)
    r, beta = [0.4, 0.9], [0.1, 0.4]
    ds, wanted = (fm.curves(system, r, beta) for system in (general, plain))
    for name in (
        "displacement_harmonic", "contact_harmonic", "friction_harmonic", "work_input", "work_damping",
        "work_friction", "sliding_distance", "first_harmonic_phase",
    ):  # fmt: skip
        assert np.allclose(ds[name], wanted[name], rtol=1e-9, atol=1e-10), name


@pytest.mark.parametrize(("kind", "masses", "system"), ONE_CONTACT)
def test_lags_and_stops_at_maxima_are_those_of_the_other_engine(kind, masses, system):
    """Where a stop holds a mass at its maximum there is no lag, but the begin and the end of the stop."""
    plain = fm.System(kind, masses, **system)
    general = fm.System(contacts=[fm.Contact(kind, masses)], **system)
    r, beta = [0.23, 0.4, 0.9, 1.3], [0.05, 0.3, 0.7, 30.0]
    ds, wanted = (fm.curves(one, r, beta, quantities=["amplitude", "phase"]) for one in (general, plain))
    np.testing.assert_array_equal(ds.regime, wanted.regime)
    held = np.isfinite(wanted.phase_begin.values).any()
    assert held == (kind == "fixed-wall")
    moves = wanted.amplitude.values > 1e-12  # the lag of a mass at rest is none, or rounding error
    for name in ("phase_lag", "phase_begin", "phase_end"):
        found, exact = ds[name].values[moves], wanted[name].values[moves]
        np.testing.assert_array_equal(np.isnan(found), np.isnan(exact), err_msg=name)
        apart = np.abs(np.exp(1j * found) - np.exp(1j * exact))
        assert np.nanmax(apart, initial=0.0) < 1e-7, name


def two(contacts, **further):
    """Two masses with contacts; further keys of the system."""
    own = {"mass_ratios": [1.0, 0.7], "stiffness_ratios": [1.0, 0.5], "damping_ratios": 0.02, **further}
    return fm.System(contacts=contacts, **own)


def cells(system, beta=(0.05, 0.3, 0.7), **settings):
    return fm.sweep(system, [0.45, 0.9, 1.5], list(beta), outputs=OUTPUTS, **settings)


def test_a_contact_without_friction_is_none():
    both = two([fm.Contact("fixed-wall", 1), fm.Contact("between-masses", (1, 2), force=0.0)])
    one = two([fm.Contact("fixed-wall", 1)])
    a, b = cells(both), cells(one)
    assert np.allclose(a.contact_amplitude.isel(contact=0), b.contact_amplitude, rtol=0.0, atol=1e-12)
    assert np.array_equal(a.stops_per_cycle.isel(contact=0), b.stops_per_cycle)


def test_a_contact_with_much_friction_joins_its_masses():
    both = two([fm.Contact("fixed-wall", 1), fm.Contact("between-masses", (1, 2), force=1e6)])
    stiffness = np.array([[1.5, -0.5], [-0.5, 0.5]])
    damping = damping_of(both)
    joined = np.ones((2, 1))
    one = fm.System(
        matrices={
            "M": joined.T @ np.diag([1.0, 0.7]) @ joined, "K": joined.T @ stiffness @ joined,
            "C": joined.T @ damping @ joined,
        },
        frequency_scale=1.0, contacts=[fm.Contact("fixed-wall", 1)],
    )  # fmt: skip
    a, b = cells(both), cells(one)
    assert np.allclose(a.contact_amplitude.isel(contact=0), b.contact_amplitude, rtol=0.0, atol=1e-11)
    assert (a.contact_regime.isel(contact=1) == 0).all()


def damping_of(system):
    """C1 of a system."""
    return system.modes.damping


def test_parallel_contacts_act_as_one():
    apart = two([fm.Contact("fixed-wall", 1, ratio=0.3, mu=1.0), fm.Contact("fixed-wall", 1, ratio=0.7)])
    one = two([fm.Contact("fixed-wall", 1)])
    a, b = cells(apart), cells(one)
    assert np.array_equal(a.contact_amplitude, b.contact_amplitude)
    assert "2 parallel contacts as one" in a.attrs["system"]


def test_the_order_of_contacts_does_not_matter():
    wall, joint = fm.Contact("fixed-wall", 1), fm.Contact("between-masses", (1, 2), ratio=0.4)
    a, b = cells(two([wall, joint])), cells(two([joint, wall]))
    for name in ("stops_per_cycle", "contact_amplitude", "stuck_fraction"):
        turned = b[name].isel(contact=[1, 0]).values
        assert np.allclose(a[name].values, turned, rtol=0.0, atol=1e-12, equal_nan=True), name


@pytest.mark.parametrize("load", [{}, {"load_harmonics": {1: [0.5, 1.0], 2: [0.4, 0.0]}}])
def test_the_moving_start_does_not_depend_on_the_order_of_contacts(load):
    """It has no displacement in any contact, and slides one of them upwards, whichever is named first."""
    wall, joint = fm.Contact("fixed-wall", 1), fm.Contact("between-masses", (1, 2), ratio=0.4)
    r = np.array([0.45, 0.9, 1.5])
    found = []
    for contacts in ([wall, joint], [joint, wall]):
        system = two(contacts, **load)
        problem, modal = problem_of(system, r)
        state = initial_states(system, problem, modal, "moving")
        x, v = state[:, 0] @ modal.phi.T, state[:, 1] @ modal.phi.T
        assert not x.any()
        z = v @ system.general.vectors.T
        assert (z.max(axis=1) > 0.0).all()
        assert (state[:, 2] == state[:, 2, :1]).all()
        found.append((v, state[:, 2]))
    for one, other in zip(*found, strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-12)
    a, b = (
        cells(two(contacts, **load), mu=1.8, start="moving") for contacts in ([wall, joint], [joint, wall])
    )
    np.testing.assert_array_equal(a.regime, b.regime)
    np.testing.assert_array_equal(a.contact_regime, b.contact_regime.isel(contact=[1, 0]))


def test_a_load_turned_by_half_a_period_turns_the_motion():
    contacts = [fm.Contact("fixed-wall", 1), fm.Contact("between-masses", (1, 2), ratio=0.4)]
    a = cells(two(contacts, load_harmonics={1: [1.0, 0.0], 2: [0.3, 0.1]}))
    b = cells(two(contacts, load_harmonics={1: [-1.0, 0.0], 2: [0.3, 0.1]}))
    assert np.allclose(a.contact_amplitude, b.contact_amplitude, rtol=0.0, atol=1e-11)
    assert np.array_equal(a.stops_per_cycle, b.stops_per_cycle, equal_nan=True)


@pytest.mark.parametrize("mu", [1.0, 1.4])
def test_equal_masses_under_equal_loads_move_alike(mu):
    """Contacts arrive together; both are like one mass."""
    # two masses on springs of their own, joined by a soft spring that is never strained
    system = fm.System(
        matrices={"M": np.eye(2), "K": np.array([[1.5, -0.5], [-0.5, 1.5]]), "C": 0.06 * np.eye(2)},
        frequency_scale=1.0, load=[1.0, 1.0],
        contacts=[fm.Contact("fixed-wall", 1), fm.Contact("fixed-wall", 2)],
    )  # fmt: skip
    one = fm.System(damping_ratios=0.03, contacts=[fm.Contact("fixed-wall", 1)])
    r, beta = [0.35, 0.8, 1.4], [0.1, 0.4, 0.7]
    a = fm.sweep(system, r, beta, mu, outputs=OUTPUTS)
    b = fm.sweep(one, r, beta, mu, outputs=OUTPUTS)
    for k in (0, 1):
        found = a.isel(contact=k)
        assert np.allclose(found.contact_amplitude, b.contact_amplitude, rtol=0.0, atol=1e-11)
        assert np.array_equal(found.stops_per_cycle, b.stops_per_cycle, equal_nan=True)


def test_masses_that_are_not_joined_are_two_systems():
    """Second mass 1.3 on a spring 0.6, loaded half as much."""
    mass, stiffness = np.diag([1.0, 1.3]), np.diag([1.0, 0.6])
    damping = np.diag([0.04, 0.05])
    both = fm.System(
        matrices={"M": mass, "K": stiffness, "C": damping}, frequency_scale=1.0, load=[1.0, 0.5],
        contacts=[fm.Contact("fixed-wall", 1), fm.Contact("fixed-wall", 2, ratio=0.5)],
    )  # fmt: skip
    a = cells(both)
    for k, ratio in ((0, 1.0), (1, 0.5)):
        own = {name: m[k : k + 1, k : k + 1] for name, m in (("M", mass), ("K", stiffness), ("C", damping))}
        one = fm.System(
            matrices=own, frequency_scale=1.0, load=[ratio],
            contacts=[fm.Contact("fixed-wall", 1, ratio=ratio)],
        )  # fmt: skip
        b = cells(one)
        found = a.isel(contact=k)
        assert np.allclose(found.contact_amplitude, b.contact_amplitude, rtol=0.0, atol=1e-11)
        assert np.array_equal(found.stops_per_cycle, b.stops_per_cycle, equal_nan=True)


def test_a_constant_load_moves_positions_only():
    load = {1: [1.0, 0.0], 2: [0.0, 0.4j]}
    contacts = [fm.Contact("fixed-wall", 1), fm.Contact("between-masses", (1, 2), ratio=0.4)]
    outputs = [*OUTPUTS, "midpoint", "peak_to_peak"]
    a, b = (
        fm.sweep(two(contacts, load_harmonics=load, **more), [0.5, 1.2], [0.1, 0.5], outputs=outputs)
        for more in ({}, {"load_offset": [0.4, -1.0]})
    )  # fmt: skip
    assert np.allclose(a.peak_to_peak, b.peak_to_peak, rtol=1e-14, atol=1e-14)
    assert np.array_equal(a.stops_per_cycle, b.stops_per_cycle, equal_nan=True)
    moved = np.linalg.solve(np.array([[1.5, -0.5], [-0.5, 0.5]]), [0.4, -1.0])
    assert np.allclose(b.midpoint - a.midpoint, moved, rtol=0.0, atol=1e-13)


def random_system(rng):
    """A chain with one to three contacts under one to four harmonics, mu = 1."""
    n = int(rng.integers(1, 5))
    # one contact of each mass at most, with the wall or with the mass before it: no loop
    every = [
        ("fixed-wall", (k,)) if k == 1 or rng.random() < 0.5 else ("between-masses", (k - 1, k))
        for k in range(1, n + 1)
    ]
    some = rng.permutation(n)[: int(rng.integers(1, min(n, 3) + 1))]
    chosen = [fm.Contact(*every[k], ratio=rng.uniform(0.2, 1.0)) for k in some]
    load = {}
    for order in rng.permutation(6)[: int(rng.integers(1, 5))] + 1:
        load[int(order)] = (rng.normal(size=n) + 1j * rng.normal(size=n)) / order
    return fm.System(
        contacts=chosen, mass_ratios=[1.0, *rng.uniform(0.5, 2.0, n - 1)], load_harmonics=load,
        stiffness_ratios=[1.0, *rng.uniform(0.5, 2.0, n - 1)], damping_ratios=rng.uniform(0.005, 0.1),
    )  # fmt: skip


def test_steady_states_do_not_depend_on_the_start():
    """mu = 1: friction is monotone, and so two motions approach each other (theory.md 11)."""
    rng = np.random.default_rng(24)
    resolved = 0
    for _ in range(60):
        system = random_system(rng)
        r, beta = [rng.uniform(0.3, 2.5)], [rng.uniform(0.05, 1.0)]
        a, b = (
            fm.sweep(
                system, r, beta, outputs=["regime", "stops_per_cycle", "contact_peak_to_peak"], start=start
            )
            for start in ("rest", "moving")
        )
        if (a.regime < 0).any() or (b.regime < 0).any():
            continue
        resolved += 1
        assert np.array_equal(a.regime, b.regime)
        size = np.abs(a.contact_peak_to_peak).max()
        assert np.allclose(
            a.contact_peak_to_peak, b.contact_peak_to_peak, rtol=0.0, atol=1e-10 * max(size, 1e-12)
        )
        assert np.array_equal(a.stops_per_cycle, b.stops_per_cycle, equal_nan=True)
    assert resolved >= 58


def test_stiff_contacts_approach_the_rigid_one():
    """The error falls like 1/k where the contact stops; reversals of slip are its stops (theory.md 11)."""
    rigid = fm.System(damping_ratios=0.05, contacts=[fm.Contact("fixed-wall", 1)])
    cell = {"r": [0.4], "beta": [0.42]}
    wanted = fm.sweep(rigid, **cell, outputs=OUTPUTS)
    assert wanted.stops_per_cycle.item() == 2.0
    errors = []
    for stiffness in (1e2, 1e4):
        soft = replace(rigid, contacts=None, contact_stiffness=stiffness)
        found = fm.sweep(soft, **cell, outputs=["contact_amplitude", "slip_reversals_per_cycle"])
        errors.append(abs(found.contact_amplitude.item() - wanted.contact_amplitude.item()))
        assert found.slip_reversals_per_cycle.item() == 2.0
    assert 50.0 < errors[0] / errors[1] < 200.0


def test_partial_sticking_begins_at_half_the_range_of_the_force(reference_table):
    """A contact rests beside others that slide from this friction on (theory.md 11)."""
    for row in reference_table("contacts.json")["partial"]:
        given = {key: np.array(row[name]) for key, name in (("M", "M"), ("K", "K"), ("C", "C1"))}
        for factor, regime in ((1.0 - 1e-3, 1), (1.0 + 1e-3, 0)):
            contacts = []
            for (kind, *masses), beta in zip(row["contacts"], row["beta_of_the_others"], strict=True):
                force = factor * row["beta_stick_partial"] if beta is None else beta
                contacts.append(fm.Contact(KINDS[kind], masses, force=force))
            system = fm.System(matrices=given, frequency_scale=1.0, contacts=contacts, load_mass=row["load"])
            ds = fm.sweep(system, [row["r"]], [0.0], outputs=["regime"])
            found = ds.contact_regime.sel(contact=row["held_contact"]).item()
            assert found == regime, (row["id"], factor)


def bank(stiffness, ratios, **further):
    """Two masses whose joint is a bank of elements with a spring in series."""
    elements = [
        fm.Contact("between-masses", (1, 2), stiffness=one, ratio=ratio)
        for one, ratio in zip(stiffness, ratios, strict=True)
    ]
    return fm.System(
        contacts=elements, mass_ratios=[1.0, 1.0], stiffness_ratios=[1.0, 0.1], damping_ratios=0.002,
        load_mass=2, **further,
    )  # fmt: skip


def test_two_equal_elements_are_one_of_twice_the_size():
    r, beta = np.linspace(0.45, 0.75, 16), [0.5, 1.5, 4.0]
    outputs = ["regime", "contact_peak_to_peak", "slips_per_cycle", "slip_reversals_per_cycle", "status"]
    two_of_them = fm.sweep(bank([2.0, 2.0], [0.5, 0.5]), r, beta, outputs=outputs)
    one = fm.sweep(bank([4.0], [1.0]), r, beta, outputs=outputs)
    assert (two_of_them.regime == one.regime).all()
    for name in ("slips_per_cycle", "slip_reversals_per_cycle"):
        for contact in range(2):
            assert np.array_equal(two_of_them[name].isel(contact=contact), one[name]), name
    ranges = two_of_them.contact_peak_to_peak.isel(contact=0)
    assert np.allclose(ranges, one.contact_peak_to_peak, rtol=1e-9)


def test_elements_of_a_bank_stop_slipping_together():
    """Their velocities are one and the same, and reach zero at one instant."""
    ds = fm.sweep(
        bank([2.0, 2.0], [1.0 / 3.0, 2.0 / 3.0]), np.linspace(0.45, 0.75, 61), [1.5],
        outputs=["regime", "slips_per_cycle"],
    )  # fmt: skip
    assert (ds.regime >= 0).all()
    assert ds.slips_per_cycle.max() <= 8.0


@pytest.mark.parametrize(
    ("own", "mu"),
    [
        ([("fixed-wall", 1, 1.0, 2.0), ("fixed-wall", 2, 0.5, 2.0)], 2.0),
        ([("fixed-wall", 1, 0.75, 1.0), ("fixed-wall", 1, 0.25, 3.0), ("fixed-wall", 2, 0.5, 1.5)], 1.5),
    ],
)
def test_a_mu_of_the_contacts_themselves_is_a_mu_of_the_grid(own, mu):
    """Parallel contacts have the sum of their static friction; whatever asks for mu is answered alike."""
    shared = {"mass_ratios": [1.0, 1.0], "stiffness_ratios": [1.0, 1.0], "damping_ratios": 0.02}
    contacts = [fm.Contact(kind, mass, ratio=ratio, mu=given) for kind, mass, ratio, given in own]
    by_contact = fm.System(contacts=contacts, **shared)
    walls = [fm.Contact("fixed-wall", 1), fm.Contact("fixed-wall", 2, ratio=0.5)]
    by_grid = fm.System(contacts=walls, **shared)
    r, beta = [0.5], [0.51, 0.7]
    for function, further in (
        (fm.sweep, {"start": "moving"}),
        (fm.sweep, {}),
        (fm.curves, {"start": "moving", "quantities": ["amplitude"]}),
    ):
        found = function(by_contact, r, beta, 1.0, **further)
        wanted = function(by_grid, r, beta, mu, **further)
        for name in wanted.data_vars:
            np.testing.assert_array_equal(found[name], wanted[name], name)
    # questions of design count both starts where they matter
    response = Response("amplitude", 1, 1)
    assert len(Responses(by_contact, response, 1.0, None)._solvers) == 2
    equal = fm.System(contacts=[replace(one, mu=1.0) for one in contacts], **shared)
    assert len(Responses(equal, response, mu, None)._solvers) == 1


@pytest.mark.parametrize(("contact", "masses", "more"), ONE_CONTACT)
def test_both_engines_give_the_same_arrays(contact, masses, more):
    """Shapes, names and values, on which the page relies for every system."""
    system = fm.System(contact, masses, **more)
    plain, general = engine_of(system), GeneralEngine(in_general_form(system))
    axes = {"mu": np.array([1.0]), "r": np.array([0.43, 0.9]), "beta": np.array([0.1, 0.4])}
    names, solver = ("stops_per_cycle", "contact_amplitude", "amplitude"), fm.Solver()
    (one, lines), (other, further) = (
        engine.cells(axes, names, solver, None, None, None) for engine in (plain, general)
    )
    for ours, theirs in zip(lines[:3], further[:3], strict=True):
        np.testing.assert_allclose(ours, theirs, rtol=1e-9)
    moving = one["regime"] > 0  # where it rests depends on what is followed
    for name in (*names, "regime", "contact_regime"):
        assert one[name].shape == other[name].shape
        np.testing.assert_allclose(one[name][moving], other[name][moving], rtol=1e-9, atol=1e-9)
    own, twin = (engine.traced(0.43, 0.1, 1.0, solver, 50) for engine in (plain, general))
    for name in ("tau", "x", "v", "z", "friction", "contact_harmonic", "friction_harmonic", "work_friction"):
        assert own.values[name].shape == twin.values[name].shape
        np.testing.assert_allclose(own.values[name], twin.values[name], atol=1e-6)
    assert own.values["contact_regime"] == twin.values["contact_regime"]
    np.testing.assert_allclose(own.limits.beta_lim, twin.limits.beta_lim, rtol=1e-9)
