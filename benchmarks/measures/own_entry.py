"""Functions of the benchmarks and the tests that call kernels."""

from collections.abc import Callable
from typing import Any

from frictionmap._kernels.compiler import entry


def own_entry(function: Callable) -> Any:
    """Compile a function that calls kernels like the package does, again in every process.

    The key of a function that is kept names its own file and the kernels, but not other modules whose
    functions it may call.
    """
    return entry(function, keep=False)
