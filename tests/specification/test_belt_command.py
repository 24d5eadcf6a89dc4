"""Commands on a grid of belt speeds without a load: map, boundaries, info, export, plot; refusals by name."""

import csv

import matplotlib.image
import numpy as np
import pytest

import frictionmap as fm
from frictionmap.command_line.cli import main
from frictionmap.files.reading import read

TEXT = """
title = "A brake pad"
[system]
damping_ratios = 0.03
[[system.contacts]]
kind = "fixed-wall"
masses = [1]
law = { speed = [0.0, 0.2, 0.6, 1.2], factor = [1.0, 0.8, 0.7, 0.68], slope = 0.08 }
[units]
natural_frequency = "50 Hz"
load = "10 N"
stiffness = "100 N/mm"
[grid]
wall_speed = { start = "10 mm/s", stop = "40 mm/s", num = 4 }
beta = ["5 N", "10 N"]
"""

#: omega_1 P/k_1 [m/s].
UNIT = 2.0 * np.pi * 50.0 * 1e-4


@pytest.fixture
def config(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "pad.toml").write_text(TEXT)
    return "pad.toml"


def refused(capsys, *arguments):
    """The message of a command that ends with status 2."""
    assert main([*arguments]) == 2
    return capsys.readouterr().err


def test_map_info_export_plot(config, capsys):
    assert main(["map", config]) == 0
    said = capsys.readouterr().out
    assert said.startswith("8 cells (")
    assert "belt speed above which there is no stick-slip cycle" in said
    ds = fm.open("pad.nc")
    assert ds.regime.dims == ("mu", "wall_speed", "beta")
    assert ds.wall_speed.values * UNIT == pytest.approx([0.01, 0.02, 0.03, 0.04], rel=1e-15)
    assert ds.wall_speed_m_s.values.tolist() == [0.01, 0.02, 0.03, 0.04]
    assert ds.friction_force.values.tolist() == [5.0, 10.0]
    assert ds.x_max_m.values == pytest.approx(ds.x_max.values * 1e-4, rel=1e-15)
    assert ds.cycle_period_s.values == pytest.approx(ds.cycle_period.values / (100.0 * np.pi), nan_ok=True)
    assert ds.attrs["title"] == "A brake pad"
    assert "no load" in ds.attrs["system"]
    assert ds.attrs["config"] == TEXT
    assert main(["info", "pad.nc"]) == 0
    said = capsys.readouterr().out
    assert "[belt]" in said
    assert "growth rate of small vibrations" not in said
    assert main(["info", "pad.nc", "--verbose"]) == 0
    assert "growth rate of small vibrations" in capsys.readouterr().out
    assert main(["info", "--json", "pad.nc"]) == 0
    assert '"stick_slip_cycle"' in capsys.readouterr().out
    assert main(["export", "pad.nc"]) == 0
    with open("pad.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 8
    assert {row["regime"] for row in rows} <= {"steady_sliding", "stick_slip_cycle", "cycle_without_stops"}
    assert float(rows[0]["x_max_1_m"]) == ds.x_max_m.values[0, 0, 0, 0]
    assert float(rows[0]["wall_speed_m_s"]) == ds.wall_speed_m_s.values[0]
    assert main(["export", "pad.nc", "--all", "-o", "all.csv"]) == 0
    with open("all.csv", newline="") as file:
        assert float(next(csv.DictReader(file))["x_max_1"]) == ds.x_max.values[0, 0, 0, 0]
    assert main(["plot", "pad.nc"]) == 0
    assert matplotlib.image.imread("pad.png").ndim == 3


def test_a_file_reproduces_itself(config, tmp_path):
    ds = fm.sweep(fm.load_config(config))
    (tmp_path / "again.toml").write_text(ds.attrs["config"])
    again = fm.sweep(fm.load_config("again.toml"))
    assert ds.drop_attrs().equals(again.drop_attrs())


def test_boundaries(config, capsys):
    assert main(["boundaries", config]) == 0
    ds = fm.open("pad-boundaries.nc")
    assert "regime" not in ds
    assert ds.cycle_speed_lim.dims == ("mu", "beta")
    assert float(ds.cycle_speed_lim[0, 1]) == pytest.approx(1.124273429839, rel=1e-11)
    assert float(ds.cycle_speed_lim_m_s[0, 1]) == pytest.approx(1.124273429839 * UNIT, rel=1e-11)
    assert "shows regimes" in refused(capsys, "plot", "pad-boundaries.nc", "-o", "b.png")


def test_the_picture_shows_every_regime_in_its_colour():
    """White and light yellow as regimes under loads that do the same, olive as no number of stops has."""
    from frictionmap.pictures.grids import Grid
    from frictionmap.pictures.maps.belt_map import BeltImage

    law = {"speed": [0.0, 0.5], "factor": [1.0, 0.7], "slope": 0.1}
    system = fm.System(damping_ratios=0.05, contacts=[fm.Contact(law=law)])
    ds = fm.sweep(system, wall_speed=[0.1, 0.45, 0.49, 1.5], beta=[0.2, 0.5])
    image = BeltImage(Grid(ds.wall_speed.values), Grid(ds.beta.values), ds.isel(mu=0))
    assert fm.regimes.STICK_SLIP_CYCLE in ds.regime.values
    table = {4: (255, 255, 255), 5: (255, 221, 124), 6: (140, 159, 90)}
    pixels = image.image((np.arange(5.0) * 10.0, np.arange(3.0) * 10.0), (40, 20), 1e9)
    for (_, i, b), code in np.ndenumerate(ds.regime.values):
        if not image.several[i, b]:
            assert tuple(pixels[10 * b + 5, 10 * i + 5, :3]) == table[code]


@pytest.mark.parametrize(
    ("change", "named"),
    [
        ("grid.r=[0.5]", "grid.r"),
        ("solver.cycles=10", "[solver]"),
        ("curves.harmonics=3", "[curves]"),
        ("axes.damping_ratios=[0.1]", "[axes]"),
        ("system.load_harmonics=[{ n = 1, mass = 1, amplitude = 1.0 }]", "system.load_harmonics"),
        ("system.waveform=square", "system.waveform"),
        ("grid.wall_speed=[0.0, 1.0]", "grid.wall_speed"),
        ("grid.wall_speed=[0.5, 0.4]", "grid.wall_speed"),
        ("grid.wall_speed=['1 Hz']", "grid.wall_speed"),
        ("grid.wall_speed=[]", "grid.wall_speed"),
    ],
)
def test_keys_without_meaning_are_refused_by_name(config, capsys, change, named):
    assert named in refused(capsys, "map", config, "--set", change)


@pytest.mark.parametrize(
    "command",
    [
        ("curves",),
        ("response", "--r", "0.5", "--beta", "0.3"),
        ("map", "-o", "pad.zarr"),
        ("reduce",),
    ],
)
def test_commands_under_loads_are_refused(config, capsys, command):
    assert "wall_speed" in refused(capsys, command[0], config, *command[1:])


def test_a_belt_speed_may_be_a_further_axis_under_a_load():
    system = fm.System(damping_ratios=0.03, wall_speed=0.1)
    ds = fm.sweep(system, r=[0.5], beta=[0.3], axes={"wall_speed": [0.1, 0.4]})
    assert ds.regime.dims == ("wall_speed", "mu", "r", "beta")
    one = fm.sweep(fm.System(damping_ratios=0.03, wall_speed=0.4), r=[0.5], beta=[0.3])
    assert ds.contact_amplitude.values[1] == one.contact_amplitude.values


def test_names_of_the_regimes():
    ds = fm.sweep(fm.System(damping_ratios=0.03), wall_speed=[0.5], beta=[0.5], mu=[1.0, 3.0])
    assert ds.frictionmap.labels.values.ravel().tolist() == ["steady-sliding", "stick-slip-cycle"]
    assert [fm.regimes.regime_name(code) for code in (4, 5, 6)] == [
        "steady_sliding", "stick_slip_cycle", "cycle_without_stops",
    ]  # fmt: skip


def test_response(config, capsys):
    """One cycle of a mass: it sticks at the speed of the belt and slips back."""
    arguments = ["response", config, "--wall-speed", "10 mm/s", "--beta", "10 N"]
    assert main(arguments) == 0
    assert capsys.readouterr().out.startswith("stick slip cycle, period ")
    ds = fm.open("pad-response.nc")
    cell = fm.sweep(fm.load_config(config)).sel(beta=1.0).isel(mu=0, wall_speed=0)
    for name in ("cycle_period", "stuck_fraction", "stops_per_cycle", "x_max", "x_min", "growth"):
        assert ds[name].values == pytest.approx(cell[name].values, rel=1e-11), name
    assert float(ds.time[-1]) == float(ds.cycle_period)
    assert ds.x_m.values[0, -1] == pytest.approx(ds.x_m.values[0, 0], rel=1e-11)
    assert ds.x.values.max() == pytest.approx(float(ds.x_max[0]), abs=1e-6)
    sticks = ds.direction.values == 0
    assert sticks.mean() == pytest.approx(float(ds.stuck_fraction), abs=1e-3)
    assert ds.v_m_s.values[0, sticks] == pytest.approx(0.01, rel=1e-11)
    slope = np.gradient(ds.x.values[0], ds.time.values)
    assert np.abs(slope - ds.v.values[0])[2:-2].max() < 1e-2
    law = fm.FrictionLaw([0.0, 0.2, 0.6, 1.2], [1.0, 0.8, 0.7, 0.68], 0.08)
    over = ds.v.values[0] - 0.01 / UNIT
    slides = ~sticks & (np.abs(over) > 1e-9)
    expected = np.sign(over[slides]) * law(np.abs(over[slides]))
    assert ds.friction.values[slides] == pytest.approx(expected, rel=1e-9)
    for command in (["plot", "pad-response.nc"], ["info", "pad-response.nc"], ["export", "pad-response.nc"]):
        assert main(command) == 0
    assert matplotlib.image.imread("pad-response.png").ndim == 3
    with open("pad-response.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 2000
    assert [name for name in rows[0] if name[:8] != "normal_f"] == ["time_s", "x_1_m", "z_m", "friction_N"]
    assert float(rows[7]["x_1_m"]) == float(ds.x_m[0, 7])


def test_works_of_a_cycle_balance():
    """Per cycle the belt does what friction and dashpots take."""
    law = {"speed": [0.0, 0.3, 0.8], "factor": [1.0, 0.75, 0.65], "slope": 0.05}
    system = fm.System(
        mass_ratios=[1, 1.5], stiffness_ratios=[1, 0.8], damping_ratios=0.03,
        contacts=[fm.Contact(masses=[2], law=law)],
    )  # fmt: skip
    ds = fm.response(system, wall_speed=0.3, beta=0.6, points=40001)
    assert ds.x.dims == ("dof", "time")
    force, time = ds.friction.values, ds.time.values
    belt = np.trapezoid(-force * 0.3, time)
    friction = np.trapezoid(force * (ds.v.values[1] - 0.3), time)
    damping = np.trapezoid(np.einsum("it,ij,jt->t", ds.v, system.modes.damping, ds.v), time)
    assert belt == pytest.approx(friction + damping, rel=1e-4)  # one jump of the force between samples
    assert friction > 0.0
    assert damping > 0.0


def test_steady_sliding_and_a_large_motion_in_time():
    law = {"speed": [0.0, 0.2, 0.6, 1.2], "factor": [1.0, 0.8, 0.7, 0.68], "slope": 0.08}
    system = fm.System(damping_ratios=0.03, contacts=[fm.Contact(law=law)])
    still = fm.response(system, wall_speed=1.3, beta=1.0, points=50)
    assert int(still.regime) == fm.regimes.STEADY_SLIDING
    assert still.x.values == pytest.approx(0.68 + 0.08 * 0.1, rel=1e-12)
    assert still.friction.values == pytest.approx(-(0.68 + 0.08 * 0.1), rel=1e-12)
    moving = fm.response(system, wall_speed=0.7, beta=1.0, points=50, start="moving")
    assert int(moving.regime) == fm.regimes.STICK_SLIP_CYCLE


def test_arguments_of_responses_without_a_load():
    system = fm.System(damping_ratios=0.03)
    with pytest.raises(fm.InputError, match=r"^r must be given"):
        fm.response(system, beta=0.5)
    with pytest.raises(fm.InputError, match=r"^beta must be given"):
        fm.response(system, wall_speed=0.5)
    with pytest.raises(fm.InputError, match="cannot use r with wall_speed"):
        fm.response(system, 0.5, 0.5, wall_speed=0.5)
    with pytest.raises(fm.InputError, match="cannot use cycles with wall_speed"):
        fm.response(system, wall_speed=0.5, beta=0.5, cycles=10)
    with pytest.raises(fm.InputError, match=r"^start must be"):
        fm.response(system, wall_speed=0.5, beta=0.5, start="rest")
    with pytest.raises(fm.InputError, match=r"^wall_speed must be > 0"):
        fm.response(system, wall_speed=0.0, beta=0.5)


def test_codes_that_belts_do_not_have_are_refused(config, tmp_path):
    """Between their codes there are gaps, where those of motions under loads are."""
    ds = fm.sweep(fm.load_config(config))
    for name, wrong in (("regime", 2), ("also_reachable", 2), ("status", 4)):
        changed = ds.copy(deep=True)
        changed[name][0, 0, 0] = wrong
        changed.to_netcdf(tmp_path / "wrong.nc")
        with pytest.raises(fm.InputError, match=rf"{name} must be .*; got {wrong} at"):
            read(tmp_path / "wrong.nc")
