"""Response curves through a view of a system with several contacts, springs, belts or periodic loads."""

from typing import Any

import numpy as np

from ..general.curves import general_curves
from ..general.problem import general_of
from ..model.settings import Quantity, curve_settings
from ..pictures.classes import of_cells
from .general_lines import chosen
from .general_views import counted_of
from .views import Follower, View, middles

#: Points of a curve: each is a motion of its own, which takes some milliseconds.
_MOST = 240

_QUANTITIES: tuple[Quantity, ...] = ("amplitude", "first_harmonic", "energy")

_OF_CONTACTS = {
    "contact_amplitude": "contact_amplitude",
    "contact_phase": "contact_first_harmonic_phase",
    "work_friction": "work_friction",
}


def general_cut(
    view: View, along: str, at: float, count: int, follower: Follower
) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    """Response curves along r at one beta, or along beta at one r, as `cut` has those of one contact.

    Arrays of contacts are (contacts, cells), of those whose names the header has under `contacts`.
    """
    count = min(count, _MOST)
    axes = {"mu": np.array([view.mu]), "r": np.array([at]), "beta": np.array([at])}
    axes[along] = middles(getattr(view, along), count, "count")

    def progress(done: int, total: int) -> None:
        follower.watch()
        follower.progress(done, total)

    ds = general_curves(view.system, axes, view.solver, curve_settings(None, _QUANTITIES), progress)
    k, general = chosen(view), general_of(view.system)
    several = general.count > 1

    def table(name: str, rows: int) -> np.ndarray:
        """Values (rows, cells); NaN if no cell of the curve has them."""
        if name not in ds:
            return np.full((rows, count), np.nan)
        return ds[name].values.reshape(count, rows).T

    shown = list(range(general.count)) if k is None else [k]
    arrays = {ours: table(name, general.count)[shown] for ours, name in _OF_CONTACTS.items()}
    arrays["amplitude"] = table("amplitude", view.system.n)
    own = "contact_regime" if several and k is not None else "regime"
    regime = table(own, general.count if own == "contact_regime" else 1)[k if own == "contact_regime" else 0]
    stops = None if k is None else table(counted_of(view).variable, general.count)[k]
    header = {
        "along": along, "at": at, "ends": getattr(view, along), "dofs": view.system.dofs.numbers,
        "contacts": [general.groups[j].name for j in shown],
    }  # fmt: skip
    flat = {name: values.astype(np.float32) for name, values in arrays.items()}
    return header, {"classes": of_cells(regime, stops), **flat}
