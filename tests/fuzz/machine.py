"""Processes of the tested package, and their slowdown by other processes."""

import contextlib
import ctypes
import os
import resource
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

from .verdict import Said

#: Linux: what lets root write where permissions forbid it (linux/capability.h), and how to give it up.
_DAC_OVERRIDE, _DAC_READ_SEARCH = 1, 2
_PR_CAPBSET_DROP = 24

_BUSY = (
    "import time; c = time.process_time(); w = time.perf_counter(); sum(range(3_000_000)); "
    "print((time.perf_counter() - w) / (time.process_time() - c))"
)


def environment(package: Path, **more: str | None) -> dict[str, str]:
    """Environment of a child: the tested package first; None removes a name."""
    content: dict[str, str | None] = {
        **os.environ, "PYTHONPATH": str(package), "MPLBACKEND": "Agg", **more,
    }  # fmt: skip
    return {name: value for name, value in content.items() if value is not None}


def slowness() -> float:
    """Ratio of elapsed time to processor time of a process, which grows if other processes run."""
    done = subprocess.run([sys.executable, "-c", _BUSY], capture_output=True, text=True, check=True)
    return max(1.0, float(done.stdout))


def prepared(*, file_size: int | None = None, ordinary: bool = False) -> Callable[[], None]:
    """Preparation of a new process.

    It restores the effect of Ctrl-C in a terminal. It limits files to `file_size` bytes. With `ordinary`,
    file permissions apply to it, even if it belongs to root.
    """
    library = ctypes.CDLL(None) if ordinary and os.geteuid() == 0 else None

    def prepare() -> None:
        signal.signal(signal.SIGINT, signal.SIG_DFL)  # a background job of a shell ignores it
        if file_size is not None:
            resource.setrlimit(resource.RLIMIT_FSIZE, (file_size, file_size))
        for capability in (_DAC_OVERRIDE, _DAC_READ_SEARCH) if library else ():
            library.prctl(_PR_CAPBSET_DROP, capability, 0, 0, 0)

    return prepare


def start(arguments: list[str], folder: Path, env: dict[str, str], **more: object) -> subprocess.Popen:
    """Start the command line in a new process."""
    command = [sys.executable, "-m", "frictionmap", *arguments]
    given = {"stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE, **more}
    given.setdefault("preexec_fn", prepared())
    return subprocess.Popen(command, cwd=folder, env=env, start_new_session=True, **given)


@contextlib.contextmanager
def ended(process: subprocess.Popen) -> Iterator[subprocess.Popen]:
    """Make sure that the process has ended."""
    try:
        yield process
    finally:
        with contextlib.suppress(ProcessLookupError):
            process.kill()
        process.wait()


def said_by(process: subprocess.Popen, limit: float) -> Said:
    """How a process ended; the status is None if it had to be ended."""
    began = time.perf_counter()
    with ended(process):
        try:
            out, err = process.communicate(timeout=limit)
        except subprocess.TimeoutExpired:
            return Said(None, seconds=time.perf_counter() - began)
    words = [(text or b"").decode(errors="replace") for text in (out, err)]
    return Said(process.returncode, *words, seconds=time.perf_counter() - began)


def run(
    arguments: list[str], folder: Path, env: dict[str, str], limit: float = 600.0, **more: object
) -> Said:
    """Run the command line in a new process."""
    return said_by(start(arguments, folder, env, **more), limit)
