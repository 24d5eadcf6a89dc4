"""Published results of other authors, from the script of the manual that shows them."""

import runpy

import matplotlib.pyplot as plt
import numpy as np
import pytest
from conftest import ROOT


@pytest.fixture(scope="module")
def shown():
    names = runpy.run_path(str(ROOT / "docs/gallery/plot_13_published.py"))
    plt.close("all")
    return names


def test_amplitudes_without_stops_of_den_hartog_and_hundal(shown):
    """Between resonances; next to them the closed form cancels."""
    assert len(shown["amplitude_errors"]) == 3
    for errors in shown["amplitude_errors"].values():
        assert errors.size > 800
        assert np.median(errors) < 1e-14
        assert errors.max() < 1e-11


def test_multipliers_of_shaw(shown):
    errors = shown["multiplier_errors"]
    assert errors.size > 800
    assert errors.max() < 1e-10


def test_the_numbers_of_stops_of_hong_and_liu(shown):
    """Cells with one stop are few: they lie next to undamped subharmonics."""
    assert {0, 2, 4, 6, 8, 10, 12, 14} <= set(shown["numbers"].astype(int))


def test_asymmetric_motions_of_csernak_stepan_and_shaw(shown):
    assert shown["asymmetric_limits"] == {n: (True, False, True) for n in (1, 2, 3)}


def test_the_least_peak_of_griffin(shown):
    assert shown["peaks"].min().item() == pytest.approx(np.pi, rel=0.1)


@pytest.mark.slow
def test_plates_of_leissa():
    """All 21 sets of edges: exact values where he has them, else upper bounds by 36 functions."""
    names = runpy.run_path(str(ROOT / "docs/gallery/plot_14_plates.py"))
    plt.close("all")
    assert len({frozenset((name, name[::-1])) for name in names["LEISSA"]}) == len(names["plates"]) == 21
    for letters, one in names["plates"].items():
        own, printed = one.frequencies, np.array(names["LEISSA"][letters])
        if letters in names["EXACT"]:
            np.testing.assert_allclose(printed, own, rtol=0.0, atol=5.1e-5)
        else:
            assert (printed >= own).all()
            assert (printed <= 1.01 * own).all()
        assert one.frequency_error.max() < 1e-5
