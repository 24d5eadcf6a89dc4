"""Pictures of one steady state in time."""

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Unpack

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from ... import regimes
from ...datasets.labels import regime_of_choice
from ...errors import InputError
from ..drawing import with_options
from ..marks import spread
from ..options import FigureOptions, current
from ..palette import CLASSES, LINES, OPEN_COLOUR, OPEN_HATCH, OPEN_LABEL, STUCK, Shade, in_turn
from ..panels import Handle, given_axes, halo, legend_below, legend_under, new_figure, title_figure
from ..second_axes import in_brackets, on_the_right, time_on_top
from ..shapes import check_holds, check_range, to_draw
from ..sizes import points
from ..words import caption, length_unit, load_of, moves_base, name_of_contact, symbols_of_masses
from .loops import draw_loop
from .traces import ROUNDING, Trace, at_rest, is_at_rest, is_cosine, levels_of, load_trace, traces_of

if TYPE_CHECKING:
    from ..panels import AxesArray


#: Height of the panels: load, motion in the contact, masses, friction, normal forces, forces of springs.
_HEIGHTS = {"load": 1.0, "z": 2.4, "masses": 3.0, "friction": 2.2, "normal": 1.8, "springs": 1.8}

#: Height of a row of the panel that shows when each of several contacts is stuck.
_BAR = 0.3

#: Width of the traces, and of the hysteresis loop beside them [inch].
_WIDTH, _LOOP_WIDTH = 7.2, 4.4

#: Name of the panel beside the traces.
_LOOP = "hysteresis loop"

#: Labels next to lines: least distance as a share of the panel's height, and largest number.
_GAP, MOST_LABELS = 0.09, 11

_OPEN_SHADE: Shade = {"color": OPEN_COLOUR, "alpha": 0.55, "linewidth": 0.0}
_SHADE: Shade = {"color": CLASSES[STUCK].colour, "alpha": 0.55, "linewidth": 0.0}
#: Size of the marks of events.
_DOT = 4.5
_LOAD_COLOUR = "#cc1f03"

_REGIME_WORDS = {
    regimes.UNRESOLVED: "unresolved",
    regimes.PERMANENT_STICKING: "permanent sticking",
    regimes.STICK_SLIP: "stick-slip",
    regimes.CONTINUOUS: "continuous",
    regimes.ONE_WAY_SLIDING: "one-way sliding",
}
_ELASTIC_WORDS = _REGIME_WORDS | {
    regimes.PERMANENT_STICKING: "no slip",
    regimes.STICK_SLIP: "slips",
    regimes.CONTINUOUS: "slips without rest",
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
            va="center", fontsize=points(8.0), color=colour, **aside,
        )  # fmt: skip


def _set_limits_around(ax: Axes, values: np.ndarray) -> None:
    """Set the limits of a vertical axis around values; a constant appears as a level line, not as its
    rounding error.
    """
    low, high = float(values.min()), float(values.max())
    half = 0.56 * (high - low)
    if is_at_rest(values):
        half = 0.5
    ax.set_ylim(0.5 * (low + high) - half, 0.5 * (low + high) + half)


def _maxima(ds: xr.Dataset, load: np.ndarray) -> np.ndarray:
    """Where the load is largest in sight, tau/pi, once per period; none for a load that is constant.

    The phase of every load of one harmonic is counted from its maximum.
    """
    turns = ds["tau"].values / np.pi
    if is_cosine(ds):
        return np.arange(2.0 * np.ceil(turns[0] / 2.0 - 1e-9), turns[-1] + 1e-9, 2.0)
    if np.ptp(load) <= ROUNDING:
        return np.empty(0)
    period = turns < turns[0] + 2.0 - 1e-9
    first = float(turns[period][np.argmax(load[period] >= load.max() - ROUNDING)])
    return np.arange(first, turns[-1] + 1e-9, 2.0)


