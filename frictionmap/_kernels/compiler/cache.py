"""Compiled kernels on disk, so that each is compiled once on a machine.

numba's own cache does not check its files for damage, needs a folder that can be written to, and does not
notice that a kernel has changed which another one calls.  Here every file holds a digest of its content and
a key; a file whose digest or key differs counts as missing.  The key names all that decides what the kernel
compiles to, so that an edit compiles again what depends on the edited file (`sources`), and nothing else.
If no folder can be written to, every run compiles.
"""

import contextlib
import hashlib
import os
import pickle
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

from numba import types
from numba.core import sigutils
from numba.core.compiler import CompileResult, compile_result
from numba.core.runtime.nrt import rtsys
from numba.core.serialize import dumps

from .folders import ENDING, UNDER_WAY, folders, forget, mark, versions, warn_of_place
from .linking import Code, KernelLibrary, rebuilt
from .notices import announce, warn_once
from .packed import Packed
from .sources import digest_for

#: Bytes of the digest (SHA-256) at the beginning of a file.
_DIGEST = 32


class _Damaged(Exception):
    """A file of the cache cannot be read, or holds something else."""


class _Stored(NamedTuple):
    """A compiled kernel, as it is stored; from `descriptor` on these are objects of numba.

    calls : places and numbers of the libraries that it calls by name
    """

    library: Code
    calls: list[tuple[tuple[str, tuple], int]]
    descriptor: Any
    environment: Any
    signature: Any
    annotation: str
    environments: tuple


#: The libraries of kernels in this process, by the names of their files.
_libraries: dict[str, KernelLibrary] = {}


def _read(path: Path, key: tuple) -> Any:
    """Return the data stored in a file under the key; None if there is no file."""
    if not os.path.isfile(path):
        if os.path.lexists(path):
            raise _Damaged
        return None
    try:
        content = path.read_bytes()
        if hashlib.sha256(content[_DIGEST:]).digest() != content[:_DIGEST]:
            raise _Damaged
        found, data = pickle.loads(content[_DIGEST:])
    except Exception:  # a damaged pickle can raise anything
        raise _Damaged from None
    if found != key:
        raise _Damaged
    return data


def _write(path: Path, key: tuple, data: object) -> None:
    """Write data under the key; the file appears complete or not at all."""
    body = dumps((key, data))
    if path.is_dir():
        path.rmdir()
    handle, name = tempfile.mkstemp(prefix=UNDER_WAY, dir=path.parent)
    try:
        with open(handle, "wb") as file:
            file.write(hashlib.sha256(body).digest() + body)
        os.chmod(name, 0o644)  # users who can enter the folder can use its files
        os.replace(name, path)
    except BaseException:
        with contextlib.suppress(OSError):
            os.unlink(name)
        raise


def _find(name: str, key: tuple) -> Any:
    """Return the data stored under the key in any folder; None if there is no undamaged file."""
    damaged = None
    for folder in folders():
        try:
            data = _read(folder / name, key)
        except _Damaged:
            damaged = folder
            continue
        if data is not None:
            mark(folder / name)
            return data
    if damaged is not None:
        warn_once(f"the compiled kernels in {damaged} are damaged; they are compiled again")
    return None


def _to_store(result: CompileResult) -> _Stored:
    """Return what a kernel is rebuilt from."""
    unannotated = result._replace(
        type_annotation=""
    )  # numba would write a listing of types, which nobody reads
    library, descriptor, environment, signature, _, _, annotation, _, environments = unannotated._reduce()
    calls = [(called.place, called.number) for called in result.library.calls]
    return _Stored(library, calls, descriptor, environment, signature, annotation, environments)


def _library(codegen: Any, name: str, key: tuple, data: _Stored | None = None) -> KernelLibrary | None:
    """Load the library of a stored kernel and all that it calls; None if any of it is missing."""
    if name not in _libraries:
        data = data or _find(name, key)
        if data is None:
            return None
        calls = []
        for place, number in data.calls:
            called = _library(codegen, *place)
            if called is None or called.number != number:
                return None
            calls.append(called)
        _libraries[name] = rebuilt(codegen, data.library, calls)
        _libraries[name].place = name, key
    return _libraries[name]


