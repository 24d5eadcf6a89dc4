"""Response curves as datasets and files: contents, requested quantities, refusals."""

import numpy as np
import pytest
import xarray as xr

import frictionmap as fm
from frictionmap import InputError
from frictionmap.command_line.cli import main

TWO = fm.System("between-masses", [1, 2], mass_ratios=[1.0, 0.5], stiffness_ratios=[1.0, 2.0])
CELL, MASS, LIMIT = ("mu", "r", "beta"), ("mu", "r", "beta", "dof"), ("mu", "r", "dof")
ALWAYS = {
    **dict.fromkeys(("regime", "stops_per_cycle", "period", "status"), CELL),
    **dict.fromkeys(("beta_lim", "beta_stick"), ("mu", "r")),
    **dict.fromkeys(("held_response", "held_phase"), ("r", "dof")),
    **dict.fromkeys(("limit_amplitude", "limit_phase"), LIMIT),
    **dict.fromkeys(("limit_first_harmonic_amplitude", "limit_first_harmonic_phase"), LIMIT),
}
QUANTITIES = {
    "amplitude": {"amplitude": MASS, "contact_amplitude": CELL},
    "phase": {
        **dict.fromkeys(("phase_lag", "phase", "phase_begin", "phase_end"), MASS),
        **dict.fromkeys(("contact_phase", "contact_phase_begin", "contact_phase_end"), CELL),
    },
    "first_harmonic": {
        **dict.fromkeys(("first_harmonic_amplitude", "first_harmonic_phase"), MASS),
        **dict.fromkeys(("contact_first_harmonic_amplitude", "contact_first_harmonic_phase"), CELL),
    },
    "energy": dict.fromkeys(
        ("sliding_distance", "work_friction", "work_input", "work_damping", "equivalent_damping"), CELL
    ),
    "harmonics": {
        "displacement_harmonic": (*MASS, "harmonic", "part"),
        "contact_harmonic": (*CELL, "harmonic", "part"),
        "friction_harmonic": (*CELL, "harmonic", "part"),
    },
    "transmitted_force": dict.fromkeys(("transmitted_force", "transmitted_first_harmonic"), CELL),
    "distortion": dict.fromkeys(("rms", "distortion"), MASS),
}
CONFIG = """
[system]
contact = "joined-base-wall"
[grid]
r = { start = 0.0, stop = 2.0, step = 0.5 }
beta = [0.0, 0.2, 3.0]
mu = [1.0, 1.5]
"""


def dims(ds):
    return {name: variable.dims for name, variable in ds.data_vars.items()}


@pytest.mark.parametrize("quantity", QUANTITIES)
def test_nothing_is_held_that_was_not_asked_for(quantity):
    ds = fm.curves(TWO, [0.4, 0.9], [0.1, 0.3], quantities=[quantity])
    assert dims(ds) == ALWAYS | QUANTITIES[quantity]
    for name, variable in ds.variables.items():
        assert variable.attrs["long_name"], name
        angle = name.endswith(("phase", "phase_lag", "phase_begin", "phase_end"))
        assert variable.attrs.get("units", "1") == ("radian" if angle else "1"), name


@pytest.mark.parametrize(
    ("settings", "highest"),
    [
        ({}, 7),
        ({"harmonics": 0}, 0),
        ({"harmonics": 3}, 3),
        ({"quantities": ["amplitude"]}, 0),
        ({"quantities": ["amplitude"], "harmonics": 2}, 2),
        ({"quantities": ["harmonics"]}, 7),
        ({"quantities": ["harmonics", "phase"], "harmonics": 1}, 1),
    ],
)
def test_how_many_harmonics_are_held(settings, highest):
    ds = fm.curves(fm.System(), 0.9, 0.2, **settings)
    assert ("displacement_harmonic" in ds) == (highest > 0)
    if highest:
        np.testing.assert_array_equal(ds.harmonic, np.arange(highest + 1))
        assert ds.part.values.tolist() == ["real", "imaginary"]


