"""Files with further axes and stores: summarised, drawn, cut, counted."""

import csv
import shutil

import numpy as np
import pytest
import xarray as xr

import frictionmap as fm
from frictionmap import InputError
from frictionmap.command_line.cli import main
from frictionmap.files.export import csv_of
from frictionmap.files.reading import opened, read
from frictionmap.files.slices import parse_choices
from frictionmap.files.storage import write
from frictionmap.files.stored import stored_system
from frictionmap.pictures.classes import count
from frictionmap.pictures.maps.regime_map import cells_of
from frictionmap.pictures.palette import NOT_YET
from frictionmap.plot import save_picture
from frictionmap.probabilities import read_shares

zarr = pytest.importorskip("zarr")

CONFIG = """
title = "Study"
[system]
mass_ratios = [1.0, 1.0]
stiffness_ratios = [1.0, 1.0]
[grid]
r = [0.3, 0.9, 1.4]
beta = [0.1, 0.5, 1.0]
[axes]
damping_ratios = [0.0, 0.05]
sample = { "mass_ratios[2]" = [1.0, 1.5, 0.5], "stiffness_ratios[2]" = [1.0, 2.0, 0.5] }
"""


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """A study as a file and, where zarr is, as a store."""
    folder = tmp_path_factory.mktemp("studies")
    (folder / "study.toml").write_text(CONFIG)
    ends = [".nc", ".zarr"]
    for end in ends:
        assert main(["map", str(folder / "study.toml"), "-o", str(folder / f"study{end}"), "--quiet"]) == 0
    return {end: folder / f"study{end}" for end in ends}


@pytest.mark.parametrize("end", [".nc", ".zarr"])
def test_a_point_is_the_map_of_its_system(files, end):
    ds = read(files[end], at={"damping_ratios": 0.05, "mass_ratios_2": 1.5})
    system = fm.System(mass_ratios=[1, 1.5], stiffness_ratios=[1, 2], damping_ratios=0.05)
    one = fm.sweep(system, r=[0.3, 0.9, 1.4], beta=[0.1, 0.5, 1.0])
    for name in one.data_vars:
        np.testing.assert_array_equal(ds[name].values, one[name].values)
    assert ds.attrs["system"] == system.describe()
    assert ds.attrs["title"] == "Study, damping_ratios = 0.05, sample = 1"  # the numbers are in `system`
    assert stored_system(ds) == system


@pytest.mark.parametrize("end", [".nc", ".zarr"])
@pytest.mark.parametrize(
    ("at", "words"),
    [
        ({}, "cannot choose a point along damping_ratios: the file has damping_ratios = 0, 0.05; give --at"),
        (
            {"damping_ratios": 0.0},
            "cannot choose a point along sample: the file has sample = 0, 1, 2; give --at sample=VALUE, or",
        ),
        ({"damping_ratios": 0.02}, "--at damping_ratios must be one of damping_ratios = 0, 0.05; got 0.02"),
        (
            {"damping_ratio": 0.0},
            r"unknown axis of --at 'damping_ratio' \(did",
        ),
        ({"sample": 1, "mass_ratios_2": 1.0, "damping_ratios": 0}, "cannot choose a point along sample"),
    ],
)
def test_choices_that_are_refused(files, end, at, words):
    with pytest.raises(InputError, match=words):
        read(files[end], at=at)


@pytest.mark.parametrize("name", ["sample", "mass_ratios_2"])
def test_a_choice_on_the_axis_that_shares_are_over(files, name):
    with pytest.raises(InputError, match="cannot use --at sample with --over sample"):
        read_shares(files[".nc"], "sample", {"damping_ratios": 0.0, name: 1.0})


@pytest.mark.parametrize("text", ["x", "x=", "=1", "x=one", "x=nan", "x=inf"])
def test_choices_that_make_no_sense(text):
    with pytest.raises(InputError, match="--at must be NAME=VALUE"):
        parse_choices([text])


def test_a_choice_twice():
    with pytest.raises(InputError, match="--at x must be given once; got 1 and 2"):
        parse_choices(["x=1", "x=2"])


