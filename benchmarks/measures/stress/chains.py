"""Groups of cells of chains: regimes around both boundaries."""

import math

from ...references.closed_forms import mp
from .bodies import chains, close_modes
from .check_cells import check_cells
from .group import Group
from .points import around
from .row import Row


def cells_of_chains(quick: bool) -> Group:
    """Chains: beta around both boundaries, at singular and other frequencies, mu = 1."""
    group = Group("cells of chains, beta around beta_lim, beta_stick")
    distances = (3, 10) if quick else (1, 3, 5, 7, 9, 11, 13, 15)
    for body in chains(quick):
        own = body.own
        held = float(body.system.modes.held_frequencies()[0])
        ratios = (0.7, float(own.w[0])) if quick else (
            0.31, 0.7, 1.3, float(own.w[0]), float(own.w[1]) * (1.0 - 1e-9), float(own.w[0]) / 2.0, held,
            held * (1.0 + 1e-6), 30.0,
        )  # fmt: skip
        for r in ratios:
            row = Row.of(body, r)
            if not (0 < row.lim < row.stick):
                continue
            cells = around(row.lim, distances) + around((row.lim + row.stick) / 2, ())
            if mp.isfinite(row.stick):
                cells += around(row.stick, distances)
            check_cells(group, row, [(k, beta) for k, beta in cells if math.isfinite(beta)])
    return group


def cells_of_close_modes(quick: bool) -> Group:
    """Fifty nearly equal oscillators: regimes around both boundaries."""
    group = Group("cells, 50 close modes")
    for body in (
        [close_modes(8, 1e-6, 0.01)] if quick else [close_modes(50, 1e-2, 0.01), close_modes(50, 1e-6, 0.01)]
    ):
        for r in (0.7,) if quick else (0.7, 1.3):
            row = Row.of(body, r)
            cells = (
                around(row.lim, (2, 8)) + around(row.stick, (2, 8)) + around((row.lim + row.stick) / 2, ())
            )
            check_cells(group, row, cells)
    return group
