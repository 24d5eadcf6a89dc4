"""Datasets made in Python say how: a history, and a configuration that makes them again to the bit."""

import tomllib
from datetime import datetime

import numpy as np
import pytest
import xarray as xr

import frictionmap as fm
from frictionmap import InputError
from frictionmap.files.reading import read
from frictionmap.files.storage import write
from frictionmap.files.stored import stored_system

M = np.array([[2.0, 0.1], [0.1, 1.0 / 3.0]])
K = np.array([[3.0, -1.0], [-1.0, 1.1]])
SYSTEMS = {
    "one mass": fm.System(),
    "joined": fm.System(contact="joined-base-wall", damping_ratios=0.1),
    "base": fm.System(excitation="base", damping_reference="base", damping_ratios=0.05),
    "chain": fm.System("between-masses", (1, 3), 2, [1, 0.5, 0.1 + 0.2], [1, 2, 1 / 3], [0.0, 0.01, 0.02]),
    "loads": fm.System(mass_ratios=[1, 1], stiffness_ratios=[1, 1], load=[1.0, complex(-1.0, -0.0)]),
    "phased": fm.System(mass_ratios=[1, 1], stiffness_ratios=[1, 1], load=[0.5 + 0.25j, -2]),
    "matrices": fm.System(matrices={"M": M, "K": K}, frequency_scale=1.1, stiffness_scale=1.7),
    "rayleigh": fm.System(matrices={"M": M, "K": K, "C": 0.01 * M + 0.02 * K}, contact_masses=(2,)),
}


@pytest.fixture(params=SYSTEMS)
def system(request):
    return SYSTEMS[request.param]


def reload(ds, folder):
    """The configuration that a dataset carries, as a file would be read."""
    (folder / "again.toml").write_text(ds.attrs["config"], encoding="utf-8")
    return fm.load_config(folder / "again.toml")


def test_the_configuration_gives_the_same_system(system, tmp_path):
    ds = fm.boundaries(system, np.linspace(0.1, 3.0, 30), [1.0, 1.1])
    config = reload(ds, tmp_path)
    assert config.system == system
    assert config.title == ds.attrs["title"]
    # to the bit, also signs of zero that equality does not see
    again = fm.boundaries(config.system, config.r, config.mu)
    xr.testing.assert_identical(again.drop_attrs(), ds.drop_attrs())


def test_the_system_of_a_file(system, tmp_path):
    write(fm.boundaries(system, [0.5, 1.5]), tmp_path / "b.nc")
    assert stored_system(read(tmp_path / "b.nc")) == system


AXES = {
    "even": (np.linspace(0.2, 2.4, 23), np.linspace(0.0, 1.3, 7), [1.0]),
    "by steps": (np.arange(1, 20) * 0.1, np.arange(5) * 0.3, [1.0, 1.5]),
    "uneven": (np.sqrt([0.1, 0.2, 0.5, 2.0, 3.0]), [0.1 + 0.2], 1.0 + 1e-12),
}


@pytest.mark.parametrize("axes", AXES)
def test_the_configuration_makes_the_same_map(axes, tmp_path):
    settings = {
        "start": "moving",
        "cycles": 500,
        "tolerance": 1e-11,
        "outputs": ["regime", "period", "cycles"],
    }
    ds = fm.sweep(fm.System(), *AXES[axes], **settings)
    config = reload(ds, tmp_path)
    assert config.solver == fm.Solver(**settings)
    for name in ("r", "beta", "mu"):
        np.testing.assert_array_equal(getattr(config, name), ds[name], strict=False)
    again = fm.sweep(config.system, config.r, config.beta, config.mu, solver=config.solver)
    xr.testing.assert_identical(again.drop_attrs(), ds.drop_attrs())


def test_settings_as_numbers_of_numpy_are_plain_numbers_in_the_configuration(tmp_path):
    given = fm.Solver(cycles=np.int64(1500), tolerance=np.float64(1e-11), steps=np.int32(20))
    ds = fm.sweep(fm.System(), [0.5], [0.1], solver=given)
    assert reload(ds, tmp_path).solver == fm.Solver(cycles=1500, tolerance=1e-11, steps=20)


