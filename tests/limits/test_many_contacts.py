"""Nine to 64 contacts: against rows of two other programs, equivalent systems, and second starts."""

import dataclasses

import numpy as np
import pytest
from general_systems import frame

import frictionmap as fm
from benchmarks.measures import second_starts


def ranges(system, r, beta, **further):
    """Ranges of the contacts in one cell, which must be resolved."""
    outputs = ("contact_peak_to_peak", "stops_per_cycle", "slips_per_cycle", "stuck_fraction")
    ds = fm.sweep(system, [r], [beta], outputs=outputs, **further)
    assert ds.status.item() == fm.regimes.RESOLVED
    return ds


def test_a_frame_of_20_storeys(reference_table):
    """Rigid and elastic dampers: ranges and counts."""
    for row in reference_table("continuous.json")["rows"]:
        if row["kind"] != "frame-20":
            continue
        given, wanted = row["given"], row["expect"]
        friction, kt = np.array(given["beta"]), given["kt_over_k"]
        first = frame(20, stiffness=kt).modes.w[0]
        # r and displacements are over the first natural frequency there
        system = frame(20, friction=friction, stiffness=kt)
        ds = ranges(system, given["r"] * first, 1.0)
        found = ds.contact_peak_to_peak.values.ravel() * first**2
        largest = max(wanted["contact_peak_to_peak"])
        assert found == pytest.approx(wanted["contact_peak_to_peak"], abs=1e-10 * largest), row["id"]
        counts = "slips_per_cycle" if kt else "stops_per_cycle"
        assert ds[counts].values.ravel().tolist() == wanted[counts], row["id"]


@pytest.mark.parametrize(("n", "seed"), [(5, 0), (6, 1), (8, 2)])
def test_contacts_without_friction_change_nothing(n, seed):
    """With nine contacts derivatives are carried in the coordinates that held ones leave free."""
    friction = np.random.default_rng(seed).uniform(0.2, 1.0, n)
    few = frame(n, friction=friction)
    idle = [fm.Contact("fixed-wall", 2 + j, ratio=0.0) for j in range(9 - n)]
    many = dataclasses.replace(few, contacts=[*few.contacts, *idle])
    r = few.modes.w[0] * np.array([0.8, 1.7, 4.0])
    beta = fm.boundaries(few, r).beta_stick.values.min() * np.array([0.3, 0.6, 0.9])
    outputs = ("contact_peak_to_peak", "stops_per_cycle", "multiplier")
    wanted, found = (fm.sweep(system, r, beta, outputs=outputs) for system in (few, many))
    own = found.isel(contact=slice(n))
    largest = wanted.contact_peak_to_peak.values.max()
    assert (wanted.stops_per_cycle > 0).any()
    assert own.contact_peak_to_peak.values == pytest.approx(
        wanted.contact_peak_to_peak.values, abs=1e-12 * largest
    )
    assert np.array_equal(own.stops_per_cycle, wanted.stops_per_cycle, equal_nan=True)
    # a double multiplier moves by the root of rounding errors
    assert found.multiplier.values == pytest.approx(wanted.multiplier.values, abs=1e-6, nan_ok=True)


def test_equal_dampers_reach_their_limits_together():
    """The loads of all of them are equal where they hold: the rates of the forces decide which let go."""
    ds = fm.sweep(frame(8, friction=1.0), [1.3], 0.3 * np.linspace(1.0, 1.08, 9))
    assert (ds.status == fm.regimes.RESOLVED).sum() >= 8


def test_doubled_contacts():
    """Two dampers with half the friction and half the stiffness each are one."""
    one = frame(9, stiffness=2.0)
    halves = [
        fm.Contact(c.kind, c.masses, ratio=0.5 * c.ratio, stiffness=1.0)
        for c in one.contacts
        for _ in range(2)
    ]
    ones = [1.0] * 9
    two = fm.System(
        contacts=halves, mass_ratios=ones, stiffness_ratios=ones, damping_ratios=0.03, load_mass=9
    )
    found = ranges(two, 0.3, 0.2).contact_peak_to_peak.values.reshape(9, 2)
    wanted = ranges(one, 0.3, 0.2).contact_peak_to_peak.values.ravel()
    assert found == pytest.approx(np.stack((wanted, wanted), axis=1), abs=1e-11 * wanted.max())


@pytest.mark.parametrize(
    ("n", "stiffness"),
    [(9, None), (9, 2.0), (12, None)] + [pytest.param(n, None, marks=pytest.mark.slow) for n in (20, 33)],
)
def test_the_bits_of_a_cell_do_not_depend_on_others(n, stiffness):
    """Rows of cells at once, every other cell, and cell by cell, on one and two threads."""
    rng = np.random.default_rng(n)
    system = frame(n, friction=rng.uniform(0.3, 1.0, n), stiffness=stiffness)
    r = np.array([2.0, 5.0]) * system.modes.w[0]
    stick = fm.boundaries(system, r)["beta_noslip" if stiffness else "beta_stick"].min().item()
    beta = stick * np.linspace(0.05, 1.1, 12 if n < 12 else 6 if n < 33 else 3)
    outputs = ("contact_amplitude", "contact_midpoint", "sliding_distance", "stuck_fraction", "multiplier")
    whole = fm.sweep(system, r, beta, outputs=outputs, threads=1)
    assert (whole.status == fm.regimes.RESOLVED).all()
    assert np.unique(whole.contact_amplitude).size > n
    assert whole.equals(fm.sweep(system, r, beta, outputs=outputs, threads=2))
    # without multipliers derivatives are kept from one return to the next, and not followed once more
    less = fm.sweep(system, r, beta, outputs=outputs[:-1], threads=2)
    assert all(less[name].equals(whole[name]) for name in less.data_vars)
    for part in (slice(0, None, 2), slice(1, None, 2), *([k] for k in range(beta.size))):
        alone = fm.sweep(system, r, beta[part], outputs=outputs, threads=2)
        assert alone.equals(whole.isel(beta=part)), part