def _draw_load(ax: Axes, ds: xr.Dataset, turns: np.ndarray) -> None:
    load = load_trace(ds)
    ax.plot(turns, load, color="black", linewidth=1.0)
    tops = _maxima(ds, load)
    if tops.size:  # a line without points that is not clipped makes the layout fail
        height = np.full(tops.size, load.max())
        ax.plot(tops, height, "v", color=_LOAD_COLOUR, markersize=5.0, clip_on=False)
    if abs(float(load.max()) - 1.0) <= ROUNDING and abs(float(load.min()) + 1.0) <= ROUNDING:
        ax.set_ylim(-1.25, 1.25)
    else:
        _set_limits_around(ax, load)
    ax.set_ylabel(load_of(ds) or "load / $P$")


def _draw_contacts(ax: Axes, ds: xr.Dataset, turns: np.ndarray, traces: Sequence[Trace]) -> list[Handle]:
    """Draw the motion in every contact, with the starts of its stops."""
    for trace in traces:
        ax.plot(turns, trace.z, color=trace.colour)
    _set_limits_around(ax, np.concatenate([trace.z for trace in traces]))
    ax.set_ylabel(f"contact\n$z$ / {length_unit(ds)}")
    on_the_right(ax, ds, "length", "$z$")
    handles: list[Handle] = [
        Line2D([], [], color=trace.colour, label=trace.label) for trace in traces if trace.label
    ]
    kinds = []
    for trace in traces:
        times, places = trace.stops
        if times.size:
            kinds.append("slip ends" if trace.elastic else "stop begins")
            ax.plot(
                times / np.pi,
                places,
                "o",
                color=trace.colour,
                markersize=_DOT,
                clip_on=False,
                label=kinds[-1],
            )
    if kinds:
        label = ", ".join(dict.fromkeys(kinds))
        handles.append(
            Line2D([], [], color="black", label=label, marker="o", linestyle="none", markersize=_DOT)
        )
    return handles


def _draw_stuck(ax: Axes, turns: np.ndarray, traces: Sequence[Trace]) -> None:
    """Draw a bar for each contact while it is stuck."""
    for row, trace in enumerate(traces):
        ax.fill_between(
            turns, row - 0.36, row + 0.36, where=trace.stuck.tolist(), color=trace.colour, linewidth=0.0
        )
        if trace.opened.any():
            ax.fill_between(
                turns, row - 0.36, row + 0.36, where=trace.opened.tolist(), facecolor="none",
                edgecolor=trace.colour, hatch=OPEN_HATCH, linewidth=0.0,
            )  # fmt: skip
    ax.set_yticks(range(len(traces)), [str(trace.number) for trace in traces])
    ax.set_ylim(len(traces) - 0.5, -0.5)
    slips = any(trace.elastic for trace in traces)
    ax.set_ylabel("no slip" if slips else "stuck", rotation=0, ha="right", va="center")


def _draw_masses(ax: Axes, ds: xr.Dataset, turns: np.ndarray) -> None:
    """Draw every mass, with its number at the end of its line; of many masses some are numbered."""
    x = np.array([at_rest(one) for one in ds["x"].values])
    names, colours = symbols_of_masses(ds), in_turn(LINES, len(x))
    for place, colour in zip(x, colours, strict=True):
        ax.plot(turns, place, color=colour, linewidth=1.2)
    _set_limits_around(ax, x)
    on_the_right(ax, ds, "length", "$x$")
    ax.set_ylabel(f"{'points' if 'point_name' in ds.coords else 'masses'}\n$x$ / {length_unit(ds)}")
    labelled = np.unique(np.linspace(0, len(x) - 1, min(len(x), MOST_LABELS)).round().astype(int))
    _label_beside(ax, x[labelled, -1], [names[k] for k in labelled], [colours[k] for k in labelled])


