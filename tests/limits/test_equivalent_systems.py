"""One structure in other words has the same curves: matrices, scales, order of masses, base, loads."""

import dataclasses
import math

import numpy as np
import pytest
import xarray as xr
from structures import CHAIN, RATIOS, chain_matrices, pendants

import frictionmap as fm
from frictionmap.features import high_frequency_limits, peak_thresholds
from frictionmap.theory.boundary_curves import many_mode_curves, one_mass_curves

MU = [1.0, 1.4]
R = np.linspace(0.13, 2.9, 61)
BOUNDARIES = ("beta_lim", "beta_lim_modal", "beta_stick")


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


def test_a_damping_matrix_may_distinguish_modes_of_one_frequency():
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
