"""Contacts that open and piecewise linear springs on a base that moves over the ground, and under records of
every interpolation; the friction from which nothing moves.
"""

import numpy as np
import pytest
from opening_truth import Course, Truth
from test_opening_histories import (
    BOTH,
    FIRST,
    GAP,
    MATRICES,
    PLAY,
    PUSH,
    check_against,
    elements_of,
    noise,
    system_of,
)

import frictionmap as fm

ON_BASE = {"excitation": "base", "damping_reference": "base"}
WEDGE = {"d": FIRST, "kn": 0.3, "phi": 0.3, "N0": 1.0}
DT = 0.35


def shaken(seed, how="linear", count=50):
    """Accelerations of a base that stays near its place: second differences of smooth random places."""
    random = np.random.default_rng(seed).normal(size=count + 2)
    place = np.convolve(random, np.hanning(13) / 4.0, mode="same")
    place[:3] = 0.0
    return fm.Record(np.diff(place, 2) / DT**2, DT, interpolation=how)


def course_of(record):
    return Course.through(record.times, record.values, record.interpolation)


ON_THE_BASE = {
    "wall at rest, spring": ({"kt": 3.0}, []), "wall at rest": ({"mu": 1.2}, []),
    "joined wall, spring": ({"moved": 1.0, "kt": 3.0}, [GAP]), "joined wall": ({"moved": 1.0}, []),
    "springs": ({"kt": 3.0}, [GAP, PLAY]), "wedge": (WEDGE, []), "open at first": ({"N0": -0.3}, [GAP]),
    "belt": ({"kt": 3.0, "belt": 0.2}, []),
}  # fmt: skip


@pytest.mark.parametrize("case", ON_THE_BASE)
def test_a_base_that_moves_over_the_ground(case):
    """What presses the contact, and the stop, are on the ground."""
    changed, springs = ON_THE_BASE[case]
    own = BOTH | changed
    system, record = system_of(own, springs, **ON_BASE), shaken(11)
    truth = Truth(MATRICES, own, elements_of(system), None, course_of(record))
    check_against(truth, fm.history(system, record, after=0.0))


@pytest.mark.parametrize("how", ["cubic", "hold"])
@pytest.mark.parametrize("base", [False, True])
@pytest.mark.parametrize("case", ["wall at rest, spring", "wall at rest", "springs", "wedge"])
def test_records_of_other_interpolations(case, base, how):
    changed, springs = ON_THE_BASE[case]
    own = BOTH | changed
    system = system_of(own, springs, **(ON_BASE if base else {}))
    given = noise(12)
    record = fm.Record(given.values, DT, quantity="force", vector=PUSH, interpolation=how)
    record = shaken(12, how) if base else record
    truth = Truth(MATRICES, own, elements_of(system), None if base else PUSH, course_of(record))
    check_against(truth, fm.history(system, record, after=0.0))


@pytest.mark.parametrize("quantity", ["velocity", "displacement"])
def test_the_same_base_by_its_velocity_and_its_displacement(quantity):
    """A cubic displacement has linear accelerations, a linear velocity has constant ones."""
    system = system_of(BOTH | {"kt": 3.0}, [GAP, PLAY], **ON_BASE)
    random = np.random.default_rng(13).normal(size=40)
    values = np.convolve(random, np.hanning(13) / 4.0, mode="same")
    values[:2] = 0.0
    record = fm.Record(values, DT, quantity=quantity)
    rates = record.pieces.terms[:, 1:4] / DT ** np.arange(1, 4) * [1.0, 2.0, 6.0]
    given = (
        rates[:, 0] if quantity == "velocity" else np.append(rates[:, 1], rates[-1, 1] + DT * rates[-1, 2])
    )
    how = "hold" if quantity == "velocity" else "linear"
    same = fm.Record(given, DT, interpolation=how)
    one, two = (fm.history(system, each, after=0.0) for each in (record, same))
    assert one["events"].item() == two["events"].item() > 5
    for name in (
        "x_max",
        "x_min",
        "acceleration_max",
        "normal_force_max",
        "spring_force_max",
        "work_friction",
    ):
        np.testing.assert_allclose(one[name], two[name], rtol=0.0, atol=1e-10, err_msg=name)


