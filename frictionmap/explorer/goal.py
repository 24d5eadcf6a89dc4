"""The goal of a design, as the page asks for it: the friction that meets it over a band of frequencies."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from .. import checks, design, regimes
from ..design.band import checked_band
from ..design.watching import watched
from ..errors import InputError, NoSteadyState
from ..units.scales import NO_SCALES
from .queries import Query, needed, number
from .subjects import Subject, subjects_of
from .views import Follower, View

#: Keys of a query for a goal.
GOAL = ("goal", "band", "of", "limit", "page", "turn")

#: The range of friction around the least peak is that in which the peak is at most this multiple of it.
NEAR = 1.05


class Goal(NamedTuple):
    """A question about the friction over a band of frequencies."""

    question: str
    band: tuple[float, ...]  # frequency ratios
    subject: Subject | None  # of goals about a response
    limit: float | None  # that the response stays within


def goal_of(query: Query) -> Goal:
    """Requested goal; its band and limit are checked when it is answered.

    Raises
    ------
    InputError
        A key is missing, or its value is invalid.
    """
    given = query.given
    question = checks.choice(needed(given, "goal"), "goal", tuple(_ANSWERS))
    band = tuple(number(part, "band") for part in needed(given, "band").split(","))
    if question in ("no-stop", "stuck"):
        return Goal(question, band, None, None)
    known = {one.key: one for one in subjects_of(query.view.system)}
    subject = known[checks.choice(given.get("of", next(iter(known))), "of", tuple(known))]
    limit = number(needed(given, "limit"), "limit") if question == "at-most" else None
    return Goal(question, band, subject, limit)


def answer_goal(view: View, goal: Goal, follower: Follower) -> dict[str, Any]:
    """The answer of `fm.design` for the page.

    `beta` is the friction ratio (None: infinite), `ranges` are those that meet the goal, from and to (None:
    without end).  About a response: `peak`, the largest one over the band, `peaks` where it is reached, with
    regime and stops, the `kind` of the optimum, and a `caution` if there is one.  About a boundary: `r`, the
    frequency that decides, and with mu > 1 `some`, the friction with which it is so from some starts.

    Raises
    ------
    InputError
        The goal does not suit the system, or cannot be met.
    """
    band = checked_band(list(goal.band), NO_SCALES)
    replace(view, r=(band.low, band.high)).check()
    try:
        with watched(follower.watch):
            found = _ANSWERS[goal.question](view, goal)
    except NoSteadyState as error:
        raise InputError(str(error)) from None
    return {"goal": goal.question, "band": [band.low, band.high], **found}


def _answer_of(function: Callable[..., xr.Dataset], view: View, goal: Goal, **further: Any) -> xr.Dataset:
    """The dataset of a question about a response."""
    assert goal.subject is not None
    return function(view.system, list(goal.band), mu=view.mu, **goal.subject.arguments, **further)


def _least_peak(view: View, goal: Goal) -> dict[str, Any]:
    found = _peaks_answer(_answer_of(design.least_peak, view, goal))
    if not found["peak"]:
        return {**found, "ranges": [[found["beta"], None]] if found["peak"] == 0.0 else []}
    return {**found, "ranges": _ranges(_answer_of(design.at_most, view, goal, limit=NEAR * found["peak"]))}


def _at_most(view: View, goal: Goal) -> dict[str, Any]:
    ds = _answer_of(design.at_most, view, goal, limit=goal.limit)
    return {**_peaks_answer(ds), "ranges": _ranges(ds), "limit": goal.limit}


def _no_stop(view: View, goal: Goal) -> dict[str, Any]:
    found = _boundary_answer(design.no_stop(view.system, list(goal.band), view.mu))
    return {**found, "ranges": [] if found["beta"] == 0.0 else [[0.0, found["beta"]]]}


def _stuck(view: View, goal: Goal) -> dict[str, Any]:
    found = _boundary_answer(design.stuck(view.system, list(goal.band), view.mu))
    return {**found, "ranges": [] if found["beta"] is None else [[found["beta"], None]]}


def _boundary_answer(ds: xr.Dataset) -> dict[str, Any]:
    """The boundary; with mu > 1 also `some`, the friction with which it is so from some starts."""
    found = {"beta": _finite(ds["beta"]), "r": _finite(ds["at_r"])}
    for name in ("beta_no_stop_some_starts", "beta_stuck_some_starts"):
        if name in ds:
            found["some"] = _finite(ds[name])
    return found


def _peaks_answer(ds: xr.Dataset) -> dict[str, Any]:
    """The optimum and its peaks: the largest one, or two equal ones.  Where nothing moves from its friction
    on there are none, and `r` decides.  `peak` is None where it is infinite.
    """
    kind, beta, peak = str(ds["kind"].values), float(ds["beta"]), float(ds["peak"][0])
    count = {"two equal peaks": 2, "threshold": 0}.get(kind, 1)
    peaks = [
        {
            "r": float(ds["peak_r"][k]),
            "regime": _regime(int(ds["peak_regime"][k])),
            "stops": _finite(ds["peak_stops"][k]),
        }
        for k in range(count)
    ]
    found = {"beta": beta, "peak": _finite(peak), "kind": kind, "peaks": peaks}
    found |= {"r": _finite(ds["at_r"])} if "at_r" in ds else {}
    return found | {"caution": ds.attrs["warnings"]} if "warnings" in ds.attrs else found


def _regime(value: int) -> str:
    name = next(code.name for code in regimes.BELT_REGIMES if code.value == value)
    return "stick-slip" if value == regimes.STICK_SLIP else name.replace("_", " ")


def _ranges(ds: xr.Dataset) -> list[list[float | None]]:
    begins, ends = ds["interval_begin"].values, ds["interval_end"].values
    return [[float(begin), _finite(end)] for begin, end in zip(begins, ends, strict=True)]


def _finite(value: Any) -> float | None:
    """A number; None if it is infinite or NaN, which JSON lacks."""
    return float(value) if np.isfinite(value) else None


_ANSWERS: Mapping[str, Callable[[View, Goal], dict[str, Any]]] = {
    "least-peak": _least_peak,
    "no-stop": _no_stop,
    "stuck": _stuck,
    "at-most": _at_most,
}
