"""NetCDF files: what a reader without frictionmap finds in them."""

import contextlib
import os
import tomllib
from datetime import datetime
from pathlib import Path

import netCDF4
import numpy as np
import pytest
import xarray as xr

import frictionmap as fm
from frictionmap import InputError
from frictionmap.command_line.cli import main
from frictionmap.files import reading, storage
from frictionmap.model.settings import OUTPUTS

CONFIG = """\
title = "Tiny"
[system]
contact = "joined-base-wall"
[grid]
r = [0.0, 0.3, 0.5, 2.0]
beta = [0.0, 0.05, 0.5, 2.0, 5.0]
mu = [1.0, 1.5]
"""

CELL = ("mu", "r", "beta")
CURVE = ("mu", "r")

#: Type and dimensions that files promise their readers.
CELL_VARIABLES = {
    "regime": "int8",
    "stops_per_cycle": "float32",
    "contact_amplitude": "float64",
    "stuck_fraction": "float32",
    "period": "int16",
    "origin": "int8",
    "cycles": "int32",
    "status": "int8",
}
MAP = {name: (dtype, CELL) for name, dtype in CELL_VARIABLES.items()} | {
    name: ("float64", CURVE) for name in ("beta_lim", "beta_stick")
}
BOUNDARIES = {name: ("float64", CURVE) for name in ("beta_lim", "beta_lim_modal", "beta_stick")} | {
    name: ("float64", ("r",)) for name in ("V", "U")
}
RESPONSE = {
    "x": ("float64", ("dof", "tau")),
    "v": ("float64", ("dof", "tau")),
    "z": ("float64", ("tau",)),
    "friction": ("float64", ("tau",)),
    "direction": ("int8", ("tau",)),
    "phase": ("int8", ("tau",)),
    "event_tau": ("float64", ("event",)),
    "event_direction": ("int8", ("event",)),
    "event_phase": ("int8", ("event",)),
    "event_z": ("float64", ("event",)),
    "regime": ("int8", ()),
    "stops_per_cycle": ("float32", ()),
    "contact_amplitude": ("float64", ()),
}
CONTENT = {"map": MAP, "boundaries": BOUNDARIES, "response": RESPONSE}


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """A file of each kind, as the program writes them."""
    folder = tmp_path_factory.mktemp("files")
    (folder / "tiny.toml").write_text(CONFIG)
    names = ", ".join(f'"{name}"' for name in OUTPUTS)
    more = {
        "map": ["--set", f"solver.outputs=[{names}]"],
        "response": ["--r", "0.3", "--beta", "0.05", "--mu", "1"],
    }
    for kind in CONTENT:
        arguments = [kind, str(folder / "tiny.toml"), "-o", str(folder / f"{kind}.nc"), "--quiet"]
        assert main(arguments + more.get(kind, [])) == 0
    return folder


@pytest.fixture(params=CONTENT)
def kind(request):
    return request.param


@pytest.fixture
def opened(files, kind):
    with xr.open_dataset(files / f"{kind}.nc") as ds:
        yield ds


def test_types_and_dimensions_after_reading(opened, kind):
    for name, (dtype, dims) in CONTENT[kind].items():
        assert opened[name].dtype == dtype, name
        assert opened[name].dims == dims, name


def test_coordinates(opened, kind):
    for name in (
        "mu",
        "r",
        *(["beta"] if kind != "boundaries" else []),
        *(["tau"] if kind == "response" else []),
    ):
        assert name in opened.coords
        assert opened[name].dtype == np.float64
        assert opened[name].attrs["units"] == "1"
        assert opened[name].attrs["long_name"]
    if kind == "map":
        assert opened.regime.shape == (2, 4, 5)
        np.testing.assert_array_equal(opened.r, [0.0, 0.3, 0.5, 2.0])
        np.testing.assert_array_equal(opened.beta, [0.0, 0.05, 0.5, 2.0, 5.0])
        np.testing.assert_array_equal(opened.mu, [1.0, 1.5])


def test_every_variable_is_described(opened):
    for name, variable in opened.variables.items():
        assert variable.attrs["long_name"], name
        coded = {"flag_values", "flag_masks"} & set(variable.attrs)
        texts = variable.dtype.kind in "UO"  # of the axis of real and imaginary parts
        assert ("units" in variable.attrs) is not (bool(coded) or texts), name
        assert variable.attrs.get("units", "1") in ("1", "radian")


def test_codes_are_explained(opened):
    for name, variable in opened.variables.items():
        if "flag_values" not in variable.attrs:
            continue
        values, meanings = variable.attrs["flag_values"], variable.attrs["flag_meanings"].split()
        assert values.dtype == variable.dtype == np.int8, name
        assert values.size == len(meanings) == len(set(meanings))
        assert np.isin(variable.values, values).all()
        for meaning in meanings:
            assert f"{meaning}: " in variable.attrs["comment"]


