"""Boundaries of a view of a system with several contacts, springs, belts or periodic loads."""

from collections.abc import Mapping

import numpy as np

from ..general.boundaries import INTERVALS, Boundaries, find_boundaries
from ..general.dataset import refuse_static
from ..general.problem import general_of
from ..jobs import Watch
from .scene_parts import Line
from .views import View

#: Ends of ranges without a stop that do not begin at beta = 0, or are not the first.
_FURTHER = tuple(f"no_stop_{end}_{k}" for k in range(1, INTERVALS + 1) for end in ("begin", "end"))

_DASHED, _DOTTED = (7, 4), (2, 3)

_NO_STOP = Line(_FURTHER, "", _DOTTED, "ends of further ranges without stops")


def chosen(view: View) -> int | None:
    """The contact that is shown, counted from 0; None: all together."""
    return 0 if general_of(view.system).count == 1 else view.contact


def general_lines(view: View) -> tuple[Line, ...]:
    """The boundaries that a view has."""
    elastic, k = general_of(view.system).elastic, chosen(view)
    several = elastic.size > 1
    if k is not None and elastic[k]:
        never = "the contact never slips" + (", the others held" if several else "")
        return (Line(("beta_noslip",), "noslip", _DASHED, f"at or above: {never}"),)
    if elastic.all():
        return (Line(("beta_noslip",), "noslip", _DASHED, "at or above: no contact slips"),)
    if elastic.any():
        noslip = Line(("beta_noslip",), "noslip", _DOTTED, "at or above: no elastic contact slips")
        return _stick(view) if k is not None else (noslip, *_stick(view))
    who = "no contact stops" if several else "the contact can slide without stopping"
    return (Line(("beta_lim",), "lim", (), f"below: {who}"), *_stick(view), _NO_STOP)


def _stick(view: View) -> tuple[Line, ...]:
    """The boundary to permanent sticking; none on a belt, which takes the mass along."""
    general, k = general_of(view.system), chosen(view)
    if any(group.first.wall_velocity for group in (general.groups if k is None else [general.groups[k]])):
        return ()
    if k is None:
        held = "all contacts can stay stuck"
    else:
        held = "the contact can stay stuck" + (", the others held" if general.count > 1 else "")
    return (Line(("beta_stick",), "stick", _DASHED, f"at or above: {held}"),)


def limits_of(view: View, r: np.ndarray, watch: Watch | None = None) -> Boundaries:
    """The boundaries of all contacts over r."""
    mu = np.array([view.mu])
    refuse_static(general_of(view.system), mu)
    return find_boundaries(view.system, r, mu, None, watch)


def general_line_values(view: View, limits: Boundaries) -> dict[str, np.ndarray]:
    """The curves of a view over r."""
    elastic, k = general_of(view.system).elastic, chosen(view)
    by_contact = limits.beta_stick_contact[0]
    found = {
        "beta_lim": limits.beta_lim[0],
        "beta_stick": limits.beta_stick[0] if k is None else by_contact[:, k],
        **_further(limits),
    }
    if elastic.any():
        found["beta_noslip"] = by_contact[:, elastic if k is None else [k]].max(axis=1)
    return {name: found[name] for line in general_lines(view) for name in line.names}


def _further(limits: Boundaries) -> Mapping[str, np.ndarray]:
    """Ends of the ranges without a stop, NaN where beta_lim already says them."""
    found = {}
    for k in range(INTERVALS):
        begin, end = limits.begins[0, :, k], limits.ends[0, :, k]
        known = begin == 0.0
        found[f"no_stop_begin_{k + 1}"] = np.where(known, np.nan, begin)
        found[f"no_stop_end_{k + 1}"] = np.where(known, np.nan, end)
    return found
