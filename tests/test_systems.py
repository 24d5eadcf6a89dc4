"""Structures by matrices, base excitation, complex loads, repeated frequencies; ways to get them wrong."""

import dataclasses
import io
import math
import pickle
import zipfile

import numpy as np
import pytest
import xarray as xr

import frictionmap as fm
from frictionmap.cli import main
from frictionmap.datasets.provenance import to_toml
from frictionmap.features import high_frequency_limits, peak_thresholds
from frictionmap.theory.boundaries import many_mode_curves, one_mass_curves

MU = [1.0, 1.4]
R = np.linspace(0.13, 2.9, 61)
RATIOS = {"mass_ratios": [1.0, 0.7, 1.9], "stiffness_ratios": [1.0, 1.3, 0.6]}
BOUNDARIES = ("beta_lim", "beta_lim_modal", "beta_stick")


def chain_matrices(masses, springs):
    """M and K of a chain."""
    springs = np.asarray(springs, dtype=float)
    K = np.diag(springs + np.append(springs[1:], 0.0))
    K -= np.diag(springs[1:], 1) + np.diag(springs[1:], -1)
    return {"M": np.diag(np.asarray(masses, dtype=float)), "K": K}


CHAIN = chain_matrices(*RATIOS.values())

#: Three equal oscillators on a mass that a spring ties to the ground; coordinates 1, 2, 3 and 4.  The
#: oscillators against each other are two modes of one frequency, r = 2, and the mass does not feel them.
PENDANTS = {
    "M": np.diag([0.5, 0.5, 0.5, 1.0]),
    "K": np.array([[2.0, 0, 0, -2], [0, 2, 0, -2], [0, 0, 2, -2], [-2, -2, -2, 7]]),
}


def pendants(contact, load, **settings):
    return fm.System(
        contact_masses=[contact], load_mass=load, matrices=PENDANTS, frequency_scale=1.0, **settings
    )


def assert_same_boundaries(one, other, rtol=1e-12, atol=0.0, scale=1.0):
    """`scale`: beta of `other` over that of `one`."""
    for name in BOUNDARIES:
        expected = scale * one[name].values
        np.testing.assert_allclose(other[name].values, expected, rtol=rtol, atol=atol, err_msg=name)


def complex_response(ds):
    return ds.V.values + 1j * ds.V_imag.values


def directly(system, r):
    """V and F by solving the equations of motion in the masses' coordinates, theory.md 1 and 4."""
    modes = system.modes
    n, c, s = system.n, modes.contact, modes.base_motion
    v, held = [], []
    for x in r:
        D = modes.stiffness - x**2 * modes.mass + 1j * x * modes.damping
        p = modes.load + 1j * x * modes.load_rate
        v.append(c @ np.linalg.solve(D, p) - s)
        bordered = np.block([[D, c[:, np.newaxis]], [c, np.zeros(1)]])
        held.append(np.linalg.solve(bordered, np.append(p, s)))
    return np.array(v), np.array(held)[:, :n], np.array(held)[:, n]


# The same structure in other words


CONTACTS = [
    {"contact": "fixed-wall", "contact_masses": [2], "load_mass": 3},
    {"contact": "joined-base-wall", "contact_masses": [3]},
    {"contact": "between-masses", "contact_masses": [1, 3], "load_mass": 2},
]


@pytest.mark.parametrize("contact", CONTACTS, ids=lambda contact: contact["contact"])
@pytest.mark.parametrize("zeta", [0.0, [0.02, 0.3, 1.2]])
@pytest.mark.parametrize(("mass", "spring"), [(1.0, 1.0), (0.37, 5.2e4), (2.3e-9, 4.7e7), (8.1e5, 3e-3)])
def test_a_chain_by_ratios_and_by_matrices(contact, zeta, mass, spring):
    """Any consistent units give the curves of the ratios, in their own units of frequency and stiffness."""
    by_ratios = fm.boundaries(fm.System(damping_ratios=zeta, **contact, **RATIOS), R, MU)
    matrices = {"M": mass * CHAIN["M"], "K": spring * CHAIN["K"]}
    system = fm.System(
        matrices=matrices, frequency_scale=math.sqrt(spring / mass), stiffness_scale=spring,
        damping_ratios=zeta, **contact,
    )  # fmt: skip
    ds = fm.boundaries(system, R, MU)
    assert_same_boundaries(by_ratios, ds)
    for name in "VUGHS":
        np.testing.assert_allclose(ds[name], by_ratios[name], rtol=1e-11, atol=1e-12, err_msg=name)
    np.testing.assert_allclose(ds.held_frequency, by_ratios.held_frequency, rtol=1e-12)


@pytest.mark.parametrize("contact", CONTACTS, ids=lambda contact: contact["contact"])
def test_masses_may_be_numbered_in_any_order(contact):
    order = [2, 0, 1]
    new = {old + 1: new + 1 for new, old in enumerate(order)}
    # between masses: c changes its sign, which U, |V| and the boundaries do not see
    settings = contact | {"contact_masses": sorted(new[mass] for mass in contact["contact_masses"])}
    if "load_mass" in contact:
        settings["load_mass"] = new[contact["load_mass"]]
    matrices = {name: matrix[np.ix_(order, order)] for name, matrix in CHAIN.items()}
    one = fm.System(matrices=CHAIN, damping_ratios=0.03, **contact)
    other = fm.System(matrices=matrices, damping_ratios=0.03, **settings)
    one, other = fm.boundaries(one, R, MU), fm.boundaries(other, R, MU)
    assert_same_boundaries(one, other)
    np.testing.assert_allclose(np.abs(complex_response(other)), np.abs(complex_response(one)), rtol=1e-12)


def test_scales():
    """r is omega over the one scale, displacements are in P over the other; beta of a base is in its Y."""
    for contact, power in (("fixed-wall", 0), ("joined-base-wall", 1)):
        plain = fm.System(contact, [2], matrices=CHAIN, frequency_scale=1.0, damping_ratios=0.01)
        scaled = fm.System(
            contact, [2], matrices=CHAIN, frequency_scale=0.7, stiffness_scale=3.0, damping_ratios=0.01
        )
        one, other = fm.boundaries(plain, R, MU), fm.boundaries(scaled, R / 0.7, MU)
        assert_same_boundaries(one, other, scale=3.0**-power)
        expected = 3.0 ** (1 - power) * complex_response(one)
        np.testing.assert_allclose(complex_response(other), expected, rtol=1e-11)
        for name in "UGHS":  # displacements by a friction of P
            np.testing.assert_allclose(other[name], 3.0 * one[name], rtol=1e-10, atol=1e-12, err_msg=name)


