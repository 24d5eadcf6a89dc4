"""Modes from files: NPZ, MAT, CSV, universal files written from the public description of data set 55."""

import numpy as np
import pytest
from scipy.io import savemat

import frictionmap as fm
from frictionmap.errors import InputError

F = np.array([12.0, 47.5, 130.25])
ZETA = np.array([0.01, 0.02, 0.005])
SHAPES = np.array([[0.5, -0.75, 0.25], [1.25, 0.5, -0.5]])
POINTS = ["tip", "shaker"]
MASSES = np.array([4.0, 2.25, 0.25])


def system(modes, **more):
    return fm.System(modes=modes, contact_masses=["tip"], load_mass="shaker", **more)


def check(found, unit=True, points=POINTS):
    modes = found.matrices
    assert modes.points == tuple(points)
    np.testing.assert_allclose(modes.w, 2.0 * np.pi * F, rtol=1e-12)
    np.testing.assert_allclose(found.damping_ratios, ZETA, rtol=1e-12)
    size = np.ones(3) if unit else np.sqrt(MASSES)
    np.testing.assert_allclose(modes.shapes, SHAPES / size, rtol=1e-12)


@pytest.mark.parametrize("ending", [".npz", ".mat"])
def test_arrays_as_of_modes(tmp_path, ending):
    path = tmp_path / f"rig{ending}"
    residual = np.array([[2e-4, 1e-5], [1e-5, 3e-4]])
    arrays = {"w": 2.0 * np.pi * F, "zeta": ZETA, "shapes": SHAPES, "residual": residual}
    if ending == ".npz":
        np.savez(path, points=POINTS, **arrays)
    else:
        savemat(path, {**arrays, "points": np.array(POINTS, dtype=object)})
    found = system(path, contact_stiffness=1.0)
    check(found)
    np.testing.assert_allclose(found.matrices.residual, residual)


def test_arrays_with_modal_masses(tmp_path):
    path = tmp_path / "rig.npz"
    named = {"frequency_Hz": F, "damping_ratios": ZETA, "shapes": SHAPES, "points": POINTS}
    np.savez(path, modal_mass=MASSES, **named)
    check(system(path), unit=False)
    np.savez(path, **named)
    with pytest.raises(InputError, match="must state modal masses"):
        system(path)
    check(system({"file": path, "normalised": "mass"}))
    np.savez(path, normalised="mass", **named)
    check(system(path))


def test_csv(tmp_path):
    path = tmp_path / "rig.csv"
    rows = [f"{f},{z},{m},{a},{b}" for f, z, m, (a, b) in zip(F, ZETA, MASSES, SHAPES.T, strict=True)]
    path.write_text("frequency_Hz,damping_ratio,modal_mass,tip,shaker\n" + "\n".join(rows) + "\n")
    check(system(path), unit=False)
    check(system({"file": str(path), "points": ["tip", "shaker"]}), unit=False)
    with pytest.raises(InputError, match=r"modes\.points must be points of rig\.csv, such as tip, shaker"):
        system({"file": path, "points": ["top"]})
    path.write_text(path.read_text().replace("47.5", "many"))
    with pytest.raises(InputError, match=r"row 3 of rig\.csv must have 5 numbers"):
        system(path)


def set_55(kind, first, second, nodes, values):
    """A data set 55 of the public description; values (nodes, 3 or 6 numbers)."""
    lines = [f"{-1:6d}", f"{55:6d}"] + ["NONE"] * 5
    lines.append("".join(f"{k:10d}" for k in (1, kind, 2, 8, 5 if kind == 3 else 2, 3)))
    lines.append("".join(f"{k:10d}" for k in first))
    lines.append("".join(f"{x:13.5E}" for x in second))
    for node, row in zip(nodes, values, strict=True):
        lines += [f"{node:10d}", "".join(f"{x:13.5E}" for x in row)]
    return "\n".join([*lines, f"{-1:6d}"]) + "\n"


