"""Boundaries of a view: their values over r, and how the page draws and explains them."""

import numpy as np

from ..solvers.interface import Limits
from .scene_parts import Line
from .views import View

_DASHED, _DOTTED = (7, 4), (2, 3)


def lines_of(view: View) -> tuple[Line, ...]:
    """The boundaries that a view has."""
    if view.unloaded:
        from . import unloaded

        return unloaded.lines_of(view)
    elastic, k = view.system.contact_system.elastic, view.shown
    held = ", the others held" if elastic.size > 1 else ""
    if view.system.contact_system.has_phases:
        return _opening_lines(view)
    if k is not None and elastic[k]:
        return (_no_slip(f"the contact never slips{held}", _DASHED),)
    stick = _stick(view, "all contacts can stay stuck" if k is None else f"the contact can stay stuck{held}")
    if elastic.all():
        return (_no_slip("no contact slips", _DASHED),)
    if elastic.any():
        return stick if k is not None else (_no_slip("no elastic contact slips", _DOTTED), *stick)
    if view.system.contact_system.has_law:
        return stick
    who = "no contact stops" if elastic.size > 1 else "continuous sliding is possible"
    return (Line(("beta_lim",), "lim", (), f"below: {who}"), *stick, *_further(view))


def _opening_lines(view: View) -> tuple[Line, ...]:
    """The friction at preload from which the only contact, whose normal force moves, never slides.

    Where the preload is given, beta changes nothing, and the place of a cell above or below says nothing.
    """
    general = view.system.contact_system
    if general.count > 1 or general.springs or any(one.first.has_preload for one in general.groups):
        return ()
    if general.elastic.all():
        return (_no_slip("the contact never slips", _DASHED),)
    return _stick(view, "the contact can stay stuck")


def _no_slip(meaning: str, dashes: tuple[int, ...]) -> Line:
    return Line(("beta_noslip",), "noslip", dashes, f"at or above: {meaning}")


def _stick(view: View, meaning: str) -> tuple[Line, ...]:
    """The boundary to permanent sticking; none on a belt, which takes the mass along."""
    if any(one.first.belt for one in view.contacts):
        return ()
    return (Line(("beta_stick",), "stick", _DASHED, f"at or above: {meaning}"),)


def _further(view: View) -> tuple[Line, ...]:
    """Ends of ranges without a stop that do not begin at beta = 0, or are not the first."""
    count = view.engine.intervals
    names = tuple(f"no_stop_{end}_{k}" for k in range(1, count + 1) for end in ("begin", "end"))
    return (Line(names, "", _DOTTED, "ends of further ranges without stops"),) if count else ()


def line_names(view: View) -> tuple[str, ...]:
    """Names of all curves of a view."""
    return tuple(name for line in lines_of(view) for name in line.names)


def line_values(view: View, r: np.ndarray, *, known: bool = False) -> dict[str, np.ndarray]:
    """The curves of a view over r; `known`: those that take no search, NaN in the place of others."""
    limits = view.engine.known_limits if known else view.engine.limits
    return values_of_lines(view, limits(r, np.array([view.mu])))


def values_of_lines(view: View, limits: Limits) -> dict[str, np.ndarray]:
    """The curves of a view from the boundaries of its system."""
    elastic, k = view.system.contact_system.elastic, view.shown
    by_contact = limits.beta_stick_contact[0]
    found = {
        "beta_lim": limits.beta_lim[0],
        "beta_stick": limits.beta_stick[0] if k is None else by_contact[:, k],
    }
    if elastic.any():
        found["beta_noslip"] = by_contact[:, elastic if k is None else [k]].max(axis=1)
    for number, ends in enumerate(zip(limits.begins[0].T, limits.ends[0].T, strict=True), 1):
        known = ends[0] == 0.0  # beta_lim says it
        for name, values in zip(("begin", "end"), ends, strict=True):
            found[f"no_stop_{name}_{number}"] = np.where(known, np.nan, values)
    return {name: found[name] for name in line_names(view)}
