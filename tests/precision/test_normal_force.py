"""Closed forms of contacts whose normal force moves with the structure, against an independent program, the
equations themselves, and the stability of their linearisation by differences.
"""

import math

import numpy as np
import pytest

from frictionmap.general.normal_force import (
    NormalSpring,
    Structure,
    coupling,
    locks_itself,
    no_slip_preload,
    sliding_limit,
    steady_sliding,
)

E1, E2 = np.eye(2)


def structure_of(row):
    return Structure(*(np.array(row[key]) for key in "MCK"))


def mode_coupling(damping=0.0):
    """Two directions of one mass with a stiffness between them; the first slides, the second presses."""
    return Structure(np.eye(2), damping * np.eye(2), np.array([[2.0, 0.35], [0.35, 1.2]]))


def random_structure(rng, n, damping):
    a = rng.normal(size=(n, n))
    stiffness = a @ a.T + np.eye(n)
    mass = np.diag(rng.uniform(0.5, 2.0, n))
    return Structure(mass, damping * (stiffness + mass), stiffness)


def test_preloads_of_an_independent_program(reference_table):
    """2e-9: the program brackets the slip of its motions."""
    for row in reference_table("laws.json")["no_slip"]:
        own = row["contact"]
        contact = NormalSpring(np.array(own["c"]), np.array(own["d"]), own["kn"])
        loads = {int(n): np.array([complex(*z) for z in load]) for n, load in row["loads"].items()}
        found = no_slip_preload(structure_of(row), contact, own["phi"], row["r"], loads, own["kt"])
        assert abs(found - row["preload_no_slip"]) < 1e-12 * found
        assert abs(coupling(structure_of(row), contact) - row["eta"]) < 1e-12


def test_flutter_limits_of_an_independent_program(reference_table):
    for row in reference_table("laws.json")["flutter"]:
        contact = NormalSpring(np.array(row["c"]), np.array(row["d"]), row["kn"])
        found = sliding_limit(structure_of(row), contact, -row["belt_sign"])
        assert found.kind == row["kind"]
        assert abs(found.phi - row["phi_flutter"]) < 1e-10 * found.phi


def feasible(structure, contact, phi, r, loads, spring, preload):
    """Whether a constant force exists with |F + g| <= phi N at 20,001 phases."""
    tau = np.linspace(0.0, 2.0 * math.pi, 20001)
    c, d = contact.friction, contact.normal
    pressed = structure.stiffness + contact.stiffness * np.outer(d, d)
    force, normal = np.zeros_like(tau), np.zeros_like(tau)
    for n, load in loads.items():
        o = n * r
        x = np.linalg.solve(
            pressed + spring * np.outer(c, c) - o * o * structure.mass + 1j * o * structure.damping, load
        )
        force += (spring * (c @ x) * np.exp(1j * n * tau)).real
        normal += (contact.stiffness * (d @ x) * np.exp(1j * n * tau)).real
    g = np.linspace(-20.0, 20.0, 40001)
    # a constant force g displaces the structure by -K'^-1 c g
    shift = -contact.stiffness * (d @ np.linalg.solve(pressed, c)) * g
    above = (force - phi * normal).max() + g - phi * (preload + shift)
    below = (-force - phi * normal).max() - g - phi * (preload + shift)
    return bool((np.maximum(above, below) <= 0.0).any())


@pytest.mark.parametrize("seed", range(4))
def test_preload_is_the_least_that_holds(seed):
    rng = np.random.default_rng(seed)
    structure = random_structure(rng, 3, 0.05)
    contact = NormalSpring(rng.normal(size=3), rng.normal(size=3), 1.5)
    loads = {n: rng.normal(size=3) + 1j * rng.normal(size=3) for n in (1, 2, 5)[: 1 + seed % 3]}
    phi = 0.9 * min(0.6, 1.0 / abs(coupling(structure, contact)))
    least = no_slip_preload(structure, contact, phi, 0.8, loads, 2.0)
    assert not feasible(structure, contact, phi, 0.8, loads, 2.0, 0.99 * least)
    assert feasible(structure, contact, phi, 0.8, loads, 2.0, 1.01 * least)


