"""What meets a user at a Python prompt: names, texts of settings, files, configurations."""

import subprocess
import sys

import numpy as np
import pytest
import xarray as xr

import frictionmap as fm
from frictionmap.files.storage import write

CONFIG = """
[system]
damping_ratios = 0.02
[solver]
cycles = 300
[grid]
r = [0.4, 0.8]
beta = [0.1, 0.5]
mu = [1.0, 1.2]
[curves]
quantities = ["energy"]
"""


@pytest.mark.parametrize(
    ("settings", "text"),
    [
        (fm.System(), "System()"),
        (
            fm.System("joined-base-wall", damping_ratios=0.1),
            "System(contact='joined-base-wall', damping_ratios=(0.1,))",
        ),
        (
            fm.System(mass_ratios=[1, 0.8], stiffness_ratios=[1, 1.2], contact_masses=[2], load_mass=2),
            "System(contact_masses=(2,), load_mass=2, mass_ratios=(1.0, 0.8), stiffness_ratios=(1.0, 1.2))",
        ),
        (
            fm.System(matrices={"M": np.eye(2), "K": np.diag([1.0, 2.0])}),
            "System(matrices=<2 by 2 matrices>)",
        ),
        (fm.Contact(masses=(2,), ratio=0.5), "Contact(masses=(2,), ratio=0.5)"),
        (fm.Solver(cycles=300), "Solver(cycles=300)"),
        (fm.Units(load="12.5 N"), "Units(load='12.5 N')"),
        (fm.PeriodicLoad({1: 1.0}), "PeriodicLoad(harmonics={1: 1.0})"),
    ],
)
def test_settings_show_what_was_given(settings, text):
    assert repr(settings) == text
    if "<" not in text:
        assert eval(text, {name: getattr(fm, name) for name in fm.__all__}) == settings


def test_only_own_names_are_listed():
    assert dir(fm) == sorted(fm.__all__)
    for room in (fm.design, fm.identify, fm.features, fm.regimes):
        assert dir(room) == sorted(room.__all__)
        assert "np" not in dir(room)


@pytest.mark.parametrize(
    "lines",
    [
        "import frictionmap as fm, xarray as xr",
        "import xarray as xr, frictionmap as fm",
        "import frictionmap as fm; fm.System(); import numpy; import xarray as xr",
        "import frictionmap; import xarray; import xarray.backends as b; xr = xarray",
    ],
)
def test_the_accessor_is_there_whatever_was_imported_first(tmp_path, lines):
    path = tmp_path / "map.nc"
    write(fm.sweep(fm.System(), r=[0.3], beta=[0.01]), path)
    found = subprocess.run(
        [sys.executable, "-c", f"{lines}; print(xr.open_dataset({str(path)!r}).frictionmap.labels.item())"],
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert found.stdout == "continuous\n", found.stderr


def test_xarray_is_not_loaded_by_the_package_alone():
    code = "import sys, frictionmap; print('xarray' in sys.modules)"
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert found.stdout == "False\n", found.stderr


def test_files_are_opened_as_they_were_computed(tmp_path):
    two = fm.System(
        mass_ratios=[1, 0.8], stiffness_ratios=[1, 1.2], damping_ratios=0.02,
        contacts=[{"masses": [1]}, {"masses": [2], "ratio": 0.5}],
    )  # fmt: skip
    units = fm.Units(natural_frequency="1 Hz", load="1 N")
    for name, ds in {
        "study": fm.sweep(fm.System(), [0.3, 0.5], [0.1, 0.5], axes={"damping_ratios": [0, 0.01]}),
        "contacts": fm.sweep(two, [0.5], [0.1, 0.4], units=units),
        "motion": fm.response(fm.System(), 0.3, 0.1),
        "curves": fm.curves(fm.System(), [0.3], [0.1]),
        "boundaries": fm.boundaries(fm.System(), [0.3, 0.5]),
    }.items():
        write(ds, tmp_path / f"{name}.nc")
        xr.testing.assert_identical(fm.open(tmp_path / f"{name}.nc"), ds)


@pytest.mark.parametrize(
    ("path", "message"),
    [
        ("missing.nc", "does not exist; give a file written by frictionmap"),
        ("map.toml", "it is a configuration; compute it first"),
        (3, "path must be the path of a file or store; got 3"),
    ],
)
def test_what_cannot_be_opened(tmp_path, monkeypatch, path, message):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "map.toml").write_text(CONFIG)
    with pytest.raises(fm.InputError, match=message):
        fm.open(path)


def test_a_configuration_takes_the_place_of_a_system_and_its_axes(tmp_path):
    path = tmp_path / "map.toml"
    path.write_text(CONFIG)
    config = fm.load_config(path)
    system, solver = fm.System(damping_ratios=0.02), fm.Solver(cycles=300)

    def same(one, other):
        """All but the time at which they were made."""
        xr.testing.assert_identical(one.assign_attrs(history=""), other.assign_attrs(history=""))

    same(fm.sweep(config), fm.sweep(system, [0.4, 0.8], [0.1, 0.5], [1.0, 1.2], solver=solver))
    same(
        fm.sweep(config, beta=[0.3], cycles=200), fm.sweep(system, [0.4, 0.8], [0.3], [1.0, 1.2], cycles=200)
    )
    same(
        fm.curves(config),
        fm.curves(system, [0.4, 0.8], [0.1, 0.5], [1.0, 1.2], solver=solver, quantities=["energy"]),
    )
    same(fm.boundaries(config), fm.boundaries(system, [0.4, 0.8], [1.0, 1.2]))


def test_further_axes_and_units_of_a_configuration_are_used(tmp_path):
    path = tmp_path / "map.toml"
    text = CONFIG.replace("r = [0.4, 0.8]", 'r = ["0.4 Hz", "0.8 Hz"]')
    path.write_text(text + '[units]\nnatural_frequency = "1 Hz"\n[axes]\ndamping_ratios = [0.0, 0.02]\n')
    ds = fm.sweep(fm.load_config(path))
    np.testing.assert_array_equal(ds.frequency, [0.4, 0.8])
    np.testing.assert_array_equal(ds.damping_ratios, [0.0, 0.02])


def test_a_system_needs_its_axes():
    with pytest.raises(fm.InputError, match=r"r must be given with a system, such as"):
        fm.sweep(fm.System())
    with pytest.raises(fm.InputError, match=r"beta must be given with a system"):
        fm.curves(fm.System(), [0.5])
    with pytest.raises(fm.InputError, match=r"system must be a frictionmap.System; got 3"):
        fm.sweep(3, [0.5], [0.1])
