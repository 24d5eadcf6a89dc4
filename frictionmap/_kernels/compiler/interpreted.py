"""Kernels as Python functions, for NUMBA_DISABLE_JIT=1: to step through, or to print from."""

from collections.abc import Callable
from functools import update_wrapper


def kernel(function: Callable) -> Callable:
    """Leave a kernel as it is."""
    return function


inner_kernel = kernel


def late_kernel(returns: object) -> Callable[[Callable], Callable]:
    """Leave a kernel as it is."""
    return kernel


def entry(function: Callable, *, keep: bool = True) -> Callable:
    """Leave an entry as it is."""
    return function


def by_class(*bodies: tuple[type, Callable]) -> Callable[[Callable], Callable]:
    """Call the body for the class of the first argument."""
    chosen = dict(bodies)

    def declare(declaration: Callable) -> Callable:
        def call(first: tuple, *others: object) -> object:
            return chosen[type(first)](first, *others)

        return update_wrapper(call, declaration)

    return declare
