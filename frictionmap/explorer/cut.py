"""A line through a view, along r or beta, as response curves."""

from collections.abc import Callable
from typing import Any, Literal

import numpy as np

from ..model.settings import Quantity
from ..pictures.classes import of_cells
from .views import View, middles

Along = Literal["r", "beta"]

#: Cells that are computed between two looks at whether anybody waits.
_AT_ONCE = 96

_QUANTITIES: tuple[Quantity, ...] = ("amplitude", "first_harmonic", "energy")


def cut(
    view: View, along: Along, at: float, count: int, watch: Callable[[], None]
) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    """Response curves along r at one beta, or along beta at one r.

    Arrays over the cut: `classes`; `contact_amplitude`, `work_friction`, `contact_phase` (of the first
    harmonic); `amplitude` (masses, cells).  Along r also `held` (masses, cells), with the contact held, and
    `limit`, those at beta_lim.
    """
    view.check(None if along == "r" else at)
    place = middles(getattr(view, along), count, "count")
    pieces: list[dict[str, np.ndarray]] = []
    for first in range(0, count, _AT_ONCE):
        watch()
        pieces.append(_piece(view, along, at, place[first : first + _AT_ONCE]))
    joined = {name: np.concatenate([piece[name] for piece in pieces], axis=-1) for name in pieces[0]}
    header = {"along": along, "at": at, "ends": getattr(view, along), "dofs": view.system.dofs.numbers}
    return header, joined


def _piece(view: View, along: Along, at: float, places: np.ndarray) -> dict[str, np.ndarray]:
    from ..steady.curves import curves  # with xarray, which a page can do without until a line is drawn

    r, beta = (places, at) if along == "r" else (at, places)
    ds = curves(view.system, r, beta, view.mu, solver=view.solver, quantities=_QUANTITIES)
    flat = ds.isel({"mu": 0, "beta" if along == "r" else "r": 0})
    names = {
        "contact_amplitude": "contact_amplitude",
        "contact_phase": "contact_first_harmonic_phase",
        "work_friction": "work_friction",
        "amplitude": "amplitude",
    }
    if along == "r":
        names |= {"held": "held_response", "limit": "limit_amplitude"}
    found = {ours: flat[name].values.T.astype(np.float32) for ours, name in names.items()}
    return {"classes": of_cells(flat["regime"].values, flat["stops_per_cycle"].values), **found}
