"""Consistency margins of an orbit: minima of its slides, forces of its stops, ends of its slides."""

import math
from typing import NamedTuple

import numpy as np

from .conditions import GRAZE, SLIDE_END, SLIP, TURN, Condition
from .orbits import Motion, Sequence, inside, motion_of
from .phases import Phases

#: Samples of a piece: per period of the fastest part of the motion, and at least.
_PER_PERIOD, _LEAST = 24, 16

#: Samples between the neighbours of a minimum, how often they are taken, and how much above the least sample
#: a minimum is that may be below it in truth: the square of the distance of samples.
_ZOOMED, _ZOOMS, _CLOSE = 17, 2, 0.07

#: Relative violation below which an orbit is consistent: rounding, and the solved extreme of its border.
_ROUNDING = 1e-8


class Samples(NamedTuple):
    """Velocity, or force, inside one piece."""

    piece: int
    tau: np.ndarray
    values: np.ndarray  # slides: sense times r z'; stops: F/(mu beta)


class Margin(NamedTuple):
    """A border that an orbit is near, and how far from it: 0 on it, negative beyond it."""

    condition: Condition
    tau: float
    value: float


def _extent(sequence: Sequence, motion: Motion, piece: int) -> tuple[float, float]:
    """Begin and end of a piece; the last one continues as the first."""
    begin, end = float(motion.times[piece][0]), float(motion.times[piece + 1][0])
    if piece == sequence.events:
        end += float(motion.times[1][0]) - sequence.start
    return begin, end


def sampled(phases: Phases, sequence: Sequence, motion: Motion, piece: int) -> Samples:
    """Sample a piece of one orbit, ends included."""
    begin, end = _extent(sequence, motion, piece)
    r = float(motion.drive.r[0])
    count = max(
        _LEAST, math.ceil(_PER_PERIOD * (end - begin) * max(1.0, phases.fastest / r) / (2.0 * math.pi))
    )
    tau = np.linspace(begin, end, count + 1)
    return Samples(piece, tau, _values(phases, sequence, motion, piece, tau))


def _values(phases: Phases, sequence: Sequence, motion: Motion, piece: int, tau: np.ndarray) -> np.ndarray:
    """Values of a piece of one orbit at phases tau (k,), see `Samples`."""
    many = _repeated(motion, piece, tau.size)
    states = inside(phases, sequence, many, piece, tau)
    sense = sequence.senses[piece]
    if sense == 0:
        return phases.force(many.drive, states, tau) / (sequence.mu * many.beta)
    return sense * phases.velocity(states)


def _least(phases: Phases, sequence: Sequence, motion: Motion, samples: Samples, sign: float) -> float:
    """Least value of sign times a piece away from its ends; minima between samples are looked at closely."""
    values = sign * samples.values
    least = float(values[1:-1].min())
    scale = float(np.abs(values).max())
    for k in _minima(values):
        low, high = samples.tau[k - 1], samples.tau[k + 1]
        if values[k] > least + _CLOSE * scale:
            continue
        for _ in range(_ZOOMS):
            tau = np.linspace(low, high, _ZOOMED)
            closer = sign * _values(phases, sequence, motion, samples.piece, tau)
            lowest = int(np.argmin(closer[1:-1])) + 1
            low, high = tau[lowest - 1], tau[lowest + 1]
            least = min(least, float(closer[lowest]))
    return least


def _repeated(motion: Motion, piece: int, count: int) -> Motion:
    """One orbit as many cases, with the beginning of one piece only."""
    drive = type(motion.drive)(*(np.repeat(array, count, axis=0) for array in motion.drive))
    times, states = [np.empty(0)] * piece, [np.empty((0, 0))] * piece
    times.append(np.repeat(motion.times[piece], count))
    states.append(np.repeat(motion.states[piece], count, axis=0))
    return Motion(drive, np.repeat(motion.beta, count), times, states)


