"""Output files: claimed before the work begins, written elsewhere, put in place in one step.

A claim is a hidden folder beside the file, one for each name and user.  A lock in it lasts as long as the
process: who finds the folder without its lock may clear it away.  What is written in it appears under the
file's own name in one step.
"""

import contextlib
import errno
import hashlib
import os
import secrets
import stat
import sys
import threading
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

from ..errors import InputError

if sys.platform != "win32":
    import fcntl

_PREFIX = ".frictionmap-"
_LOCK, _FILE = "lock", "new"
_FOLDERS = _PREFIX + 16 * "[0-9a-f]"

#: What a file system without locks says.
_NO_LOCKS = (errno.ENOSYS, errno.ENOLCK, errno.EOPNOTSUPP, errno.EINVAL)

#: Held while claims are made and files put in their place, so that an interrupt finds one or the other.
_guard = threading.Lock()
_claims: set["Output"] = set()
_written: list[Path] = []


class _Taken(Exception):
    """Another process has the lock."""


class Output:
    """A claimed output path."""

    def __init__(self, path: Path, overwrite: bool) -> None:
        self.path = path  # as the user named it
        self._overwrite = overwrite
        self._target = Path(os.path.realpath(path))
        user = os.getuid() if hasattr(os, "getuid") else 0
        name = hashlib.sha256(f"{user} {self._target.name}".encode(errors="surrogateescape")).hexdigest()
        self._folder = self._target.parent / f"{_PREFIX}{name[:16]}"
        self._scratch = self._folder / f"{_FILE}-{os.getpid()}{path.suffix[:16]}"
        self._lock = -1
        self.kept: Callable[[], str] = lambda: ""  # what of unfinished work an interrupt leaves, in words

    def fill(
        self, write: Callable[[Path], None], progress: Callable[[int], None] = lambda size: None
    ) -> None:
        """Call `write` with a temporary path and move the file into place.

        `progress` is called now and then with the number of bytes.  An interrupt waits for `write` to end:
        the libraries that write files never release their locks if interrupted.

        Raises
        ------
        OSError
            The file cannot be written, or one of its name has appeared in the meantime.
        """
        try:
            _aside(lambda: write(self._scratch), lambda: progress(_size(self._scratch)))
            _flush(self._scratch)
            with _guard:
                self._place()
        except FileExistsError:
            raise OSError(self._keep_elsewhere()) from None
        except OSError as error:
            raise OSError(
                f"cannot write {self.path}: {error.strerror or error}; check disk space and permissions"
            ) from error
        except RuntimeError as error:  # netCDF's word for any trouble, a full disk above all
            raise OSError(f"cannot write {self.path}: {error}; check disk space") from error

    def keep(self, content: bytes) -> None:
        """Put a file into place from `kept`, which is called when nothing else can be put there any more."""
        self._scratch.write_bytes(content)
        self._place()

    def _place(self) -> None:
        if self._overwrite and self._target.exists():
            _take_after(self._scratch, self._target)
            os.replace(self._scratch, self._target)
        else:
            _create(self._scratch, self._target)
        _written.append(self.path)

    def _keep_elsewhere(self) -> str:
        """Save the result under another name, as a file has appeared meanwhile; return the message."""
        number = 1
        while True:
            beside = self.path.with_name(f"{self.path.stem}-{number}{self.path.suffix}")
            with contextlib.suppress(FileExistsError), _guard:
                _create(self._scratch, self._target.with_name(beside.name))
                _written.append(beside)
                return (
                    f"cannot write {self.path}: a file of this name has appeared meanwhile; "
                    f"the result is in {beside}"
                )
            number += 1

    def claim(self) -> None:
        """Claim the name, and remove leftovers of killed runs from the folder."""
        try:
            _sweep(self._target.parent)
            with _guard:
                _claims.add(self)
                self._lock = _enter(self._folder)
        except _Taken:
            raise InputError(f"cannot write {self.path}: another run is writing it; use another -o") from None
        except OSError as error:
            raise InputError(f"cannot write {self.path}: {error.strerror}; use another -o") from None

    def release(self) -> None:
        """Release the name; only the finished file is left, if there is one."""
        with _guard:
            if self._lock >= 0:
                _remove(self._folder, self._lock, self._scratch.name)
                os.close(self._lock)
            _claims.discard(self)


@contextlib.contextmanager
def claimed(
    path: Path, overwrite: bool = False, inputs: Sequence[Path] = (), name: str = "-o"
) -> Iterator[Output]:
    """Claim an output path, or refuse it at once, until the end of the context.

    name : of the argument that gave it, for messages

    Raises
    ------
    InputError
        `path` is one of the `inputs`, exists (without `overwrite`), is no ordinary file, cannot be written
        to, or another run is writing it.
    """
    _check(path, overwrite, inputs, name)
    output = Output(path, overwrite)
    try:
        output.claim()
        _check(path, overwrite, inputs, name)  # again: a run that ended since may have made it
        yield output
    finally:
        output.release()


@contextlib.contextmanager
def claimed_folder(path: Path) -> Iterator[Output]:
    """Claim a folder, filled gradually, until the end of the context.

    Raises
    ------
    InputError
        `path` is something else than a folder, cannot be written to, or another run is writing it.
    """
    target = Path(os.path.realpath(path))
    if not target.parent.is_dir():
        raise InputError(f"-o must be in an existing folder; got {path}")
    if target.exists() and not target.is_dir():
        raise InputError(f"-o must be a store, which is a folder; got the file {path}")
    output = Output(path, True)
    try:
        output.claim()
        yield output
    finally:
        output.release()


