"""The decorators of kernels, so that all are compiled under the same rules.

What Python calls, or what makes or returns arrays, is an `entry`; all else is a `kernel`, and an
`inner_kernel` if every scan step calls it.  Python cannot call those two.
"""

from collections.abc import Callable
from typing import Any, NoReturn

from numba import config, types
from numba.core.registry import CPUDispatcher

from .cache import KernelCache
from .linking import compiler

#: Kernels never raise (`error_model="numpy"`), never re-order arithmetic (fast-math off) and release the
#: interpreter lock, so that a pool of threads can run them side by side.  What is not said here a kernel
#: would take from whoever calls it first.
_RULES = {
    "nopython": True,
    "nogil": True,
    "error_model": "numpy",
    "fastmath": False,
    "forceinline": False,
    "_nrt": True,
}

#: What kernels alone call needs no way in from Python: a fifth of the time of compilation.  Without arrays of
#: its own it needs no reference counts: counting took 30 % of a map's time, and threads wait for each other's
#: counts.
_KERNEL_RULES = {**_RULES, "no_cpython_wrapper": True, "no_cfunc_wrapper": True, "_nrt": False}


class _Compiled(CPUDispatcher):
    """Compiled once for constant and variable arguments: numba would compile f(0) and f(i), and all that they
    call, one by one."""

    def get_call_template(self, args: tuple, kws: dict) -> Any:
        return super().get_call_template(tuple(types.unliteral(kind) for kind in args), kws)


class _Kernel(_Compiled):
    """Compiled when another kernel that calls it is."""

    def add_overload(self, cres: Any) -> None:
        if not self.targetoptions["_nrt"] and _holds_array(cres.signature.return_type):
            # whoever counts references would free what was never counted
            raise TypeError(f"the kernel {self.py_func.__name__} must not return an array: make it an entry")
        super().add_overload(cres)

    def _insert(self, *_: Any) -> None:
        """Nothing that Python could call."""

    def _compile_for_args(self, *_: Any, **__: Any) -> NoReturn:
        raise TypeError(f"{self.py_func.__name__} can be called by kernels only; Python calls an entry")


class _Entry(_Compiled):
    """Compiled for Python when Python calls it; when a kernel does, without a way in, which takes longer."""

    def get_call_template(self, args: tuple, kws: dict) -> Any:
        return self.inside.get_call_template(args, kws)

    def get_overload(self, sig: Any) -> Any:
        return self.inside.get_overload(sig)


def _holds_array(kind: types.Type) -> bool:
    if isinstance(kind, types.BaseTuple):
        return any(_holds_array(part) for part in kind)
    return isinstance(kind, types.Array)


def _compiled(kind: type[_Compiled], function: Callable, rules: dict, inner: bool | None, name: str) -> Any:
    options = {"boundscheck": None, **rules}
    compiled = kind(function, targetoptions=options, pipeline_class=compiler(inner))
    compiled._cache = KernelCache(function, name)
    return compiled


def _decorator(rules: dict[str, Any], inner: bool | None) -> Callable[[Callable], Any]:
    def decorate(function: Callable) -> Any:
        return function if config.DISABLE_JIT else _compiled(_Kernel, function, rules, inner, "")

    return decorate


kernel = _decorator(_KERNEL_RULES, inner=None)

#: Called where a call would cost more than the work (48 ns beside 16).
inner_kernel = _decorator({**_KERNEL_RULES, "forceinline": True}, inner=True)


def entry(function: Callable) -> Any:
    """What Python calls, or what makes or returns arrays."""
    if config.DISABLE_JIT:
        return function
    compiled = _compiled(_Entry, function, _RULES, False, "")
    compiled.inside = _compiled(_Kernel, function, {**_KERNEL_RULES, "_nrt": True}, None, ".inside")
    return compiled
