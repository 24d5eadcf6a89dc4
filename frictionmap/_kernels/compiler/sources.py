"""The source files that decide what a kernel compiles to.

They are its own module and the modules of `_kernels` that this one imports from, directly or not: the kernels
that it calls and the constants that are compiled into it come from there.  `regimes` and the compiler count
for every kernel.  Imports are read from the text of the files: what a module holds at run time does not say
where a number came from.
"""

import functools
import hashlib
import re
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

#: `frictionmap/_kernels`, and the name of this package with a dot.
SOURCES = Path(__file__).parent.parent
_NAME = f"{__name__.rpartition('.compiler.')[0]}."

#: Dots, module and names of `from ..module import a, b`, the form in which kernels import each other.
_IMPORT = re.compile(r"^[ \t]*from[ \t]+(\.+)([\w.]*)[ \t]+import[ \t]+(\([^)]*\)|.*)", re.MULTILINE)


class _Source(NamedTuple):
    """The digest of a file, and the files of `_kernels` that it imports from."""

    digest: str
    imports: frozenset[Path]


@functools.cache
def _source(path: Path) -> _Source:
    content = path.read_bytes()
    found: set[Path] = set()
    for dots, module, names in _IMPORT.findall(content.decode(errors="replace")):
        place = path.parents[len(dots) - 1].joinpath(*filter(None, module.split(".")))
        found.update(_modules(place, names))
    imports = frozenset(file for file in found if file.is_relative_to(SOURCES))
    return _Source(hashlib.sha256(content).hexdigest(), imports)


def _modules(place: Path, names: str) -> Iterable[Path]:
    """Yield the files that names are imported from; a name in doubt may come from any of them."""
    if not place.is_dir():
        yield place.with_suffix(".py")
        return
    for name in re.findall(r"\w+", names):
        module = place / f"{name}.py"
        yield module if module.is_file() else place / "__init__.py"


def depended_on(path: Path) -> set[Path]:
    """Return the files of `_kernels` that the kernels of a file depend on, with that file itself."""
    found: set[Path] = set()
    ahead = {path}
    while ahead:
        found |= ahead
        ahead = set().union(*(_source(file).imports for file in ahead)) - found
    return found


@functools.cache
def digest_of_all() -> str:
    """Return a digest of the sources of all kernels."""
    return _digest(SOURCES.rglob("*.py"))


@functools.cache
def digest_for(module: str) -> str:
    """Return a digest of all sources that decide what the kernels of a module compile to.

    A module elsewhere may call any kernel, so that all of them count, and its own file.
    """
    if module.startswith(_NAME):
        path = SOURCES.joinpath(*module.removeprefix(_NAME).split(".")).with_suffix(".py")
        try:
            return _digest(depended_on(path))
        except OSError:  # as in an archive, whose sources count as unknown
            return digest_of_all()
    own = getattr(sys.modules.get(module), "__file__", None)
    return digest_of_all() + (_digest([Path(own)]) if own else "")


def _digest(paths: Iterable[Path]) -> str:
    """Return a digest of files and of those that count for every kernel; "" if they cannot be read."""
    files = {*paths, SOURCES.parent / "regimes.py", *(SOURCES / "compiler").glob("*.py")}
    digest = hashlib.sha256()
    try:
        for name, file in sorted((_name(file), file) for file in files):
            digest.update(f"{name} {_source(file).digest}\n".encode(errors="surrogateescape"))
    except OSError:
        return ""
    return digest.hexdigest()


def _name(file: Path) -> str:
    """Return the name of a file, the same wherever the package lies."""
    return file.relative_to(SOURCES.parent).as_posix() if file.is_relative_to(SOURCES.parent) else file.name
