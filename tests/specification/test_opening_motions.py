"""Motions of contacts that open and of piecewise linear springs in grids, along axes, with statistics, from
given starts, in files and in pictures.
"""

import functools

import matplotlib.colors
import numpy as np
import pytest

import frictionmap as fm
from frictionmap.command_line.cli import main

DAMPER = {"stiffness": 3.0, "normal": {"mass": 2, "stiffness": 1.0, "friction": 0.4, "preload": 0.3}}
STOP = {"masses": [1, 2], "gap": 0.5, "stiffness": 4.0}
CHAIN = {"mass_ratios": [1, 1], "stiffness_ratios": [1, 0.5], "damping_ratios": 0.02}
DT = 0.35

BLADES = """\
title = "Blades"
[system]
mass_ratios = [1.0, 1.0]
stiffness_ratios = [1.0, 0.5]
damping_ratios = 0.02
contacts = [{ stiffness = 3.0, normal = { mass = 2, stiffness = 1.0, friction = 0.4, preload = 0.3 } }]
springs = [{ masses = [1, 2], gap = 0.5, stiffness = 4.0 }]
[record]
pulse = { kind = "half-sine", amplitude = 1.0, duration = 4.0 }
quantity = "force"
mass = 2
"""


def blades(**changed):
    return fm.System(**{**CHAIN, "contacts": [DAMPER], "springs": [STOP], **changed})


def noise(seed, **more):
    values = np.convolve(np.random.default_rng(seed).normal(size=50), [0.75, 1.5, 0.75], mode="same")
    values[0] = 0.0
    return fm.Record(values, DT, quantity="force", mass=2, **more)


def assert_same_numbers(one, other):
    """All numbers of motions that need no samples are equal to the bit."""
    names = [name for name in other.data_vars if not {"event", "time"} & set(other[name].dims)]
    assert len(names) > 30
    for name in names:
        np.testing.assert_array_equal(np.squeeze(one[name].values), np.squeeze(other[name].values), name)


@pytest.mark.parametrize("base", [False, True])
def test_motions_of_a_grid_are_those_on_their_own(base):
    rigid = {"normal": {"mass": 2, "stiffness": 1.0, "friction": 0.4}}
    own = {"excitation": "base", "damping_reference": "base"} if base else {}
    system = blades(contacts=[rigid], **own)
    records = [noise(1), noise(2, interpolation="cubic")]
    if base:
        records = [fm.Record(one.values, DT, interpolation=one.interpolation) for one in records]
    axes = {"scale": [-0.5, 0.3], "mu": [1.0, 1.3], "beta": [0.2, 0.6]}
    grid = fm.history(system, records, samples="none", threads=2, after=3.0, **axes)
    assert (grid["separations"] > 0).any()
    assert (grid["spring_crossings"] > 0).any()
    for place in ((0, 0, 0, 0), (1, 0, 1, 1), (0, 1, 1, 0), (1, 1, 0, 1)):
        k, s, m, b = place
        scale, mu, beta = axes["scale"][s], axes["mu"][m], axes["beta"][b]
        one = fm.history(system, records[k], beta, mu, scale=scale, samples="none", after=3.0)
        assert_same_numbers(grid.isel(record=k, scale=s, mu=m, beta=b), one.squeeze())


def test_along_further_axes():
    axes = {"damping_ratios": [0.02, 0.05], "contacts[1].normal.preload": [0.1, 0.6]}
    both = fm.history(blades(), noise(3), samples="none", axes=axes)
    last = both.isel({dim: 1 for dim in both.dims if dim in axes or dim.startswith("contacts")})
    damper = {**DAMPER, "normal": {**DAMPER["normal"], "preload": 0.6}}
    one = fm.history(blades(damping_ratios=0.05, contacts=[damper]), noise(3), samples="none")
    for name in (
        "amplitude",
        "separations",
        "spring_crossings",
        "normal_force_max",
        "work_friction",
        "beta_hold",
    ):
        np.testing.assert_array_equal(np.squeeze(last[name].values), np.squeeze(one[name].values), name)


def test_statistics_of_a_long_motion():
    load = fm.Record.generate("white", 400.0, 0.1, rms=1.0, seed=1, quantity="force", mass=2)[0]
    asked = {"start": 50.0, "window": 25.0, "batches": 8}
    ds = fm.history(blades(), load, after=0.0, statistics=asked)
    direct = fm.stationary(ds["x"].squeeze(drop=True), **asked)
    np.testing.assert_allclose(ds["x_variance"].squeeze(), direct.variance, rtol=1e-12)
    np.testing.assert_allclose(ds["x_peak"].squeeze(), direct.peak, rtol=1e-12)
    less = fm.history(blades(), load, after=0.0, statistics=asked, samples="none")
    np.testing.assert_array_equal(less["x_variance"], ds["x_variance"])


