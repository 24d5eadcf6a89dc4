"""Random chains with one to three contacts on belts, at walls and between masses, rigid and elastic."""

from itertools import combinations

import numpy as np

import frictionmap as fm


def _contact(rng: np.random.Generator, place: tuple[int, ...]) -> fm.Contact:
    """A contact at a mass or between two; half of them have a spring, and half of those at walls a belt."""
    own = {"ratio": rng.uniform(0.3, 1.5), "stiffness": rng.choice([None, rng.uniform(0.5, 20.0)])}
    if len(place) == 2:
        return fm.Contact("between-masses", list(place), **own)
    return fm.Contact("fixed-wall", place[0], wall_velocity=rng.choice([0.0, rng.normal()]), **own)


def random_chain(rng: np.random.Generator, belts: bool = True) -> fm.System:
    """A chain of one to four masses; contacts with the ground and with each other make no loop of rigid ones.

    belts : whether walls may move
    """
    n = int(rng.integers(1, 5))
    places = [(i,) for i in range(1, n + 1)] + list(combinations(range(1, n + 1), 2))
    count = int(rng.integers(1, min(n, 3) + 1))
    while True:
        chosen = [places[k] for k in rng.permutation(len(places))[:count]]
        vectors = np.zeros((count, n))
        for row, place in zip(vectors, chosen, strict=True):
            row[np.array(place) - 1] = [-1.0, 1.0][-len(place) :]
        if np.linalg.matrix_rank(vectors) == count:
            break
    contacts = [_contact(rng, place) for place in chosen]
    if not belts:
        contacts = [
            fm.Contact(one.kind, one.masses, ratio=one.ratio, stiffness=one.stiffness) for one in contacts
        ]
    return fm.System(
        mass_ratios=np.concatenate(([1.0], rng.uniform(0.3, 3.0, n - 1))),
        stiffness_ratios=np.concatenate(([1.0], rng.uniform(0.3, 3.0, n - 1))),
        damping_ratios=rng.choice([0.0, 0.02, 0.2]), contacts=contacts,
    )  # fmt: skip
