"""Boundaries of general systems: permanent sticking, intervals without stops, belts that pull one way."""

import numpy as np
import pytest
from general_systems import KINDS, chain, phasors

import frictionmap as fm
from frictionmap.general import held
from frictionmap.general.boundaries import find_boundaries

#: r, ends of the rays (1, 0.3) and (1, 1) without stops, and with mu = 1.5; two masses, wall 1 and 1-2.
RAYS = [
    (0.5, 0.216083623377, 0.050582944215, 0.216083623377),
    (0.9, 0.150200587744, 0.233927063078, 0.108538653264),
    (1.3, 0.449776136918, 0.329221716028, 0.386128928594),
]

#: p_n, r, beta_stick, intervals without stops; one mass, zeta 0.03.
REENTRANT = [
    (5, 0.678, 2.913, 0.740, 1.521558963, [(0.0, 0.473611387079), (0.670735620454, 0.822914740771)]),
    (2, 0.466, 3.229, 0.631, 1.118095040, [(0.0, 0.109642002132), (0.164551885335, 0.725940225519)]),
]


def two_contacts(second):
    """Two equal masses, the first against a wall and, with this ratio, against the second."""
    contacts = [fm.Contact("fixed-wall", 1), fm.Contact("between-masses", (1, 2), ratio=second)]
    return fm.System(
        contacts=contacts, mass_ratios=[1.0, 1.0], stiffness_ratios=[1.0, 1.0], damping_ratios=0.01
    )


@pytest.mark.parametrize(("r", "first", "second", "third"), RAYS)
def test_rays_of_two_contacts(r, first, second, third):
    ds = fm.boundaries(two_contacts(0.3), [r], [1.0, 1.5])
    assert ds.beta_lim.values[:, 0] == pytest.approx([first, third], rel=1e-9)
    assert fm.boundaries(two_contacts(1.0), [r]).beta_lim.item() == pytest.approx(second, rel=1e-9)
    assert ds.beta_stick_contact.values[0, 0] == pytest.approx(
        [1.0, 0.0], abs=1e-13
    )  # mass 2 is behind mass 1


@pytest.mark.parametrize(("n", "amplitude", "angle", "r", "stick", "intervals"), REENTRANT)
def test_more_friction_can_end_stops(n, amplitude, angle, r, stick, intervals):
    """The notes print amplitudes and angles to three digits: the boundaries move by about as much."""
    system = fm.System(damping_ratios=0.03, load_harmonics={1: 1.0, n: amplitude * np.exp(1j * angle)})
    ds = fm.boundaries(system, [r])
    assert ds.beta_stick.item() == pytest.approx(stick, abs=2e-3)
    found = np.column_stack((ds.no_stop_begin.values[0, 0], ds.no_stop_end.values[0, 0]))
    assert found[: len(intervals)] == pytest.approx(np.array(intervals), abs=5e-3)
    assert np.isnan(found[len(intervals) :]).all()


def least_speed(zeta, r, load, beta, guess):
    """Least speed, in its sense, of a motion of one mass with two turns and no stop (theory.md 11).

    load : {n: p_n};  guess : its turns, and the sense of the motion after each
    """
    from scipy.optimize import fsolve

    rate = (-zeta + 1j * np.sqrt(1.0 - zeta**2)) / r
    v = {n: value / (1.0 - (n * r) ** 2 + 2j * zeta * n * r) for n, value in load.items()}
    near, senses = guess

    def step(theta):
        theta = np.mod(theta, 2.0 * np.pi)
        wave = np.exp(rate * theta) / ((rate - rate.conjugate()) * (1.0 - np.exp(2.0 * np.pi * rate)))
        return 2.0 / r**2 * wave.real - 1.0 / (2.0 * np.pi)

    def speed(tau, turns):
        free = sum((1j * n * value * np.exp(1j * n * tau)).real for n, value in v.items())
        return free - 2.0 * beta * sum(s * step(tau - turn) for s, turn in zip(senses, turns, strict=True))

    turns = fsolve(lambda x: [speed(x[i] - 1e-14, x) for i in (0, 1)], near, xtol=1e-13)
    least = np.inf
    for i in (0, 1):
        end = turns[1 - i] + (2.0 * np.pi if turns[1 - i] < turns[i] else 0.0)
        tau = np.linspace(turns[i] + 0.02, end - 0.02, 400_001)
        least = min(least, float((senses[i] * speed(tau, turns)).min()))
    return least


