"""Pictures of modes: what is drawn is the modes of the structure, at its points."""

import re

import numpy as np
import pytest
from matplotlib.figure import Figure

import frictionmap as fm
from frictionmap.errors import InputError

UNIT = {"length": 2.0, "bending_stiffness": 1.0, "mass_per_length": 1.0}


def test_modes_of_a_beam():
    beam = fm.Beam("pinned-pinned", **UNIT, points={"third": 2.0 / 3.0}, modes=3)
    axes = fm.plot_modes(beam)
    assert len(axes) == 3  # there are no more
    for k, ax in enumerate(axes, 1):
        line = next(one for one in ax.lines if len(one.get_xdata()) > 2)
        x, y = line.get_data()
        sine = np.sin(k * np.pi * x / 2.0)  # of unit mass: the integral of sin^2 over 2 is 1
        np.testing.assert_allclose(y, np.sign(y @ sine) * sine, atol=1e-13)
        assert ax.texts[0].get_text() == "third"
        assert f"{k**2 * np.pi / 8.0:.5g}" in ax.get_title()  # (k pi/2)^2/(2 pi)


def test_modes_of_a_plate_and_of_points():
    plate = fm.Plate(["supported"] * 4, [2.0, 1.0], bending_stiffness=1.0, mass_per_area=1.0,
                     points={"middle": [1.0, 0.5]}, modes=2)  # fmt: skip
    first, second = fm.plot_modes(plate, count=2)
    assert not any(type(one).__name__ == "QuadContourSet" for one in first.collections)  # no nodal line
    (nodal,) = [one for one in second.collections if type(one).__name__ == "QuadContourSet"]
    (path,) = nodal.get_paths()
    np.testing.assert_allclose(path.vertices[:, 0], 1.0, atol=1e-6)  # the second mode has one at x = a/2
    modes = fm.Modes([0.0, 1.0, 2.0], 0.0, [[1.0, 0.5, -2.0], [1.0, 1.5, 1.0]], ["a", "b"])
    system = fm.System(modes=modes, contact_masses=["a"], contact_stiffness=1.0, load_mass="b")
    axes = fm.plot_modes(system, count=9)
    drawn = [one.get_ydata().tolist() for ax in axes for one in ax.lines if one.get_marker() == "o"]
    assert drawn == [[0.5, 1.5], [-2.0, 1.0]]
    assert [one.get_text() for one in axes[0].get_xticklabels()] == ["a", "b"]


def test_modes_of_masses_and_of_a_beam_in_a_system():
    chain = fm.System(mass_ratios=[1, 1], stiffness_ratios=[1, 1])
    first, second = fm.plot_modes(chain)
    values = [one.get_ydata() for ax in (first, second) for one in ax.lines if one.get_marker() == "o"]
    golden = 0.5 * (1.0 + np.sqrt(5.0))
    np.testing.assert_allclose([x2 / x1 for x1, x2 in values], [golden, -1.0 / golden])
    assert f"{1.0 / golden:.5g}" in first.get_title()
    beam = fm.Beam("clamped-free", **UNIT, points={"tip": 2.0}, modes=2)
    system = fm.System(modes=beam, contact_masses=["tip"], contact_stiffness=1.0, load_mass="tip")
    lines = [fm.plot_modes(one)[1].lines[1].get_ydata() for one in (beam, system)]
    np.testing.assert_array_equal(*lines)


def test_frequencies_of_modes_are_in_hertz(tmp_path):
    """A cantilever has (1.8751)^2 sqrt(EI/m)/(2 pi L^2); a chain with a unit its ratio times that."""
    (tmp_path / "beam.toml").write_text(
        '[system]\ncontact_masses = ["tip"]\ncontact_stiffness = "5 N/mm"\n'
        '[system.beam]\nends = "clamped-free"\nlength = "300 mm"\nbending_stiffness = "21 N m^2"\n'
        'mass_per_length = "0.78 kg/m"\npoints = { tip = "300 mm" }\n[units]\nload = "10 N"\n'
        "[grid]\nr = [1.0]\nbeta = [0.1]\n"
    )
    config = fm.load_config(tmp_path / "beam.toml")
    hertz = 1.875104068711961**2 * np.sqrt(21.0 / 0.78) / (2.0 * np.pi * 0.3**2)
    ax, *_ = fm.plot_modes(config.system, units=config.units)
    assert ax.get_title() == f"mode 1, {hertz:.5g} Hz"
    assert ax.get_xlabel() == "place on the beam [m]"
    curves = fm.curves(config)
    assert f"natural frequencies {hertz:.5g}, " in curves.attrs["modes"]
    assert re.search(r"\d, \.\.\. Hz; ", curves.attrs["modes"])
    chain = fm.System(mass_ratios=[1, 1], stiffness_ratios=[1, 1])
    ax, *_ = fm.plot_modes(chain, units=fm.Units(natural_frequency="5 Hz", mass="1 kg"))
    assert ax.get_title() == f"mode 1, {2.5 * (np.sqrt(5.0) - 1.0):.5g} Hz"


def test_refusals():
    beam = fm.Beam("clamped-free", **UNIT, points={"tip": 2.0})
    with pytest.raises(InputError, match=r"structure must be a frictionmap\.System, Beam, Plate or Modes"):
        fm.plot_modes("chain")
    with pytest.raises(InputError, match="ax must be 2 axes, one for each mode; got 1"):
        fm.plot_modes(beam, Figure().subplots(), count=2)
    with pytest.raises(InputError, match="count must be >= 1; got 0"):
        fm.plot_modes(beam, count=0)