def test_normal_modes_of_a_universal_file(tmp_path):
    path = tmp_path / "rig.uff"
    text = ""
    for k in (1, 0, 2):  # in any order
        values = [[0.0, SHAPES[0, k], 0.0], [SHAPES[1, k], 0.0, 0.0]]
        text += set_55(2, (2, 4, 1, k + 1), (F[k], MASSES[k], ZETA[k], 0.0), (112, 40), values)
    path.write_text(text)
    found = fm.System(modes=path, contact_masses=["112.2"], load_mass="40.1")
    assert set(found.matrices.points) == {"112.2", "40.1"}  # points at rest in all modes are left out
    rows = [found.matrices.points.index(name) for name in ("112.2", "40.1")]
    np.testing.assert_allclose(found.matrices.shapes[rows], SHAPES / np.sqrt(MASSES), rtol=1e-5)
    np.testing.assert_allclose(found.matrices.w, 2.0 * np.pi * F, rtol=1e-5)
    np.testing.assert_allclose(found.damping_ratios, ZETA, rtol=1e-5)


@pytest.mark.parametrize("mass", [0.0, 1.0])
def test_unknown_modal_masses_of_a_universal_file(tmp_path, mass):
    path = tmp_path / "rig.unv"
    path.write_text(set_55(2, (2, 4, 1, 1), (12.0, mass, 0.01, 0.0), (7,), [[0.5, 0.0, 0.0]]))
    with pytest.raises(InputError, match="must state modal masses, which are unknown where all are 0 or 1"):
        fm.System(modes=path, contact_masses=["7.1"], load_mass="7.1")
    found = fm.System(modes={"file": path, "normalised": "mass"}, contact_masses=["7.1"], load_mass="7.1")
    assert found.matrices.shapes.tolist() == [[0.5]]


def test_complex_modes_of_a_universal_file(tmp_path):
    # of a real mode with the modal mass m: s = -zeta w + i w_d, modal A = 2 i w_d m; with any complex scale c
    # of the shape A has the factor c^2
    path = tmp_path / "rig.uff"
    text, scale = "", 0.6 - 0.8j
    for k in range(3):
        w = 2.0 * np.pi * F[k]
        damped = w * np.sqrt(1.0 - ZETA[k] ** 2)
        a = 2j * damped * MASSES[k] * scale**2
        shape = SHAPES[:, k] * scale
        values = [[x.real, x.imag, 0.0, 0.0, 0.0, 0.0] for x in shape]
        for sign in (1.0, -1.0):  # both of a pair
            roots = (-ZETA[k] * w, sign * damped, a.real, sign * a.imag, 0.0, 0.0)
            signed = [[v if i % 2 == 0 else sign * v for i, v in enumerate(row)] for row in values]
            text += set_55(3, (2, 6, 1, k + 1), roots, (1, 2), signed)
    path.write_text(text)
    found = fm.System(modes=path, contact_masses=["1.1"], load_mass="2.1")
    expected = SHAPES / np.sqrt(MASSES)
    signs = np.sign(found.matrices.shapes[0] * expected[0])
    np.testing.assert_allclose(found.matrices.shapes, expected * signs, rtol=2e-5)
    np.testing.assert_allclose(found.matrices.w, 2.0 * np.pi * F, rtol=1e-5)
    np.testing.assert_allclose(found.damping_ratios, ZETA, rtol=1e-4)


def test_a_configuration_with_a_file(tmp_path):
    np.savez(tmp_path / "rig.npz", w=2.0 * np.pi * F, zeta=ZETA, shapes=SHAPES, points=POINTS)
    path = tmp_path / "map.toml"
    path.write_text(
        '[system]\nmodes = "rig.npz"\ncontact_masses = ["tip"]\nload_mass = "shaker"\n'
        '[units]\nload = "2 N"\n[grid]\nr = ["10 Hz", "14 Hz"]\nbeta = ["0.1 N"]\n'
    )
    config = fm.load_config(path)
    check(config.system)
    assert config.r[0] == pytest.approx(10.0 / 12.0, rel=1e-14)
    assert (tmp_path / "rig.npz") in config.files


@pytest.mark.parametrize(("name", "content", "message"), [
    ("rig.op2", b"", "modes must be a file that ends in .npz, .mat, .csv, .uff, .unv; got 'rig.op2'"),
    ("rig.npz", b"nothing", "it is no .npz file of plain arrays"),
    ("rig.csv", b"f,tip\n1,2\n", "rig.csv must have a row per mode, with the column frequency_Hz"),
    ("rig.uff", b"    -1\n    15\n    -1\n", "rig.uff"),
    ("none.csv", None, "No such file or directory; check the path"),
])  # fmt: skip
def test_files_that_are_none(tmp_path, name, content, message):
    path = tmp_path / name
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(InputError) as caught:
        fm.System(modes=path)
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)
