"""Jobs on a pool of threads: kernels release the interpreter lock, so that they run side by side."""

import os
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from itertools import count, islice

#: A function and its arguments.
Job = tuple[Callable[..., None], tuple]

Progress = Callable[[int, int], None]

#: Called repeatedly while cells are computed; an exception raised by it ends the computation.
Watch = Callable[[], None]

#: Seconds between two calls of `Watch`.
_WATCHED = 0.02


#: Pools without work, by their number of threads: to start a thread takes longer than a few cells.
_IDLE: dict[int, list[ThreadPoolExecutor]] = {}

if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_IDLE.clear)  # threads do not exist in a child process


def _pool(threads: int) -> ThreadPoolExecutor:
    """A pool of threads that nobody else uses."""
    try:
        return _IDLE[threads].pop()
    except (KeyError, IndexError):
        return ThreadPoolExecutor(threads)


def run_here(jobs: Sequence[Job], done: Callable) -> None:
    """Run a few short jobs in this thread, as `run_jobs` does in others."""
    for index, (function, arguments) in enumerate(jobs):
        function(*arguments)
        done(index)


def run_counted(jobs: Sequence[Job], threads: int, progress: Progress | None, watch: Watch | None) -> None:
    """Run jobs as `run_jobs` does, and report how many have ended."""
    ended = count(1)

    def done(_: int) -> None:
        if progress is not None:
            progress(next(ended), len(jobs))

    run_jobs(jobs, threads, done, watch)


def run_jobs(jobs: Iterable[Job], threads: int, done: Callable, watch: Watch | None) -> None:
    """Run jobs on a pool of threads; `done(index)` is called in this thread as each one ends.

    This thread makes a job when there is room for it, and else only waits, so that it receives an interrupt
    at once.
    """
    pool = _pool(threads)
    running: dict[Future, int] = {}
    waiting = iter(enumerate(jobs))
    try:
        while True:
            for index, (function, arguments) in islice(waiting, 2 * threads - len(running)):
                running[pool.submit(function, *arguments)] = index
            if not running:
                break
            pause = None if watch is None else _WATCHED
            ended = wait(running, pause, return_when=FIRST_COMPLETED).done
            for future in sorted(ended, key=running.__getitem__):  # in the order of submission, for progress
                future.result()
                done(running.pop(future))
            if watch is not None:
                watch()
    except BaseException:
        pool.shutdown(wait=False, cancel_futures=True)  # its jobs may run on for a while
        raise
    _IDLE.setdefault(threads, []).append(pool)
