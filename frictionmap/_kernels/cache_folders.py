"""Where compiled kernels are kept: one folder for each state of all kernels.

It lies in the package's own folder or that of NUMBA_CACHE_DIR, else in the user's cache, else in a folder for
temporary files of the user's own.
"""

import contextlib
import functools
import hashlib
import os
import stat
import sys
import tempfile
import time
from pathlib import Path

import numba
import numpy as np
from numba.misc.appdirs import AppDirs

from ..version import __version__

#: Endings of the files of kernels, beginnings of those that are being written.
ENDING = ".nbc"
UNDER_WAY = "new-"

_SOURCES = Path(__file__).parent
_FOLDER = "kernels-"

#: Folders of other states of the kernels, and what interrupted runs have left, go after so long (s).
_OLD_STATE = 30 * 86400.0
_OLD_FILE = 3600.0

#: Settings of numba that have no part in the code that it makes.
_NO_MATTER = ("NUMBA_CACHE_DIR", "NUMBA_NUM_THREADS", "NUMBA_DISABLE_JIT")


@functools.cache
def state() -> str:
    """A digest of all that decides what a kernel compiles to but for the kernel and the processor."""
    digest = hashlib.sha256(__version__.encode())
    with contextlib.suppress(OSError):  # without sources, as in an archive, the version must do
        for path in (*sorted(_SOURCES.rglob("*.py")), _SOURCES.parent / "regimes.py"):
            digest.update(path.read_bytes())
    settings = sorted(
        (name, value)
        for name, value in os.environ.items()
        if name.startswith("NUMBA_") and name not in _NO_MATTER
    )
    versions = (numba.__version__, np.__version__, sys.version)
    digest.update(repr((versions, settings)).encode(errors="surrogateescape"))
    return digest.hexdigest()[:16]


def _temporary_place() -> Path | None:
    try:
        folder = Path(tempfile.gettempdir())
        if folder == Path.cwd():  # what Python takes where there is none
            return None
    except OSError:
        return None
    return folder / f"frictionmap-{os.getuid() if hasattr(os, 'getuid') else 'kernels'}"


def _private(place: Path) -> bool:
    """The folder is the user's own, made if need be; what others can write to, we do not run."""
    try:
        place.mkdir(mode=0o700, exist_ok=True)
        found = place.lstat()
    except OSError:
        return False
    mine = not hasattr(os, "getuid") or (found.st_uid == os.getuid() and not found.st_mode & 0o077)
    return stat.S_ISDIR(found.st_mode) and mine


def places() -> list[Path]:
    """Where kernels may be kept, best first."""
    given = numba.config.CACHE_DIR
    user = Path(AppDirs(appname="frictionmap", appauthor=False).user_cache_dir)
    temporary = _temporary_place()
    found = [Path(given) if given else _SOURCES / "__pycache__"]
    if user.is_absolute():  # it is not where there is no home
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
    """Folders to look for kernels in: none, or some that can only be read, and one that can be written to."""
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
    """Remove what states of the kernels long past, and interrupted runs, have left."""
    now = time.time()
    for folder in place.glob(_FOLDER + 16 * "[0-9a-f]"):
        past = _age(folder, now) > _OLD_STATE
        for file in (*folder.glob(f"*{ENDING}"), *folder.glob(f"{UNDER_WAY}*")):
            if past or (file.name.startswith(UNDER_WAY) and _age(file, now) > _OLD_FILE):
                with contextlib.suppress(OSError):
                    file.unlink()
        if past:
            with contextlib.suppress(OSError):
                folder.rmdir()


def _age(path: Path, now: float) -> float:
    try:
        return now - path.stat().st_mtime
    except OSError:
        return 0.0
