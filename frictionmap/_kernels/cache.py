"""Compiled kernels kept on disk, so that each is compiled once on a machine.

numba's own cache believes what it finds, wants a folder that can be written to, and does not see that a
kernel has changed that another one calls.  Here every file carries a digest of itself and what it is of;
anything else counts as missing.  Where no folder can be written to, every run compiles.
"""

import contextlib
import functools
import hashlib
import logging
import os
import pickle
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

from numba.core import sigutils
from numba.core.compiler import CompileResult, compile_result
from numba.core.runtime.nrt import rtsys
from numba.core.serialize import dumps

from .cache_folders import ENDING, UNDER_WAY, folders, places, state
from .linking import Code, KernelLibrary, stored

_DIGEST = 32

_log = logging.getLogger("frictionmap")

#: Called before a kernel is compiled.
listeners: list[Callable[[], None]] = []


class _Damaged(Exception):
    """A file of the cache is not what it should be."""


class _Stored(NamedTuple):
    """A compiled kernel, as it is stored."""

    library: Code
    calls: list[tuple[tuple[str, tuple], int]]  # places and numbers of the libraries that it calls
    descriptor: Any  # of numba, and so the others
    environment: Any
    signature: Any
    annotation: str
    environments: tuple


#: The code of kernels in this process, by the names of their files.
_libraries: dict[str, KernelLibrary] = {}


@functools.cache
def _say(text: str) -> None:
    """Say it once, on standard error where nothing else is arranged for."""
    _log.warning("frictionmap: %s", text)


def _read(path: Path, key: tuple) -> Any:
    """What was stored under the key; None if nothing was."""
    if not os.path.isfile(path):
        if os.path.lexists(path):
            raise _Damaged
        return None
    try:
        content = path.read_bytes()
        if hashlib.sha256(content[_DIGEST:]).digest() != content[:_DIGEST]:
            raise _Damaged
        found, data = pickle.loads(content[_DIGEST:])
    except Exception:  # whatever it is that cannot be read
        raise _Damaged from None
    if found != key:
        raise _Damaged
    return data


def _write(path: Path, key: tuple, data: object) -> None:
    body = dumps((key, data))
    if path.is_dir():
        path.rmdir()
    handle, name = tempfile.mkstemp(prefix=UNDER_WAY, dir=path.parent)
    try:
        with open(handle, "wb") as file:
            file.write(hashlib.sha256(body).digest() + body)
        os.chmod(name, 0o644)  # where others may enter the folder, they may use what is in it
        os.replace(name, path)
    except BaseException:
        with contextlib.suppress(OSError):
            os.unlink(name)
        raise


def _find(name: str, key: tuple) -> Any:
    """What is stored in a file of any folder under the key; None if nothing that can be used is."""
    damaged = None
    for folder in folders():
        try:
            data = _read(folder / name, key)
        except _Damaged:
            damaged = folder
            continue
        if data is not None:
            return data
    if damaged is not None:
        _say(f"the compiled kernels in {damaged} are damaged and compiled anew")
    return None


def _to_store(result: CompileResult) -> _Stored:
    """What makes a kernel again."""
    library, descriptor, environment, signature, _, _, annotation, _, environments = result._reduce()
    calls = [(called.place, called.number) for called in result.library.calls]
    return _Stored(library, calls, descriptor, environment, signature, annotation, environments)


def _library(codegen: Any, name: str, key: tuple, data: _Stored | None = None) -> KernelLibrary | None:
    """The code of a stored kernel, loaded with all that it calls; None if any of it is missing."""
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
        _libraries[name] = stored(codegen, data.library, calls)
        _libraries[name].place = name, key
    return _libraries[name]


def _compile_result(target_context: Any, library: KernelLibrary, data: _Stored) -> CompileResult:
    """What the compiler gave, as `CompileResult._rebuild` of numba makes it."""
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


class KernelCache:
    """What a dispatcher of numba asks its cache for."""

    def __init__(self, function: Callable, kind: str = "") -> None:
        self._name = f"{function.__module__}.{function.__qualname__}{kind}"

    @property
    def cache_path(self) -> str | None:
        """The folder that kernels are kept in."""
        return str(folders()[-1]) if folders() else None

    def load_overload(self, signature: object, target_context: Any) -> CompileResult | None:
        """The compiled kernel for a signature, or None: then it is compiled."""
        # a kernel that is loaded may count references; numba's own cache has all registries of the compiler
        # loaded here, which take as long as all the rest of a first map
        rtsys.initialize(target_context)
        key, name = self._key(signature, target_context.codegen())
        data = _find(name, key)
        library = _library(target_context.codegen(), name, key, data) if data is not None else None
        if data is not None and library is not None:
            return _compile_result(target_context, library, data)
        for listener in listeners:
            listener()
        return None

    def save_overload(self, signature: object, result: CompileResult) -> None:
        """Keep a compiled kernel, if there is a place for it."""
        if result.lifted or result.library.has_dynamic_globals:  # what lives in this process only
            return
        key, name = self._key(signature, result.codegen)
        if any(called.place is None for called in result.library.calls):  # or calls what does
            return
        _libraries[name] = result.library
        result.library.place = name, key
        if not folders():
            where = ", ".join(map(str, places()))
            _say(f"none of {where} can be written to: every run compiles the kernels anew")
            return
        folder = folders()[-1]
        try:
            _write(folder / name, key, _to_store(result))
        except OSError as error:
            _say(f"compiled kernels cannot be kept in {folder} ({error.strerror}): every run compiles anew")
        else:
            if folder.parent != places()[0]:
                _say(f"{places()[0]} cannot be written to: compiled kernels are kept in {folder.parent}")

    def _key(self, signature: object, codegen: Any) -> tuple[tuple, str]:
        """What a file is of, and its name."""
        types, _ = sigutils.normalize_signature(signature)
        key = (state(), self._name, str(types), codegen.magic_tuple())
        return key, f"{self._name}-{hashlib.sha256(repr(key).encode()).hexdigest()[:16]}{ENDING}"

    def enable(self) -> None:
        """It always is."""

    disable = enable

    def flush(self) -> None:
        """A kernel that is compiled again takes the place of the one before."""
