"""Computation of blocks by dask workers, on this machine or on a running cluster.

Workers receive the path of the store and the index of a block, no data, and compute the batch it begins.
Blocks of a lost worker are computed again, with identical bytes.
"""

import contextlib
import logging
import os
import sys
from collections import Counter, deque
from collections.abc import Callable, Iterable, Iterator
from functools import lru_cache
from pathlib import Path
from socket import gethostname
from typing import TYPE_CHECKING, Any

from .._kernels.compiler.folders import folders
from ..errors import InputError
from ..version import __version__, state
from .contents import Batch
from .run import Fill
from .store import Store, opened

if TYPE_CHECKING:
    from distributed import Client, Future, LocalCluster

#: Blocks queued at a worker: it is never idle, and few are lost if the run stops.
_WAITING = 2

#: Attempts to start local workers: if one is lost while it starts, all end.
_STARTS = 3

#: Arguments of a local cluster: no dashboard, and its scheduler's server on any free port of this machine.
#: Without a port dask takes 8787 and warns where another cluster has it.
NO_DASHBOARD: dict[str, Any] = {
    "dashboard_address": None, "scheduler_kwargs": {"dashboard_address": "127.0.0.1:0"}
}  # fmt: skip

#: Number of lost workers after which a block is considered the cause.
_LOSSES = 20

#: Seconds to wait for the first worker of a running scheduler: a queue may take a night.
_PATIENCE = 86400


def _distributed() -> Any:
    try:
        import distributed
    except ImportError:
        raise InputError(
            "cannot use --workers or --scheduler: dask is not installed; run pip install 'frictionmap[dask]'"
        ) from None
    return distributed


@lru_cache(maxsize=4)
def _store(path: str, digest: str) -> Store:
    """Open the store of a study, once per process; one process per host compiles while others wait."""
    if not Path(path).exists():
        raise OSError(
            f"cannot open {path} on {gethostname()}: workers must see the store under the same path; "
            "use a shared folder"
        )
    store = opened(Path(path))
    _check_same(store, digest)
    with _alone():
        _ = store.study.sample
    return store


def _check_same(store: Store, digest: str) -> None:
    if store.digest != digest:
        raise OSError(
            f"cannot write {store.path}: a worker found another store there; use a folder that all share"
        )


@contextlib.contextmanager
def _alone() -> Iterator[None]:
    """Exclude other processes of this host, if kernels are cached on disk and files can be locked."""
    places = folders()
    if sys.platform == "win32" or not places:
        yield
        return
    import fcntl

    with open(places[0] / "compiling.lock", "w") as lock:
        with contextlib.suppress(OSError):  # a file system without locks
            fcntl.flock(lock, fcntl.LOCK_EX)
        yield


def compute(path: str, digest: str, first: tuple[int, ...]) -> tuple[int, ...]:
    """Compute and write the batch whose first block has this place."""
    store = _store(path, digest)
    batch = store.study.batch(first)
    found = store.study.compute(batch, threads=1)
    _check_same(Store(store.path, store.study), digest)  # a run that has ended since may have been followed
    store.write(batch, found)
    return first


def task(version: str, state: str) -> Callable[[str, str, tuple[int, ...]], tuple[int, ...]]:
    """Return `compute` in the form sent to workers; a worker without this state of the package says so.

    It is in no module, and so sent as code: what is sent as the name of a module ends a worker that lacks it.
    """

    def computed(path: str, digest: str, first: tuple[int, ...]) -> tuple[int, ...]:
        import sys
        from importlib import import_module

        from distributed import get_worker

        try:
            there = import_module("frictionmap.version")
            import_module("zarr")
            compute = import_module("frictionmap.stores.workers").compute
            lacks = ""
            if there.__version__ != version:
                lacks = f"frictionmap has version {there.__version__} there"
            elif there.state() != state:
                lacks = f"frictionmap is in state {there.state()} there, here in {state}"
        except ImportError as error:
            lacks = str(error)
        if lacks:
            raise OSError(
                f"cannot use worker {get_worker().address}: it needs frictionmap[dask] {version} ({lacks}); "
                f"install it for {sys.executable} on that machine"
            )
        return compute(path, digest, first)

    return computed


