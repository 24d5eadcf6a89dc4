"""Digits that differences of nearly equal numbers would lose, against 60-digit arithmetic done here."""

import math

import mpmath as mp
import numpy as np
import pytest

import frictionmap as fm
from frictionmap._kernels.closed_form import damping_functions


@pytest.fixture(autouse=True)
def _digits():
    with mp.workdps(60):
        yield


def _matrices(masses, springs, zeta):
    """M, K and C1 = sum of 2 zeta w (M phi)(M phi)^T; frequencies w and modes phi of a chain."""
    n = len(masses)
    mass, stiffness = mp.diag(masses), mp.zeros(n)
    for i in range(n):
        stiffness[i, i] += mp.mpf(springs[i])
        if i:
            stiffness[i - 1, i - 1] += mp.mpf(springs[i])
            stiffness[i, i - 1] = stiffness[i - 1, i] = -mp.mpf(springs[i])
    root = mp.diag([1 / mp.sqrt(m) for m in masses])
    squares, phi = mp.eigsy(root * stiffness * root)
    phi = root * phi
    w = [mp.sqrt(x) for x in squares]
    shapes = mass * phi
    damping = shapes * mp.diag([2 * mp.mpf(zeta) * x for x in w]) * shapes.T
    return mass, stiffness, damping, w, phi


def _contact_vector(contact, n):
    c = mp.zeros(n, 1)
    c[contact[-1] - 1] = 1
    if len(contact) == 2:
        c[contact[0] - 1] = -1
    return c


def _responses(masses, springs, zeta, contact, load, r):
    """|V| and |F| of theory.md 2 and 4 from the equations of motion."""
    mass, stiffness, damping, _, _ = _matrices(masses, springs, zeta)
    n = len(masses)
    dynamic = stiffness - mp.mpf(r) ** 2 * mass + mp.mpc(0, 1) * mp.mpf(r) * damping
    c, p = _contact_vector(contact, n), mp.zeros(n, 1)
    p[load - 1] = 1
    bordered, right = mp.zeros(n + 1), mp.zeros(n + 1, 1)
    for i in range(n):
        right[i] = p[i]
        bordered[i, n] = bordered[n, i] = c[i]
        for j in range(n):
            bordered[i, j] = dynamic[i, j]
    return abs((c.T * mp.lu_solve(dynamic, p))[0]), abs(mp.lu_solve(bordered, right)[n])


def _chain(masses, springs, zeta, contact, load):
    return fm.System(
        contact="fixed-wall" if len(contact) == 1 else "between-masses", contact_masses=contact,
        load_mass=load, mass_ratios=masses, stiffness_ratios=springs, damping_ratios=zeta,
    )  # fmt: skip


@pytest.mark.parametrize(
    ("masses", "springs"),
    [
        ([1.0, 1.0], [1.0, 1e8]),
        ([1.0, 1.0, 1.0], [1.0, 1e10, 1.0]),
        ([1.0, 1e-8], [1.0, 1.0]),
        ([1.0, 1e3, 1e-3, 2.0], [1.0, 1e-4, 1e5, 1.0]),
    ],
)
def test_frequencies_of_chains_with_stiff_and_soft_links(masses, springs):
    """Each to its own rounding, not to that of the highest."""
    exact = [float(w) for w in _matrices(masses, springs, 0.0)[3]]
    found = fm.System(mass_ratios=masses, stiffness_ratios=springs).modes.w
    np.testing.assert_allclose(found, exact, rtol=1e-14)


