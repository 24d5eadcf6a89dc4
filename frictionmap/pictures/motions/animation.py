"""A motion as a moving picture: masses, contacts that light while they are stuck, friction loop."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple, Unpack

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from ... import checks
from ...errors import InputError
from ...files.reading import kind
from ..options import FigureOptions, checked_options, used
from ..palette import LINES, OPEN_COLOUR, OPEN_LABEL
from ..panels import Handle, legend_below, new_figure, title_figure
from ..shapes import check_holds, to_draw
from ..sizes import finish, points, sizes
from ..words import caption, length_unit, symbols_of_masses
from .history import MOST_LABELS, check_can_be_seen, title_of
from .in_time import draw_record, single_motion, time_words, values_in_si
from .loops import draw_loop, draw_loops
from .traces import Trace, traces_of

if TYPE_CHECKING:
    from matplotlib.animation import FuncAnimation

#: Valid durations [s] and numbers of frames per second.
_SECONDS, _RATES = (0.1, 600.0), (1.0, 120.0)

#: Colours of the light of a stuck contact, of a sliding one, and of an open one.
_STUCK, _SLIDING, _OPEN = "#f2a900", "white", OPEN_COLOUR

#: Colour of the cursor.
_CURSOR = "#cc1f03"

#: Size of the masses and of the lights [points].
_MASS, _LIGHT = 15.0, 10.0


class _Moving(NamedTuple):
    """A part of the drawing that changes from frame to frame, and its values over time."""

    time: np.ndarray  # as the axis of the cursor has it
    masses: Sequence[tuple[Line2D, np.ndarray]]
    contacts: Sequence[tuple[Line2D, Line2D, Trace]]  # light on the stage, point on the loop
    cursor: Line2D

    def show(self, frame: int) -> None:
        """Show the state at a sample."""
        for mark, x in self.masses:
            mark.set_xdata([x[frame]])
        for light, point, trace in self.contacts:
            light.set_xdata([trace.z[frame]])
            held = _STUCK if trace.stuck[frame] else _SLIDING
            light.set_markerfacecolor(_OPEN if trace.opened[frame] else held)
            point.set_data([trace.z[frame]], [trace.friction[frame]])
        self.cursor.set_xdata([self.time[frame]] * 2)


def animate(
    ds: xr.Dataset, *, seconds: float = 4.0, fps: float = 15.0, **options: Unpack[FigureOptions]
) -> "FuncAnimation":
    """Draw a steady state, or a motion under a record, as a moving picture.

    Masses and contacts have a row each and move along it. The light of a contact is on while it is stuck, and
    blue while it is open. A cursor runs through the motion in the contacts, or through the record, a point
    along the friction loop.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of `frictionmap.response`, or one motion of `frictionmap.history` with its samples; or a file.
    seconds : float
        Time that the whole dataset takes, 0.1 to 600 [s].
    fps : float
        Frames per second, 1 to 120.
    options : keyword arguments of the functions that draw
        Such as size="120mm", title="", or mass=[1, 5] to choose masses.  Not panels.

    Returns
    -------
    matplotlib.animation.FuncAnimation
        `.save("motion.gif")` writes it (GIF, or MP4 if ffmpeg is installed); `.to_jshtml()` shows it in a
        notebook.

    Raises
    ------
    InputError
        The dataset is neither of them, holds several motions or no samples, or an argument is invalid.

    Examples
    --------
    >>> import frictionmap as fm
    >>> fm.animate(fm.response(fm.System(), 0.3, 0.5)).save("motion.gif")  # doctest: +SKIP
    """
    from matplotlib.animation import FuncAnimation

    duration = checks.number(seconds, "seconds", least=_SECONDS[0], most=_SECONDS[1])
    rate = checks.number(fps, "fps", least=_RATES[0], most=_RATES[1])
    checked = checked_options(dict(options))
    if checked.panels:
        raise InputError("cannot use panels with animate: its panels belong together; omit panels")
    with used(checked), sizes(checked):
        ds = to_draw(ds, "animate", "response", "history")
        axes, moving = _record_stage(ds) if kind(ds) == "history" else _response_stage(ds)
        finish(axes, checked)
        figure = axes[0].figure
        figure.draw_without_rendering()
        figure.set_layout_engine("none")  # the first layout is that of all frames: to find it takes longest
    return FuncAnimation(
        figure,
        lambda frame: moving.show(int(frame)),
        frames=_frames(moving.time, max(2, round(duration * rate))),
        interval=1000.0 / rate,
        blit=False,
    )


def _frames(time: np.ndarray, count: int) -> np.ndarray:
    """Samples at equal times: the last ones that are not later.

    Both ends are samples to the bit; times between them need not be, and a rounded one only decides between
    two samples that are next to each other.
    """
    moments = np.linspace(time[0], time[-1], count)
    return np.searchsorted(time, moments, side="right") - 1


def _response_stage(ds: xr.Dataset) -> tuple[np.ndarray, _Moving]:
    """Draw everything of a steady state that stays, and the first frame."""
    check_holds(ds, ("z", "x", "friction", "direction"), "its motion")
    check_can_be_seen(ds, ("z", "x", "friction"))
    traces = traces_of(ds)
    stage, history, loop, figure = _panels(ds, traces)
    marks = _draw_stage(stage, _some_masses(ds), traces, f"displacement / {length_unit(ds)}")
    cursor = _draw_history(history, ds, traces)
    draw_loop(loop, ds, traces)
    moving = _moving(ds["tau"].values / np.pi, _some_masses(ds), traces, marks, cursor, loop)
    title_figure(figure, title_of(ds))
    legend_below(figure, _legend(traces), caption(ds))
    return np.array([stage, history, loop], dtype=object), moving


def _record_stage(ds: xr.Dataset) -> tuple[np.ndarray, _Moving]:
    """Draw everything of a motion under a record that stays, and the first frame: in SI units if known."""
    one = single_motion(ds)
    length, force = (values_in_si(one, *of)[1] for of in (("z", "m", "m"), ("friction", "N", "N")))
    in_si = {"x": ("x", "m"), "z": ("z", "m"), "friction": ("friction", "N")}
    one = one.assign({name: (one[name].dims, values_in_si(one, *of, "")[0]) for name, of in in_si.items()})
    traces = traces_of(one)
    stage, record, loop, figure = _panels(one, traces)
    marks = _draw_stage(stage, _some_masses(one), traces, f"displacement{length}")
    draw_record(record, one)
    record.set_xlabel(time_words(one))
    cursor = record.axvline(one["time"].values[0], color=_CURSOR, linewidth=1.2)
    draw_loops(loop, traces, f"motion in the contact $z${length}", f"contact force{force}")
    moving = _moving(one["time"].values, _some_masses(one), traces, marks, cursor, loop)
    title_figure(figure, str(ds.attrs.get("title", "")))
    legend_below(figure, _legend(traces), "")
    return np.array([stage, record, loop], dtype=object), moving


def _panels(ds: xr.Dataset, traces: Sequence[Trace]) -> tuple[Axes, Axes, Axes, Any]:
    """The stage, the panel over time below it, the loop beside them, and their figure."""
    rows = _some_masses(ds).sizes["dof"] + len(traces)
    figure = new_figure(8.4, 2.6 + 0.34 * rows)
    grid = figure.add_gridspec(2, 2, width_ratios=(1.25, 1.0), height_ratios=(0.34 * rows + 0.5, 1.8))
    stage, history = figure.add_subplot(grid[0, 0]), figure.add_subplot(grid[1, 0])
    return stage, history, figure.add_subplot(grid[:, 1]), figure


def _moving(
    time: np.ndarray, masses: xr.Dataset, traces: Sequence[Trace], marks: Sequence[Line2D], cursor: Line2D,
    loop: Axes,
) -> _Moving:  # fmt: skip
    """What moves, at its first frame."""
    dots = [loop.plot([], [], "o", color=_colour(trace), markersize=7.0)[0] for trace in traces]
    lights = zip(marks[masses.sizes["dof"] :], dots, traces, strict=True)
    moving = _Moving(time, [*zip(marks, masses["x"].values, strict=False)], [*lights], cursor)
    moving.show(0)
    return moving


def _some_masses(ds: xr.Dataset) -> xr.Dataset:
    """All masses of a chain; of a large structure some, evenly chosen."""
    some = np.linspace(0, ds.sizes["dof"] - 1, min(ds.sizes["dof"], MOST_LABELS)).round().astype(int)
    return ds.isel(dof=np.unique(some))


def _colour(trace: Trace) -> str:
    return trace.colour


def _draw_stage(ax: Axes, masses: xr.Dataset, traces: Sequence[Trace], words: str) -> list[Line2D]:
    """Draw a row for every mass, then one for every contact: its range, and the mark that moves."""
    rows = [*zip(symbols_of_masses(masses), masses["x"].values, strict=True)]
    rows += [(trace.label or "contact", trace.z) for trace in traces]
    marks = []
    for row, (_, values) in enumerate(rows):
        ax.plot([values.min(), values.max()], [row, row], color="0.8", linewidth=3.0, solid_capstyle="round")
        if row < masses.sizes["dof"]:
            look: dict[str, Any] = {"marker": "s", "markersize": _MASS, "color": LINES[row % len(LINES)]}
        else:
            look = {"marker": "o", "markersize": _LIGHT, "markeredgecolor": "black", "color": "black"}
        marks += ax.plot([values[0]], [row], **look)
    ax.set_yticks(range(len(rows)), [name for name, _ in rows])
    ax.set_ylim(len(rows) - 0.4, -0.6)
    ax.margins(x=0.12)
    ax.set_xlabel(words)
    return marks


def _draw_history(ax: Axes, ds: xr.Dataset, traces: Sequence[Trace]) -> Line2D:
    """Draw the motion in every contact over time, and the cursor."""
    turns = ds["tau"].values / np.pi
    for trace in traces:
        ax.plot(turns, trace.z, color=_colour(trace), linewidth=1.2)
    ax.set_xlim(turns[0], turns[-1])
    ax.set_xlabel(r"$\tau/\pi$")
    ax.set_ylabel(f"contact\n$z$ / {length_unit(ds)}", fontsize=points(9.0, "axes.labelsize"))
    return ax.axvline(turns[0], color=_CURSOR, linewidth=1.2)


def _legend(traces: Sequence[Trace]) -> list[Handle]:
    """Entries for the contacts and the states of their lights."""
    words: tuple[str, ...] = ("stuck", "slides")
    if all(trace.elastic for trace in traces):
        words = ("no slip", "slips")
    if any(trace.opened.any() for trace in traces):
        words = (*words, OPEN_LABEL)
    lights = [
        Line2D(
            [],
            [],
            marker="o",
            linestyle="none",
            markersize=8.0,
            markeredgecolor="black",
            color=colour,
            label=word,
        )
        for colour, word in zip((_STUCK, _SLIDING, _OPEN), words, strict=False)
    ]
    return [
        *lights,
        *(Line2D([], [], color=trace.colour, label=trace.label) for trace in traces if trace.label),
    ]
