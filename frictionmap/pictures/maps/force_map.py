"""Maps of friction against friction: two contacts at one frequency, each with a friction of its own."""

from typing import TYPE_CHECKING, Unpack

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure

from ... import checks, regimes
from ...datasets.labels import CELL
from ...datasets.schema import check_structure, kind
from ...errors import InputError
from ...files.config import config_of
from ...files.slices import further_axes
from ...general.boundaries import friction_lines
from ...general.partial import has_limits, holding_force
from ...general.problem import general_of
from ...model.system import System
from ..drawing import with_options
from ..grids import Grid
from ..options import FigureOptions
from ..palette import LIM, PAIRS, PARTIAL, STICK, UNRESOLVED_PAIR
from ..panels import Handle, halo, legend_below, new_figure, patch, title_figure
from ..shapes import check_options
from ..sizes import points
from ..words import system_words

if TYPE_CHECKING:
    from ..panels import AxesArray

#: Points of the curves of partial sticking.
_SAMPLES = 200

_STATES = ("sticks", "sticks and slips", "slides")


@with_options
def plot_forces(ds: xr.Dataset, over: str | None = None, **options: Unpack[FigureOptions]) -> "AxesArray":
    """Draw maps of two contacts at one frequency: the friction of one against the beta of the grid.

    Nine colours show what each of both contacts does.  For mu = 1 the curves from which one of them sticks
    while the other moves are drawn as well; they come from steady states with that contact held, not from the
    cells.  Of three or more contacts, the one along the axis is shown with the first other that beta changes,
    without such curves.

    Parameters
    ----------
    ds : xarray.Dataset
        Maps along one further axis, as ``sweep(..., axes={"contacts[2].force": ...})`` returns them, with
        `contact_regime` of two or more contacts, at one r and one mu.
    over : str, optional
        That axis, such as ``contacts_2_force``; needed where there is another one.

    Returns
    -------
    array of one matplotlib axes

    Raises
    ------
    InputError
        The dataset has no such axis, more than one r or mu, or one contact.

    Examples
    --------
    >>> import frictionmap as fm
    >>> pair = fm.System(
    ...     contacts=[fm.Contact(masses=[1]), fm.Contact(masses=[2], force=0.1)],
    ...     mass_ratios=[1, 1], stiffness_ratios=[1, 1], damping_ratios=0.02,
    ... )
    >>> outputs = ["regime", "contact_regime"]
    >>> ds = fm.sweep(pair, [0.8], [0.1, 0.3, 0.5], axes={"contacts[2].force": [0.1, 0.3]}, outputs=outputs)
    >>> axes = fm.plot_forces(ds)
    >>> [ax.get_ylabel() for ax in axes.flat]
    ['friction force of contact 2, over P (fixed-wall 2)']
    """
    check_options("plot_forces")
    ds, over = _checked(ds, over)
    count, moved = ds.sizes["contact"], _moved_by_beta(ds)
    number = int(over.split("_")[1]) - 1
    other = next((k for k in moved if k != number), 1 if number == 0 else 0)
    ds = ds.isel(contact=sorted((number, other)))
    first, second = ds["contact_regime"].values[..., 0], ds["contact_regime"].values[..., 1]
    found = _classes(first, second)
    names = _names(ds)
    figure = new_figure(6.8, 5.4)
    title_figure(figure, f"{ds.attrs.get('title', '')}, r = {float(ds['r'][0]):g}".removeprefix(", "))
    ax = figure.subplots()
    beta, force = Grid(ds["beta"].values), Grid(ds[over].values)
    _draw_cells(ax, found, beta, force)
    ax.set_xlabel(rf"friction ratio $\beta$ ({names[int(other > number)]})")
    ax.set_ylabel(f"{ds[over].attrs.get('long_name', over)} ({names[int(number > other)]})")
    ax.set_title(rf"$\mu$ = {float(ds['mu'][0]):g}", fontsize=points(10.0, "axes.titlesize"))
    handles = _limits(ax, ds, force)
    if count == 2:
        handles += _curves(ax, ds, over, beta, force)
    ax.set_xlim(*beta.limits)
    ax.set_ylim(*force.limits)
    assert isinstance(figure, Figure)
    legend_below(figure, _class_handles(found, names) + handles, system_words(ds))
    return np.array([ax], dtype=object)


