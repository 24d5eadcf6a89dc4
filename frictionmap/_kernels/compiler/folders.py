"""Folders that compiled kernels are kept in: one for each combination of the versions that matter.

Each kernel in it has a key of its own (`cache`).  Plain numba has no such keys, and gets a folder for each
state of the source files of all kernels.

The folder lies in the package or in NUMBA_CACHE_DIR; if that cannot be written to, in the user's cache; if
that cannot be written to either, in a private folder for temporary files.
"""

import contextlib
import functools
import hashlib
import math
import os
import stat
import sys
import tempfile
import time
from collections.abc import Iterable
from pathlib import Path

import llvmlite
import numba
import numpy as np

from ...version import digest_of
from .notices import warn_once
from .sources import SOURCES, digest_of_all

#: Endings of the files of kernels (those of plain numba have two), beginning of files being written.
ENDING = ".nbc"
_ENDINGS = (ENDING, ".nbi")
UNDER_WAY = "new-"

_FOLDER = "kernels-"

#: Time (s) after which kernels that nobody has used, and files of interrupted runs, are removed, and after
#: which a kernel is marked as used again: in far less than the first, and hardly ever.
_UNUSED = 30 * 86400.0
_INTERRUPTED = 3600.0
_MARK = 86400.0

#: Settings of numba that do not change the code it generates.
_NO_MATTER = ("NUMBA_CACHE_DIR", "NUMBA_NUM_THREADS", "NUMBA_DISABLE_JIT")


@functools.cache
def versions() -> str:
    """Return a digest of all that decides what kernels compile to, except their sources and the processor."""
    digest = digest_of(())
    settings = sorted(
        (name, value)
        for name, value in os.environ.items()
        if name.startswith("NUMBA_") and name not in _NO_MATTER
    )
    used = (numba.__version__, llvmlite.__version__, np.__version__, sys.version)
    digest.update(repr((used, settings)).encode(errors="surrogateescape"))
    return digest.hexdigest()[:16]


@functools.cache
def state() -> str:
    """Return a digest of versions and of the sources of all kernels."""
    return hashlib.sha256((versions() + digest_of_all()).encode()).hexdigest()[:16]


def _user_cache() -> Path:
    """Return the folder that the operating system sets aside for cached files of the user."""
    if sys.platform == "win32":
        local = os.environ.get("LOCALAPPDATA") or os.path.expanduser(r"~\AppData\Local")
        return Path(local, "frictionmap", "Cache")
    if sys.platform == "darwin":
        return Path(os.path.expanduser("~/Library/Caches"), "frictionmap")
    return Path(os.environ.get("XDG_CACHE_HOME", os.path.expanduser("~/.cache")), "frictionmap")


def _temporary_place() -> Path | None:
    """Return the place of the private folder for temporary files, if there is one."""
    try:
        folder = Path(tempfile.gettempdir())
        if folder == Path.cwd():  # Python's choice if no other folder can be written to
            return None
    except OSError:
        return None
    return folder / f"frictionmap-{os.getuid() if hasattr(os, 'getuid') else 'kernels'}"


def _private(place: Path) -> bool:
    """Make the folder; whether only the user can write to it.  Files that others can write are never run."""
    try:
        place.mkdir(mode=0o700, exist_ok=True)
        found = place.lstat()
    except OSError:
        return False
    mine = not hasattr(os, "getuid") or (found.st_uid == os.getuid() and not found.st_mode & 0o077)
    return stat.S_ISDIR(found.st_mode) and mine


def places() -> list[Path]:
    """Return the places for folders of kernels, the preferred one first."""
    given = numba.config.CACHE_DIR
    user = _user_cache()
    temporary = _temporary_place()
    found = [Path(given) if given else SOURCES / "__pycache__"]
    if user.is_absolute():  # not if there is no home directory
        found.append(user)
    return [*found, temporary] if temporary is not None else found


def _can_be_written(folder: Path) -> bool:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:
        return False
    return os.access(folder, os.R_OK | os.W_OK | os.X_OK)


@functools.cache
def folders(digest: str = "") -> tuple[Path, ...]:
    """Return the folders to look for kernels in: read-only ones, then one that can be written to, if any.

    digest : of which their name is made; without it, `versions()`
    """
    found = []
    temporary = _temporary_place()
    for place in places():
        if place == temporary and not _private(place):
            continue
        folder = place / f"{_FOLDER}{digest or versions()}"
        known = os.path.isdir(folder)
        writable = _can_be_written(folder)
        if writable or known:
            found.append(folder)
        if writable:
            if not known:
                forget(place)
            break
    return tuple(found)


def mark(file: Path) -> None:
    """Mark a kernel as used, if it can be."""
    if _age(file, time.time()) > _MARK:
        with contextlib.suppress(OSError):
            os.utime(file)


@functools.cache
def forget(place: Path) -> None:
    """Remove, once per process, kernels not used for long, files of interrupted runs, and folders left empty.

    Other files stay, with their folders.
    """
    now = time.time()
    for folder in place.glob(_FOLDER + 16 * "[0-9a-f]"):
        past = _age(folder, now) > _UNUSED
        _remove(folder.glob(f"{UNDER_WAY}*"), now - _INTERRUPTED)
        _remove(folder.glob(f"*{ENDING}"), now - _UNUSED)
        if past:
            _remove_folder(folder)


def _remove_folder(folder: Path) -> None:
    """Remove a folder without kernels; those of plain numba, in folders of their own, go with it."""
    inner = [path for path in folder.glob("*") if path.is_dir() and not path.is_symlink()]
    for path in inner:
        _remove((file for file in path.glob("*") if file.suffix in _ENDINGS), before=math.inf)
    for path in (*inner, folder):
        with contextlib.suppress(OSError):
            path.rmdir()


def _remove(files: Iterable[Path], before: float) -> None:
    """Remove files that were last used before a time."""
    for file in files:
        with contextlib.suppress(OSError):
            if file.stat().st_mtime < before:
                file.unlink()


def _age(path: Path, now: float) -> float:
    """Return the time (s) since the file was changed; 0 if it is gone."""
    try:
        return now - path.stat().st_mtime
    except OSError:
        return 0.0


def warn_of_place(found: tuple[Path, ...]) -> None:
    """Report, once, that compiled kernels are kept elsewhere than in the preferred place, or nowhere.

    found : the folders for them
    """
    first = places()[0]
    if not found:
        where = ", ".join(map(str, places()))
        warn_once(
            f"cannot keep compiled kernels: none of {where} can be written to; every run compiles them again"
        )
    elif (used := found[-1].parent) != first:
        warn_once(
            f"cannot keep compiled kernels in {first}: it cannot be written to; they are kept in {used}"
        )
