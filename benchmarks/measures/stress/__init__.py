"""Numerical torture test: cells at and around every singular point, against 40-digit arithmetic.

Every number with a 40-digit reference (`references`) is compared with it. The digits lost are the logarithm
of the relative error over the rounding error of a double, 2^-53. The condition number is the relative change
of the result per relative change of its inputs (r, beta, mu, zeta, mass and stiffness ratios). It explains as
many digits as its logarithm. Only the digits lost beyond these count; cells that lose more than `ALLOWED` are
listed individually.

Regimes at mu = 1 are proved: continuous below beta_lim, stuck at or above beta_stick; the 40-digit boundaries
show on which side a double lies. Between them motions stop, or turn more than twice per cycle. A wrong regime
is `at rounding` if it is closer to the boundary than the rounding of r can resolve; otherwise it is listed.
Stops are compared with the 40-digit steady state, found from rest, or for mu = 1 from any initial state.
Without such a reference, outputs must be consistent with each other and with their status. Random cells
(`random_cells`) follow.
"""

import time
from collections.abc import Callable
from pathlib import Path

from ...report.record import pinned, save
from . import random_cells
from .cells import (
    cells_at_lim,
    cells_at_mu,
    cells_at_stick,
    cells_chattering,
    cells_far,
    cells_inside,
    cells_without_friction,
    million_cycles,
)
from .chains import cells_of_chains, cells_of_close_modes
from .curves import (
    curves_at_modes,
    curves_at_r,
    curves_at_zeta,
    curves_close_modes,
    curves_far,
    curves_spread,
)
from .grazing import cells_grazing
from .group import ALLOWED, Group
from .picture import draw
from .summary import print_summaries, summary

#: Random cells wanted, and seconds after which to be content with fewer; by quick.
RANDOM_CELLS = {False: (200_000, 200.0), True: (100, 5.0)}

GROUPS: tuple[Callable[[bool], Group], ...] = (
    curves_at_r, curves_at_zeta, curves_far, curves_at_modes, curves_spread, curves_close_modes, cells_at_lim,
    cells_at_stick, cells_without_friction, cells_inside, cells_at_mu, cells_grazing, cells_chattering,
    cells_far, cells_of_chains, cells_of_close_modes, million_cycles,
)  # fmt: skip


def run(quick: bool, results: Path) -> dict:
    """Run every group, print, save and draw."""
    groups = []
    with pinned():
        for make in GROUPS:
            began = time.perf_counter()
            group = make(quick)
            group.seconds = time.perf_counter() - began
            groups.append(group)
            print(f"{group.name}: {group.seconds:.1f} s", flush=True)
    summaries = {group.name: summary(group) for group in groups}
    print_summaries(summaries)
    random = random_cells.random_cells(*RANDOM_CELLS[quick])
    random_cells.report(random)
    content = {
        "allowed beyond the condition number": ALLOWED,
        "groups": summaries,
        "random cells": random,
    }
    save("stress", content, results)
    draw(groups, results / "stress.png")
    return content
