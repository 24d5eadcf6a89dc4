"""Damping matrices that couple the modes, taken by their diagonal: the change, and the report of it."""

import re

import numpy as np
import pytest
from scipy.linalg import eigh
from structures import CHAIN, RATIOS

import frictionmap as fm
from benchmarks.references.naive import naive_steady_state

M, K = CHAIN["M"], CHAIN["K"]
SETTINGS = {"contact_masses": [3], "load_mass": 1, "frequency_scale": 1.0}
DASHPOT = 0.02


def damping(dashpot, mass=2):
    """Rayleigh damping, and a dashpot between a mass and the ground."""
    C = 0.01 * M + 0.01 * K
    C[mass - 1, mass - 1] += dashpot
    return C


def diagonal(C):
    """What is on its diagonal in the undamped modes."""
    phi = eigh(K, M)[1]
    shaped = M @ phi
    return shaped @ np.diag(np.diag(phi.T @ C @ phi)) @ shaped.T


def compliances(r, C):
    """Of contact and load, free and with the contact held; each over its static ones."""
    forces = np.eye(3)[:, [2, 0]]
    static = np.linalg.inv(K)[np.ix_([2, 0], [2, 0])]
    free = forces.T @ np.linalg.inv(K - r * r * M + 1j * r * C) @ forces
    held = np.zeros((2, 2), dtype=complex)
    held[1, 1] = np.linalg.inv((K - r * r * M + 1j * r * C)[:2, :2])[0, 0]
    return [one / np.sqrt(np.outer(np.diag(static), np.diag(static))) for one in (free, held)]


def test_the_change_of_linear_responses():
    C = damping(DASHPOT)
    system = fm.System(matrices={"M": M, "K": K, "C": C}, decouple=0.5, **SETTINGS)
    np.testing.assert_allclose(system.modes.damping, diagonal(C), rtol=1e-9, atol=1e-12)
    r = np.linspace(0.1, 2.2, 3000)
    errors = []
    for at in r:
        found, true = compliances(at, diagonal(C)), compliances(at, C)
        size = max(np.linalg.norm(one) for one in true)
        errors.append(max(np.linalg.norm(one - other) for one, other in zip(found, true, strict=True)) / size)
    # it has been looked for at fewer frequencies
    assert 0.9 * max(errors) < system.decoupling(r) <= 1.001 * max(errors)


def test_more_than_is_allowed_is_refused():
    matrices = {"M": M, "K": K, "C": damping(DASHPOT)}
    whole = fm.System(matrices=matrices, **SETTINGS)
    np.testing.assert_allclose(whole.modes.damping, matrices["C"], rtol=1e-15)
    system = fm.System(matrices=matrices, decouple=0.01, **SETTINGS)
    with pytest.raises(
        fm.InputError, match=r"decouple must be at least .*, the change of linear responses"
    ) as caught:
        fm.boundaries(system, [0.1, 2.0])
    least = float(re.search(r"at least ([0-9.]+)", str(caught.value))[1])
    assert system.decoupling(np.array([0.1, 0.11])) < 0.01  # also as a part of what was refused
    ds = fm.boundaries(fm.System(matrices=matrices, decouple=1.1 * least, **SETTINGS), [0.1, 2.0])
    assert re.search(r"^C, replaced by its modal diagonal.* for r = 0.1 to 2$", ds.attrs["decoupling"])
    diagonal_alone = fm.System(matrices={"M": M, "K": K, "C": diagonal(damping(DASHPOT))}, **SETTINGS)
    np.testing.assert_allclose(ds.beta_lim, fm.boundaries(diagonal_alone, [0.1, 2.0]).beta_lim, rtol=1e-12)
    assert "decoupling" not in fm.boundaries(diagonal_alone, [0.1, 2.0]).attrs


@pytest.mark.parametrize(("r", "beta"), [(0.45, 0.15), (0.62, 0.15), (1.1, 0.05)])
def test_motions_with_friction_change_about_as_much(r, beta):
    """Against the motion with the whole matrix, marched in small steps."""
    C = damping(0.005)
    system = fm.System(matrices={"M": M, "K": K, "C": C}, decouple=0.2, **SETTINGS)
    ds = fm.sweep(system, [r], [beta], outputs=["amplitude", "stops_per_cycle"])
    chain = {"gamma": RATIOS["mass_ratios"], "kappa": RATIOS["stiffness_ratios"], "contact": ("wall", 3)}
    settings = {**chain, "load": 1, "r": r, "beta": beta, "points": 100}
    taken, whole = (naive_steady_state(damping=one, **settings) for one in (diagonal(C), C))
    assert taken.stops == whole.stops == ds.stops_per_cycle.item()
    np.testing.assert_allclose(ds.amplitude.values.ravel(), taken.X, rtol=1e-6)
    change = np.abs(np.array(taken.X) / np.array(whole.X) - 1.0).max()
    assert 1e-5 < change < 2.0 * system.decoupling(np.array([0.1, 2.2]))


def test_a_matrix_of_modal_damping_is_coupled_by_reduction():
    """By as little as the modes left out matter."""
    rng = np.random.default_rng(3)
    n = 40
    springs = rng.uniform(0.5, 2.0, n)
    stiffness = np.diag(springs + np.append(springs[1:], 0.0))
    stiffness -= np.diag(springs[1:], 1) + np.diag(springs[1:], -1)
    mass = np.diag(rng.uniform(0.5, 2.0, n))
    squares, phi = eigh(stiffness, mass)
    shaped = mass @ phi
    C = shaped @ np.diag(2.0 * 0.02 * np.sqrt(squares)) @ shaped.T
    given = {"matrices": {"M": mass, "K": stiffness, "C": C}, "contact_masses": [27], "load_mass": 5}
    whole = fm.System(reduce={"modes": 16}, **given)
    assert "decoupling" not in fm.boundaries(whole, [0.2, 5.0]).attrs
    system = fm.System(reduce={"modes": 16}, decouple=0.01, **given)
    assert 0.0 < system.decoupling(np.array([0.2, 5.0])) < 1e-3
    np.testing.assert_allclose(system.modes.zeta[:5], 0.02, rtol=2e-3)
    ds = fm.boundaries(system, np.linspace(0.2, 5.0, 9))
    assert {"reduction", "decoupling"} <= set(ds.attrs)


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"decouple": 0}, "decouple must be > 0; got 0"),
        ({"decouple": 2}, "decouple must be <= 1; got 2"),
        ({"decouple": "yes"}, "decouple must be a number; got 'yes'"),
    ],
)
def test_what_is_refused(settings, message):
    with pytest.raises(fm.InputError, match=message):
        fm.System(matrices={"M": M, "K": K, "C": damping(DASHPOT)}, **SETTINGS, **settings)
    with pytest.raises(fm.InputError, match="cannot use decouple without matrices"):
        fm.System(**settings)
