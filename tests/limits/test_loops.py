"""Permanent sticking of contacts that close a loop, against linear programs over the cycle."""

import numpy as np
import pytest
from general_systems import KINDS
from scipy.optimize import linprog

import frictionmap as fm

PAIRS = [(1, 2), (2, 3), (1, 3)]


def program(mass, stiffness, damping, w, load, r, limits):
    """Least scale for which forces within scale times the limits exist at every phase (720 of them)."""
    n, count = w.shape
    dynamic = stiffness - r * r * mass + 1j * r * damping
    kept = np.linalg.svd(w)[0][:, np.linalg.matrix_rank(w) :]  # motions that all contacts allow
    x = kept @ np.linalg.solve(kept.T @ dynamic @ kept, kept.T @ load)
    f = load - dynamic @ x  # = W F
    worst = 0.0
    for tau in np.linspace(0.0, np.pi, 720, endpoint=False):
        bounds = np.hstack((np.vstack((np.eye(count), -np.eye(count))), -np.tile(limits, 2)[:, np.newaxis]))
        one = linprog(
            [*np.zeros(count), 1.0], A_ub=bounds, b_ub=np.zeros(2 * count),
            A_eq=np.hstack((w, np.zeros((n, 1)))), b_eq=(f * np.exp(1j * tau)).real,
            bounds=[(None, None)] * (count + 1),
        )  # fmt: skip
        assert one.status == 0
        worst = max(worst, one.fun)
    return worst


def test_a_triangle():
    """Three unit masses, zeta 0.02: the cut of mass 1 decides."""
    system = fm.System(
        contacts=[fm.Contact("between-masses", pair) for pair in PAIRS], mass_ratios=[1, 1, 1],
        stiffness_ratios=[1, 1, 1], damping_ratios=0.02,
    )  # fmt: skip
    ds = fm.boundaries(system, [0.5], [1.0, 1.25])
    assert ds.beta_stick.values.ravel() == pytest.approx(0.992677024995 / np.array([1.0, 1.25]), abs=1e-12)
    assert set(ds.data_vars) == {"beta_stick"}


@pytest.mark.parametrize("seed", range(4))
def test_random_loops_against_linear_programs(seed):
    """Four masses; a triangle and two walls: two loops."""
    rng = np.random.default_rng(seed)
    mass, k = np.diag(rng.uniform(0.5, 2.0, 4)), rng.uniform(0.5, 2.0, 4)
    stiffness = np.diag(k + np.append(k[1:], 0.0)) - np.diag(k[1:], 1) - np.diag(k[1:], -1)
    damping = 0.05 * stiffness
    given, mus = rng.uniform(0.3, 1.5, 5), rng.uniform(1.0, 1.5, 5)
    places = [("between-masses", pair) for pair in PAIRS] + [("fixed-wall", (1,)), ("fixed-wall", (3,))]
    contacts = [
        fm.Contact(kind, at, ratio=b, mu=m) for (kind, at), b, m in zip(places, given, mus, strict=True)
    ]
    system = fm.System(
        contacts=contacts, matrices={"M": mass, "K": stiffness, "C": damping}, frequency_scale=1.0,
        load=rng.normal(size=4) + 1j * rng.normal(size=4),
    )  # fmt: skip
    w = system.general.vectors.T
    wanted = program(mass, stiffness, damping, w, np.array(system.load), 0.7, given * mus)
    found = fm.boundaries(system, [0.7]).beta_stick.item()
    assert wanted <= found * (1.0 + 1e-9)
    assert found == pytest.approx(wanted, rel=2e-5)  # 720 phases


def test_reference_loops(reference_table):
    for row in reference_table("contacts.json")["redundant"]:
        contacts = [
            fm.Contact(KINDS[kind], masses, ratio=ratio, mu=mu)
            for (kind, *masses), ratio, mu in zip(row["contacts"], row["ray"], row["mu"], strict=True)
        ]
        given = {key: np.array(row[name]) for key, name in (("M", "M"), ("K", "K"), ("C", "C1"))}
        system = fm.System(matrices=given, frequency_scale=1.0, contacts=contacts, load_mass=row["load"])
        assert fm.boundaries(system, [row["r"]]).beta_stick.item() == pytest.approx(
            row["scale_stick"], rel=1e-10
        )
