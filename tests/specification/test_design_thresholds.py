"""Friction from which nothing moves, its spread, and cells without a periodic motion: what answers say."""

import numpy as np
import pytest

import frictionmap as fm
from frictionmap.datasets.amounts import Amounts
from frictionmap.design.limits import Extreme
from frictionmap.design.optimum import describe_cells
from frictionmap.design.performance import Performance, Unclear
from frictionmap.design.responses import Values
from frictionmap.files.reading import read
from frictionmap.files.summary import describe_file

ONE = fm.System(damping_ratios=0.05)
BAND = [0.6, 1.4]


def test_a_mass_that_is_held_has_a_threshold():
    """One mass on a wall carries the load 1: from beta 1 on it does not move."""
    ds = fm.design.least_peak(ONE, BAND)
    assert (ds.beta.item(), ds.peak.values.tolist(), str(ds.kind.values)) == (1.0, [0.0], "threshold")
    assert not {"peak_r", "peak_regime", "peak_stops"} & set(ds.variables)
    below = fm.sweep(ONE, np.linspace(*BAND, 50), [0.999, 1.0], outputs=["amplitude"]).amplitude.max("r")
    assert below.values.ravel()[0] > 1e-7
    assert below.values.ravel()[1] == 0.0


@pytest.mark.parametrize("spread", [0.05, 0.2, 0.5, 0.8])
def test_a_spread_reaches_the_threshold_at_its_lower_end(spread):
    """All of beta (1 - spread) to beta (1 + spread) holds from 1/(1 - spread) on, in the range by default."""
    ds = fm.design.robust(ONE, BAND, spread)
    assert ds.beta.item() == pytest.approx(1.0 / (1.0 - spread), rel=1e-15)
    assert (ds.peak.values.tolist(), str(ds.kind.values)) == ([0.0], "threshold")
    given = fm.design.robust(ONE, BAND, spread, beta=[0.0, 12.0])
    assert given.beta.item() == ds.beta.item()


def test_a_range_of_friction_that_ends_before_the_threshold():
    ds = fm.design.least_peak(ONE, BAND, beta=[0.3, 0.9])
    assert (ds.beta.item(), str(ds.kind.values)) == (0.9, "at the bound")
    assert ds.peak.values[0] > 0.1
    with pytest.raises(fm.InputError, match=r"begin below beta = 1, at .* is 0 .*; got beta = 2$"):
        fm.design.least_peak(ONE, BAND, beta=[2.0, 3.0])


def test_a_plateau_and_its_spread_begin_together():
    """More friction changes nothing: with a spread, from the begin of the plateau over 1 - spread."""
    wall, band = fm.System(contact="joined-base-wall", damping_ratios=0.02), [0.3, 2.5]
    sharp, robust = fm.design.least_peak(wall, band), fm.design.robust(wall, band, 0.25)
    assert str(sharp.kind.values) == str(robust.kind.values) == "plateau"
    assert robust.beta.item() * 0.75 == pytest.approx(sharp.beta.item(), rel=1e-9)
    assert robust.peak.values[0] == pytest.approx(1.0, rel=1e-9)


TWO = fm.System(
    damping_ratios=0.05, mass_ratios=[1, 1], stiffness_ratios=[1, 1], load_harmonics={1: [1, 0.8]},
    contacts=[fm.Contact("fixed-wall", 1), fm.Contact("fixed-wall", 2, ratio=0.3)],
)  # fmt: skip


def test_one_contact_that_holds_while_the_other_slides():
    """Mass 1 rests from less friction on than mass 2, on which the load 0.8 acts: that needs 0.8/0.3."""
    band = [0.4, 1.6]
    first = fm.design.least_peak(TWO, band, mass=1)
    second = fm.design.least_peak(TWO, band, mass=2)
    for ds in (first, second):
        assert (ds.peak.values.tolist(), str(ds.kind.values)) == ([0.0], "threshold")
    assert second.beta.item() == pytest.approx(0.8 / 0.3, rel=1e-12)
    r, beta = np.linspace(0.63, 0.66, 61), first.beta.item() * np.array([0.9999, 1.00001])
    moves = fm.sweep(TWO, r, beta, outputs=["contact_regime"]).contact_regime.values[0, :, :, 0] != 0
    assert (moves[:, 0].any(), moves[:, 1].any()) == (True, False)


def test_a_share_of_samples_that_hold():
    """Three samples whose loads need 1, 1.1 and 1.2: two thirds of them hold from 1.1 on."""
    system = fm.System(damping_ratios=0.05, load=[1.0])
    loads = {"sample": {"load[1]": [1.2, 1.0, 1.1]}}
    ds = fm.design.robust(system, BAND, fm.design.Samples(loads, 0.6))
    assert (ds.beta.item(), ds.peak.values.tolist(), str(ds.kind.values)) == (1.1, [0.0], "threshold")
    assert ds.beta_stuck.item() == 1.2