def test_a_response_is_of_its_cell(tmp_path):
    config = reload(fm.response(fm.System(), 0.3, 0.5, 1.2, start="moving"), tmp_path)
    assert (config.r, config.beta, config.mu) == (0.3, 0.5, 1.2)
    assert config.solver == fm.Solver(start="moving")


def test_histories_state_time_and_command():
    made = {
        "sweep": fm.sweep(fm.System(), np.linspace(0.6, 2.0, 8), [0.1, 0.2], 1.5),
        "boundaries": fm.boundaries(fm.System(), [0.6, 0.7]),
        "response": fm.response(fm.System(), 0.7, 0.2),
    }
    for function, ds in made.items():
        time, _, words = ds.attrs["history"].partition(" ")
        assert datetime.fromisoformat(time).tzinfo is not None
        assert words.startswith(f"frictionmap.{function} of fixed-wall, r = 0.")
    assert made["sweep"].attrs["history"].endswith("r = 0.6 to 2 (8 values), beta = 0.1, 0.2, mu = 1.5")


def test_writing_keeps_the_history(tmp_path):
    ds = fm.boundaries(fm.System(), [0.6, 0.7])
    write(ds, tmp_path / "b.nc")
    assert read(tmp_path / "b.nc").attrs == ds.attrs


def test_what_is_too_large_for_text_is_a_comment(tmp_path):
    n = 65
    large = fm.System(matrices={"M": np.eye(n), "K": 2.0 * np.eye(n) - np.eye(n, k=1) - np.eye(n, k=-1)})
    for system, r, comment in (
        (large, [0.5, 2.0], "\n# matrices = 65 by 65, too large"),
        (
            fm.System(), np.geomspace(0.1, 10.0, 10_001),
            "\n# r = 10001 values from 0.1 to 10.0, those of the axis r\n",
        ),
    ):  # fmt: skip
        ds = fm.boundaries(system, r)
        config = ds.attrs["config"]
        assert comment in config
        assert len(config) < 1000
        assert (stored_system(ds) is None) == (system is large)
        assert tomllib.loads(config)["system"]["contact"] == "fixed-wall"
        write(ds, tmp_path / "b.nc")
        assert read(tmp_path / "b.nc").attrs == ds.attrs


def test_the_largest_texts_go_through_a_file(tmp_path):
    """Beyond the 64 kB that an attribute of HDF5 holds in its usual place."""
    rng = np.random.default_rng(0)
    n = 64
    spread = rng.random((n, n))
    system = fm.System(matrices={"M": np.eye(n), "K": n * np.eye(n) + spread + spread.T})
    ds = fm.boundaries(system, np.sort(rng.random(300) + 0.5))
    assert len(ds.attrs["config"]) > 80_000
    write(ds, tmp_path / "b.nc")
    again = read(tmp_path / "b.nc")
    assert again.attrs == ds.attrs
    assert stored_system(again) == system


@pytest.mark.parametrize(
    "text",
    [
        "",
        "no toml",
        "[grid]\nr = 1",
        '[system]\ncontact = "nowhere"',
        '[system]\nmatrices = "frame.npz"',
        "system = 3",
    ],
)
def test_no_system_in_the_text(text):
    ds = fm.boundaries(fm.System(), [0.5]).assign_attrs(config=text)
    assert stored_system(ds) is None
    assert stored_system(ds.drop_attrs()) is None


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        ('load = [[1.0, "x"]]', r"system.load\[0\] must be a number; got 'x'"),
        ("load = 3", r"system.load must be a list of numbers; got 3"),
    ],
)
def test_loads_and_matrices_in_a_configuration_are_checked(lines, message, tmp_path):
    path = tmp_path / "c.toml"
    path.write_text(f'[system]\ncontact = "fixed-wall"\n{lines}\n[grid]\nr = 1\nbeta = 1\n')
    with pytest.raises(InputError, match=message):
        fm.load_config(path)
