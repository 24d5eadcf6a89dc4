"""Progress of long runs on standard error: one updated line on a terminal, few lines elsewhere."""

import sys
import time
from pathlib import Path
from types import TracebackType
from typing import Self

from ..steady.cost import in_bytes, in_time

#: Seconds after which work counts as long, and between two looks at it.
_LONG, _BETWEEN = 0.5, 0.1

#: Seconds after which work is reported once elsewhere.
_LONG_ELSEWHERE = 10.0

_COMPILING = "first use: compiling, about 40 s, once only"


class Progress:
    """Progress of one task, named by `what`, as a context manager.

    parts : what is counted, such as "maps", if each part is reported when it is done
    """

    def __init__(self, what: str, quiet: bool, parts: str = "") -> None:
        self._what, self._parts = what, parts
        self._done = 0  # parts
        self._active = sys.stderr is not None and not quiet
        self._terminal = self._active and sys.stderr.isatty()
        self._began = time.monotonic()
        self._next = self._began + _LONG
        self._first: tuple[float, float] | None = None  # time and share when work was first heard of
        self._reported = self._compiles = False
        self._shown = 0  # characters that stand on the terminal

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._show("")

    @property
    def took(self) -> str:
        """The time since the begin, in words."""
        seconds = time.monotonic() - self._began
        return f"{seconds:.2g} s" if seconds < 10.0 else in_time(seconds)

    def say(self, text: str, always: bool = False) -> None:
        """Print a line; on a terminal only if it is to remain."""
        if self._active and (always or not self._terminal):
            self._show("")
            print(f"frictionmap: {text}", file=sys.stderr, flush=True)

    def compiling(self) -> None:
        """Report once that kernels are being compiled."""
        if not self._compiles:
            self._compiles = True
            self._show(_COMPILING)
            self.say(_COMPILING)

    def __call__(self, done: float, total: float) -> None:
        """Report how much of the work is done."""
        now, share = time.monotonic(), done / max(total, 1)
        if self._first is None:
            self._first = now, share
        counted, left = f"{int(done)} of {total:g} {self._parts}", self._left(now, share)
        if self._parts and done >= self._done + 1:
            self._done = int(done)
            self.say(f"{counted}{left}")
        elif not self._parts and not self._reported and now >= self._began + _LONG_ELSEWHERE:
            self._reported = True
            self.say(f"{self._what}: {100.0 * share:.0f} % done{left}")
        if now >= self._next:
            self._next = now + _BETWEEN
            self._show(f"{f'{counted}  ' if self._parts else ''}{100.0 * share:5.1f} %{left}")

    def _left(self, now: float, share: float) -> str:
        """Estimate the remaining time from the progress since compilation."""
        assert self._first is not None
        since, before = self._first
        if share <= before:
            return ""
        return f"  about {in_time((1.0 - share) * (now - since) / (share - before))} left"

    def writing(self, path: Path, size: int) -> None:
        """Report how many bytes of a file are written."""
        self._show(f"writing {path}: {in_bytes(size)}")

    def _show(self, text: str) -> None:
        """Replace the line on the terminal."""
        if self._terminal and (text or self._shown):
            wipe = "\r" if text else "\r" + " " * self._shown + "\r"
            print(f"{wipe}{text:<{self._shown if text else 0}}", end="", file=sys.stderr, flush=True)
            self._shown = max(self._shown, len(text)) if text else 0
