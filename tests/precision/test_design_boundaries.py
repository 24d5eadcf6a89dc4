"""Design questions about boundaries: closed forms, roots found apart, and dense samples."""

import mpmath as mp
import numpy as np
import pytest
from scipy.optimize import brentq

import frictionmap as fm
from benchmarks.references import closed_forms
from frictionmap.design.band import Band
from frictionmap.design.grading import FINE, graded, no_stop_poles, stick_poles
from frictionmap.design.limits import stick_limit
from frictionmap.design.nearest import around, no_stop_at, stick_at
from frictionmap.model.held_structure import complex_frequencies

CHAIN = {"contact_masses": [2], "mass_ratios": [1, 1], "stiffness_ratios": [1, 1]}


@pytest.mark.parametrize(("r", "beta"), [(1.5, 40.0), (1.6, 30.0), (1.0, 20.0), (2.5, 56.0)])
def test_a_working_point_next_to_a_narrow_peak_of_sticking(r, beta):
    """One mass, spring k_t = 2 in the contact: it does not slip while 2/|3 - r^2 + 0.02 i r| <= beta."""
    system = fm.System(damping_ratios=0.01, contact_stiffness=2.0)
    half = 3.0 - 0.5 * 0.02**2
    squares = half + np.array([-1.0, 1.0]) * np.sqrt(half**2 - 9.0 + (2.0 / beta) ** 2)
    nearest = min(np.sqrt(squares), key=lambda root: abs(root - r))
    ds = fm.design.margin(system, r, beta)
    assert ds.nearest_r_on_beta_stick.item() == pytest.approx(nearest, rel=1e-9)
    assert ds.margin_r_stick.item() == pytest.approx(nearest / r - 1.0, rel=1e-7)


def half_range(r, second):
    """Of the force on mass 2, which is held, of two unit masses and springs with zeta 0.01, loads 1 and
    `second` of the orders 1 and 2 on mass 1."""
    mass, stiffness = np.eye(2), np.array([[2.0, -1.0], [-1.0, 1.0]])
    w2, phi = np.linalg.eigh(stiffness)
    damping = mass @ phi @ np.diag(0.02 * np.sqrt(w2)) @ phi.T @ mass
    tau = np.linspace(0.0, 2.0 * np.pi, 20001)
    force = np.zeros_like(tau)
    for n, load in ((1, 1.0), (2, second)):
        s = 1j * n * r
        x = load / (stiffness[0, 0] + s * damping[0, 0] + s * s)
        force += ((stiffness[1, 0] + s * damping[1, 0]) * x * np.exp(1j * n * tau)).real
    return 0.5 * np.ptp(force)


def test_a_working_point_next_to_the_peak_of_a_second_harmonic():
    """The held mass 1 resonates at sqrt(2), and at half of it with the second harmonic."""
    system = fm.System(**CHAIN, damping_ratios=0.01, load_harmonics={1: [1, 0], 2: [0.1, 0]})
    ds = fm.design.margin(system, 0.9, 2.0)
    root = brentq(lambda r: half_range(r, 0.1) - 2.0, 0.710, 0.725, xtol=1e-12)
    assert ds.nearest_r_on_beta_stick.item() == pytest.approx(root, rel=1e-7)  # samples of tau: 5e-8
    between = np.linspace(root + 1e-4, 0.9 + (0.9 - root), 400)
    assert all(half_range(r, 0.1) < 2.0 for r in between)


LOW = (
    ([1.0, 0.8, 1.53], [1.0, 0.44, 1.5], 1, [0.18, 0.63]),
    ([1.0, 0.77], [1.0, 1.47], 2, [0.56, 2.56]),
)


@pytest.mark.parametrize(("masses", "springs", "contact", "band"), LOW)
def test_dips_where_each_sample_is_found_by_following_motions(masses, springs, contact, band):
    """beta_lim in closed form, T(5.55) with the maximum of the sum, and around its minimum."""
    n = len(masses)
    ratios = {"mass_ratios": masses, "stiffness_ratios": springs, "damping_ratios": 0.007}
    ds = fm.design.no_stop(fm.System(contacts=[fm.Contact("fixed-wall", contact)], **ratios), band)
    unit = np.eye(n)
    with mp.workdps(30):
        body = closed_forms.structure(
            *closed_forms.chain_matrices(masses, springs), unit[contact - 1], unit[0], 0, [0.007] * n
        )

        def beta_lim(r):
            return float(closed_forms.beta_lim(body, r, 1.0, closed_forms.functions(body, r)))

        r = ds.at_r.item()
        assert ds.beta.item() == pytest.approx(beta_lim(r), rel=1e-9)
        around = r * (1.0 + 0.007 * np.linspace(-3.0, 3.0, 13))
        assert min(beta_lim(one) for one in around) >= ds.beta.item() * (1.0 - 1e-9)
    plain = fm.System(contact_masses=[contact], **ratios)
    grid = fm.boundaries(plain, np.linspace(*band, 20_000)).beta_lim
    assert ds.beta.item() <= grid.min() <= ds.beta.item() * 1.001


