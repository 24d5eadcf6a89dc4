"""The motions of a grid of records, scales and friction, on several threads."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from .._kernels.general.record import make_record
from .._kernels.general.series import Friction
from .._kernels.history.kept import Kept, make_kept
from .._kernels.history.motion import follow_record
from ..jobs import Progress, Watch, run_jobs
from .channels import Drive
from .structure import Structure, held_of, problem_of, watched_of

#: Events and states that there is room for at first.
_FIRST = 256

#: Intervals after a record after which a motion is not asleep.
_MOST_AFTER = 10**6

#: Friction that nothing overcomes.
_HOLDS = 1e150


class Start(NamedTuple):
    """State at the beginning."""

    q: np.ndarray  # (m,)
    p: np.ndarray  # (m,) q'


class Asked(NamedTuple):
    """How motions are followed, and what is kept."""

    start: Start
    after: float | None  # time after the record; None: until it is asleep
    every: int  # states are kept every so many samples; 0: none


class Found(NamedTuple):
    """One motion."""

    status: int
    kept: Kept
    counts: np.ndarray
    state: np.ndarray  # (2, m) at the end
    sense: np.ndarray  # (N,)
    end: float  # when that is
    asleep: bool


def _starting(structure: Structure, start: Start) -> np.ndarray:
    contacts = structure.spring.size
    found = np.zeros((3, max(start.q.size, contacts)))
    found[0, : start.q.size], found[1, : start.q.size] = start.q, start.p
    return found


class Motions:
    """The motions of a structure under one record."""

    def __init__(self, structure: Structure, drive: Drive) -> None:
        self.structure, self.drive = structure, drive
        self.problem = problem_of(structure, drive)
        self.held = held_of(self.problem)
        self.watched = watched_of(structure, self.problem, drive)

    def _limits(self, asked: Asked) -> tuple[np.ndarray, np.ndarray]:
        """Lengths of the intervals, and the limits of `follow_record`."""
        steps = self.drive.steps.copy()
        if asked.after is None:
            return steps, np.array([asked.every, _MOST_AFTER, 1])
        count = int(np.ceil(asked.after / steps[-1]))
        if count:
            steps[-1] = asked.after / count
        return steps, np.array([asked.every, count, 0])

    def follow(self, kinetic: np.ndarray, static: np.ndarray, scale: float, asked: Asked) -> Found:
        """Follow one motion; where there is no room for all its events, once more with more."""
        steps, limits = self._limits(asked)
        terms = self.drive.terms * scale
        if self.drive.normal.any():  # normal loads are no loads
            normal = self.drive.normal.any(axis=0)
            terms[:, normal] = self.drive.terms[:, normal]
        if limits[2] == 0 and steps[-1] != self.drive.steps[-1]:
            terms[-1, :, 1] *= steps[-1] / self.drive.steps[-1]
        friction = Friction(np.ascontiguousarray(kinetic), np.ascontiguousarray(static))
        start = _starting(self.structure, asked.start)
        bed = self.held.bed
        most = (
            _FIRST
            if asked.every == 0
            else _FIRST + steps.size // asked.every + int(limits[1] * (1 - limits[2]))
        )
        while True:
            masses = np.empty((0, self.problem.squares.size))
            kept = make_kept(self.problem, self.watched.weights, make_record(self.problem, masses, 0), most)
            status, counts, state, sense, done = follow_record(
                self.problem, friction, start, terms, steps, self.drive.times, self.drive.jumps, kept, bed,
                limits,
            )  # fmt: skip
            needed = int(kept.counts.max())
            if needed <= most:
                break
            most = needed
        last = steps.size - 1
        end = self.drive.times[min(done, last)] + max(0, done - last) * steps[-1]
        asleep = status == 0 and limits[2] == 1
        return Found(int(status), kept, counts, state, sense, float(end), asleep)

    def hold(self, asked: Asked) -> np.ndarray:
        """Largest force in every contact with all contacts held, (N,)."""
        friction = np.full(self.structure.spring.size, _HOLDS)
        asked = Asked(asked.start, 0.0 if asked.after is None else asked.after, 0)
        found = self.follow(friction, friction, 1.0, asked)
        rows = self.watched.places["friction"]
        return np.abs(found.kept.peaks[:2, rows]).max(axis=0)


def run_all(
    tasks: list[Callable[[], None]], threads: int, progress: Progress | None, watch: Watch | None
) -> None:
    """Run one task per motion."""
    done = 0

    def count(index: int) -> None:
        nonlocal done
        done += 1
        if progress is not None:
            progress(done, len(tasks))

    run_jobs([(task, ()) for task in tasks], threads, count, watch)
