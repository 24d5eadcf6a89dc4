"""Stores on disk: creation, identification, removal of leftovers; writing and marking of blocks."""

import contextlib
import glob
import hashlib
import secrets
import shutil
import threading
from collections.abc import Iterable, Iterator, Mapping
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from .. import checks
from .._kernels.compiler.notices import warn_once
from ..datasets.labels import REFERENCES
from ..errors import InputError
from ..files.checksums import RECORD, changed_description, chunk_is_damaged, chunks_of, record_of
from ..files.config import parse
from ..version import __version__, state
from .contents import Batch, Contents, Cut, with_cut
from .kinds import contents_of
from .layout import MARKS, Array, arrays_of, chunk, plain, region

if TYPE_CHECKING:
    import zarr

#: Names of files that are being written.
_PARTIAL = "*.partial"

_SOURCE = f"frictionmap {__version__}"

#: Held while a setting of zarr is changed.
_settings = threading.Lock()


def _zarr() -> Any:
    try:
        import zarr
    except ImportError:
        raise InputError(
            "cannot use a .zarr store: zarr is not installed; run pip install 'frictionmap[zarr]'"
        ) from None
    return zarr


class Store:
    """A store and its contents: a study of maps, or spectra."""

    def __init__(self, path: Path, study: Contents) -> None:
        self.path = path
        self.study = study

    @cached_property
    def _group(self) -> "zarr.Group":
        return _zarr().open_group(self.path, mode="r+", use_consolidated=False)

    @property
    def digest(self) -> str:
        """Hash of description and data, by which stores are distinguished."""
        content = [array.tobytes() for _, array in self.study.arrays()] if self.study.hashes_data else []
        text = str(self._group.attrs[self.study.described_in])
        return hashlib.sha256(b"".join([text.encode(), *content])).hexdigest()

    def marks(self) -> np.ndarray:
        """Blocks marked as done, bool of `study.shape`.

        Raises
        ------
        InputError
            An array of the store is missing or damaged.
        """
        name = MARKS
        try:
            for name in self._arrays:
                _ = self._group[name]
            return np.asarray(self._group[MARKS][...]) != 0
        except OSError:
            raise
        except Exception as error:  # the library raises any exception on foreign files
            raise _damaged(self.path, name, error) from None

    def done(self) -> np.ndarray:
        """Blocks marked as done whose chunks all exist and are not damaged; their files are read once."""
        for file in chunks_of(self.path / MARKS):
            if chunk_is_damaged(file):
                warn_once(f"{file} is damaged; its blocks are computed again")
                file.unlink()
        done = self.marks()
        for batch in self.study.batches():
            done[batch.places] &= not done[batch.places].any() or self._is_whole(batch)
        return done

    def _is_whole(self, batch: Batch) -> bool:
        """Whether all chunks of a batch exist, with their checksums; warns of those that are damaged."""
        for name, array in self._arrays.items():
            place = chunk(region(self.study, batch, array), array)
            file = self.path / name / self._writable[name].metadata.encode_chunk_key(place)
            if not file.exists():
                return False
            if chunk_is_damaged(file):
                warn_once(f"{file} is damaged; its block is computed again")
                return False
        return True

    def mend_axes(self) -> None:
        """Write the axes again whose chunks are damaged or missing."""
        for name, variable in self.study.coordinates().items():
            key = self._group[name].metadata.encode_chunk_key((0,) * variable.ndim)
            file = self.path / name / key
            damaged = file.exists() and chunk_is_damaged(file)
            if damaged or not np.array_equal(self._group[name][...], variable.values):
                warn_once(f"{file} is damaged; it is written again")
                self._group[name][...] = np.asarray(variable.values)

    def write(self, batch: Batch, found: Mapping[str, np.ndarray]) -> None:
        """Write a batch, whole chunks only, and then its marks."""
        for name, array in self._arrays.items():
            if name != MARKS:
                self._writable[name][region(self.study, batch, array)] = found[name]
        self._writable[MARKS][batch.places] = 1

    @cached_property
    def _writable(self) -> dict[str, "zarr.Array"]:
        """The arrays; chunks of nothing but the fill value are written like others: none is missing."""
        with _settings, _zarr().config.set({"array.write_empty_chunks": True}):
            return {name: self._group[name] for name in self._arrays}

    @cached_property
    def _arrays(self) -> dict[str, Array]:
        return arrays_of(self.study)


