"""Compilation of kernels: the decorators, and what they rely on inside numba.

Kernels import `kernel`, `inner_kernel`, `late_kernel`, `entry` and `by_class` from here, vectors from
`vectors`, `packed` from `packed` and what Python makes for entries from `lending`.

==============  =====================================================================================
module          what is in it
==============  =====================================================================================
notices         warnings given once; listeners called before a kernel is compiled
sources         the source files that decide what a kernel compiles to
folders         the folders that compiled kernels are kept in
private_names   the private names of numba and llvmlite that `fast` needs; looked up first
mode            fast or plain compiler: which one this process uses, and the variable that chooses it
interpreted     kernels as Python functions, with NUMBA_DISABLE_JIT
plain           the fall-back: `numba.njit(cache=True)`, public parts of numba only
class_dispatch  (fast) functions whose body is chosen by the class of an argument
late            (fast) kernels that are compiled when they are called first
linking         (fast) libraries of compiled kernels, linked by name or inlined
packed          named tuples that kernels pass on by their address
lending         named tuples that Python makes and lends to entries by their address
cache           (fast) compiled kernels on disk, each with a key and a digest
fast            the default: each kernel is compiled once, called by name, kept on disk
decorators      the five decorators; chooses one of the three compilers above
vectors         vectors of eight numbers that kernels compute with at once
==============  =====================================================================================

docs/compiler.md lists the private names, why each is needed, and what happens if one is missing.
"""

from .decorators import by_class, entry, inner_kernel, kernel, late_kernel

__all__ = ["by_class", "entry", "inner_kernel", "kernel", "late_kernel"]
