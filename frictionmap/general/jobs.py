"""Jobs on a pool of threads."""

from collections.abc import Callable
from concurrent.futures import FIRST_COMPLETED, ThreadPoolExecutor, wait

import numpy as np

#: Called repeatedly while jobs run; an exception raised by it ends them.
Watch = Callable[[], None]

Progress = Callable[[int, int], None]

#: Seconds between two calls of `Watch`.
_WATCHED = 0.02


def run_jobs(
    count: int, job: Callable[[int, np.ndarray], None], threads: int, progress: Progress | None = None,
    watch: Watch | None = None,
) -> None:  # fmt: skip
    """Run job(k, cancel) for k = 0..count-1; this thread only waits, so that it receives an interrupt.

    A job ends soon after cancel[0], shape (1,), is set.
    """
    cancel = np.zeros(1, np.uint8)
    pool = ThreadPoolExecutor(threads)
    running = {pool.submit(job, k, cancel) for k in range(count)}
    try:
        while running:
            ended, running = wait(running, _WATCHED if watch else None, return_when=FIRST_COMPLETED)
            for future in ended:
                future.result()
            if progress is not None and ended:
                progress(count - len(running), count)
            if watch is not None:
                watch()
    except BaseException:
        cancel[0] = 1  # the kernels check it
        raise
    finally:
        pool.shutdown(wait=True, cancel_futures=True)
