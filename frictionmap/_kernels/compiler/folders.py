"""Folders that compiled kernels are kept in: one for each state of the source files of all kernels.

The folder lies in the package or in NUMBA_CACHE_DIR; if that cannot be written to, in the user's cache; if
that cannot be written to either, in a private folder for temporary files.
"""

import contextlib
import functools
import os
import stat
import sys
import tempfile
import time
from pathlib import Path

import numba
import numpy as np

from ...version import digest_of
from .notices import warn_once

#: Endings of the files of kernels (those of plain numba have two), beginning of files being written.
ENDING = ".nbc"
_ENDINGS = (ENDING, ".nbi")
UNDER_WAY = "new-"

#: `frictionmap/_kernels`
_SOURCES = Path(__file__).parent.parent
_FOLDER = "kernels-"

#: Age (s) after which folders of other states, and files of interrupted runs, are removed.
_OLD_STATE = 30 * 86400.0
_OLD_FILE = 3600.0

#: Settings of numba that do not change the code it generates.
_NO_MATTER = ("NUMBA_CACHE_DIR", "NUMBA_NUM_THREADS", "NUMBA_DISABLE_JIT")


@functools.cache
def state() -> str:
    """Return a digest of all that decides what kernels compile to, except the processor."""
    digest = digest_of((*sorted(_SOURCES.rglob("*.py")), _SOURCES.parent / "regimes.py"))
    settings = sorted(
        (name, value)
        for name, value in os.environ.items()
        if name.startswith("NUMBA_") and name not in _NO_MATTER
    )
    versions = (numba.__version__, np.__version__, sys.version)
    digest.update(repr((versions, settings)).encode(errors="surrogateescape"))
    return digest.hexdigest()[:16]


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
    found = [Path(given) if given else _SOURCES / "__pycache__"]
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
def folders() -> tuple[Path, ...]:
    """Return the folders to look for kernels in: read-only ones, then one that can be written to, if any."""
    found = []
    temporary = _temporary_place()
    for place in places():
        if place == temporary and not _private(place):
            continue
        folder = place / f"{_FOLDER}{state()}"
        known = os.path.isdir(folder)
        writable = _can_be_written(folder)
        if writable or known:
            found.append(folder)
        if writable:
            if not known:
                _forget(place)
            break
    return tuple(found)


def _forget(place: Path) -> None:
    """Remove files of old states and of interrupted runs; other files stay, with their folders."""
    now = time.time()
    for folder in place.glob(_FOLDER + 16 * "[0-9a-f]"):
        past = _age(folder, now) > _OLD_STATE
        for file in folder.glob(f"{UNDER_WAY}*"):
            if past or _age(file, now) > _OLD_FILE:
                with contextlib.suppress(OSError):
                    file.unlink()
        if past:
            _remove_state(folder)


def _remove_state(folder: Path) -> None:
    """Remove compiled kernels, also those in the folders of plain numba, and folders left empty."""
    inner = [path for path in folder.glob("*") if path.is_dir() and not path.is_symlink()]
    for path in (*inner, folder):
        for file in path.glob("*"):
            if file.suffix in _ENDINGS:
                with contextlib.suppress(OSError):
                    file.unlink()
        with contextlib.suppress(OSError):
            path.rmdir()


def _age(path: Path, now: float) -> float:
    """Return the time (s) since the file was changed; 0 if it is gone."""
    try:
        return now - path.stat().st_mtime
    except OSError:
        return 0.0


def warn_of_place() -> None:
    """Report, once, that compiled kernels are kept elsewhere than in the preferred place, or nowhere."""
    first = places()[0]
    if not folders():
        where = ", ".join(map(str, places()))
        warn_once(
            f"cannot keep compiled kernels: none of {where} can be written to; every run compiles them again"
        )
    elif (used := folders()[-1].parent) != first:
        warn_once(
            f"cannot keep compiled kernels in {first}: it cannot be written to; they are kept in {used}"
        )
