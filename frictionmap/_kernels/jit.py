"""One decorator for every kernel, so that all are compiled under the same rules."""

from numba import njit

#: Kernels never raise (`error_model="numpy"`), never re-order arithmetic (fast-math off) and
#: release the interpreter lock, so that a pool of threads can run them side by side.
kernel = njit(cache=True, nogil=True, error_model="numpy", fastmath=False)

#: The same for what every scan step does, where a call would cost more than the work (48 ns beside 16).
inner_kernel = njit(cache=True, nogil=True, error_model="numpy", fastmath=False, forceinline=True)
