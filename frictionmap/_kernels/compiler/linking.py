"""Linking of compiled kernels: each is compiled once, on its own, and called where it lies in memory.

numba copies all that a kernel calls into the kernel, optimises it again and generates its code again: a
driver ten calls deep is compiled ten times.  Here only inner kernels and small kernels, which are worth it,
are copied into their callers.  The others are called by name: the linker of numba's single execution engine
finds them.
"""

import functools
from collections import Counter
from collections.abc import Callable, Iterable
from typing import Any, NamedTuple

from llvmlite import binding
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler, Flags

#: Lines of LLVM code below which a kernel is copied into its callers; LLVM would inline most of these.
#: With 250 a map takes up to a sixth longer; the compile time is the same.
_SMALL = 500

#: How often a kernel was compiled or loaded in this process: no two may have the same name.
_times: Counter[str] = Counter()


class Code(NamedTuple):
    """What a library is rebuilt from.

    name    : of the kernel
    number  : of kernels of that name in this process
    inner   : whether callers copy it
    code    : machine code, or LLVM bitcode of an inner kernel
    defined : names of the symbols that it defines
    """

    name: str
    number: int
    inner: bool
    code: bytes
    defined: list[str]


class KernelLibrary(JITCodeLibrary):
    """A compiled kernel: machine code to call, or LLVM code that callers copy if it is an inner kernel.

    inner : None to decide by its size
    calls : kernels that it calls by name
    place : name of its file in the cache, and the key stored there
    """

    def __init__(self, codegen: Any, name: str, number: int, inner: bool | None) -> None:
        super().__init__(codegen, name)
        self.number = number
        self.inner = inner
        self.calls: list[KernelLibrary] = []
        self.place: tuple[str, tuple] | None = None
        _times[name] = max(_times[name], number + 1)
        self.enable_object_caching()

    def add_linking_library(self, library: Any) -> None:
        """Add a function that the kernel calls."""
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
        """Leave functions as they are: they are optimised with all that is copied into the kernel, below."""
        module.data_layout = self._codegen._data_layout

    def _optimize_final_module(self) -> None:
        """Optimise once: numba's first pass is for reference counts, which kernels do not have."""
        manager = self._codegen._module_pass_manager()
        if isinstance(manager, tuple):  # numba 0.61 and newer: (manager, builder)
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
        """The object that sets a kernel's environment; an inner kernel has no code that would read it."""
        return self if self.inner else self._codegen

    def set_env(self, name: str, env: object) -> None:
        """Do nothing: see `codegen`."""

    def serialize_using_object_code(self) -> Code:
        """Return what `rebuilt` needs."""
        self._ensure_finalized()
        values = (*self._final_module.functions, *self._final_module.global_variables)
        defined = [value.name for value in values if not value.is_declaration]
        code = self._final_module.as_bitcode() if self.inner else self._get_compiled_object()
        return Code(self.name, self.number, bool(self.inner), code, defined)


def rebuilt(codegen: Any, kernel: Code, calls: list[KernelLibrary]) -> KernelLibrary:
    """Rebuild the library of a kernel from the cache; the kernels it calls are loaded already."""
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
    """Compiler flags of a kernel; numba's own functions inherit the same flags from every kernel.

    Otherwise numba compiles its functions once more for every set of flags, and compares the sets at every
    operation.
    """

    _inherited: dict[bool, Flags] = {}  # noqa: RUF012

    def copy(self) -> Flags:
        """Return the flags of functions called from here."""
        if self.nrt not in self._inherited:
            inherited = Flags(self)
            inherited.forceinline = False
            self._inherited[self.nrt] = inherited
        return self._inherited[self.nrt]


@functools.cache
def compiler(inner: bool | None) -> type[Compiler]:
    """Return numba's compiler, changed to give each kernel a library with a name that is always the same."""

    class KernelCompiler(Compiler):
        def compile_extra(self, func: Callable) -> Any:
            state = self.state
            state.flags = _KernelFlags(state.flags)
            state.flags.no_rewrites = True  # rewrites are for expressions of whole arrays
            name = f"{func.__module__}.{func.__qualname__}{state.args}{state.flags.get_mangle_string()}"
            state.library = KernelLibrary(state.targetctx.codegen(), name, _times[name], inner)
            return super().compile_extra(func)

        def _compile_bytecode(self) -> Any:
            self.state.func_id.unique_id = self.state.library.number
            return super()._compile_bytecode()

    return KernelCompiler