def test_more_harmonics_leave_the_others_as_they_are():
    few, many = (fm.curves(TWO, [0.3, 0.8], [0.1, 0.4], harmonics=n) for n in (2, 40))
    np.testing.assert_array_equal(
        few.displacement_harmonic, many.displacement_harmonic.isel(harmonic=slice(3))
    )


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"harmonics": 2.5}, "harmonics must be a whole number; got 2.5"),
        ({"quantities": "phase"}, "quantities must be a list of names; got 'phase'"),
    ],
)
def test_what_makes_no_sense_is_refused(settings, words):
    with pytest.raises(InputError, match=words) as caught:
        fm.curves(fm.System(), [0.5], [0.2], **settings)
    assert "\n" not in str(caught.value)


# The command


@pytest.fixture
def config(tmp_path):
    path = tmp_path / "tiny.toml"
    path.write_text(CONFIG)
    return path


def test_the_command_writes_what_python_computes(config, tmp_path, capsys):
    text = CONFIG + '[curves]\nharmonics = 2\nquantities = ["amplitude", "energy"]\n'
    config.write_text(text)
    assert main(["curves", str(config), "-o", str(tmp_path / "out.nc"), "--threads", "2"]) == 0
    assert "6 response curves, 5 points each (" in capsys.readouterr().out
    expected = fm.curves(
        fm.System("joined-base-wall"), np.arange(5) / 2.0, [0.0, 0.2, 3.0], [1.0, 1.5], harmonics=2,
        quantities=["amplitude", "energy"],
    )  # fmt: skip
    with xr.open_dataset(tmp_path / "out.nc") as ds:
        assert dims(ds) == dims(expected)
        for name in expected.variables:
            np.testing.assert_array_equal(ds[name], expected[name], name)
        assert ds.attrs["config"] == text


def test_a_summary_of_a_file_fits_on_one_screen(config, tmp_path, capsys):
    out = tmp_path / "out.nc"
    assert main(["curves", str(config), "-o", str(out), "--quiet"]) == 0
    assert capsys.readouterr().out == ""
    assert main(["info", str(out)]) == 0
    shown = capsys.readouterr().out
    assert "[curves]" in shown
    assert "first_harmonic_phase" in shown
    assert "\n6 response curves, 5 points each (" in shown
    assert "\npoints by stops per cycle  " in shown
    assert " cells" not in shown


def test_overrides_and_the_name_of_the_file(config, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    arguments = ["curves", str(config), "--set", "curves.harmonics=1", "--quiet"]
    assert main(arguments) == 0
    with xr.open_dataset(tmp_path / "tiny-curves.nc") as ds:
        assert ds.sizes["harmonic"] == 2
    assert main(arguments) == 2  # it is there
    assert main([*arguments, "--overwrite"]) == 0


@pytest.mark.parametrize(
    ("key", "words"),
    [
        ("curves=1", "curves must be a table [curves]; got 1"),
    ],
)
def test_a_configuration_at_fault_is_one_line(config, capsys, key, words):
    assert main(["curves", str(config), "--set", key]) == 2
    shown = capsys.readouterr()
    assert words in shown.err
    assert len(shown.err.splitlines()) == 1
    assert shown.out == ""


def test_datasets_carry_the_configuration_that_makes_them_again(tmp_path):
    ds = fm.curves(TWO, [0.4, 0.9], [0.1, 0.3], 1.2, quantities=["phase"], harmonics=3, start="moving")
    path = tmp_path / "again.toml"
    path.write_text(ds.attrs["config"])
    config = fm.load_config(path)
    again = fm.curves(
        config.system, config.r, config.beta, config.mu, harmonics=config.curves.harmonics,
        quantities=config.curves.quantities, solver=config.solver,
    )  # fmt: skip
    for name in ds.variables:
        np.testing.assert_array_equal(again[name], ds[name], name)
