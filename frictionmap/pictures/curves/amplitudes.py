"""Amplitude and phase of masses and of the contact over frequency, in columns of panels."""

from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from ..features import frequencies_of, mark_features
from ..grids import HIGH
from ..options import current
from ..palette import HELD, LIMIT, LineStyle
from ..panels import Handle
from ..second_axes import on_the_right
from ..words import length_unit, name_of_contact, names_of_masses
from .axes import CUT, CUT_LOG, Panel, Picture, about_cut, about_peaks, in_rows, over_r, scale_of
from .families import Family
from .invariants import Invariant, invariant_points
from .lines import band_handle, draw_band, draw_curve, without_jumps


class Names(NamedTuple):
    """Names of the variables of amplitude and phase: of the masses, of the contact, and of the masses at
    beta_lim.
    """

    mass: tuple[str, str]
    contact: tuple[str, str]
    limit: tuple[str, str]
    axis: str
    mass_stop: tuple[str, str] | None = None  # start and end of stops that hold the maximum
    contact_stop: tuple[str, str] | None = None


NAMES = {
    "amplitude": Names(
        ("amplitude", "phase_lag"),
        ("contact_amplitude", "contact_phase"),
        ("limit_amplitude", "limit_phase"),
        "amplitude",
        ("phase_begin", "phase_end"),
        ("contact_phase_begin", "contact_phase_end"),
    ),
    "first_harmonic": Names(
        ("first_harmonic_amplitude", "first_harmonic_phase"),
        ("contact_first_harmonic_amplitude", "contact_first_harmonic_phase"),
        ("limit_first_harmonic_amplitude", "limit_first_harmonic_phase"),
        "first harmonic",
    ),
}

#: All variables from which motions are drawn.
MOTION_VARIABLES = (
    *("held_response", "held_phase"),
    *(name for names in NAMES.values() for pair in names if isinstance(pair, tuple) for name in pair),
)

#: Spacing of ticks on an axis of phases [degrees].
_TICK = 45.0

#: Amplitude at or below which a motion has no phase.
_ROUNDING = 1e-12

Curve = tuple[np.ndarray, np.ndarray | None]  # amplitudes and phases [degrees], (lines, r)
Stop = tuple[np.ndarray, np.ndarray]  # begin and end [degrees], (lines, r)


class MotionColumn(NamedTuple):
    """Content of a column of panels: a mass, or the contact."""

    title: str
    size: np.ndarray  # (lines, r)
    phase: np.ndarray | None  # degrees
    stop: Stop | None  # stops during which it is largest
    limit: Curve | None  # at beta_lim; one row, or one per line
    held: Curve | None  # with the contact held
    invariant: Invariant
    regime: np.ndarray  # (lines, r)


def _pair(family: Family, names: tuple[str, str], **chosen: int) -> Curve | None:
    """Amplitude and phase with these names, as far as present; None without an amplitude."""
    size, phase = (family.rows(name, **chosen) if name in family.cells else None for name in names)
    if size is None or phase is None:
        return None if size is None else (size, None)
    return size, np.where(size > _ROUNDING, np.degrees(phase), np.nan)


def _stop(family: Family, names: tuple[str, str] | None, **chosen: int) -> Stop | None:
    """Start and end of stops with these names, if present."""
    if names is None or not set(names) <= set(family.cells):
        return None
    begin, end = (np.degrees(family.rows(name, **chosen)) for name in names)
    return begin, end


def _mass_column(family: Family, quantity: str, index: int) -> MotionColumn | None:
    names = NAMES[quantity]
    own = _pair(family, names.mass, dof=index)
    if own is None:
        return None
    held = _pair(family, ("held_response", "held_phase"), dof=index)
    if held is not None and not (held[0] > _ROUNDING).any():  # a mass held by the wall
        held = None
    number = int(family.cells["dof"].values[index])
    return MotionColumn(
        title=names_of_masses(family.cells)[index],
        size=own[0],
        phase=own[1],
        stop=_stop(family, names.mass_stop, dof=index),
        limit=_pair(family, names.limit, dof=index),
        held=held,
        invariant=invariant_points(family, quantity, number),
        regime=family.regime,
    )


def _contact_columns(family: Family, quantity: str) -> list[MotionColumn]:
    """A column for each contact of which the dataset has an amplitude."""
    name = NAMES[quantity].contact[0]
    return [_contact_column(one, quantity) for one in family.contacts(name)] if name in family.cells else []


def _contact_column(family: Family, quantity: str) -> MotionColumn:
    own = _pair(family, NAMES[quantity].contact)
    assert own is not None
    stop = _stop(family, NAMES[quantity].contact_stop)
    title = name_of_contact(family.cells) or "contact"
    invariant = invariant_points(family, quantity, None)
    return MotionColumn(title, *own, stop, None, None, invariant, family.regime)


def _alike(one: np.ndarray, other: np.ndarray) -> bool:
    """Whether two amplitudes are equal wherever both are finite."""
    both = np.isfinite(one) & np.isfinite(other)
    return bool(np.allclose(one[both], other[both], rtol=1e-9, atol=_ROUNDING))


