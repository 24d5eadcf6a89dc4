"""The commands history and spectrum: their configurations, files, summaries, tables and pictures."""

import numpy as np
import pytest
import xarray as xr
from conftest import ROOT

import frictionmap as fm
from frictionmap.command_line.cli import main
from frictionmap.motions.bounds import interpolation_bounds

MOTIONS = ROOT / "configs" / "motions"
FEW = ["--quiet", "--set", "record.generate.count=2", "--set", "record.generate.duration=4 s"]

FRAME = """
[system]
mass_ratios = [1.0, 1.0]
stiffness_ratios = [1.0, 1.0]
excitation = "base"
damping_reference = "base"
[[system.contacts]]
kind = "joined-base-wall"
masses = [1]
[record]
pulse = { kind = "half-sine", amplitude = 1.0, duration = 3.0 }
[history]
beta = [0.2, 0.4]
"""


SPECTRA = """
[record]
pulse = { kind = "half-sine", amplitude = 1.0, duration = 3.0 }
[spectrum]
period = [1.0]
friction = [0.1]
"""


@pytest.fixture(autouse=True)
def _here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def test_history_of_a_suite(capsys):
    assert main(["history", str(MOTIONS / "brace-frame.toml"), *FEW]) == 0
    with xr.open_dataset("brace-frame-history.nc") as ds:
        assert ds.sizes["record"] == 2
        assert ds.sizes["contact"] == 2
        np.testing.assert_allclose(ds.amplitude_m, ds.amplitude / (2.0 * np.pi * 1.5) ** 2, rtol=1e-12)
        assert ds.end_time.attrs["units"] == "s"
        assert (ds.status == 0).all()
    assert main(["plot", "brace-frame-history.nc"]) == 0
    assert main(["info", "brace-frame-history.nc"]) == 0
    said = capsys.readouterr().out
    assert "omega_1/(2 pi) is 1.5 Hz" in said  # there is no r
    assert "r = 1" not in said
    assert main(["export", "brace-frame-history.nc", "-o", "suite.csv"]) == 0


def test_the_bound_of_the_interpolation_is_printed(capsys):
    few = ["--set", "record.generate.count=2", "--set", "record.generate.duration=4 s"]
    assert main(["history", str(MOTIONS / "brace-frame.toml"), *few, "--set", "record.scale=[0.5, 2.0]"]) == 0
    with xr.open_dataset("brace-frame-history.nc") as ds:
        most = ds.attrs["interpolation_bound"]
    assert f"no displacement by more than {1e3 * most:.4g} mm" in capsys.readouterr().out
    options = {"frequency": "2.5 Hz", "damping": 0.6, "peak": "0.4 g", "unit": "g", "count": 2}
    quakes = fm.Record.generate("kanai-tajimi", "4 s", "0.01 s", **options)
    frame = fm.System(
        mass_ratios=[1, 1], stiffness_ratios=[1, 1], damping_ratios=0.02, excitation="base",
        damping_reference="base", contacts=[fm.Contact("joined-base-wall", 1)],
    )  # fmt: skip
    units = fm.Units(natural_frequency="1.5 Hz", mass="20000 kg")
    bounds = [float(interpolation_bounds(frame, one, units=units).amplitude.max()) for one in quakes]
    assert most == pytest.approx(2.0 * max(bounds) / (2.0 * np.pi * 1.5) ** 2, rel=1e-12)


