"""Functions whose body is chosen by the class of an argument when their caller is compiled."""

from collections.abc import Callable
from functools import cached_property, partial, update_wrapper
from typing import Any, NoReturn

from numba import types

from . import plain
from .mode import mode


class _Choice:
    """The bodies of a function; numba's compiler asks it as it asks a compiled function."""

    is_compiling = False  # a question for the bodies

    def __init__(self, declaration: Callable, bodies: dict[type, Any]) -> None:
        update_wrapper(self, declaration)
        self.py_func = declaration
        self.bodies = bodies
        mode.preparations.append(partial(plain.compile_by_class, self, bodies))

    @property
    def _numba_type_(self) -> Any:
        """The type of this object in kernels; None if plain numba is to find `compile_by_class`."""
        return None if mode.plain else self._type

    @cached_property
    def _type(self) -> Any:
        return types.Dispatcher(self)

    def get_call_template(self, args: tuple, kws: dict) -> Any:
        """Compile the body for a call and return its signature."""
        return self._body(args[0]).get_call_template(args, kws)

    def get_overload(self, args: tuple) -> Any:
        """Return the compiled body for a call."""
        return self._body(args[0]).get_overload(args)

    def _body(self, first: Any) -> Any:
        return self.bodies[first.instance_class]

    def __call__(self, *_: Any) -> NoReturn:
        raise TypeError(f"{self.__name__} can be called by kernels only; Python calls an entry")


def by_class(*bodies: tuple[type, Any]) -> Callable[[Callable], Any]:
    """Replace a declaration by the bodies for the classes of its first argument, a named tuple.

    The choice costs nothing when a kernel runs, and a kernel that calls the function is kept on disk like any
    other.  Kernels passed as arguments would not be, and forwarding to one of two kernels copies its records.

    bodies : (class, kernel) pairs; kernels take as many arguments as the declaration
    """
    chosen = dict(bodies)

    def declare(declaration: Callable) -> Any:
        return _Choice(declaration, chosen)

    return declare
