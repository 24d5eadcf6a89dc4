"""Files of estimates: what `info` says of them, slices, and one line for everything that makes no sense."""

import csv
import re

import numpy as np
import pytest
import xarray as xr
from decays import Truth, synthetic
from fuzz import malformed
from fuzz.reading import refused
from sweeps import swept

import frictionmap as fm
from frictionmap import InputError
from frictionmap.command_line.cli import main
from frictionmap.files.reading import read, standard_form
from frictionmap.files.storage import write
from frictionmap.files.summary import describe_file

TRUTH = Truth(3.1, 0.01, 0.2, 10.0, -0.02, 0.3, 200.0, 4.0, 0.02)


@pytest.fixture(scope="module")
def datasets():
    """A dataset of estimates of each kind of data."""
    return {
        "free-decay": fm.identify.free_decay(*synthetic(TRUTH, 1), base=1.75, stiffness=1191.0),
        "sweep": fm.identify.sweep(*swept(), sigma_amplitude=0.02),
    }


@pytest.fixture(scope="module")
def files(datasets, tmp_path_factory):
    folder = tmp_path_factory.mktemp("files")
    for kind, ds in datasets.items():
        write(ds, folder / f"{kind}.nc")
    return {kind: folder / f"{kind}.nc" for kind in datasets}


KINDS = ("free-decay", "sweep")


# What is said of them


@pytest.mark.parametrize("kind", KINDS)
def test_one_screen_of_plain_text(datasets, kind):
    text = describe_file(datasets[kind])
    assert text.isascii()
    assert len(text.splitlines()) <= 40
    assert all(len(line) <= 100 for line in text.splitlines())
    for name in datasets[kind].parameter.values:
        rows = [line.split() for line in text.splitlines() if line.split()[:1] == [name]]
        row = next(row for row in rows if row[1] != "=")  # that is the result, before the table
        assert float(row[1]) == pytest.approx(float(datasets[kind].estimate.sel(parameter=name)), rel=1e-5)


def test_source_of_data(tmp_path, capsys):
    rows = [f"{t:.6g};{x:.6g}" for t, x in zip(*synthetic(TRUTH, 1), strict=True)]
    (tmp_path / "decay.csv").write_text("\n".join(["time_s;x_mm", *rows]))
    (tmp_path / "rig.toml").write_text('title = "Frame"\n[data]\nkind = "free-decay"\nfile = "decay.csv"\n')
    out = tmp_path / "out.nc"
    assert main(["identify", str(tmp_path / "rig.toml"), "-o", str(out)]) == 0
    table = capsys.readouterr().out.splitlines()[1:]
    assert main(["info", str(out)]) == 0
    text = capsys.readouterr().out
    assert text.startswith("Frame [estimates]\n")
    together = " ".join(text.split())
    assert "decay.csv (CSV, semicolon between columns, decimal point), 800 samples fitted" in together
    assert text.splitlines()[-len(table) :] == table


def test_what_a_terminal_would_take_for_a_command_is_not_printed(datasets):
    ds = datasets["sweep"].copy()
    ds["unit"] = ds["unit"].copy(data=["\x1b[2J"] * 6)
    assert "\x1b" not in describe_file(ds.assign_attrs(warnings="a\x1b[2J; b"))


def test_errors_of_samples_are_those_given_or_those_of_the_residuals(datasets):
    assert datasets["sweep"].sigma.values.tolist() == [0.02] * 30
    decay = datasets["free-decay"]
    expected = np.sqrt(np.sum(decay.residual.values**2) / (800 - 6))
    np.testing.assert_allclose(decay.sigma, expected, rtol=1e-12)


