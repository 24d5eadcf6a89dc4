"""Moving pictures of steady states: marks are where the motion is, lights are on while contacts are stuck."""

import functools

import matplotlib.colors
import numpy as np
import pytest
from PIL import Image

import frictionmap as fm
from frictionmap.command_line.cli import main

TWO = fm.System(mass_ratios=[1, 1], stiffness_ratios=[1, 1], contact_masses=[2], damping_ratios=0.02)


@pytest.fixture(scope="module")
def stops():
    return fm.response(TWO, 0.3, 0.3, points=101)


def parts(moving):
    """The marks of masses and contacts, the cursor, the points on the loop."""
    moving._draw_was_started = True  # matplotlib warns of animations that nobody has looked at
    stage, history, loop = moving._fig.axes[:3]
    marks = [line for line in stage.lines if line.get_marker() in ("s", "o")]
    dots = [line for line in loop.lines if line.get_marker() == "o"]
    return marks, history.lines[-1], dots


@pytest.mark.parametrize("frame", [0, 17, 50, 83])
def test_marks_are_where_the_motion_is(stops, frame):
    moving = fm.animate(stops, seconds=1.0, fps=101.0)
    moving._draw_frame(frame)
    marks, cursor, (dot,) = parts(moving)
    assert [mark.get_xdata()[0] for mark in marks] == [*stops.x.values[:, frame], stops.z.values[frame]]
    assert cursor.get_xdata()[0] == stops.tau.values[frame] / np.pi
    assert (dot.get_xdata()[0], dot.get_ydata()[0]) == (stops.z.values[frame], stops.friction.values[frame])


def test_the_light_is_on_exactly_while_the_contact_is_stuck(stops):
    moving = fm.animate(stops, seconds=1.0, fps=101.0)
    lit = []
    for frame in range(stops.sizes["tau"]):
        moving._draw_frame(frame)
        light = parts(moving)[0][-1]
        lit.append(matplotlib.colors.to_hex(light.get_markerfacecolor()) == "#f2a900")
    stuck = stops.direction.values == 0
    assert stuck.any()
    assert not stuck.all()
    np.testing.assert_array_equal(lit, stuck)


def test_several_contacts_have_a_light_each():
    contacts = [fm.Contact(masses=[1], ratio=1.0), fm.Contact(masses=[2], ratio=0.5)]
    frame = fm.System(mass_ratios=[1, 1], stiffness_ratios=[1, 1], contacts=contacts, damping_ratios=0.02)
    marks, _, dots = parts(fm.animate(fm.response(frame, 0.5, 0.2, points=51), seconds=1.0, fps=10.0))
    assert [mark.get_marker() for mark in marks] == ["s", "s", "o", "o"]
    assert len(dots) == 2


def test_the_file_has_every_frame(stops, tmp_path):
    place = tmp_path / "motion.gif"
    fm.animate(stops, seconds=0.8, fps=10.0, size="80mm").save(place, writer="pillow")
    with Image.open(place) as picture:
        assert picture.n_frames == 8


