"""Contacts of loops at their limits, with forces that do not change: against time stepping, from two starts.

Of contacts that hold a mass without a load one may be at its limit, and stay there for as long as the mass
rests: whichever of them has the force that varies, its motion must go on.
"""

from itertools import combinations

import numpy as np
import pytest

import frictionmap as fm
from benchmarks.peers.moreau import march

#: Seeds of random systems in which a force stays at its limit; two to five masses.
SEEDS = (28, 38, 70, 78, 112, 182, 232, 262)

OUTPUTS = ("contact_peak_to_peak", "stops_per_cycle", "stuck_fraction", "status")


def random_loops(seed):
    """A chain under a load on mass 1, with contacts between any masses and the wall; its r and beta."""
    rng = np.random.default_rng([77, seed])
    n = int(rng.integers(2, 6))
    pairs = list(combinations(range(n + 1), 2))
    while True:
        count = int(rng.integers(3, min(len(pairs), n + 4) + 1))
        chosen = [pairs[k] for k in rng.permutation(len(pairs))[:count]]
        w = np.zeros((n + 1, count))
        for j, ends in enumerate(chosen):
            w[list(ends), j] = -1.0, 1.0
        if np.linalg.matrix_rank(w[1:]) < count:
            break
    contacts = [
        fm.Contact("between-masses" if a else "fixed-wall", (a, b) if a else b, ratio=rng.uniform(0.3, 1.5))
        for a, b in chosen
    ]
    rng.normal(size=2 * n), rng.random(n)
    system = fm.System(
        contacts=contacts, load_mass=1, mass_ratios=[1.0, *rng.uniform(0.5, 2.0, n - 1)],
        stiffness_ratios=[1.0, *rng.uniform(0.3, 2.0, n - 1)],
        damping_ratios=10.0 ** rng.uniform(-2.0, -0.7),
    )  # fmt: skip
    r = system.modes.w[0] * rng.uniform(0.3, 3.0)
    return system, r, fm.boundaries(system, [r]).beta_stick.item() * rng.uniform(0.1, 0.98)


def stepped(system, r, beta, steps, cycles):
    """Ranges of the contacts by Moreau-Jean time stepping from rest, over the last of some periods."""
    mass, stiffness, damping = (getattr(system.modes, name) for name in ("mass", "stiffness", "damping"))
    w, h = np.ascontiguousarray(system.general.vectors.T), 2.0 * np.pi / steps
    inverse = np.linalg.inv(r * r * mass + 0.5 * h * r * damping + 0.25 * h * h * stiffness)
    load = np.cos(h * np.arange(steps + 1))
    limits = h * beta * np.array([one.ratio for one in system.contacts])
    share = inverse @ w
    _, ranges = march(
        (stiffness, r * damping, inverse), w, share, w.T @ share, limits, 0.5 * (load[1:] + load[:-1]), cycles
    )
    return ranges[1] - ranges[0]


@pytest.mark.parametrize("seed", SEEDS)
def test_a_force_that_stays_at_its_limit(seed):
    system, r, beta = random_loops(seed)
    found = {
        start: fm.sweep(system, [r], [beta], outputs=OUTPUTS, start=start).squeeze()
        for start in ("rest", "moving")
    }
    ranges = found["rest"].contact_peak_to_peak.values
    assert (found["rest"].stops_per_cycle > 0.0).any()
    for one in found.values():
        assert one.status == fm.regimes.RESOLVED
        np.testing.assert_allclose(one.contact_peak_to_peak, ranges, atol=1e-12 * ranges.max())
        np.testing.assert_allclose(one.stuck_fraction, found["rest"].stuck_fraction, atol=1e-6)
    off = [np.abs(stepped(system, r, beta, steps, 60) - ranges).max() / ranges.max() for steps in (512, 4096)]
    assert off[1] < 0.3 * off[0]
    assert off[1] < 1e-2