def make_store(path: Path, contents: Contents, title: str) -> None:
    """Make a store without any block; it appears in one step.

    An existing store is set aside in one step as well, to be removed.

    Raises
    ------
    OSError
        It cannot be written.
    """
    away = _away(path)
    try:
        attributes = {
            "Conventions": "CF-1.11", "title": title, "source": _SOURCE, "references": REFERENCES,
            "state": state(), "contents": contents.kind, contents.described_in: contents.description(title),
            **contents.attributes(),
        }  # fmt: skip
        group = _zarr().create_group(away, attributes=attributes)
        for name, array in arrays_of(contents).items():
            _make_array(group, name, array)
        for name, variable in contents.coordinates().items():
            _put_array(group, name, np.asarray(variable.values), variable.dims, plain(variable.attrs))
        for name, values in contents.arrays():
            _put_array(group, name, values, ("row", "column")[: values.ndim], {})
        group.attrs[RECORD] = record_of(away, attributes)
        if path.exists():
            path.rename(_away(path))
        away.rename(path)
    except OSError as error:
        raise OSError(
            f"cannot write {path}: {error.strerror or error}; check disk space and permissions"
        ) from error
    finally:
        shutil.rmtree(away, ignore_errors=True)


def _put_array(
    group: "zarr.Group", name: str, values: np.ndarray, dims: Iterable[object], attributes: Mapping[str, Any]
) -> None:
    """Write an array as one chunk."""
    fill = values.dtype.type(0)
    like = Array(tuple(map(str, dims)), values.shape, values.shape, values.dtype, fill, attributes)
    _make_array(group, name, like)[...] = values


def _make_array(group: "zarr.Group", name: str, array: Array) -> "zarr.Array":
    from zarr.codecs import BloscCodec, Crc32cCodec

    blosc = BloscCodec(cname="lz4", clevel=5, shuffle="shuffle", typesize=array.dtype.itemsize)
    return group.create_array(
        name, shape=array.shape, chunks=array.chunks, dtype=array.dtype, fill_value=array.fill,
        compressors=(blosc, Crc32cCodec()), dimension_names=array.dims, attributes=dict(array.attributes),
    )  # fmt: skip


def opened(path: Path) -> Store:
    """The store at a path, with its contents.

    Raises
    ------
    InputError
        There is no store of this version.
    """
    kind, text, arrays = _stored(path)
    return Store(path, with_cut(kind.stored(text, arrays), cut_of(path)))


def cut_of(path: Path) -> Cut:
    """Read the division of a store into blocks from the chunks of its arrays.

    Raises
    ------
    InputError
        A required array is missing or damaged.
    """
    name = MARKS
    try:
        group = _zarr().open_group(path, mode="r", use_consolidated=False)
        together = group[name].chunks
        name = "status"  # which every store has, the rows as its last axis but one
        return Cut(group[name].chunks[-2], together)
    except OSError:
        raise
    except Exception as error:  # the library raises any exception on foreign files
        raise _damaged(path, name, error) from None


def _damaged(path: Path, name: str, error: Exception) -> InputError:
    return InputError(
        f"cannot resume {path}: array {name!r} is damaged ({checks.one_line(error)}); "
        "use --overwrite or another -o"
    )