@pytest.mark.parametrize("changed", [{"kt": 3.0}, {}, {"moved": 1.0, "kt": 3.0}])
def test_a_shaken_base_ends_in_the_steady_state(changed):
    """Steady states are those in space; the base of a long sine comes and goes slowly."""
    system, r, cycles = system_of(BOTH | changed, [GAP], **ON_BASE), 1.3, 300
    steady = fm.response(system, r, 0.2)
    assert steady["period"].item() == 1
    period = 2.0 * np.pi / r
    record = fm.Record.sweep(
        r, r, cycles * period, quantity="displacement", amplitude=1.0, rise=12 * period, fall=period
    )
    ds = fm.history(system, record, after=0.0)
    k = np.abs(ds["time"].values - (cycles - 2.75) * period).argmin()  # sin is there what cos is at 0
    assert ds["time"].values[k] == pytest.approx((cycles - 2.75) * period, abs=1e-9)
    for name, factor, base in (("x", 1.0, 1.0), ("v", r, 0.0)):
        found = ds[name].squeeze().values[:, k] + base
        np.testing.assert_allclose(found, factor * steady[name].values[:, 0], rtol=0.0, atol=1e-9)


def fine(record, parts=40):
    """The same straight lines by more samples."""
    count = parts * (record.values.size - 1) + 1
    times = np.linspace(0.0, record.duration, count)
    return fm.Record(np.interp(times, record.times, record.values), DT / parts)


def test_the_direction_of_an_open_contact_is_that_relative_to_its_wall():
    ds = fm.history(system_of(BOTH | {"kt": 3.0}, **ON_BASE), fine(shaken(11)), after=0.0)
    opened, direction = ds["open"].values.ravel() == 1, ds["direction"].values.ravel()
    v, way = ds["v"].squeeze().values[0], np.diff(ds["z"].values.ravel())
    inside = opened[:-1] & opened[1:] & (direction[:-1] == direction[1:]) & (way != 0.0)
    assert inside.sum() > 50
    assert (np.sign(way) == direction[:-1])[inside].all()
    assert (np.sign(v[:-1]) != direction[:-1])[inside].any()  # its mass alone may move the other way


HOLDING = {
    "spring": ({"kt": 3.0}, []), "rigid": ({"mu": 1.3}, []), "wedge": (WEDGE, []),
    "springs": ({"kt": 3.0}, [GAP, PLAY]),
}  # fmt: skip


@pytest.mark.parametrize("case", HOLDING)
@pytest.mark.parametrize("base", [False, True])
@pytest.mark.parametrize("scale", [1.0, -0.6])
def test_nothing_moves_from_beta_hold_on(case, base, scale):
    changed, springs = HOLDING[case]
    system = system_of(BOTH | changed | {"N0": None}, springs, **(ON_BASE if base else {}))
    record = shaken(14) if base else noise(14)
    # a base that moves on after its record moves contacts that hold during it
    asked = {"scale": scale, "samples": "none", "after": 0.0 if base else "rest"}
    hold = fm.history(system, record, **asked)["beta_hold"].item()
    assert hold > 0.0
    asked["beta_hold"] = False
    above, below = (fm.history(system, record, beta=hold * (1.0 + e), **asked) for e in (1e-9, -1e-9))
    assert np.isnan(above["first_motion"].item())
    assert above["sliding_distance"].item() == above["separations"].item() == 0.0
    assert np.isfinite(below["first_motion"].item())


