"""All friction with which a response stays within a limit over a band."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from ... import checks
from ...datasets.amounts import DOWN, UP, Amounts, amounts_of, band_of
from ...datasets.design_labels import beta_label, size_label
from ...datasets.labels import Label
from ...files.key import Key, either, number, with_unit
from ...model.system import System
from ...units.axes import require
from ...units.scales import Units, scales_of
from .keys import BAND, OF_PEAKS
from .record import Goal, Question, Ranges
from .rows import LISTED, answer_rows, change_rows, peak_rows
from .sentences import limit_of, range_of_regimes, whole_sentence

if TYPE_CHECKING:
    import xarray as xr


def at_most(
    system: System,
    band: Any,
    limit: Any,
    mass: int = 1,
    mu: float = 1.0,
    *,
    quantity: str = "amplitude",
    contact: int = 1,
    beta: Any = None,
    threads: int | None = None,
    units: Units | None = None,
) -> "xr.Dataset":
    """Find all friction with which a response stays within a limit over a band of frequencies.

    Parameters
    ----------
    limit : float or str
        Largest response that is allowed, over P/k1 (Y), or of a force over P; with units also a length or a
        force, such as "3 mm".
    others
        As in `least_peak`.

    Returns
    -------
    xarray.Dataset
        That of `least_peak`, with `interval_begin` and `interval_end` (interval): ranges of the friction
        ratio.  A range may have no end: from `beta_stuck` on nothing changes.

    Raises
    ------
    InputError
        As `least_peak`; or the limit is below the least peak, which the message gives.
    NoSteadyState
        As `least_peak`.

    Examples
    --------
    >>> import frictionmap as fm
    >>> pair = fm.System(contact_masses=[2], mass_ratios=[1, 1], stiffness_ratios=[1, 1], damping_ratios=0.01)
    >>> ds = fm.design.at_most(pair, band=[0.3, 2.2], limit=4.0)
    >>> round(ds.interval_begin.values[0].item(), 3), round(ds.interval_end.values[0].item(), 3)
    (0.957, 2.668)
    """
    from ..answers import peaks_answer
    from ..ranges import find_ranges
    from ..task import checked_number, checked_task

    checks.instance(system, "system", System)
    scales = scales_of(units, system)
    kind = "force" if quantity == "transmitted_force" else "length"
    require(scales, limit=(kind, limit), band=("frequency", band), beta=("force", beta))
    value = checked_number(limit, "limit", kind, scales, above=0.0)
    task = checked_task(system, band, (quantity, mass, contact), mu, beta, threads, units)
    curve = task.performance()
    optimum, begins, ends = find_ranges(task, curve, value, limit)
    ranges = {"interval": np.arange(1, begins.size + 1), "interval_begin": begins, "interval_end": ends}
    force = scales.of("force")
    if force is not None:
        ranges |= {"interval_begin_N": begins * force, "interval_end_N": ends * force}
    ds = peaks_answer("at-most", task, curve, optimum, {"limit": value}, ranges)
    if isinstance(limit, str):
        ds["limit"].attrs["given"] = limit  # the unit of the user
    return ds


def allowed_ranges(ds: "xr.Dataset") -> Ranges:
    """The friction that is allowed."""
    return list(zip(ds["interval_begin"].values.tolist(), ds["interval_end"].values.tolist(), strict=True))


def _range_words(words: Amounts, begin: float, end: float) -> str:
    """A range of friction, each end rounded into it."""
    if np.isinf(end):
        return f"from {words.friction(begin, UP)}"
    if begin == 0.0:
        return f"up to {words.friction(end, DOWN)}"
    return f"from {words.friction_range(begin, end)}"


def _range_sentence(ds: "xr.Dataset") -> Iterator[str]:
    """The friction that keeps the limit, and the best one."""
    if not {"interval_begin", "interval_end", "limit"} <= set(ds.variables):
        return
    words, ranges = amounts_of(ds), [one for one in allowed_ranges(ds) if one[0] <= one[1]]
    listed = " and ".join(_range_words(words, *one) for one in ranges[:LISTED])
    best = ""
    if {"beta", "peak"} <= set(ds.variables):
        best = f" ({words.response(float(ds['peak'][0]), UP)} at {words.friction(float(ds['beta']))})"
    yield whole_sentence(f"{listed} {words.stays(limit_of(ds))}{band_of(ds)}{best}")


def _range_rows(ds: "xr.Dataset") -> Iterator[tuple[str, str]]:
    """The ranges of friction."""
    if not {"interval_begin", "interval_end"} <= set(ds):
        return
    words = amounts_of(ds)
    for k, (begin, end) in enumerate(allowed_ranges(ds)[:LISTED]):
        limit = f" for at most {limit_of(ds)}" if "limit" in ds else ""
        last = f"to {words.friction_and_ratio(end)}" if np.isfinite(end) else "or more"
        yield (f"friction{limit}" if k == 0 else ""), f"{words.friction_and_ratio(begin)} {last}"


_LIMIT = Key(
    "limit",
    "for at-most: the largest response allowed; displacements over P/k_1, forces over P",
    either(number(above=0.0), with_unit("length"), with_unit("force")),
    example="4.0",
    words="a number > 0, or a length or force with its unit",
)

AT_MOST = Question(
    name="at-most",
    title="Friction that keeps a response within a limit",
    function=at_most,
    needed=(BAND, _LIMIT),
    optional=OF_PEAKS,
    labels={
        "limit": Label(np.float64, "largest response that is allowed", (), least=0.0),
        "interval": Label(np.int64, "interval, counted from 1", ("interval",), least=1),
        "interval_begin": beta_label("friction ratio at which an allowed range begins", ("interval",)),
        "interval_end": beta_label("friction ratio at which an allowed range ends", ("interval",)),
        "interval_begin_N": size_label(
            "friction force at which an allowed range begins", ("interval",), units="N"
        ),
        "interval_end_N": size_label(
            "friction force at which an allowed range ends", ("interval",), units="N"
        ),
    },
    rows=(answer_rows, peak_rows, change_rows, _range_rows),
    panels=("performance", "responses"),
    goal=Goal("never above", lambda ds, _: allowed_ranges(ds)),
    sentences=(_range_sentence, range_of_regimes),
)
