"""The largest forces in contacts that all hold: the friction from which nothing moves.

A contact holds for as long as abs(f) <= b nu.  Under a varying normal load the least b is the largest of
abs(f)/nu: with the largest excess f - b nu, at the instant t, b + excess/nu(t) is the next b (Dinkelbach).
It never exceeds the largest ratio, and converges quadratically.
"""

from copy import copy

import numpy as np

from .._kernels.general.problem import FLAT
from .cells import Asked, Found, Motions
from .channels import Drive
from .structure import Watched

#: Friction that nothing overcomes.
HOLDS = 1e150

#: Longest periods of the held structure after a record in which its largest force is looked for: undamped
#: modes of several frequencies come nearer and nearer to their bound without an end.
MOST_PERIODS = 100.0

#: A bound within this share of a force is that force with rounding error.
SAME = 1e-12

#: Ratios beyond this multiple of the force are those of a normal load of 0.
_INFINITE = 1e12

#: Steps to a ratio at most; each one squares its error.
_MOST_STEPS = 60


def holding_friction(motions: Motions, scale: np.ndarray, mu: np.ndarray, asked: Asked) -> np.ndarray:
    """Static friction that holds the contacts, (scales, mu, N)."""
    found = np.abs(scale)[:, np.newaxis] * motions.needed_friction(largest_forces(motions, asked))
    return np.repeat(found[:, np.newaxis], mu.size, axis=1)


def largest_forces(motions: Motions, asked: Asked) -> np.ndarray:
    """Largest force in every contact, over its normal load, with all contacts held, (N,).

    After the record the free vibration is followed until its energy bounds all later forces.
    """
    held = copy(motions)
    held.problem = motions.problem._replace(normal=np.zeros_like(motions.problem.normal), law=FLAT)
    period = 2.0 * np.pi / motions.held.slowest
    after = asked.after
    if after is None:
        after = period if motions.held.bed.active[0] else 0.0
    while True:
        forces, found = _ratios(motions, held, asked._replace(after=after, every=0))
        done = asked.after is not None or not 0.0 < after < MOST_PERIODS * period
        if done or (_bound(motions, found) <= forces * (1.0 + SAME)).all():
            return forces
        after *= 2.0


def _ratios(motions: Motions, held: Motions, asked: Asked) -> tuple[np.ndarray, Found]:
    """Largest abs(f)/nu within the time that is asked, and the motion."""
    normal = motions.problem.normal
    force = motions.watched.weights[motions.watched.places["friction"]]
    varying = normal.any(axis=1)
    load = np.zeros_like(force)
    load[:, -normal.shape[1] :] = normal
    friction = np.full(varying.size, HOLDS)
    ratio = np.zeros(varying.size)
    for _ in range(_MOST_STEPS):
        # the excess over b is that of f -+ b (nu - 1)
        finite = np.where(np.isinf(ratio), 0.0, ratio)
        shift = finite[:, np.newaxis] * load
        held.watched = Watched(np.vstack((force - shift, force + shift)), {})
        found = held.follow(friction, friction, 1.0, asked, False)
        high, low = found.kept.peaks[1, : varying.size], found.kept.peaks[0, varying.size :]
        excess = np.array((high, -low)) - finite
        times = np.array((found.kept.times[1, : varying.size], found.kept.times[0, varying.size :]))
        with np.errstate(divide="ignore", invalid="ignore"):
            nu = _normal_loads(motions.drive, times)
            new = np.maximum(ratio, np.where(excess > 0.0, finite + excess / nu, 0.0).max(axis=0))
        if not ratio.any():
            largest = np.abs((high, low)).max(axis=0)
        new = np.where(new > _INFINITE * largest, np.inf, new)
        if not varying.any() or (new <= ratio * (1.0 + SAME)).all():
            return new, found
        ratio = new
    return ratio, found


def _normal_loads(drive: Drive, times: np.ndarray) -> np.ndarray:
    """Normal loads of the contacts at times, (..., N) of one for each contact."""
    k = np.minimum(np.searchsorted(drive.times, times, side="right") - 1, drive.times.size - 1)
    k = np.maximum(k, 0)
    x = (times - drive.times[k]) / drive.steps[k]
    powers = x[..., np.newaxis] ** np.arange(drive.terms.shape[2])
    values = np.einsum("...dn,...n->...d", drive.terms[k], powers)
    values[k == drive.times.size - 1] = 0.0
    return 1.0 + np.einsum("...jd,jd->...j", values, drive.normal)


def _bound(motions: Motions, one: Found) -> np.ndarray:
    """Bound on the forces in contacts that stay held, without load, from the energy at the end, (N,)."""
    bed, state = motions.held.bed, motions.state_at_end(one)
    return np.abs(bed.forces @ state) + np.linalg.norm(bed.vibration @ state) * bed.gains