def test_what_is_printed_and_drawn_of_a_threshold(tmp_path):
    ds = fm.design.least_peak(ONE, BAND)
    text = describe_file(ds)
    assert "From beta = 1 mass 1 does not move for r between 0.6 and 1.4." in text
    assert "least peak," not in text
    assert "stick-slip" not in text
    assert "peaks  " not in text
    labels = [one.get_text() for one in fm.plot_design(ds)[0].figure.legends[0].get_texts()]
    assert "does not move from β = 1 on" in labels
    ds.to_netcdf(tmp_path / "threshold.nc")
    assert describe_file(read(tmp_path / "threshold.nc")) == text


CHAIN = {"contact_masses": [2], "mass_ratios": [1, 1], "stiffness_ratios": [1, 1], "damping_ratios": 0.01}


def test_irregular_cells_far_below_the_peak_do_not_decide(tmp_path):
    """At mu = 1.3 some cells near r = 1.2 have no period; their motion is two thirds of the peak at 1.55."""
    system = fm.System(**CHAIN)
    ds = fm.design.least_peak(system, [0.3, 2.2], mu=1.3)
    assert ds.beta.item() == pytest.approx(1.401948, rel=1e-5)  # that of mu = 1: the peak is without stops
    assert ds.peak.values[0] == pytest.approx(2.727102937, rel=1e-8)
    caution = ds.attrs["warnings"]
    assert "no periodic steady state at beta = 1.40" in caution
    assert "largest response seen 1.8" in caution
    twin = fm.System(contacts=[fm.Contact("fixed-wall", 2)], **{**CHAIN, "contact_masses": [1]})
    r = np.linspace(1.2, 1.21, 401)
    status = fm.sweep(system, r, [ds.beta.item()], 1.3, outputs=["status"]).status.values.ravel()
    assert (status == fm.regimes.IRREGULAR).any()
    whole = fm.sweep(twin, r[::8], [ds.beta.item()], 1.3, outputs=["amplitude"], cycles=8000)
    assert whole.amplitude.sel(dof=1).max() < 0.75 * ds.peak.values[0]  # in four times as many periods
    ds.to_netcdf(tmp_path / "cautious.nc")
    assert f"warning: {caution}" in describe_file(read(tmp_path / "cautious.nc"))


class Given:
    """Responses of a given shape, with an irregular motion at one frequency."""

    def __init__(self, seen):
        self.seen = seen

    def at(self, r, beta):
        size = 1.0 / np.hypot(1.0 - r * r, 0.2 * r)
        irregular = np.where(np.abs(r - 0.8) < 1e-9, self.seen, 0.0)
        return Values(
            np.where(irregular == 0.0, size, irregular), np.ones(r.size), np.ones(r.size), irregular
        )

    def on_grid(self, r, beta):
        rows, columns = np.broadcast_arrays(r[:, np.newaxis], beta)
        found = self.at(rows.ravel(), columns.ravel())
        return Values(*(array.reshape(rows.shape) for array in found))


@pytest.mark.parametrize(
    ("seen", "decides"), [(1.0, False), (3.7, False), (3.9, True), (8.0, True), (np.nan, True)]
)
def test_an_irregular_cell_that_could_be_the_peak(seen, decides):
    """The peak is 5.025: three quarters of it count."""
    curve = Performance(Given(seen), np.linspace(0.5, 1.5, 101), Extreme(9.0, 1.0))
    (peaks,) = curve.whole(np.array([0.5]))
    table = curve.unknown if decides else curve.harmless
    assert np.isinf(peaks.largest) == decides
    assert [cells.number for cells in table.values()] == [1]
    assert table[0.5].r == pytest.approx(0.8)
    assert not (curve.harmless if decides else curve.unknown)
    if not decides:
        assert peaks.largest == pytest.approx(5.0252, rel=1e-4)


def test_cells_in_words():
    """In ratios, and in units where they are known."""
    one, two = Unclear(1, 0.8, 3.9, 5.0), Unclear(2, 0.8, np.nan, 5.0)
    ratios = Amounts({}, "amplitude of mass 1")
    assert describe_cells(ratios, 0.5, one) == (
        "1 cell of the band has no periodic steady state at beta = 0.5 (r = 0.8: largest response seen "
        "3.9 P/k1)"
    )
    assert (
        describe_cells(ratios, 0.5, two)
        == "2 cells of the band have no periodic steady state at beta = 0.5 (r = 0.8)"
    )
    units = Amounts({"force": 40.0, "frequency": 5.0, "length": 1e-3}, "amplitude of mass 1")
    assert describe_cells(units, 0.5, one) == (
        "1 cell of the band has no periodic steady state at 20 N (4 Hz: largest response seen 3.9 mm)"
    )