def test_the_first_natural_frequency_is_the_scale_unless_another_is_given():
    system = fm.System(matrices={"M": 4.0 * CHAIN["M"], "K": 9.0 * CHAIN["K"]})
    assert system.modes.w[0] == pytest.approx(1.0, rel=1e-14)
    assert fm.System(matrices={"M": [[3.0]], "K": [[7.0]]}).modes.w.tolist() == [1.0]
    other = fm.System(matrices=CHAIN, frequency_scale=system.modes.w[0])
    np.testing.assert_allclose(other.modes.w / other.modes.w[0], system.modes.w, rtol=1e-14)


@pytest.mark.parametrize("contact", ["fixed-wall", "joined-base-wall"])
@pytest.mark.parametrize("zeta", [0.0, 0.04, 1.0, 1.6])
def test_one_mass_by_matrices(contact, zeta):
    """Another unit of frequency takes the code for many modes: the curves are those of one mass."""
    one = fm.System(contact, damping_ratios=zeta)
    other = fm.System(
        contact, matrices={"M": [[2.0]], "K": [[50.0]]}, frequency_scale=4.0, stiffness_scale=50.0,
        damping_ratios=zeta,
    )  # fmt: skip
    assert one.normalised
    assert not other.normalised
    assert other.modes.w.tolist() == [1.25]
    one, other = fm.boundaries(one, R / 1.25, MU), fm.boundaries(other, R, MU)
    assert_same_boundaries(one, other)
    np.testing.assert_allclose(complex_response(other), complex_response(one), rtol=1e-12)


def test_one_mass_by_matrices_in_its_own_units_is_the_one_mass():
    system = fm.System(matrices={"M": [[3.1]], "K": [[7.3]]}, stiffness_scale=7.3)
    assert system.normalised
    xr.testing.assert_equal(fm.boundaries(system, R, MU), fm.boundaries(fm.System(), R, MU))
    assert not fm.System(**RATIOS).normalised
    assert not fm.System(matrices={"M": [[3.1]], "K": [[7.3]]}).normalised


def test_a_damping_matrix_and_the_ratios_it_makes():
    """Rayleigh damping a M + b K: zeta = (a/w + b w)/2."""
    a, b = 0.05, 0.02
    matrices = {**CHAIN, "C": a * CHAIN["M"] + b * CHAIN["K"]}
    by_matrix = fm.System(contact_masses=[2], matrices=matrices, frequency_scale=1.0)
    w = by_matrix.modes.w
    np.testing.assert_allclose(by_matrix.modes.zeta, 0.5 * (a / w + b * w), rtol=1e-12)
    by_ratios = fm.System(
        contact_masses=[2], matrices=CHAIN, frequency_scale=1.0, damping_ratios=0.5 * (a / w + b * w)
    )
    assert_same_boundaries(fm.boundaries(by_ratios, R, MU), fm.boundaries(by_matrix, R, MU))
    # other units: of frequency 10 and of stiffness 1000
    units = {"M": CHAIN["M"] * 10.0, "K": CHAIN["K"] * 1e3, "C": matrices["C"] * 100.0}
    other = fm.System(contact_masses=[2], matrices=units, frequency_scale=10.0, stiffness_scale=1e3)
    assert_same_boundaries(fm.boundaries(by_matrix, R, MU), fm.boundaries(other, R, MU))


def test_damping_of_some_modes_only():
    """C of rank one: the other modes are undamped to the bit."""
    w, phi = (system := fm.System(matrices=CHAIN)).modes.w, system.modes.phi
    shape = CHAIN["M"] @ phi[:, 1]
    by_matrix = fm.System(matrices={**CHAIN, "C": 0.1 * np.outer(shape, shape)})
    zeta = by_matrix.modes.zeta
    assert zeta[0] == zeta[2] == 0.0
    assert zeta[1] > 0.01
    np.testing.assert_allclose(by_matrix.modes.w, w, rtol=1e-13)


def test_a_damping_matrix_may_tell_modes_of_one_frequency_apart():
    """Two equal oscillators, coupled by a dashpot only: their sum is undamped, their difference is not."""
    C = 0.2 * np.array([[1.0, -1.0], [-1.0, 1.0]])
    system = fm.System(matrices={"M": np.eye(2), "K": np.eye(2), "C": C}, contact_masses=[1])
    assert system.modes.zeta == pytest.approx([0.0, 0.2])
    v, _, held = directly(system, R)
    ds = fm.boundaries(system, R)
    np.testing.assert_allclose(complex_response(ds), v, rtol=1e-11)
    np.testing.assert_allclose(ds.beta_stick[0], np.abs(held), rtol=1e-11)


def test_modes_of_one_frequency_and_one_damping_by_a_matrix():
    """Of four equal oscillators three are damped alike by C: the contact sees one motion of these only."""
    phi = np.linalg.qr(np.random.default_rng(1).normal(size=(4, 4)))[0]
    C = (phi * [0.1, 0.4, 0.4, 0.4]) @ phi.T
    modes = fm.System(matrices={"M": np.eye(4), "K": np.eye(4), "C": 0.5 * (C + C.T)}).modes
    np.testing.assert_allclose(modes.zeta, [0.05, 0.2, 0.2, 0.2], rtol=1e-13)
    assert np.count_nonzero(modes.chi) == 2
    assert np.sum(modes.chi**2) == pytest.approx(1.0)


# Base excitation


@pytest.mark.parametrize("zeta", [0.0, 0.05, 0.7])
@pytest.mark.parametrize("reference", ["ground", "base"])
@pytest.mark.parametrize("contact", ["fixed-wall", "joined-base-wall"])
def test_base_excitation_of_one_mass(contact, reference, zeta):
    """p = 1, or 1 + 2 i zeta r with a dashpot to the base (Hundal's problem); T(3.24) if the wall moves."""
    system = fm.System(contact, damping_ratios=zeta, excitation="base", damping_reference=reference)
    p = 1.0 + (2j * zeta * R if reference == "base" else 0.0)
    stiffness = 1.0 - R**2 + 2j * zeta * R
    s = system.base_motion
    ds = fm.boundaries(system, R, MU)
    np.testing.assert_allclose(complex_response(ds), p / stiffness - s, rtol=1e-11)
    np.testing.assert_allclose(ds.beta_stick[0], np.abs(p - s * stiffness), rtol=1e-12)
    # one equation for all loads: the boundaries are those of a fixed wall times the load in the contact
    wall = fm.boundaries(fm.System(damping_ratios=zeta), R, MU)
    for name in BOUNDARIES:
        np.testing.assert_allclose(ds[name], wall[name] * np.abs(p - s * stiffness), rtol=1e-12)


