"""Oscillators with friction under one record, eight at a time: records and results as arrays."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from .._kernels.compiler.vectors import LANES
from .._kernels.general.problem import PIECE_TERMS
from .._kernels.history.motion import CREEPING, RESOLVED
from .._kernels.history.spectrum import follow_lanes
from .._kernels.history.spectrum_lanes import (
    ASLEEP,
    DISTANCE,
    PEAK,
    REACH,
    STATUS,
    STOPS,
    TURN,
    TURNS,
    Load,
    X,
)
from .pieces import Pieces

#: A value and the one before it differ by no more than this share of the largest where nothing jumps.
_ROUNDING = 1e-13

#: Friction that nothing overcomes, in lanes without an oscillator, and with a load of zero.
_HOLDS = 1e150


class Oscillators(NamedTuple):
    """Oscillators of mass 1, one per entry."""

    w: np.ndarray  # natural frequency [rad/time], 0 without a spring
    zeta: np.ndarray
    beta: np.ndarray  # kinetic friction force
    mu: np.ndarray  # ratio of static to kinetic friction


class Driven(NamedTuple):
    """A record in equal parts of its samples."""

    load: Load
    lengths: np.ndarray  # distinct lengths of the parts
    duration: float


class Responses(NamedTuple):
    """What became of oscillators, one per entry."""

    amplitude: np.ndarray
    acceleration_amplitude: np.ndarray
    residual: np.ndarray  # NaN where it does not come to rest
    sliding_distance: np.ndarray
    stops: np.ndarray
    turns: np.ndarray
    asleep_time: np.ndarray  # NaN where it is not asleep
    status: np.ndarray


def _split(pieces: Pieces, parts: int) -> tuple[np.ndarray, np.ndarray]:
    """Polynomials over equal parts of the intervals, and the lengths of the parts."""
    begin = np.tile(np.arange(parts) / parts, pieces.steps.size)[:, np.newaxis]
    terms = np.repeat(pieces.terms, parts, axis=0)
    for i in range(PIECE_TERMS - 1):
        for k in range(PIECE_TERMS - 2, i - 1, -1):
            terms[:, k] += begin[:, 0] * terms[:, k + 1]
    return terms / float(parts) ** np.arange(PIECE_TERMS), np.repeat(pieces.steps / parts, parts)


def driven(pieces: Pieces, parts: int, base: bool) -> Driven:
    """Arrays of a load in `parts` equal parts of every sample; base : see `Load`."""
    terms, steps = _split(pieces, parts)
    begins, ends = terms[:, 0].copy(), terms.sum(axis=1)
    joined = np.abs(begins[1:] - ends[:-1]) <= _ROUNDING * max(np.abs(begins).max(), np.abs(ends).max())
    ends[:-1][joined] = begins[1:][joined]
    curved = bool(terms[:, 2:].any())
    if not curved:
        terms[:, 1] = ends - begins
    lengths, which = np.unique(steps, return_inverse=True)
    jumps = np.concatenate(([True], ~joined))
    load = Load(begins, ends, steps, which.astype(np.int64), jumps, np.ascontiguousarray(terms), curved, base)
    return Driven(load, lengths, float(pieces.times[-1]))


def parts_of(pieces: Pieces, w: np.ndarray, zeta: np.ndarray) -> np.ndarray:
    """Number of parts of a sample in which the fastest part of each oscillator turns by TURN at most."""
    with np.errstate(invalid="ignore"):
        rate = w * np.where(zeta > 1.0, zeta + np.sqrt((zeta - 1.0) * (zeta + 1.0)), 1.0)
    return np.maximum(1, np.ceil(rate * float(pieces.steps.max()) / TURN)).astype(np.int64)


def in_lanes(parts: np.ndarray) -> Iterator[tuple[int, np.ndarray]]:
    """Group oscillators by eight with the same number of parts: (parts, their numbers)."""
    for count in np.unique(parts):
        members = np.flatnonzero(parts == count)
        for first in range(0, members.size, LANES):
            yield int(count), members[first : first + LANES]


def follow(drive: Driven, these: Oscillators) -> Responses:
    """Follow up to eight oscillators from rest through a record, and on until they rest permanently."""
    count = these.w.size
    cells = np.zeros((4, LANES))
    cells[2], cells[3] = _HOLDS, 1.0
    for row, values in zip(cells, these, strict=True):
        row[:count] = values
    state = follow_lanes(drive.load, drive.lengths, drive.duration, cells)[:, :count]
    rests = np.isin(state[STATUS], (RESOLVED, CREEPING))
    return Responses(
        state[REACH], state[PEAK], np.where(rests, state[X], np.nan), state[DISTANCE], state[STOPS],
        state[TURNS], state[ASLEEP], state[STATUS],
    )  # fmt: skip
