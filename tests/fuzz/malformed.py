"""Malformed files, made from valid ones in the child: other structure or values, damaged bytes, slices."""

import random
from pathlib import Path

import numpy as np
import xarray as xr

from . import other_structure, other_values
from .contents import CANNOT, Content, Mutation
from .slices import write_slice

STRUCTURE, VALUES, BYTES, SLICES = "other structure", "other values", "damaged bytes", "slices"


def _changed(base: Path, mutations: tuple[Mutation, ...], rng: random.Random, path: Path) -> str:
    """Write the file with one to three changes; try others if the library cannot write these."""
    for _ in range(200):
        content = Content.of(base)
        kind = rng.choice(["NETCDF4"] * 9 + ["NETCDF3_64BIT_OFFSET"])
        path.unlink(missing_ok=True)  # what a failure left may still be open in the library
        try:
            said = [rng.choice(mutations)(content, rng) for _ in range(rng.choice([1, 1, 2, 3]))]
            content.write(path, kind)
        except CANNOT:
            continue  # no file that could be met: nothing can write it
        return "; ".join([*said, *([kind] if kind != "NETCDF4" else [])])
    raise RuntimeError("no malformed file could be written")


def _damaged(content: bytearray, rng: random.Random) -> str:
    size = len(content)
    at, length = rng.randrange(size), rng.choice([1, 8, 64, 512])
    how = rng.choice(["bit", "bit", "bit", "bytes", "zeros", "noise", "cut", "removed", "doubled", "added"])
    if how == "bit":
        content[at] ^= 1 << rng.randrange(8)
    elif how == "bytes":
        for _ in range(length):
            content[rng.randrange(size)] = rng.randrange(256)
    elif how in ("zeros", "noise"):
        content[at : at + length] = bytes(
            rng.randrange(256) if how == "noise" else 0 for _ in content[at : at + length]
        )
    elif how == "cut":
        del content[at:]
    elif how == "removed":
        del content[at : at + length]
    elif how == "doubled":
        content[at:at] = content[at : at + length]
    else:
        content += bytes(length)
    return f"{how} at {at}, {length}"


def differs(base: Path, path: Path) -> bool:
    """Whether a number in a file differs from the file it was made from."""
    try:
        with xr.open_dataset(base, decode_cf=False) as good, xr.open_dataset(path, decode_cf=False) as bad:
            return any(
                name in bad.variables
                and not np.array_equal(v.values, bad[name].values, equal_nan=v.dtype.kind == "f")
                for name, v in good.variables.items()
                if v.dtype.kind in "iuf"
            )
    except Exception:  # an unreadable file shows no wrong values
        return False


def make(base: Path, family: str, seed: int, path: Path) -> str:
    """Write one malformed file; return a description."""
    rng = random.Random(f"{family} {base.name} {seed}")
    path.unlink(missing_ok=True)
    if family == SLICES:
        return f"{base.name}: {write_slice(base, rng, path)}"
    if family == BYTES:
        content = bytearray(base.read_bytes())
        said = [_damaged(content, rng) for _ in range(rng.choice([1, 1, 1, 3, 10])) if content]
        path.write_bytes(content)
        return f"{base.name}: {'; '.join(said)}"
    mutations = other_structure.STRUCTURE if family == STRUCTURE else other_values.VALUES
    return f"{base.name}: {_changed(base, mutations, rng, path)}"