class _Arrays(Mapping[str, np.ndarray]):
    """Data of a store beside its variables, read when used."""

    def __init__(self, path: Path, found: Mapping[str, "zarr.Array"]) -> None:
        self._path, self._found = path, found

    def __getitem__(self, name: str) -> np.ndarray:
        try:
            return np.asarray(self._found[name][...])
        except ValueError as error:
            raise _damaged(self._path, name, error) from None

    def __iter__(self) -> Iterator[str]:
        return iter(self._found)

    def __len__(self) -> int:
        return len(self._found)


def _stored(path: Path) -> tuple[type[Contents], str, Mapping[str, np.ndarray]]:
    """Kind of the contents of a store, their description, and data beside it.

    Other folders are refused, and stores of another state of the program.
    """
    zarr = _zarr()
    source: object = "something else"
    try:
        group = zarr.open_group(path, mode="r", use_consolidated=False)
        source = group.attrs.get("source", source)
        if source == _SOURCE:
            _check_described(path, group.attrs)
            kind = contents_of(str(group.attrs["contents"]))
            found = {f"{name}/{key}": one for name, part in group.groups() for key, one in part.arrays()}
            return kind, str(group.attrs[kind.described_in]), _Arrays(path, found)
    except InputError:
        raise
    except PermissionError as error:
        raise InputError(
            f"cannot resume {path}: {error.filename} is read-protected; make it readable or use another -o"
        ) from None
    except Exception:  # any exception of the library on foreign files
        pass
    raise InputError(
        f"cannot resume {path}: written by {source}, this is {_SOURCE}; use --overwrite or another -o"
    )


def _check_described(path: Path, attributes: Mapping[str, Any]) -> None:
    """Refuse a store that another state of the program has begun, or whose description is damaged."""
    changed = changed_description(path, attributes)
    if changed is not None:
        raise InputError(f"cannot resume {path}: {changed} is damaged; use --overwrite or another -o")
    there = attributes.get("state", "unknown")
    if there != state():
        raise InputError(
            f"cannot resume {path}: it was begun by another state of {_SOURCE} ({there}, this is {state()}), "
            "whose cells may differ; use --overwrite or another -o"
        )


def check_same(path: Path, contents: Contents, title: str) -> None:
    """Refuse a store of something else; the message names the differing keys."""
    kind, text, arrays = _stored(path)
    if kind is not type(contents):
        raise InputError(f"cannot resume {path}: it holds a {kind.kind}; use --overwrite or another -o")
    there, here = _flat(parse(text)), _flat(parse(contents.description(title)))
    there.pop("title", None)
    here.pop("title", None)
    differing = [key for key in {**there, **here} if there.get(key) != here.get(key)]
    if not differing and (data := contents.differing_data(arrays)):
        differing = [data]
    if differing:
        words = "; ".join(
            f"{key}: {checks.one_line(there.get(key))} there, {checks.one_line(here.get(key))} now"
            for key in differing[:3]
        )
        raise InputError(
            f"cannot resume {path}: its configuration differs, {words}; use --overwrite or another -o"
        )


def _flat(tree: Mapping[str, Any], prefix: str = "") -> dict[str, Any]:
    """Flatten nested tables to dotted keys."""
    flat: dict[str, Any] = {}
    for key, value in tree.items():
        flat |= _flat(value, f"{prefix}{key}.") if isinstance(value, Mapping) else {f"{prefix}{key}": value}
    return flat


def _being_made(path: Path) -> str:
    """Prefix of the names of a store that is being made, or was replaced."""
    return f".{path.name}-"


def _away(path: Path) -> Path:
    """A name for a store that is being made, or put away."""
    return path.with_name(_being_made(path) + secrets.token_hex(8))


def remove_strays(path: Path) -> None:
    """Remove leftovers of stopped runs; no other run may be writing the store."""
    for folder in path.parent.glob(glob.escape(_being_made(path)) + 16 * "[0-9a-f]"):
        shutil.rmtree(folder, ignore_errors=True)
    for stray in path.rglob(_PARTIAL):
        with contextlib.suppress(OSError):
            stray.unlink()
