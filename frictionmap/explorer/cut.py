"""Response curves through a view, along r or beta."""

from typing import Any, Literal, get_args

import numpy as np

from .. import checks
from ..model.settings import Quantity, curve_settings
from ..pictures.classes import of_cells
from ..units.axes import KINDS
from .drawing import mass_names
from .quantities import counted_of
from .queries import PAGE, Query, needed, points_of
from .views import Follower, View, middles

Along = Literal["r", "beta"]

#: Cells computed at once: a request cannot be cancelled while their boundaries are determined.
_AT_ONCE = 96

#: Cells of a curve at most where each motion is followed, which takes some milliseconds.
_FOLLOWED = 240

_QUANTITIES: tuple[Quantity, ...] = ("amplitude", "first_harmonic", "energy")

#: Arrays of contacts, and those along r, with their names in datasets.
_OF_CONTACTS = {
    "contact_amplitude": "contact_amplitude",
    "contact_phase": "contact_first_harmonic_phase",
    "work_friction": "work_friction",
}
_ALONG_R = {"held": "held_response", "limit": "limit_amplitude"}


#: Keys of its query.
KEYS = ("along", "place", "count", *PAGE)


def read(query: Query) -> tuple[Along, float, int]:
    """Axis of a cut, value of the other axis, number of points."""
    valid: tuple[Along, ...] = get_args(Along)
    along: Any = checks.choice(needed(query.given, "along"), "along", valid)
    kind = KINDS["beta" if along == "r" else "r"]
    place = checks.number(query.ratio(needed(query.given, "place"), "place", kind), "place", least=0.0)
    return along, place, points_of(query)


def cut(
    view: View, along: Along, at: float, count: int, follower: Follower
) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    """Response curves along r at one beta, or along beta at one r.

    Arrays over the cut: `classes`; `contact_amplitude`, `work_friction`, `contact_phase` (of the first
    harmonic), of the contact that is shown, or (contacts, cells) of those whose names the header has under
    `contacts`; `amplitude` (masses, cells).  Along r also `held` (masses, cells), with the contact held, and
    `limit`, those at beta_lim, if they are closed forms.
    """
    view.check(None if along == "r" else at)
    count = count if view.engine.has_closed_limits else min(count, _FOLLOWED)
    place = middles(getattr(view, along), count, "count")
    pieces: list[dict[str, np.ndarray]] = []
    for first in range(0, count, _AT_ONCE):
        follower.watch()
        pieces.append(_piece(view, along, at, place[first : first + _AT_ONCE], follower))
    joined = {name: np.concatenate([piece[name] for piece in pieces], axis=-1) for name in pieces[0]}
    header = {
        "along": along, "at": at, "ends": getattr(view, along), "dofs": mass_names(view.system),
        "contacts": [one.name for one in view.contacts] if view.shown is None else [],
    }  # fmt: skip
    return header, joined


def _piece(
    view: View, along: Along, at: float, places: np.ndarray, follower: Follower
) -> dict[str, np.ndarray]:
    """Arrays of some cells of a cut."""
    here = np.array([at])
    axes = {"r": places, "beta": here} if along == "r" else {"r": here, "beta": places}
    axes["mu"] = np.array([view.mu])
    found = view.engine.curves(
        axes, view.solver, curve_settings(None, _QUANTITIES), None, follower.progress, follower.watch
    ).isel({"mu": 0, "beta" if along == "r" else "r": 0}, missing_dims="ignore")
    k, count = view.shown, view.system.contact_system.count

    def table(name: str) -> np.ndarray:
        """Values (rows, cells), of one contact (cells,); NaN if no cell has them."""
        if name not in found:
            rows = view.system.n if name == "amplitude" else count if k is None else None
            return np.full((places.size,) if rows is None else (rows, places.size), np.nan)
        values = found[name].values.T
        return values if k is None or "contact" not in found[name].dims else values[k]

    along_r = {ours: name for ours, name in _ALONG_R.items() if along == "r" and name in found}
    names = {**_OF_CONTACTS, "amplitude": "amplitude", **along_r}
    by = counted_of(view).variable
    regime = table("contact_regime" if count > 1 and k is not None else "regime")
    flat = {ours: table(name).astype(np.float32) for ours, name in names.items()}
    return {"classes": of_cells(regime, table(by) if by else None), **flat}
