"""The goal of a design, as the page asks for it: the friction that meets it over a band of frequencies."""

from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from .. import checks, regimes
from ..datasets.questions import record, records
from ..design.band import checked_band
from ..design.questions.record import Question
from ..design.watching import watched
from ..errors import InputError, NoSteadyState
from ..units.scales import NO_SCALES
from .queries import PAGE, Query, needed
from .subjects import Subject, subjects_of
from .views import Follower, View

if TYPE_CHECKING:
    import xarray as xr

#: Keys of its query.
KEYS = ("goal", "band", "of", "limit", *PAGE)


class Goal(NamedTuple):
    """A question about the friction over a band of frequencies."""

    question: str
    band: tuple[float, ...]  # frequency ratios
    subject: Subject | None  # of goals about a response
    limit: float | None  # that the response stays within


def goals() -> tuple[Question, ...]:
    """The questions that are goals on the page."""
    return tuple(one for one in records() if one.goal is not None)


def describe_goals() -> list[dict[str, Any]]:
    """Goals for the page: key, label, whether they are about a response, and whether it has a limit."""
    return [
        {"key": one.name, "label": one.goal.label, "response": one.of_response, "limit": one.has_limit}
        for one in goals()
        if one.goal is not None
    ]


def read(query: Query) -> tuple[Goal]:
    """Requested goal; its band and limit are checked when it is answered.

    Raises
    ------
    InputError
        A key is missing, or its value is invalid.
    """
    given = query.given
    question = checks.choice(needed(given, "goal"), "goal", tuple(one.name for one in goals()))
    band = band_of(query)
    if not record(question).of_response:
        return (Goal(question, band, None, None),)
    known = {one.key: one for one in subjects_of(query.view.system)}
    subject = known[checks.choice(given.get("of", next(iter(known))), "of", tuple(known))]
    limit = limit_of(query) if record(question).has_limit else None
    return (Goal(question, band, subject, limit),)


def band_of(query: Query) -> tuple[float, ...]:
    """Requested band of frequency ratios, not checked yet."""
    return tuple(query.ratios(needed(query.given, "band").split(","), "band", "frequency"))


def limit_of(query: Query) -> float:
    """Requested limit of a response, which is a length, not checked yet."""
    return query.ratio(needed(query.given, "limit"), "limit", "length")


def answer_goal(view: View, goal: Goal, follower: Follower) -> dict[str, Any]:
    """The answer of `fm.design` for the page.

    `beta` is the friction ratio (None: infinite), `ranges` are those that meet the goal, from and to (None:
    without end).  About a response: `peak`, the largest one over the band, `peaks` where it is reached, with
    regime and stops, the `kind` of the optimum, and a `caution` if there is one.  About a boundary: `r`, the
    frequency that decides, and with mu > 1 `some`, the friction with which it is so from some starts.  `rows`
    are those of its summary.

    Raises
    ------
    InputError
        The goal does not suit the system, or cannot be met.
    """
    band = checked_band(list(goal.band), NO_SCALES)
    replace(view, r=(band.low, band.high)).check()
    question = record(goal.question)
    limit = {} if goal.limit is None else {"limit": goal.limit}
    try:
        with watched(follower.watch):
            ds = _answer(question, view, goal, **limit)
            ranges = question.goal.ranges(ds, lambda most: _answer(record("at-most"), view, goal, limit=most))
    except NoSteadyState as error:
        raise InputError(str(error)) from None
    found = _peaks_answer(ds) if question.of_response else _boundary_answer(ds)
    return {
        "goal": goal.question, "band": [band.low, band.high], **found, **limit,
        "ranges": [[begin, _finite(end)] for begin, end in ranges],
        "rows": [row for rows in question.rows for row in rows(ds)],
    }  # fmt: skip


def _answer(question: Question, view: View, goal: Goal, **limit: float) -> "xr.Dataset":
    """The dataset of a question about the view of a goal."""
    of = goal.subject.arguments if goal.subject is not None else {}
    return question.function(view.system, list(goal.band), mu=view.mu, **of, **limit)


def _boundary_answer(ds: "xr.Dataset") -> dict[str, Any]:
    """The boundary; with mu > 1 also `some`, the friction with which it is so from some starts."""
    found = {"beta": _finite(ds["beta"]), "r": _finite(ds["at_r"])}
    for name in ("beta_no_stop_some_starts", "beta_stuck_some_starts"):
        if name in ds:
            found["some"] = _finite(ds[name])
    return found


def _peaks_answer(ds: "xr.Dataset") -> dict[str, Any]:
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


def _finite(value: Any) -> float | None:
    """A number; None if it is infinite or NaN, which JSON lacks."""
    return float(value) if np.isfinite(value) else None
