"""Binary packets for the page: a header in JSON, followed by arrays.

Four bytes contain the length of the header; arrays begin at multiples of eight bytes after it.  Infinities
and NaN, which JSON lacks, are sent in arrays.
"""

import json
from collections.abc import Mapping
from typing import Any

import numpy as np

_ALIGNED = 8

#: Types of arrays in JavaScript.
_TYPES = {"uint8": "Uint8Array", "int8": "Int8Array", "float32": "Float32Array", "float64": "Float64Array"}


def pack(header: Mapping[str, Any], arrays: Mapping[str, np.ndarray]) -> bytes:
    """Header and arrays as one sequence of bytes, little-endian."""
    parts: list[bytes] = []
    places: dict[str, Any] = {}
    at = 0
    for name, values in arrays.items():
        little = np.ascontiguousarray(values, dtype=values.dtype.newbyteorder("<"))
        body = little.tobytes()
        places[name] = {"type": _TYPES[values.dtype.name], "shape": list(values.shape), "at": at}
        parts.append(body + bytes(-len(body) % _ALIGNED))
        at += len(parts[-1])
    text = json.dumps({**header, "arrays": places}, ensure_ascii=False, allow_nan=False).encode()
    text += b" " * (-(len(text) + 4) % _ALIGNED)
    return b"".join((len(text).to_bytes(4, "little"), text, *parts))


def unpack(packet: bytes) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    """Unpack header and arrays of a packet as the page does, for tests and benchmarks."""
    length = int.from_bytes(packet[:4], "little")
    header = json.loads(packet[4 : 4 + length])
    numpy_types = {theirs: np.dtype(ours) for ours, theirs in _TYPES.items()}
    arrays = {}
    for name, place in header.pop("arrays").items():
        kind, shape = numpy_types[place["type"]], tuple(place["shape"])
        count = int(np.prod(shape))
        arrays[name] = np.frombuffer(packet, kind, count, 4 + length + place["at"]).reshape(shape)
    return header, arrays
