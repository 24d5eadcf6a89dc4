"""What is proved about motions under any record, in random chains with several contacts."""

from functools import partial

import numpy as np
import pytest
from random_chains import random_chain

import frictionmap as fm


def _energy(system, x, v, friction):
    """Kinetic energy, and that of all springs, (time,); x, v : (n, time), friction : (contacts, time)."""
    softness = [0.0 if one.stiffness is None else 1.0 / one.stiffness for one in system.contacts]
    modes = system.modes
    twice = (v * (modes.mass @ v)).sum(axis=0) + (x * (modes.stiffness @ x)).sum(axis=0)
    return 0.5 * (twice + softness @ friction**2)


def _apart(seed):
    """Energy of the difference of two motions of a system over their common times, and their events."""
    rng = np.random.default_rng(seed)
    system = random_chain(rng)
    n = system.n
    record = fm.Record(
        2.0 * rng.normal(size=40), 0.4, quantity="force", mass=int(rng.integers(1, n + 1)),
        interpolation=str(rng.choice(["linear", "cubic", "hold"])),
    )  # fmt: skip
    starts = [{"x": rng.normal(size=n), "v": rng.normal(size=n)} for _ in range(2)]
    runs = [
        fm.history(system, record, beta=0.4, start=start, after=5.0, beta_hold=False, threads=1)
        for start in starts
    ]
    # of times twice there, both sides of an event, one: the state is continuous
    _, *places = np.intersect1d(runs[0].time.values, runs[1].time.values, return_indices=True)
    rows = [
        [ds[name].values.reshape(-1, ds.time.size)[:, place] for name in ("x", "v", "friction")]
        for ds, place in zip(runs, places, strict=True)
    ]
    energy = _energy(system, *(one - two for one, two in zip(*rows, strict=True)))
    return energy, sum(ds.events.item() for ds in runs)


@pytest.mark.parametrize(
    "seeds", [range(20), pytest.param(range(20, 1000), marks=pytest.mark.slow)], ids=["few", "1000"]
)
def test_two_motions_never_move_apart(seeds):
    """history.md 2: for mu = 1 the energy of their difference never grows, whatever the record."""
    moved = 0
    for seed in seeds:
        energy, events = _apart(seed)
        assert energy.size >= 40
        assert (np.diff(energy) <= 1e-14 * energy[0]).all(), seed
        moved += events > 0
    assert moved > 0.99 * len(seeds)  # or nothing is said of contacts: a few hold all the time


@pytest.mark.parametrize(
    "seeds", [range(20), pytest.param(range(20, 200), marks=pytest.mark.slow)], ids=["few", "200"]
)
def test_from_beta_hold_on_nothing_moves(seeds):
    """history.md 2: from rest, rigid and elastic, any mu where the contacts are rigid."""
    for seed in seeds:
        rng = np.random.default_rng(seed)
        system = random_chain(rng, belts=False)
        elastic = any(one.stiffness is not None for one in system.contacts)
        mu = 1.0 if elastic else rng.uniform(1.0, 2.0)
        record = fm.Record(
            rng.normal(size=40), 0.4, quantity="force", mass=int(rng.integers(1, system.n + 1))
        )
        follow = partial(fm.history, system, record, mu=mu, after=20.0, samples="none", threads=1)
        hold = follow().beta_hold.item()
        assert hold > 0.0
        beta = [hold * (1.0 - 1e-9), hold * (1.0 + 1e-9)]
        events = follow(beta=beta, beta_hold=False).events.values.ravel()
        assert events[0] > 0, seed
        assert events[1] == 0, seed