def test_no_digit_of_the_load_in_a_joined_wall_is_lost_at_low_frequency():
    """F = r^2 with a dashpot to the base, r^2 - 2 i zeta r without, to the last digit; many masses too."""
    r = np.array([1e-9, 1e-6, 1e-3])
    relative = fm.System("joined-base-wall", damping_ratios=0.3, damping_reference="base")
    np.testing.assert_allclose(relative.contact_load(r), r**2, rtol=4e-16)
    ground = fm.System("joined-base-wall", damping_ratios=0.3)
    np.testing.assert_allclose(ground.contact_load(r), r**2 - 0.6j * r, rtol=4e-16)
    # a rigid structure of mass m on a base: r^2 times what the held mass and its neighbours weigh
    many = fm.System("joined-base-wall", [1], **RATIOS)
    np.testing.assert_allclose(many.contact_load(r), 3.6 * r**2, rtol=1e-5)
    assert many.contact_load(r[:1])[0] == pytest.approx(3.6e-18, rel=1e-13)
    np.testing.assert_allclose(
        many.modes.contact_response(r)[0], 1e-18 * (1.0 + 0.7 + 1.9), rtol=1e-13
    )  # spring 1 carries all three masses


@pytest.mark.parametrize("contact", CONTACTS, ids=lambda contact: contact["contact"])
@pytest.mark.parametrize("reference", ["ground", "base"])
def test_base_excitation_of_structures(contact, reference):
    """Against a solution in the masses' coordinates, by matrices and by ratios."""
    settings = {k: v for k, v in contact.items() if k != "load_mass"} | {
        "excitation": "base", "damping_reference": reference, "damping_ratios": [0.02, 0.1, 0.3],
    }  # fmt: skip
    by_ratios = fm.System(**settings, **RATIOS)
    np.testing.assert_array_equal(by_ratios.modes.load, [1.0, 0.0, 0.0])
    by_matrices = fm.System(**settings, matrices=CHAIN, frequency_scale=1.0)
    for system in (by_ratios, by_matrices):
        v, x, held = directly(system, R)
        ds = fm.boundaries(system, R)
        np.testing.assert_allclose(complex_response(ds), v, rtol=1e-10)
        np.testing.assert_allclose(ds.beta_stick[0], np.abs(held), rtol=1e-10)
        np.testing.assert_allclose(system.modes.held_response(R), x, rtol=1e-9, atol=1e-12)
    assert_same_boundaries(fm.boundaries(by_ratios, R, MU), fm.boundaries(by_matrices, R, MU))


def test_motion_of_the_base_is_seen_from_the_ground_or_from_the_base():
    """All dashpots to the base: in coordinates that move with it the load is r^2 M ones, and nothing else."""
    system = fm.System(
        excitation="base", damping_reference="base", damping_ratios=0.1, contact_masses=[3], **RATIOS
    )
    modes = system.modes
    relative = [
        np.linalg.solve(
            modes.stiffness - r**2 * modes.mass + 1j * r * modes.damping, r**2 * modes.mass @ np.ones(3)
        )[2]
        for r in R
    ]
    np.testing.assert_allclose(
        complex_response(fm.boundaries(system, R)), np.array(relative) + 1.0, rtol=1e-11
    )


def test_joined_base_wall_is_base_excitation():
    plain = fm.System("joined-base-wall", [2], **RATIOS)
    assert plain == fm.System("joined-base-wall", [2], excitation="base", **RATIOS)
    assert plain.excitation == "base"
    assert plain.load_mass == 1


def test_limits_with_dashpots_to_the_base():
    """The load in the contact grows with r, unless the dashpots pull both masses in contact alike."""
    hundal = fm.System(excitation="base", damping_reference="base", damping_ratios=0.1)
    assert high_frequency_limits(hundal) == (math.inf, math.inf)
    assert high_frequency_limits(fm.System(excitation="base")) == high_frequency_limits(fm.System())
    # what grows cancels between masses that the dashpots pull alike; then C's next power counts
    rows = np.array([[2.0, -0.5, -0.5], [-0.5, 1.7, -0.2], [-0.5, -0.2, 2.7]])  # their sums are 1, 1 and 2
    for matrices in (
        {**CHAIN, "C": 0.3 * CHAIN["M"]},
        {"M": np.eye(3), "K": rows + np.eye(3), "C": 0.3 * rows},
    ):
        alike = fm.System(
            "between-masses", [1, 2], matrices=matrices, excitation="base", damping_reference="base",
            frequency_scale=1.0,
        )  # fmt: skip
        limits = high_frequency_limits(alike, 1.4)
        ds = fm.boundaries(alike, [1e5], 1.4)  # the rest is of the order of 1/r
        assert limits.beta_stick == pytest.approx(ds.beta_stick.item(), rel=1e-4)
        assert limits.beta_lim == pytest.approx(ds.beta_lim.item(), rel=1e-4)
    # peaks, with the load that there is at each natural frequency
    one = peak_thresholds(hundal)
    assert one == pytest.approx(peak_thresholds(fm.System(damping_ratios=0.1)) * abs(1.0 + 0.2j))


# Complex loads


def test_loads_superpose():
    """V and F are linear in the loads, phases included."""
    loads = ([1.0, 0.0, 0.5j], [0.0, -2.0 + 1.0j, 0.0])
    both = [a + b for a, b in zip(*loads, strict=True)]
    settings = {"contact": "between-masses", "contact_masses": [1, 3], "damping_ratios": 0.03, **RATIOS}
    one, two, sum_of_both = (fm.System(load=load, **settings) for load in (*loads, both))
    v = [complex_response(fm.boundaries(system, R)) for system in (one, two, sum_of_both)]
    np.testing.assert_allclose(v[2], v[0] + v[1], rtol=1e-11)
    np.testing.assert_allclose(
        sum_of_both.contact_load(R), one.contact_load(R) + two.contact_load(R), rtol=1e-11
    )
    v, _, held = directly(sum_of_both, R)
    np.testing.assert_allclose(complex_response(fm.boundaries(sum_of_both, R)), v, rtol=1e-11)
    np.testing.assert_allclose(sum_of_both.contact_load(R), held, rtol=1e-11)


