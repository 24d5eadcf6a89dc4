"""Kernels that only other kernels can call, made callable for tests."""

from collections.abc import Callable

from numba import njit


def callable_kernel(kernel: Callable) -> Callable:
    """A function that calls the kernel, compiled for the test."""

    @njit(error_model="numpy")
    def call(*arguments):
        return kernel(*arguments)

    return call
