"""The command `identify`: files of measured data, configurations of rigs, tables of estimates, refusals."""

import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from decays import Truth, synthetic
from refusals import refusal
from scipy.io import savemat

import frictionmap as fm
from frictionmap.command_line.cli import main

TRUTH = Truth(3.1, 0.01, 0.2, 10.0, -0.02, 0.3, 200.0, 4.0, 0.02)


@pytest.fixture
def rig(tmp_path, monkeypatch):
    """Writes a data file and its configuration; the path of the latter."""
    monkeypatch.chdir(tmp_path)

    def write(text, more="", name="decay.csv"):
        if isinstance(text, str):
            (tmp_path / name).write_text(text)
        path = tmp_path / "rig.toml"
        path.write_text(f'[data]\nkind = "free-decay"\nfile = "{name}"\n{more}\n')
        return path

    return write


def csv_of(time, x, head="time_s,x_mm", separator=",", comma=False):
    rows = [f"{t:.6g}{separator}{place:.6g}" for t, place in zip(time, x, strict=True)]
    text = "\n".join(rows)
    return head + "\n" + (text.replace(".", ",") if comma else text) + "\n"


# What comes out


def test_from_a_file_to_a_friction_force(rig, capsys):
    path = rig(csv_of(*synthetic(TRUTH, 1)), "[known]\nbase_mm = 1.75\nstiffness = 1191.0")
    assert main(["identify", str(path)]) == 0
    out = capsys.readouterr().out
    row = next(line.split() for line in out.splitlines() if line.split()[:1] == ["x_F"])
    assert float(row[1]) == pytest.approx(TRUTH.x_F, abs=0.002)
    assert row[-1] == "mm"
    assert "friction and viscous damping found" in out
    with xr.open_dataset("rig-identify.nc") as ds:
        assert float(ds.estimate.sel(parameter="x_F")) == pytest.approx(TRUTH.x_F, abs=0.002)
        np.testing.assert_allclose(ds.model - ds.data, ds.residual, atol=1e-12)
        assert ds.unit.values.tolist() == ["Hz", "1", "mm", "mm", "s", "mm"]
        assert float(ds.friction_force) == pytest.approx(1191.0 * TRUTH.x_F * 1e-3, abs=0.003)
        assert ds.attrs["config"] == path.read_text()
        assert not any(np.isnan(ds[name]).any() for name in ds.data_vars if ds[name].dtype.kind == "f")


def test_the_result_comes_first_and_a_missing_stiffness_is_named(rig, capsys):
    """The interval is that of the estimate times k; without k it is F/k, and the key for F is named."""
    path = rig(csv_of(*synthetic(TRUTH, 1)), "[known]\nstiffness = 1191.0")
    assert main(["identify", str(path)]) == 0
    _, result, *more = capsys.readouterr().out.splitlines()
    with xr.open_dataset("rig-identify.nc") as ds:
        one = ds.sel(parameter="x_F")
        half = 1.191 * 0.5 * float(one.upper - one.lower)
        force = float(ds.friction_force)
    found = re.fullmatch(r"  F = (\S+) \+- (\S+) N \(95 %\); friction and viscous damping found", result)
    assert float(found[1]) == pytest.approx(force, rel=1e-3)
    assert float(found[2]) == pytest.approx(half, rel=0.05)
    (head,) = (k for k, line in enumerate(more) if line.split()[0] == "estimate")
    assert all(line.startswith("  warning: ") for line in more[:head])
    assert main(["identify", str(path), "--overwrite", "--verbose"]) == 0
    assert "linear_decrement" in capsys.readouterr().out
    assert main(["identify", str(rig(csv_of(*synthetic(TRUTH, 1)))), "--overwrite"]) == 0
    _, result, *table = capsys.readouterr().out.splitlines()
    assert re.match(r"  x_F = \S+ \+- \S+ mm \(95 %\); friction", result)
    (missing,) = (k for k, line in enumerate(table) if "known.stiffness (N/m) is missing" in line)
    assert missing < [line.split()[0] for line in table].index("estimate")
    assert not [line for line in table if "linear_decrement" in line]