def test_a_phase_of_all_loads_changes_no_boundary():
    load = np.array([1.0, 0.3 - 0.2j, -0.7j])
    one = fm.System(contact_masses=[2], load=load, damping_ratios=0.01, **RATIOS)
    other = fm.System(contact_masses=[2], load=load * np.exp(0.9j), damping_ratios=0.01, **RATIOS)
    a, b = fm.boundaries(one, R, MU), fm.boundaries(other, R, MU)
    assert_same_boundaries(a, b)
    np.testing.assert_allclose(complex_response(b), complex_response(a) * np.exp(0.9j), rtol=1e-12)
    np.testing.assert_allclose(peak_thresholds(other), peak_thresholds(one), rtol=1e-12)
    assert high_frequency_limits(other) == pytest.approx(high_frequency_limits(one))


def test_a_load_of_one_is_the_load_mass():
    for n, mass in ((1, 1), (3, 2)):
        ratios = RATIOS if n == 3 else {}
        load = [float(k == mass) for k in range(1, n + 1)]
        one, other = fm.System(load_mass=mass, **ratios), fm.System(load=load, **ratios)
        xr.testing.assert_equal(fm.boundaries(one, R, MU), fm.boundaries(other, R, MU))


@pytest.mark.parametrize("zeta", [0.0, 0.1, 1.3])
@pytest.mark.parametrize(
    "settings",
    [
        {"load": [0.6 - 0.8j]},
        {"load": [3j]},
        {"excitation": "base"},
        {"excitation": "base", "damping_reference": "base"},
        {"contact": "joined-base-wall", "damping_reference": "base"},
    ],
)
def test_loads_of_one_mass_by_the_code_for_many(settings, zeta):
    system = fm.System(damping_ratios=zeta, **settings)
    r, mu = R[np.abs(R - 1.0) > 1e-3], np.array(MU)
    one, many = one_mass_curves(system, r, mu).curves, many_mode_curves(system, r, mu)
    for field in dataclasses.fields(one):
        a, b = getattr(one, field.name), getattr(many, field.name)
        np.testing.assert_allclose(b, a, rtol=1e-11, atol=1e-13, err_msg=field.name)


# Modes that the contact does not see


def test_repeated_frequencies_leave_one_seen_mode():
    """Three oscillators against each other: two modes of one frequency, of which the contact sees one."""
    modes = pendants(contact=1, load=4).modes
    assert modes.w[1] == modes.w[2] == pytest.approx(2.0, rel=1e-14)
    assert np.count_nonzero(modes.chi) == 3
    assert np.sum(modes.chi**2) == pytest.approx(2.0)
    np.testing.assert_allclose(modes.phi.T @ modes.mass @ modes.phi, np.eye(4), atol=1e-14)
    np.testing.assert_allclose(modes.phi.T @ modes.stiffness @ modes.phi, np.diag(modes.w**2), atol=1e-13)
    # the load on mass 4 feeds neither
    assert np.all(modes.participation(R)[:, 1:3] == 0.0)


def test_repeated_frequencies_of_unlike_damping_are_left():
    modes = pendants(contact=1, load=4, damping_ratios=[0.0, 0.1, 0.2, 0.0]).modes
    np.testing.assert_allclose(
        modes.phi.T @ modes.damping @ modes.phi, np.diag(2 * modes.zeta * modes.w), atol=1e-13
    )


@pytest.mark.parametrize("zeta", [0.0, 0.02])
def test_what_moves_against_itself_is_not_there(zeta):
    """Contact and load on the common mass: the curves are those of two masses, one the oscillators' sum."""
    many = pendants(contact=4, load=4, damping_ratios=zeta)
    assert np.count_nonzero(many.modes.chi) == 2
    two = fm.System(
        contact_masses=[1],
        damping_ratios=zeta,
        matrices=chain_matrices([1.0, 1.5], [1.0, 6.0]),
        frequency_scale=1.0,
    )
    r = np.unique(np.concatenate((R, [2.0 / 3.0, 0.4, 2.0 * (1 - 1e-12), 2.0 * (1 + 1e-12)])))
    one, other = fm.boundaries(two, r, MU), fm.boundaries(many, r, MU)
    assert_same_boundaries(one, other, atol=1e-14)  # at r = 2 mass 4 is at rest, and beta_lim 0
    for ds in (fm.boundaries(many, [2.0], MU), fm.boundaries(two, [2.0], MU)):
        assert np.all(np.isfinite(ds.U))
        assert np.all(ds.beta_lim < 1e-14 if zeta == 0.0 else ds.beta_lim > 1e-4)
        np.testing.assert_allclose(ds.beta_stick[:, 0], 1.0 / np.array(MU), rtol=1e-14)


def test_curves_at_a_frequency_of_modes_that_nothing_sees():
    """Displacements of all masses are finite there, and those next to it."""
    system = pendants(contact=4, load=4)
    r = np.array([2.0 * (1.0 - 1e-7), 2.0, 2.0 * (1.0 + 1e-7)])
    x = np.array([system.modes.response(r, row) for row in system.modes.phi])
    assert np.all(np.isfinite(x))
    np.testing.assert_allclose(x[:, 1], x[:, 0], rtol=1e-5, atol=1e-6)
    held = system.modes.held_response(r)
    assert np.all(np.isfinite(held))
    np.testing.assert_allclose(held, 0.0, atol=1e-8)


