"""The largest forces in contacts that all hold: the friction from which nothing moves.

A contact holds for as long as abs(f) <= b nu.  Under a varying normal load the least b is the largest of
abs(f)/nu, from which on the largest excess abs(f) - b nu is not above 0.  It is a convex function of b that
falls: a secant through two values meets 0 before it does, and converges to it.  Normal loads that jump need
no side of the instant at which the excess is largest.
"""

from copy import copy

import numpy as np

from .._kernels.general.problem import FLAT
from .bed import dragged
from .cells import Asked, Found, Motions
from .structure import Watched

#: Friction that nothing overcomes.
HOLDS = 1e150

#: Forces beyond this are those of a contact that slides from the beginning, under any friction.
_SLIDES = 1e-3 * HOLDS

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

    After the record the free vibration is followed until its energy bounds all later forces.  Walls that go
    on drag what holds to them along, until it slips.
    """
    held = copy(motions)
    held.problem = motions.problem._replace(normal=np.zeros_like(motions.problem.normal), law=FLAT)
    period = 2.0 * np.pi / motions.held.slowest
    after = asked.after
    if after is None:
        after = period if motions.bed_after(1.0).active[0] else 0.0
    while True:
        forces, found = _ratios(motions, held, asked._replace(after=after, every=0))
        done = asked.after is not None or not 0.0 < after < MOST_PERIODS * period
        if done or (_bound(motions, found) <= forces * (1.0 + SAME)).all():
            endless = dragged(motions.problem, motions.left) & (asked.after is None)
            return np.where(endless | (forces > _SLIDES), np.inf, forces)
        after *= 2.0


def _ratios(motions: Motions, held: Motions, asked: Asked) -> tuple[np.ndarray, Found]:
    """Largest abs(f)/nu within the time that is asked, and the motion."""
    normal = motions.problem.normal
    force = motions.watched.weights[motions.watched.places["friction"]]
    varying = normal.any(axis=1)
    load = np.zeros_like(force)
    load[:, -normal.shape[1] :] = normal
    friction = np.full(varying.size, HOLDS)
    ratio, before, last = np.zeros((3, varying.size))
    most = 1.0 + np.abs(normal) @ motions.loads_of(1.0)
    for step in range(_MOST_STEPS):
        # the excess over b is that of f -+ b (nu - 1)
        finite = np.where(np.isinf(ratio), before, ratio)
        shift = finite[:, np.newaxis] * load
        held.watched = Watched(np.vstack((force - shift, force + shift)), {})
        found = held.follow(friction, friction, 1.0, asked, False)
        high, low = found.kept.peaks[1, : varying.size], found.kept.peaks[0, varying.size :]
        excess = np.maximum(high, -low) - finite
        if not varying.any():
            return excess, found
        with np.errstate(divide="ignore", invalid="ignore"):
            if step == 0:
                largest, fall = excess, most
            else:
                fall = np.where(finite > before, np.maximum(last - excess, 0.0) / (finite - before), fall)
            new = np.where(excess > SAME * largest, finite + excess / fall, ratio)
        new = np.where((new > _INFINITE * largest) | np.isinf(ratio), np.inf, new)
        if (new <= ratio * (1.0 + SAME)).all():
            return new, found
        before, last, ratio = finite, excess, new
    return ratio, found


def _bound(motions: Motions, one: Found) -> np.ndarray:
    """Bound on the forces in contacts that stay held, without load, from the energy at the end, (N,)."""
    bed, state = motions.held.bed, motions.state_at_end(one)
    return np.abs(bed.forces @ state) + np.linalg.norm(bed.vibration @ state) * bed.gains
