"""How compiled kernels come together: each is compiled once, on its own, and called where it lies.

numba makes all that a kernel calls part of the kernel, optimises it again and emits it again: a driver ten
calls deep is compiled ten times.  Here only inner kernels, which are worth it, become part of their callers.
The others are called by name: the linker of numba's one execution engine finds them.
"""

import functools
from collections import Counter
from collections.abc import Callable, Iterable
from typing import Any, NamedTuple

from llvmlite import binding
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler, Flags

#: Lines of code of a kernel that becomes part of its callers: those that LLVM would make part of them.  With
#: 250 a map takes up to a sixth longer; compiling takes as long with either.
_SMALL = 500

#: How often a kernel was compiled or loaded in this process: no two may have the same name.
_times: Counter[str] = Counter()


class Code(NamedTuple):
    """What makes a library again."""

    name: str
    number: int
    inner: bool
    code: bytes  # for the machine, or of an inner kernel for the compiler
    defined: list[str]  # names


class KernelLibrary(JITCodeLibrary):
    """A kernel, as code to call or, of an inner kernel, as code to become part of its callers.

    inner : None to tell by its size
    """

    def __init__(self, codegen: Any, name: str, number: int, inner: bool | None) -> None:
        super().__init__(codegen, name)
        self.number = number  # of kernels of that name in this process
        self.inner = inner
        self.calls: list[KernelLibrary] = []  # by name
        self.place: tuple[str, tuple] | None = None  # its file in the cache, and what that is of
        _times[name] = max(_times[name], number + 1)
        self.enable_object_caching()

    def add_linking_library(self, library: Any) -> None:
        """What the kernel calls."""
        if not isinstance(library, KernelLibrary):
            super().add_linking_library(library)
        elif library.inner:
            super().add_linking_library(library)
            self._call(library.calls)
        else:
            library._ensure_finalized()
            self._call([library])

    def _call(self, libraries: Iterable["KernelLibrary"]) -> None:
        self.calls += [library for library in libraries if library not in self.calls]

    def _optimize_functions(self, module: Any) -> None:
        """Together with all that is part of the kernel, below."""
        module.data_layout = self._codegen._data_layout

    def _optimize_final_module(self) -> None:
        """Once: numba's first pass is for the counting of references, which kernels have none of."""
        manager = self._codegen._module_pass_manager()
        if isinstance(manager, tuple):  # newer versions of numba: with what made it
            manager, builder = manager
            manager.run(self._final_module, builder)
        else:
            manager.run(self._final_module)

    def _finalize_final_module(self) -> None:
        if self.inner is None:
            self.inner = str(self._final_module).count("\n") < _SMALL
        if self.inner:
            self._finalize_dynamic_globals()
            self._finalized = True
        else:
            super()._finalize_final_module()

    @property
    def codegen(self) -> Any:
        """Who sets a kernel's environment; an inner one has no code of its own that would look for it."""
        return self if self.inner else self._codegen

    def set_env(self, name: str, env: object) -> None:
        """See `codegen`."""

    def serialize_using_object_code(self) -> Code:
        """See `stored`."""
        self._ensure_finalized()
        values = (*self._final_module.functions, *self._final_module.global_variables)
        defined = [value.name for value in values if not value.is_declaration]
        code = self._final_module.as_bitcode() if self.inner else self._get_compiled_object()
        return Code(self.name, self.number, bool(self.inner), code, defined)


def stored(codegen: Any, kernel: Code, calls: list[KernelLibrary]) -> KernelLibrary:
    """The library of a kernel that was compiled before; those it calls are loaded."""
    library = KernelLibrary(codegen, kernel.name, kernel.number, kernel.inner)
    library.calls = calls
    if kernel.inner:
        library._final_module = binding.parse_bitcode(kernel.code)
    else:
        library._set_compiled_object(kernel.code)
    library._finalize_final_module()
    if not kernel.inner:
        codegen._engine._defined_symbols.update(kernel.defined)
    return library


class _KernelFlags(Flags):
    """Rules of a kernel; what numba's own functions take from those that call them is alike for all.

    Else numba compiles its own once more for every set of rules, and compares the sets at every operation.
    """

    _taken: dict[bool, Flags] = {}  # noqa: RUF012

    def copy(self) -> Flags:
        """What the functions take that are called from here."""
        if self.nrt not in self._taken:
            taken = Flags(self)
            taken.forceinline = False
            self._taken[self.nrt] = taken
        return self._taken[self.nrt]


@functools.cache
def compiler(inner: bool | None) -> type[Compiler]:
    """numba's compiler, which puts a kernel in a library of its own, named alike in every process."""

    class KernelCompiler(Compiler):
        def compile_extra(self, func: Callable) -> Any:
            state = self.state
            state.flags = _KernelFlags(state.flags)
            state.flags.no_rewrites = True  # they are for expressions of whole arrays
            name = f"{func.__module__}.{func.__qualname__}{state.args}{state.flags.get_mangle_string()}"
            state.library = KernelLibrary(state.targetctx.codegen(), name, _times[name], inner)
            return super().compile_extra(func)

        def _compile_bytecode(self) -> Any:
            self.state.func_id.unique_id = self.state.library.number
            return super()._compile_bytecode()

    return KernelCompiler
