"""The performance curve: the largest response over friction, and response curves of the answer."""

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from ..grids import HIGH
from ..palette import CLASSES, CONTINUOUS, LINES, STUCK
from ..panels import Handle
from ..second_axes import force_on_top, frequency_on_top, on_the_right

#: Friction and response that are shown, as multiples of those of the answer.
_FRICTION_SHOWN, _RESPONSE_SHOWN = 3.0, 3.0

#: Share of the friction that is shaded around the answer, if none is given.
_TOLERANCE = 0.2

_ANSWER, _ASIDE, _LIMIT = LINES[0], LINES[3], LINES[4]
_DASHES = {0.5: (0, (4, 1.5)), 1.0: "-", 2.0: (0, (1.5, 1.2))}


def _measure_of(ds: xr.Dataset) -> str:
    """Measure of the response: force or length."""
    return "force" if "force" in str(ds.attrs.get("response", "")) else "length"


def _unit_of(ds: xr.Dataset) -> str:
    return "/ $P$" if _measure_of(ds) == "force" else "/ $(P/k_1)$"


def draw_performance(ax: Axes, ds: xr.Dataset) -> list[Handle]:
    """Draw the largest response over friction, with the answer, its tolerance, and ranges of regimes."""
    beta, size = ds["beta_search"].values, ds["peak_of_beta"].values
    best, least = float(ds["beta"]), float(ds["peak"].values[0])
    ends = ds["interval_end"].values if "interval_end" in ds else np.empty(0)
    wide = max([_FRICTION_SHOWN * best, *(1.2 * ends[np.isfinite(ends)])])
    right = min(float(beta[-1]), wide) if wide > 0.0 else float(beta[-1])
    limit = float(ds["limit"]) if "limit" in ds else 0.0
    top = max(_RESPONSE_SHOWN * least, 1.5 * limit) or float(size[np.isfinite(size)].max()) or 1.0
    handles = _draw_ranges(ax, ds, right)
    ax.plot(beta, np.minimum(size, HIGH * top), color="black", linewidth=1.4)
    handles.append(Line2D([], [], color="black", linewidth=1.4, label=_curve_label(ds)))
    ax.plot([best], [least], "o", color=_ANSWER, markersize=6.0, zorder=4.0)
    handles.append(Line2D([], [], color=_ANSWER, marker="o", linestyle="none", label=_answer_label(ds)))
    if "peak_of_sample" in ds:
        sizes = ds["peak_of_sample"].values
        ax.plot(np.full(sizes.size, best), sizes, "_", color=_ANSWER, markersize=9.0, zorder=3.0)
        label = f"{sizes.size} samples at this friction"
        handles.append(Line2D([], [], color=_ANSWER, marker="_", linestyle="none", label=label))
    if limit:
        ax.axhline(limit, color=_LIMIT, linewidth=1.1, linestyle=(0, (4, 2)))
        handles.append(Line2D([], [], color=_LIMIT, linestyle=(0, (4, 2)), label=f"limit {limit:.4g}"))
    ax.set_xlim(0.0, right)
    ax.set_ylim(0.0, top)
    ax.set_xlabel(r"friction ratio $\beta$")
    ax.set_ylabel(f"largest {ds.attrs.get('response', 'response')} {_unit_of(ds)}")
    force_on_top(ax, ds)
    on_the_right(ax, ds, _measure_of(ds))
    return handles