def _friction_levels(ds: xr.Dataset, trace: Trace) -> tuple[dict[str, float], np.ndarray | None]:
    """Levels of friction by their symbols, and the factor of the normal load."""
    levels = levels_of(ds, trace)
    if levels is None:
        return {}, None
    index = f"_{{{trace.number}}}" if trace.number else ""
    if levels.over_normal:
        found = {rf"\varphi N{index}": levels.kinetic}
        if levels.static > levels.kinetic:
            found[rf"\mu{index}\varphi N{index}"] = levels.static
        return found, levels.factor
    found = {rf"\beta{index}": levels.kinetic}
    if levels.static > levels.kinetic:
        found[rf"\mu{index}\beta{index}"] = levels.static
    return found, levels.factor


def _draw_levels(
    ax: Axes, turns: np.ndarray, levels: np.ndarray, factor: np.ndarray | None, colour: str
) -> None:
    """Draw levels of friction, which follow the normal load."""
    for level in np.unique(levels):
        if factor is None:
            ax.axhline(level, color=colour, linewidth=0.9, linestyle=":")
        else:
            ax.plot(turns, level * factor, color=colour, linewidth=0.9, linestyle=":")


def _draw_friction(ax: Axes, ds: xr.Dataset, turns: np.ndarray, traces: Sequence[Trace]) -> None:
    """Draw the friction force of every contact between its kinetic and static levels."""
    places, texts, colours, seen = [], [], [], []
    for trace in traces:
        colour = trace.colour
        ax.plot(turns, trace.friction, color=colour, linewidth=1.2)
        names, factor = _friction_levels(ds, trace)
        levels = np.array([sign * level for level in names.values() for sign in (1.0, -1.0)])
        _draw_levels(ax, turns, levels, factor, trace.colour if trace.label else "#606060")
        places += [*(levels if factor is None else levels * factor[-1])]
        texts += [f"${sign}{name}$" for name in names for sign in ("", "-")]
        colours += [colour] * levels.size
        seen += [trace.friction, levels if factor is None else np.outer(levels, factor).ravel()]
    together = np.concatenate(seen)
    _set_limits_around(ax, together[np.isfinite(together)])
    on_the_right(ax, ds, "force", "friction")
    _label_beside(ax, np.array(places), texts, colours)
    ax.set_ylabel("friction / $P$")


def _draw_normal(ax: Axes, ds: xr.Dataset, turns: np.ndarray, traces: Sequence[Trace]) -> None:
    """Draw the normal forces that move with the structure."""
    for trace in traces:
        if trace.normal is not None:
            ax.plot(turns, trace.normal, color=trace.colour, linewidth=1.2)
    ax.set_ylim(bottom=0.0)
    on_the_right(ax, ds, "force", "normal force")
    ax.set_ylabel("normal\nforce / $P$")


def _draw_springs(ax: Axes, ds: xr.Dataset, turns: np.ndarray) -> None:
    """Draw the forces of piecewise linear springs, with their numbers at the ends of the lines."""
    forces = np.atleast_2d(ds["spring_force"].values)
    colours = in_turn(LINES, len(forces))
    for force, colour in zip(forces, colours, strict=True):
        ax.plot(turns, force, color=colour, linewidth=1.2)
    _set_limits_around(ax, forces)
    on_the_right(ax, ds, "force", "springs")
    if len(forces) > 1:
        _label_beside(ax, forces[:, -1], [str(k + 1) for k in range(len(forces))], colours)
    ax.set_ylabel("springs\nforce / $P$")