def test_the_nearest_crossing_of_a_narrow_dip():
    """At a third of the natural frequency; with zeta = 0.01 the dip is 2 % wide."""
    plain = fm.System(damping_ratios=0.01)
    r = np.linspace(0.32, 0.36, 40_001)
    below = r[fm.boundaries(plain, r).beta_lim.values[0] < 0.01]
    for system in (plain, fm.System(contacts=[fm.Contact("fixed-wall", 1)], damping_ratios=0.01)):
        found = fm.design.margin(system, 0.36, 0.01).nearest_r_on_beta_lim.item()
        assert found == pytest.approx(below.max(), abs=1e-6)


def any_system(random):
    n = int(random.integers(1, 4))
    ratios = {
        "mass_ratios": [1.0, *random.uniform(0.4, 1.6, n - 1)],
        "stiffness_ratios": [1.0, *random.uniform(0.4, 1.6, n - 1)],
        "damping_ratios": random.choice([0.002, 0.01, 0.05]),
    }
    place = int(random.integers(1, n + 1))
    kind = random.integers(4)
    if kind == 0:
        return fm.System(contact_masses=[place], contact_stiffness=random.uniform(0.3, 4.0), **ratios)
    if kind == 1:
        two = [fm.Contact("fixed-wall", 1), fm.Contact("fixed-wall", n, ratio=random.uniform(0.3, 1.5))]
        return fm.System(contacts=two if n > 1 else two[:1], **ratios)
    if kind == 2:
        loads = {1: [1.0, *[0.0] * (n - 1)], 3: [random.uniform(0.05, 0.6), *[0.0] * (n - 1)]}
        return fm.System(contact_masses=[place], load_harmonics=loads, **ratios)
    return fm.System(contact_masses=[place], **ratios)


@pytest.mark.parametrize("seed", range(12))
def test_no_crossing_of_dense_samples_is_nearer(seed):
    random = np.random.default_rng(seed)
    system, r = any_system(random), random.uniform(0.2, 3.0)
    dense = np.union1d(np.geomspace(0.1 * r, 10.0 * r, 20_001), [r])
    values = stick_limit(system, dense, 1.0)
    near = values[(dense > 0.3 * r) & (dense < 3.0 * r)]
    beta = np.exp(random.uniform(*np.log([near.min() + 1e-3, 1.1 * near.max() + 2e-3])))
    found = fm.design.margin(system, r, beta).nearest_r_on_beta_stick.item()
    k = np.flatnonzero((values[1:] > beta) != (values[:-1] > beta))
    if not k.size:
        assert np.isnan(found)
        return
    nearest = min(abs(dense[k] - r).min(), abs(dense[k + 1] - r).min())
    assert abs(found - r) <= nearest + 3e-4 * r
    assert stick_limit(system, np.array([found]), 1.0)[0] == pytest.approx(beta, rel=1e-9)


def test_samples_are_close_where_poles_are():
    system = fm.System(**CHAIN, damping_ratios=0.003)
    band = Band(0.3, 2.2)
    for poles in (stick_poles(system), no_stop_poles(system, band.low)):
        r = graded(band, poles, FINE)
        middle, step = 0.5 * (r[1:] + r[:-1]), np.diff(r)
        distance = np.abs(middle[:, np.newaxis] - poles).min(axis=1)
        assert (step > 0.0).all()
        assert (step <= FINE * np.minimum(distance, middle) * (1.0 + 1e-12)).all()
        assert (r[0], r[-1]) == band


def test_complex_frequencies_are_those_of_the_modes():
    """Modal damping: w (sqrt(1 - zeta^2) + i zeta); with mass 2 held, mass 1 alone between two springs."""
    system = fm.System(**CHAIN, damping_ratios=[0.02, 0.1])
    modes = system.modes
    found = np.sort_complex(complex_frequencies(modes.mass, modes.damping, modes.stiffness, np.empty((0, 2))))
    zeta = np.array([0.02, 0.1])
    expected = np.sort_complex(modes.w * (np.sqrt(1.0 - zeta**2) + 1j * zeta))
    np.testing.assert_allclose(found, expected, rtol=1e-12)
    (held,) = complex_frequencies(modes.mass, modes.damping, modes.stiffness, np.array([[0.0, 1.0]]))
    c = modes.damping[0, 0]
    assert held == pytest.approx(np.sqrt(2.0 - 0.25 * c * c) + 0.5j * c, rel=1e-12)


def test_no_friction_is_without_stops_at_a_pole_without_damping():
    """At a third of the natural frequency U is infinite without damping, and beta_lim is 0, T(3.21)."""
    assert fm.design.no_stop(fm.System(), [0.3, 0.6]).beta.item() == 0.0


def test_the_search_ends_where_motions_are_followed_no_further():
    """With a natural frequency of 100 motions are followed from r = 0.01 up; closed forms reach further."""
    light = {"mass_ratios": [1, 1e-4], "stiffness_ratios": [1, 1], "damping_ratios": 0.05}
    listed = fm.System(contacts=[fm.Contact("fixed-wall", 1)], **light)
    for r in (0.05, 0.5):
        low, high = around(no_stop_at(listed, 0.1, 1.0), r)
        assert (low, high) == (pytest.approx(max(0.1 * r, 0.01), rel=0.1), 10.0 * r)
        assert np.isfinite(fm.boundaries(listed, [low]).beta_stick.item())
        assert around(stick_at(listed, 0.1, 1.0), r).low == 0.1 * r
        assert around(no_stop_at(fm.System(**light), 0.1, 1.0), r).low == 0.1 * r
