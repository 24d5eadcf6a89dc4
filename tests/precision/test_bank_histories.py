"""Motions under records of banks as one contact: against their elements one by one, and what is proved."""

from dataclasses import replace

import numpy as np
import pytest

import frictionmap as fm
from frictionmap.command_line.cli import main

CHAIN = {"mass_ratios": [1.0, 0.8], "stiffness_ratios": [1.0, 1.2], "damping_ratios": 0.02}
SHAKEN = {"excitation": "base", "damping_ratios": 0.03}
ONE = {"damping_ratios": 0.03}


def bank(k, u, **own):
    """A contact whose elements of stiffness k slip at elongations u times beta."""
    return fm.Contact(stiffness=list(k), ratio=list(np.multiply(k, u)), **own)


def drawn(seed, n):
    """Stiffness and elongations of n elements."""
    rng = np.random.default_rng(seed)
    return rng.uniform(0.1, 1.0, n) * 2.0 / n, rng.uniform(0.05, 2.0, n)


def noise(seed, count=60, dt=0.3, **own):
    """A record that begins at rest and has loops within loops."""
    values = np.convolve(np.random.default_rng(seed).normal(size=count), [0.5, 1.0, 0.5], mode="same")
    values[0] = 0.0
    return fm.Record(values, dt, **{"quantity": "force", **own})


def as_one(contacts, kind="contact"):
    """The contacts with every bank as one contact, or as its elements."""
    return [replace(one, bank=kind if isinstance(one.stiffness, tuple) else None) for one in contacts]


K, U = drawn(1, 12)
WALL = bank(K, U)
TWO = [
    bank(K, U, masses=2),
    bank(K[:4], U[:4]),
    fm.Contact("between-masses", (1, 2), stiffness=1.3, ratio=0.4),
]
SHOCK, DROP = noise(11, quantity="acceleration"), noise(13, quantity="displacement", interpolation="cubic")
CASES = {
    "noise": ([WALL], ONE, noise(1)),
    "long steps": ([WALL], ONE, noise(2, 20, 2.5)),
    "a spline": ([WALL], ONE, noise(3, interpolation="cubic")),
    "held samples": ([WALL], ONE, noise(4, interpolation="hold")),
    "a step from rest": ([WALL], ONE, fm.Record([-1.0, -1.0], 4.0, quantity="force", interpolation="hold")),
    "a run-up": ([WALL], ONE, fm.Record.sweep(0.5, 1.8, 40.0, quantity="force")),
    "equal thresholds": ([bank(K, np.round(2.0 * U) / 2.0 + 0.25)], ONE, noise(5)),
    "all at once": ([bank(K, np.full(12, 0.6))], ONE, noise(6)),
    "one stiff element": ([bank([1e4, *K], [1e-5, *U])], ONE, noise(7)),
    "given forces": ([fm.Contact(stiffness=[0.6, 0.3], force=[0.1, 0.2])], ONE, noise(8)),
    "no spring beside": ([WALL], {"stiffness_ratios": [0.0]}, noise(9)),
    "two banks and an element": (TWO, CHAIN, noise(10, mass=2)),
    "a wall that moves with the base": ([replace(WALL, kind="joined-base-wall")], SHAKEN, SHOCK),
    "a wall at rest": ([WALL], SHAKEN, noise(12, quantity="acceleration")),
    "a displacement of the base": ([WALL], SHAKEN, DROP),
}  # fmt: skip

#: Variables that are of the structure; of contacts those of the element that slips first, and sums.
WHOLE = (
    "x", "v", "acceleration", "amplitude", "acceleration_amplitude", "base_force", "x_max", "x_min",
    "residual", "work_load", "work_walls", "work_damping", "energy", "end_time", "beta_hold",
)  # fmt: skip
FIRST = (
    "z", "z_max", "z_min", "contact_amplitude", "sliding_distance", "largest_slide", "slips", "turns",
    "stuck_fraction", "contact_residual",
)  # fmt: skip
SUMS = ("friction", "work_friction")


def of_banks(contacts, values, how):
    """Values of the elements (..., element, ...) as those of their banks; `how` first or sum."""
    found, at = [], 0
    for one in contacts:
        own = values[:, at : at + len(one.elements)]
        first = np.argmin([(each.ratio or each.force) / each.stiffness for each in one.elements])
        found.append(own.sum(axis=1) if how == "sum" else own[:, first])
        at += len(one.elements)
    return np.stack(found, axis=1)


def of_contacts(ds, name):
    """Values (scale, contact, ...)."""
    values = ds[name].squeeze(("record", "mu", "beta"))
    return (values if "contact" in values.dims else values.expand_dims("contact", 1)).values


