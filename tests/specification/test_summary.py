"""What `map` and `info` say: numbers, causes, and nothing that a terminal cannot show."""

import numpy as np
import pytest
import xarray as xr

import frictionmap as fm
from frictionmap import regimes
from frictionmap.command_line.cli import main
from frictionmap.files.summary import describe_causes, describe_file, describe_map, describe_response
from frictionmap.model.settings import OUTPUTS
from frictionmap.units.table import wrapped

TWO = fm.System(mass_ratios=[1.0, 0.5], stiffness_ratios=[1.0, 2.0], damping_ratios=0.02)
WIDTH, HEIGHT = 100, 42


@pytest.fixture(scope="module")
def datasets():
    """One of each kind; the map has cells that are marginal (r = 1/2) and quasi-static (r = 0)."""
    return {
        "map": fm.sweep(fm.System(), [0.0, 0.5, 1.5], [0.2, 0.8], [1.0, 1.5], outputs=OUTPUTS),
        "boundaries": fm.boundaries(TWO, np.linspace(0.0, 3.0, 31), [1.0, 1.5]),
        "response": fm.response(TWO, 0.3, 0.1, 1.5),
    }


@pytest.mark.parametrize("verbose", [False, True])
@pytest.mark.parametrize("kind", ["map", "boundaries", "response"])
def test_one_screen_of_plain_text(datasets, kind, verbose):
    text = describe_file(datasets[kind], verbose)
    assert text.isascii()
    assert len(text.splitlines()) <= HEIGHT
    assert all(len(line) <= WIDTH for line in text.splitlines())


def test_boundaries_print_their_features(datasets):
    ds = datasets["boundaries"]
    lines = {line.split()[0]: line for line in describe_file(ds).splitlines() if line.startswith("  ")}
    for name in ("natural_frequency", "peak_threshold", "held_frequency", "beta_lim_high", "beta_stick_high"):
        assert lines[name].split()[1:] == [
            f"{value:.6g}" + "," * (k < ds[name].size - 1) for k, value in enumerate(ds[name].values)
        ]
    assert f"{float(ds.invariant_point[0]):.6g}" in lines["invariant_point"]


def test_mass_invariant_points_are_printed_mass_by_mass():
    ds = fm.boundaries(fm.System(mass_ratios=[1, 0.5], stiffness_ratios=[1, 2]), np.linspace(0.5, 3.0, 9))
    text = " ".join(describe_file(ds).split())
    for mass in (1, 2):
        points = ds.mass_invariant_point.sel(dof=mass).values
        shown = ", ".join(f"{point:.6g}" for point in points[~np.isnan(points)])
        assert f"dof {mass}: {shown or 'none'}" in text


def test_a_response_prints_its_numbers(datasets):
    ds = datasets["response"]
    text = describe_file(ds, verbose=True)
    for name in ("stops_per_cycle", "contact_amplitude", "stuck_fraction", "beta_lim", "beta_stick"):
        assert f"{float(ds[name]):.6g}" in text
    reach = np.abs(ds.x).max("tau").values
    assert f"mass by mass  {reach[0]:.6g} P/k1, {reach[1]:.6g} P/k1" in text
    begins = ds.event_tau.values[ds.event_direction.values == 0] / np.pi
    assert ", ".join(f"{value:.6g}" for value in begins) in text


def test_a_stuck_response_in_words():
    ds = fm.response(fm.System(), 0.5, 2.0)
    assert describe_response(ds) == "permanent sticking"
    assert "permanent sticking" in describe_file(ds)


def slices(ds):
    """Sensible slices, by name."""
    found = {
        "transposed": ds.transpose(),
        "reversed": ds.isel({name: slice(None, None, -1) for name in ds.dims}),
    }
    for name in ds.dims:
        found[f"one {name}"] = ds.isel({name: 0})
    for name in ds.data_vars:
        found[f"only {name}"] = ds[[name]]
    return found


@pytest.mark.parametrize("kind", ["map", "boundaries", "response"])
def test_slices_are_described(datasets, kind, tmp_path, capsys):
    """Whatever is cut out of a dataset and saved by xarray can be looked into."""
    for name, part in slices(datasets[kind]).items():
        part.to_netcdf(tmp_path / "slice.nc")
        assert main(["info", str(tmp_path / "slice.nc")]) == 0, name
        shown = capsys.readouterr().out
        assert shown == describe_file(xr.load_dataset(tmp_path / "slice.nc")) + "\n", name
        for variable in part.data_vars:
            assert str(variable) in shown, name


