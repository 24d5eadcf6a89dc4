"""Code of the child: runs the command line, calls and malformed files of the tested package.

It is started with that package already imported, and imports nothing else that needs it by name but
`frictionmap`. Standard output and standard error are captured at the level of file descriptors.
"""

import contextlib
import faulthandler
import io
import json
import os
import resource
import signal
import sys
import tempfile
import traceback
from collections.abc import Callable, Iterator
from pathlib import Path

from . import calling, malformed

#: A run that asks for more memory than this gets a MemoryError, not the machine's last page.
_MEMORY = 12 * 2**30


class _Caught:
    """Output on file descriptors 1 and 2."""

    def __init__(self) -> None:
        self.files = [tempfile.TemporaryFile(), tempfile.TemporaryFile()]  # noqa: SIM115 (as long as we live)

    @contextlib.contextmanager
    def catching(self) -> Iterator[None]:
        for file in self.files:
            file.seek(0)
            file.truncate()
        own = [os.dup(number) for number in (1, 2)]
        for number, file in enumerate(self.files, start=1):
            os.dup2(file.fileno(), number)
        before = sys.stdout, sys.stderr
        sys.stdout, sys.stderr = (
            io.TextIOWrapper(
                io.FileIO(number, "w", closefd=False), encoding="utf-8", errors="backslashreplace"
            )
            for number in (1, 2)
        )
        try:
            yield
        finally:
            for stream in (sys.stdout, sys.stderr):
                with contextlib.suppress(OSError, ValueError):
                    stream.flush()
            sys.stdout, sys.stderr = before
            for number, descriptor in enumerate(own, start=1):
                os.dup2(descriptor, number)
                os.close(descriptor)

    def text(self) -> list[str]:
        for file in self.files:
            file.seek(0)
        return [file.read().decode(errors="replace") for file in self.files]


class Worker:
    """Runs one request after the other."""

    def __init__(self) -> None:
        self._caught = _Caught()

    def main(self, arguments: list[str], folder: str) -> dict:
        """Run the command line: status, output, and the error that escaped from it."""
        from frictionmap.command_line.cli import main

        os.chdir(folder)
        status, escaped = None, ""
        with self._caught.catching():
            try:
                status = main(arguments)
            except SystemExit as end:
                status = end.code if isinstance(end.code, int) else 1
            except BaseException as error:
                escaped = f"{type(error).__name__}: {error}"
        out, err = self._caught.text()
        return {"status": status, "out": out, "err": err, "escaped": escaped}

    def call(self, code: str, folder: str, plain: str = "") -> dict:
        """Call the Python API."""
        os.chdir(folder)
        with self._caught.catching():
            found = calling.outcome(code, plain)
        return found | {"said": "".join(self._caught.text())}

    def mutant(self, base: str, family: str, seed: int, folder: str, plot: bool) -> dict:
        """Make a malformed file, and read it with `info` and `plot`."""
        made = malformed.make(Path(base), family, seed, Path(folder) / "mutant.nc")
        answer = {"what": made, "info": self.main(["info", "mutant.nc"], folder)}
        if answer["info"]["status"] == 0:
            answer["unseen"] = family == malformed.BYTES and malformed.differs(Path(base), Path("mutant.nc"))
        if plot:
            arguments = ["plot", "mutant.nc", "-o", "picture.png", "--overwrite", "--quiet"]
            answer["plot"] = self.main(arguments, folder)
        return answer


def serve(log: int) -> None:
    """Answer the requests on standard input until there are no more."""
    resource.setrlimit(resource.RLIMIT_AS, (_MEMORY, _MEMORY))
    faulthandler.enable(log)
    faulthandler.register(signal.SIGUSR1, log, all_threads=False)
    answers = os.fdopen(os.dup(1), "w", buffering=1)
    requests = os.fdopen(os.dup(0), "r")
    worker = Worker()
    doing: dict[str, Callable[..., dict]] = {
        "main": worker.main, "call": worker.call, "mutant": worker.mutant,
    }  # fmt: skip
    answers.write("{}\n")
    for line in requests:
        request = json.loads(line)
        try:
            answer = doing[request.pop("do")](**request)
        except Exception:  # ours: what the package raises is caught where it is called
            answer = {"failed": traceback.format_exc()}
        answers.write(json.dumps(answer) + "\n")
