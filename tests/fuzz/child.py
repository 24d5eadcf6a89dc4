"""Long-lived child process that runs the tested package; it is restarted when it ends."""

import contextlib
import json
import os
import selectors
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from .machine import environment
from .verdict import Said

_TESTS = Path(__file__).resolve().parent.parent

#: The package under trial is imported before the tests, beside which another one may lie, come onto the path.
_START = (
    "import sys, frictionmap; sys.path.insert(0, sys.argv[1]); "
    "from fuzz.worker import serve; serve(int(sys.argv[2]))"
)


class Ended(Exception):
    """The child ended, or was ended."""

    def __init__(self, hang: bool, stack: str) -> None:
        super().__init__(stack)
        self.hang = hang
        self.stack = stack  # of Python, innermost call first

    @property
    def in_library(self) -> bool:
        """Whether it happened inside the HDF5 library."""
        first = next((line for line in self.stack.splitlines() if "File " in line), "")
        return any(name in first for name in ("netCDF4", "h5netcdf", "h5py", "backends/file_manager"))


class Child:
    """Requests and replies, one line of JSON each, under a time limit."""

    def __init__(self, package: Path) -> None:
        self.package = package
        self._process: subprocess.Popen | None = None

    def __enter__(self) -> "Child":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """End the child."""
        if self._process is not None:
            self._process.kill()
            self._process.wait()
            for pipe in (self._process.stdin, self._process.stdout):
                with contextlib.suppress(BrokenPipeError):
                    pipe.close()
            self._log.close()
            self._process = None

    def _started(self) -> subprocess.Popen:
        if self._process is None:
            self._log = tempfile.TemporaryFile()  # noqa: SIM115 (closed in close)
            os.set_inheritable(self._log.fileno(), True)
            self._process = subprocess.Popen(
                [sys.executable, "-c", _START, str(_TESTS), str(self._log.fileno())],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=self._log,
                pass_fds=[self._log.fileno()],
                env=environment(self.package),
                cwd=tempfile.gettempdir(),
            )
            self._answer(600.0)  # it says when it has loaded all it needs
        return self._process

    def ask(self, limit: float = 120.0, **request: object) -> dict:
        """Return the reply to a request; Ended if it takes longer than `limit` seconds or ends the child."""
        process = self._started()
        process.stdin.write(json.dumps(request).encode() + b"\n")
        process.stdin.flush()
        return self._answer(limit)

    def _answer(self, limit: float) -> dict:
        pipe, until, got = self._process.stdout, time.monotonic() + limit, b""
        with selectors.DefaultSelector() as selector:
            selector.register(pipe, selectors.EVENT_READ)
            while not got.endswith(b"\n"):
                if not selector.select(max(until - time.monotonic(), 0.0)):
                    raise self._ended(hang=True)
                part = os.read(pipe.fileno(), 1 << 16)
                if not part:
                    raise self._ended(hang=False)
                got += part
        answer = json.loads(got)
        if "failed" in answer:
            raise RuntimeError(answer["failed"])
        return answer

    def _ended(self, hang: bool) -> Ended:
        if hang:
            self._process.send_signal(signal.SIGUSR1)  # faulthandler writes the stack
            time.sleep(0.5)
        else:
            self._process.wait()
        self._log.seek(0)
        stack = self._log.read().decode(errors="replace")
        self.close()
        return Ended(hang, stack)

    def main(self, arguments: list[str], folder: Path, limit: float = 120.0) -> Said:
        """Run the command line in this folder."""
        return Said(**self.ask(limit, do="main", arguments=arguments, folder=str(folder)))
