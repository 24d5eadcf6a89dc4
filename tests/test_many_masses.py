"""Curves of several masses: 22-digit values, limits, invariants, numbers printed in the thesis."""

import math

import mpmath as mp
import numpy as np
import pytest
from conftest import ROOT
from kernels import callable_kernel

import frictionmap as fm
from frictionmap._kernels import closed_form
from frictionmap._kernels.boundary import structure as sums
from frictionmap._kernels.boundary.structure import ROWS

decay = callable_kernel(closed_form.decay)
largest_sum = callable_kernel(sums.largest_sum)
mode_sums = callable_kernel(sums.mode_sums)

KINDS = {"wall": "fixed-wall", "base": "joined-base-wall", "masses": "between-masses"}

#: The reference's sum of modal maxima misses a maximum of mode 3 at tau = 0.00085, next to the end of the
#: interval, in this row; it lies 8e-6 above the end's limit (sampled in 75 digits).
MISSED = ("3dof-base2", "0.2896")


def chain(entry, zeta=0.0):
    """A system of the reference file."""
    kind, *masses = entry["contact"]
    return fm.System(
        contact=KINDS[kind], contact_masses=masses, load_mass=entry["load"],
        mass_ratios=[float(value) for value in entry["gamma"]],
        stiffness_ratios=[float(value) for value in entry["kappa"]], damping_ratios=zeta,
    )  # fmt: skip


def test_reference_rows(all_boundaries):
    """V, U, G, H, S, beta_lim and beta_stick of every row, 12 systems x 3 dampings, to 1e-11 relative.

    U is a sum that may vanish: its error counts against the sum of moduli.
    """
    systems, rows = all_boundaries
    for row in rows:
        system = chain(systems[row["system"]], float(row["zeta"]))
        r = float(row["r"])
        ds = fm.boundaries(system, [r], [1.0, 1.2, 2.0])
        # what a rounding of r does to the functions: they turn by pi w/r
        modes = system.modes
        sensitive = 1e-15 * np.max(modes.w) / r / min(1.0, np.min(np.abs(modes.w / r % 1.0 - 0.5)))
        tolerance = max(1e-11, sensitive)
        for name, key in (("V", "V_re"), ("V_imag", "V_im"), *((n, n) for n in "UGHS")):
            value, exact = float(ds[name][0]), float(row[key])
            scale = max(abs(exact), 0.01 * abs(float(row["S"])) * r**2 if name == "U" else 0.0)
            assert abs(value - exact) <= tolerance * max(scale, 1e-3), (name, row, value)
        for m, mu in enumerate(("1", "1.2", "2")):
            exact = float(row[f"beta_lim_mu{mu}"])
            assert float(ds.beta_lim[m, 0]) == pytest.approx(exact, rel=tolerance), (mu, row)
            if (row["system"], row["r"]) != MISSED:
                exact = float(row[f"beta_lim_modal_sum_mu{mu}"])
                assert float(ds.beta_lim_modal[m, 0]) == pytest.approx(exact, rel=tolerance), (mu, row)
            with mp.workdps(30):
                exact = float(mp.mpf(row["beta_stick_mu1"]) / mp.mpf(mu))
            assert float(ds.beta_stick[m, 0]) == pytest.approx(exact, rel=1e-11), (mu, row)


@pytest.mark.plain
def test_the_modal_sum_is_only_a_bound():
    """5-mass chain, contact on mass 3, T Fig. 6.17: 0.0174 against 0.0128 at r1 = 0.6."""
    system = fm.System(
        contact_masses=[3], mass_ratios=[1.0] * 5, stiffness_ratios=[1.0] * 5
    )  # fmt: skip
    ds = fm.boundaries(system, [0.4, 0.6])
    assert np.round(ds.beta_lim[0].values * [1.0, 10.0], 4).tolist() == [0.1064, 0.1741]
    assert np.round(ds.beta_lim_modal[0].values * [1.0, 10.0], 4).tolist() == [0.0809, 0.1281]


