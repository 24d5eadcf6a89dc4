"""Damage to a cache of kernels: to its files, one by one or exchanged, and to its folders."""

import pickle
import random
import shutil
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

#: Does something to some files, or folders.
Act = Callable[[list[Path], random.Random], None]


def _each(what: Callable[[Path, random.Random], object]) -> Act:
    def act(files: list[Path], rng: random.Random) -> None:
        for path in files:
            what(path, rng)

    return act


def _cut(path: Path, rng: random.Random) -> None:
    content = path.read_bytes()
    path.write_bytes(content[: rng.randrange(1, len(content))])


def _empty(path: Path, rng: random.Random) -> None:
    path.write_bytes(b"")


def _garbage(path: Path, rng: random.Random) -> None:
    path.write_bytes(rng.randbytes(path.stat().st_size))


def _zeros(path: Path, rng: random.Random) -> None:
    path.write_bytes(bytes(path.stat().st_size))


def _wrong_pickle(path: Path, rng: random.Random) -> None:
    path.write_bytes(pickle.dumps(rng.choice([None, [1, 2], {"a": 1}, "text", 1.5])))


class _Elsewhere:
    """Pickles as a name in a module that does not exist."""

    def __reduce__(self) -> tuple:
        return (_nowhere, ())


def _nowhere() -> None:
    """Stands for a name that the reader does not have."""


def _lost_module(path: Path, rng: random.Random) -> None:
    path.write_bytes(pickle.dumps(_Elsewhere()).replace(b"faults.damages", b"faults.nowhere"))


def _folder(path: Path, rng: random.Random) -> None:
    path.unlink()
    path.mkdir()


def _unreadable(path: Path, rng: random.Random) -> None:
    path.chmod(0)


def _gone(path: Path, rng: random.Random) -> None:
    path.unlink()


def _flipped(path: Path, rng: random.Random) -> None:
    content = bytearray(path.read_bytes())
    for _ in range(8):
        content[rng.randrange(len(content))] ^= 0xFF
    path.write_bytes(content)


def _swapped(files: list[Path], rng: random.Random) -> None:
    contents = [path.read_bytes() for path in files]
    for path, content in zip(files, contents[1:] + contents[:1], strict=True):
        path.write_bytes(content)


def _file_for_folder(path: Path, rng: random.Random) -> None:
    shutil.rmtree(path)
    path.write_bytes(b"")


def _emptied(path: Path, rng: random.Random) -> None:
    shutil.rmtree(path)
    path.mkdir()


def _dead_link(path: Path, rng: random.Random) -> None:
    shutil.rmtree(path)
    path.symlink_to("nowhere")


def _sealed(path: Path, rng: random.Random) -> None:
    path.chmod(0)


_OF_FILES: dict[str, Act] = {
    "cut off": _each(_cut),
    "empty": _each(_empty),
    "garbage": _each(_garbage),
    "zeros": _each(_zeros),
    "another pickle": _each(_wrong_pickle),
    "a pickle of a lost module": _each(_lost_module),
    "a folder in its place": _each(_folder),
    "not readable": _each(_unreadable),
    "gone": _each(_gone),
    "bytes flipped": _each(_flipped),
    "swapped": _swapped,
}
_OF_FOLDERS: dict[str, Act] = {
    "a file in its place": _each(_file_for_folder),
    "emptied": _each(_emptied),
    "a link to nowhere": _each(_dead_link),
    "neither readable nor writable": _each(_sealed),
}


@dataclass(frozen=True)
class Damage:
    """An action on the files with one ending, or on the folders that contain any."""

    name: str
    ending: str  # "" for folders
    act: Act

    def of(self, cache: list[Path]) -> list[Path]:
        """Select the files of a cache that are damaged."""
        if not self.ending:
            return sorted({path.parent for path in cache})
        return [path for path in cache if path.suffix == self.ending]


#: numba keeps an index and the compiled data; a package may have its own files instead.
DAMAGES = tuple(
    Damage(f"{words}: {how}", ending, act)
    for ending, words, acts in (
        (".nbi", "index", _OF_FILES),
        (".nbc", "data", _OF_FILES),
        ("", "folder", _OF_FOLDERS),
    )
    for how, act in acts.items()
)
