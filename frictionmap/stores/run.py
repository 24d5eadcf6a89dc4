"""Computation of the missing blocks of a store, wherever a run was stopped."""

import os
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path

import numpy as np

from ..errors import InputError
from ..files.places import claimed_folder
from ..jobs import Progress
from .contents import Batch, Contents, FindCut, with_cut
from .store import Store, check_same, cut_of, make_store, remove_strays

#: Computes and writes batches of blocks, and yields each when it is done.
Fill = Callable[[Store, Iterable[Batch]], Iterator[Batch]]


def in_this_process(threads: int | None) -> Fill:
    """Compute one batch after the other, each on threads."""

    def fill(store: Store, batches: Iterable[Batch]) -> Iterator[Batch]:
        for batch in batches:
            store.write(batch, store.study.compute(batch, threads))
            yield batch

    return fill


def fill_store(
    path: Path,
    study: Contents,
    title: str,
    fill: Fill,
    overwrite: bool = False,
    progress: Progress | None = None,
    find_cut: FindCut | None = None,
) -> Store:
    """Make the store of a study, or resume it, until all its blocks are done.

    A store keeps the cut that it was made with; `find_cut` gives that of a new one.

    Raises
    ------
    InputError
        There is a store of another study or state of the program (without `overwrite`), or something else of
        that name, it is protected from writing and not done, or another run is at it.
    OSError
        A block cannot be written; those before it are kept.
    """
    if path.is_symlink():
        path = path.resolve()
    with claimed_folder(path) as claim:
        if path.exists() and not overwrite:
            check_same(path, study, title)
            study = with_cut(study, cut_of(path))
        else:
            _check_replaceable(path)
            study = study if find_cut is None else with_cut(study, find_cut(study))
            make_store(path, study, title)
        remove_strays(path)
        store = Store(path, study)
        done = store.done()
        store.mend_axes()
        if not done.all():
            _check_writable(path)
        claim.kept = lambda: (
            f"{np.count_nonzero(done):,} of {done.size:,} blocks are in {path}; repeat the command to resume"
        )
        missing = [batch for batch in study.batches() if not done[batch.places].all()]
        try:
            for batch in fill(store, missing):
                done[batch.places] = True
                if progress is not None:
                    progress(int(np.count_nonzero(done)), done.size)
        except OSError as error:
            failed = f"write {path}: {error.strerror}" if error.strerror else f"finish {path}: {error}"
            raise OSError(f"cannot {failed}; {claim.kept()}") from error
        remove_strays(path)  # what workers left that were killed while they wrote
        return store


def _check_replaceable(path: Path) -> None:
    """Refuse to replace a folder that is not a store or is write-protected."""
    if not path.exists():
        return
    _check_writable(path)
    if not (path / "zarr.json").is_file():
        raise InputError(f"cannot overwrite {path}: the folder is not a store; use another -o")


def _check_writable(path: Path) -> None:
    """Refuse a store that is write-protected, or has a write-protected array."""
    for place in (path, *path.glob("*/")):
        if not os.access(place, os.W_OK):
            raise InputError(
                f"cannot write {place}: it is write-protected; make it writable or use another -o"
            )