def test_an_existing_file_is_kept(rig, capsys):
    path = rig(csv_of(*synthetic(TRUTH, 1)))
    assert main(["identify", str(path), "--quiet"]) == 0
    assert capsys.readouterr().out == ""
    assert "it already exists" in refusal(capsys, "identify", path)
    assert main(["identify", str(path), "--quiet", "--overwrite"]) == 0
    before = Path("decay.csv").read_bytes()
    assert "-o must end in .nc; got decay.csv" in refusal(
        capsys, "identify", path, "-o", "decay.csv", "--overwrite"
    )
    assert Path("decay.csv").read_bytes() == before


def test_known_and_free_must_agree(rig, capsys):
    path = rig(csv_of(*synthetic(TRUTH, 1)), "[known]\nzeta = 0.01")
    assert main(["identify", str(path)]) == 0
    assert re.search(r"zeta +0.01 +held", capsys.readouterr().out)
    free = 'fit.free=["f_n", "zeta", "x_F", "X0", "t0", "centre"]'
    assert "cannot fit zeta: [known] holds it" in refusal(capsys, "identify", path, "--set", free)
    message = refusal(capsys, "identify", path, "--set", 'fit.free=["f_n"]')
    assert "cannot hold x_F: its value is missing" in message
    few = 'fit.free=["f_n", "x_F"]'  # where and when it starts need not be named
    assert main(["identify", str(path), "--quiet", "--overwrite", "--set", few]) == 0
    message = refusal(capsys, "identify", path, "--overwrite", "--set", 'fit.free=["f_n", "x_F", "offset"]')
    assert "fit.free must be one of f_n, zeta, x_F, X0, t0, centre; got 'offset'" in message


def test_a_window_leaves_out_the_rest(rig, capsys):
    path = rig(csv_of(*synthetic(TRUTH, 1)), "window = [0.0, 1.5]")
    assert main(["identify", str(path), "--quiet"]) == 0
    with xr.open_dataset("rig-identify.nc") as ds:
        assert ds.sizes["sample"] == 301
    message = refusal(capsys, "identify", path, "--overwrite", "--set", "data.window=[7, 8]")
    assert "window must hold samples" in message


# Files


@pytest.mark.parametrize(
    ("head", "separator", "comma", "form"),
    [
        ("time_s,x_mm", ",", False, "comma between columns, decimal point"),
        ("time_s;x_mm", ";", False, "semicolon between columns, decimal point"),
        ("time_s;x_mm", ";", True, "semicolon between columns, decimal comma"),
        ("time_s\tx_mm", "\t", True, "tab between columns, decimal comma"),
    ],
)
def test_files_of_data_loggers(rig, head, separator, comma, form):
    time, x = synthetic(TRUTH, 1)
    path = rig(csv_of(time, x, head, separator, comma))
    assert main(["identify", str(path), "--quiet"]) == 0
    with xr.open_dataset("rig-identify.nc") as ds:
        np.testing.assert_allclose(ds.data, x, rtol=1e-5)
        assert form in ds.attrs["data_form"]


def test_arrays_in_files(rig, tmp_path):
    time, x = synthetic(TRUTH, 1)
    np.savez(tmp_path / "decay.npz", time_ms=1e3 * time, x_m=1e-3 * x)
    savemat(tmp_path / "decay.mat", {"time_s": time, "Weg_um": 1e3 * x[:, None], "note": "a rig"})
    more = 'columns = { x = "Weg_um" }'
    for name, keys, unit in (("decay.npz", "", "m"), ("decay.mat", more, "um")):
        assert main(["identify", str(rig(None, keys, name)), "--quiet", "--overwrite"]) == 0
        with xr.open_dataset("rig-identify.nc") as ds:
            one = ds.sel(parameter="x_F")
            assert one.unit == unit
            in_mm = float(one.estimate) * {"m": 1e3, "um": 1e-3}[unit]
            assert in_mm == pytest.approx(TRUTH.x_F, abs=0.002)
            np.testing.assert_allclose(ds.time, time, atol=1e-12)


def test_no_such_data(rig, capsys, tmp_path):
    (tmp_path / "decay.npz").write_bytes(b"PK nothing")
    (tmp_path / "decay.mat").write_bytes(b"MATLAB 5.0 nothing")
    for name in ("decay.npz", "decay.mat", "absent.csv", "decay.tdms"):
        assert name in refusal(capsys, "identify", rig(None, name=name))


GOOD = csv_of(*synthetic(TRUTH, 1)).splitlines()


