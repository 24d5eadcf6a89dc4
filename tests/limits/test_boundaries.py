"""Boundaries in limiting cases, and what they must be to each other whatever the numbers are."""

import math

import numpy as np
import pytest

import frictionmap as fm

pytestmark = pytest.mark.plain


def test_limits():
    """r = 0, r = 1, odd and even sub-multiples, r -> infinity."""
    ds = fm.boundaries(fm.System(), [0.0, 0.25, 1 / 3, 0.5, 1.0, 1e7], [1.0, 2.0])
    assert ds.beta_lim[0, 0] == 0.0
    assert ds.beta_lim[0, 4] == math.pi / 4
    assert ds.beta_lim[1, 4] == math.pi / 4
    assert math.isinf(ds.V[4])
    assert math.isinf(ds.U[4])
    # beta_lim vanishes at 1/3; the double next to 1/3 is off by 2e-17
    assert ds.beta_lim[0, 2] < 1e-15
    # U = 0: |V|/S with S = 1/r^2
    assert ds.U[3] == 0.0
    assert float(ds.beta_lim[0, 3]) == pytest.approx(1 / 3, rel=1e-15)
    for m, mu in enumerate((1.0, 2.0)):  # T(2.31) with mu squared
        limit = 2.0 / math.sqrt(4.0 * mu**2 + math.pi**2)
        assert float(ds.beta_lim[m, 5]) == pytest.approx(limit, rel=1e-12)


def test_joined_base_wall_is_the_fixed_wall_scaled():
    """The load in the contact is |F|, F = r^2 - 2 i zeta r: beta_lim and beta_stick scale with it."""
    r = np.linspace(0.06, 3.0, 50)
    for zeta in (0.0, 0.1, 1.2):
        wall = fm.boundaries(fm.System(damping_ratios=zeta), r, [1.0, 1.5])
        base = fm.boundaries(fm.System(contact="joined-base-wall", damping_ratios=zeta), r, [1.0, 1.5])
        load = np.abs(r**2 - 2j * zeta * r)
        np.testing.assert_allclose(base.beta_lim, wall.beta_lim * load, rtol=1e-14)
        np.testing.assert_allclose(base.beta_stick, wall.beta_stick * load, rtol=1e-14)
        response = (base.V + 1j * base.V_imag).values
        x = 1.0 / (1.0 - r**2 + 2j * zeta * r)  # T(3.9): V of z is that of x less the base's motion
        np.testing.assert_allclose(response, x - 1.0, rtol=1e-10)


def test_mu_1_beta_lim_never_passes_beta_stick():
    """With mu = 1 a continuous motion needs a load above the friction: the strip is never negative."""
    r = np.concatenate((np.geomspace(1e-3, 1e3, 2000), 1.0 / np.arange(1, 30)))
    for zeta in (0.0, 0.01, 0.5, 2.0):
        ds = fm.boundaries(fm.System(damping_ratios=zeta), np.unique(r))
        assert np.all(ds.beta_lim <= ds.beta_stick)


@pytest.mark.plain
def test_one_mass_by_many():
    """The code for many modes with one mode equals that for one mass."""
    for contact in ("fixed-wall", "joined-base-wall"):
        for zeta in (0.0, 0.03, 1.0, 2.0):
            system = fm.System(contact=contact, damping_ratios=zeta)
            r = np.concatenate((np.linspace(0.04, 2.5, 200), [0.25, 1 / 3, 0.5, 1.0 - 1e-9]))
            r = np.unique(r[r != 1.0])
            mu = np.array([1.0, 1.4])
            from frictionmap.theory.boundary_curves import many_mode_curves, one_mass_curves

            one = one_mass_curves(system, r, mu).curves
            many = many_mode_curves(system, r, mu)
            for name in ("v", "u", "g", "h", "s", "beta_lim", "beta_lim_modal"):
                np.testing.assert_allclose(
                    getattr(many, name), getattr(one, name), rtol=1e-11, atol=1e-13, err_msg=name
                )
            np.testing.assert_allclose(many.beta_stick, one.beta_stick, rtol=1e-11)


def test_a_stiff_link_acts_as_one_mass():
    """Two masses on a link of stiffness 1e8 are one mass of their sum: r scales with its square root."""
    # without damping the link would ring at random phases of its 10^4 turns: it is damped critically
    two = fm.System(mass_ratios=[1.0, 2.0], stiffness_ratios=[1.0, 1e8], damping_ratios=[0.0, 1.0])
    r = np.linspace(0.1, 1.5, 30)
    one = fm.boundaries(fm.System(), r * math.sqrt(3.0))
    linked = fm.boundaries(two, r)
    # the contact's own mass jumps at a turn: only U and V are those of one mass
    np.testing.assert_allclose(linked.U, one.U, rtol=1e-6, atol=1e-6)
    np.testing.assert_allclose(linked.V, one.V, rtol=1e-6)
    np.testing.assert_allclose(linked.beta_stick, one.beta_stick, rtol=1e-6)


@pytest.mark.plain
def test_renumbering_changes_nothing():
    """A chain is held at one end only; but masses of equal chains swapped by symmetry give equal curves."""
    # contact and load swapped: V, U of the contact by reciprocity (|V| is symmetric in load and contact)
    r = np.linspace(0.1, 3.0, 50)
    chain = {"mass_ratios": [1.0, 0.7, 1.9], "stiffness_ratios": [1.0, 1.3, 0.6]}
    ab = fm.boundaries(fm.System(contact_masses=[2], load_mass=3, **chain), r)
    ba = fm.boundaries(fm.System(contact_masses=[3], load_mass=2, **chain), r)
    np.testing.assert_allclose(ab.V, ba.V, rtol=1e-9, atol=1e-11)


@pytest.mark.plain
def test_limits_of_many_masses():
    """r -> 0 and r -> infinity; undamped resonances; a mode that the contact does not see."""
    two = fm.System(mass_ratios=[1.0, 1.0], stiffness_ratios=[1.0, 1.0])
    ds = fm.boundaries(two, [0.0, 1e6], [1.0, 2.0])
    assert np.all(ds.beta_lim[:, 0] == 0.0)
    for m, mu in enumerate((1.0, 2.0)):  # T(6.8), mu squared, load on the mass in contact
        assert float(ds.beta_lim[m, 1]) == pytest.approx(2.0 / math.hypot(2.0 * mu, math.pi), rel=1e-9)
        assert float(ds.beta_stick[m, 1]) == pytest.approx(1.0 / mu, rel=1e-9)
    # minimum beta for a finite peak, T(6.2), (6.26): (pi/4)|lambda/chi|; here beta_lim next to it
    parts = np.diagonal(two.modes.participation(two.modes.w))
    for w, chi, part in zip(two.modes.w, two.modes.chi, parts, strict=True):
        ds = fm.boundaries(two, [w * (1.0 - 1e-9), w, w * (1.0 + 1e-9)])
        np.testing.assert_allclose(ds.beta_lim[0], 0.25 * math.pi * abs(part / chi), rtol=1e-5)
