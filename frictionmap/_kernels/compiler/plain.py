"""The fall-back: kernels compiled and kept by numba's public interface alone.

Results are those of the fast compiler, bit for bit.  Compilation takes longer, because numba optimises and
generates code for a kernel again in each kernel that calls it.  Files on disk carry no digest of their
content.
"""

import functools
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from numba import config, njit
from numba.extending import overload

from .folders import folders, state, warn_of_place
from .notices import announce, warn_once

#: Kernels never raise (`error_model="numpy"`), never re-order arithmetic (no fast-math), and release the
#: interpreter lock, so that several threads can run them side by side.
_RULES = {"nogil": True, "error_model": "numpy", "fastmath": False}

_PACKAGE = f"{__name__.partition('.')[0]}."


def kernel(function: Callable) -> Callable:
    """Decorate a function that only kernels call; it becomes part of the entries that call it.

    Under `njit` it would be compiled once more for each constant that it is called with.
    """
    overload(function, jit_options=_RULES, strict=False)(lambda *_: function)
    return function


inner_kernel = kernel


def late_kernel(returns: Any) -> Callable[[Callable], Callable]:
    """Leave a kernel to be compiled with those that call it."""
    return kernel


def dispatcher(function: Callable) -> Any:
    """Compile a function under the rules of kernels, without keeping it."""
    return njit(**_RULES)(function)


def entry(function: Callable, *, keep: bool = True) -> Any:
    """Decorate a function that Python calls.

    keep : keep the compiled function on disk, if a folder can be written to
    """
    if keep and folders(state()):
        try:
            with _numba_folder(folders(state())[-1]):
                return njit(cache=True, **_RULES)(function)
        except Exception as error:  # numba finds no source file or no folder
            warn_once(f"compiled kernels cannot be kept ({error}): every run compiles them again")
    return dispatcher(function)


@contextmanager
def _numba_folder(folder: Path) -> Iterator[None]:
    """Make numba keep what is decorated meanwhile in a folder for this state of the kernels.

    numba does not notice that a kernel has changed which an entry calls; the name of the folder does.
    """
    before = config.CACHE_DIR
    config.CACHE_DIR = str(folder)
    try:
        yield
    finally:
        config.CACHE_DIR = before


def by_class(*bodies: tuple[type, Callable]) -> Callable[[Callable], Callable]:
    """Replace a declaration by the bodies for the classes of its first argument, a named tuple."""

    def declare(declaration: Callable) -> Callable:
        compile_by_class(declaration, dict(bodies))
        return declaration

    return declare


def compile_by_class(name: Callable, bodies: dict[type, Any]) -> None:
    """Let numba compile the body for the class of the first argument where a kernel calls `name`."""

    def choose(first: Any, *_: Any) -> Callable:
        body = bodies[first.instance_class]
        return getattr(body, "py_func", body)

    overload(name, jit_options=_RULES, strict=False)(choose)


@functools.cache
def prepare() -> None:
    """Announce compilations from now on; without numba's events nothing is announced."""
    try:
        from numba.core import event

        event.register("numba:compile", _announcer(event.Listener))
    except (ImportError, AttributeError):
        pass


def _announcer(base: type) -> Any:
    class Announcer(base):
        def on_start(self, event: Any) -> None:
            if event.data["dispatcher"].py_func.__module__.startswith(_PACKAGE):
                warn_of_place(folders(state()))
                announce()

        def on_end(self, event: Any) -> None:
            """Do nothing: only the start is announced."""

    return Announcer()
