"""Cancelling a design question while it is computed."""

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar

from ..jobs import Watch

_WATCH: ContextVar[Watch | None] = ContextVar("watch", default=None)


@contextmanager
def watched(watch: Watch) -> Iterator[None]:
    """Have questions that are asked inside call `watch` repeatedly; an exception raised by it ends them."""
    before = _WATCH.set(watch)
    try:
        yield
    finally:
        _WATCH.reset(before)


def current_watch() -> Watch | None:
    """The function that questions call now, if any."""
    return _WATCH.get()


def look() -> None:
    """Call that function."""
    watch = _WATCH.get()
    if watch is not None:
        watch()
