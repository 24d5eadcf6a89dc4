"""Borders between numbers of stops in files: written by `boundaries --borders`, read back, drawn."""

import numpy as np
import pytest
import xarray as xr

import frictionmap as fm
from frictionmap.command_line.cli import main
from frictionmap.files.reading import read
from frictionmap.files.summary import describe_file
from frictionmap.plot import pictured

CONFIG = """\
title = "Borders"
[system]
contact = "joined-base-wall"
excitation = "base"
[units]
natural_frequency = "2 Hz"
base_amplitude = "1 mm"
stiffness = "2 N/mm"
[grid]
r = { start = 0.0, stop = 0.4, step = 0.01 }
beta = { start = 0.0, stop = 0.02, step = 0.005 }
mu = [1.0, 1.5]
"""
NAMES = ("border_r", "border_beta", "border_kind", "border_mu", "stops_below", "stops_above")


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    folder = tmp_path_factory.mktemp("borders")
    (folder / "b.toml").write_text(CONFIG.replace("start = 0.0, stop = 0.4", "start = 0.22, stop = 0.23"))
    assert (
        main(["boundaries", str(folder / "b.toml"), "--borders", "-o", str(folder / "b.nc"), "--quiet"]) == 0
    )
    return folder / "b.nc"


def test_a_file_holds_borders_and_boundaries(path):
    ds = read(path)
    assert {*NAMES, "border_r_Hz", "border_beta_N", "beta_lim"} <= set(ds.data_vars)
    with xr.open_dataset(path) as plain:
        np.testing.assert_array_equal(plain.border_kind.values, ds.border_kind.values)
        assert dict(plain.border_beta.sizes) == dict(ds.border_beta.sizes)
    np.testing.assert_allclose(ds.border_r_Hz, 2.0 * ds.border_r, rtol=1e-15)
    np.testing.assert_allclose(ds.border_beta_N, 2.0 * ds.border_beta, rtol=1e-15)
    unique = ds.border_kind.values[ds.border_mu.values == 1.0]
    assert set(unique) <= {"graze", "slip-in-stop", "turn/stop"}
    assert "border_r" in describe_file(ds)


def test_borders_lie_between_the_boundaries(path):
    ds = read(path)
    ds = ds.isel(border=ds.border_mu.values == 1.0)
    x, y = ds.border_r.values.ravel(), ds.border_beta.values.ravel()
    x, y = x[~np.isnan(x)], y[~np.isnan(y)]
    curves = fm.boundaries(fm.System(contact="joined-base-wall"), np.unique(x))
    place = np.searchsorted(curves.r.values, x)
    assert (y >= curves.beta_lim.values[0, place] * (1.0 - 1e-9)).all()
    assert (y <= curves.beta_stick.values[0, place] * (1.0 + 1e-9)).all()


def test_borders_are_drawn_with_their_mu(path):
    ds = read(path)
    kept = [name for name in ds.data_vars if name in pictured(None)["boundaries"]]  # as the command reads
    axes = fm.plot_boundaries(ds[kept])
    lines = [[line for line in ax.lines if line.get_linewidth() == 0.8] for ax in axes]
    for mu, drawn in zip((1.0, 1.5), lines, strict=True):
        assert len(drawn) == (ds.border_mu == mu).sum() > 0
    assert {line.get_label() for line in lines[0]} == {"borders between numbers of stops"}
    assert {line.get_label() for line in lines[1]} == {
        "ends of periodic motions (not of the basins of a start)"
    }


def test_a_file_states_the_meaning_of_borders_for_larger_mu(path):
    ds = read(path)
    assert "basin" in ds.border_mu.attrs["comment"]
    several = ds.border_mu.values > 1.0
    assert np.isnan(ds.stops_below.values[several]).any()
    assert not np.isnan(ds.stops_below.values[~several]).any()


def test_what_borders_need(path, capsys):
    config = str(path.with_suffix(".toml"))
    for more, words in (
        (["--set", "grid.r=[0.01, 0.02]"], "grid.r must have two values >= 0.0625"),
        (["--set", "system.contact_stiffness=2.0", "--set", "grid.mu=[1.0]"], "cannot find borders"),
    ):
        assert main(["boundaries", config, "--borders", "-o", str(path.parent / "x.nc"), *more]) == 2
        assert words in capsys.readouterr().err
        assert not (path.parent / "x.nc").exists()


@pytest.mark.parametrize("command", ["map", "boundaries"])
def test_borders_may_be_an_output(command, path, tmp_path):
    """Asked for by name in [solver], they are those of --borders, in a map as well, and are drawn."""
    text = path.with_suffix(".toml").read_text()
    asked = tmp_path / "asked.toml"
    asked.write_text(text + '[solver]\noutputs = ["regime", "border_r"]\n')
    assert main([command, str(asked), "-o", str(tmp_path / "a.nc"), "--quiet"]) == 0
    ds, known = read(tmp_path / "a.nc"), read(path)
    for name in NAMES:
        np.testing.assert_array_equal(ds[name].values, known[name].values)
    draw = fm.plot_regimes if command == "map" else fm.plot_boundaries
    drawn = [line for line in draw(ds)[0].lines if line.get_label() == "borders between numbers of stops"]
    assert len(drawn) == (ds.border_mu == 1.0).sum() > 0
    assert not [line for line in draw(ds)[1].lines if line.get_label() == "borders between numbers of stops"]


def test_a_store_has_no_borders(path, tmp_path, capsys):
    asked = tmp_path / "asked.toml"
    asked.write_text(path.with_suffix(".toml").read_text() + '[solver]\noutputs = ["regime", "border_r"]\n')
    assert main(["map", str(asked), "-o", str(tmp_path / "a.zarr"), "--quiet"]) == 2
    assert "cannot write borders between numbers of stops into" in capsys.readouterr().err


def test_a_study_has_no_borders(path, tmp_path, capsys):
    """They would be those of one of its systems."""
    asked = tmp_path / "asked.toml"
    text = path.with_suffix(".toml").read_text() + '[solver]\noutputs = ["regime", "border_r"]\n'
    asked.write_text(text + "[axes]\ndamping_ratios = [0.0, 0.1]\n")
    assert main(["map", str(asked), "-o", str(tmp_path / "a.nc"), "--quiet"]) == 2
    assert "cannot find borders between numbers of stops with [axes]" in capsys.readouterr().err
    assert not (tmp_path / "a.nc").exists()
