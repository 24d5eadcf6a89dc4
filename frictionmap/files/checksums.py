"""Checksums of stores: every chunk has one, and a record has those of the files that describe the arrays.

The chunks have the checksum of the codec crc32c behind their bytes, so that any program that reads them
detects a flipped bit.  The files `zarr.json` have none; an attribute of the store lists theirs.
"""

import json
import zlib
from collections.abc import Iterator, Mapping
from importlib import import_module
from pathlib import Path
from typing import Any

#: The attribute with the record, and the file that describes a group or an array.
RECORD = "checksums"
_DESCRIPTION = "zarr.json"

#: The codec, and the bytes of its checksum.
CODEC = "crc32c"
_BYTES = 4


def _crc32c(content: bytes) -> int:
    """Checksum by the package that zarr itself uses, which depends on its version."""
    try:
        return int(import_module("google_crc32c").value(content))
    except ImportError:
        return int(import_module("crc32c").crc32c(content))


def chunk_is_damaged(file: Path) -> bool:
    """Whether the bytes of a chunk differ from those that were written."""
    content = file.read_bytes()
    if len(content) < _BYTES:
        return True
    return _crc32c(content[:-_BYTES]) != int.from_bytes(content[-_BYTES:], "little")


def _descriptions(store: Path) -> Iterator[Path]:
    """The files that describe the arrays of a store and of the groups in it."""
    return (path for path in sorted(store.rglob(_DESCRIPTION)) if path.parent != store)


def record_of(store: Path, attributes: Mapping[str, Any]) -> str:
    """The record of a store that has these attributes: checksums of each, and of the descriptions in it.

    The checksum of the record itself stands before it.
    """
    record = {
        "attributes": {name: _attribute_checksum(value) for name, value in attributes.items()},
        "files": {
            path.relative_to(store).as_posix(): _crc32(path.read_bytes()) for path in _descriptions(store)
        },
    }
    text = json.dumps(record)
    return f"{_crc32(text.encode())} {text}"


def _crc32(content: bytes) -> str:
    return f"{zlib.crc32(content):08x}"


def attributes_of(store: Path) -> dict[str, Any]:
    """The attributes of a store; none where the file with them cannot be read."""
    try:
        found = json.loads((store / _DESCRIPTION).read_text(encoding="utf-8"))
        return dict(found["attributes"])
    except (OSError, ValueError, KeyError, TypeError):
        return {}


def _attribute_checksum(value: object) -> str:
    """Checksum of an attribute."""
    return _crc32(json.dumps(value, sort_keys=True).encode())


def changed_description(store: Path, attributes: Mapping[str, Any]) -> Path | None:
    """The first file of a store that differs from its record; None where all agree, or without a record.

    Attributes that were added to the store do not count.
    """
    if RECORD not in attributes:
        return None
    own, _, text = str(attributes[RECORD]).partition(" ")
    if own != _crc32(text.encode()):
        return store / _DESCRIPTION
    record = json.loads(text)
    for name, found in record["attributes"].items():
        if name not in attributes or _attribute_checksum(attributes[name]) != found:
            return store / _DESCRIPTION
    for name, found in record["files"].items():
        file = store / name
        if not file.is_file() or _crc32(file.read_bytes()) != found:
            return file
    return None


def damaged_chunk(store: Path) -> Path | None:
    """The first chunk of a store that is damaged; None if there is none, or chunks have no checksums."""
    for description in _descriptions(store):
        if CODEC in description.read_text(encoding="utf-8", errors="replace"):
            for file in chunks_of(description.parent):
                if chunk_is_damaged(file):
                    return file
    return None


def chunks_of(array: Path) -> list[Path]:
    """The files of the chunks of an array, without those that were being written."""
    found = (array / "c").rglob("*") if (array / "c").is_dir() else array.glob("c")
    return sorted(path for path in found if path.is_file() and path.suffix != ".partial")