@pytest.mark.parametrize("end", [".nc", ".zarr"])
def test_info(files, end, capsys):
    assert main(["info", str(files[end]), "--verbose"]) == 0
    told = capsys.readouterr().out
    assert "sample                0, 1, 2" in told
    assert "varied: damping_ratios, mass_ratios, stiffness_ratios" in " ".join(told.split())
    axes = ["mu", "r", "beta", "damping_ratios", "sample", "mass_ratios_2", "stiffness_ratios_2"]
    lines = [line.split() for line in told.split("variables")[0].split("axes\n")[1].splitlines()]
    assert [line[0] for line in lines] == axes
    assert "regime                (..., mu, r, beta) motion regime of the steady state" in told
    assert "54 cells (" in told
    assert ("6 of 6 blocks; all computed" in told) == (end == ".zarr")
    assert main(["info", str(files[end]), "--at", "damping_ratios=0.05", "--at", "sample=2"]) == 0
    assert "modal damping ratios 0.05" in capsys.readouterr().out


def _marks_along_beta(ds):
    return ds.assign(block_done=(("beta",), np.ones(ds.beta.size)))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda ds: ds.isel(beta=[]), "beta must have at least one value; got none"),
        (lambda ds: ds.isel(sample=[]), "sample must have at least one value; got none"),
        (_marks_along_beta, "block_done must have the dimensions (damping_ratios, mu, row_block, sample)"),
    ],
)
def test_malformed_files_are_refused_in_one_line(files, tmp_path, capsys, change, message):
    path = tmp_path / "malformed.nc"
    with xr.open_dataset(files[".nc"]) as ds:
        change(ds).to_netcdf(path)
    assert main(["info", str(path)]) == 2
    told = capsys.readouterr().err
    assert told.startswith(f"frictionmap: file {path}: {message}")
    assert told.count("\n") == 1


def test_info_lists_further_coordinates_of_numbers_or_text(files, tmp_path, capsys):
    path = tmp_path / "named.nc"
    with xr.open_dataset(files[".nc"]) as ds:
        beside = {"who": ("sample", ["a", "b", "c"]), "good": ("sample", [True, False, True])}
        ds.assign_coords(beside).to_netcdf(path)
    assert main(["info", str(path)]) == 0
    told = capsys.readouterr().out
    assert "a, b, c" in told
    assert "good" not in told


@pytest.mark.parametrize("end", [".nc", ".zarr"])
def test_plot(files, end, tmp_path):
    where = ["--at", "damping_ratios=0", "--at", "sample=1"]
    assert main(["plot", str(files[end]), *where, "-o", str(tmp_path / "one.png"), "--quiet"]) == 0
    over = ["--at", "damping_ratios=0", "--over", "sample"]
    assert main(["plot", str(files[end]), *over, "-o", str(tmp_path / "all.png"), "--quiet"]) == 0
    assert main(["plot", str(files[end]), "--over", "mass", "-o", str(tmp_path / "no.png")]) == 2


@pytest.mark.parametrize("end", [".nc", ".zarr"])
@pytest.mark.parametrize("cut", [{"mu": 1.0}, {"r": 0.9}, {"beta": 0.5}, {"mu": 1.0, "r": 0.9, "beta": 0.5}])
def test_shares_of_a_cut(files, tmp_path, end, cut):
    whole = read_shares(files[end], "sample", {"damping_ratios": 0.05})
    part = read_shares(files[end], "sample", {"damping_ratios": 0.05, **cut})
    xr.testing.assert_equal(part, whole.sel({name: [value] for name, value in cut.items()}))
    with xr.open_dataset(files[".nc"]) as ds:
        xr.testing.assert_equal(fm.shares(ds.isel(damping_ratios=1).sel(cut), "sample"), part)
    save_picture(part, tmp_path / "shares.png")


@pytest.mark.parametrize("end", [".nc", ".zarr"])
def test_shares_name_their_system(files, end):
    found = read_shares(files[end], "sample", {"damping_ratios": 0.05})
    assert found.attrs["title"] == "Study, damping_ratios = 0.05"
    assert "modal damping ratios 0.05; varied: mass_ratios, stiffness_ratios" in found.attrs["system"]
    assert stored_system(found) == fm.System(mass_ratios=[1, 1], stiffness_ratios=[1, 1], damping_ratios=0.05)


