"""Harmonics of steady states over frequency, in decibels relative to the first."""

from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from ..options import current
from ..palette import sequence
from ..panels import Handle
from ..words import name_of_contact, names_of_masses
from .axes import Panel, Picture, Row, in_rows, over_r
from .families import Family
from .lines import draw_curve

HARMONIC_VARIABLES = ("displacement_harmonic", "contact_harmonic")

#: Level [dB] below which harmonics are not shown.
LOWEST = -120.0

#: First harmonics at or below this size are rounding errors of rest.
_ROUNDING = 1e-12

#: Largest number of harmonics in a picture.
MOST_ORDERS = 12


class Spectrum(NamedTuple):
    """Harmonics of a mass, or of the contact, for one line of a family."""

    title: str
    levels: np.ndarray  # (orders, r), of the orders 0, 1, ... [dB re first]
    regime: np.ndarray  # (r,)


def levels_of(values: np.ndarray) -> np.ndarray:
    """Levels of harmonics in dB relative to the first, (..., harmonic, part) -> (..., harmonic)."""
    size = np.hypot(values[..., 0], values[..., 1])
    first = np.where(size[..., 1:2] > _ROUNDING, size[..., 1:2], np.nan)  # of a motion at rest there is none
    with np.errstate(divide="ignore", invalid="ignore"):
        return 20.0 * np.log10(size / first)


def _motion_levels(family: Family) -> list[tuple[str, np.ndarray]]:
    """Names and levels, (lines, r, harmonic), of the masses, and of the contacts that no mass equals."""
    order = (family.line, "r", "harmonic", "part")
    found = []
    if "displacement_harmonic" in family.cells:
        values = family.cells["displacement_harmonic"].transpose("dof", *order).values
        names = names_of_masses(family.cells)
        found = [(name, levels_of(part)) for name, part in zip(names, values, strict=True)]
    if "contact_harmonic" in family.cells and not current().mass:
        masses = [part for _, part in found]
        for one in family.contacts("contact_harmonic"):
            own = levels_of(one.cells["contact_harmonic"].transpose(*order).values)
            if not any(np.allclose(own[..., 2:], part[..., 2:], equal_nan=True) for part in masses):
                found.append((name_of_contact(one.cells) or "contact", own))
    return found


def spectra(family: Family) -> list[list[Spectrum]]:
    """A row for each line of a family, with a spectrum for each motion."""
    motions = _motion_levels(family)
    return [
        [Spectrum(f"{name}, {label}", levels[k].T, family.regime[k]) for name, levels in motions]
        for k, label in enumerate(family.labels)
    ]


def orders_of(rows: list[list[Spectrum]]) -> list[int]:
    """Harmonics above the first that are strong enough to be shown anywhere."""
    found: set[int] = set()
    for spectrum in (spectrum for row in rows for spectrum in row):
        strong = (spectrum.levels >= LOWEST).any(axis=1)
        found.update(int(n) for n in np.flatnonzero(strong) if n > 1)
    return sorted(found)[:MOST_ORDERS]


def _draw(ax: Axes, spectrum: Spectrum, family: Family, orders: list[int]) -> list[Handle]:
    """Draw one line for each harmonic; return entries for the legend."""
    x = family.cells["r"].values
    colours = sequence(len(orders))
    for n, colour in zip(orders, colours, strict=True):
        draw_curve(ax, x, np.maximum(spectrum.levels[n], 1.1 * LOWEST), spectrum.regime, colour, np.inf)
    return [
        Line2D([], [], color=colour, label=f"harmonic {n}") for n, colour in zip(orders, colours, strict=True)
    ]


def spectrum_picture(family: Family) -> Picture:
    """A row for each line of a family and a column for each motion; for a single motion, panels in rows."""
    rows = spectra(family)
    orders = orders_of(rows)
    strong = np.concatenate([spectrum.levels[orders].ravel() for row in rows for spectrum in row])
    strong = strong[np.isfinite(strong) & (strong >= LOWEST)]
    ends = max(LOWEST, float(strong.min(initial=-40.0)) - 5.0), max(0.0, float(strong.max(initial=0.0))) + 5.0

    def panel(spectrum: Spectrum) -> Panel:
        def draw(ax: Axes) -> list[Handle]:
            over_r(ax, family, spectrum.title, "dB re first harmonic")
            ax.set_ylim(*ends)
            return _draw(ax, spectrum, family, orders)

        return draw

    panels: list[Row] = [[panel(spectrum) for spectrum in row] for row in rows]
    remarks = [f"harmonics below {LOWEST:g} dB are not shown"]
    if len(panels[0]) == 1 or len(panels[0]) > current().columns(len(panels[0])):
        panels = in_rows([one for row in panels for one in row if one is not None], [])
    return Picture(panels, 2.6, remarks)
