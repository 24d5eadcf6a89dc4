"""The friction from which nothing moves, of contacts that open and beside piecewise linear springs.

While all contacts are held and closed, the motion does not depend on their friction at preload: N - N0 is
kn d.x, linear springs or not.  So a contact holds iff abs(f) - mu phi kn d.x never exceeds mu times its
friction at preload, and then it does not open either.  Contacts without friction, and those with a gap, have
preloads of their own and may open or close; what a closed gap does depends on its friction.
"""

from typing import NamedTuple

import numpy as np

from .._kernels.history.course import RESOLVED
from .._kernels.phases.problem import LIFTOFFS, SMOOTH, Cell
from .cells import Asked, Motions, Ran
from .holding import HOLDS, MOST_PERIODS, SAME
from .opening import OpeningMotions, pattern_of, state_of
from .phase_beds import bed_of


class _Held(NamedTuple):
    """All contacts held."""

    cell: Cell
    static: np.ndarray  # (M, N) ratios of static to kinetic friction
    own: np.ndarray  # (N,) bool: contacts with a preload of their own: without friction, or with a gap
    weights: np.ndarray  # (2 M N, Q) f - mu phi kn d.x and -f - mu phi kn d.x of the others


def opening_holding_friction(motions: Motions, scale: np.ndarray, mu: np.ndarray, asked: Asked) -> np.ndarray:
    """Static friction at preload that holds the contacts, (scales, mu, N); NaN where a gap closes."""
    assert isinstance(motions, OpeningMotions)
    held = _held(motions, mu)
    return np.array([_at_scale(motions, held, float(one), asked) for one in scale])


def _held(motions: OpeningMotions, mu: np.ndarray) -> _Held:
    problem, places = motions.phases, motions.watched.places
    cells = [motions.cell(1.0, float(one)) for one in mu]
    static, given = np.array([one.static for one in cells]), cells[0]
    own = problem.presses & ((problem.law == SMOOTH) | (given.preload < 0.0))
    cell = Cell(
        np.where(own, given.limit, HOLDS), np.ones(own.size), np.where(own, given.preload, HOLDS),
        given.constant,
    )  # fmt: skip
    phi = np.where(
        problem.presses & ~own, problem.lift / np.where(problem.presses, problem.pressed, 1.0), 0.0
    )
    force = np.where(own[:, np.newaxis], 0.0, motions.watched.weights[places["friction"]])
    pressed = (static * phi)[:, :, np.newaxis] * motions.watched.weights[places["normal_force"]]
    weights = np.stack((force - pressed, -force - pressed))
    return _Held(cell, static, own, weights.reshape(-1, force.shape[1]))


def _at_scale(motions: OpeningMotions, held: _Held, scale: float, asked: Asked) -> np.ndarray:
    """The friction at one factor of the record, (M, N); NaN where walls or the base go on after it.

    After the record the free vibration is followed until its energy bounds all later forces.
    """
    after, shape = asked.after or 0.0, (2, *held.static.shape)
    while True:
        ran, beds = motions.ran(held.cell, scale, asked._replace(after=after, every=0), False, held.weights)
        if ran.status != RESOLVED:
            return np.full(shape[1:], np.nan)
        needed = np.maximum(ran.kept.peaks[1].reshape(shape).max(axis=0), 0.0)
        motion = ran.memory.motion
        gap = held.own & (motions.phases.law != SMOOTH)
        closed = (motion.open == 0) | (motion.counts[LIFTOFFS] > 0.0)
        needed[:, gap & closed] = np.nan
        if asked.after is not None:
            return needed
        if not beds.still:
            return np.full_like(needed, np.nan)
        later, period = _later(motions, held, ran, beds.load)
        if (later <= needed * (1.0 + SAME))[~np.isnan(needed)].all() or after >= MOST_PERIODS * period:
            return needed
        after = max(2.0 * after, period)


def _later(motions: OpeningMotions, held: _Held, ran: Ran, load: np.ndarray) -> tuple[np.ndarray, float]:
    """Bounds on these from now on, (M, N), infinite where the phase may end; period of the slowest mode."""
    problem, state, pattern = motions.phases, state_of(ran.memory), pattern_of(ran.memory)
    count, nothing = int(problem.presses.sum()), np.zeros(held.own.size)
    found = np.full(held.static.shape, np.inf)
    period = 0.0
    for m, static in enumerate(held.static):
        cell = Cell(nothing, static, np.where(held.own, held.cell.preload, 0.0), held.cell.constant)
        phase = bed_of(problem, cell, pattern, motions.free, True, load)
        bed, period = phase.bed, 2.0 * np.pi / phase.slowest
        size = np.linalg.norm(bed.vibration @ state)
        least = bed.margins @ state - size * bed.gains
        who = np.flatnonzero(phase.held)
        opens, knots = least[:count][held.own[problem.presses]], least[count + 2 * who.size :]
        if bed.active[0] and (opens >= 0.0).all() and (knots >= 0.0).all():
            found[m] = 0.0
            found[m, who] = -least[count : count + 2 * who.size].reshape(-1, 2).min(axis=1)
    return found, period