def test_codes_of_the_regime_are_those_promised(files):
    for kind in ("map", "response"):
        with xr.open_dataset(files / f"{kind}.nc") as ds:
            assert ds.regime.attrs["flag_values"].tolist() == [-1, 0, 1, 2]
            assert ds.regime.attrs["flag_meanings"] == "unresolved permanent_sticking stick_slip continuous"
    with xr.open_dataset(files / "map.nc") as ds:
        assert ds.origin.attrs["flag_values"].tolist() == [0, 1, 2]
        assert ds.status.attrs["flag_values"][0] == 0
        assert ds.status.attrs["flag_meanings"].startswith("resolved ")
    with xr.open_dataset(files / "response.nc") as ds:
        for name in ("direction", "phase", "event_direction", "event_phase"):
            assert ds[name].attrs["flag_values"].tolist() == [-1, 0, 1]


def test_only_what_was_asked_for_is_stored(files, tmp_path):
    arguments = ["map", str(files / "tiny.toml"), "-o", str(tmp_path / "out.nc"), "--quiet"]
    assert main([*arguments, "--set", 'solver.outputs=["period"]', "--set", "grid.r=[0.3, 2.0]"]) == 0
    with xr.open_dataset(tmp_path / "out.nc") as ds:
        assert set(ds.data_vars) == {"period", "beta_lim", "beta_stick"}


def test_global_attributes(opened, kind, files):
    attributes = opened.attrs
    assert set(attributes) == {
        "Conventions", "title", "source", "history", "references", "config", "system", "excitation"
    }  # fmt: skip
    assert attributes["Conventions"].startswith("CF-1.")
    assert attributes["title"] == "Tiny"
    assert attributes["source"] == f"frictionmap {fm.__version__}"
    stamp, _, command = attributes["history"].partition(" ")
    assert datetime.fromisoformat(stamp).tzinfo is not None
    assert command.startswith(f"frictionmap {kind} ")
    assert tomllib.loads(attributes["config"])["system"] == {"contact": "joined-base-wall"}
    assert "one mass" in attributes["system"]
    assert attributes["excitation"] == "base"
    if kind != "map":  # overrides rewrite the text
        assert attributes["config"] == CONFIG


def test_without_xarray(files, kind):
    """As ncdump sees it: NetCDF-4 with named dimensions, no fill values, nothing packed, all readable."""
    with netCDF4.Dataset(files / f"{kind}.nc") as raw:
        raw.set_auto_maskandscale(False)
        assert raw.data_model == "NETCDF4"
        assert not any(dimension.isunlimited() for dimension in raw.dimensions.values())
        assert set(CONTENT[kind]) <= set(raw.variables)
        for name, variable in raw.variables.items():
            assert not {"_FillValue", "scale_factor", "add_offset"} & set(variable.ncattrs()), name
            assert variable[...].shape == variable.shape
            if name in CONTENT[kind]:
                assert variable.dtype == CONTENT[kind][name][0], name


def test_values_survive(files):
    """Stuck, infinite, missing: as computed, to the bit."""
    system = fm.System(contact="joined-base-wall")
    config = fm.load_config(files / "tiny.toml")
    direct = fm.sweep(system, config.r, config.beta, config.mu, outputs=OUTPUTS)
    with xr.open_dataset(files / "map.nc") as ds:
        for name in direct.variables:
            np.testing.assert_array_equal(ds[name], direct[name], strict=True)
        assert np.isnan(ds.stops_per_cycle).any()


def test_kinds(opened, kind):
    assert reading.kind(opened) == kind


def test_read_holds_nothing_open(files, tmp_path, kind):
    path = tmp_path / "copy.nc"
    path.write_bytes((files / f"{kind}.nc").read_bytes())
    ds = reading.read(path)
    path.unlink()
    assert float(ds["beta_lim"].max()) > 0.0
    assert not any(target.startswith(str(path)) for target in open_files())


def open_files():
    """Paths of the files this process holds open, where the system lists them."""
    for entry in Path("/proc/self/fd").glob("*"):
        with contextlib.suppress(OSError):  # the descriptor of the listing itself
            yield os.readlink(entry)


@pytest.mark.parametrize("length", [0, 10, 1000, 5000, -1000, -1])
def test_a_truncated_file_is_refused(files, tmp_path, length):
    path = tmp_path / "cut.nc"
    path.write_bytes((files / "map.nc").read_bytes()[:length])
    with pytest.raises(InputError, match=r"^cannot read .*cut\.nc: it is damaged or not NetCDF"):
        reading.read(path)


def test_a_damaged_file_is_refused(tmp_path):
    """The beginning and the end are well, the data in the middle are not."""
    path = tmp_path / "damaged.nc"
    storage.write(fm.boundaries(fm.System(), np.linspace(0.0, 2.0, 20001)), path)
    content = bytearray(path.read_bytes())
    middle = len(content) // 2
    content[middle : middle + 1000] = bytes(1000)
    path.write_bytes(content)
    with pytest.raises(InputError, match=r"damaged\.nc: it is damaged or not NetCDF"):
        reading.read(path)


def test_writing_does_not_touch_the_dataset(tmp_path):
    tiny = fm.boundaries(fm.System(), [0.5, 2.0])
    before = tiny.copy(deep=True)
    storage.write(tiny, tmp_path / "out.nc", "a command")
    xr.testing.assert_identical(tiny, before)
    assert reading.read(tmp_path / "out.nc").attrs["history"].endswith("Z a command")
