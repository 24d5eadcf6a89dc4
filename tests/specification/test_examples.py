"""The synthetic rigs of configs/rigs: what makes them, and that the command finds the truth in each."""

import re
import subprocess
import sys

import pytest
import xarray as xr
from conftest import ROOT

from frictionmap.command_line.cli import main
from frictionmap.examples import TRUTHS, rig_files

RIGS = ROOT / "configs" / "rigs"


def test_the_files_are_those_of_the_generator():
    assert {path.name: path.read_text(encoding="utf-8") for path in RIGS.iterdir()} == rig_files()


def test_the_files_are_small_and_state_that_nothing_was_measured():
    assert sum(path.stat().st_size for path in RIGS.iterdir()) < 70_000
    for path in RIGS.iterdir():
        assert path.read_text(encoding="utf-8").startswith("# Synthetic: made by frictionmap.examples"), path


def test_another_seed_is_another_measurement():
    tables = {name: text for name, text in rig_files(2).items() if name.endswith(".csv")}
    for name, text in tables.items():
        assert text != rig_files()[name]
        assert text.splitlines()[:2] == rig_files()[name].splitlines()[:2]


def test_the_generator_writes_into_a_folder(tmp_path):
    folder = tmp_path / "new"
    subprocess.run([sys.executable, "-m", "frictionmap.examples", folder], cwd=ROOT, check=True, timeout=600)
    assert sorted(path.name for path in folder.iterdir()) == sorted(path.name for path in RIGS.iterdir())


@pytest.mark.parametrize("kind", TRUTHS)
def test_the_command_finds_the_truth(kind, tmp_path, monkeypatch, capsys):
    """Within four standard errors, of which a normal deviate is in 99.994 %."""
    monkeypatch.chdir(tmp_path)
    assert main(["identify", str(RIGS / f"{kind}.toml")]) == 0
    with xr.open_dataset(f"{kind}-identify.nc") as ds:
        for name, truth in TRUTHS[kind].items():
            one = ds.sel(parameter=name)
            assert abs(float(one.estimate) - truth) < 4.0 * float(one.standard_error), name
    assert main(["plot", f"{kind}-identify.nc"]) == 0
    assert main(["info", f"{kind}-identify.nc"]) == 0
    assert f"{kind}.csv (CSV, comma between columns" in " ".join(capsys.readouterr().out.split())
    assert (tmp_path / f"{kind}-identify.png").stat().st_size > 5000


@pytest.mark.parametrize("kind", TRUTHS)
def test_the_truth_is_stored_with_the_data(kind):
    text = (RIGS / f"{kind}.toml").read_text(encoding="utf-8")
    (told,) = re.findall(r"^# The truth, in Hz, mm and s: (.*)$", text, re.MULTILINE)
    pairs = (part.split(" = ") for part in told.split(", "))
    assert {name: float(value) for name, value in pairs} == dict(TRUTHS[kind])
