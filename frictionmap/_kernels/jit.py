"""One decorator for every kernel, so that all are compiled under the same rules."""

from collections.abc import Callable

from numba import config, njit

from .cache import KernelCache


def _kernels(**settings: bool) -> Callable[[Callable], Callable]:
    compiled = njit(nogil=True, error_model="numpy", fastmath=False, **settings)

    def decorate(function: Callable) -> Callable:
        found = compiled(function)
        if not config.DISABLE_JIT:
            found._cache = KernelCache(function)
        return found

    return decorate


#: Kernels never raise (`error_model="numpy"`), never re-order arithmetic (fast-math off) and
#: release the interpreter lock, so that a pool of threads can run them side by side.
kernel = _kernels()

#: The same for what every scan step does, where a call would cost more than the work (48 ns beside 16).
inner_kernel = _kernels(forceinline=True)
