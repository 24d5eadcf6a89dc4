"""The decorators of kernels, made by the compiler that this process uses.

Functions that Python calls, and functions that make or return arrays, are entries; all others are kernels,
and inner kernels if they are called in every scan step.  Python cannot call a kernel.

kernel, inner_kernel : decorate a function that only kernels call
late_kernel          : decorate a kernel that many runs never call, with the type of its result: None, bool,
                       int, float, or a tuple or named tuple of these; it is compiled at its first call
entry                : decorate a function that Python calls; with keep=False it is not kept on disk
by_class             : replace a declaration by bodies, chosen by the class of the first argument
"""

from types import ModuleType

from numba import config

from . import interpreted, plain
from .mode import check_version, mode, requested, warn_of_plain


def _example() -> None:
    """Be decorated, without being compiled, to see whether that works."""


def _compiler() -> ModuleType:
    """Choose the module that makes the decorators."""
    if config.DISABLE_JIT:
        return interpreted
    if requested() == "fast":
        try:
            check_version()
            from . import private_names

            private_names.check()
            from . import fast

            fast.entry(_example)
        except Exception as error:  # whatever another numba lacks or refuses
            warn_of_plain(error)
        else:
            return fast
    plain.prepare()
    return plain


_chosen = _compiler()


def compiler_in_use() -> str:
    """Return "fast", "plain" or "interpreted"."""
    return "plain" if mode.plain else _chosen.__name__.rpartition(".")[2]


kernel = _chosen.kernel
inner_kernel = _chosen.inner_kernel
late_kernel = _chosen.late_kernel
entry = _chosen.entry
by_class = _chosen.by_class
