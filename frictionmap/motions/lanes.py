"""Oscillators with friction under one record, eight at a time: records and results as arrays."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from .._kernels.compiler.vectors import LANES
from .._kernels.history.course import CREEPING, RESOLVED
from .._kernels.history.spectrum import follow_lanes, rest_lanes
from .._kernels.history.spectrum_lanes import (
    ASLEEP,
    DISTANCE,
    PEAK,
    REACH,
    STATE_ROWS,
    STATUS,
    STOPS,
    TURN,
    TURNS,
    Load,
    X,
)
from ..errors import InputError
from .holding import HOLDS
from .pieces import SAME, Pieces, shifted
from .record import Record

#: Parts of samples in a block, of 88 bytes each.
_BLOCK = 10**6

#: Parts of a sample at most, for oscillators with a period far below its length.
_MOST_PARTS = 10**6


class Oscillators(NamedTuple):
    """Oscillators of mass 1, one per entry."""

    w: np.ndarray  # natural frequency [rad/time], 0 without a spring
    zeta: np.ndarray
    beta: np.ndarray  # kinetic friction force
    mu: np.ndarray  # ratio of static to kinetic friction


class Driven(NamedTuple):
    """A record in equal parts of its samples."""

    pieces: Pieces
    ends: np.ndarray  # (K,) values at the ends of the samples, without jumps of rounding
    jumps: np.ndarray  # (K,) bool: whether it jumps where the sample begins
    parts: int
    base: bool
    kept: list[Load]  # the whole of it, where that is small

    @property
    def lengths(self) -> np.ndarray:
        """Distinct lengths of the parts."""
        return np.unique(self.pieces.steps) / self.parts


class Grid(NamedTuple):
    """The oscillators that are wanted under every record; forces are over the mass."""

    records: tuple[Record, ...]
    scale: np.ndarray
    mu: np.ndarray
    period: np.ndarray
    friction: np.ndarray
    damping: float

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of records, and of values along the axes."""
        return len(self.records), self.scale.size, self.mu.size, self.period.size, self.friction.size


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


def driven(pieces: Pieces, parts: int, base: bool) -> Driven:
    """A load in `parts` equal parts of every sample; base : see `Load`."""
    begins, ends = pieces.terms[:, 0], pieces.ends
    joined = np.abs(begins[1:] - ends[:-1]) <= SAME * max(np.abs(begins).max(), np.abs(ends).max())
    ends[:-1][joined] = begins[1:][joined]
    drive = Driven(pieces, ends, np.concatenate(([True], ~joined)), parts, base, [])
    if parts * ends.size <= _BLOCK:
        drive.kept.append(_block(drive, 0, ends.size))
    return drive


def _shifted(terms: np.ndarray, parts: int) -> np.ndarray:
    """Polynomials over equal parts of the intervals."""
    begin = np.tile(np.arange(parts) / parts, len(terms))
    return shifted(np.repeat(terms, parts, axis=0), begin) / float(parts) ** np.arange(terms.shape[1])


def _block(drive: Driven, first: int, last: int) -> Load:
    """The load over the samples from `first` to before `last`."""
    parts, pieces = drive.parts, drive.pieces
    terms = _shifted(pieces.terms[first:last], parts)
    begins = terms[:, 0].copy()
    ends = np.append(begins[1:], 0.0)
    ends[parts - 1 :: parts] = drive.ends[first:last]
    jumps = np.zeros(begins.size, dtype=bool)
    jumps[::parts] = drive.jumps[first:last]
    curved = bool(pieces.terms[:, 2:].any())
    if not curved:
        terms[:, 1] = ends - begins
    which = np.searchsorted(np.unique(pieces.steps), pieces.steps[first:last]).astype(np.int64)
    steps = np.repeat(pieces.steps[first:last] / parts, parts)
    return Load(
        begins, ends, steps, np.repeat(which, parts), jumps, np.ascontiguousarray(terms), curved, drive.base
    )


def _blocks(drive: Driven) -> Iterator[Load]:
    """The load in blocks of the memory that it may take."""
    if drive.kept:
        yield from drive.kept
        return
    samples = max(1, _BLOCK // drive.parts)
    for first in range(0, drive.ends.size, samples):
        yield _block(drive, first, min(first + samples, drive.ends.size))


def parts_of(pieces: Pieces, w: np.ndarray, zeta: np.ndarray) -> np.ndarray:
    """Number of parts of a sample in which the fastest part of each oscillator turns by TURN at most."""
    with np.errstate(invalid="ignore"):
        rate = w * np.where(zeta > 1.0, zeta + np.sqrt((zeta - 1.0) * (zeta + 1.0)), 1.0)
    parts = np.ceil(rate * float(pieces.steps.max()) / TURN)
    if parts.max() > _MOST_PARTS:
        least = 2.0 * np.pi * float(pieces.steps.max()) / _MOST_PARTS
        raise InputError("period", f"must be >= {least:.3g} for samples that far apart; got a shorter one")
    return np.maximum(1, parts).astype(np.int64)


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
    cells[2], cells[3] = HOLDS, 1.0  # in lanes without an oscillator nothing moves
    for row, values in zip(cells, these, strict=True):
        row[:count] = values
    state, begins = np.zeros((STATE_ROWS, LANES)), True
    for block in _blocks(drive):
        follow_lanes(block, drive.lengths, cells, state, begins)
        begins = False
    rest_lanes(state, float(drive.pieces.times[-1]))
    state = state[:, :count]
    rests = np.isin(state[STATUS], (RESOLVED, CREEPING))
    return Responses(
        state[REACH], state[PEAK], np.where(rests, state[X], np.nan), state[DISTANCE], state[STOPS],
        state[TURNS], state[ASLEEP], state[STATUS],
    )  # fmt: skip