def _motions(family: Family, quantity: str) -> list[MotionColumn]:
    """The masses, and the contacts that no mass moves with; or the contacts alone."""
    if quantity == "contact":
        return _contact_columns(family, "amplitude")
    masses = [_mass_column(family, quantity, index) for index in range(family.cells.sizes.get("dof", 0))]
    found = [mass for mass in masses if mass is not None]
    contacts = [] if current().mass else _contact_columns(family, quantity)
    return found + [
        contact for contact in contacts if not any(_alike(mass.size, contact.size) for mass in found)
    ]


def _draw_reference(ax: Axes, x: np.ndarray, rows: np.ndarray, style: LineStyle, top: float | None) -> Line2D:
    """Draw a curve that is common to all lines, or one for each; a phase in degrees if `top` is None."""
    for row in rows:
        line = without_jumps(x, row) if top is None else (x, np.minimum(row, HIGH * top))
        (drawn,) = ax.plot(*line, **style, zorder=1.9)
    return drawn


def _draw_amplitude(ax: Axes, motion: MotionColumn, family: Family, top: float) -> list[Handle]:
    """Draw the upper panel of a column; return entries for the legend."""
    x = family.cells["r"].values
    handles: list[Handle] = []
    for row, regime, colour in zip(motion.size, motion.regime, family.colours, strict=True):
        draw_curve(ax, x, row, regime, colour, top)
    for curve, style in ((motion.limit, LIMIT), (motion.held, HELD)):
        if curve is not None:
            handles.append(_draw_reference(ax, x, curve[0], style, top))
    places = motion.invariant.places
    inside = places[places[:, 1] <= top]
    if inside.size:
        handles += ax.plot(
            *inside.T, "o", markersize=5.5, markerfacecolor="white", markeredgecolor="black",
            markeredgewidth=1.0, label=motion.invariant.label, clip_on=False, zorder=3.0,
        )  # fmt: skip
    return handles


def _draw_phase(ax: Axes, motion: MotionColumn, family: Family) -> list[Handle]:
    """Draw the lower panel of a column, in degrees; return entries for the legend."""
    x = family.cells["r"].values
    assert motion.phase is not None
    handles: list[Handle] = []
    for row, regime, colour in zip(motion.phase, motion.regime, family.colours, strict=True):
        draw_curve(ax, x, row, regime, colour, None)
    if motion.stop is not None and np.isfinite(motion.stop[0]).any():
        for begin, end, colour in zip(*motion.stop, family.colours, strict=True):
            draw_band(ax, x, begin, end, colour)
        handles.append(band_handle())
    for curve, style in ((motion.limit, LIMIT), (motion.held, HELD)):
        if curve is not None and curve[1] is not None:
            handles.append(_draw_reference(ax, x, curve[1], style, None))
    return handles


def _phase_limits(shown: list[MotionColumn]) -> tuple[float, float]:
    """Limits for all phases, at least 180 degrees apart [degrees]."""
    phases = [motion.phase for motion in shown if motion.phase is not None]
    phases += [motion.stop[0] for motion in shown if motion.stop is not None]
    together = np.concatenate([phase[np.isfinite(phase)] for phase in phases] or [np.empty(0)])
    return _TICK * float(np.floor(together.min(initial=0.0) / _TICK)), 180.0


def _tick(ends: tuple[float, float]) -> float:
    """Spacing of ticks on an axis of phases [degrees]; twice as wide where a small figure has a long axis."""
    return 2.0 * _TICK if current().size is not None and ends[1] - ends[0] > 5.0 * _TICK else _TICK


def _about_gaps(shown: list[MotionColumn]) -> list[str]:
    """Reason for missing phases, unless a band explains it."""
    why = "no phase where the largest displacement lasts throughout a stop, or the period is not one"
    for motion in shown:
        moves = np.isfinite(motion.size) & (motion.size > _ROUNDING)
        known = np.isfinite(motion.phase if motion.phase is not None else motion.size)
        if motion.stop is not None:
            known |= np.isfinite(motion.stop[0])
        if (moves & ~known).any():
            return [why]
    return []


def motion_picture(family: Family, quantity: str, log: bool) -> Picture:
    """A column for each motion: amplitude above, phase below."""
    of = "amplitude" if quantity == "contact" else quantity
    shown = _motions(family, quantity)
    sizes = [motion.size for motion in shown]
    scale, ends = scale_of(family, sizes, CUT_LOG if log else CUT, log), _phase_limits(shown)
    marks = frequencies_of(family.system)
    unit = length_unit(family.cells)

    def amplitude(motion: MotionColumn) -> Panel:
        def draw(ax: Axes) -> list[Handle]:
            over_r(ax, family, motion.title, f"{NAMES[of].axis} / {unit}")
            handles = _draw_amplitude(ax, motion, family, scale.top)
            scale.apply(ax, motion.size)
            on_the_right(ax, family.cells, "length", NAMES[of].axis)
            return handles + mark_features(ax, marks, family.r)

        return draw

    def phase(motion: MotionColumn) -> Panel:
        def draw(ax: Axes) -> list[Handle]:
            over_r(ax, family, motion.title, "phase lag [°]")
            ax.set_ylim(*ends)
            ax.set_yticks(np.arange(180.0, ends[0] - 1.0, -_tick(ends))[::-1])
            return _draw_phase(ax, motion, family)

        return draw

    below = [phase(motion) for motion in shown if motion.phase is not None]
    rows = in_rows([amplitude(motion) for motion in shown], below)
    return Picture(rows, 2.9, [*about_cut(scale, sizes), *about_peaks(family), *_about_gaps(shown)])
