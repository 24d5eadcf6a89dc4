"""Functions of the benchmarks and the tests that call kernels."""

from collections.abc import Callable
from typing import Any

from frictionmap._kernels.compiler import entry


def own_entry(function: Callable) -> Any:
    """Compile a function that calls kernels like the package does, again in every process.

    The package identifies compiled kernels by its own source files; it would not notice a change of this
    function.
    """
    return entry(function, keep=False)