@pytest.mark.plain
@pytest.mark.parametrize("zeta", [0.0, 0.02, 1.0, 1.5])
def test_modal_sum_is_never_above(zeta):
    system = fm.System(
        contact="between-masses", contact_masses=[2, 4], load_mass=3, mass_ratios=[1, 2, 0.5, 1.5],
        stiffness_ratios=[1, 0.7, 1.3, 0.4], damping_ratios=zeta,
    )  # fmt: skip
    ds = fm.boundaries(system, np.linspace(0.05, 3.0, 400), [1.0, 1.5])
    assert np.all(ds.beta_lim_modal <= ds.beta_lim * (1.0 + 1e-12))
    assert np.all(np.isfinite(ds.beta_lim))


@pytest.mark.plain
def test_one_mass_by_many():
    """The code for many modes with one mode equals that for one mass."""
    for contact in ("fixed-wall", "joined-base-wall"):
        for zeta in (0.0, 0.03, 1.0, 2.0):
            system = fm.System(contact=contact, damping_ratios=zeta)
            r = np.concatenate((np.linspace(0.04, 2.5, 200), [0.25, 1 / 3, 0.5, 1.0 - 1e-9]))
            r = np.unique(r[r != 1.0])
            mu = np.array([1.0, 1.4])
            from frictionmap.theory.boundaries import many_mode_curves, one_mass_curves

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


def test_global_maximum_of_random_sums():
    """No sample of the bracket of many modes lies above S."""
    rng = np.random.default_rng(5)
    for _ in range(150):
        n = int(rng.integers(1, 7))
        w = np.sort(rng.uniform(0.2, 3.0, n))
        zeta = rng.choice([0.0, 0.01, 0.2, 1.0, 1.4], n)
        chi = rng.normal(size=n)
        r = float(rng.uniform(0.08, 3.0))
        table = np.empty((ROWS, n))
        u, _, h, _, used = mode_sums(r, w, zeta, chi, table)
        end = h + float(np.sum(chi**2)) / r**2
        s = largest_sum(end, table, used, np.empty((80, 8)))
        tau = np.linspace(0.0, np.pi, 4000)[1:-1]
        y = np.zeros_like(tau)
        for i in range(used):
            q, e = np.array([decay(table[2, i], table[1, i] * t) for t in tau]).T
            y += table[0, i] * (table[3, i] * q + table[4, i] * e)
        values = (u * np.cos(tau) + y) / np.sin(tau)
        size = abs(u) + np.abs(y).max() + abs(end)
        assert np.all(values <= s + 1e-12 * size / np.sin(tau))
        assert max(values.max(), end) >= s - 1e-3 * size


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


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"mass_ratios": [1.0, 2.0]}, "stiffness_ratios must have as many values as mass_ratios"),
        ({"contact": "between-masses"}, "for one mass"),
        ({"contact_masses": [3]}, r"contact_masses\[0\] must be <= 1; got 3"),
        ({"contact_masses": [1, 1]}, "must name one mass"),
        ({"load_mass": 2}, "load_mass must be <= 1; got 2"),
        ({"mass_ratios": [1.0, -1.0], "stiffness_ratios": [1, 1]}, r"mass_ratios\[1\] must be > 0; got -1"),
        ({"mass_ratios": [2.0]}, "must be 1, the unit"),
        ({"damping_ratios": [0.1, 0.2]}, "one number or one a mode"),
    ],
)
def test_bad_systems(arguments, message):
    with pytest.raises(fm.InputError, match=message):
        fm.System(**arguments)


def test_bad_contacts_of_many():
    many = {"mass_ratios": [1, 1, 1], "stiffness_ratios": [1, 1, 1]}
    with pytest.raises(fm.InputError, match="with A < B"):
        fm.System(contact="between-masses", contact_masses=[2, 2], **many)
    with pytest.raises(fm.InputError, match="two masses"):
        fm.System(contact="between-masses", contact_masses=[2], **many)
    with pytest.raises(fm.InputError, match="load_mass must be 1 for joined-base-wall"):
        fm.System(contact="joined-base-wall", load_mass=2, **many)


@pytest.mark.parametrize("path", sorted((ROOT / "configs").glob("*.toml")), ids=lambda path: path.stem)
def test_every_configuration_loads(path):
    """Each file of configs/ is legal, and its curves have no hole but those that are limits."""
    config = fm.load_config(path)
    ds = fm.boundaries(config.system, config.r, config.mu)
    assert not np.any(np.isnan(ds.beta_lim))
    assert not np.any(np.isnan(ds.beta_stick))
    assert np.all(ds.beta_lim >= 0.0)
