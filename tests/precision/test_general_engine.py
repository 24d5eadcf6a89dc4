"""Steady states of several contacts, springs, belts, varying normal loads and periodic loads, against values
computed by independent programs, and against numbers printed in the notes on them.
"""

import numpy as np
import pytest
from general_systems import Solved, chain, matrices, phasors, vector

import frictionmap as fm
from frictionmap._kernels.general.counts import MOVED, REVERSALS, SLIPS, STOPS, STUCK, TURNS

OUTPUTS = (
    "regime", "stops_per_cycle", "turns_per_cycle", "stuck_fraction", "contact_peak_to_peak", "amplitude",
    "peak_to_peak", "period", "status",
)  # fmt: skip


def solved_row(row, systems, **further):
    """Steady state of a row of one contact."""
    system = systems[row["system"]]
    n = len(system["gamma"])
    mass, stiffness, damping = matrices(system["gamma"], system["kappa"], row["zeta"])
    loads = phasors(row["harmonics"]) if "harmonics" in row else {1: np.eye(n)[row["load_mass"] - 1] + 0j}
    friction = ([row["beta"]], [row["beta"] * row["mu"]])
    belt = [row.get("wall_velocity", 0.0)]
    w = vector(system["contact"], n)
    found = Solved(mass, stiffness, damping, w, row["r"], loads, friction, belt=belt, **further)
    offset = np.linalg.solve(stiffness, np.array(row.get("offset", np.zeros(n))))
    return found, offset


def check_extremes(found, offset, row, tolerance):
    """Extremes of the masses; of a contact that stays stuck only their range is determined."""
    highest, lowest = found.highest[1] + offset, found.lowest[1] + offset
    size = max(np.abs(row["x_max"]).max(), np.abs(row["x_min"]).max())
    if row.get("mean_depends_on_start") or row.get("no_slip"):
        wanted = np.subtract(row["x_max"], row["x_min"])
        assert np.abs(highest - lowest - wanted).max() <= tolerance * max(size, 1e-300) or size == 0.0
    else:
        assert np.abs(highest - row["x_max"]).max() <= tolerance * size
        assert np.abs(lowest - row["x_min"]).max() <= tolerance * size


def test_any_periodic_load_and_belts(reference_table):
    content = reference_table("loads.json")
    for row in content["rows"]:
        found, offset = solved_row(row, content["systems"])
        assert found.resolved
        assert found.period == row["period"]
        assert found.counts[STOPS, 0] / found.period == row["stops_per_cycle"]
        share = 1.0 if not found.counts[MOVED, 0] else found.counts[STUCK, 0] / (2.0 * np.pi * found.period)
        assert abs(share - row["stuck_share"]) < 1e-10
        check_extremes(found, offset, row, 1e-10)


def test_varying_normal_load(reference_table):
    systems = reference_table("loads.json")["systems"]
    for row in reference_table("normal_load.json")["rows"]:
        normal = {int(n): complex(*value) for n, value in row["normal_load"].items()}
        found, offset = solved_row(row, systems, normal=normal)
        assert found.resolved
        assert found.counts[STOPS, 0] / found.period == row["stops_per_cycle"]
        assert abs(found.counts[STUCK, 0] / (2.0 * np.pi * found.period) - row["stuck_share"]) < 1e-10
        check_extremes(found, offset, row, 1e-10)


def test_elastic_contacts(reference_table):
    content = reference_table("elastic.json")
    for row in content["rows"]:
        found, offset = solved_row(row, content["systems"], spring=[row["kt"]])
        assert found.resolved
        check_extremes(found, offset, row, 1e-10)
        share = found.counts[STUCK, 0] / (2.0 * np.pi * found.period)
        if row["no_slip"]:  # a contact that creeps to the edge of its range touches it by rounding
            assert share > 1.0 - 1e-7
            continue
        always = found.counts[STUCK, 0] == 0.0
        slips = 1.0 if always else found.counts[SLIPS, 0] / found.period
        assert slips == row["slip_phases_per_cycle"]
        assert found.counts[REVERSALS, 0] / found.period == row["slip_reversals_per_cycle"]
        assert abs(share - row["elastic_share"]) < 1e-10


