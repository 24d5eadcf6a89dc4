"""Pictures: regime maps, boundaries, one response in time."""

import textwrap
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.patheffects import AbstractPathEffect, withStroke

from . import regimes
from .errors import InputError
from .reading import kind

if TYPE_CHECKING:
    from matplotlib.axes import Axes

FORMATS = (".png", ".pdf", ".svg")


#: Classes of cells in a map, label and colour: from continuous on the colour falls in lightness with the
#: number of stops, so that it survives grey printing, and runs from yellow to blue, so that it survives
#: colour blindness.
_CLASSES = (
    ("unresolved", "#d7301f"),
    ("permanent sticking", "#c8c8c8"),
    ("continuous", "#ffffff"),
    ("1 stop", "#fbe45b"),
    ("2 stops", "#7cc5b0"),
    ("3 stops", "#3f8fb5"),
    ("4 stops", "#2c5aa0"),
    ("more stops", "#1b1f5c"),
    ("stops per cycle not whole", "#b04fa3"),
    ("stick-slip, not counted", "#d9a066"),
    ("stuck or unresolved", "#c8c8c8"),
)
_UNRESOLVED, _STUCK, _CONTINUOUS, _ONE, _MORE, _BROKEN, _UNCOUNTED, _NO_STOPS = 0, 1, 2, 3, 7, 8, 9, 10

_PALE = "#e3eff8"
_COARSE = 120

#: Panels of one figure; more cannot be read, and would not fit in memory.
MOST_PANELS = 60

_LIM: dict[str, Any] = {"color": "black", "linewidth": 1.4, "label": r"$\beta_\mathrm{lim}$"}
_STICK: dict[str, Any] = {
    "color": "black",
    "linewidth": 1.4,
    "linestyle": (0, (4, 2)),
    "label": r"$\beta_\mathrm{stick}$",
}

_MODAL: dict[str, Any] = {
    "color": "#b04fa3",
    "linewidth": 1.0,
    "linestyle": ":",
    "label": "lower bound, sum of modal maxima",
}


_SEVERAL: dict[str, Any] = {"hatch": "////", "edgecolor": "#404040", "linewidth": 0.0}


def _halo() -> list[AbstractPathEffect]:
    return [withStroke(linewidth=3.0, foreground="white")]


def _stops_classes(stops: np.ndarray) -> np.ndarray:
    """The class of cells that stop; NaN is a motion without a number of stops, as at r = 0."""
    nearest = np.rint(np.nan_to_num(stops))
    found = np.clip(_ONE - 1 + nearest, _ONE, _MORE).astype(int)
    found[stops != nearest] = _BROKEN
    found[np.isnan(stops)] = _UNCOUNTED
    return found


def classes(ds: xr.Dataset) -> np.ndarray:
    """The class of every cell of one mu: an index into the legend, shape (r, beta).

    The regime decides; among stick-slip motions, the number of stops.  A map without regimes tells
    continuous (no stops) from stick-slip, but not stuck from unresolved.  A map without numbers of stops
    has one class of stick-slip.
    """
    shape = (ds.sizes["r"], ds.sizes["beta"])
    stops = ds["stops_per_cycle"].values if "stops_per_cycle" in ds else np.full(shape, np.nan)
    if "regime" in ds:
        regime = ds["regime"].values
        found = np.full(shape, _UNRESOLVED)
        found[regime == regimes.PERMANENT_STICKING] = _STUCK
        found[regime == regimes.CONTINUOUS] = _CONTINUOUS
        slip = regime == regimes.STICK_SLIP
    else:
        found = np.full(shape, _NO_STOPS)
        found[stops == 0.0] = _CONTINUOUS
        slip = stops > 0.0
    found[slip] = _stops_classes(stops[slip])
    return found


def _edges(centres: np.ndarray) -> np.ndarray:
    """Edges of the cells around the grid points."""
    if centres.size == 1:
        half = 0.5 * abs(centres[0]) or 0.5
        return np.array([centres[0] - half, centres[0] + half])
    middle = 0.5 * (centres[1:] + centres[:-1])
    ends = 1.5 * centres[[0, -1]] - 0.5 * centres[[1, -2]]
    return np.concatenate((ends[:1], middle, ends[1:]))


