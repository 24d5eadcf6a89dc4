"""The performance curve: the largest response over friction, and response curves of the answer."""

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from ...datasets.amounts import amounts_of
from ...datasets.physical import ones_of
from ...units.table import UNITS, handy_unit
from ..grids import HIGH
from ..palette import CLASSES, CONTINUOUS, LINES, STUCK
from ..panels import Handle
from ..second_axes import force_on_top, frequency_on_top, on_the_right
from ..words import length_unit

#: Friction and response that are shown, as multiples of those of the answer; curves of the answer are shown
#: up to `_MOST_SHOWN` times its peak.
_FRICTION_SHOWN, _RESPONSE_SHOWN, _MOST_SHOWN = 3.0, 3.0, 4.0

#: Height of the axis over the largest peak of the curves of the answer.
_ABOVE = 1.1

#: Share of the friction that is shaded around the answer, if none is given.
_TOLERANCE = 0.2

#: Blue is the answer, and lighter where its friction may be; brown is a second vertical axis.
ANSWER, _ASIDE, _LIMIT, _OTHER = LINES[0], LINES[1], LINES[4], "#606060"
_TINT = 0.18
_DASHED, _DOTTED = (0, (4, 1.5)), (0, (1.5, 1.2))


def _measure_of(ds: xr.Dataset) -> str:
    """Measure of the response: force or length; nothing of a share."""
    return amounts_of(ds).measure


def _over(ds: xr.Dataset) -> str:
    """What the response is over, after its name."""
    return {"force": " / $P$", "length": f" / {length_unit(ds)}"}.get(_measure_of(ds), "")


def _response_on_the_right(ax: Axes, ds: xr.Dataset) -> None:
    """Add an axis of the response in its unit, if it has one."""
    measure = _measure_of(ds)
    if measure:
        on_the_right(ax, ds, measure, str(ds.attrs["response"]) if measure == "force" else "")


def in_units(ds: xr.Dataset, value: float, measure: str, largest: float) -> str:
    """A friction ratio or a response in the unit of an axis up to `largest`, in brackets; empty if the
    dataset has no units.
    """
    one = ones_of(ds).get(measure)
    if one is None or not np.isfinite(value):
        return ""
    unit = handy_unit(one * largest, measure)
    return f" ({one * value / float(UNITS[unit].size):.4g} {unit.replace('um', 'µm')})"


def _beta(ds: xr.Dataset, value: float) -> str:
    return f"β = {value:.4g}{in_units(ds, value, 'force', _right(ds))}"


def _right(ds: xr.Dataset) -> float:
    """End of the axis of friction."""
    beta, best = ds["beta_search"].values, float(ds["beta"])
    ends = ds["interval_end"].values if "interval_end" in ds else np.empty(0)
    wide = max([_FRICTION_SHOWN * best, *(1.2 * ends[np.isfinite(ends)])])
    return min(float(beta[-1]), wide) if wide > 0.0 else float(beta[-1])


def draw_performance(ax: Axes, ds: xr.Dataset) -> list[Handle]:
    """Draw the curve that was minimised over friction, with the answer, its tolerance and the regimes."""
    beta, size = ds["beta_search"].values, ds["peak_of_beta"].values
    best, least = float(ds["beta"]), float(ds["peak"].values[0])
    right = _right(ds)
    limit = float(ds["limit"]) if "limit" in ds else 0.0
    top = max(_RESPONSE_SHOWN * least, 1.5 * limit) or float(size[np.isfinite(size)].max()) or 1.0
    handles = _draw_ranges(ax, ds, right)
    worst = {"worst_search", "worst_of_beta"} <= set(ds.variables)
    if worst:
        own = ds["worst_of_beta"].values
        handles += _draw_size(ax, ds["worst_search"].values, own, top, {"linewidth": 1.4}, _worst_label(ds))
    thin: dict[str, Any] = {"linewidth": 0.9, "linestyle": _DASHED} if worst else {"linewidth": 1.4}
    handles += _draw_size(ax, beta, size, top, thin, _curve_label(ds))
    ax.plot([best], [least], "o", color=ANSWER, markersize=6.0, zorder=4.0)
    handles.append(Line2D([], [], color=ANSWER, marker="o", linestyle="none", label=_answer_label(ds)))
    if "peak_of_sample" in ds:
        sizes = ds["peak_of_sample"].values
        ax.plot(np.full(sizes.size, best), sizes, "_", color=_OTHER, markersize=9.0, zorder=3.0)
        label = f"{sizes.size} samples at this friction"
        handles.append(Line2D([], [], color=_OTHER, marker="_", linestyle="none", label=label))
    if limit:
        ax.axhline(limit, color=_LIMIT, linewidth=1.1, linestyle=(0, (4, 2)))
        words = f"limit {limit:.4g}{in_units(ds, limit, _measure_of(ds), top)}"
        handles.append(Line2D([], [], color=_LIMIT, linestyle=(0, (4, 2)), label=words))
    ax.set_xlim(0.0, right)
    ax.set_ylim(0.0, top)
    ax.set_xlabel(r"friction ratio $\beta$")
    ax.set_ylabel(f"largest {ds.attrs.get('response', 'response')}{_over(ds)}")
    force_on_top(ax, ds)
    _response_on_the_right(ax, ds)
    return handles


