"""Which compiler a process uses: the fast one of this package, or plain numba.

The fast compiler relies on private parts of numba, and is used with those versions of numba that it was
tested with.  If a part is missing, or fails when a kernel is compiled, the whole process changes to plain
numba, which gives the same results after a longer compilation.
"""

import os
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import numba

from ...errors import InputError
from .notices import log, warn_once

#: The environment variable that chooses the compiler, and its values, the default first.
VARIABLE = "FRICTIONMAP_COMPILER"
VALUES = ("fast", "plain")

#: Versions of numba that the tests of the compiler were run with: with another, a kernel may be compiled
#: wrongly without an error.
TESTED = ("0.60", "0.61", "0.62", "0.63", "0.64", "0.65", "0.66", "0.67", "0.68")


class UntestedNumba(Exception):
    """The fast compiler was not tested with this version of numba."""


def requested() -> str:
    """Return the compiler that the environment asks for."""
    value = os.environ.get(VARIABLE) or VALUES[0]
    if value not in VALUES:
        raise InputError(f"unknown {VARIABLE} {value!r}; valid: {', '.join(VALUES)}")
    return value


def check_version() -> None:
    """Raise UntestedNumba unless this numba was tested, or the environment asks for the fast compiler."""
    tested = ".".join(numba.__version__.split(".")[:2]) in TESTED
    if not tested and not os.environ.get(VARIABLE):
        raise UntestedNumba(f"tested are {TESTED[0]} to {TESTED[-1]}; {VARIABLE}=fast uses it nevertheless")


def warn_of_plain(error: Exception) -> None:
    """Report why plain numba compiles the kernels."""
    reason = f"{type(error).__name__}: {str(error).strip()}".splitlines()[0]
    log.debug("the fast compiler failed", exc_info=error)
    warn_once(
        f"cannot use the fast kernel compiler with numba {numba.__version__} ({reason}); plain numba "
        f"compiles the kernels: same results, longer compilation ({VARIABLE}=plain silences this)"
    )


class Mode:
    """The compiler in use.

    plain        : whether kernels are compiled by plain numba from now on
    preparations : called before the first kernel is compiled by plain numba instead of the fast compiler
    """

    def __init__(self) -> None:
        self.plain = False
        self.preparations: list[Callable[[], None]] = []
        self._lock = threading.RLock()

    @contextmanager
    def plain_instead(self, error: Exception) -> Iterator[None]:
        """Change to plain numba after an error of the fast compiler, unless plain numba fails too.

        If both fail, the kernel is wrong, not the compiler: the second error is raised, nothing changes.
        """
        with self._lock:
            before, self.plain = self.plain, True
            while self.preparations:
                self.preparations.pop()()
            try:
                yield
            except BaseException:
                self.plain = before
                raise
            warn_of_plain(error)


#: Of this process.
mode = Mode()
