"""Expected content of the figures of the gallery as numbers, on a coarse part of each grid.

The numbers are in `gallery/data`.  A test computes the coarse grids again; another one makes sure that the
scripts of the gallery, which stand on their own, compute what the configurations say.  After a change that is
meant to change figures,

    python docs/picture_data.py

writes the numbers again.
"""

from pathlib import Path

import numpy as np
import xarray as xr

import frictionmap as fm
from frictionmap import regimes
from frictionmap.files.config import Config
from frictionmap.pictures.classes import classes

CONFIGS = Path(__file__).resolve().parent.parent / "configs"
DATA = Path(__file__).resolve().parent / "gallery" / "data"

#: All configurations: figures of the thesis, the rig, and the map of coexistence.
FIGURES = tuple(sorted(path.stem for path in CONFIGS.glob("*.toml")))

#: Approximate number of values of r and of beta that are saved.
_KEPT = 30

#: Class of cells whose result may differ between machines: not periodic, not reached, marginal, or decided by
#: rounding; see `write`.
ANY = 255
_SETTLED = (regimes.RESOLVED, regimes.QUASI_STATIC)

#: Samples per period of a motion, and the stride of the saved ones.
_SAMPLES, _EVERY = 2000, 40

#: Numbers are saved with 24 bits; results agree to 1e-10 on any machine.
_RELATIVE, _ABSOLUTE = 1e-6, 1e-7

#: Relative change of r and beta that is far above rounding and far below the resolution of a figure.
_PUSH = 1e-13

_MAPPED = ("contact_amplitude", "also_reachable")
_BOUNDARIES = ("beta_lim", "beta_stick")
_PHASES = ("phase_lag", "first_harmonic_phase")
_DRAWN = ("amplitude", "first_harmonic_amplitude", *_PHASES)
_MOVES = ("x", "z", "friction")
_CODES = ("class", "also_reachable", "sense")
_OF_CELLS = ("class", *_MAPPED, *_DRAWN)


def compute(config: Config, r: np.ndarray, beta: np.ndarray) -> xr.Dataset:
    """Compute the result of a configuration on a grid; for a single cell, its motion."""
    if r.size * beta.size == 1:
        cell = r.item(), beta.item(), config.mu.item()
        return fm.response(config.system, *cell, solver=config.solver, points=_SAMPLES)
    if "[curves]" not in config.text:
        return fm.sweep(config.system, r, beta, config.mu, solver=config.solver)
    return fm.curves(
        config.system, r, beta, config.mu, harmonics=config.curves.harmonics,
        quantities=config.curves.quantities, solver=config.solver,
    )  # fmt: skip


def coarse(name: str) -> xr.Dataset:
    """Compute the result of `configs/NAME.toml` on the saved part of the grid."""
    config = fm.load_config(CONFIGS / f"{name}.toml")
    return compute(config, _some(config.r), _some(config.beta))


def _some(values: np.ndarray) -> np.ndarray:
    """Select about `_KEPT` values, starting half a step from the first, so that the ends are not special."""
    step = max(1, values.size // _KEPT)
    return values[step // 2 :: step]


def shown(ds: xr.Dataset) -> dict[str, np.ndarray]:
    """Numbers that a figure of a dataset shows: classes of cells, boundaries, values of curves."""
    if "tau" in ds:
        return _moving(ds)
    settled = np.ones([ds.sizes[name] for name in ("mu", "r", "beta")], dtype=bool)
    if "status" in ds:
        settled = np.isin(ds["status"].values, _SETTLED)
    found = np.stack([classes(ds.isel(mu=index)) for index in range(ds.sizes["mu"])])
    numbers = {"r": ds["r"].values, "beta": ds["beta"].values, "class": np.where(settled, found, ANY)}
    for name in _BOUNDARIES:
        numbers[name] = ds[name].values.astype(np.float32)
    for name in (*_MAPPED, *_DRAWN):
        if name in ds:
            values = ds[name].values
            numbers[name] = np.where(_spread(settled, values.ndim), values, 0).astype(np.float32)
    return numbers


def _moving(ds: xr.Dataset) -> dict[str, np.ndarray]:
    """Numbers that a figure of a motion shows, at some times."""
    some = ds.isel(tau=slice(0, None, _EVERY))
    cell = ds.expand_dims("beta").expand_dims("r").expand_dims("mu")
    numbers = {name: np.atleast_1d(ds[name].values) for name in ("r", "beta")}
    numbers["class"] = classes(cell.isel(mu=0))[np.newaxis]
    numbers["sense"] = some["direction"].values
    return numbers | {name: some[name].values.astype(np.float32) for name in _MOVES}


def _spread(cells: np.ndarray, ndim: int) -> np.ndarray:
    """Extend an array over cells to `ndim` dimensions."""
    return cells.reshape(cells.shape + (1,) * (ndim - cells.ndim))


def differences(name: str, ds: xr.Dataset) -> list[str]:
    """Compare a dataset with the saved figure of this name; one line per quantity that differs."""
    with np.load(DATA / f"{name}.npz") as known:
        kept = dict(known)
    missing = [axis for axis in ("r", "beta") if not np.isin(kept[axis], ds[axis].values).all()]
    if missing:
        return [f"its axis {axis} lacks values" for axis in missing]
    now = shown(ds if "tau" in ds else ds.sel(r=kept["r"], beta=kept["beta"]))
    if now.keys() != kept.keys():
        return [f"it has {', '.join(now)} where {', '.join(kept)} were"]
    open_to_any = (now["class"] == ANY) | (kept["class"] == ANY)
    return [text for key in kept for text in _different(key, now[key], kept[key], open_to_any)]


def _different(name: str, now: np.ndarray, kept: np.ndarray, open_to_any: np.ndarray) -> list[str]:
    if now.shape != kept.shape:
        return [f"{name} has the shape {now.shape} where it was {kept.shape}"]
    with np.errstate(invalid="ignore"):  # of infinities
        off = np.abs(now.astype(float) - kept)
    if name in _PHASES:
        off = np.minimum(off, np.abs(off - 2.0 * np.pi))
    near = off <= (0.0 if name in _CODES else _ABSOLUTE + _RELATIVE * np.abs(kept))
    same = (now == kept) | (np.isnan(now) & np.isnan(kept)) | near
    if name in _OF_CELLS:
        same |= _spread(open_to_any, same.ndim)
    if same.all():
        return []
    first = tuple(int(index) for index in np.argwhere(~same)[0])
    return [f"{name} differs in {np.count_nonzero(~same)} places, at {first} {now[first]} was {kept[first]}"]


def write(name: str) -> None:
    """Save the numbers that a figure shows now; cells that change with rounding become `ANY`.

    Their class may change, or which of several equal maxima is found first.
    """
    ds = coarse(name)
    kept = shown(ds)
    config = fm.load_config(CONFIGS / f"{name}.toml")
    for push in (1.0 - _PUSH, 1.0 + _PUSH):
        pushed = shown(compute(config, push * kept["r"], push * kept["beta"]))
        kept["class"][pushed["class"] != kept["class"]] = ANY
        for phase in set(_PHASES) & kept.keys():
            moved = np.abs(pushed[phase] - kept[phase]) > 1e-3
            kept["class"][moved.any(axis=-1)] = ANY
    DATA.mkdir(exist_ok=True)
    np.savez_compressed(DATA / f"{name}.npz", **kept)


if __name__ == "__main__":
    for figure in FIGURES:
        write(figure)
