"""Pictures: regime maps, boundaries, response curves, one response in time."""

import functools
import shutil
from collections.abc import Callable
from collections.abc import Set as AbstractSet
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Unpack

import xarray as xr

from .checks import nearest
from .datasets.labels import BOUNDARIES, HISTORY_VARIABLES, SHARES
from .errors import InputError
from .files.reading import kind
from .model.settings import CURVE_OUTPUTS
from .model.system import System
from .pictures.curves.figure import CURVE_VARIABLES, few_curves, plot_curves
from .pictures.curves.harmonics import HARMONIC_VARIABLES
from .pictures.designs.figure import plot_design
from .pictures.fits.figure import plot_fit
from .pictures.maps.belt_map import plot_belt
from .pictures.maps.boundary_map import plot_boundaries
from .pictures.maps.force_map import plot_forces
from .pictures.maps.quantity_map import plot_quantity, quantities_of
from .pictures.maps.regime_map import plot_regimes
from .pictures.maps.share_map import plot_shares
from .pictures.mode_shapes import plot_modes
from .pictures.motions.animation import animate
from .pictures.motions.belt_cycle import plot_belt_motion
from .pictures.motions.history import plot_response
from .pictures.motions.in_time import plot_history, plot_spectrum
from .pictures.motions.orbit import plot_orbit
from .pictures.motions.suites import plot_energies, plot_incremental
from .pictures.options import FigureOptions
from .pictures.structures import plot_structure
from .pictures.styles import settings_of, written
from .units.scales import Units

if TYPE_CHECKING:
    from .pictures.panels import AxesArray

__all__ = [
    "FORMATS",
    "PICTURED",
    "animate",
    "check_picture",
    "draw",
    "few_curves",
    "pictured",
    "plot_belt",
    "plot_belt_motion",
    "plot_boundaries",
    "plot_curves",
    "plot_design",
    "plot_energies",
    "plot_fit",
    "plot_forces",
    "plot_history",
    "plot_incremental",
    "plot_modes",
    "plot_orbit",
    "plot_quantity",
    "plot_regimes",
    "plot_response",
    "plot_shares",
    "plot_spectrum",
    "plot_structure",
    "save_picture",
    "save_structure",
]

FORMATS = (".png", ".pdf", ".svg")

#: Moving pictures, of responses only.
MOVING = (".gif", ".mp4")

_FEATURES = ("natural_frequency", "held_frequency", "invariant_point")

_BORDERS = ("border_r", "border_beta", "border_mu")

_GENERAL_BOUNDARIES = ("beta_stick_contact", "beta_noslip", "no_stop_begin", "no_stop_end")

#: What pictures are made of, by the kind of file: no other variable need be read.
PICTURED = {
    "map": frozenset(
        (
            *("regime", "contact_regime", "status", "also_reachable", "period"),
            *("stops_per_cycle", "slips_per_cycle", "slip_reversals_per_cycle"),
            *(*_BORDERS, *BOUNDARIES, *_GENERAL_BOUNDARIES, *_FEATURES),
        )
    ),
    "boundaries": frozenset((*_BORDERS, *BOUNDARIES, *CURVE_OUTPUTS, *_GENERAL_BOUNDARIES, *_FEATURES)),
    "response": frozenset(
        (
            *("regime", "contact_regime", "stops_per_cycle", "slips_per_cycle", "period", "status"),
            "separations_per_cycle",
            *(*HISTORY_VARIABLES, *HARMONIC_VARIABLES),
        )
    ),
    "curves": CURVE_VARIABLES,
    "shares": frozenset(SHARES),
}


def pictured(quantity: str | None) -> dict[str, AbstractSet[str]]:
    """Variables to read for a picture, by the kind of file; of maps also the quantity to draw."""
    if quantity is None:
        return {**PICTURED}
    return {**PICTURED, "map": PICTURED["map"] | {quantity}}


def check_picture(path: Path) -> None:
    """Refuse a file name with an unknown suffix of pictures."""
    valid = (*FORMATS, *MOVING)
    if path.suffix.lower() not in valid:
        raise InputError(f"-o must end in {', '.join(valid)}; got {path}")
    if path.suffix.lower() == ".mp4" and not shutil.which("ffmpeg"):
        raise InputError(f"cannot write {path}: ffmpeg is not installed; use .gif")


