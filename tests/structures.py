"""Structures that several tests take."""

import numpy as np

import frictionmap as fm

KINDS = {"wall": "fixed-wall", "base": "joined-base-wall", "masses": "between-masses"}


def chain(entry, zeta=0.0):
    """A system of the reference file."""
    kind, *masses = entry["contact"]
    return fm.System(
        contact=KINDS[kind], contact_masses=masses, load_mass=entry["load"],
        mass_ratios=[float(value) for value in entry["gamma"]],
        stiffness_ratios=[float(value) for value in entry["kappa"]], damping_ratios=zeta,
    )  # fmt: skip


def random_chain(rng, zeta):
    """A random chain, contact and load; and the same as the slow reference wants it."""
    n = int(rng.integers(2, 5))
    gamma, kappa = (np.concatenate(([1.0], rng.uniform(0.3, 3.0, n - 1))) for _ in range(2))
    kind = rng.choice(["wall", "base", "masses"])
    first = int(rng.integers(1, n)) if kind == "masses" else int(rng.integers(1, n + 1))
    contact = (str(kind), first)
    if kind == "masses":
        contact = ("masses", first, int(rng.integers(first + 1, n + 1)))
    load = 1 if kind == "base" else int(rng.integers(1, n + 1))
    entry = {"contact": contact, "load": load, "gamma": tuple(gamma), "kappa": tuple(kappa)}
    return chain(entry, zeta), entry


def chain_matrices(masses, springs):
    """M and K of a chain."""
    springs = np.asarray(springs, dtype=float)
    K = np.diag(springs + np.append(springs[1:], 0.0))
    K -= np.diag(springs[1:], 1) + np.diag(springs[1:], -1)
    return {"M": np.diag(np.asarray(masses, dtype=float)), "K": K}


#: A chain, by its ratios and by its matrices.
RATIOS = {"mass_ratios": [1.0, 0.7, 1.9], "stiffness_ratios": [1.0, 1.3, 0.6]}
CHAIN = chain_matrices(*RATIOS.values())

#: Three equal oscillators on a mass that a spring ties to the ground; coordinates 1, 2, 3 and 4.  The
#: oscillators against each other are two modes of one frequency, r = 2, and the mass does not feel them.
PENDANTS = {
    "M": np.diag([0.5, 0.5, 0.5, 1.0]),
    "K": np.array([[2.0, 0, 0, -2], [0, 2, 0, -2], [0, 0, 2, -2], [-2, -2, -2, 7]]),
}


def pendants(contact, load, **settings):
    return fm.System(
        contact_masses=[contact], load_mass=load, matrices=PENDANTS, frequency_scale=1.0, **settings
    )