def test_a_loaded_mode_that_the_contact_does_not_see():
    """It moves as if free, and neither V nor U nor F knows of it; undamped, masses that it moves resonate."""
    symmetric = {"M": np.eye(3), "K": np.array([[2.0, -1, 0], [-1, 2, -1], [0, -1, 2]])}
    system = fm.System(contact_masses=[2], load_mass=1, matrices=symmetric, frequency_scale=1.0)
    unseen = np.flatnonzero(system.modes.chi == 0.0)
    assert unseen.tolist() == [1]
    assert system.modes.w[1] == pytest.approx(math.sqrt(2.0))
    r = np.array([0.5, system.modes.w[1], 1.7])
    assert np.all(np.isfinite(system.modes.contact_response(r)))
    x = system.modes.held_response(r)
    np.testing.assert_allclose(x[[0, 2]], directly(system, r[[0, 2]])[1], rtol=1e-12, atol=1e-15)
    assert np.isinf(x[1, 0])
    assert peak_thresholds(system)[1] == math.inf


def test_held_resonances_that_the_load_does_not_feed():
    """Two equal masses, contact and load on mass 1: mass 2 would resonate at r = 1, but nothing moves it."""
    for stiffness in (1.0, 1e9):
        two = fm.System(
            matrices=chain_matrices([stiffness] * 2, [stiffness] * 2), frequency_scale=1.0, damping_ratios=0.0
        )
        ds = fm.boundaries(two, [0.5, 1.0, 1.5], MU)
        np.testing.assert_allclose(ds.beta_stick, [[1.0] * 3, [1.0 / 1.4] * 3], rtol=1e-13)
        np.testing.assert_allclose(two.modes.held_response(np.array([1.0])), 0.0, atol=1e-15)
    fed = fm.System(matrices=chain_matrices([1.0] * 2, [1.0] * 2), load_mass=2, frequency_scale=1.0)
    assert np.all(np.isinf(fm.boundaries(fed, [1.0]).beta_stick))
    assert np.all(np.isinf(fed.modes.held_response(np.array([1.0]))))


# The object


def test_equal_systems_are_equal_and_hash_alike(tmp_path):
    np.savez(tmp_path / "frame.npz", **CHAIN)
    by_path = fm.System(matrices=tmp_path / "frame.npz")
    by_text = fm.System(matrices=str(tmp_path / "frame.npz"))
    by_mapping = fm.System(matrices=CHAIN)
    lists = fm.System(matrices={name: matrix.tolist() for name, matrix in CHAIN.items()})
    assert by_path == by_text == by_mapping == lists
    assert len({by_path, by_text, by_mapping, lists}) == 1
    assert by_path != fm.System(matrices=CHAIN, damping_ratios=0.1)
    assert by_path != fm.System(matrices={**CHAIN, "K": 2.0 * CHAIN["K"]})
    assert fm.System(load=[1.0]) == fm.System(load=np.array([1.0 + 0.0j]))
    again = dataclasses.replace(by_path, contact_masses=[2])
    assert again == fm.System(matrices=CHAIN, contact_masses=[2])
    assert pickle.loads(pickle.dumps(by_path)) == by_path


def test_matrices_are_copied():
    given = {name: matrix.copy() for name, matrix in CHAIN.items()}
    system = fm.System(matrices=given)
    given["K"][:] = 0.0
    assert system == fm.System(matrices=CHAIN)
    with pytest.raises(ValueError, match="read-only"):
        system.matrices.mass[0, 0] = 2.0


def test_rounding_of_an_assembly_is_symmetrised():
    K = CHAIN["K"].copy()
    K[0, 1] *= 1.0 + 1e-13
    system = fm.System(matrices={**CHAIN, "K": K})
    assert np.array_equal(system.matrices.stiffness, system.matrices.stiffness.T)


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        (
            {},
            "one mass; friction between the mass and a fixed wall, harmonic load on the mass; no viscous "
            "damping",
        ),
        (
            {"excitation": "base", "damping_reference": "base", "damping_ratios": 0.1},
            "one mass; friction between the mass and a fixed wall, harmonic base motion through the spring "
            "and dashpot; damping ratio 0.1",
        ),
        (
            {"load": [1.0 - 0.5j]},
            "one mass; friction between the mass and a fixed wall, harmonic load (1-0.5j) on the mass; "
            "no viscous damping",
        ),
        (
            {"contact": "joined-base-wall", "contact_masses": [2], "damping_ratios": 0.1,
             "damping_reference": "base", **RATIOS},
            "chain of 3 masses (1, 0.7, 1.9), springs (1, 1.3, 0.6); friction between mass 2 and a wall that "
            "moves with the base; harmonic base motion through the springs and dashpots; modal damping "
            "ratios 0.1",
        ),
        (
            {"matrices": CHAIN, "frequency_scale": 12.3, "load": [1, 0, 0.5j]},
            "structure of 3 degrees of freedom, r = omega/12.3, displacements in P/1; friction between "
            "mass 1 and a fixed wall; harmonic load (1, 0, 0+0.5j) on the masses; no viscous damping",
        ),
        (
            {"matrices": {"M": [[1.0]], "K": [[4.0]], "C": [[0.4]]}, "stiffness_scale": 4},
            "structure of 1 degree of freedom, r = omega/2 (the first natural frequency), displacements in "
            "P/4; friction between the mass and a fixed wall; harmonic load on the mass; damping ratio 0.1",
        ),
    ],
)  # fmt: skip
def test_description(settings, words):
    assert fm.System(**settings).describe() == words


def test_description_of_a_file_has_no_folder(tmp_path):
    np.savez(tmp_path / "frame.npz", **CHAIN, C=0.1 * CHAIN["M"])
    words = fm.System(matrices=tmp_path / "frame.npz", frequency_scale=1.0).describe()
    assert words.startswith("structure of 3 degrees of freedom from frame.npz, r = omega/1, ")
    assert words.endswith("; modal damping ratios 0.024647 to 0.137844, from C")


# Bad input: the words that its message has, from Python and from the command line


def changed(name, i, j, value):
    """The chain's matrices with one entry changed."""
    matrix = CHAIN[name].copy()
    matrix[i, j] = value
    return {**CHAIN, name: matrix}


def full(value):
    return np.full((3, 3), value)


FRAME = {"matrices": CHAIN}

