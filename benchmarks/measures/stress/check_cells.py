"""Checks of the cells of one (r, mu): regimes, amplitudes and stops against 40 digits, and consistency."""

import math
import warnings
from collections.abc import Iterable, Iterator
from functools import partial
from typing import Any

import numpy as np

import frictionmap as fm
from frictionmap import regimes

from ...references import closed_forms
from ...references.closed_forms import mp
from .check_counts import check_count
from .group import STATUS_NAMES, Group, watched
from .row import Row

OUTPUTS = (
    "regime", "stops_per_cycle", "contact_amplitude", "stuck_fraction", "period", "origin", "cycles",
    "status",
)  # fmt: skip
#: Turns a cycle of what beta_lim is the boundary of, with some room for a turn at the end of the samples.
_TWO = 2.5


def check_cells(
    group: Group, row: Row, cells: Iterable[tuple[int | None, float]], *, count: bool = False,
    **settings: Any,
) -> None:  # fmt: skip
    """Check cells (k, beta) of one row; with `count` (one mass), stops against 40-digit steady states."""
    k_of = {beta: k for k, beta in cells if beta >= 0.0}
    betas = sorted(k_of)
    where = f"{row.body.name}, r = {row.r!r}, mu = {row.mu!r}"
    ds = watched(
        group, where,
        lambda: fm.sweep(
            row.body.system, [row.r], betas, row.mu, threads=1, outputs=OUTPUTS, **settings
        ),
        len(betas),
    )  # fmt: skip
    if ds is None:
        return
    for j, beta in enumerate(betas):
        cell = {name: ds[name].values[0, 0, j].item() for name in OUTPUTS}
        what = f"{where}, beta = {beta!r}"
        group.cells += 1
        group.statuses[cell["status"]] += 1
        _check_consistent(group, what, cell)
        _check_regime(group, row, beta, what, cell)
        if cell["regime"] == regimes.CONTINUOUS and row.regime(beta) == regimes.CONTINUOUS:
            group.compare(
                f"amplitude: {what}", k_of[beta], cell["contact_amplitude"], row.amplitude(beta),
                partial(_amplitude_condition, row, beta),
            )  # fmt: skip
        elif count and cell["regime"] == regimes.STICK_SLIP:
            check_count(group, row, k_of[beta], beta, what, cell)


def _amplitude_condition(row: Row, beta: float) -> Iterator:
    yield closed_forms.condition(lambda r: row.amplitude(beta, r), row.r)
    if beta > 0.0:
        yield closed_forms.condition(row.amplitude, beta)


def _check_consistent(group: Group, what: str, cell: dict) -> None:
    """Check that outputs do not contradict each other."""
    z, stops, stuck = cell["contact_amplitude"], cell["stops_per_cycle"], cell["stuck_fraction"]
    resolved = cell["status"] == regimes.RESOLVED
    regime = cell["regime"]
    slips = regime == regimes.STICK_SLIP
    for wrong, words in (
        (resolved and regime == regimes.UNRESOLVED, "resolved without a regime"),
        (resolved and math.isnan(z), "resolved, amplitude NaN"),
        (resolved and slips and math.isnan(stops), "resolved, stops NaN"),
        (resolved and slips and not stops > 0.0, f"slips with {stops} stops"),
        (regime == regimes.CONTINUOUS and stops != 0.0, f"continuous with {stops} stops"),
        (z < 0.0 or stops < 0.0, "negative"),
        (not (0.0 <= stuck <= 1.0) and not math.isnan(stuck), f"stuck for {stuck}"),
        (regime == regimes.PERMANENT_STICKING and z != 0.0, "stuck with an amplitude"),
        (resolved and slips and cell["period"] < 1, f"period {cell['period']}"),
    ):
        if wrong:
            group.inconsistent.append(f"{what}: {words}")


def _check_regime(group: Group, row: Row, beta: float, what: str, cell: dict) -> None:
    want, regime = row.regime(beta), cell["regime"]
    if want is None or regime in (want, regimes.UNRESOLVED):
        return
    if (want, regime) == (regimes.STICK_SLIP, regimes.CONTINUOUS) and _turns(row, beta) > _TWO:
        group.many_turns += 1
        return
    if row.near(beta):
        group.at_rounding += 1
        return
    edge = min((row.lim, row.stick), key=lambda x: abs(mp.mpf(beta) - x))
    distance = float((mp.mpf(beta) - edge) / edge) if edge else math.inf
    group.wrong.append(
        f"{what}: regime {regime}, is {want}; {distance:+.1e} from the boundary, "
        f"status {STATUS_NAMES[cell['status']]}"
    )


def _turns(row: Row, beta: float) -> float:
    """Changes of direction per cycle of the steady state found by the package."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            direction = fm.response(row.body.system, row.r, beta, row.mu).direction
        except fm.NoSteadyState:
            return math.nan
    moving = direction.values[direction.values != 0]
    cycles = round(float(direction.tau[-1]) / (2.0 * math.pi))
    return float(np.count_nonzero(np.diff(moving, append=moving[0]))) / cycles