def test_one_motion_with_its_history(tmp_path):
    (tmp_path / "frame.toml").write_text(FRAME)
    assert main(["history", "frame.toml", "--quiet", "--set", "history.beta=0.2"]) == 0
    ds = fm.open("frame-history.nc")
    direct = fm.history(
        fm.System(
            mass_ratios=[1, 1], stiffness_ratios=[1, 1], excitation="base", damping_reference="base",
            contacts=[fm.Contact("joined-base-wall", 1)],
        ),
        fm.Record.pulse("half-sine", 1.0, 3.0), beta=0.2,
    )  # fmt: skip
    np.testing.assert_array_equal(ds.x, direct.x)
    assert ds.time.size > 2
    assert main(["export", "frame-history.nc", "-o", "motion.csv"]) == 0
    lines = (tmp_path / "motion.csv").read_text().splitlines()
    assert lines[0].startswith("time,x_1,x_2")
    assert len(lines) == ds.time.size + 1
    assert main(["plot", "frame-history.nc"]) == 0
    # goes on from the end of the first
    goes_on = ["--set", 'history.start="frame-history.nc"', "--set", "history.beta=0.2"]
    assert main(["history", "frame.toml", "--quiet", "-o", "on.nc", *goes_on]) == 0


def test_statistics_are_in_the_file_and_printed(tmp_path, capsys):
    shaken = FRAME.replace("pulse = { kind = \"half-sine\", amplitude = 1.0, duration = 3.0 }",
        "generate = { kind = \"white\", rms = 1.0, duration = 300.0, dt = 0.1 }")  # fmt: skip
    (tmp_path / "frame.toml").write_text(shaken)
    choice = ["--set", "history.beta=0.2", "--set", "history.samples=none"]
    assert main(["history", "frame.toml", *choice, "--set", "history.statistics={ start = 50.0 }"]) == 0
    ds = fm.open("frame-history.nc")
    assert "time" not in ds.dims
    values = zip(ds.x_variance.values.ravel(), ds.x_variance_error.values.ravel(), strict=True)
    words = ", ".join(f"{value:.4g} +- {error:.2g}" for value, error in values)
    for said in (capsys.readouterr().out, ds.frictionmap.summary()):
        assert f"variance of the displacement       {words}" in str(said)
    again = [*choice, "--overwrite", "--set", "history.statistics={ window = 200.0 }"]
    assert main(["history", "frame.toml", *again]) == 2
    assert "history.statistics.window must fit twice" in capsys.readouterr().err


def test_motions_along_further_axes(tmp_path, capsys):
    """Those of each system, and of a file the one that is chosen."""
    varied = "[axes]\ndamping_ratios = [0.0, 0.05]\njoint = { file = 'joint.csv' }\n"
    (tmp_path / "joint.csv").write_text("mass_ratios[2],stiffness_ratios[2]\n1.0,0.5\n2.0,1.0\n0.5,1.0\n")
    (tmp_path / "frame.toml").write_text(FRAME + varied)
    assert main(["history", "frame.toml"]) == 0
    assert "damping_ratios 0.05, joint 0, beta 0.4" in " ".join(capsys.readouterr().out.split())
    found = fm.open("frame-history.nc")
    assert found.x.dims == ("damping_ratios", "joint", "record", "scale", "mu", "beta", "dof", "time")
    np.testing.assert_array_equal(found.mass_ratios_2, [1.0, 2.0, 0.5])
    pulse = fm.Record.pulse("half-sine", 1.0, 3.0)
    for k, (mass, spring) in enumerate([(1.0, 0.5), (2.0, 1.0), (0.5, 1.0)]):
        system = fm.System(
            mass_ratios=[1, mass], stiffness_ratios=[1, spring], damping_ratios=0.05, excitation="base",
            damping_reference="base", contacts=[fm.Contact("joined-base-wall", 1)],
        )  # fmt: skip
        alone, part = fm.history(system, pulse, beta=[0.2, 0.4]), found.isel(damping_ratios=1, joint=k)
        for name in alone.data_vars:
            inside = {dim: slice(alone.sizes[dim]) for dim in ("time", "event") if dim in alone[name].dims}
            np.testing.assert_array_equal(part[name].isel(inside), alone[name], err_msg=name)
            beyond = {dim: slice(alone.sizes[dim], None) for dim in inside}
            rest = part[name].isel(beyond).values
            assert not inside or (np.isnan(rest).all() if rest.dtype.kind == "f" else (rest <= 0).all())
    assert main(["plot", "frame-history.nc"]) == 2
    assert "--at damping_ratios=0.0 --at joint=0 or ds.sel(" in capsys.readouterr().err
    one = ["--at", "damping_ratios=0.05", "--at", "mass_ratios_2=2.0"]
    assert main(["plot", "frame-history.nc", *one]) == 0
    assert main(["export", "frame-history.nc", "-o", "all.csv"]) == 0
    assert (tmp_path / "all.csv").read_text().startswith("damping_ratios,joint,record,")
    assert main(["explore", "frame.toml"]) == 2
    assert "cannot open a page of motions with [axes]" in capsys.readouterr().err


