"""Drifts, accelerations and forces on the base: from the equations of motion along the motion in time."""

import numpy as np
import pytest

import frictionmap as fm
from frictionmap.command_line.cli import main

OUTPUTS = ("drift", "acceleration_amplitude", "base_force")
SOLVER = fm.Solver(outputs=("regime", *OUTPUTS))
TWO = {"mass_ratios": [1.0, 0.8], "stiffness_ratios": [1.0, 1.2], "damping_ratios": 0.05}
BRACES = [fm.Contact("joined-base-wall", 1), fm.Contact("between-masses", (1, 2), ratio=0.5)]
UNEVEN = {"load_harmonics": {1: [1.0, 0.2j], 2: [0.3, 0.0]}, "load_offset": [0.3, 0.1]}

CASES = {
    "one mass": (fm.System(damping_ratios=0.05), 0.4, 1.0),
    "one mass, stop after stop": (fm.System(damping_ratios=0.05), 0.65, 1.3),
    "joined base wall": (
        fm.System("joined-base-wall", (1,), **TWO, damping_reference="base"), 0.4, 1.0,
    ),
    "two braces": (fm.System(excitation="base", contacts=BRACES, **TWO), 0.4, 1.0),
    "two braces that stick": (fm.System(excitation="base", contacts=BRACES, **TWO), 4.4, 1.0),
    "uneven load": (fm.System(contacts=[fm.Contact("fixed-wall", 1)], **TWO, **UNEVEN), 0.4, 1.5),
    "sliding base": (
        fm.System(
            "joined-base-wall", (1,), mass_ratios=[1, 3], stiffness_ratios=[0, 1], damping_ratios=0.05
        ),
        0.2, 1.0,
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", CASES)
def test_values_are_those_along_the_motion(name):
    system, beta, mu = CASES[name]
    r, modes, general = 0.8, system.modes, system.contact_system
    one = fm.response(system, r, beta, mu, solver=SOLVER, points=20_000)
    tau, x, v = one.tau.values, one.x.values, one.v.values
    u = np.cos(tau) * (system.excitation == "base")
    du = -np.sin(tau) * (system.excitation == "base")
    drift = np.diff(np.vstack((u, x)), axis=0)
    np.testing.assert_allclose(one.drift, 0.5 * np.ptp(drift, axis=1), rtol=1e-6, atol=1e-13)
    loads = sum((p[:, np.newaxis] * np.exp(1j * n * tau)).real for n, p in general.forces.items())
    loads = loads + general.offset[:, np.newaxis] + 0.0 * x
    friction = np.atleast_2d(one.friction.values)
    to_base = system.damping_reference == "base"
    on_masses = (
        loads
        - modes.stiffness @ (x - u)
        - r * modes.damping @ (v - du * to_base)
        - general.vectors.T @ friction
    )
    acceleration = np.linalg.solve(modes.mass, on_masses)
    # samples miss a jump by at most one step of 3e-4, over which values change by a few parts in a thousand
    np.testing.assert_allclose(one.acceleration_amplitude, np.abs(acceleration).max(axis=1), rtol=2e-3)
    base = (loads - modes.mass @ acceleration).sum(axis=0)
    assert one.base_force.item() == pytest.approx(np.abs(base).max(), rel=2e-3)
    cell = fm.sweep(system, [r], [beta], mu, solver=SOLVER).isel(mu=0, r=0, beta=0)
    for output in OUTPUTS:
        np.testing.assert_allclose(cell[output], one[output], rtol=1e-11, atol=1e-13)


def test_the_force_on_the_base_is_that_of_the_closed_forms():
    """The engine of one rigid contact has the largest force on the ground among its response curves."""
    system = fm.System(mass_ratios=[1, 0.8], stiffness_ratios=[1, 1.2], damping_ratios=0.05)
    r, beta = [0.5, 0.8, 1.4], [0.1, 0.5, 1.2]
    cells = fm.sweep(system, r, beta, solver=SOLVER)
    curves = fm.curves(system, r, beta, quantities=["transmitted_force"])
    np.testing.assert_allclose(cells.base_force, curves.transmitted_force, rtol=1e-9)


@pytest.mark.parametrize("name", ["one mass", "two braces", "two braces that stick", "uneven load"])
def test_curves_have_the_values_of_maps(name):
    system, beta, mu = CASES[name]
    cells = fm.sweep(system, [0.8], [beta], mu, solver=SOLVER)
    curves = fm.curves(system, [0.8], [beta], mu, quantities=OUTPUTS)
    for output in OUTPUTS:
        np.testing.assert_allclose(curves[output], cells[output], rtol=1e-11, atol=1e-13)


def test_curves_from_the_command_line(tmp_path):
    text = (
        "[system]\ndamping_ratios = 0.05\n[grid]\nr = [0.5, 0.8]\nbeta = [0.1, 0.5]\n"
        '[curves]\nquantities = ["drift", "base_force"]\n'
    )
    (tmp_path / "one.toml").write_text(text)
    target = tmp_path / "one.nc"
    assert main(["curves", str(tmp_path / "one.toml"), "-o", str(target)]) == 0
    found = fm.open(target)
    cells = fm.sweep(fm.System(damping_ratios=0.05), [0.5, 0.8], [0.1, 0.5], solver=SOLVER)
    np.testing.assert_array_equal(found.base_force, cells.base_force)
    np.testing.assert_array_equal(found.drift, cells.drift)


def test_accelerations_in_si_units():
    units = fm.Units(natural_frequency="2 Hz", stiffness="1 kN/mm", base_amplitude="5 mm")
    system = fm.System("joined-base-wall", (1,), damping_ratios=0.05)
    ds = fm.sweep(system, [0.5, 0.8], [0.2], solver=SOLVER, units=units)
    one = 5e-3 * (2.0 * np.pi * 2.0) ** 2
    np.testing.assert_allclose(ds.acceleration_amplitude_m_s2, one * ds.acceleration_amplitude, rtol=1e-12)
    np.testing.assert_allclose(ds.base_force_N, 5e3 * ds.base_force, rtol=1e-12)
    np.testing.assert_allclose(ds.drift_m, 5e-3 * ds.drift, rtol=1e-12)


def test_drifts_need_storeys():
    system = fm.System(matrices={"M": np.eye(2), "K": [[2.0, -1.0], [-1.0, 1.0]]})
    with pytest.raises(fm.InputError, match="cannot compute drift of a structure given by matrices"):
        fm.sweep(system, [0.5], [0.1], solver=SOLVER)
