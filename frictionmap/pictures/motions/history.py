"""Pictures of one steady state in time."""

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from ... import regimes
from ...errors import InputError
from ..marks import spread
from ..palette import CLASSES, LINES, STUCK, Shade
from ..panels import Handle, given_axes, halo, legend_below, new_figure, title_figure
from ..second_axes import in_brackets, on_the_right, time_on_top
from ..shapes import check_holds, check_range, to_draw
from ..words import caption, load_of, moves_base

if TYPE_CHECKING:
    from ..panels import AxesArray


#: Height of the panels: load, motion in the contact, masses, friction.
_HEIGHTS = {"load": 1.0, "z": 2.4, "masses": 3.0, "friction": 2.2}

#: Labels next to lines: least distance as a share of the panel's height, and largest number.
_GAP, MOST_LABELS = 0.09, 11

#: Largest range of a motion that counts as constant.
_ROUNDING = 1e-9

#: Variables of the events; without one of these the starts of stops are not marked.
_EVENTS = ("event_tau", "event_direction", "event_z")

_SHADE: Shade = {"color": CLASSES[STUCK].colour, "alpha": 0.55, "linewidth": 0.0}
_LOAD_COLOUR = "#cc1f03"

_REGIME_WORDS = {
    regimes.UNRESOLVED: "unresolved",
    regimes.PERMANENT_STICKING: "permanent sticking",
    regimes.STICK_SLIP: "stick-slip",
    regimes.CONTINUOUS: "continuous",
}


def _label_beside(ax: Axes, places: np.ndarray, texts: Sequence[str], colours: Sequence[str]) -> None:
    """Write labels at the right of a panel, next to `places` on its vertical axis, without overlap.

    If there is a second axis, the labels are placed inside the panel.
    """
    aside = (
        {"xytext": (-4, 0), "ha": "right", "path_effects": halo()} if ax.child_axes else {"xytext": (4, 0)}
    )
    low, high = ax.get_ylim()
    beside = spread((places - low) / (high - low), _GAP)
    for height, text, colour in zip(beside, texts, colours, strict=True):
        ax.annotate(
            text, (1.0, height), xycoords="axes fraction", textcoords="offset points",
            va="center", fontsize=8, color=colour, **aside,
        )  # fmt: skip


def _in_sight(ax: Axes, values: np.ndarray) -> None:
    """Set the limits of a vertical axis around values; a constant appears as a level line, not as its
    rounding error.
    """
    low, high = float(values.min()), float(values.max())
    half = 0.56 * (high - low)
    if half <= _ROUNDING * max(1.0, abs(low), abs(high)):
        half = 0.5
    ax.set_ylim(0.5 * (low + high) - half, 0.5 * (low + high) + half)


def _draw_load(ax: Axes, turns: np.ndarray, name: str) -> None:
    ax.plot(turns, np.cos(np.pi * turns), color="black", linewidth=1.0)
    tops = np.arange(0.0, turns[-1] + 1e-9, 2.0)
    ax.plot(tops, np.ones(tops.size), "v", color=_LOAD_COLOUR, markersize=5.0, clip_on=False)
    ax.set_ylim(-1.25, 1.25)
    ax.set_ylabel(name)


def _draw_contact(ax: Axes, ds: xr.Dataset, turns: np.ndarray) -> list[Handle]:
    z = ds["z"].values
    ax.plot(turns, z, color=LINES[0])
    _in_sight(ax, z)
    ax.set_ylabel("contact\n" r"$z$ / $(P/k_1)$")
    on_the_right(ax, ds, "length", "$z$")
    begins = ds["event_direction"].values == 0 if set(_EVENTS) <= set(ds) else np.zeros(0, dtype=bool)
    if not begins.any():
        return []
    times, places = ds["event_tau"].values[begins] / np.pi, ds["event_z"].values[begins]
    marks = ax.plot(times, places, "o", color="black", markersize=4.5, clip_on=False, label="stop begins")
    return [*marks]


def _draw_masses(ax: Axes, ds: xr.Dataset, turns: np.ndarray) -> None:
    """Draw every mass, with its number at the end of its line; of many masses some are numbered."""
    x = ds["x"].values
    numbers = ds["dof"].values
    colours = [LINES[k % len(LINES)] for k in range(len(x))]
    for place, colour in zip(x, colours, strict=True):
        ax.plot(turns, place, color=colour, linewidth=1.2)
    _in_sight(ax, x)
    on_the_right(ax, ds, "length", "$x$")
    ax.set_ylabel("masses\n" r"$x$ / $(P/k_1)$")
    labelled = np.unique(np.linspace(0, len(x) - 1, min(len(x), MOST_LABELS)).round().astype(int))
    _label_beside(
        ax, x[labelled, -1], [rf"$x_{{{numbers[k]}}}$" for k in labelled], [colours[k] for k in labelled]
    )


def _draw_friction(ax: Axes, ds: xr.Dataset, turns: np.ndarray) -> None:
    """Draw the friction force between its kinetic and static levels."""
    friction, beta, mu = ds["friction"].values, float(ds["beta"]), float(ds["mu"])
    ax.plot(turns, friction, color="black", linewidth=1.2)
    names = {beta: r"\beta", mu * beta: r"\mu\beta"} if mu > 1.0 else {beta: r"\beta"}
    levels = np.array([sign * level for level in names for sign in (1.0, -1.0)])
    texts = [f"${sign}{name}$" for name in names.values() for sign in ("", "-")]
    for level in np.unique(levels):
        ax.axhline(level, color="#606060", linewidth=0.9, linestyle=":")
    _in_sight(ax, np.concatenate((friction, levels)))
    on_the_right(ax, ds, "force", "friction")
    _label_beside(ax, levels, texts, ["black"] * len(texts))
    ax.set_ylabel("friction / $P$")