def _check(path: Path, overwrite: bool, inputs: Sequence[Path], name: str) -> None:
    try:
        target = Path(os.path.realpath(path))
        if not target.parent.is_dir():
            raise InputError(f"{name} must be in an existing folder; got {path}")
        try:
            mode = os.lstat(target).st_mode
        except FileNotFoundError:
            return
        if stat.S_ISDIR(mode):
            raise InputError(f"{name} must be a file; got the folder {path}")
        if not stat.S_ISREG(mode):  # /dev/null, say: it would be replaced by a file
            raise InputError(f"{name} must be an ordinary file; got {path}")
        for given in inputs:
            if given.exists() and os.path.samefile(given, target):  # who reads it refuses a missing one
                raise InputError(f"cannot write {path}: it is the input file {given}; use another {name}")
        if not overwrite:
            raise InputError(f"cannot write {path}: it already exists; use --overwrite or another {name}")
        if not os.access(target, os.W_OK):
            raise InputError(f"cannot write {path}: it is write-protected; use another {name}")
    except OSError as error:
        raise InputError(f"cannot write {path}: {error.strerror}; use another {name}") from None


def abandon() -> str:
    """Remove all claims permanently; nothing can be claimed or moved into place afterwards."""
    known = _guard.acquire(timeout=1.0)
    kept = "".join(output.kept() for output in _claims)
    for output in list(_claims):
        if output._lock >= 0:
            _remove(output._folder, output._lock, output._scratch.name)
    if not known:  # a file system that has stopped answering
        return "the output may have been written"
    return kept or (f"{', '.join(map(str, _written))} had been written" if _written else "")


def _enter(folder: Path) -> int:
    """Take the lock of a folder, which is made if necessary."""
    while True:
        with contextlib.suppress(FileExistsError):
            folder.mkdir()
        with contextlib.suppress(FileNotFoundError):  # another process is clearing it away
            return _lock(folder, os.O_RDWR | os.O_CREAT)


def _flock(handle: int) -> None:
    if sys.platform == "win32":
        raise OSError(errno.ENOSYS, "no locks")
    fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)


def _lock(folder: Path, flags: int) -> int:
    """Take the lock of a folder; it is held until the returned file is closed or the process ends."""
    path = folder / _LOCK
    handle = os.open(path, flags, 0o600)
    try:
        _flock(handle)
        if not os.path.samestat(os.fstat(handle), os.stat(path)):
            raise FileNotFoundError(path)
    except BlockingIOError:
        os.close(handle)
        raise _Taken from None
    except OSError as error:
        if error.errno in _NO_LOCKS and flags & os.O_CREAT:
            return handle  # all that is lost is that leftovers stay
        os.close(handle)
        raise
    return handle


def _sweep(parent: Path) -> None:
    """Remove the folders of runs that were killed."""
    for folder in parent.glob(_FOLDERS):
        with contextlib.suppress(OSError, _Taken):
            lock = _lock(folder, os.O_RDWR)
            _remove(folder, lock)
            os.close(lock)


def _remove(folder: Path, lock: int, files: str = f"{_FILE}*") -> None:
    """Remove leftovers of a claim, and nothing else."""
    folder = _moved_away(folder, lock)
    for _ in range(3):  # a library may make its file just now
        for file in (*folder.glob(files), folder / _LOCK):
            with contextlib.suppress(OSError):
                file.unlink()
        with contextlib.suppress(OSError):
            folder.rmdir()
            return


def _moved_away(folder: Path, lock: int) -> Path:
    """Rename a folder, so that another run may claim its name, and return the new path."""
    away = folder.with_name(_PREFIX + secrets.token_hex(8))
    try:
        _flock(lock)  # ours already; an error where there are no locks, as then others may be in the folder
        if not all(name == _LOCK or name.startswith(_FILE) for name in os.listdir(folder)):
            return folder  # somebody keeps other things there
        folder.rename(away)
    except OSError:
        return folder
    return away


def _aside(work: Callable[[], None], waiting: Callable[[], None]) -> None:
    """Run work in a separate thread, where no interrupt is raised, and wait for it."""
    failures: list[BaseException] = []
    wanted, begin, done = threading.Event(), threading.Event(), threading.Event()

    def run() -> None:
        begin.wait()
        try:
            if wanted.is_set():
                work()
        except BaseException as error:
            failures.append(error)
        finally:
            done.set()

    try:
        threading.Thread(target=run, daemon=True).start()
        wanted.set()  # from here on it is waited for; an interrupt before finds the work not begun
        begin.set()
        while not done.wait(0.2):
            waiting()
    finally:
        begin.set()
        if wanted.is_set():
            done.wait()
    if failures:
        raise failures[0]


def _size(path: Path) -> int:
    return path.stat().st_size if path.exists() else 0


def _flush(path: Path) -> None:
    """Flush a file to disk; some file systems report errors only then."""
    handle = os.open(path, os.O_RDWR)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


def _take_after(new: Path, old: Path) -> None:
    """Copy owner, group and permissions of the replaced file, as far as permitted."""
    before = old.stat()
    if hasattr(os, "chown"):
        for owner, group in ((before.st_uid, -1), (-1, before.st_gid)):
            with contextlib.suppress(OSError):
                os.chown(new, owner, group)
    with contextlib.suppress(OSError):
        new.chmod(stat.S_IMODE(before.st_mode))


def _create(new: Path, target: Path) -> None:
    """Rename `new` to `target`, which must not exist, in one step."""
    try:
        os.link(new, target)
    except FileExistsError:
        raise
    except OSError:  # a file system without hard links
        os.close(os.open(target, os.O_WRONLY | os.O_CREAT | os.O_EXCL))
        os.replace(new, target)