BAD_SYSTEMS = {
    # matrices
    "M not symmetric": (
        {"matrices": changed("M", 0, 1, 0.5)},
        ["matrices: M must be symmetric", "0.5 at [0, 1]", "0.0 at [1, 0]"],
    ),
    "K not symmetric": (
        {"matrices": changed("K", 0, 2, 1e-9)},
        ["matrices: K must be symmetric", "1e-09 at [0, 2]"],
    ),
    "C not symmetric": ({"matrices": {**CHAIN, "C": np.triu(full(1.0))}}, ["matrices: C must be symmetric"]),
    "M indefinite": (
        {"matrices": changed("M", 1, 1, -2.0)},
        ["matrices: M must be positive definite", "indefinite", "eigenvalues from -2 to 1.9"],
    ),
    "K indefinite": (
        {"matrices": changed("K", 2, 2, -1.0)},
        ["matrices: K must be positive definite", "indefinite", "-1"],
    ),
    "M singular": (
        {"matrices": changed("M", 1, 1, 0.0)},
        ["matrices: M must be positive definite", "singular", "eigenvalues from 0 to 1.9"],
    ),
    "K of a free structure": (
        {"matrices": changed("K", 0, 0, 1.3)},
        ["matrices: K must be positive definite", "singular", "eigenvalues from"],
    ),
    "C indefinite": (
        {"matrices": {**CHAIN, "C": np.diag([1.0, 1.0, -0.5])}},
        ["matrices: C must be positive semi-definite", "indefinite", "-0.5"],
    ),
    "C that couples modes": (
        {"matrices": {**CHAIN, "C": np.diag([0.1, 0.0, 0.0])}},
        ["matrices: C must be diagonal in the undamped modes", "Rayleigh", "damping_ratios", "couples"],
    ),
    "C that damps too much": (
        {"matrices": {**CHAIN, "C": 1e3 * CHAIN["M"]}},
        ["matrices: C must make damping ratios <= 100", "of mode 1"],
    ),
    "C and ratios": (
        {"matrices": {**CHAIN, "C": 0.1 * CHAIN["M"]}, "damping_ratios": 0.1},
        ["damping_ratios must be left out if matrices has C", "0.1"],
    ),
    "rows": ({"matrices": {**CHAIN, "M": np.ones((2, 3))}}, ["matrices: M must be square", "(2, 3)"]),
    "a vector": ({"matrices": {**CHAIN, "M": np.ones(3)}}, ["matrices: M must be square", "(3,)"]),
    "a number": ({"matrices": {**CHAIN, "K": 4.0}}, ["matrices: K must be square", "()"]),
    "nothing": (
        {"matrices": {"M": np.empty((0, 0)), "K": np.empty((0, 0))}},
        ["matrices: M must be square", "(0, 0)"],
    ),
    "sizes that differ": (
        {"matrices": {**CHAIN, "K": np.eye(2)}},
        ["matrices: K must have the shape of M, (3, 3)", "(2, 2)"],
    ),
    "C of another size": ({"matrices": {**CHAIN, "C": [[1.0]]}}, ["matrices: C must have the shape of M"]),
    "not a number": (
        {"matrices": changed("K", 1, 2, math.nan)},
        ["matrices: K must be finite", "nan at [1, 2]"],
    ),
    "infinite": ({"matrices": changed("M", 0, 0, math.inf)}, ["matrices: M must be finite", "inf at [0, 0]"]),
    "complex": ({"matrices": {**CHAIN, "K": full(1j)}}, ["matrices: K must be", "real", "complex128"]),
    "true and false": ({"matrices": {**CHAIN, "M": full(True)}}, ["matrices: M must be", "real", "bool"]),
    "text": ({"matrices": {**CHAIN, "M": full("1")}}, ["matrices: M must be", "real", "<U1"]),
    "huge": (
        {"matrices": {**CHAIN, "K": 1e200 * CHAIN["K"]}},
        ["matrices: K must have a largest entry of 1e-100 to 1e+100", "2.3e+200"],
    ),
    "tiny": ({"matrices": {**CHAIN, "M": 1e-200 * CHAIN["M"]}}, ["matrices: M must have a largest entry"]),
    "frequencies too far apart": (
        {"matrices": {"M": np.diag([1.0, 1e-10]), "K": np.diag([1.0, 1e10])}},
        ["matrices must make natural frequencies that double precision can hold together", "1e+10"],
    ),
    "stiffness ratios too far apart": (
        {"mass_ratios": [1, 1], "stiffness_ratios": [1, 1e20]},
        ["mass_ratios and stiffness_ratios must make natural frequencies", "1.41e+10"],
    ),
    "no K": ({"matrices": {"M": np.eye(2)}}, ["matrices must have arrays M, K", "K is missing", "got M"]),
    "no arrays": ({"matrices": {}}, ["matrices must have arrays M, K", "M is missing", "got none"]),
    "an unknown array": (
        {"matrices": {**CHAIN, "D": np.eye(3)}},
        ["matrices must have arrays M, K and optionally C", "'D'"],
    ),
    "matrices and masses": (
        {**FRAME, "mass_ratios": [1.0]},
        ["mass_ratios must be left out if matrices are given", "[1.0]"],
    ),
    "matrices and springs": (
        {**FRAME, "stiffness_ratios": [1.0, 1.0]},
        ["stiffness_ratios must be left out if matrices are given", "[1.0, 1.0]"],
    ),
    "a frequency of zero": ({**FRAME, "frequency_scale": 0.0}, ["frequency_scale must be > 0", "got 0"]),
    "a frequency below zero": ({**FRAME, "frequency_scale": -1.0}, ["frequency_scale must be > 0", "-1"]),
    "a frequency as text": ({**FRAME, "frequency_scale": "1"}, ["frequency_scale must be a number", "'1'"]),
    "a frequency far off": (
        {**FRAME, "frequency_scale": 1e-90},
        ["frequency_scale and stiffness_scale must leave M", "1e-90"],
    ),
    "a stiffness of zero": ({**FRAME, "stiffness_scale": 0.0}, ["stiffness_scale must be > 0", "got 0"]),
    "a stiffness far off": (
        {**FRAME, "stiffness_scale": 1e200},
        ["frequency_scale and stiffness_scale must leave", "1e+200"],
    ),
    "a frequency scale of a chain": (
        {"frequency_scale": 2.0},
        ["frequency_scale must be left out without matrices", "2.0"],
    ),
    "a stiffness scale of a chain": (
        {"stiffness_scale": 2.0},
        ["stiffness_scale must be left out without matrices", "2.0"],
    ),
    "a damping ratio too few": (
        {**FRAME, "damping_ratios": [0.1, 0.2]},
        ["damping_ratios must be one number or one a mode (3)", "got 2"],
    ),
    # contact and load
    "a contact that does not exist": (
        {**FRAME, "contact_masses": [4]},
        ["contact_masses[0] must be <= 3", "got 4"],
    ),
    "a contact with mass 0": ({**FRAME, "contact_masses": [0]}, ["contact_masses[0] must be >= 1", "got 0"]),
    "a load that does not exist": ({**FRAME, "load_mass": 4}, ["load_mass must be <= 3", "got 4"]),
    "between a mass and itself": (
        {**FRAME, "contact": "between-masses", "contact_masses": [2, 2]},
        ["contact_masses must be [A, B] with A < B", "[2, 2]"],
    ),
    "between masses in the wrong order": (
        {"contact": "between-masses", "contact_masses": [3, 1], **RATIOS},
        ["contact_masses must be [A, B] with A < B", "[3, 1]"],
    ),
    "between masses of which one does not exist": (
        {"contact": "between-masses", "contact_masses": [1, 4], **RATIOS},
        ["contact_masses[1] must be <= 3", "got 4"],
    ),
    "between more than two": (
        {"contact": "between-masses", "contact_masses": [1, 2, 3], **RATIOS},
        ["contact_masses must name two masses [A, B]", "[1, 2, 3]"],
    ),
    "between degrees of freedom of one": (
        {"contact": "between-masses", "contact_masses": [1, 2], "matrices": {"M": [[1.0]], "K": [[1.0]]}},
        ["contact must be fixed-wall or joined-base-wall for one mass"],
    ),
    "an unknown excitation": ({"excitation": "bases"}, ["excitation must be one of force, base", "base?"]),
    "an unknown reference": (
        {"damping_reference": "wall"},
        ["damping_reference must be one of ground, base", "'wall'"],
    ),
    "dashpots to a base at rest": (
        {"damping_reference": "base"},
        ["damping_reference must be ground unless the base moves", "got 'base'"],
    ),
    "a load on mass 2 of a moving base": (
        {"excitation": "base", "load_mass": 2, **RATIOS},
        ["load_mass must be 1 for base excitation", "got 2"],
    ),
    "a load on mass 2 of a joined base-wall": (
        {**FRAME, "contact": "joined-base-wall", "load_mass": 2},
        ["load_mass must be 1 for joined-base-wall", "got 2"],
    ),
    # chains
    "a ratio of zero": (
        {"mass_ratios": [1, 1], "stiffness_ratios": [1, 0]},
        ["stiffness_ratios[1] must be > 0", "got 0"],
    ),
    "a ratio below zero": (
        {"mass_ratios": [1, -2], "stiffness_ratios": [1, 1]},
        ["mass_ratios[1] must be > 0", "got -2"],
    ),
    "a spring too few": (
        {"mass_ratios": [1, 1, 1], "stiffness_ratios": [1, 1]},
        ["stiffness_ratios must have as many values as mass_ratios (3)", "got 2"],
    ),
}  # fmt: skip