def _mark_stops(
    axes: Sequence[Axes], ds: xr.Dataset, turns: np.ndarray, traces: Sequence[Trace]
) -> list[Handle]:
    """Mark maxima of the load with dotted lines in all panels; shade stops of a single contact."""
    maxima = _maxima(ds, load_trace(ds))
    inside = maxima[(maxima > 1e-9) & (maxima < turns[-1] - 1e-9)]
    for ax in axes:
        for turn in inside:
            ax.axvline(turn, color=_LOAD_COLOUR, linewidth=1.0, linestyle=(0, (1, 2)), zorder=0.7)
    handles = _shade_stops(axes, ds, turns, traces[0]) if len(traces) == 1 else []
    handles += _shade_open(axes, turns, traces)
    words = "maximum of the load (of the base's motion)" if moves_base(ds) else "maximum of the load"
    handles.append(
        Line2D([], [], color=_LOAD_COLOUR, label=words, marker="v", markersize=5.0, linestyle=(0, (1, 2)))
    )
    return handles


def _shade_open(axes: Sequence[Axes], turns: np.ndarray, traces: Sequence[Trace]) -> list[Handle]:
    """Shade in all panels when a single contact is open; the bars of several show it."""
    if not any(trace.opened.any() for trace in traces):
        return []
    if len(traces) > 1:
        return [Patch(facecolor="none", edgecolor="black", hatch=OPEN_HATCH, linewidth=0.0, label=OPEN_LABEL)]
    opened = traces[0].opened.tolist()
    for ax in axes:
        transform = ax.get_xaxis_transform()
        ax.fill_between(turns, 0, 1, where=opened, transform=transform, zorder=0.4, **_OPEN_SHADE)
    return [Patch(**_OPEN_SHADE, label=OPEN_LABEL)]


def _shade_stops(axes: Sequence[Axes], ds: xr.Dataset, turns: np.ndarray, trace: Trace) -> list[Handle]:
    """Shade the stops of a single contact in all panels."""
    for ax in axes:
        transform = ax.get_xaxis_transform()
        ax.fill_between(turns, 0, 1, where=trace.stuck.tolist(), transform=transform, zorder=0.5, **_SHADE)
    if not trace.stuck.any():
        return []
    if trace.elastic:
        return [Patch(**_SHADE, label="no slip")]
    regime = _regime_of(ds)
    stuck = regime == regimes.PERMANENT_STICKING if regime is not None else bool(trace.stuck.all())
    return [Patch(**_SHADE, label="permanent sticking" if stuck else "stop")]


def _regime_of(ds: xr.Dataset) -> int | None:
    """Regime of a steady state: of the contact that was chosen, or of all; None if the file has none."""
    name = regime_of_choice(ds)
    return int(ds[name]) if name in ds else None


def _counts(ds: xr.Dataset) -> str:
    """Numbers of stops, or of slips, per cycle of all contacts; empty if there are none."""
    found: list[tuple[str, str]] = []
    names = {"stops_per_cycle": "stops", "slips_per_cycle": "slips"}
    rows = {word: np.atleast_1d(ds[name].values) for name, word in names.items() if name in ds}
    for of_contact in zip(*rows.values(), strict=True):
        known = [(f"{n:.4g}", word) for n, word in zip(of_contact, rows, strict=True) if np.isfinite(n)]
        found += known[:1] or [("0", "stops")]
    if not any(number != "0" for number, _ in found):
        return ""
    if len({word for _, word in found}) == 1:
        return f", {_counted([number for number, _ in found], found[0][1])} per cycle"
    return f", {' and '.join(_counted([number], word) for number, word in found)} per cycle"


def _counted(numbers: list[str], word: str) -> str:
    """The numbers and what they count, which is one if the only number is 1."""
    return f"{' and '.join(numbers)} {word.removesuffix('s') if numbers == ['1'] else word}"


def _separations(ds: xr.Dataset) -> str:
    """Numbers of separations per cycle of all contacts that can open; empty if there are none."""
    if "separations_per_cycle" not in ds:
        return ""
    found = np.atleast_1d(ds["separations_per_cycle"].values)
    found = found[np.isfinite(found)]
    numbers = [f"{n:.4g}" for n in found]
    return f", {_counted(numbers, 'separations')} per cycle" if found.any() else ""