def test_several_contacts(reference_table):
    for row in reference_table("contacts.json")["steady_states"]:
        mass, stiffness, damping, w = (np.array(row[key]) for key in ("M", "K", "C1", "W"))
        load = np.array(row["load_re"]) + 1j * np.array(row["load_im"])
        beta = np.array(row["beta"])
        found = Solved(
            mass, stiffness, damping, w, row["r"], {1: load}, (beta, beta * np.array(row["mu"])),
            walls=row["s"], start=row["x_start"],
        )  # fmt: skip
        assert found.resolved, row["id"]
        assert np.array_equal(found.counts[STOPS] / found.period, row["stops_per_cycle"]), row["id"]
        assert np.array_equal(found.counts[TURNS] / found.period, row["turns_per_cycle"]), row["id"]
        rests = found.counts[MOVED] == 0.0
        assert np.array_equal(rests, np.array(row["regime"]) == 0), row["id"]
        stuck = np.where(rests, 1.0, found.counts[STUCK] / (2.0 * np.pi * found.period))
        assert np.abs(stuck - row["stuck_fraction"]).max() < 1e-9
        ranges = np.where(rests, 0.0, found.highest[0] - found.lowest[0])
        wanted = np.where(rests, 0.0, np.subtract(row["contact_max"], row["contact_min"]))
        assert np.abs(ranges - wanted).max() <= 1e-9 * wanted.max()


#: r, friction ratios, mu, stops, turns, amplitudes, shares stuck; two masses, contacts wall 1 and 1-2.
TWO_CONTACTS = [
    (0.5, (0.5, 0.2), (1.0, 1.0), (2, 2), (0, 2), (1.586051307411, 0.802820764235), (0.13987395, 0.19906992)),
    (0.9, (0.5, 0.2), (1.0, 1.0), (2, 2), (0, 0), (0.288461097321, 0.313157301758), (0.14567396, 0.17295440)),
    (0.9, (0.5, 0.05), (1.0, 1.0), (2, 0), (0, 2), (0.111489975059, 0.478943784635), (0.4050062779, 0.0)),
    (0.2, (0.3, 0.1), (1.0, 1.0), (2, 4), (0, 0), (0.807178956046, 0.112820289245), (0.46586746, 0.61797514)),
    (0.5, (0.5, 0.2), (1.5, 1.2), (2, 2), (0, 2), (1.624235853478, 0.831517347059), (0.19662546, 0.22710223)),
]  # fmt: skip


def two_contacts(forces, mu=(None, None), **further):
    """E1: two equal masses, the first against a wall and against the second."""
    contacts = [
        fm.Contact("fixed-wall", 1, force=forces[0], mu=mu[0]),
        fm.Contact("between-masses", (1, 2), force=forces[1], mu=mu[1]),
    ]
    return fm.System(
        contacts=contacts, mass_ratios=[1.0, 1.0], stiffness_ratios=[1.0, 1.0], damping_ratios=0.01, **further
    )


@pytest.mark.parametrize(("r", "forces", "mu", "stops", "turns", "amplitudes", "shares"), TWO_CONTACTS)
def test_two_contacts(r, forces, mu, stops, turns, amplitudes, shares):
    ds = fm.sweep(two_contacts(forces, mu), [r], [0.0], outputs=(*OUTPUTS, "contact_amplitude")).isel(
        mu=0, r=0, beta=0
    )
    assert ds.stops_per_cycle.values.tolist() == list(stops)
    assert ds.turns_per_cycle.values.tolist() == list(turns)
    assert np.allclose(ds.contact_amplitude, amplitudes, rtol=0.0, atol=1e-11)
    assert np.allclose(ds.stuck_fraction, shares, rtol=0.0, atol=1e-7)  # float32


