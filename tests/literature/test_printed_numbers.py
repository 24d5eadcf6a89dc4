"""Numbers that are printed: boundaries in the thesis, multipliers of a mass on a fixed wall."""

import pytest

import frictionmap as fm

pytestmark = pytest.mark.plain


def test_printed_numbers():
    """T p. 43 (2.30): finite peak from pi/4 = 0.785 on; T(2.31): 0.537 (three digits are printed)."""
    ds = fm.boundaries(fm.System(), [1.0, 1e6])
    assert round(float(ds.beta_lim[0, 0]), 3) == 0.785
    assert round(float(ds.beta_lim[0, 1]), 3) == 0.537


@pytest.mark.parametrize(
    ("r", "beta", "half"),
    [
        (2.0, 0.5, 0.525707j),
        (0.75, 0.5, 0.344681 + 0.509822j),
        (0.9, 0.6, 0.781573 + 0.229366j),
        (0.5, 0.2, -1.0),
    ],
)
def test_published_multipliers(r, beta, half):
    """Multipliers of the half-period map of one mass on a fixed wall, to the digits given."""
    ds = fm.sweep(fm.System(), [r], [beta], outputs=["multiplier"])
    assert ds.multiplier.item() == pytest.approx(abs(half) ** 2, abs=1.5e-6)