@pytest.mark.parametrize(("settings", "words"), BAD_SYSTEMS.values(), ids=BAD_SYSTEMS)
def test_bad_systems(settings, words):
    with pytest.raises(fm.InputError) as caught:
        fm.System(**settings)
    message = str(caught.value)
    assert "\n" not in message
    for word in words:
        assert word in message, message


def status_and_message(folder, capsys, system):
    """Exit status of `boundaries` for these keys of [system], and the one line on standard error."""
    tree = {"system": system, "grid": {"r": [0.5], "beta": [0.5]}}
    (folder / "configs").mkdir(exist_ok=True)
    (folder / "configs" / "c.toml").write_text(to_toml(tree))
    before = sorted(folder.rglob("*"))
    status = main(["boundaries", str(folder / "configs" / "c.toml"), "-o", str(folder / "out.nc")])
    out, err = capsys.readouterr()
    if status:
        assert sorted(folder.rglob("*")) == before
        assert out == ""
        assert err.count("\n") == 1
    return status, err


@pytest.mark.parametrize(("settings", "words"), BAD_SYSTEMS.values(), ids=BAD_SYSTEMS)
def test_bad_systems_from_the_command_line(tmp_path, capsys, settings, words):
    (tmp_path / "configs").mkdir()
    if "matrices" in settings:
        np.savez(tmp_path / "configs" / "frame.npz", **settings["matrices"])
        settings = {**settings, "matrices": "frame.npz"}
    status, message = status_and_message(tmp_path, capsys, settings)
    assert status == 2
    assert message.startswith("frictionmap: system.")
    for word in words:
        assert word in message, message


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"load": [1.0, 2.0]}, ["load must have one number a mass (1)", "got 2"]),
        ({"load": []}, ["load must have one number a mass (1)", "got 0"]),
        ({"load": [0.0]}, ["load must have a value that is not zero"]),
        ({"load": [0j, 0, 0.0], **RATIOS}, ["load must have a value that is not zero"]),
        ({"load": [math.nan]}, ["load[0] must be finite", "nan"]),
        ({"load": [complex(1.0, math.inf)]}, ["load[0] must be finite", "inf"]),
        ({"load": ["1"]}, ["load[0] must be a number", "'1'"]),
        ({"load": [True]}, ["load[0] must be a number", "True"]),
        ({"load": 1.0}, ["load must be a list of numbers", "1.0"]),
        ({"load": [1.0], "load_mass": 1}, ["load must be left out if load_mass is given", "1"]),
        ({"load": [1.0], "excitation": "base"}, ["load must be left out with base excitation", "[1.0]"]),
        ({"load": [1.0], "contact": "joined-base-wall"}, ["load must be left out with base excitation"]),
        ({"matrices": 5}, ["matrices must be the path of an .npz file or a mapping", "got 5"]),
        ({"matrices": np.eye(2)}, ["matrices must be the path of an .npz file or a mapping", "array("]),
        ({"matrices": {**CHAIN, "K": [[1.0], [1.0, 2.0]]}}, ["matrices: K must be an array of real numbers"]),
        ({"matrices": {**CHAIN, "C": None}}, ["matrices: C must be an array of real numbers", "object"]),
        ({"matrices": {1: np.eye(2)}}, ["matrices must have arrays M, K and optionally C", "got 1"]),
    ],
)
def test_bad_systems_that_a_configuration_cannot_have(settings, words):
    with pytest.raises(fm.InputError) as caught:
        fm.System(**settings)
    message = str(caught.value)
    assert "\n" not in message
    for word in words:
        assert word in message, message


