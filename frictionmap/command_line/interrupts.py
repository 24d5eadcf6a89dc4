"""Ctrl-C and termination: the program ends at once, whatever it is doing.

Python runs a signal's handler in the main thread, between two of its own instructions: not while a kernel is
compiled or a large file compressed, which may take many seconds.  So a thread of its own waits for signals.
"""

import contextlib
import os
import select
import signal
import threading
import time
from collections.abc import Callable

#: Exit status of an interrupted run, whichever of the signals ended it.
STATUS = 130

_SIGNALS = ("SIGINT", "SIGTERM", "SIGHUP")

_tidy: Callable[[], str] | None = None
_watched: set[int] = set()
_caught = threading.Event()


def before_exit(tidy: Callable[[], str]) -> None:
    """Register a function that is called on an interrupt and returns what was written, in words."""
    global _tidy
    _tidy = tidy


def obey() -> None:
    """End the process with status 130 on any interrupt from now on; for programs, not for libraries."""
    reading, writing = os.pipe()
    os.set_blocking(writing, False)
    signal.set_wakeup_fd(writing, warn_on_full_buffer=False)
    for name in _SIGNALS:
        number = getattr(signal, name, None)
        if number is not None and signal.getsignal(number) is not signal.SIG_IGN:  # as nohup sets it
            signal.signal(number, lambda *_: _caught.set())
            _watched.add(number)
    threading.Thread(target=_watch, args=(reading,), daemon=True).start()


def ignore() -> None:
    """Ignore further signals; one already received still terminates the process."""
    for number in _watched:
        signal.signal(number, signal.SIG_IGN)
    while _caught.is_set():
        time.sleep(1.0)


def _watch(reading: int) -> None:
    while os.read(reading, 1)[0] not in _watched:
        pass
    try:
        written = _tidy() if _tidy is not None else ""
        _say(f"frictionmap: interrupted; {written or 'nothing was written'}")
    finally:
        os._exit(STATUS)


def _say(text: str) -> None:
    """Write a line to standard error, unless its pipe is full."""
    wipe = "\r" + " " * 78 + "\r" if os.isatty(2) else ""  # the line of progress
    with contextlib.suppress(OSError, ValueError):
        if select.select([], [2], [], 0.5)[1]:
            os.write(2, f"{wipe}{text}\n".encode(errors="backslashreplace"))
