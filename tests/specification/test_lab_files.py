"""Files of measuring programs: UFF, MAT v7.3, TDMS, through the extra `lab`; what is said without it."""

import sys

import numpy as np
import pytest
import xarray as xr
from decays import Truth, synthetic
from sweeps import responses

from frictionmap.command_line.cli import main

TRUTH = Truth(3.1, 0.01, 0.2, 10.0, -0.02, 0.3, 200.0, 4.0, 0.02)


@pytest.fixture
def rig(tmp_path, monkeypatch):
    """Writes a configuration for a data file in the current folder."""
    monkeypatch.chdir(tmp_path)

    def write(file, kind="free-decay", more=""):
        (tmp_path / "rig.toml").write_text(f'[data]\nkind = "{kind}"\nfile = "{file}"\n{more}\n')
        return "rig.toml"

    return write


def set_58(x, data, kind, unit, node=1, name="NONE"):
    """A set 58 as pyuff writes it: a record (1) over time, or a response (4) of displacements."""
    record = kind == 1
    return {
        "type": 58, "binary": 0, "func_type": kind, "rsp_node": node, "rsp_dir": 1, "ref_node": 0,
        "ref_dir": 0, "id1": "NONE", "abscissa_spec_data_type": 17 if record else 18,
        "abscissa_axis_lab": "time" if record else "frequency",
        "abscissa_axis_units_lab": "s" if record else "Hz",
        "ordinate_spec_data_type": 8, "ordinate_axis_lab": name, "ordinate_axis_units_lab": unit,
        "orddenom_spec_data_type": 0 if record else 8, "ord_data_type": 4 if record else 6,
        "x": x, "data": data,
        "abscissa_spacing": 1, "abscissa_min": x[0], "abscissa_inc": x[1] - x[0], "num_pts": x.size,
    }  # fmt: skip


def estimate(name):
    with xr.open_dataset("rig-identify.nc") as ds:
        return float(ds.estimate.sel(parameter=name)), ds.attrs["data_form"]


def test_a_record_in_a_universal_file(rig):
    pyuff = pytest.importorskip("pyuff")
    time, x = synthetic(TRUTH, 1)
    pyuff.UFF("decay.uff").write_sets(set_58(time, x, 1, "mm", name="x"), "overwrite")
    assert main(["identify", rig("decay.uff"), "--quiet"]) == 0
    found, form = estimate("x_F")
    assert found == pytest.approx(TRUTH.x_F, abs=0.002)
    assert form == "UFF"


def test_a_record_without_a_unit_is_refused(rig, capsys):
    pyuff = pytest.importorskip("pyuff")
    time, x = synthetic(TRUTH, 1)
    pyuff.UFF("decay.unv").write_sets(set_58(time, x, 1, "NONE", name="x"), "overwrite")
    assert main(["identify", rig("decay.unv")]) == 2
    said = capsys.readouterr().err
    assert "column x: its name must end in a unit, _mm, _m, _um, _in, _cm, _ft, _m_s" in said
    assert 'got none (or write columns = { x = { name = "x", unit = "mm" } }' in said


def test_responses_in_a_universal_file(rig):
    pyuff = pytest.importorskip("pyuff")
    f = np.linspace(0.5, 8.0, 76)
    X = responses(f, [1.0, 0.9], [1.0, 1.2], [0.01, 0.02], 3.0)
    sets = [set_58(f, X[:, k], 4, "NONE", node=k + 1) for k in range(2)]
    pyuff.UFF("sweep.uff").write_sets(sets, "overwrite")
    assert main(["identify", rig("sweep.uff", "sweep", "[system]\nmasses = 2"), "--quiet"]) == 0
    for name, value in (("gamma", 0.9), ("kappa", 1.2), ("f_k1m1", 3.0), ("zeta_1", 0.01), ("zeta_2", 0.02)):
        assert estimate(name)[0] == pytest.approx(value, rel=1e-4)  # the file has six digits


def test_a_record_in_a_mat_file_of_version_73(rig):
    h5py = pytest.importorskip("h5py")
    time, x = synthetic(TRUTH, 1)
    with h5py.File("decay.mat", "w", userblock_size=512) as stored:
        stored["time_s"], stored["x_mm"] = time[np.newaxis], x[np.newaxis]
        stored["note"] = np.frombuffer("rig".encode("utf-16-le"), dtype=np.uint16)
        stored["note"].attrs["MATLAB_class"] = np.bytes_("char")
    with open("decay.mat", "r+b") as file:  # the header of MATLAB, as scipy looks for it
        file.write(b"MATLAB 7.3 MAT-file".ljust(124) + b"\x00\x02IM")
    assert main(["identify", rig("decay.mat"), "--quiet"]) == 0
    found, form = estimate("x_F")
    assert found == pytest.approx(TRUTH.x_F, abs=0.002)
    assert form == "MAT v7.3"


def test_a_waveform_in_a_tdms_file(rig):
    nptdms = pytest.importorskip("nptdms")
    _, x = synthetic(TRUTH, 1)
    waveform = {
        "wf_increment": 1.0 / TRUTH.rate,
        "wf_samples": x.size,
        "wf_start_offset": 0.0,
        "unit_string": "mm",
    }
    with nptdms.TdmsWriter("decay.tdms") as writer:
        writer.write_segment([nptdms.ChannelObject("rig", "x", x, properties=waveform)])
    assert main(["identify", rig("decay.tdms"), "--quiet"]) == 0
    found, form = estimate("x_F")
    assert found == pytest.approx(TRUTH.x_F, abs=0.002)
    assert form == "TDMS"


@pytest.mark.parametrize(("package", "file"), [("pyuff", "a.uff"), ("pyuff", "a.unv"), ("nptdms", "a.tdms")])
def test_without_the_package_it_is_named(rig, capsys, monkeypatch, tmp_path, package, file):
    monkeypatch.setitem(sys.modules, package, None)
    (tmp_path / file).write_bytes(b"anything")
    assert main(["identify", rig(file)]) == 2
    err = capsys.readouterr().err
    assert f"cannot read {file}: {package} is not installed; run pip install 'frictionmap[lab]'" in err
    assert err.count("\n") == 1


@pytest.mark.parametrize(("package", "file"), [("pyuff", "a.uff"), ("nptdms", "a.tdms")])
def test_files_that_are_something_else(rig, capsys, tmp_path, package, file):
    pytest.importorskip(package)
    (tmp_path / file).write_bytes(b"nothing of the kind\n")
    assert main(["identify", rig(file)]) == 2
    err = capsys.readouterr().err
    assert file in err
    assert err.count("\n") == 1
