"""Running requests: which are cancelled, and whether kernels are being compiled.

Every page has a lane for each kind of work; a new job in a lane cancels the previous one.
"""

import threading
import time
from collections import OrderedDict
from collections.abc import Callable, Iterator
from contextlib import contextmanager

#: Lanes that are remembered: pages that were closed leave theirs behind.
_MOST_LANES = 256


class Outdated(Exception):
    """The request is cancelled: nobody waits for the answer."""


class Job:
    """Work for a request."""

    def __init__(self, gone: Callable[[], bool], turn: int) -> None:
        self._gone = gone
        self.turn = turn
        self.outdated = False
        self.compiles_since: float | None = None
        self.kernels = 0

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
        self.compiles_since = None
        self.watch()


class Jobs:
    """All running jobs."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._lanes: OrderedDict[str, Job] = OrderedDict()
        self._running: set[Job] = set()

    def listen(self) -> None:
        """Listen to compilation from now on; this imports the compiler."""
        from .._kernels.compiler.notices import listeners

        listeners.append(self._compiling)

    def close(self) -> None:
        """Stop listening to compilation and cancel all jobs."""
        from .._kernels.compiler.notices import listeners

        if self._compiling in listeners:
            listeners.remove(self._compiling)
        with self._lock:
            for job in self._running:
                job.outdated = True

    @contextmanager
    def enter(self, lane: str, gone: Callable[[], bool] = lambda: False, turn: int = 0) -> Iterator[Job]:
        """Run a job in a lane; of it and its predecessor, the one with the earlier turn is cancelled."""
        job = Job(gone, turn)
        with self._lock:
            before = self._lanes.pop(lane, job)
            newer, older = (before, job) if before.turn > turn else (job, before)
            older.outdated = newer is not older
            self._lanes[lane] = newer
            while len(self._lanes) > _MOST_LANES:
                self._lanes.popitem(last=False)
            self._running.add(job)
        try:
            yield job
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
        """State of compilation: duration [s] and number of kernels so far; empty if none is running."""
        with self._lock:
            compiling = [job for job in self._running if job.compiles_since is not None]
            if not compiling:
                return {}
            since = min(job.compiles_since or 0.0 for job in compiling)
            kernels = max(job.kernels for job in compiling)
        return {"seconds": time.monotonic() - since, "kernels": kernels}
