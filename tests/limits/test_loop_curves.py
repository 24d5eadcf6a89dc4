"""Response curves and design questions of rigid contacts that close a loop: against maps and open chains."""

import numpy as np
import pytest

import frictionmap as fm

PAIRS = [(1, 2), (2, 3), (1, 3)]
R, BETA = [0.4, 0.7, 1.1], [0.05, 0.2, 5.0]
QUANTITIES = ["amplitude", "phase", "first_harmonic", "energy", "harmonics"]


def triangle(ratios, **further):
    """Three masses, contacts between all of them; those with ratio None are left out."""
    contacts = [
        fm.Contact("between-masses", pair, ratio=ratio)
        for pair, ratio in zip(PAIRS, ratios, strict=True)
        if ratio is not None
    ]
    given = further or {"load_mass": 2}
    return fm.System(
        contacts=contacts, mass_ratios=[1.0, 1.3, 0.8], stiffness_ratios=[1.0, 0.9, 1.2],
        damping_ratios=0.05, **given,
    )  # fmt: skip


def test_curves_are_those_of_the_cells_of_a_map():
    """Sliding, stick-slip and stuck cells; unknown numbers are NaN in both."""
    system = triangle([1.0, 0.6, 0.8])
    found = fm.curves(system, R, BETA, quantities=QUANTITIES, harmonics=3)
    names = [
        "regime", "status", "stops_per_cycle", "peak_to_peak", "contact_peak_to_peak", "sliding_distance",
        "amplitude", "contact_amplitude",
    ]  # fmt: skip
    cells = fm.sweep(system, R, BETA, outputs=names)
    assert (found.status == fm.regimes.RESOLVED).all()
    assert {0, 1} <= set(found.regime.values.ravel().tolist())
    for name in names:
        if name in ("stops_per_cycle", "sliding_distance"):  # none of stuck cells in curves
            np.testing.assert_allclose(found[name].values[:, :, :2], cells[name].values[:, :, :2], atol=1e-11)
        else:
            np.testing.assert_allclose(found[name].values, cells[name].values, rtol=1e-11, atol=1e-11)
    moving = found.isel(beta=slice(2))
    lost = moving.work_friction.sum("contact") + moving.work_damping
    np.testing.assert_allclose(moving.work_input, lost, rtol=1e-11)
    stuck = found.isel(beta=2)
    np.testing.assert_allclose(stuck.first_harmonic_amplitude, 0.5 * stuck.peak_to_peak, rtol=1e-12)
    np.testing.assert_array_equal(found.beta_stick, cells.beta_stick)


def test_harmonics_are_those_of_the_motion():
    """By a Fourier transform of a response; forces that are not determined in a common stop have none."""
    system = triangle([1.0, 0.6, 0.8])
    found = fm.curves(system, [0.7], [0.2], quantities=["harmonics"], harmonics=3).squeeze()
    motion = fm.response(system, 0.7, 0.2, points=1024)
    third = np.fft.rfft(motion.x.values[:, :-1])[:, 3] / 512.0
    values = found.displacement_harmonic.sel(harmonic=3).values
    assert values[:, 0] + 1j * values[:, 1] == pytest.approx(third, abs=1e-6)
    assert np.abs(third).max() > 1e-4
    known = np.isfinite(motion.friction.values).all(axis=1)
    assert np.isfinite(found.friction_harmonic.values).all(axis=(1, 2)).tolist() == known.tolist()


def test_designs_of_a_loop_with_a_frictionless_contact_are_those_of_a_chain():
    """Friction that holds, margins, the least peak: forces of a loop decide together, of a chain alone."""
    closed, opened = triangle([1.0, 0.7, 0.0]), triangle([1.0, 0.7, None])
    band = (0.4, 1.2)
    one, other = (fm.design.stuck(system, band) for system in (closed, opened))
    assert one.beta.item() == pytest.approx(other.beta.item(), rel=1e-9)
    assert one.at_r.item() == pytest.approx(other.at_r.item(), rel=1e-4)
    one, other = (fm.design.margin(system, 0.7, 0.5 * one.beta.item()) for system in (closed, opened))
    for name in ("beta_stick", "margin_beta_stick", "margin_r_stick"):
        assert one[name].item() == pytest.approx(other[name].item(), rel=1e-9), name
    one, other = (fm.design.least_peak(system, (0.55, 0.65), beta=(0.05, 0.4)) for system in (closed, opened))
    assert one.peak.item() == pytest.approx(other.peak.item(), rel=1e-9)
    assert one.beta.item() == pytest.approx(other.beta.item(), rel=1e-4)
    assert one.peak.item() > 0.1


def test_the_friction_that_holds_a_loop_over_a_band_is_the_largest_boundary():
    system, band = triangle([1.0, 0.6, 0.8]), (0.4, 1.2)
    found = fm.design.stuck(system, band)
    limits = fm.boundaries(system, np.linspace(*band, 4001)).beta_stick
    assert limits.max().item() <= found.beta.item() * (1.0 + 1e-12)
    assert found.beta.item() == pytest.approx(limits.max().item(), rel=1e-5)
    at = fm.boundaries(system, [found.at_r.item()]).beta_stick.item()
    assert at == pytest.approx(found.beta.item(), rel=1e-12)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda s: fm.design.no_stop(s, (0.4, 0.6)), "where contacts close a loop: no limit of it is known"),
        (lambda s: fm.curves(s, [0.5], [0.1], [1.2]), "mu must be 1 for motions of contacts that close"),
        (lambda s: fm.design.least_peak(s, (0.4, 0.6), mu=1.2, beta=(0.1, 0.2)), "mu must be 1 for motions"),
    ],
)
def test_what_curves_and_designs_of_a_loop_refuse(call, words):
    with pytest.raises(fm.InputError, match=words):
        call(triangle([1.0, 0.6, 0.8]))


def test_even_harmonics_leave_the_friction_that_holds_unknown():
    system = triangle([1.0, 0.6, 0.8], load_harmonics={1: 1.0, 2: 0.2})
    words = "with even harmonics and contacts that close a loop: the friction that holds has no closed form"
    with pytest.raises(fm.InputError, match=words):
        fm.design.stuck(system, (0.4, 0.6))
    with pytest.raises(fm.InputError, match=f"beta must be two friction ratios {words}"):
        fm.design.least_peak(system, (0.4, 0.6))
    found = fm.curves(system, [0.5], [0.1], quantities=["energy"])
    assert found.work_input.item() == pytest.approx(
        found.work_friction.sum().item() + found.work_damping.item(), rel=1e-11
    )
