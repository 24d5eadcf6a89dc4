"""Contacts that open and piecewise linear springs where they are something simpler."""

import numpy as np
import pytest

import frictionmap as fm
from frictionmap.model.spring_element import SpringElement
from frictionmap.phases.quantities import TABLE
from frictionmap.phases.solve import response_phases, sweep_phases
from frictionmap.phases.system import PhaseContact, PhaseSystem

MASS = np.diag([1.0, 1.4, 0.8])
DAMPING = np.array([[0.12, -0.03, 0.0], [-0.03, 0.1, -0.02], [0.0, -0.02, 0.09]])
STIFFNESS = np.array([[2.2, -1.1, 0.0], [-1.1, 2.0, -0.7], [0.0, -0.7, 1.5]])
LOAD = np.array([1.0, 0.0, 0.4 - 0.3j])
C, D = np.array([0.0, 1.0, 0.0]), np.array([-0.3, 0.0, 1.0])


def structure(**own):
    return PhaseSystem(MASS, DAMPING, STIFFNESS, **{"loads": {1: LOAD}, **own})


def cell(system, r, beta=1.0, mu=1.0):
    found = sweep_phases(system, [r], [beta], [mu], outputs=tuple(TABLE))
    return {name: table[0, 0, 0] for name, table in found.items()}


def amplitudes(stiffness, r):
    return np.abs(np.linalg.solve(stiffness - r * r * MASS + 1j * r * DAMPING, LOAD))


def damper(**own):
    given = {
        "normal": D, "normal_stiffness": 1.3, "friction": 0.5, "preload": 0.15, "stiffness": 2.5,
        "static": 1.0, **own,
    }  # fmt: skip
    return PhaseContact(given.pop("direction", C), **given)


def test_without_friction_a_closed_contact_is_a_spring():
    r = 0.7
    found = cell(structure(contacts=[damper(friction=0.0, preload=1e3)]), r)
    wanted = amplitudes(STIFFNESS + 1.3 * np.outer(D, D), r)
    assert np.abs(found["amplitude"] - wanted).max() < 1e-14 * wanted.max()


def test_a_knot_without_a_bend_changes_nothing():
    r = 0.8
    spring = SpringElement(C - D, [-0.2, 0.1], [-0.3, 0.15], 1.5, 1.5)
    found = cell(structure(springs=[spring]), r)
    wanted = amplitudes(STIFFNESS + 1.5 * np.outer(C - D, C - D), r)
    assert found["spring_crossings"] == 4
    assert np.abs(found["amplitude"] - wanted).max() < 2e-14 * wanted.max()


def test_a_contact_that_only_opens_is_a_gap():
    r = 1.1
    contact = cell(structure(contacts=[damper(friction=0.0, preload=-0.2)]), r)
    spring = cell(structure(springs=[SpringElement(D, [0.2 / 1.3], [0.0], 0.0, 1.3)]), r)
    assert contact["separations_per_cycle"] == 1
    assert np.abs(contact["amplitude"] - spring["amplitude"]).max() < 1e-13


@pytest.mark.parametrize("stiffness", [0.0, 2.5])
def test_a_mass_that_nothing_couples_gives_the_normal_force(stiffness):
    """d.x is then a function of time: the contact is one under a given normal load."""
    r, share = 0.9, 0.6
    # the last mass oscillates as share/kn cos(tau), by a load of its own
    mass, damping, stiffness_of = np.eye(3), np.diag([0.1, 0.08, 0.2]), STIFFNESS.copy()
    stiffness_of[2], stiffness_of[:, 2] = 0.0, 0.0
    stiffness_of[2, 2] = 3.0
    kn, phi, preload = 0.7, 0.5, 0.8
    drive = (3.0 + kn - r * r + 1j * r * 0.2) * share * preload / kn
    contact = PhaseContact(
        np.array([0.0, 1.0, 0.0]), normal=np.array([0.0, 0.0, 1.0]), normal_stiffness=kn, friction=phi,
        preload=preload, stiffness=stiffness, static=1.0,
    )  # fmt: skip
    loads = {1: np.array([1.0, 0.3j, drive])}
    found = cell(PhaseSystem(mass, damping, stiffness_of, [contact], loads=loads), r)
    given = {"K": stiffness_of[:2, :2], "M": np.eye(2), "C": damping[:2, :2]}
    own = {"stiffness": stiffness} if stiffness else {}
    system = fm.System(
        matrices=given, frequency_scale=1.0, load_harmonics={1: [1.0, 0.3j]},
        contacts=[fm.Contact("fixed-wall", 2, normal_load={1: share}, **own)],
    )  # fmt: skip
    outputs = ["peak_to_peak", "work_friction", "sliding_distance"]
    wanted = fm.sweep(system, [r], [phi * preload], outputs=outputs).isel(mu=0, r=0, beta=0)
    assert abs(found["normal_force_max"][0] - 1.6 * preload) < 1e-13
    assert np.abs(found["peak_to_peak"][:2] - wanted.peak_to_peak.values).max() < 1e-12
    assert abs(found["work_friction"][0] - float(wanted.work_friction)) < 1e-12
    assert abs(found["sliding_distance"][0] - float(wanted.sliding_distance)) < 1e-12