def test_stiff_springs_hold_like_rigid_contacts():
    rng = np.random.default_rng(5)
    structure = random_structure(rng, 3, 0.05)
    contact = NormalSpring(np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0]), 1.0)
    loads = {1: np.array([1.0, 0.3j, 0.2])}
    rigid = no_slip_preload(structure, contact, 0.3, 0.8, loads)
    off = [no_slip_preload(structure, contact, 0.3, 0.8, loads, kt) / rigid - 1.0 for kt in (1e4, 1e6)]
    assert abs(off[1]) < 1e-4
    assert abs(off[1] / off[0] - 0.01) < 1e-4  # the error falls like 1/k_t


def test_self_locking():
    """From |phi eta| = 1 on a constant force holds any load, and one sense of sliding diverges there."""
    structure, contact = mode_coupling(0.02), NormalSpring(E1, E2, 1.0)
    limit = 1.0 / abs(coupling(structure, contact))
    loads = {1: np.array([3.0, 1.0j])}
    assert not locks_itself(structure, contact, 0.999 * limit)
    assert no_slip_preload(structure, contact, 0.999 * limit, 0.8, loads, 2.0) > 0.0
    assert locks_itself(structure, contact, 1.001 * limit)
    assert no_slip_preload(structure, contact, 1.001 * limit, 0.8, loads, 2.0) == 0.0
    kinds = {sliding_limit(structure, contact, sense).kind: sliding_limit(structure, contact, sense).phi
             for sense in (1, -1)}  # fmt: skip
    assert abs(kinds["divergence"] - limit) < 1e-12 * limit


@pytest.mark.parametrize("sense", [1, -1])
def test_steady_sliding_obeys_the_equations(sense):
    structure, contact, phi, preload = mode_coupling(0.02), NormalSpring(E1, E2, 1.0), 0.6, 1.0

    def acceleration(state):
        x, v = state[:2], state[2:]
        normal = max(0.0, preload + contact.stiffness * (contact.normal @ x))
        force = sense * phi * normal * contact.friction + (normal - preload) * contact.normal
        return np.linalg.solve(structure.mass, -structure.damping @ v - structure.stiffness @ x - force)

    found = steady_sliding(structure, contact, phi, sense, preload)
    rest = np.concatenate((found.place, np.zeros(2)))
    assert found.normal_force > 0.0
    assert abs(found.normal_force - preload - contact.stiffness * found.place[1]) < 1e-14
    assert np.abs(acceleration(rest)).max() < 1e-14
    step = 1e-3  # the right side is linear: differences are exact
    slopes = [
        (acceleration(rest + step * e) - acceleration(rest - step * e)) / (2.0 * step) for e in np.eye(4)
    ]
    matrix = np.vstack((np.hstack((np.zeros((2, 2)), np.eye(2))), np.array(slopes).T))
    roots = np.linalg.eigvals(matrix)
    assert abs(found.growth - roots.real.max()) < 1e-12
    assert np.abs(roots - (found.growth + 1j * found.frequency)).min() < 1e-12


def test_mode_coupling():
    """The growth found by the program of the notes, and the limit of two undamped directions."""
    contact = NormalSpring(E1, E2, 1.0)
    growths = [steady_sliding(mode_coupling(0.02), contact, 0.6, sense, 1.0).growth for sense in (1, -1)]
    assert abs(max(growths) - 0.0858459277768) < 1e-12
    (flutter,) = (
        found for sense in (1, -1)
        if (found := sliding_limit(mode_coupling(), contact, sense)).kind == "flutter"
    )  # fmt: skip
    k11, k22, k12, kn = 2.0, 1.2, 0.35, 1.0
    assert abs(flutter.phi - ((k11 - k22 - kn) ** 2 + 4.0 * k12**2) / (4.0 * k12 * kn)) < 1e-12
    assert abs(flutter.phi - 0.378571428571) < 1e-12


@pytest.mark.parametrize("damping", [0.0, 0.01, 0.1])
def test_stability_changes_at_the_limit(damping):
    rng = np.random.default_rng(17)
    limits = 0
    for _ in range(20):
        structure = random_structure(rng, int(rng.integers(2, 5)), damping)
        n = len(structure.mass)
        contact = NormalSpring(rng.normal(size=n), rng.normal(size=n), rng.uniform(0.3, 3.0))
        phi, _ = sliding_limit(structure, contact, 1)
        for share in (0.2, 0.6, 0.95, 0.999):
            at = share * phi if np.isfinite(phi) else 100.0 * share
            assert steady_sliding(structure, contact, at, 1, 1.0).growth < 1e-7
        if np.isfinite(phi):
            limits += 1
            assert steady_sliding(structure, contact, 1.001 * phi, 1, 1.0).growth > 1e-7
    assert limits > 5
