"""Pictures: regime maps, boundaries, one response in time."""

from collections.abc import Callable
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING

import xarray as xr

from .datasets.labels import HISTORY_VARIABLES
from .errors import InputError
from .files.reading import kind
from .pictures.boundary_map import plot_boundaries
from .pictures.history import plot_response
from .pictures.regime_map import plot_regimes

if TYPE_CHECKING:
    from .pictures.panels import AxesArray

__all__ = [
    "FORMATS",
    "PICTURED",
    "check_picture",
    "plot_boundaries",
    "plot_regimes",
    "plot_response",
    "save_picture",
]

FORMATS = (".png", ".pdf", ".svg")

#: What pictures are made of: no other variable need be read.
PICTURED = frozenset(
    (
        *("regime", "stops_per_cycle", "also_reachable", "period"),
        *("beta_lim", "beta_lim_modal", "beta_stick"),
        *("natural_frequency", "held_frequency", "invariant_point"),
        *HISTORY_VARIABLES,
    )
)

_DPI = 160


def check_picture(path: Path) -> None:
    """Refuse a name whose ending is not that of a picture."""
    if path.suffix.lower() not in FORMATS:
        raise InputError(f"-o must end in {', '.join(FORMATS)}; got {path}")


def save_picture(ds: xr.Dataset, path: Path) -> None:
    """Draw a dataset of any kind into a file; drawn first, as on a full disk matplotlib fails in odd ways."""
    draw: dict[str, Callable[[xr.Dataset], AxesArray]] = {
        "map": plot_regimes,
        "boundaries": plot_boundaries,
        "response": plot_response,
    }
    drawn = BytesIO()
    draw[kind(ds)](ds)[0].figure.savefig(drawn, format=path.suffix[1:].lower(), dpi=_DPI)
    path.write_bytes(drawn.getbuffer())
