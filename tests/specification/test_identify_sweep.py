"""The command `identify` for sweeps without friction."""

import json

import numpy as np
import pytest
import xarray as xr
from refusals import refusal
from sweeps import responses

from frictionmap.command_line.cli import main

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


def test_from_a_file_to_two_masses(rig, capsys):
    assert main(["identify", rig(LINES)]) == 0
    out = capsys.readouterr().out
    assert "a chain of two masses explains the data, with errors from the residuals" in out
    rows = {line.split()[0]: line.split()[1] for line in out.splitlines() if line.split()}
    assert float(rows["gamma"]) == pytest.approx(0.9, abs=1e-6)
    assert float(rows["kappa"]) == pytest.approx(1.2, abs=1e-6)
    with xr.open_dataset("rig-identify.nc") as ds:
        assert ds.parameter.values.tolist() == ["f0", "f1", "f2", "f_k1m1", "gamma", "kappa"]
        assert ds.unit.values.tolist() == ["Hz", "Hz", "Hz", "Hz", "1", "1"]


def test_three_masses_with_lags(rig):
    """Columns of every mass measured, lags in degrees or radian, damping of every mode."""
    f = np.linspace(0.5, 7.0, 70)
    X = responses(f, [1.0, 1.2, 0.7], [1.0, 0.8, 1.1], [0.01, 0.02, 0.015], 3.0)
    head = "frequency_Hz,amplitude_ratio_1,phase_lag_1_deg,amplitude_ratio_3,phase_lag_3_rad"
    columns = [f, np.abs(X[:, 0]), -np.degrees(np.angle(X[:, 0])), np.abs(X[:, 2]), -np.angle(X[:, 2])]
    lines = [",".join(f"{value:.12g}" for value in row) for row in np.transpose(columns)]
    assert main(["identify", rig(lines, SWEEP.replace("2", "3"), head), "--quiet"]) == 0
    with xr.open_dataset("rig-identify.nc") as ds:
        expected = {
            "f_k1m1": 3.0, "mass_ratio_2": 1.2, "mass_ratio_3": 0.7, "stiffness_ratio_2": 0.8,
            "stiffness_ratio_3": 1.1, "zeta_1": 0.01, "zeta_2": 0.02, "zeta_3": 0.015,
        }  # fmt: skip
        assert ds.parameter.values.tolist() == list(expected)
        np.testing.assert_allclose(ds.estimate, list(expected.values()), rtol=1e-8)
        assert ds.sizes["sample"] == 4 * f.size


def test_parameters_that_are_not_determined_are_named(rig, capsys):
    message = refusal(capsys, "identify", rig(LINES, head="frequency_Hz,amplitude_ratio_2"))
    assert "amplitude_ratio_2" in message
    assert "cannot identify f_k1m1, gamma, kappa separately: mass 2 does not determine them; fix 1" in message


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
    message = refusal(
        capsys, "identify", "rig.toml", "--set", f"data.file={measured / 'bad' / 'sweep-one-peak.csv'}"
    )
    assert "two peaks for two frequencies; got one peak" in message
    assert "sweep-one-peak.csv" in message


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        (["-1.0,2.0", *LINES], "column frequency_Hz, line 2 must be > 0; got -1"),
        ([*LINES[:5], "1.7,0", *LINES[6:]], "column amplitude_ratio_1, line 7 must be > 0; got 0"),
    ],
)
def test_bad_rows(rig, capsys, lines, message):
    assert message in refusal(capsys, "identify", rig(lines))


@pytest.mark.parametrize(
    ("head", "message"),
    [
        (
            "frequency_Hz,amplitude_ratio_3",
            "system.masses must be at least 3, as there is amplitude_ratio_3; got 2",
        ),
        (
            "frequency_Hz,ratio",
            "column amplitude_ratio_1 is missing; the file has",
        ),
    ],
)
def test_bad_names(rig, capsys, head, message):
    assert message in refusal(capsys, "identify", rig(LINES, head=head))


def test_masses_are_asked_for(rig, capsys):
    text = SWEEP.replace("masses = 2", "")
    assert "system.masses must be a whole number from 1 to 5; got nothing" in refusal(
        capsys, "identify", rig(LINES, text)
    )
