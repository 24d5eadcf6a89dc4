"""Datasets in the standard form that pictures require."""

from collections.abc import Iterable

import numpy as np
import xarray as xr

from ..errors import InputError
from ..files.reading import kind, standard_form
from .options import Options, current

#: Largest value that can be drawn: axes are wider than their data, and their ends must be finite.
_LARGEST = 1e300

_MAKERS = {
    "map": "sweep returns, over mu, r and beta",
    "boundaries": "boundaries returns, over mu and r",
    "curves": "curves returns, over mu, r and beta",
    "response": "response returns, over tau",
    "estimates": "the functions of identify return, over parameter",
    "shares": "shares returns, over outcome, mu, r and beta",
    "design": "the functions of design return",
    "history": "history returns, over record, scale, mu and beta",
    "spectrum": "spectrum returns, over period",
    "belt": "sweep returns, over mu, wall_speed and beta",
}
_DRAWN_BY = {
    "map": "plot_regimes",
    "boundaries": "plot_boundaries",
    "curves": "plot_curves",
    "response": "plot_response",
    "estimates": "plot_fit",
    "shares": "plot_shares",
    "design": "plot_design",
    "history": "plot_history",
    "spectrum": "plot_spectrum",
    "belt": "plot_belt",
}

#: Options that only some functions take.
_MAPS = ("plot_regimes", "plot_quantity", "plot_boundaries")
_OPTIONS_OF = {
    "mass": ("plot_curves", "plot_response", "plot_orbit", "plot_quantity", "animate"),
    "beta": ("plot_curves",),
    "point": _MAPS,
    "box": _MAPS,
}


def to_draw(ds: object, function: str, *valid: str) -> xr.Dataset:
    """Convert a dataset to its standard form, if it is of a kind that a function draws."""
    wanted = f"ds of {function} must be a dataset such as {_MAKERS[valid[0]]}"
    if not isinstance(ds, xr.Dataset):
        raise InputError(f"{wanted}; got {type(ds).__name__}")
    found = kind(ds)
    if found not in valid:
        raise InputError(f"{wanted}; got one such as {_MAKERS[found]} (use {_DRAWN_BY[found]})")
    check_options(function)
    return _selected(standard_form(ds), current())


def check_options(function: str) -> None:
    """Refuse options that do not apply to what a function draws."""
    for name, valid in _OPTIONS_OF.items():
        if getattr(current(), name) and function not in valid:
            raise InputError(
                f"cannot use {name} with {function}: it applies to {', '.join(valid)}; omit {name}"
            )


def _selected(ds: xr.Dataset, options: Options) -> xr.Dataset:
    """The masses and friction ratios that the options ask for."""
    if options.mass and "dof" in ds.dims:
        there = ds["dof"].values.tolist()
        for number in options.mass:
            if number not in there:
                raise InputError(f"mass must be one of {', '.join(map(str, there))}; got {number}")
        ds = ds.sel(dof=sorted(set(options.mass)))
    elif options.mass:
        raise InputError("cannot choose a mass: the dataset has no values of each mass; omit mass")
    if options.beta:
        there = ds["beta"].values
        ds = ds.isel(beta=sorted({int(np.argmin(np.abs(there - beta))) for beta in options.beta}))
    return ds


def check_holds(ds: xr.Dataset, names: Iterable[str], what: str) -> None:
    """Refuse a dataset without a variable that a picture requires."""
    for name in names:
        if name not in ds:
            raise InputError(f"a dataset must hold {name} for {what} to be drawn; got no such variable")


def check_range(ds: xr.Dataset, names: Iterable[str]) -> None:
    """Refuse variables beyond the range of an axis."""
    for name in names:
        largest = float(np.abs(ds[name].values).max(initial=0.0))
        if largest > _LARGEST:
            raise InputError(f"{name} must be at most {_LARGEST:g} to be drawn; got {largest:g}")


def panels_of(ds: xr.Dataset) -> list[xr.Dataset]:
    """A dataset for each mu."""
    return [ds.isel(mu=m) for m in range(ds.sizes["mu"])]