@pytest.mark.parametrize(("r", "stiffness"), [(0.9, 3.0), (0.5, None)])
def test_from_the_steady_state_of_a_response_file(tmp_path, r, stiffness):
    """Under the same load the motion goes on as it was."""
    contact = {"normal": {**DAMPER["normal"], "preload": 0.8}} | (
        {"stiffness": stiffness} if stiffness else {}
    )
    system = blades(contacts=[contact], load=[0.0, -1.0j])
    steady = fm.response(system, r, 0.2)
    assert steady["period"].item() == 1
    assert (steady["open"] == 1).any()
    steady.to_netcdf(tmp_path / "steady.nc")
    load = fm.Record.sweep(r, r, 2.0 * np.pi * 5 / r, quantity="force", mass=2)
    ds = fm.history(system, load, beta=0.2, start=str(tmp_path / "steady.nc"), after=0.0)
    for cycle in range(6):
        k = np.abs(ds["time"].values - 2.0 * np.pi * cycle / r).argmin()
        for name, rate in (("x", 1.0), ("v", r)):
            found = ds[name].squeeze().values[:, k]
            np.testing.assert_allclose(found, rate * steady[name].values[:, -1], rtol=0.0, atol=1e-9)
    assert np.isnan(ds["beta_hold"].item())
    lost = ds["work_friction"].item() / 5
    assert lost == pytest.approx(steady["work_friction"].item(), abs=1e-9)


@pytest.mark.parametrize("opens", [False, True])
def test_from_the_response_of_a_base_that_moves(opens):
    """A response is in space, a motion relative to the base; u = -cos(tau), and the record is r sin(r t)."""
    r, kind = 0.45, {"kind": "joined-base-wall", "masses": [1]}
    pressed = {"normal": {"masses": [1, 2], "stiffness": 1.0, "friction": 0.4, "preload": 0.8}}
    system = fm.System(
        **CHAIN, contacts=[kind | (pressed if opens else {})], excitation="base", damping_reference="base",
        load_harmonics=[{"n": 1, "amplitude": 1.0, "phase_deg": 180.0}],
    )  # fmt: skip
    steady = fm.response(system, r, 0.3)
    assert steady["period"].item() == 1
    assert steady["stops_per_cycle"].item() > 0
    shaken = fm.Record.sweep(r, r, 2.0 * np.pi * 3 / r, quantity="velocity", amplitude=r)
    ds = fm.history(system, shaken, beta=0.3, start=steady, after=0.0)
    for cycle in range(1, 4):
        k = np.abs(ds["time"].values - 2.0 * np.pi * cycle / r).argmin()
        x, v = (ds[name].squeeze().values[:, k] for name in ("x", "v"))
        np.testing.assert_allclose(x, steady["x"].values[:, -1] + 1.0, rtol=0.0, atol=1e-9)
        np.testing.assert_allclose(v, r * steady["v"].values[:, -1], rtol=0.0, atol=1e-9)


@pytest.fixture
def motion(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "blades.toml").write_text(BLADES)
    assert main(["history", "blades.toml", "-o", "blades.nc", "--quiet"]) == 0
    return fm.open("blades.nc")


def test_a_moving_picture_shows_when_the_contact_is_open(motion):
    ds = fm.history(blades(), noise(4), after=5.0)
    one = ds.squeeze()
    moving = fm.animate(ds, seconds=2.0, fps=30.0)
    moving._draw_was_started = True
    colours = {"#f2a900": "stuck", "#ffffff": "slides", "#bcd9f2": "open"}
    seen = set()
    for frame in range(one.sizes["time"]):
        moving._draw_frame(frame)
        light = [line for line in moving._fig.axes[0].lines if line.get_marker() == "o"][-1]
        state = colours[matplotlib.colors.to_hex(light.get_markerfacecolor())]
        opened, direction = bool(one["open"][frame]), int(one["direction"][frame])
        assert state == ("open" if opened else "slides" if direction else "stuck")
        seen.add(state)
    assert seen == {"stuck", "slides", "open"}


def test_files_tables_and_pictures(motion, monkeypatch, capsys):
    monkeypatch.setattr("frictionmap.plot.animate", functools.partial(fm.animate, seconds=0.2, fps=20.0))
    assert main(["info", "blades.nc"]) == 0
    text = capsys.readouterr().out
    for name in ("separations", "spring_crossings"):
        words = "separations" if name == "separations" else "knots passed"
        assert f"{motion[name].item():g}" in next(line for line in text.splitlines() if words in line)
    assert main(["export", "blades.nc", "-o", "blades.csv", "--quiet"]) == 0
    table = np.genfromtxt("blades.csv", delimiter=",", names=True)
    np.testing.assert_allclose(table["x_1"], motion["x"].squeeze().values[0], rtol=0.0, atol=1e-15)
    assert main(["plot", "blades.nc", "-o", "blades.gif", "--quiet"]) == 0
    for quantity in ("history", "energies"):
        assert main(["plot", "blades.nc", "--quantity", quantity, "-o", f"{quantity}.png", "--quiet"]) == 0


def test_the_picture_shades_when_a_contact_is_open(motion):
    axes = fm.plot_history(motion)
    labels = [text.get_text() for text in axes[0].figure.legends[0].get_texts()]
    assert "a contact is open" in labels
    assert "all contacts stick" in labels