def changed(line, text):
    """The good file with one line, counted from 1, replaced."""
    return "\n".join([*GOOD[: line - 1], text, *GOOD[line:]]) + "\n"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("\n".join(GOOD[1:]), r"column time_s .*_s, _ms, _us, _min\) is missing.* write a line of names"),
        (changed(1, "time_s,y_mm"), r"column x_mm .* is missing; the file has time_s, y_mm"),
        ("time_s,x_mm\n", r"no values below time_s, x_mm"),
        ("", r"it is empty; the first line must name the columns"),
    ],
)  # fmt: skip
def test_bad_files(rig, capsys, text, message):
    found = refusal(capsys, "identify", rig(text))
    assert re.search(message, found), found
    assert "decay.csv" in found


def test_a_growing_motion_is_no_decay(rig, capsys):
    time = np.arange(1000) / 250.0
    x = 0.1 * np.exp(time) * np.cos(2.0 * np.pi * 3.1 * time)
    assert "as a free decay: its amplitude grows" in refusal(capsys, "identify", rig(csv_of(time, x)))


def test_rows_without_a_number_are_dropped_on_request_only(rig, capsys):
    path = rig(changed(402, "2,nan"))
    assert main(["identify", str(path), "--set", "data.missing=drop"]) == 0
    assert "warning: 1 of 800 rows of decay.csv have no number and were ignored" in capsys.readouterr().out
    many = "\n".join(GOOD[:1] + [f"{line.split(',')[0]}," for line in GOOD[1:10]] + GOOD[10:])
    message = refusal(capsys, "identify", rig(many), "--overwrite", "--set", "data.missing=drop")
    assert "column x_mm, line 2 must be a finite number; got ''" in message
    assert "9 of 800 rows have none; at most 1% may be ignored" in message


def test_gaps_and_clipped_samples_are_reported(rig, capsys):
    time, x = synthetic(TRUTH, 1)
    path = rig(csv_of(np.delete(time, slice(300, 340)), np.delete(x, slice(300, 340))))
    assert main(["identify", str(path)]) == 0
    assert "warning: a gap of 0.205 s" in capsys.readouterr().out
    path = rig(csv_of(time, np.clip(x, -5.0, 5.0)))
    assert main(["identify", str(path), "--overwrite"]) == 0
    assert "warning: clipped" in capsys.readouterr().out
    with xr.open_dataset("rig-identify.nc") as ds:
        assert (np.abs(ds.data) < 5.0).all()
        one = ds.sel(parameter="x_F")
        assert abs(float(one.estimate) - TRUTH.x_F) < 4.0 * float(one.standard_error)


def test_coarse_samples_are_not_clipped():
    time, x = synthetic(TRUTH._replace(noise=0.0, rate=2000.0), 1)
    assert "clipped" not in fm.identify.free_decay(time, np.round(x, 1)).warnings


@pytest.mark.parametrize("step", [1e-6, 1e-3, 0.01, 0.1])
@pytest.mark.parametrize("late", [0.0, 0.4, 0.9])
def test_a_mass_held_before_its_release_is_not_clipped(step, late):
    """Until t0 it is at the largest value of the record, then it is soon far away from it."""
    truth = TRUTH._replace(t0=0.1 + late / TRUTH.rate, noise=0.0)
    time, x = synthetic(truth, 1)
    readings = np.round(x / step) * step
    ds = fm.identify.free_decay(time, readings)
    assert "clipped" not in ds.warnings
    assert ds.sizes["sample"] == time.size


@pytest.mark.parametrize("step", [0.01, 0.05, 0.2])
def test_a_coarse_record_is_clipped_where_its_range_ends(step):
    time, x = synthetic(TRUTH._replace(rate=1000.0), 1)
    readings = np.round(np.clip(x, -5.0, 9.0) / step) * step
    with_both = np.round(np.clip(x, -5.0, 5.0) / step) * step
    for cut in (readings, with_both):
        ds = fm.identify.free_decay(time, cut)
        assert "clipped" in ds.warnings
        assert float(ds.data.min()) > -5.0 + 0.5 * step


