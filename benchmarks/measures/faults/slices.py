"""What a user may do with a dataset of ours before writing it again."""

import random
from pathlib import Path

import xarray as xr


def _sliced(ds: xr.Dataset, rng: random.Random) -> tuple[xr.Dataset, str]:
    """One step that a user may take with a dataset of ours."""
    dim = str(rng.choice(sorted(map(str, ds.dims)))) if ds.dims else ""
    how = rng.choice(["one", "one, dropped", "some", "every second", "none", "names", "without", "turned",
    "squeezed",
                      "expanded", "stacked", "mean", "float32", "where", "reset", "attributes",
                      "backwards"])  # fmt: skip
    names = [str(name) for name in ds.data_vars]
    if how in ("one", "one, dropped") and dim:
        return ds.isel({dim: rng.randrange(ds.sizes[dim])}, drop=how != "one"), f"{how} of {dim}"
    if how == "some" and dim:
        first = rng.randrange(ds.sizes[dim])
        return ds.isel({dim: slice(first, first + rng.choice([1, 2, 5]))}), f"some of {dim}"
    if how == "every second" and dim:
        return ds.isel({dim: slice(None, None, 2)}), f"every second {dim}"
    if how == "backwards" and dim:
        return ds.isel({dim: slice(None, None, -1)}), f"{dim} backwards"
    if how == "none" and dim:
        return ds.isel({dim: slice(0, 0)}), f"none of {dim}"
    if how == "names":
        kept = rng.sample(names, rng.randrange(1, len(names) + 1))
        return ds[kept], f"only {', '.join(kept)}"
    if how == "without":
        name = rng.choice([str(name) for name in ds.variables])
        return ds.drop_vars(name), f"without {name}"
    if how == "turned" and len(ds.dims) > 1:
        order = [str(name) for name in ds.dims]
        rng.shuffle(order)
        return ds.transpose(*order), f"turned to {', '.join(order)}"
    if how == "squeezed":
        return ds.squeeze(drop=rng.random() < 0.5), "squeezed"
    if how == "expanded":
        return ds.expand_dims("more"), "expanded"
    if how == "stacked" and {"r", "beta"} <= set(ds.dims):
        return ds.stack(cell=("r", "beta")).reset_index("cell"), "stacked"
    if how == "mean" and dim:
        return ds.mean(dim, keep_attrs=rng.random() < 0.5), f"mean over {dim}"
    if how == "float32":
        return ds.astype("f4"), "float32"
    if how == "where" and "r" in ds.dims:
        return ds.where(ds["r"] > float(ds["r"].mean()), drop=rng.random() < 0.5), "where r is large"
    if how == "reset" and dim:
        return ds.drop_vars(dim, errors="ignore"), f"without the axis {dim}"
    if how == "attributes":
        ds = ds.copy()
        ds.attrs = {"source": ds.attrs.get("source", "")}
        return ds, "without attributes"
    return ds, "as it is"


def write_slice(base: Path, rng: random.Random, path: Path) -> str:
    with xr.open_dataset(base) as opened:
        whole = opened.load()
    for _ in range(100):
        ds, said = whole, []
        try:
            for _ in range(rng.choice([1, 1, 2, 3])):
                ds, step = _sliced(ds, rng)
                said.append(step)
            ds.to_netcdf(path)
        except (ValueError, TypeError, KeyError, IndexError, NotImplementedError):
            continue  # xarray itself refuses
        return "; ".join(said)
    raise RuntimeError("no slice could be written")