@pytest.mark.parametrize("stiffness", [0.0, 3.0])
def test_contacts_that_stay_closed_are_ordinary_ones(stiffness):
    """Contacts with constant friction, one at mu > 1, and belts: the general engine has them, too."""
    r, beta = 0.62, 0.35
    own = {"stiffness": stiffness} if stiffness else {"mu": 1.15}
    walls = {"wall_speed": 0.12}
    contacts = [fm.Contact("fixed-wall", 1, **walls, **own), fm.Contact("between-masses", [2, 3], ratio=0.6)]
    system = fm.System(
        matrices={"K": STIFFNESS, "M": MASS, "C": DAMPING}, frequency_scale=1.0, load_harmonics={1: LOAD},
        contacts=contacts,
    )  # fmt: skip
    outputs = ["peak_to_peak", "work_friction", "period", "turns_per_cycle"]
    wanted = fm.sweep(system, [r], [beta], outputs=outputs).isel(mu=0, r=0, beta=0)
    static = 1.0 if stiffness else 1.15
    pair = [
        PhaseContact(np.array([1.0, 0.0, 0.0]), stiffness=stiffness, static=static, **walls),
        PhaseContact(np.array([0.0, -1.0, 1.0]), ratio=0.6),
    ]
    found = cell(structure(contacts=pair), r, beta)
    assert found["period"] == wanted.period
    assert np.abs(found["peak_to_peak"] - wanted.peak_to_peak.values).max() < 1e-11
    assert np.abs(found["work_friction"] - wanted.work_friction.values).max() < 1e-11


def test_signs_and_numbering():
    r = 1.15
    spring = SpringElement(np.array([-1.0, 1.0, 0.0]), [-0.3, 0.2], [-0.1, 0.1], 1.0, 2.0)
    first = cell(structure(contacts=[damper()], springs=[spring]), r)
    assert first["separations_per_cycle"] > 0
    turned = SpringElement(-spring.direction, [-0.2, 0.3], [-0.1, 0.1], 2.0, 1.0)
    second = cell(structure(contacts=[damper(direction=-C)], springs=[turned]), r)
    order = [2, 0, 1]

    def moved(table):
        return np.asarray(table)[order]

    swapped = PhaseSystem(
        MASS[np.ix_(order, order)], DAMPING[np.ix_(order, order)], STIFFNESS[np.ix_(order, order)],
        [damper(direction=moved(C), normal=moved(D))],
        [SpringElement(moved(spring.direction), [-0.3, 0.2], [-0.1, 0.1], 1.0, 2.0)],
        {1: moved(LOAD)},
    )  # fmt: skip
    third = cell(swapped, r)
    for name in ("work_friction", "open_fraction", "normal_force_max", "spring_force_max", "slips_per_cycle"):
        assert np.abs(second[name] - first[name]).max() < 1e-12
        assert np.abs(third[name] - first[name]).max() < 1e-12
    assert np.abs(second["midpoint"] - first["midpoint"]).max() < 1e-12
    assert np.abs(third["midpoint"] - moved(first["midpoint"])).max() < 1e-12


def test_a_large_preload_is_a_spring_and_a_held_contact():
    r = 0.6
    found = cell(structure(contacts=[damper(preload=50.0)]), r)
    wanted = amplitudes(STIFFNESS + 1.3 * np.outer(D, D) + 2.5 * np.outer(C, C), r)
    assert found["regime"] == fm.regimes.PERMANENT_STICKING
    assert np.abs(0.5 * found["peak_to_peak"] - wanted).max() < 1e-13