def title_of(ds: xr.Dataset) -> str:
    """Title with the cell and its result."""
    symbols = {"r": "r", "beta": "β", "mu": "μ"}
    cell = ", ".join(
        f"{symbol} = {float(ds[name]):.6g}{in_brackets(ds, name)}" for name, symbol in symbols.items()
    )
    contact = name_of_contact(ds)
    if contact:
        cell = f"{cell}, {contact}"
    regime = _regime_of(ds)
    if regime is None:
        return cell
    elastic = all(trace.elastic for trace in traces_of(ds)) if "z" in ds and "friction" in ds else False
    words = (_ELASTIC_WORDS if elastic else _REGIME_WORDS)[regime]
    counted = _counts(ds) + _separations(ds)
    if "status" in ds and int(ds["status"]) in regimes.WITHOUT_PERIOD:
        return f"{cell}: {words}{counted}, irregular, excerpt"
    period = int(ds["period"]) if "period" in ds else 1
    return f"{cell}: {words}{counted}" + (f", period {period}" if period > 1 else "")


def is_a_mass(ds: xr.Dataset, trace: Trace) -> bool:
    """Whether a mass moves with a contact."""
    return any(np.allclose(x, trace.z, rtol=0.0, atol=1e-12) for x in ds["x"].values)


def _panels(ds: xr.Dataset, traces: Sequence[Trace]) -> dict[str, float]:
    """Panels of a steady state, and their heights.

    A single mass that moves with its contact has no panel of its own.
    """
    same = ds.sizes["dof"] == 1 and any(is_a_mass(ds, trace) for trace in traces)
    there = {
        "load": "load" in ds or load_of(ds) is not None,
        "z": True,
        "stuck": len(traces) > 1,
        "masses": not same,
        "friction": True,
        "normal": any(trace.normal is not None for trace in traces),
        "springs": "spring_force" in ds,
    }
    heights = {**_HEIGHTS, "stuck": _BAR * (len(traces) + 1)}
    return {name: heights[name] for name, shown in there.items() if shown}


def _new_axes(heights: Sequence[float], beside: bool) -> "AxesArray":
    """Create a figure with panels from top to bottom, and one beside them if there is a loop."""
    height = 0.78 * sum(heights) + 0.9
    if beside and (not heights or current().columns(2) == 1):
        return _with_loop_below(heights)
    if not beside:
        figure = new_figure(_WIDTH, height)
        return np.atleast_1d(figure.subplots(len(heights), 1, sharex=True, height_ratios=heights))
    figure = new_figure(_WIDTH + _LOOP_WIDTH, height)
    grid = figure.add_gridspec(len(heights), 2, height_ratios=heights, width_ratios=(_WIDTH, _LOOP_WIDTH))
    traces = [figure.add_subplot(grid[0, 0])]
    for row in range(1, len(heights)):
        traces.append(figure.add_subplot(grid[row, 0], sharex=traces[0]))
    for ax in traces[:-1]:
        ax.tick_params(labelbottom=False)
    loop = figure.add_subplot(grid[:, 1])
    loop.set_box_aspect(1.0)
    return np.array([*traces, loop], dtype=object)


def _with_loop_below(heights: Sequence[float]) -> "AxesArray":
    """Create a figure with panels from top to bottom, and that of the loop below them."""
    figure = new_figure(_WIDTH, 0.78 * sum(heights) + 0.9 + _LOOP_WIDTH)
    traces: list[Axes] = []
    loop = _LOOP_WIDTH / 0.78
    grid = figure.add_gridspec(len(heights) + 1, 1, height_ratios=(*heights, loop))
    for row in range(len(heights)):
        traces.append(figure.add_subplot(grid[row, 0], sharex=traces[0] if traces else None))
    for ax in traces[:-1]:
        ax.tick_params(labelbottom=False)
    return np.array([*traces, figure.add_subplot(grid[-1, 0])], dtype=object)