def test_other_commands_take_them_or_give_the_reason(files, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    path = str(files["free-decay"])
    assert main(["export", path, "-o", "table.csv", "--quiet"]) == 0
    with (tmp_path / "table.csv").open() as table:
        rows = list(csv.DictReader(table))
    with xr.open_dataset(path) as ds:
        assert [row["parameter"] for row in rows] == ds.parameter.values.tolist()
        assert [float(row["estimate"]) for row in rows] == ds.estimate.values.tolist()
        assert [row["unit"] for row in rows] == ds.unit.values.tolist()
    assert main(["export", path, "-o", "copy.nc", "--quiet"]) == 0
    xr.testing.assert_equal(read(tmp_path / "copy.nc"), read(files["free-decay"]))
    for command in (["plot", path, "--at", "sample=1"], ["plot", path, "--over", "sample"]):
        assert main(command) == 2
        assert re.search(r"unknown (further )?axis of --\w+ 'sample'; valid: none", capsys.readouterr().err)


# Slices


@pytest.mark.parametrize("kind", KINDS)
def test_what_is_fitted_is_in_standard_form(datasets, files, kind):
    xr.testing.assert_identical(standard_form(datasets[kind]), datasets[kind])
    xr.testing.assert_identical(read(files[kind]).drop_attrs(), datasets[kind].drop_attrs())


def test_slices_come_in_standard_form(datasets, tmp_path):
    ds = datasets["free-decay"]
    part = standard_form(ds.sel(parameter="x_F"))
    assert part.parameter.values.tolist() == ["x_F"]
    for name in ("estimate", "standard_error", "lower", "upper", "unit", "at_bound"):
        assert part[name].values.tolist() == ds[name].sel(parameter=["x_F"]).values.tolist()
    ds.isel(sample=slice(None, None, 4)).transpose("parameter2", ...).to_netcdf(tmp_path / "part.nc")
    again = read(tmp_path / "part.nc")
    assert again.sizes["sample"] == 200
    assert again.correlation.dims == ("parameter", "parameter2")


# What makes no sense


REFUSED = [
    (lambda ds: ds.drop_vars("lower"), "cannot use the estimates: variable 'lower' is missing"),
    (lambda ds: ds.drop_vars("parameter"), "cannot use the estimates: variable 'parameter' is missing"),
    (lambda ds: ds.isel(parameter=[0, 0, 1]), "must be a list of different names; got f_n, f_n, zeta"),
    (lambda ds: ds.isel(parameter=[]), "parameter must be a list of different names; got none"),
    (lambda ds: ds.assign(estimate=ds.estimate * np.nan), r"estimate must be finite; got nan at \[0\]"),
    (lambda ds: ds.assign(standard_error=-ds.standard_error), "standard_error must be finite, >= 0 or NaN"),
    (lambda ds: ds.assign(upper=ds.upper * np.nan), r"upper must be a number; got nan at \[0\]"),
    (lambda ds: ds.assign(at_bound=ds.at_bound + 2), r"at_bound must be whole, >= 0, <= 1; got 2 at \[0\]"),
    (lambda ds: ds.assign(unit=ds.estimate), "unit must be text; got "),
    (lambda ds: ds.assign(estimate=ds.unit), "estimate must be numbers; got type"),
    (lambda ds: ds.assign(data=ds.data.where(ds.data > 0.0)), r"data must be finite; got nan at"),
    (lambda ds: ds.assign(model=ds.estimate), r"model must have the dim.* \(sample\).*; got \(parameter\)"),
    (lambda ds: ds.assign_attrs(warnings=3), "the attribute warnings must be text; got 3"),
    (lambda ds: ds.assign(verdict=-1), "verdict must be whole, >= 0; got -1"),
]  # fmt: skip


@pytest.mark.parametrize(("change", "message"), REFUSED)
def test_what_makes_no_sense_is_refused_in_one_line(datasets, change, message):
    with pytest.raises(InputError, match=message) as caught:
        standard_form(change(datasets["free-decay"]))
    assert "\n" not in str(caught.value)


def test_the_file_is_named(datasets, tmp_path, capsys):
    ds = datasets["free-decay"]
    write(ds.assign(standard_error=-ds.standard_error), tmp_path / "wrong.nc")
    assert main(["info", str(tmp_path / "wrong.nc")]) == 2
    assert re.match(r"frictionmap: file .*wrong\.nc: standard_error must be finite", capsys.readouterr().err)


@pytest.mark.parametrize("family", [malformed.STRUCTURE, malformed.VALUES])
@pytest.mark.parametrize("kind", KINDS)
def test_malformed_files_are_read_or_refused(files, kind, family):
    """Other names, dimensions, types, attributes or values: well, or one line that names the file."""
    assert 1 < refused(files[kind], family, 15) < 15
