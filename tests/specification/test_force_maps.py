"""Friction against friction at one frequency: curves of partial sticking, nine colours, refusals."""

from dataclasses import replace

import numpy as np
import pytest

import frictionmap as fm
from frictionmap import regimes
from frictionmap.command_line.cli import main
from frictionmap.errors import InputError
from frictionmap.general.partial import holding_force
from frictionmap.pictures.palette import PAIRS

#: Two masses with a wall at the first and a joint between them, the first example of the theory.
SYSTEM = fm.System(
    contacts=[
        fm.Contact("fixed-wall", 1),
        fm.Contact("between-masses", (1, 2), force=0.2, name="joint"),
    ],
    mass_ratios=[1.0, 1.0], stiffness_ratios=[1.0, 1.0], damping_ratios=0.01,
)  # fmt: skip

FORCES = np.linspace(0.05, 1.45, 9)


@pytest.fixture(scope="module")
def maps():
    beta = np.linspace(0.05, 1.2, 8)
    return fm.sweep(SYSTEM, [0.9], beta, 1.0, axes={"contacts[2].force": FORCES})


@pytest.mark.parametrize(
    ("r", "expected"), [(0.5, 0.681473075865), (0.9, 1.154492427416), (1.3, 0.717521350625)]
)
def test_the_force_from_which_the_joint_sticks_is_the_published_one(r, expected):
    found = holding_force(SYSTEM, r, 1, np.array([[1.0, 0.0], [0.0, 0.0]]), np.array([0.5]))
    assert found == pytest.approx(expected, abs=1e-11)


def test_each_contact_sticks_beyond_its_curve(maps):
    """The curves come from motions with one contact held; the cells from motions in which both can move."""
    beta = maps.beta.values
    joint = holding_force(SYSTEM, 0.9, 1, np.array([[1.0, 0.0], [0.0, 0.0]]), beta)
    wall = holding_force(SYSTEM, 0.9, 0, np.array([[0.0, 0.0], [1.0, 0.0]]), FORCES)
    stuck = (maps.contact_regime == regimes.PERMANENT_STICKING).squeeze()
    stuck = stuck.transpose("contacts_2_force", "beta", "contact").values
    np.testing.assert_array_equal(stuck[..., 1], joint <= FORCES[:, np.newaxis])
    np.testing.assert_array_equal(stuck[..., 0], beta >= wall[:, np.newaxis])
    assert 0 < stuck[..., 0].sum() < stuck[..., 0].size
    assert 0 < stuck[..., 1].sum() < stuck[..., 1].size


def test_nine_colours_and_curves(maps):
    (ax,) = fm.plot_forces(maps)
    (mesh,) = ax.collections
    states = {regimes.PERMANENT_STICKING: 0, regimes.STICK_SLIP: 1, regimes.CONTINUOUS: 2}
    regime = maps.contact_regime.squeeze().transpose("contacts_2_force", "beta", "contact").values
    classes = [[3 * states[one] + states[other] for one, other in row] for row in regime]
    np.testing.assert_array_equal(mesh.get_array().reshape(FORCES.size, -1), classes)
    (legend,) = ax.figure.legends
    labels = [text.get_text() for text in legend.get_texts()]
    assert f"fixed-wall 1 slides, joint sticks and slips ({np.sum(np.equal(classes, 7))})" in labels
    assert "one contact sticks, the other moves" in labels
    colours = [patch.get_facecolor() for patch in legend.get_patches()]
    assert len(colours) == np.unique(classes).size <= len(PAIRS)


def test_curves_of_one_contact_are_drawn_where_they_hold(maps):
    """They are limits of mu = 1, of the contacts, not of the grid."""
    assert "one contact sticks, the other moves" in _labels(fm.plot_forces(maps))
    contacts = [replace(one, mu=2.0) for one in SYSTEM.contacts]
    own = fm.sweep(
        replace(SYSTEM, contacts=contacts), [0.9], [0.1, 0.5], 1.0, axes={"contacts[2].force": FORCES[:2]}
    )
    assert "one contact sticks, the other moves" not in _labels(fm.plot_forces(own))


def _labels(axes):
    return [text.get_text() for text in axes[0].figure.legends[0].get_texts()]


def test_from_the_command_line(maps, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    maps.to_netcdf("forces.nc")
    assert main(["plot", "forces.nc", "--against", "contacts_2_force"]) == 0
    assert (tmp_path / "forces.png").stat().st_size > 10000
    assert main(["plot", "forces.nc", "--against", "damping_ratios"]) == 2
    assert "unknown further axis of --against" in capsys.readouterr().err
    assert main(["plot", "forces.nc", "--against", "contacts_2_force", "--log"]) == 2
    assert "cannot use --log with --against" in capsys.readouterr().err


def test_refusals(maps):
    with pytest.raises(InputError, match="ds of plot_forces must be a dataset; got int"):
        fm.plot_forces(3)
    with pytest.raises(InputError, match=r"over must be a further axis .*contacts_2_force.*; got 'sample'"):
        fm.plot_forces(maps, "sample")
    two = fm.sweep(SYSTEM, [0.5, 0.9], [0.3], 1.0, axes={"contacts[2].force": [0.1, 0.2]})
    with pytest.raises(InputError, match="must hold one r; got 2: choose one"):
        fm.plot_forces(two)
    fm.plot_forces(two.isel(r=[0]))
    fm.plot_forces(two.isel(r=1))