@pytest.mark.parametrize(
    ("masses", "springs", "zeta", "contact", "load", "r"),
    [
        ([1.0, 1.0], [1.0, 1e8], 0.01, [1], 1, 0.9),
        ([1.0, 1.0, 1.0], [1.0, 1e10, 1.0], 0.01, [3], 1, 0.3),
        ([1.0, 1.0, 1.0], [1.0, 1e10, 1.0], 0.01, [3], 1, 2.0),
        ([1.0] * 5, [1.0] * 5, 0.0, [3], 1, 30.0),
        ([1.0] * 5, [1.0] * 5, 0.01, [3], 1, 30.0),
        ([1.0] * 5, [1.0] * 5, 0.0, [3], 1, 1e5),
        ([1.0] * 5, [1.0] * 5, 0.0, [4, 5], 1, 1e5),
        ([1.0] * 5, [1.0] * 5, 0.0, [2, 3], 1, 1e-3),
        ([1.0, 0.5, 2.0], [1.0, 1e-5, 0.7], 0.0, [3], 1, 0.7),
        ([1.0] * 30, [1.0] * 30, 0.0, [28], 2, 2.5),
    ],
)
def test_response_far_from_the_load(masses, springs, zeta, contact, load, r):
    """V and beta_stick where the sum over modes cancels, or a stiff link drowns the others."""
    v, force = _responses(masses, springs, zeta, contact, load, r)
    ds = fm.boundaries(_chain(masses, springs, zeta, contact, load), [r])
    assert math.hypot(ds.V.item(), ds.V_imag.item()) == pytest.approx(float(v), rel=2e-14, abs=0.0)
    assert ds.beta_stick.item() == pytest.approx(float(force), rel=2e-14, abs=0.0)


def test_sticking_near_a_held_resonance_without_load():
    """Mass 3 resonates behind the held contact, and the load does not feed it: F is 0/0 in modes."""
    chain = [1.0, 0.5, 2.0], [1.0, 2.0, 0.7], 0.0, [2], 1
    for offset in (1e-13, -1e-13, 1e-10, 1e-6):
        r = math.sqrt(0.35) * (1.0 + offset)
        ds = fm.boundaries(_chain(*chain), [r])
        assert ds.beta_stick.item() == pytest.approx(float(_responses(*chain, r)[1]), rel=2e-14, abs=0.0)


def test_matrices_far_from_the_load():
    """The same of a structure given by matrices."""
    system = _chain([1.0] * 5, [1.0] * 5, 0.0, [3], 1)
    given = fm.System(
        matrices={"M": system.modes.mass, "K": system.modes.stiffness}, frequency_scale=1.0,
        contact_masses=[3], load_mass=1,
    )  # fmt: skip
    v, force = _responses([1.0] * 5, [1.0] * 5, 0.0, [3], 1, 30.0)
    ds = fm.boundaries(given, [30.0])
    assert abs(ds.V.item()) == pytest.approx(float(v), rel=2e-14, abs=0.0)
    assert ds.beta_stick.item() == pytest.approx(float(force), rel=2e-14, abs=0.0)


def _over_damped(zeta, r):
    """u and g, T(7.11), (7.12), with sin -> sinh."""
    zeta, a = mp.mpf(zeta), 1 / mp.mpf(r)
    s = mp.sqrt(zeta**2 - 1)
    x, angle = mp.pi * zeta * a, mp.pi * s * a
    below = mp.cosh(x) + mp.cosh(angle)
    return a * mp.sinh(angle) / s / below, (mp.sinh(x) - zeta / s * mp.sinh(angle)) / below


@pytest.mark.parametrize("zeta", [1.0 + 1e-13, 1.0 + 1e-4, 3.0, 30.0, 100.0])
def test_damping_functions_of_over_damped_modes(zeta):
    """On both sides of x = pi zeta/R = 1 and far from it; next to zeta = 1 the difference is of order x^3."""
    for r in (0.1, 1.0, math.pi * zeta * (1 - 1e-9), math.pi * zeta * (1 + 1e-9), 20.0 * zeta, 1e4, 1e6):
        u, g = _over_damped(zeta, r)
        found = damping_functions(1.0, zeta, r)
        assert found[0] == pytest.approx(float(u), rel=2e-14, abs=0.0)
        assert found[1] == pytest.approx(float(g), rel=2e-14, abs=0.0)