def test_a_point_of_a_slice(files, tmp_path, capsys):
    """What xarray has left of a file identifies its systems by values, not by places."""
    with xr.open_dataset(files[".nc"]) as ds:
        ds.isel(sample=[1, 2], damping_ratios=1, r=0).to_netcdf(tmp_path / "slice.nc")
    expected = fm.System(mass_ratios=[1, 0.5], stiffness_ratios=[1, 0.5], damping_ratios=0.05)
    assert stored_system(read(tmp_path / "slice.nc", at={"sample": 2})) == expected
    assert main(["info", str(tmp_path / "slice.nc")]) == 0
    assert "6 cells (" in capsys.readouterr().out


def test_info_describes_a_store_larger_than_memory(tmp_path, capsys, monkeypatch):
    from frictionmap import checks

    path = tmp_path / "study.toml"
    path.write_text(CONFIG)
    out = str(tmp_path / "study.zarr")
    monkeypatch.setattr(checks, "MOST_CELLS", 20)
    assert main(["map", str(path), "-o", out, "--quiet"]) == 0
    assert main(["info", out]) == 0
    assert "54 cells (" in capsys.readouterr().out
    at = ["--at", "damping_ratios=0"]
    assert main(["export", out, *at, "--over", "sample", "-o", str(tmp_path / "s.nc"), "--quiet"]) == 0
    assert main(["export", out, *at, "--at", "sample=0", "-o", str(tmp_path / "one.nc"), "--quiet"]) == 0


def test_export(files, tmp_path):
    cut = ["--at", "damping_ratios=0.05", "--at", "sample=1", "--at", "r=0.9"]
    assert main(["export", str(files[".zarr"]), *cut, "-o", str(tmp_path / "cut.csv"), "--quiet"]) == 0
    assert main(["export", str(files[".zarr"]), *cut, "-o", str(tmp_path / "cut.nc"), "--quiet"]) == 0
    with open(tmp_path / "cut.csv", newline="") as opened:
        rows = list(csv.DictReader(opened))
    ds = read(tmp_path / "cut.nc")
    assert [float(row["beta"]) for row in rows] == [0.1, 0.5, 1.0]
    assert [float(row["contact_amplitude"]) for row in rows] == ds[
        "contact_amplitude"
    ].values.ravel().tolist()
    names = dict(
        zip(ds["regime"].attrs["flag_values"], ds["regime"].attrs["flag_meanings"].split(), strict=True)
    )
    assert [row["regime"] for row in rows] == [names[code] for code in ds["regime"].values.ravel()]
    assert main(["export", str(files[".nc"]), *cut, "-o", str(tmp_path / "cut.txt")]) == 2


def test_unfinished_blocks_are_reported_and_drawn_as_such(files, tmp_path, capsys):
    path = tmp_path / "part.zarr"
    shutil.copytree(files[".zarr"], path)
    arrays = zarr.open_group(path, mode="r+")
    for name in ("block_done", "regime", "status", "stops_per_cycle", "contact_amplitude", "beta_lim"):
        arrays[name][1] = arrays[name].fill_value
    ds = read(path, at={"damping_ratios": 0.05, "sample": 0})
    assert count(cells_of(ds.isel(mu=0)).found)[NOT_YET] == 9
    ds = read(path, at={"damping_ratios": 0.0, "sample": 0})
    assert count(cells_of(ds.isel(mu=0)).found)[NOT_YET] == 0
    assert main(["info", str(path)]) == 0
    told = capsys.readouterr().out
    assert "3 of 6 blocks; repeat the command to resume" in told
    assert "27 cells not_computed" in told
    arguments = ["plot", str(path), "--at", "damping_ratios=0.05", "--at", "sample=0"]
    assert main([*arguments, "-o", str(tmp_path / "part.png"), "--quiet"]) == 0


@pytest.mark.parametrize("error", [KeyError("nu"), OSError("no room"), MemoryError(), TypeError("text")])
def test_another_error_while_a_file_is_open_is_not_blamed_on_the_file(files, error):
    def fails_after_reading():
        with opened(files[".zarr"]) as ds:
            assert ds["regime"].values.any()
            raise error

    with pytest.raises(type(error)) as raised:
        fails_after_reading()
    assert raised.value is error