def test_three_contacts():
    """E2 of the notes: five masses, contacts wall 1, 2-3 and wall 5."""
    contacts = [("fixed-wall", (1,), 0.3), ("between-masses", (2, 3), 0.2), ("fixed-wall", (5,), 0.1)]
    system = fm.System(
        contacts=[fm.Contact(kind, masses, force=force) for kind, masses, force in contacts],
        mass_ratios=[1.0] * 5, stiffness_ratios=[1.0] * 5, damping_ratios=0.01,
    )  # fmt: skip
    ds = fm.response(system, 0.4, 0.0)
    assert ds.stops_per_cycle.values.tolist() == [4.0, 2.0, 2.0]
    wanted = (0.517703340139, 0.318990635327, 0.869384830430)
    assert np.allclose(ds.contact_amplitude, wanted, rtol=0.0, atol=1e-11)
    balance = ds.work_input - ds.work_damping - ds.work_friction.sum()
    assert abs(float(balance)) < 1e-11 * float(ds.work_input)


#: zeta, loads, r, beta, wall velocity, stops, share stuck, extremes of x; one mass, mu = 1.
PERIODIC_LOADS = [
    (0.05, {1: 1.0, 2: 0.6 * np.exp(-1j * np.radians(70.0))}, 1.191, 1.00442, 0.0, 2, 0.45154034026,
     (-0.03732371066, 0.17594857068)),
    (0.01, {1: 1.0, 3: 0.4 * np.exp(1j * np.radians(50.0))}, 0.93, 1.07224, 0.5, 2, 0.29394133316,
     (-0.57020497536, 1.36456001350)),
]  # fmt: skip


@pytest.mark.parametrize(("zeta", "load", "r", "beta", "velocity", "stops", "share", "ends"), PERIODIC_LOADS)
def test_one_mass_under_two_harmonics(zeta, load, r, beta, velocity, stops, share, ends):
    system = fm.System(damping_ratios=zeta, load_harmonics=load, wall_velocity=velocity)
    ds = fm.response(system, r, beta)
    assert float(ds.stops_per_cycle) == stops
    assert float(ds.stuck_fraction) == pytest.approx(share, abs=1e-7)
    lowest = float(ds.midpoint[0] - 0.5 * ds.peak_to_peak[0])
    highest = float(ds.midpoint[0] + 0.5 * ds.peak_to_peak[0])
    assert (lowest, highest) == pytest.approx(ends, abs=2e-11)
    assert float(ds.x.min()) == pytest.approx(lowest, abs=1e-5)
    assert float(ds.x.max()) == pytest.approx(highest, abs=1e-5)


#: Griffin's damper, one mass, zeta 0.01: contact stiffness, friction with the least peak, r and height of it.
LEAST_PEAKS = [
    (0.3, 1.2916, 1.07265, 8.5506118),
    (1.0, 1.4596, 1.22504, 2.9159968),
    (10.0, 1.5178, 2.44105, 0.30871698),
]


@pytest.mark.parametrize(("stiffness", "beta", "r", "peak"), LEAST_PEAKS)
def test_least_peak_of_an_elastic_damper(stiffness, beta, r, peak):
    """At the optimum two maxima are equally high: the larger of both has the height of the notes to their
    digits of beta.
    """
    system = fm.System(damping_ratios=0.01, contact_stiffness=stiffness)
    near = np.linspace(0.999 * r, 1.001 * r, 81)
    ds = fm.curves(system, near, [beta], quantities=["amplitude"])
    assert float(ds.amplitude.max()) == pytest.approx(peak, rel=2e-5)


def test_harmonics_and_distances(reference_table):
    content = reference_table("loads.json")
    for row in content["rows"][::3]:
        system = content["systems"][row["system"]]
        if row["wall_velocity"] and system["contact"][0] != "wall":
            continue  # a belt between masses is no system of the package
        given = chain(
            system, row["zeta"], load_harmonics=phasors(row["harmonics"]), load_offset=row["offset"],
            wall_velocity=row["wall_velocity"],
        )  # fmt: skip
        ds = fm.response(given, row["r"], row["beta"], row["mu"], points=2)
        size = np.abs(row["x_max"]).max()
        for n in (1, 2):
            x = ds.displacement_harmonic.sel(harmonic=n).values
            z = ds.contact_harmonic.sel(harmonic=n).values
            wanted = np.array(row[f"harmonic_{n}"])
            assert np.abs(np.vstack((x, z)) - wanted).max() <= 1e-10 * size
        assert float(ds.sliding_distance) == pytest.approx(
            row["sliding_distance"], abs=1e-10 * max(size, 1.0)
        )
