"""The default compiler: each kernel is compiled once, under the same rules, and kept on disk.

It replaces parts of numba's dispatchers (docs/compiler.md).  If numba fails with them, plain numba compiles
the entry that was called, and from then on all others (`mode`).
"""

import gc
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cached_property
from typing import Any, NoReturn

import numba
from numba import types
from numba.core.registry import CPUDispatcher

from . import plain
from .cache import KernelCache
from .class_dispatch import by_class
from .late import Late
from .linking import compiler
from .mode import mode

__all__ = ["by_class", "entry", "inner_kernel", "kernel", "late_kernel"]

#: Kernels never raise (`error_model="numpy"`), never re-order arithmetic (no fast-math), and release the
#: interpreter lock, so that several threads can run them side by side.  Options left out here a kernel
#: would take from its first caller.
_RULES = {
    "nopython": True,
    "nogil": True,
    "error_model": "numpy",
    "fastmath": False,
    "forceinline": False,
    "boundscheck": None,
    "_nrt": True,
}

#: A kernel needs no wrappers for Python and C, which take a fifth of the compilation.  It has no arrays of
#: its own and therefore needs no reference counts, which took 30 % of a map's time because threads wait for
#: each other's counts.
_KERNEL_RULES = {**_RULES, "no_cpython_wrapper": True, "no_cfunc_wrapper": True, "_nrt": False}


@contextmanager
def _without_collector() -> Iterator[None]:
    """Switch off Python's garbage collector, which takes an eighth of a compilation.

    The compiler makes millions of objects and keeps most of them.  Afterwards they count as old, so that the
    next collections pass over them; objects that a program has frozen stay frozen.
    """
    was_on = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_on:
            if gc.get_freeze_count() == 0:
                gc.freeze()
                gc.unfreeze()  # into the oldest generation
            gc.enable()


class RuleBroken(TypeError):
    """A kernel breaks a rule of this package; plain numba would compile it."""


class _Compiled(CPUDispatcher):
    """A function compiled once for constant and variable arguments alike.

    numba would compile f(0) and f(i), and all that they call, one by one.
    """

    def get_call_template(self, args: tuple, kws: dict) -> Any:
        compiler = self.plain_form if mode.plain else super()
        return compiler.get_call_template(tuple(types.unliteral(kind) for kind in args), kws)

    def get_overload(self, sig: Any) -> Any:
        return (self.plain_form if mode.plain else super()).get_overload(sig)

    @cached_property
    def plain_form(self) -> Any:
        """The function for kernels that plain numba compiles."""
        return plain.dispatcher(self.py_func)


class _Kernel(_Compiled):
    """A kernel, compiled when a kernel that calls it is compiled."""

    def add_overload(self, cres: Any) -> None:
        if not self.targetoptions["_nrt"] and _holds_array(cres.signature.return_type):
            # a caller that counts references would free an array that was never counted
            raise RuleBroken(f"the kernel {self.py_func.__name__} must not return an array: make it an entry")
        super().add_overload(cres)

    def _insert(self, *_: Any) -> None:
        """Do nothing: Python cannot call a kernel."""

    def _compile_for_args(self, *_: Any, **__: Any) -> NoReturn:
        raise TypeError(f"{self.py_func.__name__} can be called by kernels only; Python calls an entry")


class _LateKernel(_Kernel):
    """A kernel that is compiled while others run."""

    def compile(self, sig: Any) -> Any:
        with _without_collector():
            return super().compile(sig)


class _Entry(_Compiled):
    """A function that Python calls; for kernels that call it, it is compiled once more as a kernel.

    kept   : whether it is kept on disk
    inside : its form for kernels, without the wrappers for Python, which take longer to compile
    """

    kept: bool
    inside: _Kernel

    @cached_property
    def plain_entry(self) -> Any:
        """The same entry for Python, compiled by plain numba."""
        return plain.entry(self.py_func, keep=self.kept)

    def get_call_template(self, args: tuple, kws: dict) -> Any:
        return self.inside.get_call_template(args, kws)

    def get_overload(self, sig: Any) -> Any:
        return self.inside.get_overload(sig)

    def _compile_for_args(self, *args: Any, **kws: Any) -> Any:
        """Return the compiled function for arguments of new types, which numba then calls."""
        if mode.plain:
            return self.plain_entry
        try:
            with _without_collector():
                return super()._compile_for_args(*args, **kws)
        except (RuleBroken, MemoryError):
            raise
        except Exception as error:  # whatever another numba does differently
            return self._plain_instead(error, args)

    def _plain_instead(self, error: Exception, args: tuple) -> Any:
        with mode.plain_instead(error):
            plain.prepare()
            self.plain_entry.compile(tuple(map(numba.typeof, args)))
        return self.plain_entry


def _holds_array(kind: types.Type) -> bool:
    if isinstance(kind, types.BaseTuple):
        return any(_holds_array(part) for part in kind)
    return isinstance(kind, types.Array)


def _compiled(kind: type[_Compiled], function: Callable, rules: dict[str, Any], inner: bool | None) -> Any:
    return kind(function, targetoptions=dict(rules), pipeline_class=compiler(inner))


def _kept(compiled: _Compiled, kind: str = "") -> Any:
    """Keep on disk what is compiled of a function."""
    if not hasattr(compiled, "_cache"):
        raise AttributeError("numba.core.registry.CPUDispatcher._cache is missing")
    compiled._cache = KernelCache(compiled.py_func, kind)
    return compiled


def kernel(function: Callable) -> Any:
    """Decorate a function that only kernels call."""
    return _kept(_compiled(_Kernel, function, _KERNEL_RULES, inner=None))


def inner_kernel(function: Callable) -> Any:
    """Decorate a kernel called so often that a call would cost more than the work (48 ns and 16 ns)."""
    return _kept(_compiled(_Kernel, function, {**_KERNEL_RULES, "forceinline": True}, inner=True))


def late_kernel(returns: Any) -> Callable[[Callable], Any]:
    """Decorate a kernel that is compiled when it is called first; see `decorators`."""
    return lambda function: Late(_kept(_compiled(_LateKernel, function, _KERNEL_RULES, inner=False)), returns)


def entry(function: Callable, *, keep: bool = True) -> Any:
    """Decorate a function that Python calls, or that makes or returns arrays.

    keep : keep the compiled function on disk
    """
    compiled = _compiled(_Entry, function, _RULES, inner=False)
    compiled.inside = _compiled(_Kernel, function, {**_KERNEL_RULES, "_nrt": True}, inner=None)
    compiled.kept = keep
    if keep:
        _kept(compiled)
        _kept(compiled.inside, ".inside")
    return compiled
