"""Response curves through a view, along r or beta."""

from typing import Any, Literal

import numpy as np

from ..model.settings import Quantity, curve_settings
from ..pictures.classes import of_cells
from .views import Follower, View, middles

Along = Literal["r", "beta"]

#: Cells computed at once: a request cannot be cancelled while their boundaries are determined.
_AT_ONCE = 96

_QUANTITIES: tuple[Quantity, ...] = ("amplitude", "first_harmonic", "energy")


def cut(
    view: View, along: Along, at: float, count: int, follower: Follower
) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    """Response curves along r at one beta, or along beta at one r.

    Arrays over the cut: `classes`; `contact_amplitude`, `work_friction`, `contact_phase` (of the first
    harmonic); `amplitude` (masses, cells).  Along r also `held` (masses, cells), with the contact held, and
    `limit`, those at beta_lim.
    """
    view.check(None if along == "r" else at)
    if view.system.general is not None:
        from .general_cut import general_cut  # this module is needed for few systems

        return general_cut(view, along, at, count, follower)
    place = middles(getattr(view, along), count, "count")
    pieces: list[dict[str, np.ndarray]] = []
    for first in range(0, count, _AT_ONCE):
        follower.watch()
        pieces.append(_piece(view, along, at, place[first : first + _AT_ONCE], follower))
    joined = {name: np.concatenate([piece[name] for piece in pieces], axis=-1) for name in pieces[0]}
    header = {"along": along, "at": at, "ends": getattr(view, along), "dofs": view.system.dofs.numbers}
    return header, joined


def _piece(
    view: View, along: Along, at: float, places: np.ndarray, follower: Follower
) -> dict[str, np.ndarray]:
    from ..single.curves import solve_curves  # with xarray, which a page can do without until a line is drawn

    here = np.array([at])
    axes = {"r": places, "beta": here} if along == "r" else {"r": here, "beta": places}
    axes["mu"] = np.array([view.mu])
    asked = curve_settings(None, _QUANTITIES)
    found = solve_curves(view.system, axes, view.solver, asked, None, follower.progress, follower.watch)
    names = {
        "contact_amplitude": "contact_amplitude",
        "contact_phase": "contact_first_harmonic_phase",
        "work_friction": "work_friction",
        "amplitude": "amplitude",
        "regime": "regime",
        "stops": "stops_per_cycle",
    }
    if along == "r":
        names |= {"held": "held_response", "limit": "limit_amplitude"}
    only = {"mu": 0, "beta" if along == "r" else "r": 0}
    flat = {ours: found[name].isel(only, missing_dims="ignore").values.T for ours, name in names.items()}
    classes = of_cells(flat.pop("regime"), flat.pop("stops"))
    return {"classes": classes, **{name: values.astype(np.float32) for name, values in flat.items()}}