@pytest.mark.parametrize("case", CASES)
def test_a_bank_is_its_elements(case):
    contacts, system, record = CASES[case]
    after = 10.0 if case in ("no spring beside", "a wall at rest") else "rest"
    asked = {"beta": 0.6, "scale": [0.8, 1.0], "after": after}
    one, each = (
        fm.history(fm.System(contacts=as_one(contacts, kind), **system), record, **asked)
        for kind in ("contact", "elements")
    )
    assert (one.status == 0).all()
    np.testing.assert_array_equal(one.status, each.status)
    assert (of_contacts(one, "slips") > 3).any()
    for name in WHOLE:
        size = max(1.0, np.abs(np.nan_to_num(each[name].values)).max())
        np.testing.assert_allclose(
            one[name].values, each[name].values, rtol=0.0, atol=1e-11 * size, err_msg=name
        )
    for names, how in ((FIRST, "first"), (SUMS, "sum")):
        for name in names:
            found, expected = of_contacts(one, name), of_banks(contacts, of_contacts(each, name), how)
            size = max(1.0, np.abs(np.nan_to_num(expected)).max())
            np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-11 * size, err_msg=name)
    if after == "rest":
        np.testing.assert_allclose(one.asleep_time, each.asleep_time, rtol=1e-14)


def test_events_are_those_of_the_element_that_slips_first():
    contacts, system, record = CASES["noise"]
    one, each = (
        fm.history(fm.System(contacts=as_one(contacts, kind), **system), record, 0.6).squeeze()
        for kind in ("contact", "elements")
    )
    own = each.event_contact.values == 1 + np.argmin(U)
    assert one.event_kind.values.tolist() == each.event_kind.values[own].tolist()
    np.testing.assert_allclose(one.event_time, each.event_time.values[own], rtol=0.0, atol=1e-9)
    assert one.first_motion.item() == pytest.approx(each.first_motion.item(), abs=1e-11)


def test_the_energies_balance_over_time():
    contacts, system, record = CASES["two banks and an element"]
    system = fm.System(contacts=as_one(contacts), **system | {"damping_ratios": 0.0})
    ds = fm.history(system, record, 0.6, after=20.0).squeeze()
    assert ds.lost_friction.values[:, -1] == pytest.approx(ds.work_friction.values, rel=1e-13)
    assert ds.stored_energy.values[-1] == pytest.approx(ds.energy.item(), rel=1e-12)
    # what the load has done is stored, or lost in the contacts
    total = (ds.stored_energy + ds.lost_friction.sum("contact")).values
    assert total[-1] == pytest.approx(ds.work_load.item(), rel=1e-12)
    after = ds.time.values >= record.times[-1]
    assert np.ptp(total[after]) < 1e-12 * total[-1]


JOINT = fm.System(contacts=as_one([WALL]), damping_ratios=0.01)
STILL = fm.Record([0.0, 0.0], 0.2, quantity="force")


def test_a_lap_joint_rings_down_until_it_is_asleep():
    """It rests away from the middle, where the stretched springs balance; nothing slips again."""
    ds = fm.history(JOINT, STILL, 0.5, start={"x": [3.0], "v": [0.0]})
    assert ds.status.item() == 0
    rest, k = ds.residual.item(), K[np.argsort(U, kind="stable")]
    stretch = ds.elongation.values.ravel() + rest - ds.x.values.ravel()[-1]
    assert 0.01 < abs(rest) < 1.0
    assert rest + k @ stretch == pytest.approx(0.0, abs=1e-14)
    assert (np.abs(stretch) < 0.5 * np.sort(U)).all()
    later = fm.history(JOINT, STILL, 0.5, start=ds, after=2000.0)
    assert later.slips.item() == 0
    assert later.asleep_time.item() == pytest.approx(STILL.times[-1])
    assert later.x.values.ravel()[-1] == pytest.approx(rest, abs=1e-7)


def test_turning_points_of_a_decay_are_among_the_samples():
    """A mass that turns is at rest there: its displacements are those of the envelope."""
    ds = fm.history(JOINT, STILL, 0.5, start={"x": [3.0], "v": [0.0]})
    x, v = ds.x.values.ravel(), ds.v.values.ravel()
    turns = np.flatnonzero(np.abs(v) < 1e-13)
    assert turns.size > 20
    signs = np.sign(x[turns])
    assert (np.diff(turns[np.append(True, np.diff(signs) != 0)]) > 0).all()
    peaks = x[turns]
    assert peaks.max() == ds.x_max.item()
    assert peaks.min() == ds.x_min.item()


@pytest.mark.parametrize("cut", [17, 33])
def test_a_record_that_is_cut_continues(cut):
    contacts, system, record = CASES["two banks and an element"]
    system = fm.System(contacts=as_one(contacts), **system)
    parts = [
        fm.Record(values, 0.3, quantity="force", mass=2)
        for values in (record.values[: cut + 1], record.values[cut:])
    ]
    first = fm.history(system, parts[0], 0.6, after=0.0)
    second = fm.history(system, parts[1], 0.6, after=0.0, start=first)
    whole = fm.history(system, record, 0.6, after=0.0)
    for name in ("x", "v", "friction"):
        ends = [ds[name].squeeze().values[:, -1] for ds in (second, whole)]
        np.testing.assert_allclose(*ends, rtol=0.0, atol=1e-12, err_msg=name)
    np.testing.assert_allclose(second.elongation, whole.elongation, rtol=0.0, atol=1e-12)
    for name in ("work_friction", "sliding_distance", "work_load"):
        total = first[name] + second[name]
        np.testing.assert_allclose(total, whole[name], rtol=1e-12, err_msg=name)