def draw(
    ds: xr.Dataset, quantity: str | None = None, *, log: bool = False, **options: Unpack[FigureOptions]
) -> "AxesArray":
    """Draw a dataset of any kind; without a quantity, the first one available."""
    what = kind(ds)
    if what == "curves":
        return plot_curves(ds, quantity, log=log, **options)
    if what == "map" and quantity in quantities_of(ds):
        return plot_quantity(ds, str(quantity), log=log, **options)
    drawn_of: dict[str, dict[str, Callable[..., AxesArray]]] = {
        "map": {"regimes": plot_regimes},
        "boundaries": {"boundaries": plot_boundaries},
        "response": {"history": plot_response, "orbit": plot_orbit},
        "estimates": {"fit": plot_fit},
        "shares": {"shares": plot_shares},
        "design": {"design": plot_design},
        "history": {"history": plot_history, "energies": plot_energies},
        "spectrum": {"spectrum": plot_spectrum, "incremental": plot_incremental},
        "belt": {"motion": plot_belt_motion} if "time" in ds.coords else {"regimes": plot_belt},
    }
    valid = drawn_of[what]
    if log:
        raise InputError(
            f"cannot draw {what} with log: it applies to response curves and quantities of maps; omit log"
        )
    if quantity is None:
        quantity = next(iter(valid))
    if quantity not in valid:
        there = [*valid, *(quantities_of(ds) if what == "map" else [])]
        hint = nearest(quantity, there)
        raise InputError(
            f"unknown quantity {quantity!r} in a file of kind {what}{hint}; valid: {', '.join(there)}"
        )
    return valid[quantity](ds, **options)


def save_picture(
    ds: xr.Dataset,
    path: Path,
    quantity: str | None = None,
    *,
    log: bool = False,
    against: str | None = None,
    style: Path | None = None,
    **options: Unpack[FigureOptions],
) -> None:
    """Draw a dataset of any kind into a file; drawn first, as on a full disk matplotlib fails in odd ways.

    Parameters
    ----------
    ds : xarray.Dataset
        Any result.
    path : Path
        File to write: .png, .pdf or .svg; .gif or .mp4 for the moving picture of a response or a history.
    quantity : str, optional
        What to draw; by default the first quantity available.
    log : bool
        Logarithmic axis of amplitudes, or scale of colours.
    against : str, optional
        Draw maps along this further axis as one, see `plot_forces`.
    style : Path, optional
        Settings of matplotlib, a file FILE.mplstyle.
    options : keyword arguments of the functions that draw
    """
    if path.suffix.lower() in MOVING:
        with settings_of(style):
            _save_moving(ds, path, quantity, options)
        return
    drawn = BytesIO()
    with settings_of(style):
        axes = plot_forces(ds, against, **options) if against else draw(ds, quantity, log=log, **options)
        written(axes[0].figure, drawn, path.suffix[1:].lower(), options.get("dpi"))
    path.write_bytes(drawn.getbuffer())


def save_structure(
    system: System,
    path: Path,
    what: str = "structure",
    *,
    style: Path | None = None,
    units: Units | None = None,
    **options: Unpack[FigureOptions],
) -> None:
    """Draw a structure, or its modes, into a file .png, .pdf or .svg; with units modes are in hertz.

    Raises
    ------
    InputError
        `what` is neither "structure" nor "modes", or an option is invalid.
    """
    drawn_by: dict[str, Callable[..., AxesArray]] = {
        "structure": plot_structure, "modes": functools.partial(plot_modes, units=units),
    }  # fmt: skip
    if what not in drawn_by:
        raise InputError(
            f"unknown quantity {what!r} of a configuration{nearest(what, drawn_by)}; "
            f"valid: {', '.join(drawn_by)}"
        )
    drawn = BytesIO()
    with settings_of(style):
        axes = drawn_by[what](system, **options)
        written(axes[0].figure, drawn, path.suffix[1:].lower(), options.get("dpi"))
    path.write_bytes(drawn.getbuffer())


def _save_moving(ds: xr.Dataset, path: Path, quantity: str | None, options: FigureOptions) -> None:
    """Write the moving picture of a response, or of a motion under a record."""
    what = kind(ds)
    if what not in ("response", "history") or quantity is not None:
        shown = f"a {what}" if quantity is None else f"{quantity!r}"
        raise InputError(
            f"cannot write {shown} as a moving picture: only responses and histories move; "
            f"use {', '.join(FORMATS)}"
        )
    moving = animate(ds, **options)
    moving.save(path, writer="pillow" if path.suffix.lower() == ".gif" else "ffmpeg", dpi=options.get("dpi"))
