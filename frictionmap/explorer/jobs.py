"""Running requests: which are cancelled, and whether kernels are being compiled.

Every page has a lane for each kind of work; a new job in a lane cancels the previous one.
"""

import threading
import time
from collections import OrderedDict
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from .compile_times import CompileTimes, default_place

#: Lanes that are remembered: pages that were closed leave theirs behind.
_MOST_LANES = 256

#: Lane of the work that no page waits for.
REHEARSAL = "rehearsal"


class Outdated(Exception):
    """The request is cancelled: nobody waits for the answer."""


class Job:
    """Work for a request; `group` names the kernels that it needs."""

    def __init__(self, gone: Callable[[], bool], turn: int, group: str, times: CompileTimes) -> None:
        self._gone, self._times = gone, times
        self.turn, self.group = turn, group
        self.outdated = False
        self.compiles_since: float | None = None
        self.kernels, self._spent = 0, 0.0

    def watch(self) -> None:
        """Check, while cells are computed, whether the request still stands.

        Raises
        ------
        Outdated
            Another request has taken its place, or the page has gone.
        """
        if self.outdated or self._gone():
            raise Outdated

    def progress(self, done: float, total: float) -> None:
        """Note that cells are finished, so that compilation is over."""
        self.compiled()
        self.watch()

    def compiled(self) -> None:
        """Note that compilation is over."""
        since, self.compiles_since = self.compiles_since, None
        self._spent += 0.0 if since is None else time.monotonic() - since

    def record(self) -> None:
        """Keep the time of compilation for the next time, if anything was compiled."""
        self.compiled()
        if self.kernels and self.group:
            self._times.record(self.group, self._spent, self.kernels)

    def left(self, now: float) -> float:
        """Seconds that compilation will still take; 0 if more kernels have come than expected.

        The more kernels are compiled, the more their time counts, and the less the expected one. A machine
        may be slower than expected, or busy.
        """
        since = self.compiles_since  # once: the thread of the job may end it meanwhile
        if since is None or not self.group:
            return 0.0
        expected, kernels = self._times.expected(self.group)
        missing = max(0.0, 1.0 - self.kernels / kernels)
        return missing * (missing * expected + self._spent + (now - since))


class Jobs:
    """All running jobs."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._lanes: OrderedDict[str, Job] = OrderedDict()
        self._running: set[Job] = set()
        self._times = CompileTimes()
        self._closed = False

    def listen(self) -> None:
        """Listen to compilation from now on; this imports the compiler."""
        from .._kernels.compiler.notices import listeners

        self._times = CompileTimes(default_place())
        listeners.append(self._compiling)

    def close(self) -> None:
        """Stop listening to compilation and cancel all jobs."""
        from .._kernels.compiler.notices import listeners

        if self._compiling in listeners:
            listeners.remove(self._compiling)
        with self._lock:
            self._closed = True
            for job in self._running:
                job.outdated = True

    @contextmanager
    def enter(
        self, lane: str, gone: Callable[[], bool] = lambda: False, turn: int = 0, group: str = ""
    ) -> Iterator[Job]:
        """Run a job in a lane; of it and its predecessor, the one with the earlier turn is cancelled."""
        job = Job(gone, turn, group, self._times)
        with self._lock:
            before = self._lanes.pop(lane, job)
            newer, older = (before, job) if before.turn > turn else (job, before)
            older.outdated = newer is not older
            job.outdated |= self._closed
            self._lanes[lane] = newer
            while len(self._lanes) > _MOST_LANES:
                self._lanes.popitem(last=False)
            self._running.add(job)
        try:
            yield job
            if lane == REHEARSAL:  # others also wait for kernels that are not theirs
                job.record()
        finally:
            with self._lock:
                self._running.discard(job)

    def _compiling(self) -> None:
        """Note that a kernel is about to be compiled for one of the running jobs."""
        now = time.monotonic()
        with self._lock:
            for job in self._running:
                job.compiles_since = job.compiles_since or now
                job.kernels += 1

    def state(self) -> dict[str, float]:
        """State of compilation: time so far, number of kernels, expected time left [s]; empty without any.

        Jobs that a page waits for come first, as others are of no interest to it.
        """
        with self._lock:
            rehearsal = self._lanes.get(REHEARSAL)
            running = [job for job in self._running if job.compiles_since is not None]
        compiling = [job for job in running if job is not rehearsal] or running
        if not compiling:
            return {}
        now = time.monotonic()
        since = min(job.compiles_since or now for job in compiling)
        kernels = max(job.kernels for job in compiling)
        left = max(_foremost(job, running).left(now) for job in compiling)
        # if all their kernels have come, they wait for what others compile: numba compiles for one at a time
        left = left or max(_foremost(job, running).left(now) for job in running)
        return {"seconds": now - since, "kernels": kernels, "left": left}


def _foremost(job: Job, running: list[Job]) -> Job:
    """The job that has seen most of the kernels that a job needs: the rehearsal may have begun before it."""
    return max((one for one in running if one.group == job.group), key=lambda one: one.kernels)