def _compile_result(target_context: Any, library: KernelLibrary, data: _Stored) -> CompileResult:
    """Rebuild the compiler's result, as `CompileResult._rebuild` of numba does."""
    for environment in data.environments:
        library.codegen.set_env(environment.env_name, environment)
    return compile_result(
        target_context=target_context,
        typing_context=target_context.typing_context,
        library=library,
        environment=data.environment,
        entry_point=target_context.get_executable(library, data.descriptor, data.environment),
        fndesc=data.descriptor,
        type_annotation=data.annotation,
        signature=data.signature,
        objectmode=False,
        lifted=(),
        reload_init=(),
        referenced_envs=data.environments,
    )


def _described(kind: Any) -> object:
    """Return what distinguishes the type of an argument.

    numba's names of named tuples leave out the fields, whose order a kernel has compiled in: the class of an
    argument need not come from a file that the kernel depends on.
    """
    if isinstance(kind, Packed):
        return "packed", _described(kind.group)
    if isinstance(kind, types.BaseNamedTuple):
        group = kind.instance_class
        return f"{group.__module__}.{group.__qualname__}", kind.fields, *map(_described, kind)
    if isinstance(kind, types.BaseTuple):
        return (*map(_described, kind),)
    return str(kind)


class KernelCache:
    """The cache of one function, called by its dispatcher.

    kind : distinguishes two forms of the same function
    """

    def __init__(self, function: Callable, kind: str = "") -> None:
        self._module = function.__module__
        self._name = f"{function.__module__}.{function.__qualname__}{kind}"

    @property
    def cache_path(self) -> str | None:
        """The folder that new kernels are written to."""
        return str(folders()[-1]) if folders() else None

    def load_overload(self, signature: object, target_context: Any) -> CompileResult | None:
        """Load the kernel for a signature; None if it has to be compiled."""
        # a kernel may count references, which need this; numba's own cache loads all registries of the
        # compiler here, which takes as long as the rest of a first map
        rtsys.initialize(target_context)
        key, name = self._key(signature, target_context.codegen())
        data = _find(name, key)
        library = _library(target_context.codegen(), name, key, data) if data is not None else None
        if data is not None and library is not None:
            return _compile_result(target_context, library, data)
        announce()
        return None

    def save_overload(self, signature: object, result: CompileResult) -> None:
        """Write a compiled kernel, if there is a folder for it."""
        if result.lifted or result.library.has_dynamic_globals:  # it holds addresses of this process
            return
        key, name = self._key(signature, result.codegen)
        if any(called.place is None for called in result.library.calls):  # or calls a kernel that does
            return
        _libraries[name] = result.library
        result.library.place = name, key
        if not folders():
            warn_of_place(())
            return
        folder = folders()[-1]
        forget(folder.parent)
        try:
            _write(folder / name, key, _to_store(result))
        except OSError as error:
            warn_once(
                f"cannot keep compiled kernels in {folder}: {error.strerror}; every run compiles them again"
            )
        else:
            warn_of_place(folders())

    def _key(self, signature: object, codegen: Any) -> tuple[tuple, str]:
        """Return the key of a compiled kernel, and the name of its file."""
        given, _ = sigutils.normalize_signature(signature)
        sources = versions(), digest_for(self._module)
        key = (*sources, self._name, *map(_described, given)), codegen.magic_tuple()
        return key, f"{self._name}-{hashlib.sha256(repr(key).encode()).hexdigest()[:16]}{ENDING}"

    def enable(self) -> None:
        """Do nothing: the cache is always enabled."""

    disable = enable

    def flush(self) -> None:
        """Do nothing: a kernel that is compiled again replaces its file."""