def check_end(system, r, found, wanted, inside):
    """An end of an interval without stops is that of the reference, or the closed equations show that it is
    nearer to the truth: reference motions were searched for a touch of zero speed on a grid of times.

    inside : 1.0 if the interval lies above this end, -1.0 if below
    """
    if found == pytest.approx(wanted, rel=1e-9, abs=1e-12):
        return 0
    assert (found - wanted) * inside > 0.0
    ds = fm.response(system, r, found * (1.0 + 1e-3 * inside), points=2)
    guess = ds.event_tau.values, ds.event_direction.values
    load = {n: complex(v[0]) for n, v in system.general.forces.items()}
    within, beyond = (
        least_speed(system.zeta, r, load, found * (1.0 + side * inside * 1e-7), guess) for side in (1.0, -1.0)
    )
    assert within > 0.0 > beyond
    return 1


def test_reentrant_intervals_to_nine_digits(reference_table):
    for row in reference_table("reentrant.json").values():
        load = {int(n): complex(*value) for n, value in row["load"].items()}
        system = fm.System(damping_ratios=row["zeta"], load_harmonics=load)
        ds = fm.boundaries(system, [row["r"]])
        begins, ends = ds.no_stop_begin.values[0, 0], ds.no_stop_end.values[0, 0]
        for k, one in enumerate(row["no_stop_intervals"]):
            check_end(system, row["r"], begins[k], one["beta_from"], 1.0)
            check_end(system, row["r"], ends[k], one["beta_to"], -1.0)
        assert np.isnan(begins[len(row["no_stop_intervals"]) :]).all()
        only = find_boundaries(system, np.array([row["r"]]), np.ones(1), intervals=1)
        assert (only.begins.item(), only.ends.item()) == (begins[0], ends[0])  # the search ends there
        assert ds.beta_stick.item() == pytest.approx(row["beta_stick"], rel=1e-12)


def test_first_intervals_of_periodic_loads(reference_table):
    systems = reference_table("loads.json")["systems"]
    nearer = 0
    for row in reference_table("loads_boundaries.json")["rows"]:
        system = chain(
            systems[row["system"]], row["zeta"], load_harmonics=phasors(row["harmonics"]),
            wall_velocity=row["wall_velocity"],
        )  # fmt: skip
        ds = fm.boundaries(system, [row["r"]], [row["mu"]])
        if not row["wall_velocity"]:
            assert ds.beta_stick.item() == pytest.approx(row["beta_stick"], rel=1e-12)
        nearer += check_end(system, row["r"], ds.beta_lim.item(), row["beta_lim_1"], -1.0)
    assert nearer <= 4


def test_rays_of_several_contacts(reference_table):
    """Walls that move with the base are left out: there the reference load is not that of the base."""
    for row in reference_table("contacts.json")["rays"]:
        if any(row["s"]):
            continue
        given = {key: np.array(row[name]) for key, name in (("M", "M"), ("K", "K"), ("C", "C1"))}
        contacts = [
            fm.Contact(KINDS[kind], masses, ratio=ratio, mu=mu)
            for (kind, *masses), ratio, mu in zip(row["contacts"], row["ray"], row["mu"], strict=True)
        ]
        system = fm.System(matrices=given, frequency_scale=1.0, contacts=contacts, load_mass=row["load"])
        ds = fm.boundaries(system, [row["r"]])
        assert ds.beta_stick.item() == pytest.approx(row["scale_stick"], rel=1e-9)
        tolerance = 1e-6 if row["id"] == 105 else 1e-9  # stops there begin at a graze that a grid misses
        assert ds.beta_lim.item() == pytest.approx(row["scale_lim"], rel=tolerance), row["id"]


