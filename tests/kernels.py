"""Kernels that only other kernels can call, made callable for tests."""

from collections.abc import Callable

from frictionmap._kernels.compiler import entry


def callable_kernel(kernel: Callable) -> Callable:
    """An entry that calls the kernel; compiled once, and kept on disk as the kernel itself is."""

    def call(*arguments):
        return kernel(*arguments)

    function = getattr(kernel, "py_func", kernel)
    call.__module__ = f"callable.{function.__module__}"
    call.__qualname__ = function.__qualname__
    return entry(call)
