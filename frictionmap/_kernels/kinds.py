"""Functions with a body for every kind of motion, chosen when their caller is compiled."""

from collections.abc import Callable
from functools import update_wrapper
from typing import Any

from numba import config, types


class _Choice:
    """The bodies of a function; numba's compiler asks it as it asks a compiled function."""

    is_compiling = False  # that is asked of the bodies

    def __init__(self, declaration: Callable, bodies: dict[type, Any]) -> None:
        update_wrapper(self, declaration)
        self.py_func = declaration
        self.bodies = bodies
        self._numba_type_ = types.Dispatcher(self)

    def get_call_template(self, args: tuple, kws: dict) -> Any:
        """The signature of a call, whose body is compiled."""
        return self._body(args[0]).get_call_template(args, kws)

    def get_overload(self, args: tuple) -> Any:
        """What was compiled for a call."""
        return self._body(args[0]).get_overload(args)

    def _body(self, first: Any) -> Any:
        return self.bodies[first.instance_class]


def by_class(*bodies: tuple[type, Callable]) -> Callable[[Callable], Any]:
    """Replace a declaration by the bodies for the classes of its first argument, a named tuple.

    The choice costs nothing when a kernel runs, and a kernel that calls the function is cached on disk as any
    other.  Kernels passed as arguments would not be, and forwarding to one of two kernels copies its records.

    bodies : (class, kernel) pairs; kernels of as many arguments as the declaration has
    """
    chosen = dict(bodies)

    def declare(declaration: Callable) -> Any:
        if not config.DISABLE_JIT:
            return _Choice(declaration, chosen)

        def pick(first: tuple, *others: object) -> object:
            return chosen[type(first)](first, *others)

        return update_wrapper(pick, declaration)

    return declare