def _draw_size(
    ax: Axes, beta: np.ndarray, size: np.ndarray, top: float, style: dict[str, Any], label: str
) -> list[Handle]:
    """Draw a curve of the largest response, up to about `top`."""
    ax.plot(beta, np.minimum(size, HIGH * top), color="black", **style)
    return [Line2D([], [], color="black", label=label, **style)]


def draw_ridge(ax: Axes, ds: xr.Dataset) -> list[Handle]:
    """Draw the least peak of every ratio of the second contact, and the friction at which it occurs."""
    ratio, best = ds["ratio_search"].values, float(ds["second_ratio"])
    ax.plot(ratio, ds["peak_of_ratio"].values, ".-", color="black", linewidth=1.4)
    ax.plot([best], [float(ds["peak"].values[0])], "o", color=ANSWER, markersize=6.0, zorder=4.0)
    ax.set_xlabel(f"friction of contact {int(ds['second'])} / $\\beta$")
    ax.set_ylabel(f"least peak{_over(ds)}")
    ax.set_ylim(bottom=0.0)
    beside = ax.twinx()
    beside.plot(ratio, ds["beta_of_ratio"].values, color=_ASIDE, linewidth=1.1, linestyle=(0, (4, 2)))
    beside.set_ylabel(r"its friction ratio $\beta$", color=_ASIDE)
    beside.set_ylim(bottom=0.0)
    label = f"least: ratio {best:.4g}"
    return [
        Line2D([], [], color="black", linewidth=1.4, marker=".", label="least peak at each ratio"),
        Line2D([], [], color=_ASIDE, linewidth=1.1, linestyle=(0, (4, 2)), label="its friction"),
        Line2D([], [], color=ANSWER, marker="o", linestyle="none", label=label),
    ]


def _answer_label(ds: xr.Dataset) -> str:
    best, kind = float(ds["beta"]), str(ds["kind"].values) if "kind" in ds else ""
    if kind == "threshold":
        return f"does not move from {_beta(ds, best)} on"
    return f"least: {_beta(ds, best)}" + (f", {kind}" if kind else "")


def _curve_label(ds: xr.Dataset) -> str:
    if "quantile" not in ds:
        exactly = "with exactly this friction" if "worst_of_beta" in ds else "over the band"
        return f"largest response {exactly}"
    return f"largest response over the band, {100.0 * float(ds['quantile']):g} % quantile of the samples"


def _worst_label(ds: xr.Dataset) -> str:
    spread = f" within ± {100.0 * float(ds['spread']):g} % of the friction" if "spread" in ds else ""
    return f"largest response{spread}"