def test_beta_hold_counts_what_comes_after_the_record():
    """The largest force in a contact is that of the free vibration after a short pulse."""
    system = system_of(BOTH | {"kt": 3.0, "N0": None}, [PLAY])
    pulse = fm.Record.pulse("half-sine", 1.0, 0.5, quantity="force", vector=PUSH)
    hold = fm.history(system, pulse)["beta_hold"].item()
    during = fm.history(system, pulse, after=0.0)["beta_hold"].item()
    assert during < 0.9 * hold
    asked = {"samples": "none", "beta_hold": False}
    above, below = (fm.history(system, pulse, beta=hold * (1.0 + e), **asked) for e in (1e-9, -1e-9))
    assert np.isnan(above["first_motion"].item())
    assert below["first_motion"].item() > pulse.duration


def test_beta_hold_of_preloads_of_their_own():
    """The friction axis does not change them: they hold at any beta or at none; a gap that closes decides."""
    record = noise(15)
    for own in (BOTH | {"kt": 3.0}, BOTH | {"mu": 1.2}):
        for scale in (0.01, 1.0):
            ds = fm.history(system_of(own), record, scale=scale, samples="none")
            moves = np.isfinite(ds["first_motion"].item())
            assert moves == (scale == 1.0)
            assert ds["beta_hold"].item() == (np.inf if moves else 0.0)
    gap = system_of(BOTH | {"N0": -0.3})
    assert np.isnan(fm.history(gap, record, samples="none")["beta_hold"].item())
    assert fm.history(gap, record, scale=0.01, samples="none")["beta_hold"].item() == 0.0


def test_without_a_spring_that_is_reached_beta_hold_is_that_of_other_systems():
    own = {"mass_ratios": [1, 2], "stiffness_ratios": [1, 0.5], "damping_ratios": 0.02}
    far = {"masses": [1, 2], "backlash": 1e3, "stiffness": 3.0}
    asked = {"mu": [1.0, 1.4], "scale": [-1.0, 0.5], "samples": "none"}
    for contacts in ([{}], [{}, {"masses": [2], "ratio": 0.3}]):
        one, two = (
            fm.history(fm.System(**own, contacts=contacts, **more), [noise(3), noise(4)], **asked)
            for more in ({}, {"springs": [far]})
        )
        np.testing.assert_allclose(two["beta_hold"], one["beta_hold"], rtol=1e-12)


def test_energies_of_a_base_that_moves_over_the_ground():
    """What the ground does counts as work of walls; lost and stored energies over time add up to it."""
    system = system_of(BOTH | {"kt": 3.0}, [GAP, PLAY], **ON_BASE)
    ds = fm.history(system, fine(shaken(16)), after=5.0)
    lost = ds["lost_friction"].values.ravel()[-1] + ds["lost_damping"].values.ravel()[-1]
    kept = ds["stored_energy"].values.ravel()
    assert kept[0] == 0.0
    assert kept[-1] == pytest.approx(ds["energy"].item(), abs=1e-10)
    done = ds["work_load"].item() + ds["work_walls"].item()
    assert abs(ds["work_walls"].item()) > 0.1
    assert lost + kept[-1] == pytest.approx(done, rel=2e-5)  # trapezoidal rule


def test_asleep_on_a_base_that_has_moved():
    """A base that ends elsewhere leaves contacts pressed otherwise; the place of rest accounts for it."""
    place = 0.4 * (1.0 - np.cos(np.pi * np.minimum(np.arange(60) * 0.2 / 6.0, 1.0)))
    record = fm.Record(place, 0.2, quantity="displacement")
    for changed in ({"kt": 3.0}, {"moved": 1.0}):
        system = system_of(BOTH | changed, [GAP], **ON_BASE)
        ds = fm.history(system, record)
        assert ds["status"].item() == 0
        long = fm.history(system, record, after=ds["asleep_time"].item() - record.duration + 1500.0)
        assert long["events"].item() == ds["events"].item()
        end = long["x"].squeeze().values[:, -1]
        np.testing.assert_allclose(end, ds["residual"].squeeze().values, rtol=0.0, atol=1e-9)
        np.testing.assert_allclose(
            long["z"].values.ravel()[-1], ds["contact_residual"].item(), rtol=0.0, atol=1e-9
        )