def test_no_slip_of_elastic_contacts(reference_table):
    content = reference_table("elastic.json")
    for row in content["rows"]:
        if row["wall_velocity"]:
            continue
        system = chain(
            content["systems"][row["system"]], row["zeta"], load_harmonics=phasors(row["harmonics"]),
            contact_stiffness=row["kt"],
        )  # fmt: skip
        found = fm.boundaries(system, [row["r"]]).beta_noslip.item()
        assert found == pytest.approx(row["beta_noslip"], rel=1e-11)


@pytest.mark.parametrize("stiffness", [0.3, 3.0])
def test_slip_begins_below_no_slip(stiffness):
    system = fm.System(damping_ratios=0.02, contact_stiffness=stiffness)
    for r in (0.7, np.sqrt(1.0 + stiffness) * 1.1):
        limit = fm.boundaries(system, [r]).beta_noslip.item()
        ds = fm.sweep(system, [r], [0.999 * limit, 1.001 * limit], outputs=["regime", "slips_per_cycle"])
        assert ds.regime.values.ravel().tolist() == [1, 0]
        assert ds.slips_per_cycle.values.ravel()[0] >= 2.0


def test_a_belt_faster_than_the_motion_pulls_one_way():
    """From the largest speed of the motion without friction on, friction is a constant pull."""
    load = {1: 1.0, 2: 0.4j}
    r = 0.8
    system = fm.System(damping_ratios=0.05, load_harmonics=load, wall_velocity=0.1)
    limit = fm.boundaries(system, [r]).wall_velocity_lim.item()
    outputs = ["regime", "peak_to_peak", "midpoint"]
    fast = fm.System(damping_ratios=0.05, load_harmonics=load, wall_velocity=1.0002 * limit)
    ds = fm.sweep(fast, [r], [0.0, 0.1, 1.0, 10.0], outputs=outputs)
    assert (ds.regime == fm.regimes.ONE_WAY_SLIDING).values.ravel().tolist() == [True] * 4
    ranges = ds.peak_to_peak.values.ravel()
    assert ranges == pytest.approx(ranges[0], rel=1e-12)
    pulled = ds.midpoint.values.ravel() - ds.midpoint.values.ravel()[0]
    assert pulled == pytest.approx([0.0, 0.1, 1.0, 10.0], rel=1e-12)
    slow = fm.System(damping_ratios=0.05, load_harmonics=load, wall_velocity=0.98 * limit)
    assert fm.sweep(slow, [r], [0.1, 1.0]).regime.values.ravel().tolist() != [3, 3]


def test_the_limit_of_a_belt_counts_dampers_of_the_base():
    base = {"excitation": "base", "damping_reference": "base", "damping_ratios": 0.3}
    limit = fm.boundaries(fm.System(wall_velocity=0.1, **base), [1.3]).wall_velocity_lim.item()
    regimes = [
        fm.sweep(fm.System(wall_velocity=share * limit, **base), [1.3], [0.2]).regime.item()
        for share in (1.0002, 0.9998)
    ]
    assert regimes[0] == fm.regimes.ONE_WAY_SLIDING != regimes[1]


def test_curves_and_maps_of_a_held_spring_agree():
    """On a wall that moves with the base, where the spring is strained by both motions."""
    system = fm.System("joined-base-wall", contact_stiffness=2.0, damping_ratios=0.1)
    names = ["contact_amplitude", "amplitude"]
    ds = fm.sweep(system, [0.7], [5.0], outputs=["regime", *names])
    assert ds.regime.item() == 0
    curves = fm.curves(system, [0.7], [5.0], quantities=["amplitude"])
    for name in names:
        assert np.array_equal(curves[name], ds[name]), name
    assert abs(ds.contact_amplitude.item() - ds.amplitude.item()) > 0.1


def test_friction_that_is_infinite_at_one_frequency_leaves_that_at_others():
    """F = a sin tau and nu = 1 + (1 - e) cos tau: f = a/sqrt(1 - (1 - e)^2), infinite for a = 1e9."""
    e = 1e-8
    found = held._least_friction({1: np.array([[-1e9j], [-1j]])}, {1: 1.0 - e}, 0, True)
    assert found[0] == np.inf
    assert found[1] == pytest.approx(1.0 / np.sqrt(1.0 - (1.0 - e) ** 2), rel=1e-6)  # cancellation: eps/e