def test_spectra_along_further_axes(tmp_path, capsys):
    pulse = "[record]\npulse = { kind = 'half-sine', amplitude = 1.0, duration = 3.0 }\n"
    text = (
        pulse
        + "[spectrum]\nperiod = [1.0, 4.0]\nfriction = [0.1, 0.2]\n[axes]\ndamping_ratios = [0.0, 0.05]\n"
    )
    (tmp_path / "s.toml").write_text(text)
    assert main(["spectrum", "s.toml"]) == 0
    found, record = fm.open("s-spectrum.nc"), fm.Record.pulse("half-sine", 1.0, 3.0)
    for damping in (0.0, 0.05):
        alone = fm.spectrum(record, [1.0, 4.0], [0.1, 0.2], damping=damping)
        for name in alone.data_vars:
            np.testing.assert_array_equal(found[name].sel(damping_ratios=damping), alone[name])
    assert main(["plot", "s-spectrum.nc", "--at", "damping_ratios=0.05"]) == 0
    soft = fm.spectrum(record, 4.0, 0.1, axes={"contact_stiffness": [3.0, 30.0]})
    assert soft.amplitude.dims[0] == "contact_stiffness"
    capsys.readouterr()
    refused = {
        ("-o", "s.zarr"): "cannot write spectra along [axes] into s.zarr",
        (
            "-o",
            "t.nc",
            "--set",
            "axes.load_mass=[1, 2]",
        ): "axes must be one of damping_ratios, contact_stiffness",
    }
    for more, said in refused.items():
        assert main(["spectrum", "s.toml", *more]) == 2
        assert said in capsys.readouterr().err
    with pytest.raises(fm.InputError, match="cannot use axes with store"):
        fm.spectrum(record, 4.0, 0.1, axes={"damping_ratios": [0.1]}, store="s.zarr")
    with pytest.raises(fm.InputError, match="cannot name a further axis period"):
        fm.history(fm.System(), record, axes={"period": {"damping_ratios": [0.1, 0.2]}})


def test_spectra_of_a_suite():
    few = ["--set", "spectrum.period.num=5"]
    assert main(["spectrum", str(MOTIONS / "spectra.toml"), *FEW, *few]) == 0
    with xr.open_dataset("spectra-spectrum.nc") as ds:
        assert dict(ds.amplitude.sizes) == {"record": 2, "scale": 1, "mu": 1, "period": 5, "beta": 3}
        np.testing.assert_allclose(ds.period[[0, -1]], [0.05, 4.0], rtol=1e-12)
        np.testing.assert_allclose(ds.beta, 9.80665 * np.array([0.02, 0.05, 0.1]), rtol=1e-12)
    assert main(["plot", "spectra-spectrum.nc"]) == 0
    assert main(["info", "spectra-spectrum.nc"]) == 0


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ("history.beta=[0.4,0.2]", "history.beta must increase; got [0.4, 0.2]"),
        ("history.samples=often", "history.samples must be one of all, none; got 'often'"),
        ("record.after=-1", "record.after must be >= 0; got -1"),
        ("history.betas=1", "unknown key 'history.betas' (did you mean beta?); valid: beta, friction, mu, "),
        (
            "record.unit=g",
            "cannot convert seconds to ratios: a reference value is missing; give units.natural_f",
        ),
        ("history.start=none.nc", "none.nc"),
    ],
)
def test_a_mistake_is_refused_in_one_line(tmp_path, capsys, change, message):
    (tmp_path / "frame.toml").write_text(FRAME)
    assert main(["history", "frame.toml", "--set", change]) == 2
    said = capsys.readouterr().err
    assert message in said
    assert len(said.strip().splitlines()) == 1


