"""Pictures of structures: everything that the system has is in them, at its place."""

import numpy as np
import pytest
from layouts import assert_inside_and_apart
from matplotlib.colors import to_hex
from matplotlib.patches import Rectangle

import frictionmap as fm
from frictionmap.command_line.cli import main
from frictionmap.errors import InputError
from frictionmap.pictures.structures import BODY, CONTACT, LOAD

CHAIN = {"mass_ratios": [1, 1, 1], "stiffness_ratios": [1, 1, 1]}
CONTACTS = [
    fm.Contact("fixed-wall", 1),
    fm.Contact("between-masses", [1, 2]),
    fm.Contact("between-masses", [2, 3], stiffness=1.0),
    fm.Contact("between-masses", [1, 3], stiffness=1.0),
]


def patches(ax, colour):
    """Middles of the rectangles of a colour."""
    found = [
        one for one in ax.patches if isinstance(one, Rectangle) and to_hex(one.get_facecolor()) == colour
    ]
    return np.array([one.get_center() for one in found])


def arrows(ax):
    return [one for one in ax.texts if getattr(one, "arrow_patch", None) is not None]


def words(ax):
    return [one.get_text() for one in ax.texts if one.get_text()]


def test_a_chain_has_its_masses_springs_contacts_and_load():
    system = fm.System(**CHAIN, contacts=CONTACTS, load_mass=2)
    (ax,) = fm.plot_structure(system)
    np.testing.assert_allclose(patches(ax, BODY), [[1, 0], [2, 0], [3, 0]])
    pads = patches(ax, CONTACT)
    np.testing.assert_allclose(pads[:, 0], [1.0, 1.5, 2.5, 2.0])  # where they act
    assert pads[0, 1] < 0.0 < pads[1, 1] == pads[2, 1] < pads[3, 1]  # the last one crosses two others
    (load,) = arrows(ax)
    assert 2.0 < load.xyann[0] < load.xy[0] < 3.0
    assert words(ax) == ["1", "2", "3", "1", "2", "3", "4"]
    labels = [text.get_text() for text in ax.figure.legends[0].get_texts()]
    assert labels == ["contact", "contact with a spring", "load"]
    assert_inside_and_apart(ax.figure)


def test_a_base_moves_instead_of_a_load():
    (ax,) = fm.plot_structure(fm.System(contact="joined-base-wall", excitation="base"))
    (motion,) = arrows(ax)
    assert motion.xy[0] < 1.0
    assert patches(ax, CONTACT)[0, 1] > 0.0
    labels = [text.get_text() for text in ax.figure.legends[0].get_texts()]
    assert labels == ["contact to the base", "motion of the base"]


def dots(ax, marker):
    return np.array([one.get_xydata()[0] for one in ax.lines if one.get_marker() == marker])


def test_beams_and_plates_have_their_points_contacts_and_loads():
    beam = fm.Beam("clamped-free", length=2.0, bending_stiffness=1.0, mass_per_length=1.0,
                   points={"tip": 2.0, "joint": 0.5}, modes=2)  # fmt: skip
    (bare,) = fm.plot_structure(beam)
    np.testing.assert_allclose(dots(bare, "o"), [[6.0, 0.0], [1.5, 0.0]])  # a quarter of its length
    assert not dots(bare, "s").size
    system = fm.System(modes=beam, contact_masses=["joint"], contact_stiffness=1.0, load_mass="tip")
    (ax,) = fm.plot_structure(system)
    np.testing.assert_allclose(dots(ax, "s"), [[1.5, 0.0]])
    assert [one.xy for one in arrows(ax)] == [(6.0, 0.0)]
    assert arrows(ax)[0].arrow_patch.get_edgecolor()[:3] == pytest.approx(
        tuple(int(LOAD[k : k + 2], 16) / 255 for k in (1, 3, 5))
    )
    edges = ["clamped", "free", "free", "free"]
    plate = fm.Plate(edges, [2.0, 1.0], bending_stiffness=1.0, mass_per_area=1.0,
                     points={"a": [2.0, 0.0], "b": [1.0, 1.0]}, modes=2)  # fmt: skip
    contact = fm.Contact("between-masses", ["a", "b"], stiffness=1.0)
    (ax,) = fm.plot_structure(fm.System(modes=plate, contacts=[contact], load_mass="a"))
    np.testing.assert_allclose(dots(ax, "o"), [[2.0, 0.0], [1.0, 1.0]])
    np.testing.assert_allclose(dots(ax, "s"), [[1.5, 0.5]])
    assert "clamped edge" in [text.get_text() for text in ax.figure.legends[0].get_texts()]


def test_a_ring_is_round_and_a_large_structure_has_its_contacts_only():
    sectors = {
        "count": 6,
        "mass": [[1.0]],
        "stiffness": [[2.0]],
        "coupling": [{"masses": [1, 1], "stiffness": 0.3}],
    }
    (ax,) = fm.plot_structure(
        fm.ring(sectors=sectors, contacts=[fm.Contact("between-masses", [1, "next.1"])])
    )
    radius = np.hypot(*dots(ax, "o").T)
    np.testing.assert_allclose(radius, radius[0])
    assert len(dots(ax, "s")) == len(radius) == len(arrows(ax)) == 6
    stiffness = 2.0 * np.eye(60) - np.eye(60, k=1) - np.eye(60, k=-1)
    system = fm.System(matrices={"M": np.eye(60), "K": stiffness}, contact_masses=[7], load_mass=50)
    (ax,) = fm.plot_structure(system)
    assert words(ax) == ["7", "50", "1", "2 of 60 degrees of freedom"]


def test_a_structure_by_one_command(tmp_path, capsys):
    path = tmp_path / "frame.toml"
    path.write_text(
        "[system]\nmass_ratios = [1, 1]\nstiffness_ratios = [1, 1]\n[grid]\nr = [0.5]\nbeta = [0.1]\n"
    )
    for quantity in ("structure", "modes"):
        output = tmp_path / f"{quantity}.png"
        assert main(["plot", str(path), "--quantity", quantity, "--size", "85mm", "-o", str(output)]) == 0
        assert output.stat().st_size > 2000
    assert main(["plot", str(path), "--quantity", "mode", "-o", str(tmp_path / "x.png")]) == 2
    assert "did you mean" in capsys.readouterr().err
    assert main(["plot", str(path), "--log", "-o", str(tmp_path / "x.png")]) == 2


def test_what_has_no_structure():
    with pytest.raises(
        InputError, match=r"^structure must be a frictionmap\.System, Beam, Plate or Modes; got 3$"
    ):
        fm.plot_structure(3)
    with pytest.raises(InputError, match=r"^cannot use beta with plot_structure"):
        fm.plot_structure(fm.System(), beta=0.1)
