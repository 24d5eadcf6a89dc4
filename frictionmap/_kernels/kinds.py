"""Functions with a body for every kind of motion, chosen when their caller is compiled."""

from collections.abc import Callable
from functools import wraps

from numba import types
from numba.extending import overload

from .jit import KERNEL_RULES


def _plain(body: Callable) -> Callable:
    """The Python function of a kernel; with the compiler off it is one."""
    return getattr(body, "py_func", body)


def by_class(
    *bodies: tuple[type, Callable], inline: bool = False, allocates: bool = False
) -> Callable[[Callable], Callable]:
    """Replace a declaration by the bodies for the classes of its first argument, a named tuple.

    The choice costs nothing when a kernel runs, and a kernel that calls the function is cached on disk as any
    other.  Kernels passed as arguments would not be, and forwarding to one of two kernels copies its records.

    bodies : (class, kernel) pairs; kernels of as many arguments as the declaration has
    inline : for what every event does, where a call would pass a whole record
    allocates : whether the kernels may allocate arrays
    """
    chosen = {kind: _plain(body) for kind, body in bodies}

    def declare(declaration: Callable) -> Callable:
        @wraps(declaration)
        def pick(first: tuple, *others: object) -> object:
            return chosen[type(first)](first, *others)

        def choose(first: types.Type, *_: types.Type) -> Callable | None:
            # a tuple whose fields are all of one type has another type class: the base covers both
            return chosen.get(first.instance_class) if isinstance(first, types.BaseNamedTuple) else None

        overload(pick, strict=False, jit_options=KERNEL_RULES | {"forceinline": inline, "_nrt": allocates})(
            choose
        )
        return pick

    return declare