def _minima(values: np.ndarray) -> np.ndarray:
    """Indices of interior local minima."""
    return np.flatnonzero((values[1:-1] < values[:-2]) & (values[1:-1] <= values[2:])) + 1


def margins(phases: Phases, sequence: Sequence, unknowns: np.ndarray) -> list[Margin]:
    """All borders that an orbit is near, from the nearest on; unknowns: its event times, r and beta."""
    motion = motion_of(phases, sequence, unknowns[np.newaxis, :-2], unknowns[-2:-1], unknowns[-1:])
    found: list[Margin] = []
    for piece in range(1, sequence.events + 1):
        samples = sampled(phases, sequence, motion, piece)
        found += _slide_margins(samples) if sequence.senses[piece] else _stop_margins(samples)
    found += _end_margins(phases, sequence, motion)
    return sorted(found, key=lambda margin: abs(margin.value))


def _slide_margins(samples: Samples) -> list[Margin]:
    size = samples.values.max()
    return [
        Margin(Condition(GRAZE, samples.piece), float(samples.tau[k]), float(samples.values[k] / size))
        for k in _minima(samples.values)
    ]


def _stop_margins(samples: Samples) -> list[Margin]:
    return [
        Margin(
            Condition(SLIP, samples.piece, sign), float(samples.tau[k]), float(1.0 - sign * samples.values[k])
        )
        for sign in (1, -1)
        for k in _minima(-sign * samples.values)
    ]


def _end_force(phases: Phases, sequence: Sequence, motion: Motion, k: int) -> float:
    """Force that would hold the contact at the end of slide k, against the slide, over beta."""
    force = phases.force(motion.drive, motion.states[k + 1], motion.times[k + 1])[0]
    return float(sequence.senses[k] * force / motion.beta[0])


def _end_margins(phases: Phases, sequence: Sequence, motion: Motion) -> list[Margin]:
    found = []
    for k in range(sequence.events):
        if sequence.senses[k]:
            force = _end_force(phases, sequence, motion, k)
            tau = float(motion.times[k + 1][0])
            found.append(Margin(Condition(TURN, k), tau, 1.0 + force / sequence.mu))
            if sequence.mu > 1.0:
                found.append(Margin(Condition(SLIDE_END, k), tau, 1.0 - force))
    return found


def violation(phases: Phases, sequence: Sequence, unknowns: np.ndarray) -> float:
    """Relative violation of the consistency of an orbit: 0 if it is consistent."""
    times = unknowns[:-2]
    edges = np.concatenate(([sequence.start], times, [sequence.end]))
    if (np.diff(edges) <= 0.0).any() or unknowns[-1] <= 0.0 or unknowns[-2] <= 0.0:
        return math.inf
    try:
        motion = motion_of(phases, sequence, times[np.newaxis], unknowns[-2:-1], unknowns[-1:])
    except np.linalg.LinAlgError:
        return math.inf  # its return determines no state
    worst = 0.0
    for piece in range(1, sequence.events + 1):
        samples = sampled(phases, sequence, motion, piece)
        if sequence.senses[piece]:
            fastest = float(samples.values.max())
            if fastest <= 0.0:
                return math.inf  # it slides the other way
            worst = max(worst, -_least(phases, sequence, motion, samples, 1.0) / fastest)
        else:
            for sign in (1.0, -1.0):
                worst = max(worst, -_least(phases, sequence, motion, samples, sign) - 1.0)
    for k in range(sequence.events):
        if sequence.senses[k]:
            force = _end_force(phases, sequence, motion, k)
            turns = sequence.senses[k + 1] != 0
            over = force + sequence.mu if turns else max(-force - sequence.mu, force - 1.0)
            worst = max(worst, over / sequence.mu)
    return worst


def is_physical(phases: Phases, sequence: Sequence, unknowns: np.ndarray) -> bool:
    """Whether an orbit is consistent."""
    return violation(phases, sequence, unknowns) <= _ROUNDING
