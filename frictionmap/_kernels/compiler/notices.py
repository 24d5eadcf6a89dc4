"""What the compiler reports: warnings, each given once, and that a kernel is about to be compiled."""

import contextlib
import functools
import logging
from collections.abc import Callable, Iterator

log = logging.getLogger("frictionmap")

#: Functions without arguments that are called before a kernel is compiled.
listeners: list[Callable[[], None]] = []


@functools.cache
def warn_once(text: str) -> None:
    """Log a warning once per process; without a logging configuration it goes to standard error."""
    log.warning("frictionmap: %s", text)


def announce() -> None:
    """Call the listeners: a kernel is about to be compiled."""
    for listener in listeners:
        listener()


@contextlib.contextmanager
def listening(listener: Callable[[], None]) -> Iterator[None]:
    """Have a listener called for the length of the context, however it ends."""
    listeners.append(listener)
    try:
        yield
    finally:
        listeners.remove(listener)
