"""Pictures: regime maps, boundaries, response curves, one response in time."""

from collections.abc import Callable
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING

import xarray as xr

from .datasets.labels import BOUNDARIES, HISTORY_VARIABLES, SHARES
from .errors import InputError
from .files.reading import kind
from .pictures.curves.figure import CURVE_VARIABLES, plot_curves
from .pictures.curves.harmonics import HARMONIC_VARIABLES
from .pictures.designs.figure import plot_design
from .pictures.fits.figure import plot_fit
from .pictures.maps.boundary_map import plot_boundaries
from .pictures.maps.force_map import plot_forces
from .pictures.maps.regime_map import plot_regimes
from .pictures.maps.share_map import plot_shares
from .pictures.motions.history import plot_response
from .pictures.motions.orbit import plot_orbit

if TYPE_CHECKING:
    from .pictures.panels import AxesArray

__all__ = [
    "FORMATS",
    "PICTURED",
    "check_picture",
    "plot_boundaries",
    "plot_curves",
    "plot_design",
    "plot_fit",
    "plot_forces",
    "plot_orbit",
    "plot_regimes",
    "plot_response",
    "plot_shares",
    "save_picture",
]

FORMATS = (".png", ".pdf", ".svg")

_FEATURES = ("natural_frequency", "held_frequency", "invariant_point")

_GENERAL_BOUNDARIES = ("beta_stick_contact", "beta_noslip", "no_stop_begin", "no_stop_end")

#: What pictures are made of, by the kind of file: no other variable need be read.
PICTURED = {
    "map": frozenset(
        (
            *("regime", "contact_regime", "status", "also_reachable", "period"),
            *("stops_per_cycle", "slips_per_cycle", "slip_reversals_per_cycle"),
            *(*BOUNDARIES, *_GENERAL_BOUNDARIES, *_FEATURES),
        )
    ),
    "boundaries": frozenset(("border_r", "border_beta", *BOUNDARIES, *_GENERAL_BOUNDARIES, *_FEATURES)),
    "response": frozenset(
        (
            *("regime", "contact_regime", "stops_per_cycle", "slips_per_cycle", "period", "status"),
            *(*HISTORY_VARIABLES, *HARMONIC_VARIABLES),
        )
    ),
    "curves": CURVE_VARIABLES,
    "shares": frozenset(SHARES),
}

_DPI = 160


def check_picture(path: Path) -> None:
    """Refuse a file name with an unknown suffix of pictures."""
    if path.suffix.lower() not in FORMATS:
        raise InputError(f"-o must end in {', '.join(FORMATS)}; got {path}")


def _draw(ds: xr.Dataset, quantity: str | None, log: bool) -> "AxesArray":
    """Draw a dataset of any kind; without a quantity, the first one available."""
    what = kind(ds)
    if what == "curves":
        return plot_curves(ds, quantity, log=log)
    drawn_of: dict[str, dict[str, Callable[[xr.Dataset], AxesArray]]] = {
        "map": {"regimes": plot_regimes},
        "boundaries": {"boundaries": plot_boundaries},
        "response": {"history": plot_response, "orbit": plot_orbit},
        "estimates": {"fit": plot_fit},
        "shares": {"shares": plot_shares},
        "design": {"design": plot_design},
    }
    valid = drawn_of[what]
    if log:
        raise InputError(f"cannot draw {what} with log: it applies to response curves only; omit log")
    if quantity is None:
        quantity = next(iter(valid))
    if quantity not in valid:
        raise InputError(f"unknown quantity {quantity!r} in a file of kind {what}; valid: {', '.join(valid)}")
    return valid[quantity](ds)


def save_picture(
    ds: xr.Dataset, path: Path, quantity: str | None = None, *, log: bool = False, against: str | None = None
) -> None:
    """Draw a dataset of any kind into a file; drawn first, as on a full disk matplotlib fails in odd ways.

    against : draw maps along this further axis as one, see `plot_forces`
    """
    drawn = BytesIO()
    axes = plot_forces(ds, against) if against else _draw(ds, quantity, log)
    figure = axes[0].figure
    figure.savefig(drawn, format=path.suffix[1:].lower(), dpi=_DPI)
    path.write_bytes(drawn.getbuffer())