@pytest.mark.parametrize("system", [ONE, CHAIN], ids=["one mass", "two masses"])
def test_a_steady_state_continues_under_its_own_load(system):
    """From the state of a response at tau = 0, elements that never slip included."""
    r, contacts = 0.8, as_one([bank(K, [*U[:-1], 50.0])])
    load = [-1.0j] if system is ONE else [-1.0j, 0.0]  # a sine, as the record
    system = fm.System(contacts=contacts, load=load, **system)
    steady = fm.response(system, r, 0.4)
    force = fm.Record.sweep(r, r, 4.0 * np.pi / r, quantity="force")
    ds = fm.history(system, force, 0.4, start=steady, after=0.0).squeeze()
    for name in ("x", "v"):
        end = steady[name].values[:, -1] * (r if name == "v" else 1.0)
        found = ds[name].values.reshape(end.size, -1)[:, -1]
        np.testing.assert_allclose(found, end, rtol=0.0, atol=1e-10, err_msg=name)
    np.testing.assert_allclose(ds.elongation, steady.elongation, rtol=0.0, atol=1e-10)
    assert ds.work_friction.item() == pytest.approx(2.0 * steady.work_friction.item(), rel=1e-9)


def test_bounds_of_motions_hold_for_banks():
    """Under another record, and with more friction: see the bounds."""
    from frictionmap.motions.bounds import friction_bounds, record_bounds

    contacts, system, record = CASES["two banks and an element"]
    system = fm.System(contacts=as_one(contacts), **system)
    other = replace(record, values=1.05 * record.values)
    one, two = (fm.history(system, given, [0.6, 0.63], after=0.0) for given in (record, other))
    apart = np.abs(one.x_max - two.x_max).isel(beta=0).squeeze()
    assert (apart <= record_bounds(system, record, other).amplitude.squeeze()).all()
    step = np.abs(one.x_max.diff("beta")).squeeze()
    assert (step <= friction_bounds(system, one.isel(beta=[0]), 0.03).amplitude.squeeze()).all()


def test_friction_that_holds_all_elements():
    """With it nothing slips, with 1e-9 less something does."""
    system, record = fm.System(contacts=as_one([WALL]), **ONE), CASES["noise"][2]
    hold = fm.history(system, record, 0.1).beta_hold.item()
    ds = fm.history(system, record, [hold * (1.0 - 1e-9), hold * (1.0 + 1e-9)], samples="none")
    assert ds.slips.values.ravel().tolist() == [1.0, 0.0]


def test_the_same_bits_for_any_number_of_threads():
    system, records = fm.System(contacts=as_one([WALL]), **ONE), [noise(20), noise(21)]
    one, two = (fm.history(system, records, [0.2, 0.6], threads=threads) for threads in (1, 2))
    for name in ("x", "amplitude", "work_friction", "elongation"):
        np.testing.assert_array_equal(one[name].values, two[name].values)


def test_a_start_without_elongations_is_refused():
    system, record = fm.System(contacts=as_one([WALL]), **ONE), noise(22)
    ds = fm.history(system, record, 0.6, samples=7)
    with pytest.raises(fm.InputError, match=r'start must have its last sample at its end.*samples = "all"'):
        fm.history(system, record, 0.6, start=ds)
    with pytest.raises(fm.InputError, match=r"start must have .*elongation"):
        fm.history(system, record, 0.6, start=fm.history(system, record, 0.6).drop_vars("elongation"))
    given = fm.history(system, record, 0.6)
    with pytest.raises(fm.InputError, match="start must have 12 elements, as the system has; got 5"):
        fm.history(system, record, 0.6, start=given.isel(element=slice(0, 5)))


def test_a_configuration_continues_from_a_file(tmp_path):
    """The state of the elements is in the file of a motion, and so is all else."""
    text = """\
[system]
damping_ratios = 0.03
[[system.contacts]]
bank = "contact"
stiffness = [0.5, 0.3, 0.2]
ratio = [0.2, 0.3, 0.5]
[record]
quantity = "force"
pulse = { kind = "half-sine", amplitude = 2.0, duration = 3.0 }
after = 4.0
[history]
beta = [0.5]
"""
    (tmp_path / "first.toml").write_text(text)
    (tmp_path / "second.toml").write_text(text + 'start = "first.nc"\n')
    for name in ("first", "second"):
        assert main(["history", str(tmp_path / f"{name}.toml"), "-o", str(tmp_path / f"{name}.nc")]) == 0
    first, second = (fm.open(tmp_path / f"{name}.nc") for name in ("first", "second"))
    assert first.slips.item() > 0
    assert second.x.values.ravel()[0] == pytest.approx(first.x.values.ravel()[-1], abs=1e-15)
    assert second.y.values.ravel()[0] == pytest.approx(first.y.values.ravel()[-1], abs=1e-15)
    assert first.element_contact.values.tolist() == [1, 1, 1]