def _mark_stops(axes: Sequence[Axes], ds: xr.Dataset, turns: np.ndarray) -> list[Handle]:
    """Shade stops, and mark maxima of the load with dotted lines, in all panels."""
    stopped = ds["direction"].values == 0
    for ax in axes:
        transform = ax.get_xaxis_transform()
        ax.fill_between(turns, 0, 1, where=stopped.tolist(), transform=transform, zorder=0.5, **_SHADE)
        for turn in np.arange(2.0, turns[-1] - 1e-9, 2.0):
            ax.axvline(turn, color=_LOAD_COLOUR, linewidth=1.0, linestyle=(0, (1, 2)), zorder=0.7)
    stuck = int(ds["regime"]) == regimes.PERMANENT_STICKING if "regime" in ds else bool(stopped.all())
    handles: list[Handle] = []
    if stopped.any():
        handles.append(Patch(**_SHADE, label="permanent sticking" if stuck else "stop"))
    load = "maximum of the load (of the base's motion)" if moves_base(ds) else "maximum of the load"
    handles.append(
        Line2D([], [], color=_LOAD_COLOUR, label=load, marker="v", markersize=5.0, linestyle=(0, (1, 2)))
    )
    return handles


def title_of(ds: xr.Dataset) -> str:
    """Title with the cell and its result."""
    symbols = {"r": "r", "beta": "β", "mu": "μ"}
    cell = ", ".join(
        f"{symbol} = {float(ds[name]):.6g}{in_brackets(ds, name)}" for name, symbol in symbols.items()
    )
    if "regime" not in ds:
        return cell
    words = _REGIME_WORDS[int(ds["regime"])]
    stops = float(ds["stops_per_cycle"]) if "stops_per_cycle" in ds else 0.0
    counted = f", {stops:.4g} stops per cycle" if stops > 0 else ""
    if "status" in ds and int(ds["status"]) in regimes.WITHOUT_PERIOD:
        return f"{cell}: {words}{counted}, irregular, excerpt"
    period = int(ds["period"]) if "period" in ds else 1
    return f"{cell}: {words}{counted}" + (f", period {period}" if period > 1 else "")


def contact_is_a_mass(ds: xr.Dataset) -> bool:
    """Whether a mass moves with the contact."""
    return any(np.allclose(x, ds["z"].values, rtol=0.0, atol=1e-12) for x in ds["x"].values)


def _panels(ds: xr.Dataset) -> list[str]:
    """Panels of a steady state; a single mass that moves with its contact has no panel of its own."""
    same = ds.sizes["dof"] == 1 and contact_is_a_mass(ds)
    loaded = load_of(ds) is not None
    return [
        name
        for name, there in (("load", loaded), ("z", True), ("masses", not same), ("friction", True))
        if there
    ]


def check_can_be_seen(ds: xr.Dataset, names: Iterable[str]) -> None:
    """Refuse a single instant, and variables beyond the range of an axis."""
    if ds.sizes["tau"] < 2:
        raise InputError(f"a response must have two tau or more to be drawn; got {ds.sizes['tau']}")
    check_range(ds, names)


def plot_response(ds: xr.Dataset, ax: "Sequence[Axes] | AxesArray | None" = None) -> "AxesArray":
    """Draw one steady state in time: load, motion in the contact, every mass, friction force.

    Stops are shaded and their starts marked; masses are numbered; the levels of kinetic and static friction
    are labelled.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of `response`.
    ax : array of matplotlib axes, optional
        Axes to draw into, from top to bottom: load (unless loads are given mass by mass), motion in the
        contact, masses (unless a single mass moves with the contact), friction force.

    Returns
    -------
    An array of the axes.

    Raises
    ------
    InputError
        The dataset is not a response or lacks a variable to draw, or the number of axes differs from that of
        the panels.
    """
    ds = to_draw(ds, "plot_response", "response")
    check_holds(ds, ("z", "x", "friction", "direction"), "its motion")
    check_can_be_seen(ds, ("z", "x", "friction"))
    names = _panels(ds)
    if ax is None:
        heights = [_HEIGHTS[name] for name in names]
        figure = new_figure(7.2, 0.78 * sum(heights) + 0.9)
        axes = figure.subplots(len(names), 1, sharex=True, height_ratios=heights)
    else:
        axes = given_axes(ax, len(names), f"for {', '.join(names)}")
    turns = ds["tau"].values / np.pi
    handles = _mark_stops(axes, ds, turns)
    by_name = dict(zip(names, axes, strict=True))
    if "load" in by_name:
        _draw_load(by_name["load"], turns, load_of(ds) or "")
    handles += _draw_contact(by_name["z"], ds, turns)
    if "masses" in by_name:
        _draw_masses(by_name["masses"], ds, turns)
    _draw_friction(by_name["friction"], ds, turns)
    axes[-1].set_xlabel(r"$\tau/\pi$")
    axes[-1].set_xlim(turns[0], turns[-1])
    time_on_top(axes[0], ds)
    if ax is None:
        title_figure(axes[0].figure, title_of(ds))
        legend_below(axes[0].figure, handles, caption(ds))
    return axes
