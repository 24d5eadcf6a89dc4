"""A motion in sentences: what the contacts do in a cell, and why."""

from collections.abc import Iterable, Mapping

import numpy as np

from .. import regimes
from .views import View

#: What a contact does, by its regime: one that is rigid, and one with a spring.
_RIGID = {
    regimes.PERMANENT_STICKING: "never slides: friction holds it permanently",
    regimes.CONTINUOUS: "slides to and fro without stopping",
    regimes.ONE_WAY_SLIDING: "slides one way only, without turning or stopping",
}
_ELASTIC = {
    regimes.PERMANENT_STICKING: "never slips: its spring deforms",
    regimes.CONTINUOUS: "slips without pause",
}

#: The same of many contacts; and that of a motion with stops, or slips.
_MANY = {
    regimes.PERMANENT_STICKING: "never slide or slip",
    regimes.STICK_SLIP: "move and rest in turn",
    regimes.CONTINUOUS: "never rest",
    regimes.ONE_WAY_SLIDING: "slide one way only",
}

#: Contacts that have a sentence each, and contacts that are named in a sentence.
_MOST = 8

#: Boundaries by their symbols.
_SYMBOLS = {"beta_lim": "β_lim", "beta_stick": "β_stick", "beta_noslip": "β_noslip"}


def describe_motion(
    view: View, beta: float, values: Mapping[str, np.ndarray], limits: Mapping[str, np.ndarray]
) -> list[str]:
    """Describe what each contact that is shown does, why, and how sure that is.

    limits : the boundaries at the frequency of the cell
    """
    k, count = view.shown, view.system.contact_system.count
    shown = range(count) if k is None else [k]
    many = len(shown) > _MOST
    found = _describe_many(view, values) if many else [_describe_contact(view, values, j) for j in shown]
    found += _given_frictions(view, shown)
    known = {name: float(one.item()) for name, one in limits.items() if name in _SYMBOLS}
    found += [_explained(beta, known)] if view.engine.has_closed_limits else _placed(beta, known)
    status = int(values["status"])
    if status != regimes.RESOLVED:
        meaning = regimes.status_meaning(status)
        found.append(f"{meaning[0].upper()}{meaning[1:]}.")
    return found


def _describe_contact(view: View, values: Mapping[str, np.ndarray], j: int) -> str:
    groups = view.system.contact_system.groups
    who = groups[j].name if len(groups) > 1 else "the contact"
    elastic, regime = groups[j].stiffness is not None, int(values["contact_regime"][j])
    does = (_ELASTIC if elastic else _RIGID).get(regime) or _counted(values, j, elastic=elastic)
    opened = 100.0 * float(values["open_fraction"][j]) if "open_fraction" in values else 0.0
    opens = f"; it is open {opened:.3g} % of the time" if opened > 0.0 else ""
    return f"{who[0].upper()}{who[1:]} {does}{opens}."


def _given_frictions(view: View, shown: Iterable[int]) -> list[str]:
    """The friction of contacts whose preload is given: beta does not change it."""
    groups, found = view.system.contact_system.groups, []
    for j in shown:
        if groups[j].first.has_preload:
            normal = groups[j].first.normal
            who = f" of {groups[j].name}" if len(groups) > 1 else ""
            unit = "k₁Y" if view.system.excitation == "base" else "P"
            friction = f"{normal.friction * max(0.0, normal.preload):.4g} {unit}"
            found.append(f"The preload is given: the friction{who} at rest is {friction}, whatever β is.")
    return found


def _describe_many(view: View, values: Mapping[str, np.ndarray]) -> list[str]:
    """How many contacts do what, and which those are where they are few."""
    groups, found = view.system.contact_system.groups, []
    each = np.asarray(values["contact_regime"])
    for regime, does in _MANY.items():
        which = np.flatnonzero(each == regime)
        if which.size:
            names = ": " + ", ".join(groups[j].name for j in which) if which.size <= _MOST else ""
            found.append(f"{which.size} of {each.size} contacts {does}{names}.")
    return found


def _counted(values: Mapping[str, np.ndarray], j: int, *, elastic: bool) -> str:
    """A motion with stops, or with slips of an elastic contact, and their number."""
    events, share = ("slips", "elastic_fraction") if elastic else ("stops", "stuck_fraction")
    count, part = float(values[f"{events}_per_cycle"][j]), 100.0 * float(values[share][j])
    counted = f"{count:.4g} {events.removesuffix('s') if count == 1.0 else events} per cycle"
    does, rests = ("slips and rests", "without slip") if elastic else ("slides and stops", "stuck")
    return f"{does}: {counted}; {rests} {part:.3g} % of the time"


def _explained(beta: float, limits: Mapping[str, float]) -> str:
    """Why one contact moves as it does: closed forms say all of it."""
    lim, stick = limits["beta_lim"], limits["beta_stick"]
    if beta >= stick:
        return f"β = {beta:.4g} reaches β_stick = {stick:.4g}: friction can hold the contact permanently."
    if beta < lim:
        return f"β = {beta:.4g} lies below β_lim = {lim:.4g}: the contact can slide without stopping."
    return (
        f"β = {beta:.4g} lies between β_lim = {lim:.4g} and β_stick = {stick:.4g}: friction stops the "
        "contact, but cannot hold it permanently."
    )


def _placed(beta: float, limits: Mapping[str, float]) -> list[str]:
    """The position of the cell between the boundaries."""
    known = [(_SYMBOLS[name], limits[name]) for name in _SYMBOLS if np.isfinite(limits.get(name, np.nan))]
    below = [f"below {symbol} = {value:.4g}" for symbol, value in known if beta < value]
    above = [f"at or above {symbol} = {value:.4g}" for symbol, value in known if beta >= value]
    return [f"β = {beta:.4g} lies {' and '.join((*above, *below))}."] if known else []