# Files


class Harm:
    """What loading a pickle would do."""

    def __reduce__(self):
        return (print, ("a program has run",))


def archive(**members):
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w") as opened:
        for name, data in members.items():
            opened.writestr(name.replace("_", "."), data)
    return content.getvalue()


def saved(save, *arrays, **named):
    content = io.BytesIO()
    save(content, *arrays, **named)
    return content.getvalue()


PICKLED = saved(np.savez, M=np.array([[Harm()]], dtype=object), K=np.eye(1))
GOOD = saved(np.savez, **CHAIN)
EYE = saved(np.save, np.eye(2))

BAD_FILES = {
    "empty": (b"", "not an .npz file"),
    "text": (b"M = 1", "not an .npz file"),
    "one array": (EYE, "one array"),
    "a pickle": (pickle.dumps(Harm()), "not an .npz file"),
    "a pickled matrix": (PICKLED, "not an .npz file of plain arrays"),
    "cut short": (GOOD[:-100], "not an .npz file"),
    "damaged": (GOOD.replace(b"\x00\x00\xf0\x3f", b"\x00\x00\xf1\x3f"), "not an .npz file of plain arrays"),
    "an archive of something else": (archive(M_npy=b"M", K_npy=b"K"), "real numbers"),
    "an archive of text": (archive(a_txt=b"M"), "'a.txt'"),
    "an empty archive": (archive(), "M is missing, got none"),
    "a header that promises too much": (
        archive(M_npy=EYE.replace(b"(2, 2)", b"(9, 9)"), K_npy=EYE),
        "not an .npz file of plain arrays",
    ),
}  # fmt: skip


@pytest.mark.parametrize(("content", "word"), BAD_FILES.values(), ids=BAD_FILES)
def test_bad_files(tmp_path, capsys, content, word):
    (tmp_path / "configs").mkdir()
    (tmp_path / "configs" / "frame.npz").write_bytes(content)
    status, message = status_and_message(tmp_path, capsys, {"matrices": "frame.npz"})
    assert status == 2
    assert message.startswith("frictionmap: system.matrices")
    assert "arrays M, K and optionally C" in message or "must be an array" in message
    assert word in message
    assert "a program has run" not in message


@pytest.mark.parametrize(
    ("matrices", "words"),
    [
        ("missing.npz", ["system.matrices must be an .npz file", "missing.npz", "No such file or directory"]),
        (".", ["system.matrices must be an .npz file", "directory"]),
        ("", ["system.matrices must be the path of an .npz file", "''"]),
        (5, ["system.matrices must be the path of an .npz file", "5"]),
        (["a.npz"], ["system.matrices must be the path of an .npz file", "['a.npz']"]),
        ("a\0b", ["system.matrices must be an .npz file"]),
    ],
)
def test_bad_paths(tmp_path, capsys, matrices, words):
    status, message = status_and_message(tmp_path, capsys, {"matrices": matrices})
    assert status == 2
    for word in words:
        assert word in message, message


def test_a_good_file(tmp_path, capsys, monkeypatch):
    """A path is relative to the folder of the configuration, wherever the program is run; or absolute."""
    (tmp_path / "configs").mkdir()
    np.savez_compressed(tmp_path / "configs" / "frame.npz", **CHAIN)
    monkeypatch.chdir(tmp_path)
    for path in ("frame.npz", str(tmp_path / "configs" / "frame.npz")):
        keys = {"matrices": path, "frequency_scale": 2.0, "excitation": "base", "damping_ratios": 0.02}
        assert status_and_message(tmp_path, capsys, keys) == (0, "")
        ds = xr.load_dataset(tmp_path / "out.nc")
        (tmp_path / "out.nc").unlink()
        assert f'matrices = "{path}"' in ds.attrs["config"]
        assert ds.attrs["system"].startswith(
            "structure of 3 degrees of freedom from frame.npz, r = omega/2, "
        )
        system = fm.System(matrices=CHAIN, frequency_scale=2.0, excitation="base", damping_ratios=0.02)
        np.testing.assert_array_equal(ds.beta_lim, fm.boundaries(system, [0.5]).beta_lim)


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        (
            {"contact": "joined-base-wall", "excitation": "force"},
            "excitation must be base, or left out, for a",
        ),
        ({"mass_ratios": np.ma.masked_array([1.0], [True])}, "mass_ratios must have no masked values"),
        ({"damping_ratios": np.ma.masked_array([0.1], [True])}, "damping_ratios must have no masked values"),
        ({"mass_ratios": np.array(1.0)}, "mass_ratios must be a list of numbers; got array"),
        ({"mass_ratios": xr.DataArray([[1.0]])}, "mass_ratios must be a list of numbers; got <xarray"),
        ({"damping_ratios": [[0.1]]}, r"damping_ratios\[0\] must be a number"),
        (
            {"matrices": {"M": np.eye(2), "K": np.ma.masked_array(np.eye(2), np.eye(2))}},
            "matrices: K must have no masked values",
        ),
    ],
)
def test_nothing_is_dropped_in_silence(settings, message):
    with pytest.raises(fm.InputError, match=message) as error:
        fm.System(**settings)
    assert "\n" not in str(error.value)


def test_arrays_of_any_kind_are_lists():
    ratios = xr.DataArray([1.0, 2.0])
    system = fm.System(mass_ratios=ratios, stiffness_ratios=ratios.values, damping_ratios=0.1 * ratios)
    assert system == fm.System(mass_ratios=[1, 2], stiffness_ratios=[1, 2], damping_ratios=[0.1, 0.2])
    assert fm.System(damping_ratios=xr.DataArray(0.1)) == fm.System(damping_ratios=0.1)
    assert fm.System("joined-base-wall").excitation == "base"
    assert fm.System().excitation == "force"


@pytest.mark.filterwarnings("error")
def test_scales_that_are_none():
    with pytest.raises(
        fm.InputError, match=r"^stiffness_scale must be left out without matrices.*; got True$"
    ):
        fm.System(stiffness_scale=True)
    with pytest.raises(
        fm.InputError, match=r"^frequency_scale and stiffness_scale must leave M with entries"
    ):
        fm.System(matrices={"M": np.eye(2), "K": 2.0 * np.eye(2) - np.eye(2)[::-1]}, frequency_scale=1e200)
