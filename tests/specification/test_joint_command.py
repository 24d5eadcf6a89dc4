"""Several measurements in tables [[data]] through the command `identify`: what comes out, what is refused."""

import tomllib

import numpy as np
import pytest
import xarray as xr
from conftest import ROOT
from jsonschema import Draft202012Validator
from refusals import refusal

from frictionmap.command_line.cli import main
from frictionmap.identify.rigs.keys import rig_schema

RIGS = ROOT / "configs" / "rigs"

#: The truth that stands beside the data of configs/rigs.
TRUTH = {"f_n": 3.12, "zeta": 0.008, "mu": 1.2, "x_F_decay": 0.2, "x_F_shaken": 0.7}

#: One of the two tables [[data]].
ONE = '[[data]]\nkind = "record"\nfile = "record.csv"\nlabel = "shaken"\n'


@pytest.fixture
def rig(tmp_path, monkeypatch):
    """Writes joint.toml, changed, beside the data of configs/rigs; its path."""
    monkeypatch.chdir(tmp_path)
    for name in ("free-decay.csv", "record.csv"):
        (tmp_path / name).write_bytes((RIGS / name).read_bytes())

    def write(*changes):
        text = (RIGS / "joint.toml").read_text()
        for old, new in changes:
            assert old in text
            text = text.replace(old, new, 1)
        (tmp_path / "joint.toml").write_text(text)
        return "joint.toml"

    return write


def test_from_files_to_friction_forces(rig, capsys):
    assert main(["identify", rig()]) == 0
    out = capsys.readouterr().out
    assert "friction found in all of the data" in out
    with xr.open_dataset("joint-identify.nc") as ds:
        for name, truth in TRUTH.items():
            one = ds.sel(parameter=name)
            assert abs(float(one.estimate) - truth) < 4.0 * float(one.standard_error), name
        assert float(ds.friction_force_shaken) == pytest.approx(1.191 * 0.7, rel=0.01)
        assert ds.attrs["data_file"] == "free-decay.csv, record.csv"
    assert main(["plot", "joint-identify.nc"]) == 0
    assert main(["info", "joint-identify.nc"]) == 0
    assert "x_F_shaken" in capsys.readouterr().out


def test_windows_units_and_columns_are_those_of_each_file(rig, tmp_path):
    rows = np.genfromtxt(tmp_path / "free-decay.csv", delimiter=",", skip_header=2)
    table = np.column_stack((1e3 * rows[:, 0], 1e3 * rows[:, 1]))
    np.savetxt(tmp_path / "other.csv", table, "%.6g", ",", header="t_ms,x_um", comments="")
    path = rig(
        ('file = "free-decay.csv"', 'file = "other.csv"\ncolumns = { time = "t_ms" }\nwindow = [0.0, 3.0]')
    )
    assert main(["identify", path, "--quiet"]) == 0
    with xr.open_dataset("joint-identify.nc") as ds:
        assert float(ds.time_of_sample[ds["set"] == "decay"].max()) == pytest.approx(3.0)
        one = ds.sel(parameter="x_F_decay")
        assert abs(float(one.estimate) - 0.2) < 4.0 * float(one.standard_error)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (('kind = "record"', 'kind = "forced"'), "data[1].kind must be one of free-decay, record;"),
        (('label = "shaken"', 'labels = "shaken"'), "unknown key 'data[1].labels'"),
        (('label = "shaken"', 'label = "decay"'), "label must be different in every table [[data]]"),
        (('file = "record.csv"', "file = 3"), "data[1].file must be text; got 3"),
        (('file = "record.csv"', 'file = "none.csv"'), "none.csv: No such file"),
        (('label = "decay"', 'columns = { base = "x_mm" }'), "unknown key 'data[0].columns.base'"),
        (('label = "decay"', "window = [7, 8]"), "free-decay.csv: window must hold samples"),
        (('label = "decay"', 'missing = "mend"'), "data[0].missing must be one of refuse, drop; got 'mend'"),
        ((ONE, ""), "two or more tables [[data]]"),
    ],
)  # fmt: skip
def test_bad_configurations(rig, capsys, change, message):
    assert message in refusal(capsys, "identify", rig(change))


def test_the_schema_knows_tables_of_data():
    schema = Draft202012Validator(rig_schema())
    text = (RIGS / "joint.toml").read_text()
    schema.validate(tomllib.loads(text))
    assert not schema.is_valid(tomllib.loads(text.replace('kind = "record"', 'kind = "sweep"')))
    assert not schema.is_valid(tomllib.loads(text.replace("label =", "labels =")))
    assert not schema.is_valid(tomllib.loads(text.replace("stiffness", "base_mm")))
