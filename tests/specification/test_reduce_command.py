"""`frictionmap reduce`: from matrices of a finite-element program to a small file and a map of two forces.

The model is a rod of 60 equal elements, held at one end, with three joints, one of them elastic.
"""

import numpy as np
import pytest
import structure_files as written
import xarray as xr
from scipy.io import mmwrite
from scipy.linalg import eigh
from scipy.sparse import coo_array

import frictionmap as fm
from frictionmap.command_line.cli import main

N, MASS, SPRING = 60, 0.5, 1.2e6

JOINTS = """
load_mass = 60
damping_ratios = 0.01
stiffness_scale = 2.0e4

[[system.contacts]]
masses = [20]

[[system.contacts]]
name = "flange"
kind = "between-masses"
masses = [39, 40]
stiffness = 30.0
force = 0.3

[[system.contacts]]
masses = [60]
ratio = 0.5

[grid]
r = 0.9
beta = { start = 0.05, stop = 0.35, num = 3 }
"""

WHOLE = '[system]\nmatrices = { M = "M.mtx", K = "K.mtx" }\n'
FORCES = '\n[axes]\n"contacts[2].force" = [0.05, 0.6]\n'


def rod():
    springs = np.full(N, SPRING)
    stiffness = np.diag(springs) + np.diag(np.append(springs[1:], 0.0))
    stiffness -= np.diag(springs[1:], 1) + np.diag(springs[1:], -1)
    return {"M": MASS * np.eye(N), "K": stiffness}


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name, matrix in rod().items():
        mmwrite(f"{name}.mtx", coo_array(matrix), symmetry="symmetric")
    (tmp_path / "rod.toml").write_text(WHOLE + "reduce = { modes = 12 }\n" + JOINTS)
    return tmp_path


def refusal(capsys, *arguments):
    assert main([str(one) for one in arguments]) == 2
    return capsys.readouterr().err


def test_from_matrix_market_to_a_map_of_two_forces_in_three_commands(folder, capsys):
    assert main(["reduce", "rod.toml", "-o", "small.npz"]) == 0
    report = capsys.readouterr().out
    assert "60 degrees of freedom reduced to 16, with 12 modes; wrote small.npz" in report
    assert "natural frequencies within" in report
    assert "for r = 0.9 to 0.9; effective masses of contacts are up to" in report
    assert "against all 56 modes beta_noslip changes by less than 0.01 %" in report
    (line,) = (one for one in report.splitlines() if "in [system]:" in one)
    scale = float(line.split("frequency_scale = ")[1].split(",")[0])
    first = np.sqrt(eigh(*(rod()[name] for name in "KM"), eigvals_only=True)[0])
    assert scale == pytest.approx(first, rel=1e-9)
    small = f'[system]\nmatrices = "small.npz"\nfrequency_scale = {scale!r}\n'
    (folder / "small.toml").write_text(small + JOINTS + FORCES)
    assert main(["map", "small.toml", "-o", "forces.nc", "--quiet"]) == 0
    assert main(["plot", "forces.nc", "--against", "contacts_2_force", "-o", "forces.png"]) == 0
    assert (folder / "forces.png").stat().st_size > 0
    found = xr.load_dataset("forces.nc")
    assert found.sizes["contacts_2_force"] == 2
    (ax,) = fm.plot_forces(found)
    assert "flange" in ax.get_ylabel()
    assert "fixed-wall 20" in ax.get_xlabel()
    # the whole rod in two of the cells: the reduction costs below a per cent of the motion
    cells = {"r": [0.9], "beta": [0.2], "outputs": ["regime", "contact_amplitude"]}
    for force in (0.05, 0.6):
        joints = [{"masses": [20]}, {"kind": "between-masses", "masses": [39, 40], "stiffness": 30.0,
                                     "force": force}, {"masses": [60], "ratio": 0.5}]  # fmt: skip
        whole = fm.System(
            matrices=rod(), contacts=joints, load_mass=60, damping_ratios=0.01, stiffness_scale=2.0e4
        )
        wanted = fm.sweep(whole, **cells)
        own = found.sel(contacts_2_force=force, beta=[0.2], method="nearest")
        np.testing.assert_array_equal(own.regime.squeeze(), wanted.regime.squeeze())
        largest = float(wanted.contact_amplitude.max())
        difference = own.contact_amplitude.squeeze() - wanted.contact_amplitude.squeeze()
        assert float(abs(difference).max()) < 0.01 * largest


def test_the_file_gives_the_system_of_the_configuration(folder):
    """The same masses under the same numbers, and the same boundaries to the bit."""
    assert main(["reduce", "rod.toml", "-o", "small.npz", "--quiet"]) == 0
    reduced = fm.load_config("rod.toml").system
    scale = {"frequency_scale": reduced.omega_1, "stiffness_scale": 2.0e4, "load_mass": 60}
    again = fm.System(matrices="small.npz", contacts=reduced.contacts, damping_ratios=0.01, **scale)
    assert again.dofs.numbers == reduced.dofs.numbers
    assert {20, 39, 40, 60} <= set(again.dofs.numbers)
    for name in ("beta_noslip", "beta_stick"):
        one, other = (fm.boundaries(system, [0.5, 0.9])[name] for system in (reduced, again))
        np.testing.assert_array_equal(one, other)


def test_names_of_nodes_stay(folder):
    """Labels of Abaqus name contacts, loads and rows of the small file, in files and in configurations."""
    labels = [(100 + k // 3, k % 3 + 1) for k in range(N)]
    for name, matrix in rod().items():
        written.abaqus(folder / f"{name}.mtx", matrix, labels)
    system = {
        "contacts": [{"masses": ["106.2"], "stiffness": 3.0}, {"masses": ["119.3"]}],
        "load_mass": "112.1", "damping_ratios": 0.01,
    }  # fmt: skip
    reduced = fm.System(matrices={"M": "M.mtx", "K": "K.mtx"}, reduce={"modes": 8}, **system)
    assert {"106.2", "112.1", "119.3"} <= set(reduced.dofs.written_labels)
    np.savez("small.npz", **reduced.matrices.named_arrays)
    again = fm.System(matrices="small.npz", frequency_scale=reduced.omega_1, **system)
    assert again.dofs == fm.System(matrices="small.npz", **system).dofs
    assert again.dofs.written_labels == reduced.dofs.written_labels
    assert again.dofs.numbers == reduced.dofs.numbers
    wanted = fm.boundaries(reduced, [0.5, 1.2])
    np.testing.assert_array_equal(fm.boundaries(again, [0.5, 1.2]).beta_stick, wanted.beta_stick)
    (folder / "again.toml").write_text(wanted.attrs["config"])
    assert fm.load_config("again.toml").system.contacts[0].label == "fixed-wall 106.2"


def test_refusals(folder, capsys):
    (folder / "whole.toml").write_text(WHOLE + JOINTS)
    message = refusal(capsys, "reduce", "whole.toml")
    assert "cannot reduce: the key reduce is missing; write reduce = { modes = 16 } below [system]" in message
    assert main(["reduce", "whole.toml", "--set", "system.reduce.modes=16", "--quiet"]) == 0
    assert (folder / "whole-reduced.npz").exists()
    assert "-o must end in .npz; got small.nc" in refusal(capsys, "reduce", "rod.toml", "-o", "small.nc")
    message = refusal(capsys, "reduce", "rod.toml", "--set", "system.reduce.modes=0")
    assert "system.reduce: cannot keep the error below 0.001 in the range of r with 0 modes" in message
    assert "modes suffice" in message