BAD = {
    "no-header": "_s, _ms", "no-unit": "none", "unknown-unit": "'furlong'", "missing-column": "x_mm",
    "empty": "x_mm", "nan": "line 402", "text": "line 122", "time-backwards": "line 303",
    "time-twice": "line 13", "too-short": "fewer than 3 extrema", "constant": "resolution (0)",
    "growing": "as a free decay: its amplitude grows", "undersampled": "samples per cycle, 8 needed",
}  # fmt: skip


@pytest.mark.parametrize("name", BAD)
def test_bad_measurements(measured, rig, capsys, name):
    path = rig(None, name=str(measured / "bad" / f"{name}.csv"))
    message = refusal(capsys, "identify", path)
    assert BAD[name] in message
    assert f"{name}.csv" in message


@pytest.mark.parametrize(("name", "warning"), [("gap", "a gap of 0.084 s"), ("clipped", "clipped: 14.4%")])
def test_odd_measurements(measured, rig, capsys, name, warning):
    assert main(["identify", str(rig(None, name=str(measured / "bad" / f"{name}.csv")))]) == 0
    assert f"warning: {warning}" in capsys.readouterr().out


# Configurations and arguments


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "must have a table [data] with kind, one of free-decay, "),
        ('kind = "free-decay"', "must have a table [data] with kind, one of free-decay, "),
        ('[data]\nfile = "decay.csv"', "must have a table [data] with kind, one of free-decay, "),
        (
            '[data]\nkind = "free-decay"',
            "data.file must be the path of a file of measured data; got nothing",
        ),
        ("[system]\n[grid]\nr = 1.0", "it describes a map; use frictionmap map"),
    ],
)
def test_configurations_of_something_else(tmp_path, capsys, text, message):
    path = tmp_path / "rig.toml"
    path.write_text(text)
    assert message in refusal(capsys, "identify", path)


def test_commands_name_each_other(rig, capsys):
    path = rig("\n".join(GOOD))
    assert "it describes measured data; use frictionmap identify" in refusal(capsys, "map", path)
    assert "it is a data file; give a RIG.toml" in refusal(capsys, "identify", path.parent / "decay.csv")


def test_text_of_two_bytes_a_letter_without_a_mark(rig, capsys):
    path = rig("")
    (path.parent / "decay.csv").write_bytes("\n".join(GOOD).encode("utf-16-le"))
    assert "it contains zero bytes and is not text" in refusal(capsys, "identify", path)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"x": np.full(800, np.nan)}, "x must be finite; got nan at index 0"),
        ({"base": 0.0}, "base must be > 0"),
    ],
)
def test_bad_arguments(arguments, message):
    time, x = synthetic(TRUTH, 1)
    with pytest.raises(fm.InputError, match=re.escape(message)):
        fm.identify.free_decay(**{"time": time, "x": x} | arguments)


def test_the_room_is_loaded_when_used():
    code = (
        "import frictionmap as fm, sys; print('scipy' in sys.modules); print(fm.identify.free_decay.__name__)"
    )
    shown = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=600
    )
    assert shown.stdout.split() == ["False", "free_decay"]


def test_columns_that_are_not_used_are_named(rig, capsys):
    """What is mapped elsewhere is no candidate, and what is unknown does not matter."""
    time, x = synthetic(TRUTH, 1)
    rows = "\n".join(f"{t:.6g},{place:.6g},{place:.6g},note" for t, place in zip(time, x, strict=True))
    text = f"time_s,x_mm,x_volt,remark\n{rows}\n"
    assert main(["identify", str(rig(text))]) == 0
    assert "warning: columns of decay.csv that are not used: x_volt, remark\n" in capsys.readouterr().out
    text = text.replace("x_volt", "x_time_s")
    assert main(["identify", str(rig(text, 'columns = { x = "x_mm" }')), "--overwrite"]) == 0
    assert "warning: columns of decay.csv that are not used: x_time_s, remark\n" in capsys.readouterr().out


def test_unused_columns_of_large_files(rig, capsys):
    time, x = synthetic(TRUTH, 1)
    names = ",".join(f"channel_{k}" for k in range(20))
    rows = "\n".join(f"{t:.6g},{place:.6g}" + 20 * ",1" for t, place in zip(time, x, strict=True))
    assert main(["identify", str(rig(f"time_s,x_mm,{names}\n{rows}\n"))]) == 0
    assert "channel_6, channel_7 and 12 more\n" in capsys.readouterr().out