def test_a_damaged_chunk_is_reported_where_it_is_read(files, tmp_path):
    path = tmp_path / "cut.zarr"
    shutil.copytree(files[".zarr"], path)
    for chunk in (path / "regime" / "c").rglob("[0-9]"):
        if chunk.is_file():
            chunk.write_bytes(chunk.read_bytes()[:10])
    with opened(path) as ds:
        assert (ds["stops_per_cycle"].values >= 0).any()
    with pytest.raises(InputError, match=r"cut\.zarr/regime/c/0/0/0/0/0 is damaged; "), opened(path) as ds:
        _ = ds["regime"].values


def test_shares_of_what_is_finished(files, tmp_path, capsys):
    path = tmp_path / "part.zarr"
    shutil.copytree(files[".zarr"], path)
    marks = zarr.open_array(path / "block_done", mode="r+")
    marks[1, 2] = 0
    at = {"damping_ratios": 0.05}
    whole = read(files[".nc"], at={**at, "sample": 0}), read(files[".nc"], at={**at, "sample": 1})
    found = read_shares(path, "sample", at)
    assert found.attrs["samples"] == 2
    for name, code in {"permanent_sticking": 0, "stick_slip": 1, "continuous": 2}.items():
        expected = np.mean([ds["regime"].values == code for ds in whole], axis=0)
        np.testing.assert_array_equal(found["regime_share"].sel(outcome=name), expected)
    with xr.open_zarr(path, consolidated=False, chunks=None) as ds:
        xr.testing.assert_equal(fm.shares(ds.isel(damping_ratios=1), "sample"), found)
    marks[1] = 0
    assert main(["plot", str(path), "--at", "damping_ratios=0.05", "--over", "sample"]) == 2
    assert "cannot compute shares over sample: no point of it is finished" in capsys.readouterr().err


# Shares


@pytest.fixture(scope="module")
def samples():
    """Maps of thirty random systems of two masses, and each of them alone."""
    rng = np.random.default_rng(7)
    changes = {"mass_ratios[2]": rng.uniform(0.8, 1.2, 30), "stiffness_ratios[2]": rng.uniform(0.8, 1.2, 30)}
    system = fm.System(mass_ratios=[1, 1], stiffness_ratios=[1, 1], damping_ratios=0.01)
    grid = {"r": np.linspace(0.2, 1.8, 9), "beta": np.linspace(0.0, 1.3, 7), "mu": [1.0, 1.5]}
    return fm.sweep(system, **grid, axes={"sample": changes})


def test_shares_are_shares(samples):
    found = fm.shares(samples, "sample", quantiles=(0.0, 0.1, 0.5, 1.0))
    share = found["regime_share"]
    np.testing.assert_allclose(share.sum("outcome"), 1.0, rtol=0, atol=1e-15)
    codes = dict(zip(share["outcome"].values, (-1, 0, 1, 2), strict=True))
    for name, code in codes.items():
        expected = (samples["regime"] == code).mean("sample")
        np.testing.assert_allclose(share.sel(outcome=name), expected, rtol=0, atol=1e-15)
    for name in ("beta_lim", "beta_stick", "contact_amplitude"):
        expected = np.quantile(samples[name].values, [0.0, 0.1, 0.5, 1.0], axis=0)
        finite = np.isfinite(expected)
        values = found[f"{name}_quantile"].values
        np.testing.assert_allclose(values[finite], expected[finite], rtol=1e-14)


def test_quantiles_of_what_is_missing_or_infinite(samples):
    some = samples.isel(r=[0], beta=[0], mu=[0], sample=slice(0, 4)).copy(deep=True)
    some["contact_amplitude"].values[:, 0, 0, 0] = [np.nan, 1.0, np.inf, 3.0]
    found = fm.shares(some, "sample", quantiles=(0.0, 0.25, 0.5, 0.75, 1.0))
    assert found["contact_amplitude_quantile"].values.ravel().tolist() == [1.0, 2.0, 3.0, np.inf, np.inf]
    some["contact_amplitude"].values[:] = np.nan
    assert np.isnan(fm.shares(some, "sample")["contact_amplitude_quantile"].values).all()


