"""Kernels that only other kernels can call, made callable for tests."""

from collections.abc import Callable

from frictionmap._kernels.compiler import entry


def callable_kernel(kernel: Callable) -> Callable:
    """An entry that calls the kernel; compiled once, and kept on disk as the kernel itself is.

    Its module is this one: numba can load only what belongs to a module that can be imported.
    """

    def call(*arguments):
        return kernel(*arguments)

    function = getattr(kernel, "py_func", kernel)
    call.__qualname__ = f"{function.__module__}.{function.__qualname__}"
    return entry(call)