def test_the_counts_of_a_slice_are_its_own(datasets):
    whole = datasets["map"]
    for m in range(2):
        text = describe_file(whole.isel(mu=m))
        slides = int((whole.regime[m] == regimes.CONTINUOUS).sum())
        assert 0 < slides < int((whole.regime == regimes.CONTINUOUS).sum())
        assert "\n6 cells (" in text
        assert f" {slides} continuous)" in text


def test_causes_are_summed_up_with_advice(datasets):
    ds = datasets["map"]
    codes = {code.value: code for code in regimes.STATUSES}
    expected = [
        f"{count} cell{'s' if count > 1 else ''} {codes[value].name}: {codes[value].advice}"
        for value, count in zip(*np.unique(ds.status.values, return_counts=True), strict=True)
        if value != regimes.RESOLVED
    ]
    assert describe_causes(ds) == expected
    assert {line.split()[2][:-1] for line in expected} == {"marginal", "quasi_static"}
    text = describe_file(ds)
    assert all(f"\n  {line}" in text for line in expected)


def test_every_cause_has_advice():
    assert all(code.advice for code in regimes.STATUSES if code.value != regimes.RESOLVED)


def test_causes_end_the_output_of_map(tmp_path, capsys, monkeypatch):
    """They are not among the outputs asked for; the regimes do not distinguish them."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "c.toml").write_text(
        '[system]\ncontact = "fixed-wall"\n[grid]\nr = [0.0, 0.5, 1.5]\nbeta = [0.2, 0.8]\nmu = [1.0, 1.5]\n'
        '[solver]\noutputs = ["regime"]\n'
    )
    assert main(["map", "c.toml"]) == 0
    first, *causes = capsys.readouterr().out.splitlines()
    assert first.endswith("wrote c.nc")
    assert [line.split()[2] for line in causes] == ["marginal:", "quasi_static:"]
    assert main(["info", "c.nc"]) == 0
    assert capsys.readouterr().out.splitlines()[-2:] == causes


def test_a_map_without_causes_does_not_mention_them():
    ds = fm.sweep(fm.System(), [0.8, 1.5], [0.2, 2.0])
    assert describe_causes(ds) == []
    assert "status" not in ds
    assert describe_map(ds) == "4 cells (2 permanent sticking, 2 continuous)"


def test_texts_of_a_file_cannot_move_the_cursor(datasets):
    ds = datasets["map"].assign_attrs(title="two\nlines \x1b[2J", system="x" * 5000)
    text = describe_file(ds)
    assert text.splitlines()[0] == "two lines ?[2J [map]"
    assert len(text.splitlines()) <= HEIGHT
    assert all(len(line) <= WIDTH for line in text.splitlines())


@pytest.mark.parametrize("width", range(24, 60))
def test_no_line_ends_between_a_number_and_its_unit(width):
    """Nor beside an equals sign; words that only begin like a unit are words."""
    text = (
        "r = 1 is 17.7941 Hz, beta = 1 is 100 N, a displacement of 1 is 80 um; damper 3 N s/m, 0.5 m/s2, "
        "beam 21 N m^2, 20 % of 5 modes and 12 masses"
    )
    lines = wrapped(text, width)
    assert " ".join(lines) == text
    assert max(map(len, lines)) <= width
    parts = ("17.7941 Hz", "100 N", "80 um", "3 N s/m", "0.5 m/s2", "21 N m^2", "20 %", "r = 1", "beta = 1")
    assert all(any(part in line for line in lines) for part in parts)
    narrow = wrapped("5 modes, 12 masses", 8)
    assert narrow == ["5 modes,", "12", "masses"]


def stops_line(ds):
    (line,) = [line for line in describe_file(ds).splitlines() if line.startswith("cells by stops")]
    return line.removeprefix("cells by stops per cycle  ")


def test_cells_by_stops_are_all_counted(datasets):
    ds = datasets["map"].isel(r=[2] * 40, beta=[0]).assign_coords(r=np.linspace(0.5, 2.5, 40))
    ds["stops_per_cycle"] = ds["stops_per_cycle"].copy(data=np.full(ds["stops_per_cycle"].shape, np.nan))
    stops = ds["stops_per_cycle"].values.reshape(-1)
    stops[:5] = [0.0, 2.0, 0.8, 2.0, 1.25]
    assert stops_line(ds) == "2: 2, non-integer, 0.8 to 1.25: 2"
    stops[10:24] = 2.0 * np.arange(1, 15)
    told = ", ".join(f"{2 * k}: {1 + 2 * (k == 1)}" for k in range(1, 13))
    assert stops_line(ds) == f"{told}, more, to 28: 2, non-integer, 0.8 to 1.25: 2"
    stops[:] = 1.5
    assert stops_line(ds) == "non-integer, 1.5 to 1.5: 80"
