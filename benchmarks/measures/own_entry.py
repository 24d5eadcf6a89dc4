"""Functions of the benchmarks and the tests that call kernels."""

from collections.abc import Callable
from typing import Any

from numba.core.caching import NullCache

from frictionmap._kernels.compiler import entry


def own_entry(function: Callable) -> Any:
    """Compile a function that calls kernels, as the package does; every process does so anew.

    What the package keeps on disk it knows by its own sources: it would not see that this one has changed.
    """
    compiled = entry(function)
    if compiled is not function:  # as it is where the JIT is off
        compiled._cache = compiled.inside._cache = NullCache()
    return compiled
