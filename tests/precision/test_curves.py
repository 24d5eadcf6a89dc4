"""Response functions and boundaries of one mass against 22-digit values and 40-digit arithmetic."""

import math

import mpmath as mp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from kernels import callable_kernel

import frictionmap as fm
from benchmarks.references import closed_forms
from frictionmap._kernels import closed_form
from frictionmap._kernels.boundary import one_mass as maxima
from frictionmap._kernels.closed_form import damping_functions

decay = callable_kernel(closed_form.decay)
sincos_quarter = callable_kernel(closed_form.sincos_quarter)
largest_bracket = callable_kernel(maxima.largest_bracket)

pytestmark = pytest.mark.plain

CONTACT = {"sdof-wall": "fixed-wall", "sdof-base": "joined-base-wall"}

#: Rounding of a dozen operations; the functions themselves lose no digit.
TIGHT = 2e-14


def relative(value, exact):
    """Relative error of a double against a high-precision value."""
    if abs(exact) < 1e-60:  # zero, but for the rounding of the high precision
        return abs(value)
    return float(abs((mp.mpf(value) - exact) / exact))


def test_reference_rows(boundary_rows):
    """V, U, G, H, S, beta_lim and beta_stick of every row, to 1e-12 relative."""
    for row in boundary_rows:
        system = fm.System(contact=CONTACT[row["system"]], damping_ratios=float(row["zeta"]))
        ds = fm.boundaries(system, [float(row["r"])], [1.0, 1.2, 2.0])
        with mp.workdps(30):
            for name, key in (("V", "V_re"), ("V_imag", "V_im"), *((n, n) for n in "UGHS")):
                assert relative(float(ds[name][0]), mp.mpf(row[key])) < 1e-12, (name, row)
            for m, mu in enumerate(("1", "1.2", "2")):
                for name, key in (
                    ("beta_lim", f"beta_lim_mu{mu}"),
                    ("beta_lim_modal", f"beta_lim_modal_sum_mu{mu}"),
                ):
                    assert relative(float(ds[name][m, 0]), mp.mpf(row[key])) < 1e-12, (name, mu, row)
                stick = mp.mpf(row["beta_stick_mu1"]) / float(mu)
                assert relative(float(ds["beta_stick"][m, 0]), stick) < 1e-12, (mu, row)


# r and zeta where something is special: resonance, odd and even sub-multiples, zeta = 1, both ends
RATIOS = [0.03, 0.1, 1 / 7, 0.2, 0.25, 0.3, 1 / 3, 0.34, 0.45, 0.5, 0.7, 0.999, 1.0 - 1e-9, 1.001, 1.7, 9.0]
DAMPINGS = [0.0, 1e-9, 1e-3, 0.05, 0.3, 0.9, 1.0 - 1e-9, 1.0, 1.0 + 1e-9, 1.3, 5.0]


@pytest.mark.parametrize("zeta", DAMPINGS)
def test_functions_against_40_digits(zeta):
    """U, G, H, S and beta_lim for every kind of damping, resonance and sub-multiple."""
    body = closed_forms.one_mass(zeta)
    for r in RATIOS:
        exact = closed_forms.functions(body, r)
        ds = fm.boundaries(fm.System(damping_ratios=zeta), [r], [1.0, 1.5])
        # large zeta: g is the difference of two close functions of (zeta +- sqrt(zeta^2 - 1))
        tolerance = TIGHT * max(1.0, 1.0 / r) * (1.0 + zeta**2)
        for name in "UGHS":
            value, reference = float(ds[name][0]), getattr(exact, name.lower())
            assert relative(value, reference) < tolerance, (name, r, zeta)
        for m, mu in enumerate((1.0, 1.5)):
            reference = closed_forms.beta_lim(body, r, mu, exact)
            assert relative(float(ds["beta_lim"][m, 0]), reference) < tolerance, (r, zeta)


@pytest.mark.parametrize("distance", [10.0**-k for k in range(3, 16)])
@pytest.mark.parametrize("n", [1, 2, 3, 4, 5, 6, 7, 20, 21])
def test_no_digit_is_lost_next_to_sub_multiples(n, distance):
    """sin and cos of pi/(2r) keep full relative precision next to all of their zeros."""
    for r in ((1.0 + distance) / n, (1.0 - distance) / n):
        sine, cosine = sincos_quarter(1.0, 0.0, r)
        with mp.workdps(50):
            angle = mp.pi / (2 * mp.mpf(r))
            assert relative(sine, mp.sin(angle)) < 1e-15
            assert relative(cosine, mp.cos(angle)) < 1e-15


@pytest.mark.parametrize("r", [1.0 - 1e-3, 1.0 + 1e-6, 1.0 - 1e-9, 1.0 + 1e-12, 1.0 - 2**-53])
def test_beta_lim_next_to_resonance(r):
    """U/V is a finite ratio of infinite functions there; no digit of it may be lost."""
    body = closed_forms.one_mass(0.0)
    exact = closed_forms.functions(body, r)
    for mu in (1.0, 2.0):
        ds = fm.boundaries(fm.System(), [r], mu)
        assert relative(float(ds.beta_lim[0, 0]), closed_forms.beta_lim(body, r, mu, exact)) < TIGHT


@settings(max_examples=300, deadline=None, derandomize=True)
@given(
    r=st.floats(0.01, 3.0),
    zeta=st.one_of(st.just(0.0), st.floats(1e-6, 2.0)),
)
def test_maximum_is_global(r, zeta):
    """No sample of the bracket lies above S, and S is reached."""
    u, g = damping_functions(1.0, zeta, r)
    h = (g + 2.0 * zeta * r * u) / r**2
    if not (math.isfinite(u) and abs(u) < 1e8):
        return  # next to a pole of u samples in double precision prove nothing
    end = h + 1.0 / r**2
    s = largest_bracket(1.0 / r, zeta, u, g, end)
    count = int(200 * max(1.0, 1.0 / r))
    tau = math.pi * np.arange(1, count) / count
    q, e = np.array([decay(zeta, t / r) for t in tau]).T
    values = (u * np.cos(tau) + (1.0 + g) * q / r - u * e) / np.sin(tau)
    size = np.abs(values).max() + abs(u) + end
    # samples next to 0 and pi are quotients of two small numbers
    rounding = 1e-14 * size / np.sin(tau) / r
    assert np.all(values <= s + rounding)
    # between samples the bracket is curved by at most (its size)/r^2
    spacing = (math.pi / count / r) ** 2
    assert max(values.max(), end) >= s - 0.5 * spacing * size - rounding.min()


def test_search_is_skipped_where_it_cannot_matter():
    """Undamped with r >= 1/2: the end of the interval is the maximum (and so the floor comes back)."""
    for r in np.linspace(0.5, 4.0, 50):
        u, g = damping_functions(1.0, 0.0, r)
        assert largest_bracket(1.0 / r, 0.0, u, g, 1.0 / r**2) == 1.0 / r**2