def test_plot_writes_a_moving_picture(stops, tmp_path, monkeypatch, capsys):
    """Four frames of it, not sixty."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("frictionmap.plot.animate", functools.partial(fm.animate, seconds=0.2, fps=20.0))
    stops.to_netcdf("motion.nc")
    assert main(["plot", "motion.nc", "-o", "motion.gif", "--size", "80mm"]) == 0
    assert capsys.readouterr().out == "wrote motion.gif\n"
    with Image.open(tmp_path / "motion.gif") as picture:
        assert (picture.format, picture.n_frames) == ("GIF", 4)


def test_maps_do_not_move(tmp_path):
    from frictionmap.plot import save_picture

    ds = fm.sweep(fm.System(), [0.5], [0.2])
    with pytest.raises(
        fm.InputError, match=r"^cannot write a map as a moving picture: only responses and histories move"
    ):
        save_picture(ds, tmp_path / "map.gif")


#: A frame on a moving base: a pulse, and friction in both storeys.
PULSE = fm.Record([0.0, 3.0, -2.0, 1.0, -1.0, 0.0, 0.0], dt=0.05, quantity="acceleration", unit="m/s^2")
FRAME = fm.System(
    mass_ratios=[1, 1], stiffness_ratios=[1, 1], excitation="base", damping_ratios=0.02,
    contacts=[
        fm.Contact("joined-base-wall", masses=[1], ratio=1.0),
        fm.Contact("between-masses", masses=[1, 2], ratio=0.5),
    ],
)  # fmt: skip


@pytest.fixture(scope="module")
def shaken():
    units = fm.Units(natural_frequency="1.5 Hz", mass="100 kg")
    return fm.history(FRAME, PULSE, beta=["60 N"], units=units)


def test_a_history_moves_under_its_record(shaken):
    """Frames are at equal times, each the last state until then, in SI units."""
    moving = fm.animate(shaken, seconds=2.0, fps=20.0)
    frames = [*moving.new_frame_seq()]
    one = shaken.squeeze(["record", "scale", "mu", "beta"])
    time = one.time.values
    moments = np.linspace(time[0], time[-1], 40)
    lit = []
    for frame, moment in zip(frames, moments, strict=True):
        assert time[frame] <= moment
        assert frame + 1 == time.size or time[frame + 1] > moment
        moving._draw_frame(frame)
        marks, _, dots = parts(moving)
        cursor = next(line for line in moving._fig.axes[1].lines if line.get_color() == "#cc1f03")
        assert cursor.get_xdata()[0] == time[frame]
        at = one.isel(time=frame)
        assert [mark.get_xdata()[0] for mark in marks] == [*at.x_m.values, *at.z_m.values]
        assert [dot.get_ydata()[0] for dot in dots] == [*at.friction_N.values]
        shown = [matplotlib.colors.to_hex(mark.get_markerfacecolor()) == "#f2a900" for mark in marks[2:]]
        np.testing.assert_array_equal(shown, at.direction.values == 0)
        lit += shown
    assert any(lit)
    assert not all(lit)
    record = moving._fig.axes[1].lines[0]
    np.testing.assert_array_equal(record.get_ydata(), one.drive.values)
    assert moving._fig.axes[0].get_xlabel() == "displacement [m]"
    assert moving._fig.axes[2].get_ylabel() == "contact force [N]"


def test_plot_writes_the_moving_picture_of_a_history(shaken, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("frictionmap.plot.animate", functools.partial(fm.animate, seconds=0.2, fps=20.0))
    shaken.to_netcdf("motion.nc")
    assert main(["plot", "motion.nc", "-o", "motion.gif", "--size", "80mm"]) == 0
    assert capsys.readouterr().out == "wrote motion.gif\n"
    with Image.open(tmp_path / "motion.gif") as picture:
        assert (picture.format, picture.n_frames) == ("GIF", 4)


def test_one_of_several_motions_is_chosen_with_at(tmp_path, monkeypatch, capsys):
    """The remedy of the message; the motions that end sooner are padded with NaN."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("frictionmap.plot.animate", functools.partial(fm.animate, seconds=0.2, fps=20.0))
    pulse = fm.Record([0.0, 1.0, 0.0], dt=1.0, quantity="force")
    twice = fm.history(fm.System(damping_ratios=0.1), [pulse, pulse], beta=[0.05, 0.4], scale=[0.5, 1.0])
    assert np.isnan(twice.x).any()
    twice.to_netcdf("motions.nc")
    assert main(["plot", "motions.nc", "-o", "motion.gif"]) == 2
    said = capsys.readouterr().err
    assert (
        "--at record=1 --at scale=0.5 --at beta=0.05 or ds.sel(record=[1], scale=[0.5], beta=[0.05])" in said
    )
    options = ["--at", "record=1", "--at", "scale=0.5", "--at", "beta=0.05"]
    assert main(["plot", "motions.nc", "-o", "motion.gif", *options]) == 0
    assert main(["plot", "motions.nc", "-o", "motion.png", *options]) == 0
    assert main(["info", "motions.nc", *options]) == 0
    assert "stops" in capsys.readouterr().out


def test_histories_without_one_motion_are_refused():
    several = fm.history(fm.System(), fm.Record([0.0, 1.0, 0.0], dt=1.0, quantity="force"), beta=[0.2, 0.3])
    remedy = r"choose one, such as --at beta=0\.2 or ds\.sel\(beta=\[0\.2\]\)$"
    with pytest.raises(fm.InputError, match=remedy):
        fm.animate(several)
    fm.animate(several.sel(beta=[0.2]), seconds=0.1)._draw_was_started = True  # the remedy works
    pulse = fm.Record([0.0, 1.0, 0.0], dt=1.0, quantity="force")
    with pytest.raises(fm.InputError, match='samples="all"'):
        fm.animate(fm.history(fm.System(), pulse, beta=[0.2], samples="none"))


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"seconds": 0.0}, "^seconds must be .*; got 0"),
        ({"fps": 500.0}, "^fps must be .*; got 500"),
        ({"panels": 1}, "^cannot use panels with animate"),
    ],
)
def test_invalid_arguments_are_refused(stops, options, said):
    with pytest.raises(fm.InputError, match=said):
        fm.animate(stops, **options)