def test_spectra_are_of_one_mass(tmp_path, capsys):
    (tmp_path / "frame.toml").write_text(FRAME + "[spectrum]\nperiod = [1.0]\nfriction = [0.1]\n")
    assert main(["spectrum", "frame.toml"]) == 2
    assert "spectra of 2 masses" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ("spectrum.period=-1 s", "spectrum.period must be > 0; got -1"),
        ("spectrum.period=[0.0, 1.0]", "spectrum.period must be > 0; got 0"),
        (
            'spectrum.period={ start = "0 s", stop = "2 s", num = 3 }',
            "spectrum.period.start must be > 0; got 0",
        ),
        (
            "spectrum.friction=0.1",
            'spectrum.friction must have a unit, such as "0.05 g", because the records have one; got 0.1',
        ),
    ],
)
def test_mistakes_in_spectra_are_refused_with_what_is_valid(capsys, change, message):
    assert main(["spectrum", str(MOTIONS / "spectra.toml"), *FEW, "--set", change]) == 2
    assert message in capsys.readouterr().err


WALLS = {
    "wall_speed = '0.1 m/s'\n":
        "system.wall_speed must be 0 for joined-base-wall, which has no wall of its own; got '0.1 m/s'",
    "[[system.contacts]]\nkind = 'between-masses'\nmasses = [1, 2]\nwall_velocity = '0.1 m/s'\n":
        "system.contacts[1].wall_velocity must be 0 for between-masses, which has no wall",
    "normal_load = [{ n = 1, amplitude = '0.5 N' }]\n":
        "system.normal_load[0].amplitude must be a ratio to the mean normal load, without a unit; got '0.5",
}  # fmt: skip


@pytest.mark.parametrize("given", WALLS)
def test_the_first_remedy_is_the_last(tmp_path, capsys, given):
    """A wall that a contact does not have is refused before a reference value is asked for."""
    record = "[record]\npulse = { kind = 'half-sine', amplitude = 1.0, duration = 3.0 }\n"
    contact = "contact = 'joined-base-wall'\n" if given.startswith("wall") else ""
    (tmp_path / "wall.toml").write_text(f"[system]\n{contact}{given}{record}")
    assert main(["history", "wall.toml"]) == 2
    assert WALLS[given] in capsys.readouterr().err


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("law", "{ speed = [0.0, 0.5], factor = [1.0, 0.7] }"),
        ("wall_speed", "0.3"),
        ("normal_load", "[{ n = 1, re = 0.5 }]"),
    ],
)
def test_spectra_do_not_leave_out_what_the_contact_has(tmp_path, capsys, key, value):
    text = f"[system]\n[[system.contacts]]\n{key} = {value}\n" + SPECTRA
    (tmp_path / "one.toml").write_text(text)
    assert main(["spectrum", "one.toml"]) == 2
    assert f"cannot compute spectra of a contact with {key}" in capsys.readouterr().err


def test_what_a_motion_is_under_is_refused_by_steady_states():
    moving = fm.Record([0.0, 0.1, 0.0], 1.0, quantity="force")
    system = fm.System(contacts=[fm.Contact("fixed-wall", 1, normal_record=moving)])
    with pytest.raises(fm.InputError, match="normal_record under a periodic load"):
        fm.sweep(system, [0.5], [0.2])
    low = fm.Record([0.0, -1.2, 0.0], 1.0, quantity="force")
    lifted = fm.System(contacts=[fm.Contact("fixed-wall", 1, normal_record=low)])
    with pytest.raises(fm.InputError, match="must leave 1 \\+ its value >= 0"):
        fm.history(lifted, moving)