def draw_ridge(ax: Axes, ds: xr.Dataset) -> list[Handle]:
    """Draw the least peak of every ratio of the second contact, and the friction at which it occurs."""
    ratio, best = ds["ratio_search"].values, float(ds["second_ratio"])
    ax.plot(ratio, ds["peak_of_ratio"].values, ".-", color="black", linewidth=1.4)
    ax.plot([best], [float(ds["peak"].values[0])], "o", color=_ANSWER, markersize=6.0, zorder=4.0)
    ax.set_xlabel(f"friction of contact {int(ds['second'])} / $\\beta$")
    ax.set_ylabel(f"least peak {_unit_of(ds)}")
    ax.set_ylim(bottom=0.0)
    beside = ax.twinx()
    beside.plot(ratio, ds["beta_of_ratio"].values, color=_ASIDE, linewidth=1.1, linestyle=(0, (4, 2)))
    beside.set_ylabel(r"its friction ratio $\beta$", color=_ASIDE)
    beside.set_ylim(bottom=0.0)
    label = f"least: ratio {best:.4g}"
    return [
        Line2D([], [], color="black", linewidth=1.4, marker=".", label="least peak at each ratio"),
        Line2D([], [], color=_ASIDE, linewidth=1.1, linestyle=(0, (4, 2)), label="its friction"),
        Line2D([], [], color=_ANSWER, marker="o", linestyle="none", label=label),
    ]


def _answer_label(ds: xr.Dataset) -> str:
    best, kind = float(ds["beta"]), str(ds["kind"].values) if "kind" in ds else ""
    if kind == "threshold":
        return f"does not move from β = {best:.4g} on"
    return f"least: β = {best:.4g}" + (f" ({kind})" if kind else "")


def _curve_label(ds: xr.Dataset) -> str:
    if "quantile" not in ds:
        return "largest response over the band"
    return f"largest response over the band, {100.0 * float(ds['quantile']):g} % quantile of the samples"


def _draw_ranges(ax: Axes, ds: xr.Dataset, right: float) -> list[Handle]:
    """Shade the friction that is allowed or within the tolerance, without stops, and stuck."""
    handles: list[Handle] = []
    best = float(ds["beta"])

    def shade(low: float, high: float, colour: str, label: str, alpha: float = 0.35) -> None:
        if low < right and high > low:
            ax.axvspan(low, min(high, right), color=colour, alpha=alpha, linewidth=0.0)
            handles.append(Patch(color=colour, alpha=alpha, linewidth=0.0, label=label))

    if {"interval_begin", "interval_end"} <= set(ds):
        for low, high in zip(ds["interval_begin"].values, ds["interval_end"].values, strict=True):
            shade(float(low), float(high), _ASIDE, "within the limit")
    elif "quantile" not in ds:
        spread = float(ds["spread"]) if "spread" in ds else _TOLERANCE
        shade(best * (1.0 - spread), best * (1.0 + spread), _ASIDE, f"friction ± {100.0 * spread:g} %")
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


def draw_responses(ax: Axes, ds: xr.Dataset) -> list[Handle]:
    """Draw response curves at the answer, at half and twice its friction, without friction, and stuck."""
    r, best = ds["r_search"].values, float(ds["beta"])
    top = _RESPONSE_SHOWN * float(ds["peak"].values[0]) or 1.0
    handles: list[Handle] = []
    for level, curve in zip(ds["curve"].values.tolist(), ds["response_of_r"].values, strict=True):
        share = level / best if best > 0.0 else 0.0
        known = next((one for one in _DASHES if abs(share - one) < 1e-9), None)
        style: dict[str, Any] = (
            {"color": _ANSWER, "linestyle": _DASHES[known]} if known else {"color": "#808080"}
        )
        label = f"β = {level:.4g}"
        if not known:
            style["linestyle"] = ":" if np.isinf(level) else "-"
            label = "stuck" if np.isinf(level) else "without friction"
        shown = np.minimum(np.where(np.isnan(curve), np.inf, curve), HIGH * top)
        ax.plot(r, shown, linewidth=1.6 if known == 1.0 else 1.1, **style)
        handles.append(Line2D([], [], label=label, **style))
    if "peak_r" in ds:
        ax.plot(ds["peak_r"].values, ds["peak"].values, "o", color=_ANSWER, markersize=4.5, clip_on=True)
    ax.set_xlim(r[0], r[-1])
    ax.set_ylim(0.0, top)
    ax.set_xlabel(r"frequency ratio $r$")
    ax.set_ylabel(f"{ds.attrs.get('response', 'response')} {_unit_of(ds)}")
    frequency_on_top(ax, ds.rename(r_search="r"))
    on_the_right(ax, ds, _measure_of(ds))
    return handles