def _largest(masses, springs, zeta, contact, r):
    """S, theory.md 3, from samples, the highest three tops by golden sections."""
    _, _, _, w, phi = _matrices(masses, springs, zeta)
    chi = list(_contact_vector(contact, len(masses)).T * phi)
    r, zeta = mp.mpf(r), mp.mpf(zeta)
    s = mp.sqrt(1 - zeta**2)
    rows = []
    for part, rate in zip(chi, w, strict=True):
        a = rate / r
        x, angle = mp.pi * zeta * a, mp.pi * s * a
        below = mp.cosh(x) + mp.cos(angle)
        u, g = a * mp.sin(angle) / s / below, (mp.sinh(x) - zeta / s * mp.sin(angle)) / below
        rows.append(((part / rate) ** 2, a, u, g))

    def bracket(tau):
        total = mp.mpf(0)
        for c, a, u, g in rows:
            envelope = mp.exp(-zeta * a * tau)
            q = envelope * mp.sin(s * a * tau) / s
            e = envelope * mp.cos(s * a * tau) - zeta * q
            total += c * (u * mp.cos(tau) + (1 + g) * a * q - u * e)
        return total / mp.sin(tau)

    count = 240
    times = [mp.pi * k / count for k in range(1, count)]
    values = [bracket(tau) for tau in times]
    tops = [k for k in range(1, count - 2) if values[k - 1] <= values[k] >= values[k + 1]]
    best = max(values[0], values[-1])
    for k in sorted(tops, key=lambda k: values[k])[-3:]:
        low, high = times[k - 1], times[k + 1]
        for _ in range(70):
            left, right = low + (high - low) * mp.mpf("0.382"), low + (high - low) * mp.mpf("0.618")
            low, high = (low, right) if bracket(left) > bracket(right) else (left, high)
        best = max(best, bracket((low + high) / 2))
    h = sum(c * (g * a * a + 2 * zeta * a * u) for c, a, u, g in rows)
    inverse_mass = sum(1 / mp.mpf(masses[j - 1]) for j in contact)
    return max(best, h + inverse_mass / r**2)


@pytest.mark.parametrize(
    ("masses", "springs", "zeta", "contact"),
    [
        ([1.0, 1.0], [1.0, 1.0], 0.0, [1]),
        ([1.0] * 5, [1.0] * 5, 0.0, [3]),
        ([1.0, 1.0], [1.0, 1.0], 1e-3, [1, 2]),
        ([1.0] * 5, [1.0] * 5, 0.3, [3]),
    ],
)
def test_largest_bracket_near_a_resonance(masses, springs, zeta, contact):
    """S stays finite where u of an undamped mode is infinite: two terms of order u are nearly opposite."""
    system = _chain(masses, springs, zeta, contact, 1)
    w = float(system.modes.w[0])
    offsets = [1e-2, 1e-5, 1e-9, 1e-13]
    for r in [w * (1.0 + sign * x) for x in offsets for sign in (1, -1)]:
        exact = float(_largest(masses, springs, zeta, contact, r))
        # what rounding of w leaves uncertain: S turns within zeta of the resonance
        tolerance = 2e-13 if zeta else 2e-14
        assert fm.boundaries(system, [r]).S.item() == pytest.approx(exact, rel=tolerance, abs=0.0)


def test_largest_bracket_in_resonance():
    """To the bit at an undamped frequency S has its limit, and beta_lim its own, (pi/4)|lambda/chi|."""
    system = fm.System(mass_ratios=[1.0, 1.0], stiffness_ratios=[1.0, 1.0])
    for w, chi, part in zip(
        system.modes.w, system.modes.chi, np.diagonal(system.modes.participation(system.modes.w)), strict=True
    ):
        ds = fm.boundaries(system, [w])
        assert math.isinf(ds.U.item())
        exact = _largest([1.0, 1.0], [1.0, 1.0], 0.0, [1], w * (1.0 + 1e-15))
        assert ds.S.item() == pytest.approx(float(exact), rel=1e-14, abs=0.0)
        assert ds.beta_lim.item() == pytest.approx(0.25 * math.pi * abs(part / chi), rel=1e-14)