def _draw_ranges(ax: Axes, ds: xr.Dataset, right: float) -> list[Handle]:
    """Shade the friction that is allowed or within the tolerance, without stops, and stuck."""
    handles: list[Handle] = []
    best = float(ds["beta"])

    def shade(low: float, high: float, label: str) -> None:
        if low < right and high > low:
            ax.axvspan(low, min(high, right), color=ANSWER, alpha=_TINT, linewidth=0.0)
            handles.append(Patch(color=ANSWER, alpha=_TINT, linewidth=0.0, label=label))

    if {"interval_begin", "interval_end"} <= set(ds):
        for low, high in zip(ds["interval_begin"].values, ds["interval_end"].values, strict=True):
            shade(float(low), float(high), "friction within the limit")
    elif "quantile" not in ds:
        spread = float(ds["spread"]) if "spread" in ds else _TOLERANCE
        shade(best * (1.0 - spread), best * (1.0 + spread), f"friction ± {100.0 * spread:g} %")
    if "beta_no_stop" in ds and np.isfinite(float(ds["beta_no_stop"])):
        handles += _strip(ax, 0.0, float(ds["beta_no_stop"]), right, CONTINUOUS, "no stops in the band")
    if "beta_stuck" in ds and np.isfinite(float(ds["beta_stuck"])):
        handles += _strip(ax, float(ds["beta_stuck"]), right, right, STUCK, "sticks over the whole band")
    return handles


def _strip(ax: Axes, low: float, high: float, right: float, of: int, label: str) -> list[Handle]:
    """A strip at the foot of the panel in the colour of a class."""
    if not low < min(high, right):
        return []
    style: dict[str, Any] = {"facecolor": CLASSES[of].colour, "edgecolor": "black", "linewidth": 0.6}
    ax.axvspan(low, min(high, right), 0.0, 0.03, zorder=3.0, **style)
    return [Patch(label=label, **style)]


def _curve_style(level: float, best: float) -> dict[str, Any]:
    """Style of a response curve by its friction: blue at the answer, black around it, else grey."""
    if np.isinf(level) or level == 0.0:
        return {"color": "#808080", "linewidth": 1.1, "linestyle": ":" if np.isinf(level) else "-"}
    if abs(level - best) <= 1e-9 * best:
        return {"color": ANSWER, "linewidth": 1.6}
    return {"color": "black", "linewidth": 1.1, "linestyle": _DASHED if level < best else _DOTTED}


def draw_responses(ax: Axes, ds: xr.Dataset) -> list[Handle]:
    """Draw response curves at the answer, below and above it, without friction, and stuck.

    Of uncertain structures they are those of the nominal one, and that of the sample that decides.
    """
    r, best = ds["r_search"].values, float(ds["beta"])
    levels, curves = ds["curve"].values.tolist(), ds["response_of_r"].values
    of_sample = ds["response_of_sample"].values if "response_of_sample" in ds else None
    own = [curve for level, curve in zip(levels, curves, strict=True) if 0.0 < level < np.inf]
    top = _top(float(ds["peak"].values[0]), [*own, *([] if of_sample is None else [of_sample])])
    handles: list[Handle] = []

    def draw(curve: np.ndarray, label: str, style: dict[str, Any]) -> None:
        ax.plot(r, np.minimum(np.where(np.isnan(curve), np.inf, curve), HIGH * top), **style)
        handles.append(Line2D([], [], label=label, **style))

    nominal = ", nominal" if of_sample is not None else ""
    for level, curve in zip(levels, curves, strict=True):
        words = "stuck" if np.isinf(level) else _beta(ds, level) if level else "without friction"
        style = _curve_style(level, best)
        if nominal and style["color"] == ANSWER:
            style["color"] = "black"
        draw(curve, words + nominal, style)
    if of_sample is not None:
        draw(
            of_sample,
            f"{_beta(ds, best)}, sample {int(ds['deciding_sample'])}",
            {"color": ANSWER, "linewidth": 1.6},
        )
    if "peak_r" in ds:
        ax.plot(ds["peak_r"].values, ds["peak"].values, "o", color=ANSWER, markersize=4.5, clip_on=True)
    ax.set_xlim(r[0], r[-1])
    ax.set_ylim(0.0, top)
    ax.set_xlabel(r"frequency ratio $r$")
    ax.set_ylabel(f"{ds.attrs.get('response', 'response')}{_over(ds)}")
    frequency_on_top(ax, ds.rename(r_search="r"))
    _response_on_the_right(ax, ds)
    return handles


def _top(peak: float, curves: list[np.ndarray]) -> float:
    """End of the axis of responses: the curves of the answer are not cut off, unless they are much higher."""
    sizes = [curve[np.isfinite(curve)].max(initial=0.0) for curve in curves]
    least = 1.5 * peak
    inside = [size for size in sizes if not peak or size <= _MOST_SHOWN * peak]
    return float(max([least, *(_ABOVE * size for size in inside)])) or 1.0