@pytest.mark.parametrize("n", [9, 16, 32])
def test_second_starts(n):
    """A motion from rest and one from far away end alike: n contacts of random friction, rigid or elastic."""
    rng = np.random.default_rng(n)
    friction = rng.uniform(0.3, 1.0, n)
    for stiffness in (None, 1.0):
        system = frame(n, friction=friction, stiffness=stiffness, zeta=0.05)
        r = 5.0 * system.modes.w[0]
        beta = 0.3 * fm.boundaries(system, [r])["beta_noslip" if stiffness else "beta_stick"].item()
        found = [
            ranges(system, r, beta, start=start).contact_peak_to_peak.values.ravel()
            for start in ("rest", "moving")
        ]
        assert found[0] == pytest.approx(found[1], abs=1e-12 * found[0].max())


@pytest.mark.slow
@pytest.mark.parametrize("count", [9, 16, 24])
@pytest.mark.parametrize("grounds", [False, True])
def test_second_starts_of_contacts_that_close_loops(count, grounds):
    """Rings of unequal sectors with rigid dampers between neighbours, and to the ground."""
    rng = np.random.default_rng(count)
    contacts = [{"kind": "between-masses", "masses": [1, "next.1"]}]
    contacts += [{"kind": "fixed-wall", "masses": 1, "ratio": 0.3}] if grounds else []
    sectors = {
        "count": count, "mass": [[1.0]], "stiffness": [[0.6]], "engine_order": 2,
        "coupling": [{"masses": [1, 1], "stiffness": 0.5}],
        "spread": {"standard_deviation": 0.03, "seed": count},
    }  # fmt: skip
    system = fm.ring(sectors=sectors, contacts=contacts, load_mass=1, damping_ratios=0.05)
    beta = rng.uniform(0.2, 0.7) * fm.boundaries(system, [1.1])["beta_stick"].item()
    found = [
        ranges(system, 1.1, beta, start=start).contact_peak_to_peak.values.ravel()
        for start in ("rest", "moving")
    ]
    assert found[0].max() > 0.01
    assert found[0] == pytest.approx(found[1], abs=1e-12 * found[0].max())


@pytest.mark.slow
@pytest.mark.parametrize("k", range(6))
def test_random_systems_end_alike_from_two_starts(k):
    """Frames and rings of 9 to 12 contacts; the benchmark has 500 of up to 64."""
    kind, ended, _ = second_starts.check(k, quick=True)
    assert ended == "same", kind


def crowded(seed):
    """Some masses with several contacts each: a rigid one under a varying normal load, the others springs."""
    rng = np.random.default_rng(seed)
    n = int(rng.integers(9, 14))
    rng.random()
    masses = int(rng.integers(4, n + 1))
    rng.integers(0, 6)
    contacts, taken = [], set()
    for _ in range(n):
        j = int(rng.integers(1, masses + 1))
        given = {"stiffness": rng.uniform(0.3, 3.0)} if j in taken else {}
        given = given or {"normal_load": {1: float(rng.uniform(0.1, 0.5))}}
        taken.add(j)
        contacts.append(fm.Contact("fixed-wall", j, ratio=float(rng.uniform(0.3, 1.0)), **given))
    ratios = [[1.0, *rng.uniform(0.5, 2.0, masses - 1)] for _ in range(2)]
    system = fm.System(
        contacts=contacts, mass_ratios=ratios[0], stiffness_ratios=ratios[1],
        damping_ratios=float(rng.uniform(0.01, 0.08)), load_mass=int(rng.integers(1, masses + 1)),
    )  # fmt: skip
    return system, float(rng.uniform(0.5, 6.0)) * system.modes.w[0]


@pytest.mark.parametrize("seed", [111, 3, 8])
def test_contacts_at_the_edge_of_a_slip(seed):
    """A cell beside one far away is as it is alone: of 111 the search ends at a limit of a spring."""
    system, r = crowded(seed)
    beta = np.array([0.3, 0.31, 0.32, 0.6, 0.9])
    row = fm.sweep(system, [r], beta, outputs=("contact_amplitude",))
    assert (row.status == fm.regimes.RESOLVED).all()
    for k in range(beta.size):
        alone = fm.sweep(system, [r], beta[k : k + 1], outputs=("contact_amplitude",))
        found, wanted = row.contact_amplitude.values[..., k, :], alone.contact_amplitude.values[..., 0, :]
        assert found == pytest.approx(wanted, abs=1e-11), k


def test_at_most_64_contacts():
    contacts = [fm.Contact("between-masses", (1, 2), stiffness=1.0)] * 65
    with pytest.raises(fm.InputError, match="at most 64"):
        fm.System(contacts=contacts, mass_ratios=[1, 1], stiffness_ratios=[1, 1])