def _limits(centres: np.ndarray) -> np.ndarray:
    """Limits of a plotted axis: its ends, or the edges of its only cell."""
    return (centres if centres.size > 1 else _edges(centres))[[0, -1]]


def _curve(r: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A curve over frequency; a single value reaches over its cell."""
    return (r, values) if r.size > 1 else (_edges(r), np.repeat(values, 2))


def _name_region(ax: "Axes", mask: np.ndarray, r: np.ndarray, beta: np.ndarray, text: str) -> None:
    """Write a region's name where there is most room for it, if there is enough."""
    from scipy.ndimage import binary_erosion, distance_transform_edt

    # on a coarse picture of the map, where a letter is about 2 wide and a line 6 high
    rows = np.linspace(0, mask.shape[0] - 1, _COARSE).round().astype(int)
    columns = np.linspace(0, mask.shape[1] - 1, _COARSE).round().astype(int)
    fits = binary_erosion(mask[np.ix_(rows, columns)], np.ones((2 * len(text) + 3, 9)))
    if not fits.any():
        return
    room = distance_transform_edt(np.pad(fits, 1))[1:-1, 1:-1]
    best = np.argwhere(room > room.max() - 1.0)
    i, j = best[np.argmin(np.square(best - best.mean(axis=0)).sum(axis=1))]  # in the middle of a strip
    where = (r[rows[i]], beta[columns[j]])
    ax.text(*where, text, ha="center", va="center", fontsize=9, path_effects=_halo())


def _hatch_several(ax: "Axes", panel: xr.Dataset) -> bool:
    """Hatch the cells that have several answers, one of which the start chooses; whether there are any."""
    if "also_reachable" not in panel:
        return False
    flags = panel["also_reachable"].values
    several = (flags & (flags - 1)) != 0  # more than one bit
    r, beta = panel["r"].values, panel["beta"].values
    if r.size == 1:
        r, several = _edges(r), several.repeat(2, axis=0)
    if beta.size == 1:
        beta, several = _edges(beta), several.repeat(2, axis=1)
    if several.any():
        hatches = ax.contourf(
            r, beta, several.T, levels=[0.5, 1.5], colors="none", hatches=[_SEVERAL["hatch"]]
        )
        hatches.set(edgecolor=_SEVERAL["edgecolor"], linewidth=_SEVERAL["linewidth"])
    return bool(several.any())


def plot_regimes(ds: xr.Dataset, ax: "Axes | None" = None) -> "Axes | np.ndarray":
    """Picture of a regime map: stops per cycle in discrete colours, boundaries over it.

    Where the map holds `also_reachable`, cells that other starts end differently in are hatched.

    Parameters
    ----------
    ds : xarray.Dataset
        As `sweep` returns it, with `regime` or `stops_per_cycle`.
    ax : matplotlib axes, optional
        Axes for one mu; without it a figure with a panel for each mu is made.

    Returns
    -------
    The axes, or an array of them where a figure was made.

    Raises
    ------
    InputError
        The dataset holds neither output, or `ax` is given and the map has several mu.
    """
    if "regime" not in ds and "stops_per_cycle" not in ds:
        raise InputError("a map must hold regime or stops_per_cycle to be drawn; it holds neither")
    panels = [ds.isel(mu=m) for m in range(ds.sizes["mu"])] if "mu" in ds.dims else [ds]
    if ax is not None:
        if len(panels) > 1:
            raise InputError(f"ax must come with a map of one mu; got {len(panels)}: use ds.sel(mu=...)")
        _legend(ax, [_draw_map(ax, panels[0])], _hatch_several(ax, panels[0]))
        return ax
    figure, axes = _figure(len(panels), ds.attrs.get("title", ""))
    present = [_draw_map(panel_ax, panel) for panel_ax, panel in zip(axes, panels, strict=True)]
    several = [_hatch_several(panel_ax, panel) for panel_ax, panel in zip(axes, panels, strict=True)]
    _legend(figure, present, any(several))
    return axes


def _figure(panels: int, title: str) -> tuple[Figure, np.ndarray]:
    """A figure with a panel for each mu."""
    if panels > MOST_PANELS:
        raise InputError(
            f"a file must hold at most {MOST_PANELS} mu to be drawn; got {panels}: "
            "draw some of them with frictionmap.plot_regimes(ds.sel(mu=...))"
        )
    columns = min(panels, 2)
    rows = -(-panels // columns)
    figure = Figure(figsize=(5.2 * columns + 0.4, 4.0 * rows + 1.1), layout="constrained")
    grid = figure.subplots(rows, columns, squeeze=False).ravel()
    for spare in grid[panels:]:
        spare.remove()
    wrapped = textwrap.fill(title, int(11 * figure.get_figwidth()))
    figure.suptitle(wrapped, fontsize=11, parse_math=False)  # a dollar sign is a dollar sign
    return figure, grid[:panels]


def _finish_panel(ax: "Axes", panel: xr.Dataset) -> None:
    """Limits and names of the frequency axis, and what both kinds of panels share."""
    ax.set_xlim(*_limits(panel["r"].values))
    ax.set_xlabel(r"frequency ratio $r$")
    ax.set_ylabel(r"friction ratio $\beta$")
    if "mu" in panel.coords:
        ax.set_title(rf"$\mu$ = {float(panel['mu']):g}", fontsize=10)


def _draw_map(ax: "Axes", panel: xr.Dataset) -> set[int]:
    r, beta = panel["r"].values, panel["beta"].values
    found = classes(panel)
    colours = ListedColormap([colour for _, colour in _CLASSES])
    norm = BoundaryNorm(np.arange(len(_CLASSES) + 1) - 0.5, len(_CLASSES))
    ax.pcolormesh(_edges(r), _edges(beta), found.T, cmap=colours, norm=norm, rasterized=True)
    for name, style in (("beta_lim", _LIM), ("beta_stick", _STICK)):
        if name in panel:
            ax.plot(*_curve(r, panel[name].values), path_effects=_halo(), **style)
    ax.set_ylim(*_limits(beta))
    for index, text in ((_STUCK, "permanent sticking"), (_CONTINUOUS, "continuous")):
        _name_region(ax, found == index, r, beta, text)
    _finish_panel(ax, panel)
    return set(np.unique(found).tolist())


def _legend(owner: "Figure | Axes", present: list[set[int]], several: bool) -> None:
    shown = sorted(set().union(*present))
    handles: list[Any] = [_patch(*_CLASSES[i]) for i in shown]
    if several:
        handles.append(Patch(facecolor="none", label="several answers: the start decides", **_SEVERAL))
    handles += [Line2D([], [], **_LIM), Line2D([], [], **_STICK)]
    if isinstance(owner, Figure):
        _legend_below(owner, handles)
    else:
        owner.legend(handles=handles, fontsize=8)


def _patch(label: str, colour: str) -> Patch:
    return Patch(facecolor=colour, edgecolor="black", linewidth=0.6, label=label)


def _legend_below(figure: Figure, handles: list) -> None:
    wide = figure.get_figwidth() > 7.0
    figure.legend(handles=handles, fontsize=8, loc="outside lower center", ncols=5 if wide else 3)


def plot_boundaries(ds: xr.Dataset) -> np.ndarray:
    """Picture of the boundaries over frequency, a panel for each mu."""
    figure, axes = _figure(ds.sizes["mu"], ds.attrs.get("title", ""))
    handles = [
        _patch("continuous", _PALE), _patch("stick-slip", "white"), _patch(*_CLASSES[_STUCK]),
        Line2D([], [], **_LIM), Line2D([], [], **_STICK),
    ]  # fmt: skip
    modal = not np.array_equal(ds["beta_lim"].values, ds["beta_lim_modal"].values)
    if modal:
        handles.append(Line2D([], [], **_MODAL))
    for m, ax in enumerate(axes):
        panel = ds.isel(mu=m)
        r, lim = _curve(ds["r"].values, panel["beta_lim"].values)
        _, stick = _curve(ds["r"].values, panel["beta_stick"].values)
        finite = np.concatenate((lim[np.isfinite(lim)], stick[np.isfinite(stick)]))
        # beta_stick has poles where the held structure resonates: they leave the picture at the top
        top = min(1.15 * finite.max(initial=0.1), 2.0 * lim[np.isfinite(lim)].max(initial=0.05))
        ax.fill_between(r, 0.0, np.minimum(lim, top), color=_PALE)
        ax.fill_between(r, np.minimum(stick, top), top, color=_CLASSES[_STUCK][1])
        ax.plot(r, lim, path_effects=_halo(), **_LIM)
        ax.plot(r, stick, path_effects=_halo(), **_STICK)
        if modal:
            ax.plot(*_curve(ds["r"].values, panel["beta_lim_modal"].values), **_MODAL)
        ax.set_ylim(0.0, top)
        _finish_panel(ax, panel)
    _legend_below(figure, handles)
    return axes


def plot_response(ds: xr.Dataset) -> np.ndarray:
    """Picture of one steady state: motion, friction force and stop marks over time."""
    figure = Figure(figsize=(7.2, 5.4), layout="constrained")
    top, bottom = axes = figure.subplots(2, 1, sharex=True, height_ratios=(3, 2))
    turns = ds["tau"].values / np.pi
    base_moves = not np.allclose(ds["x"].values[0], ds["z"].values, rtol=0.0, atol=1e-12)
    top.plot(turns, ds["z"].values, color="#2c5aa0", label=r"motion in the contact, $z$")
    if base_moves:
        top.plot(turns, ds["x"].values[0], color="#c06014", linestyle="--", label=r"mass, $x$")
    stopped = ds["phase"].values == 0
    for ax in axes:
        ax.fill_between(
            turns, 0, 1, where=stopped, transform=ax.get_xaxis_transform(), color="#d9d9d9", linewidth=0.0,
            label="stop" if stopped.any() and ax is top else None,
        )  # fmt: skip
    begins = ds["event_phase"].values == 0
    if begins.any():
        times, places = ds["event_tau"].values[begins] / np.pi, ds["event_z"].values[begins]
        top.plot(times, places, "o", color="black", markersize=5, clip_on=False, label="stop begins")
    top.set_ylabel(r"displacement / $(P/k_1)$")
    figure.legend(fontsize=8, loc="outside lower center", ncols=4)
    bottom.plot(turns, ds["friction"].values, color="black", linewidth=1.2)
    mu_beta = float(ds["mu"]) * float(ds["beta"])
    for level in (-mu_beta, mu_beta):
        bottom.axhline(level, color="#7f7f7f", linewidth=0.8, linestyle=":")
    bottom.set_ylabel(r"friction force / $P$")
    bottom.set_xlabel(r"$\tau/\pi$")
    bottom.set_xlim(turns[0], turns[-1])
    stops = float(ds["stops_per_cycle"])
    words = next(c.name for c in regimes.REGIMES if c.value == int(ds["regime"])).replace("_", " ")
    counted = f", {stops:.4g} stops per cycle" if stops > 0 else ""
    cell = rf"$r$ = {float(ds['r']):g}, $\beta$ = {float(ds['beta']):g}, $\mu$ = {float(ds['mu']):g}"
    figure.suptitle(f"{cell}: {words}{counted}", fontsize=11)
    return axes


def check_picture(path: Path) -> None:
    """Refuse a name whose ending is not that of a picture."""
    if path.suffix.lower() not in FORMATS:
        raise InputError(f"-o must end in {', '.join(FORMATS)}; got {path}")


def save_picture(ds: xr.Dataset, path: Path) -> None:
    """Draw a dataset of any kind into a file."""
    draw: dict[str, Callable[[xr.Dataset], Any]] = {
        "map": plot_regimes,
        "boundaries": plot_boundaries,
        "response": plot_response,
    }
    draw[kind(ds)](ds)[0].figure.savefig(path, dpi=160)
