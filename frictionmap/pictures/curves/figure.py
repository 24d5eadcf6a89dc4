"""Pictures of response curves over frequency: amplitude and phase, harmonics, energy."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Unpack

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from ...errors import InputError
from ..drawing import with_options
from ..options import FigureOptions, current
from ..panels import MOST_PANELS, Handle, distinct, given_axes, legend_below, legend_under, table_of_panels
from ..shapes import to_draw
from ..words import caption
from .amplitudes import MOTION_VARIABLES, NAMES, motion_picture
from .axes import Picture, in_rows
from .families import Family, family_of
from .harmonics import HARMONIC_VARIABLES, spectrum_picture
from .lines import regime_handles
from .works import SCALARS, scalar_picture

if TYPE_CHECKING:
    from ..panels import AxesArray

#: Quantities that can be drawn, and the variables of which at least one is required.
CURVE_QUANTITIES: dict[str, tuple[str, ...]] = {
    "amplitude": ("amplitude",),
    "first_harmonic": (NAMES["first_harmonic"].mass[0],),
    "contact": ("contact_amplitude",),
    "harmonics": HARMONIC_VARIABLES,
    **{name: tuple(variables) for name, variables in SCALARS.items()},
}

#: All variables from which curves are drawn.
CURVE_VARIABLES = frozenset(
    (
        "regime",
        "contact_regime",
        "slips_per_cycle",
        *MOTION_VARIABLES,
        *(name for names in CURVE_QUANTITIES.values() for name in names),
    )
)

#: Largest number of lines in a picture that can be distinguished.
_MOST_LINES = 12

#: Number of lines drawn of more of them.
_FEW_LINES = 6


def _quantity(ds: xr.Dataset, asked: str | None) -> str:
    """Quantity to draw: the requested one if present, or the first one present."""
    there = [name for name, variables in CURVE_QUANTITIES.items() if set(variables) & set(ds)]
    if asked is None and there:
        return there[0]
    if asked in there:
        return asked
    valid = f"one of {', '.join(there)}" if there else "in the dataset, which has none that is drawn"
    raise InputError(f"quantity must be {valid}; got {asked}")


def _check_lines(family: Family) -> None:
    if len(family.labels) > _MOST_LINES:
        name = family.line
        raise InputError(
            f"a dataset must have at most {_MOST_LINES} {name} for its curves to be drawn; got "
            f"{len(family.labels)}: draw some of them with frictionmap.plot_curves(ds.sel({name}=[...]))"
        )


def few_curves(ds: xr.Dataset) -> tuple[xr.Dataset, str]:
    """Curves of friction ratios spread over those of a dataset with too many to draw, and this in words."""
    count = ds.sizes.get("beta", 1)
    if count <= _MOST_LINES:
        return ds, ""
    chosen = np.linspace(0, count - 1, _FEW_LINES).round().astype(int)
    return ds.isel(beta=chosen), f" with {_FEW_LINES} of {count} friction ratios; --beta chooses others"


def _picture(family: Family, quantity: str, log: bool) -> Picture:
    if quantity == "harmonics":
        return spectrum_picture(family)
    if quantity in SCALARS:
        return scalar_picture(family, quantity, log)
    return motion_picture(family, quantity, log)


def _line_handles(family: Family) -> list[Handle]:
    return [
        Line2D([], [], color=colour, linewidth=1.6, label=label)
        for colour, label in zip(family.colours, family.labels, strict=True)
    ]


def _title(ds: xr.Dataset, family: Family) -> str:
    return ", ".join(filter(None, (str(ds.attrs.get("title", "")), family.chosen)))


@with_options
def plot_curves(
    ds: xr.Dataset,
    quantity: str | None = None,
    *,
    log: bool = False,
    ax: "Sequence[Axes] | AxesArray | None" = None,
    **options: Unpack[FigureOptions],
) -> "AxesArray":
    """Draw response curves over frequency, one colour for each friction ratio.

    Lines are solid where the motion is continuous, dashed for stick-slip, dotted where the contact is stuck.
    Black: the continuous motion at beta_lim, and the structure with its contact held.  Circles mark points
    that friction does not change.  For several mu the first is drawn, and named in the title; for a single
    beta there is a line for each mu.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of `curves`, or a part of it, or a map with amplitudes.
    quantity : str, optional
        "amplitude" (largest displacements, with the phase if present), "first_harmonic" (its amplitude and
        phase), "contact" (amplitude and phase of the motion in the contact), "harmonics" (in dB relative to
        the first), "energy", "transmitted_force".  Default: the first of these that the dataset contains.
    log : bool
        Logarithmic axis of amplitudes.  The axis of r follows its grid.
    ax : array of matplotlib axes, optional
        Axes to draw into, row by row; the legend is placed below the last of them.

    Returns
    -------
    An array of the axes.

    Raises
    ------
    InputError
        The dataset does not contain the quantity, or has too many lines, or the number of axes differs from
        that of the panels.

    Examples
    --------
    >>> import frictionmap as fm
    >>> ds = fm.curves(fm.System(), r=[0.4, 0.8, 1.2], beta=[0.1, 0.5])
    >>> axes = fm.plot_curves(ds)
    >>> [ax.get_ylabel() for ax in axes.flat]
    ['amplitude / $(P/k_1)$', 'phase lag [°]']
    """
    ds = to_draw(ds, "plot_curves", "curves", "map")
    quantity = _quantity(ds, quantity)
    if log and quantity == "harmonics":
        raise InputError("cannot draw harmonics with log: they are in decibels; omit log")
    family = family_of(ds)
    _check_lines(family)
    picture = _picture(family, quantity, log)
    panels = current().chosen(panel for row in picture.rows for panel in row if panel is not None)
    if current().panels:
        picture = picture._replace(rows=in_rows([*panels], []))
    if ax is None:
        axes = _new_axes(picture, len(panels), _title(ds, family))
    else:
        axes = given_axes(ax, len(panels), "one for each panel")
    others = [handle for panel, one in zip(panels, axes, strict=True) for handle in panel(one)]
    elastic = "slips_per_cycle" in ds and "stops_per_cycle" not in ds
    lines = [] if quantity == "harmonics" else _line_handles(family)
    handles = [*lines, *regime_handles(family.regime, elastic), *distinct(others)]
    if ax is None:
        figure = axes[0].figure
        assert isinstance(figure, Figure)
        legend_below(figure, handles, "; ".join((caption(ds), *picture.remarks)))
    else:
        legend_under(axes[-1], handles)
    return axes


def _new_axes(picture: Picture, panels: int, title: str) -> "AxesArray":
    """Create a figure with one axes per panel; positions without a panel stay empty."""
    if panels > MOST_PANELS:
        raise InputError(
            f"a picture must have at most {MOST_PANELS} panels; got {panels}: draw some masses or friction "
            "ratios with frictionmap.plot_curves(ds.sel(dof=[...], beta=[...]))"
        )
    table = table_of_panels(len(picture.rows), len(picture.rows[0]), picture.height, title)
    used = [panel is not None for row in picture.rows for panel in row]
    axes = table.ravel()
    for spare in axes[[not there for there in used]]:
        spare.remove()
    return axes[used]