@pytest.mark.parametrize("speed", [0.0, 0.15])
def test_an_elastic_and_a_rigid_contact_side_by_side(speed):
    """Both rest together, and the elastic one begins to slip when the rigid one lets go, or follows."""
    r, beta = 0.55, 0.3
    contacts = [
        fm.Contact("fixed-wall", 2, wall_speed=speed),
        fm.Contact("fixed-wall", 2, ratio=0.7, stiffness=2.0, wall_speed=speed),
    ]
    system = fm.System(
        matrices={"K": STIFFNESS, "M": MASS, "C": DAMPING}, frequency_scale=1.0, load_harmonics={1: LOAD},
        contacts=contacts,
    )  # fmt: skip
    outputs = ["peak_to_peak", "work_friction", "stops_per_cycle"]
    wanted = fm.sweep(system, [r], [beta], outputs=outputs).isel(mu=0, r=0, beta=0)
    pair = [PhaseContact(C, wall_speed=speed), PhaseContact(C, ratio=0.7, stiffness=2.0, wall_speed=speed)]
    found = cell(structure(contacts=pair), r, beta)
    assert wanted.stops_per_cycle[0] > 0
    assert found["stops_per_cycle"][0] == wanted.stops_per_cycle[0]
    assert np.abs(found["peak_to_peak"] - wanted.peak_to_peak.values).max() < 1e-11
    assert np.abs(found["work_friction"] - wanted.work_friction.values).max() < 1e-11


def test_elastic_contacts_whose_limit_a_rigid_one_keeps_constant():
    """Friction grows with the displacement of the mass itself, which a rigid contact holds at times."""
    r, first = 0.62, np.array([1.0, 0.0, 0.0])
    contacts = [
        PhaseContact(first, stiffness=3.9, ratio=0.4),
        PhaseContact(first, stiffness=2.7, normal=-first, normal_stiffness=3.0, friction=0.14, preload=0.5),
        PhaseContact(first, static=1.2),
    ]
    found = response_phases(structure(contacts=contacts), r, 0.45, 1.0, points=200)
    assert found["status"] == fm.regimes.RESOLVED
    assert found["stops_per_cycle"][2] > 0
    given = float(found["work_input"])
    taken = float(found["work_damping"] + found["work_friction"].sum())
    assert abs(given - taken) < 1e-12 * given
    limit = 0.14 * np.maximum(0.5 - 3.0 * found["x"][0], 0.0)
    assert (np.abs(found["friction"][1]) <= limit + 1e-12).all()


@pytest.mark.parametrize("beta", [3.0, 4.0, 5.0])
def test_the_place_of_contacts_that_rest_in_the_end(beta):
    """It is that of the last slip on the way from rest, which the other engine follows, too."""
    r = 0.62
    contacts = [
        fm.Contact("fixed-wall", 1, stiffness=2.0, ratio=0.8), fm.Contact("fixed-wall", 3, stiffness=1.5),
    ]  # fmt: skip
    system = fm.System(
        matrices={"K": STIFFNESS, "M": MASS, "C": DAMPING}, frequency_scale=1.0,
        load_harmonics={1: 3.0 * LOAD, 2: LOAD.real}, contacts=contacts,
    )  # fmt: skip
    outputs = ["peak_to_peak", "midpoint", "slips_per_cycle", "sliding_distance"]
    wanted = fm.sweep(system, [r], [beta], outputs=outputs).isel(mu=0, r=0, beta=0)
    pair = [
        PhaseContact(np.array([1.0, 0.0, 0.0]), stiffness=2.0, ratio=0.8),
        PhaseContact(np.array([0.0, 0.0, 1.0]), stiffness=1.5),
    ]
    loads = {1: 3.0 * LOAD, 2: LOAD.real.astype(complex)}
    found = cell(structure(contacts=pair, loads=loads), r, beta)
    assert (found["slips_per_cycle"] == 0.0).any()
    assert np.abs(wanted.midpoint.values).max() > 1e-3
    assert np.abs(found["peak_to_peak"] - wanted.peak_to_peak.values).max() < 1e-10
    assert np.abs(found["midpoint"] - wanted.midpoint.values).max() < 1e-10


def test_reversals_of_slip_are_those_of_a_system_without_the_stop_that_it_never_reaches():
    """A periodic motion reverses its slips an even number of times."""
    outputs = ["slips_per_cycle", "slip_reversals_per_cycle"]
    own = {"contacts": [fm.Contact(stiffness=3.0)], "damping_ratios": 0.05}
    for loads in ({1: 1.0}, {1: 1.0, 3: 0.6 - 0.4j}, {2: 1.0, 5: 0.5j}):
        plain = fm.System(load_harmonics=loads, **own)
        beside = fm.System(load_harmonics=loads, springs=[fm.Spring(gap=1e3, stiffness=1.0)], **own)
        ds, wanted = (fm.sweep(one, [0.4, 0.9], [0.3, 0.6], outputs=outputs) for one in (beside, plain))
        assert (wanted.slip_reversals_per_cycle % 2 == 0).all()
        for name in outputs:
            np.testing.assert_array_equal(ds[name], wanted[name])