CONTACTS = """
title = "Two contacts"
[system]
mass_ratios = [1.0, 1.0]
stiffness_ratios = [1.0, 1.0]
damping_ratios = 0.05
load_mass = 2
[[system.contacts]]
kind = "fixed-wall"
masses = [1]
ratio = 0.5
[[system.contacts]]
name = "joint"
kind = "between-masses"
masses = [1, 2]
[grid]
r = [0.4, 0.9, 1.4]
beta = [0.1, 0.5, 0.9, 1.3]
[axes]
"stiffness_ratios[2]" = [0.8, 1.0, 1.3]
"""


def test_shares_of_contacts(tmp_path):
    """Those of all contacts together, or of the one that is chosen: its regimes, beta_stick and amplitude."""
    (tmp_path / "c.toml").write_text(CONTACTS)
    path, over = str(tmp_path / "c.nc"), "stiffness_ratios_2"
    assert main(["map", str(tmp_path / "c.toml"), "-o", path, "--quiet"]) == 0
    whole = xr.load_dataset(path)
    assert (whole.contact_regime != whole.regime).any([over, "mu", "r", "beta"]).all()
    for number in (None, 1, 2):
        at = ["--at", f"contact={number}"] if number else []
        out = str(tmp_path / f"shares-{number}.nc")
        assert main(["export", path, "--over", over, *at, "-o", out, "--quiet"]) == 0
        found = read(tmp_path / out)
        one = whole.sel(contact=number) if number else whole
        regime = one.contact_regime if number else one.regime
        for name, code in {"permanent_sticking": 0, "stick_slip": 1, "continuous": 2}.items():
            np.testing.assert_array_equal(
                found.regime_share.sel(outcome=name), (regime == code).mean(over), name
            )
        stick = one.beta_stick_contact if number else one.beta_stick
        np.testing.assert_allclose(
            found.beta_stick_quantile.sel(quantile=0.5), stick.median(over), rtol=1e-14
        )
        assert ("contact_amplitude_quantile" in found) == (number is not None)
        picture = fm.plot_shares(found)[0].figure.get_suptitle()
        assert picture == {None: "Two contacts", 1: "Two contacts, contact 1 (fixed-wall 1)"}.get(
            number, "Two contacts, contact 2 (joint)"
        )
        drawn = str(tmp_path / f"shares-{number}.png")
        assert main(["plot", path, "--over", over, *at, "-o", drawn, "--quiet"]) == 0


def test_shares_of_a_belt(tmp_path):
    """Sliding one way is a regime of its own: the shares add up to 1, and tables have its name."""
    system = fm.System(damping_ratios=0.02, wall_velocity=0.6)
    ds = fm.sweep(system, [0.5, 3.0], [0.2, 0.6], axes={"damping_ratios": [0.02, 0.3]})
    assert (ds.regime == fm.regimes.ONE_WAY_SLIDING).any()
    share = fm.shares(ds, "damping_ratios").regime_share
    np.testing.assert_array_equal(share.sum("outcome"), 1.0)
    expected = (ds.regime == fm.regimes.ONE_WAY_SLIDING).mean("damping_ratios")
    np.testing.assert_array_equal(share.sel(outcome="one_way_sliding"), expected)
    titles = [ax.get_title() for ax in fm.plot_shares(fm.shares(ds, "damping_ratios"))]
    assert any("one way sliding" in title for title in titles)
    assert "one_way_sliding" in csv_of(ds.isel(damping_ratios=0))


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda ds: (ds.drop_vars("regime"), "sample"), "ds has no variable regime"),
        (
            lambda ds: (ds.expand_dims(damping_ratios=[0.0, 0.1]), "sample"),
            "has the further axis damping_ratios",
        ),
    ],
)
def test_shares_that_are_refused(samples, change, words):
    with pytest.raises(InputError, match=words):
        fm.shares(*change(samples))


def test_a_picture_of_shares(samples, tmp_path):
    found = fm.shares(samples, "sample")
    axes = fm.plot_shares(found)
    there = [name for name in found["outcome"].values if (found["regime_share"].sel(outcome=name) > 0).any()]
    assert len(axes) == 2 * len(there)
    shown = axes[0].collections[0].get_array().reshape(7, 9)
    np.testing.assert_array_equal(shown, found["regime_share"].sel(outcome="continuous")[0].values.T)
    with pytest.raises(InputError, match="ds of plot_shares must be a dataset such as shares returns"):
        fm.plot_shares(samples)


