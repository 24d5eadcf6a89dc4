"""The command `identify` for sweeps without friction."""

import json

import numpy as np
import pytest
import xarray as xr

from frictionmap.cli import main

SWEEP = """
[data]
kind = "sweep"
file = "sweep.csv"
[system]
excitation = "base"
masses = 2
"""


def amplitude(f, gamma=0.9, kappa=1.2, f_k1m1=3.0):
    """|X_1|/Y of two masses on a shaken base, by Cramer's rule."""
    w = (f / f_k1m1) ** 2
    second = kappa - gamma * w
    return np.abs(second / ((1.0 + kappa - w) * second - kappa**2))


FREQUENCIES = np.arange(0.5, 8.0, 0.22)
LINES = [f"{f:.4f},{x:.10f}" for f, x in zip(FREQUENCIES, amplitude(FREQUENCIES), strict=True)]


@pytest.fixture
def rig(tmp_path, monkeypatch):
    """Writes a data file and its configuration; the path of the latter."""
    monkeypatch.chdir(tmp_path)

    def write(lines, text=SWEEP, head="frequency_Hz,amplitude_ratio_1"):
        (tmp_path / "sweep.csv").write_text("\n".join([head, *lines]) + "\n")
        (tmp_path / "rig.toml").write_text(text)
        return "rig.toml"

    return write


def refusal(capsys, *arguments):
    """The one line on standard error of a command that is refused."""
    assert main(["identify", *arguments]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.count("\n") == 1
    return err


def test_from_a_file_to_two_masses(rig, capsys):
    assert main(["identify", rig(LINES)]) == 0
    out = capsys.readouterr().out
    assert "two natural frequencies found" in out
    rows = {line.split()[0]: line.split()[1] for line in out.splitlines() if line.split()}
    assert float(rows["gamma"]) == pytest.approx(0.9, abs=1e-6)
    assert float(rows["kappa"]) == pytest.approx(1.2, abs=1e-6)
    with xr.open_dataset("rig-identify.nc") as ds:
        assert ds.parameter.values.tolist() == ["f0", "f1", "f2", "f_k1m1", "gamma", "kappa"]
        assert ds.unit.values.tolist() == ["Hz", "Hz", "Hz", "Hz", "1", "1"]


@pytest.mark.parametrize("folder", ["visible-1", "visible-2"])
def test_synthetic_sweeps(measured, tmp_path, folder):
    """Every estimate within its tolerance, standard errors near the Cramer-Rao bound."""
    truth = json.loads((measured / folder / "truth.json").read_text())["sweep-two-storey"]
    path = tmp_path / "out.nc"
    assert (
        main(["identify", str(measured / folder / "sweep-two-storey.toml"), "-o", str(path), "--quiet"]) == 0
    )
    with xr.open_dataset(path) as ds:
        for name, tolerance in truth["tolerance"].items():
            one = ds.sel(parameter=name)
            assert abs(float(one.estimate) - truth[name]) < tolerance, name
            assert 0.8 < float(one.standard_error) / truth["crb"][name] < 1.25, name


def test_one_peak(measured, rig, capsys):
    rig([])
    message = refusal(capsys, "rig.toml", "--set", f"data.file={measured / 'bad' / 'sweep-one-peak.csv'}")
    assert "one peak: two frequencies wanted" in message
    assert "sweep-one-peak.csv" in message


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        (["-1.0,2.0", *LINES], "column frequency_Hz, line 2 must be > 0; got -1"),
        ([*LINES[:5], "1.7,0", *LINES[6:]], "column amplitude_ratio_1, line 7 must be > 0; got 0"),
        ([*LINES[:5], "1.0,2", *LINES[6:]], "column frequency_Hz, line 7 must be higher than the row before"),
        ([*LINES[:5], "1.7,x", *LINES[6:]], "column amplitude_ratio_1, line 7 must be a finite number"),
        (LINES[:3], "frequency must have more values than there are unknowns, 3; got 3"),
    ],
)
def test_bad_rows(rig, capsys, lines, message):
    assert message in refusal(capsys, rig(lines))


@pytest.mark.parametrize(
    ("head", "message"),
    [
        (
            "frequency_Hz,ratio",
            "must have a column amplitude_ratio_1, or data.columns.amplitude_ratio_1 names",
        ),
        ("frequency_rpm,amplitude_ratio_1", "column frequency_rpm must end in its unit, one of _Hz"),
    ],
)
def test_bad_names(rig, capsys, head, message):
    assert message in refusal(capsys, rig(LINES, head=head))


@pytest.mark.parametrize(
    ("override", "message"),
    [
        ("system.masses=0", "system.masses must be >= 2; got 0"),
        ("system.stiffness=3", "unknown key system.stiffness"),
        ("system.excitation=shaker", "system.excitation must be one of base; got 'shaker'"),
        ("data.sigma_amplitude=0", "data.sigma_amplitude must be > 0; got 0"),
        ("data.window=[1, 2]", "unknown key data.window"),
        ("known.mu=1", "unknown key known.mu"),
    ],
)
def test_bad_configurations(rig, capsys, override, message):
    assert message in refusal(capsys, rig(LINES), "--set", override)


def test_masses_are_asked_for(rig, capsys):
    text = SWEEP.replace("masses = 2", "")
    assert "system.masses must be given for a sweep" in refusal(capsys, rig(LINES, text))
