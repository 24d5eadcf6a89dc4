"""The decorators of kernels, so that all are compiled under the same rules.

What Python calls, or what makes or returns arrays, is an `entry`; all else is a `kernel`, and an
`inner_kernel` if every scan step calls it.  Python cannot call those two.
"""

from collections.abc import Callable
from typing import Any, NoReturn

from numba import config, types
from numba.core.registry import CPUDispatcher

from .cache import KernelCache

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
KERNEL_RULES = {**_RULES, "no_cpython_wrapper": True, "no_cfunc_wrapper": True, "_nrt": False}


class _Entry(CPUDispatcher):
    """Compiled once for constant and variable arguments: numba would compile f(0) and f(i), and all that they
    call, one by one."""

    def get_call_template(self, args: tuple, kws: dict) -> Any:
        return super().get_call_template(tuple(types.unliteral(kind) for kind in args), kws)


class _Kernel(_Entry):
    """Compiled when another kernel that calls it is."""

    def add_overload(self, cres: Any) -> None:
        if _holds_array(cres.signature.return_type):
            # whoever counts references would free what was never counted
            raise TypeError(f"the kernel {self.py_func.__name__} must not return an array: make it an entry")
        super().add_overload(cres)

    def _insert(self, *_: Any) -> None:
        """Nothing that Python could call."""

    def _compile_for_args(self, *_: Any, **__: Any) -> NoReturn:
        raise TypeError(f"{self.py_func.__name__} can be called by kernels only; Python calls an entry")


def _holds_array(kind: types.Type) -> bool:
    if isinstance(kind, types.BaseTuple):
        return any(_holds_array(part) for part in kind)
    return isinstance(kind, types.Array)


def _decorator(dispatcher: type[_Entry], rules: dict[str, Any]) -> Callable[[Callable], Any]:
    def decorate(function: Callable) -> Any:
        if config.DISABLE_JIT:
            return function
        compiled = dispatcher(function, targetoptions={"boundscheck": None, **rules})
        compiled._cache = KernelCache(function)
        return compiled

    return decorate


entry = _decorator(_Entry, _RULES)
kernel = _decorator(_Kernel, KERNEL_RULES)

#: Called where a call would cost more than the work (48 ns beside 16).
inner_kernel = _decorator(_Kernel, {**KERNEL_RULES, "forceinline": True})
