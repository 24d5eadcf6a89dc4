"""The private names of numba and llvmlite that the fast compiler relies on.

`check` looks them up before the first kernel is decorated.  Names of `on_objects` exist only on objects that
numba makes; they are missed when the first kernel is compiled, which then falls back to plain numba as well.
"""

from importlib import import_module
from typing import Any, NamedTuple


class Names(NamedTuple):
    """Names of one module or class.

    owner      : "module" or "module:class"
    names      : found in the owner itself
    on_objects : found on objects of the class
    purpose    : why the fast compiler needs them
    """

    owner: str
    names: tuple[str, ...]
    purpose: str
    on_objects: tuple[str, ...] = ()


NAMES = (
    Names(
        "numba.core.registry:CPUDispatcher",
        (
            "get_call_template", "get_overload", "add_overload", "compile", "_compile_for_args", "_insert",
        ),
        "a kernel is compiled once for constant and variable arguments, has no wrapper for Python and "
        "returns no array; an entry is compiled by plain numba if the fast compiler fails",
        ("_cache", "targetoptions"),
    ),
    Names(
        "numba.core.types:Dispatcher",
        ("get_call_type", "get_overload"),
        "the class of an argument selects the body of a function",
    ),
    Names("numba.core.types", ("unliteral",), "constant arguments are typed like variables"),
    Names("numba.core.types:BaseTuple", ("from_types",), "the result of a late kernel is declared"),
    Names(
        "numba.core.typing.templates",
        ("make_concrete_template",),
        "a call of a late kernel is typed without compiling it",
    ),
    Names(
        "numba.core.cgutils",
        ("add_global_variable", "get_or_insert_function", "if_unlikely", "is_null"),
        "a call of a late kernel goes through an address",
    ),
    Names(
        "numba.core.compiler:Compiler",
        ("compile_extra", "_compile_bytecode"),
        "each kernel gets a library of its own, with the same name in every process",
        ("state",),
    ),
    Names(
        "numba.core.compiler:Flags",
        ("copy", "nrt", "forceinline", "no_rewrites", "get_mangle_string"),
        "numba's own functions are compiled once for all kernels",
    ),
    Names(
        "numba.core.codegen:JITCodeLibrary",
        (
            "add_linking_library", "enable_object_caching", "serialize_using_object_code",
            "has_dynamic_globals", "codegen", "_ensure_finalized", "_finalize_dynamic_globals",
            "_finalize_final_module", "_finalized", "_get_compiled_object", "_optimize_final_module",
            "_optimize_functions", "_set_compiled_object", "get_pointer_to_function",
        ),
        "a kernel is optimised once, then called by name or copied into its callers",
        ("_codegen", "_final_module"),
    ),
    Names(
        "numba.core.codegen:JITCPUCodegen",
        ("_module_pass_manager", "magic_tuple", "set_env"),
        "a kernel is optimised as numba does it; its file names the processor it was compiled for",
        ("_data_layout", "_engine"),
    ),
    Names(
        "numba.core.codegen:JitEngine",
        (),
        "the linker finds kernels that were loaded from disk",
        ("_defined_symbols",),
    ),
    Names(
        "llvmlite.binding",
        ("add_symbol", "parse_bitcode"),
        "late kernels are asked for, inner kernels are loaded from disk",
    ),
    Names("numba.core.compiler", ("compile_result",), "a compiled kernel is rebuilt from its file"),
    Names(
        "numba.core.compiler:CompileResult",
        ("_reduce", "_replace", "codegen", "lifted", "library"),
        "a compiled kernel is written to its file",
    ),
    Names("numba.core.cpu:CPUContext", ("get_executable",), "a kernel loaded from disk gets its entry point"),
    Names("numba.core.runtime.nrt:rtsys", ("initialize",), "a kernel loaded from disk may count references"),
    Names("numba.core.serialize", ("dumps",), "numba's objects are written to files"),
    Names("numba.core.sigutils", ("normalize_signature",), "a kernel's file names its argument types"),
)  # fmt: skip


def check() -> None:
    """Look up every name; the AttributeError or ImportError says which one is missing."""
    for group in NAMES:
        module, _, inside = group.owner.partition(":")
        owner = import_module(module)
        if inside:
            owner = _found(owner, inside, group.owner)
        for name in group.names:
            _found(owner, name, f"{group.owner}.{name}")


def _found(owner: object, name: str, full: str) -> Any:
    if not hasattr(owner, name):
        raise AttributeError(f"{full.replace(':', '.')} is missing")
    return getattr(owner, name)
