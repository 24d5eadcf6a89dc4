"""How far a working point is from the boundaries of its regime."""

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from ... import checks
from ...datasets.amounts import DIGITS, amounts_of
from ...datasets.design_labels import beta_label, r_label
from ...datasets.labels import Label
from ...files.key import Key, either, number, with_unit
from ...model.system import System
from ...units.axes import KINDS, require
from ...units.scales import Units, scales_of
from .keys import BETA, MU
from .record import Question
from .rows import friction_rows
from .sentences import whole_sentence

if TYPE_CHECKING:
    import xarray as xr


def margin(system: System, r: Any, beta: Any, mu: float = 1.0, *, units: Units | None = None) -> "xr.Dataset":
    """Find how far a working point is from the boundaries of its regime, in friction and in frequency.

    Parameters
    ----------
    system, mu, units
        As in `least_peak`.
    r : float
        Frequency ratio of the working point, > 0; with units also a frequency.
    beta : float
        Its friction ratio, > 0; with units also a force.

    Returns
    -------
    xarray.Dataset
        `beta_lim` and `beta_stick` at r, `margin_beta_lim` and `margin_beta_stick`: how much they are above
        beta, relative to beta; `nearest_r_on_beta_lim` and `nearest_r_on_beta_stick`, the nearest frequencies
        within a factor of ten at which a boundary is beta (NaN: none), `margin_r` and `margin_r_stick`: how
        far they are, relative to r.  With mu > 1 the boundaries are those of some initial states.

    Raises
    ------
    InputError
        An argument has the wrong type or is out of range.

    Examples
    --------
    >>> import frictionmap as fm
    >>> ds = fm.design.margin(fm.System(damping_ratios=0.01), r=0.75, beta=0.6)
    >>> round(100 * ds.margin_beta_lim.item(), 6), round(100 * ds.margin_r.item(), 6)
    (27.535839, -14.57624)
    """
    from ..answers import answer, boundaries_over
    from ..band import Band
    from ..limits import has_no_stop_limit, no_stop_limit, refuse_unknown_stick, stick_limit
    from ..nearest import around, nearest, no_stop_at, stick_at
    from ..task import checked_number

    checks.instance(system, "system", System)
    scales = scales_of(units, system)
    require(scales, r=(KINDS["r"], r), beta=(KINDS["beta"], beta))
    r = checked_number(r, "r", KINDS["r"], scales, above=0.0, most=checks.LARGEST_RATIO)
    beta = checked_number(beta, "beta", KINDS["beta"], scales, above=0.0)
    mu = checks.number(mu, "mu", least=1.0)
    found: dict[str, Any] = {"at_r": r, "beta": beta, "mu": mu}
    refuse_unknown_stick(system, "find margins")
    limits: dict[str, tuple] = {"beta_stick": (stick_limit, stick_at, "margin_r_stick")}
    if has_no_stop_limit(system):
        limits["beta_lim"] = no_stop_limit, no_stop_at, "margin_r"
    low = 0.5 * r
    for name, (limit, at, margin_r) in limits.items():
        value, line = float(limit(system, np.array([r]), mu)[0]), at(system, beta, mu)
        place = nearest(line, r)
        low = max(low, around(line, r).low)
        found |= {name: value, f"margin_{name}": value / beta - 1.0}
        found |= {f"nearest_r_on_{name}": place, margin_r: place / r - 1.0}
    shown = Band(low, 2.0 * r)
    found |= boundaries_over(system, shown, mu)
    return answer("margin", system, shown, found, {"r": r, "beta": beta, "mu": mu}, units, scales)


#: Boundaries of the regimes: variable, words, and the variables of its place in frequency.
_BOUNDARIES = (
    ("beta_lim", "motion without stops", "nearest_r_on_beta_lim"),
    ("beta_stick", "permanent sticking", "nearest_r_on_beta_stick"),
)


def _regime_sentence(ds: "xr.Dataset") -> Iterator[str]:
    """What the contact does at the working point, as far as the boundaries show it."""
    if not {"beta", "at_r"} <= set(ds.variables):
        return
    words, beta = amounts_of(ds), float(ds["beta"])
    starts = float(ds.get("mu", 1.0)) > 1.0 or beta > float(ds.get("beta_unique", np.inf))
    can = "can " if starts else ""
    does = ""
    if "beta_stick" in ds and beta >= float(ds["beta_stick"]):
        does = f"{can}stay{'' if can else 's'} stuck"
    elif "beta_lim" in ds and beta <= float(ds["beta_lim"]):
        does = f"{can}slide{'' if can else 's'} without stops"
    elif "beta_lim" in ds and np.isfinite(float(ds["beta_lim"])):
        does = "sticks and slips"
    if does:
        frequency = words.frequency(float(ds["at_r"]), digits=DIGITS)
        yield whole_sentence(f"at {frequency} and {words.friction(beta, digits=DIGITS)} the contact {does}")


def _margin_rows(ds: "xr.Dataset") -> Iterator[tuple[str, str]]:
    """The working point, and how far the boundaries are above or below it in friction and in frequency."""
    yield from friction_rows(ds, "working point: friction", "working point: frequency")
    words = amounts_of(ds)
    for name, regime, place in _BOUNDARIES:
        if {name, "beta"} <= set(ds.variables):
            apart = _apart(float(ds[name]), float(ds["beta"]), words.friction_and_ratio, words.friction)
            yield f"{regime}, in friction", apart
        if {place, "at_r"} <= set(ds.variables):
            apart = _apart(float(ds[place]), float(ds["at_r"]), words.frequency_and_ratio, words.frequency)
            yield f"{regime}, in frequency", apart


def _apart(boundary: float, point: float, place: Callable[[float], str], size: Callable[[float], str]) -> str:
    """A boundary, and how far it is above or below the working point."""
    if not np.isfinite(boundary):
        return "no boundary" + (" at any friction" if np.isinf(boundary) else " within a factor of ten")
    side = "above" if boundary >= point else "below"
    change = f"{100.0 * (boundary / point - 1.0):+.3g} %"
    return f"boundary at {place(boundary)}: {size(abs(boundary - point))} {side} the working point ({change})"


_R = Key(
    "r",
    "for margin: the frequency of the working point",
    either(number(above=0.0), with_unit("frequency")),
    example="0.75",
    words="a frequency ratio > 0, or a frequency with its unit",
)

MARGIN = Question(
    name="margin",
    title="Margins of a working point",
    function=margin,
    needed=(_R, BETA),
    optional=(MU,),
    labels={
        "beta_lim": beta_label("boundary of motion without stops at the working point", nan=True),
        "beta_stick": beta_label("boundary to permanent sticking at the working point"),
        "margin_beta_lim": Label(np.float64, "beta_lim/beta - 1", (), least=-1.0, nan=True, inf=True),
        "margin_beta_stick": Label(np.float64, "beta_stick/beta - 1", (), least=-1.0, inf=True),
        "nearest_r_on_beta_lim": r_label("nearest frequency ratio at which beta_lim is beta", nan=True),
        "nearest_r_on_beta_stick": r_label("nearest frequency ratio at which beta_stick is beta", nan=True),
        "margin_r": Label(np.float64, "nearest_r_on_beta_lim/r - 1", (), least=-1.0, nan=True),
        "margin_r_stick": Label(np.float64, "nearest_r_on_beta_stick/r - 1", (), least=-1.0, nan=True),
    },
    rows=(_margin_rows,),
    sentences=(_regime_sentence,),
    panels=("limits",),
    mark="working point",
)
