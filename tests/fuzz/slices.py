"""Operations that a user may apply to a dataset before writing it again."""

import random
from collections.abc import Callable
from pathlib import Path

import xarray as xr

from .contents import CANNOT

#: One step: the dataset, one of its dimensions, random numbers; what became of it.
Step = Callable[[xr.Dataset, str, random.Random], xr.Dataset]


def _one(ds: xr.Dataset, dim: str, rng: random.Random) -> xr.Dataset:
    return ds.isel({dim: rng.randrange(ds.sizes[dim])})


def _one_dropped(ds: xr.Dataset, dim: str, rng: random.Random) -> xr.Dataset:
    return ds.isel({dim: rng.randrange(ds.sizes[dim])}, drop=True)


def _some(ds: xr.Dataset, dim: str, rng: random.Random) -> xr.Dataset:
    first = rng.randrange(ds.sizes[dim])
    return ds.isel({dim: slice(first, first + rng.choice([1, 2, 5]))})


def _only(ds: xr.Dataset, dim: str, rng: random.Random) -> xr.Dataset:
    names = sorted(map(str, ds.data_vars))
    return ds[rng.sample(names, rng.randrange(1, len(names) + 1))]


def _without(ds: xr.Dataset, dim: str, rng: random.Random) -> xr.Dataset:
    return ds.drop_vars(rng.choice(sorted(map(str, ds.variables))))


def _turned(ds: xr.Dataset, dim: str, rng: random.Random) -> xr.Dataset:
    order = sorted(map(str, ds.dims))
    rng.shuffle(order)
    return ds.transpose(*order)


def _mean(ds: xr.Dataset, dim: str, rng: random.Random) -> xr.Dataset:
    return ds.mean(dim, keep_attrs=rng.random() < 0.5)


def _where(ds: xr.Dataset, dim: str, rng: random.Random) -> xr.Dataset:
    return ds.where(ds["r"] > float(ds["r"].mean()), drop=rng.random() < 0.5)


def _source_only(ds: xr.Dataset, dim: str, rng: random.Random) -> xr.Dataset:
    ds = ds.copy()
    ds.attrs = {"source": ds.attrs.get("source", "")}
    return ds


_STEPS: dict[str, Step] = {
    "one of it": _one,
    "one of it, dropped": _one_dropped,
    "some of it": _some,
    "every second of it": lambda ds, dim, rng: ds.isel({dim: slice(None, None, 2)}),
    "backwards": lambda ds, dim, rng: ds.isel({dim: slice(None, None, -1)}),
    "none of it": lambda ds, dim, rng: ds.isel({dim: slice(0, 0)}),
    "without its axis": lambda ds, dim, rng: ds.drop_vars(dim),
    "mean over it": _mean,
    "only some variables": _only,
    "without a variable": _without,
    "dimensions in another order": _turned,
    "squeezed": lambda ds, dim, rng: ds.squeeze(drop=rng.random() < 0.5),
    "a dimension more": lambda ds, dim, rng: ds.expand_dims("more"),
    "r and beta stacked": lambda ds, dim, rng: ds.stack(cell=("r", "beta")).reset_index("cell"),
    "float32": lambda ds, dim, rng: ds.astype("f4"),
    "where r is large": _where,
    "without attributes": _source_only,
    "as it is": lambda ds, dim, rng: ds,
}


def write_slice(base: Path, rng: random.Random, path: Path) -> str:
    """Write a dataset after one to three operations; try others if xarray cannot apply these."""
    with xr.open_dataset(base) as opened:
        whole = opened.load()
    for _ in range(100):
        ds, said = whole, []
        path.unlink(missing_ok=True)
        try:
            for _ in range(rng.choice([1, 1, 2, 3])):
                dim = rng.choice(sorted(map(str, ds.dims)))
                name = rng.choice(list(_STEPS))
                ds = _STEPS[name](ds, dim, rng)
                said.append(f"{dim}: {name}")
            ds.to_netcdf(path)
        except CANNOT:
            continue
        return "; ".join(said)
    raise RuntimeError("no slice could be written")