def check_can_be_seen(ds: xr.Dataset, names: Iterable[str]) -> None:
    """Refuse a single instant, and variables beyond the range of an axis."""
    if ds.sizes["tau"] < 2:
        raise InputError(f"a response must have two tau or more to be drawn; got {ds.sizes['tau']}")
    check_range(ds, names)


@with_options
def plot_response(
    ds: xr.Dataset,
    ax: "Sequence[Axes] | AxesArray | None" = None,
    **options: Unpack[FigureOptions],
) -> "AxesArray":
    """Draw one steady state in time: load, motion in the contact, every mass, friction force.

    Stops are shaded and their starts marked; masses are numbered; the levels of kinetic and static friction
    are labelled.  Several contacts have one colour each, and bars show when each is stuck.  For contacts with
    a spring the hysteresis loop is drawn beside the traces.  Normal forces that move with the structure and
    forces of piecewise linear springs have panels of their own, and times at which a contact is open are
    shaded.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of `response`.
    ax : array of matplotlib axes, optional
        Axes to draw into, from top to bottom: load (unless loads are given mass by mass), motion in the
        contact, bars of several contacts, masses (unless a single mass moves with the contact), friction
        force, normal forces and forces of piecewise linear springs (if there are any), hysteresis loop (if a
        contact has a spring).

    Returns
    -------
    An array of the axes.

    Raises
    ------
    InputError
        The dataset is not a response or lacks a variable to draw, or the number of axes differs from that of
        the panels.

    Examples
    --------
    Panels of the load, the displacement in the contact and the friction:

    >>> import frictionmap as fm
    >>> ds = fm.response(fm.System(), 0.3, 0.5)
    >>> fm.plot_response(ds).size
    3
    """
    ds = to_draw(ds, "plot_response", "response")
    check_holds(ds, ("z", "x", "friction", "direction"), "its motion")
    check_can_be_seen(ds, ("z", "x", "friction"))
    traces = traces_of(ds)
    heights = _panels(ds, traces)
    elastic = [trace for trace in traces if trace.elastic]
    names = current().chosen([*heights, *[_LOOP] * bool(elastic)])
    heights = {name: height for name, height in heights.items() if name in names}
    elastic = elastic if _LOOP in names else []
    if ax is None:
        axes = _new_axes([*heights.values()], bool(elastic))
    else:
        axes = given_axes(ax, len(names), f"for {', '.join(names)}")
    over_tau, beside = axes[: len(heights)], axes[len(heights) :]
    handles = _draw_traces(dict(zip(heights, over_tau, strict=True)), ds, traces) if heights else []
    for one in beside:
        draw_loop(one, ds, elastic)
    if ax is None:
        title_figure(axes[0].figure, title_of(ds))
        legend_below(axes[0].figure, handles, caption(ds))
    else:
        legend_under(axes[-1], handles)
    return axes


def _draw_traces(axes: dict[str, Axes], ds: xr.Dataset, traces: Sequence[Trace]) -> list[Handle]:
    """Draw the panels over tau; return entries for the legend."""
    turns = ds["tau"].values / np.pi
    handles = _mark_stops([*axes.values()], ds, turns, traces)
    if "load" in axes:
        _draw_load(axes["load"], ds, turns)
    if "z" in axes:
        handles += _draw_contacts(axes["z"], ds, turns, traces)
    if "stuck" in axes:
        _draw_stuck(axes["stuck"], turns, traces)
    if "masses" in axes:
        _draw_masses(axes["masses"], ds, turns)
    if "friction" in axes:
        _draw_friction(axes["friction"], ds, turns, traces)
    if "normal" in axes:
        _draw_normal(axes["normal"], ds, turns, traces)
    if "springs" in axes:
        _draw_springs(axes["springs"], ds, turns)
    over_tau = [*axes.values()]
    first, last = over_tau[0], over_tau[-1]
    last.set_xlabel(r"$\tau/\pi$")
    last.set_xlim(turns[0], turns[-1])
    time_on_top(first, ds)
    return handles