def local(workers: int) -> Fill:
    """Compute on local worker processes, started for this run."""
    distributed = _distributed()
    import dask

    def fill(store: Store, batches: Iterable[Batch]) -> Iterator[Batch]:
        _tidy_in_silence()
        with (
            dask.config.set({"distributed.scheduler.allowed-failures": _LOSSES}),
            _cluster(workers) as cluster,
            distributed.Client(cluster) as client,
        ):
            yield from _on(client, store, batches)

    return fill


def _tidy_in_silence() -> None:
    """Start Python's resource tracker without its warnings.

    An interrupt ends this process at once.  The tracker outlives it and removes the semaphores of the
    workers, which is its purpose.
    """
    from multiprocessing import resource_tracker

    before = os.environ.get("PYTHONWARNINGS")
    os.environ["PYTHONWARNINGS"] = "ignore:resource_tracker:UserWarning"
    try:
        resource_tracker.ensure_running()
    finally:
        if before is None:
            del os.environ["PYTHONWARNINGS"]
        else:
            os.environ["PYTHONWARNINGS"] = before


def _cluster(workers: int) -> "LocalCluster":
    """Start worker processes with one thread each."""
    starts = 0
    while True:
        starts += 1
        try:
            return _distributed().LocalCluster(
                n_workers=workers, threads_per_worker=1, processes=True, silence_logs="CRITICAL",
                **NO_DASHBOARD,
            )  # fmt: skip
        except RuntimeError as error:
            if starts == _STARTS:
                raise OSError(
                    f"cannot start {workers} worker processes: {error}; use fewer --workers"
                ) from error


def running(address: str, say: Callable[[str], None]) -> Fill:
    """Compute on the workers of a running scheduler, which see the store under the same path.

    say : called with a message while there are none
    """
    distributed = _distributed()
    for name in ("distributed", "distributed.client"):
        logging.getLogger(name).setLevel(logging.CRITICAL)  # what there is to say is said below

    def fill(store: Store, batches: Iterable[Batch]) -> Iterator[Batch]:
        try:
            client = distributed.Client(address, timeout="30s")
        except (OSError, ValueError) as error:
            raise InputError(
                f"--scheduler must be the address of a running scheduler; got {address} ({error})"
            ) from None
        with client:
            _wait(client, address, say)
            yield from _on(client, store, batches)

    return fill


def _wait(client: "Client", address: str, say: Callable[[str], None]) -> None:
    """Wait for the first worker."""
    if client.nthreads():
        return
    say(f"waiting for workers of {address}")
    try:
        client.wait_for_workers(1, timeout=_PATIENCE)
    except TimeoutError:
        raise OSError(
            f"cannot compute on {address}: it had no worker for {_PATIENCE / 3600:g} hours; start some"
        ) from None


def _on(client: "Client", store: Store, batches: Iterable[Batch]) -> Iterator[Batch]:
    """Yield batches as they are finished; a few more are submitted than there are workers."""
    path, digest, sent = str(store.path.resolve()), store.digest, task(__version__, state())
    waiting = deque(batch.first for batch in batches)
    places: dict[str, tuple[int, ...]] = {}
    losses: Counter[tuple[int, ...]] = Counter()
    under_way = _distributed().as_completed(raise_errors=False)

    def top_up() -> None:
        """Submit as many batches as the present workers take; workers may come and go."""
        threads = max(1, sum(client.nthreads().values()))
        while waiting and len(places) < (1 + _WAITING) * threads:
            place = waiting.popleft()
            future = client.submit(sent, path, digest, place, pure=False)
            places[future.key] = place
            under_way.add(future)

    top_up()
    for future in under_way:
        place = places.pop(future.key)
        if future.status == "finished":
            yield store.study.batch(place)
        else:
            losses[place] += 1
            _check_lost(future, losses[place])
            waiting.appendleft(place)
        top_up()


def _check_lost(future: "Future", times: int) -> None:
    """Raise the error of a block, unless it is the loss of a few workers."""
    if future.status != "error":
        raise OSError(
            "cannot go on: the connection to the dask scheduler is lost; run the command again to resume"
        )
    error = future.exception()
    if "deserialization" in str(error):  # dask's word where what is sent cannot be read
        raise OSError(
            "cannot run on the workers: their versions of Python or dask differ from those here "
            f"({str(error).splitlines()[0]}); install the same versions"
        ) from error
    if not isinstance(error, _distributed().KilledWorker) or times > _LOSSES:
        raise error
