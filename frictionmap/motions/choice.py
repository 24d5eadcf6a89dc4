"""`least_median`: the friction with the least median of a peak over a suite of records."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from .. import checks
from ..errors import InputError
from ..model.system import System
from ..units.scales import Units
from .bounds import BOUNDED, friction_bounds
from .dataset import history
from .record import Record
from .scaling import friction_ratios, motion_scales

#: Values of friction on the grid that is searched for local minima.
GRID = 50

#: Share by which a section of an interval shrinks, and relative width at which it ends: the value of a smooth
#: minimum is then exact to rounding, and a kink where two records are equal is found to 1e-12.
_GOLDEN = (5.0**0.5 - 1.0) / 2.0
_WIDTH = 1e-12

#: Relative changes of the friction whose results are stated.
_OFFSETS = np.array([-0.2, 0.2])

#: Axis of `local_minima`.
_VALUES = ["beta", "peak"]

QUANTITIES = ("acceleration_amplitude", "amplitude", "base_force", "residual", "contact_amplitude")


def least_median(
    system: System,
    records: Sequence[Record],
    beta: Any,
    *,
    quantity: str = "acceleration_amplitude",
    mass: int = 1,
    contact: int = 1,
    quantile: float = 0.5,
    mu: float = 1.0,
    units: Units | None = None,
    after: str | float = "rest",
    threads: int | None = None,
) -> xr.Dataset:
    """Find the friction with the least median, or quantile, of a peak over a suite of records.

    The least median may lie on a kink where two records are equal, and there may be several local minima:
    each one on a grid of 50 is refined by golden sections.

    Parameters
    ----------
    system : System
    records : sequence of Record
    beta : (from, to)
        Range of friction that is searched; as `beta` of `history`.
    quantity : str
        "acceleration_amplitude", "amplitude", "base_force", "residual" (its modulus) or "contact_amplitude".
    mass, contact : int
        Of which mass or contact it is, counted from 1.
    quantile : float
        Share of the records that stay below it; 0.5: the median.
    mu, units, after, threads : as in `history`

    Returns
    -------
    xarray.Dataset
        `beta`, `peak`, and `peak_of_record` there; `peak_of_beta` over `beta_search`; `peak_of_offset` with
        20 % less and more friction; `local_minima` (beta, peak).  `least_between`: what the quantile cannot
        fall below between a value of `beta_search` and the next one; `missed_at_most`: how much lower than
        `peak` it can be between them.  Both are bounds from the energy of the difference of two motions, for
        mu = 1; NaN of accelerations and forces, which jump with the friction force.

    Raises
    ------
    InputError
        An argument has the wrong type or is out of range.

    Examples
    --------
    The friction with which the median distance from the place of rest after three pulses is least:

    >>> import frictionmap as fm
    >>> pulses = [fm.Record([0.0, a, -a, 0.0], dt=1.0, quantity="force") for a in (0.8, 1.0, 1.3)]
    >>> system = fm.System(damping_ratios=0.02)
    >>> ds = fm.design.least_median(system, pulses, beta=(0.01, 0.5), quantity="residual")
    >>> round(ds.beta.item(), 4)
    0.0131
    """
    checks.choice(quantity, "quantity", QUANTITIES)
    quantile = checks.number(quantile, "quantile", least=0.0, most=1.0)
    ends = friction_ratios(beta, "beta", motion_scales(units, system))
    if ends.size != 2 or ends[0] >= ends[1]:
        raise InputError("beta", f"must be two values of friction, from and to; got {checks.one_line(beta)}")
    options: dict[str, Any] = {"mu": mu, "units": units, "after": after, "threads": threads}

    place = {"dof": system.dofs.number(mass, "mass") - 1, "contact": contact - 1}

    def motions(friction: np.ndarray) -> xr.Dataset:
        return history(system, records, beta=friction, samples="none", beta_hold=False, **options)

    def peaks(friction: np.ndarray) -> np.ndarray:
        return _values_at(abs(motions(friction)[quantity]), place)

    def least(friction: np.ndarray) -> np.ndarray:
        order = np.unique(friction)
        found = np.quantile(peaks(order), quantile, axis=0)
        return found[np.searchsorted(order, friction)]

    grid = np.linspace(ends[0], ends[1], GRID)
    first = _with(quantity, motions(grid))
    values = _values_at(abs(first[quantity]), place)
    over = np.quantile(values, quantile, axis=0)
    apart = _apart(system, first, quantity, grid[1] - grid[0], units)
    lowest = np.maximum(values - (np.nan if apart is None else _values_at(apart, place)), 0.0)
    between = np.quantile(lowest, quantile, axis=0)[:-1]
    minima = _refined(least, grid, over)
    best = int(np.argmin(minima[1]))
    answer, peak = float(minima[0, best]), float(minima[1, best])
    return xr.Dataset(
        {
            "beta": ((), answer), "peak": ((), peak),
            "peak_of_record": ("record", peaks(np.array([answer]))[:, 0]),
            "peak_of_beta": ("beta_search", over),
            "least_between": ("beta_search", np.append(between, np.nan)),
            "missed_at_most": ((), np.maximum(0.0, peak - between.min())),
            "peak_of_offset": ("offset", least(answer * (1.0 + _OFFSETS))),
            "local_minima": (("value", "minimum"), minima),
        },
        {"beta_search": grid, "record": np.arange(1, len(records) + 1), "offset": _OFFSETS, "value": _VALUES},
        {"quantity": quantity, "quantile": quantile},
    )  # fmt: skip


def _with(quantity: str, ds: xr.Dataset) -> xr.Dataset:
    """Motions that have a quantity; of structures given by modes some are not known."""
    if quantity not in ds:
        there = ", ".join(name for name in QUANTITIES if name in ds)
        raise InputError("quantity", f"must be one of {there} for points of modes; got {quantity!r}")
    return ds


def _apart(
    system: System, ds: xr.Dataset, quantity: str, step: float, units: Units | None
) -> xr.DataArray | None:
    """How far a quantity can be away within a step of friction; None where that has no bound."""
    if quantity not in BOUNDED:
        return None
    return friction_bounds(system, ds, step, units=units)[BOUNDED[quantity]]


def _values_at(values: xr.DataArray, place: Mapping[str, int]) -> np.ndarray:
    """The values of one mass or one contact, (record, beta)."""
    values = values.isel(scale=0, mu=0).isel(place, missing_dims="ignore")
    return values.transpose("record", "beta").values


def _refined(least: Any, grid: np.ndarray, over: np.ndarray) -> np.ndarray:
    """The local minima of the grid, refined: (2, minima) of friction and value."""
    padded = np.concatenate(([np.inf], over, [np.inf]))
    k = np.flatnonzero((over <= padded[:-2]) & (over <= padded[2:]))
    low, high = grid[np.maximum(k - 1, 0)], grid[np.minimum(k + 1, grid.size - 1)]
    inner = np.array([high - _GOLDEN * (high - low), low + _GOLDEN * (high - low)])
    values = np.array([least(inner[0]), least(inner[1])])
    while ((high - low) > _WIDTH * high).any():
        left = values[0] <= values[1]  # the minimum is left of the second inner point
        low, high = np.where(left, low, inner[0]), np.where(left, inner[1], high)
        kept, kept_value = np.where(left, inner[0], inner[1]), np.where(left, values[0], values[1])
        new = np.where(left, high - _GOLDEN * (high - low), low + _GOLDEN * (high - low))
        new_value = least(new)
        inner = np.where(left, [new, kept], [kept, new])
        values = np.where(left, [new_value, kept_value], [kept_value, new_value])
    found = np.array([[*inner[0], *inner[1], *grid[k]], [*values[0], *values[1], *over[k]]]).reshape(2, 3, -1)
    best = found[1].argmin(axis=0)
    return found[:, best, np.arange(k.size)]
