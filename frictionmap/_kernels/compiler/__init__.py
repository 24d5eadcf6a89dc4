"""Compilation of kernels: the decorators, and what they rely on inside numba.

Kernels import `kernel`, `inner_kernel`, `entry` and `by_class` from here and nothing else.

==============  =========================================================================
module          what is in it
==============  =========================================================================
decorators      the four decorators; chooses one of the three compilers below
fast            the default: each kernel is compiled once, called by name, kept on disk
plain           the fall-back: `numba.njit(cache=True)`, public parts of numba only
interpreted     kernels as Python functions, with NUMBA_DISABLE_JIT
mode            which of fast and plain this process uses, and the variable that chooses
private_names   the private names of numba and llvmlite that `fast` needs; looked up first
linking         (fast) libraries of compiled kernels, linked by name or inlined
class_dispatch  (fast) functions whose body is chosen by the class of an argument
cache           (fast) compiled kernels on disk, with a digest
folders         the folders that compiled kernels are kept in
notices         warnings given once; listeners called before a kernel is compiled
==============  =========================================================================

docs/compiler.md lists the private names, why each is needed, and what a process loses without them.
"""

from .decorators import by_class, entry, inner_kernel, kernel

__all__ = ["by_class", "entry", "inner_kernel", "kernel"]