def test_shares_as_a_file(samples, tmp_path, capsys):
    write(samples, tmp_path / "samples.nc")
    out = tmp_path / "shares.nc"
    over = ["export", str(tmp_path / "samples.nc"), "--over", "sample", "--quiet"]
    assert main([*over, "-o", str(out)]) == 0
    found = fm.shares(samples, "sample")
    xr.testing.assert_equal(read(out), found)
    assert main(["info", str(out)]) == 0
    told = capsys.readouterr().out
    assert "[shares]" in told
    means = found["regime_share"].mean(("mu", "r", "beta"))
    assert f"30 samples; over all cells {100 * float(means[0]):.3g} % unresolved" in told
    assert main(["plot", str(out), "-o", str(tmp_path / "shares.png"), "--quiet"]) == 0
    xr.open_dataset(out).isel(mu=1).sel(outcome=["continuous"]).to_netcdf(tmp_path / "slice.nc")
    assert main(["plot", str(tmp_path / "slice.nc"), "-o", str(tmp_path / "slice.png"), "--quiet"]) == 0
    with pytest.raises(InputError, match="use plot_shares"):
        fm.plot_regimes(found)
    assert main([*over, "-o", str(tmp_path / "shares.csv")]) == 0
    with open(tmp_path / "shares.csv", newline="") as opened:
        rows = list(csv.DictReader(opened))
    assert len(rows) == 2 * 9 * 7
    for name, column in (
        ("regime_share", {"outcome": "stick_slip"}),
        ("contact_amplitude_quantile", {"quantile": 0.95}),
        ("beta_lim_quantile", {"quantile": 0.5}),
    ):
        expected = found[name].sel(column).broadcast_like(found["regime_share"][0].drop_vars("outcome"))
        (value,) = column.values()
        told = [float(row[f"{name}_{value}"]) for row in rows]
        assert told == expected.transpose("mu", "r", "beta").values.ravel().tolist()


def test_info_gives_the_range_of_further_coordinates(samples, tmp_path, capsys):
    write(samples, tmp_path / "samples.nc")
    assert main(["info", str(tmp_path / "samples.nc")]) == 0
    values = samples["mass_ratios_2"].values
    assert (
        f"  mass_ratios_2         {values.min():g} to {values.max():g}, 30 values" in capsys.readouterr().out
    )


def test_a_study_survives_the_file(samples, tmp_path):
    write(samples, tmp_path / "s.nc")
    with xr.open_dataset(tmp_path / "s.nc") as opened:
        xr.testing.assert_identical(fm.shares(opened, "sample"), fm.shares(samples, "sample"))


def test_a_matrices_file_of_that_name_is_not_taken_for_the_one_of_a_study(tmp_path, monkeypatch):
    """The system of a point is left out where the file does not hold it."""
    monkeypatch.chdir(tmp_path)
    np.savez("frame.npz", M=np.eye(2), K=[[2.0, -1.0], [-1.0, 1.0]])
    text = CONFIG.replace("mass_ratios = [1.0, 1.0]\nstiffness_ratios = [1.0, 1.0]", 'matrices = "frame.npz"')
    (tmp_path / "frame.toml").write_text(text[: text.index("sample =")])
    assert main(["map", "frame.toml", "--quiet"]) == 0
    np.savez("frame.npz", M=np.eye(2), K=[[9.0, -1.0], [-1.0, 1.0]])
    assert read(tmp_path / "frame.nc", at={"damping_ratios": 0.05}).attrs["system"] == ""


@pytest.mark.parametrize("command", ["boundaries", "curves"])
def test_stores_are_of_maps(tmp_path, capsys, command):
    (tmp_path / "study.toml").write_text(CONFIG[: CONFIG.index("[axes]")])
    assert main([command, str(tmp_path / "study.toml"), "-o", str(tmp_path / "out.zarr")]) == 2
    assert "only `map` and `spectrum` can write a .zarr store" in capsys.readouterr().err
    assert not (tmp_path / "out.zarr").exists()