def _checked(ds: xr.Dataset, over: str | None) -> tuple[xr.Dataset, str]:
    """The maps in the order (over, beta, contact), and the axis; refuse others."""
    if not isinstance(ds, xr.Dataset):
        raise InputError(f"ds of plot_forces must be a dataset; got {type(ds).__name__}")
    check_structure(ds, in_parts=True)
    valid = [name for name in further_axes(ds) if name.startswith("contacts_")] if kind(ds) == "map" else []
    if over is None and len(valid) == 1:
        over = valid[0]
    if over not in valid:
        there = ", ".join(valid) or "none"
        raise InputError(
            f"over must be a further axis with a number of a contact (there: {there}); "
            f"got {checks.one_line(over)}"
        )
    if "contact_regime" not in ds or ds.sizes.get("contact", 1) < 2:
        raise InputError(
            f"ds of plot_forces must hold contact_regime of two or more contacts; got "
            f"{ds.sizes.get('contact', 1)}"
        )
    for name in ("mu", "r"):
        if ds[name].size != 1:
            raise InputError(f"ds of plot_forces must hold one {name}; got {ds[name].size}: choose one")
    ds = ds.assign_coords({name: np.atleast_1d(ds[name].values) for name in CELL if ds[name].ndim == 0})
    ds = ds.squeeze([name for name in ("mu", "r") if name in ds["contact_regime"].dims])
    ds = ds.assign_coords({name: ("one", np.atleast_1d(ds[name].values)) for name in ("mu", "r")})
    others = [dim for dim in ds["contact_regime"].dims if dim not in (over, "beta", "contact")]
    if others:
        raise InputError(f"cannot draw maps over {over}: ds has the further axis {others[0]}; choose a point")
    ds = ds.sortby(over)
    return ds.assign(contact_regime=ds["contact_regime"].transpose(over, "beta", "contact")), over


def _classes(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Class of every cell: 3 times the state of contact 1 plus that of contact 2; the last: unresolved."""
    codes = (regimes.PERMANENT_STICKING, regimes.STICK_SLIP, regimes.CONTINUOUS)
    states = []
    for regime in (first, second):
        state = np.full(regime.shape, -1)
        for k, code in enumerate(codes):
            state[regime == code] = k
        state[regime == regimes.ONE_WAY_SLIDING] = len(codes) - 1
        states.append(state)
    known = (states[0] >= 0) & (states[1] >= 0)
    return np.where(known, 3 * states[0] + states[1], len(PAIRS))


def _names(ds: xr.Dataset) -> tuple[str, str]:
    """Names of both contacts."""
    if "contact_name" in ds.coords:
        one, other = (str(name) for name in ds["contact_name"].values)
        return one, other
    return "contact 1", "contact 2"


def _draw_cells(ax: Axes, found: np.ndarray, beta: Grid, force: Grid) -> None:
    colours = ListedColormap([*PAIRS, UNRESOLVED_PAIR])
    ax.pcolormesh(
        beta.edges, force.edges, found, cmap=colours, vmin=-0.5, vmax=len(PAIRS) + 0.5, rasterized=True
    )


def _class_handles(found: np.ndarray, names: tuple[str, str]) -> list[Handle]:
    """Legend entries of the classes that occur, with their numbers of cells."""
    handles: list[Handle] = []
    for k, colour in enumerate((*PAIRS, UNRESOLVED_PAIR)):
        cells = int((found == k).sum())
        if cells:
            label = "unresolved"
            if k < len(PAIRS):
                label = f"{names[0]} {_STATES[k // 3]}, {names[1]} {_STATES[k % 3]}"
            handles.append(patch(f"{label} ({cells:,})", colour))
    return handles


def _moved_by_beta(ds: xr.Dataset) -> list[int]:
    """Contacts, counted from 0, whose friction the grid's beta changes; all if the file does not say."""
    system = _system(ds)
    if system is None:
        return list(range(ds.sizes["contact"]))
    return np.flatnonzero(friction_lines(system, np.array([1.0]))[0][:, 0]).tolist()


def _limits(ax: Axes, ds: xr.Dataset, force: Grid) -> list[Handle]:
    """Draw the boundaries: no contact stops, all stick."""
    handles: list[Handle] = []
    for name, style in (("beta_lim", LIM), ("beta_stick", STICK)):
        if name in ds:
            values = ds[name].squeeze().values
            handles += ax.plot(values, force.values, path_effects=halo(), **style)
    return handles


def _curves(ax: Axes, ds: xr.Dataset, over: str, beta: Grid, force: Grid) -> list[Handle]:
    """Draw the boundaries of two contacts from which one of them sticks."""
    system = _system(ds)
    if system is None or not (
        general_of(system).has_equal_friction(float(ds["mu"][0])) and has_limits(system)
    ):
        return []
    r, number = float(ds["r"][0]), int(over.split("_")[1]) - 1
    part = over.removeprefix(f"contacts_{number + 1}_")
    if part != "force":
        return []
    other = 1 - number
    lines, _ = friction_lines(system, np.array([1.0]))
    if lines[other, 0] == 0.0:  # the grid's beta moves neither
        return []
    x = beta.at(np.linspace(0.0, 1.0, _SAMPLES))
    of_beta = lines.copy()
    of_beta[number] = 0.0
    along = holding_force(system, r, number, of_beta, x)
    drawn: list[Handle] = [*ax.plot(x, along, path_effects=halo(), **PARTIAL)]
    y = force.at(np.linspace(0.0, 1.0, _SAMPLES))
    of_force = np.zeros_like(lines)
    of_force[number, 0] = 1.0
    across = (holding_force(system, r, other, of_force, y) - lines[other, 1]) / lines[other, 0]
    ax.plot(across, y, path_effects=halo(), **PARTIAL)
    return drawn


def _system(ds: xr.Dataset) -> System | None:
    """The system of the file, whatever the friction of the contact that varies; None if it does not say."""
    try:
        config = config_of(str(ds.attrs.get("config", "")), {})
    except InputError:
        return None
    return config.system if config is not None else None
