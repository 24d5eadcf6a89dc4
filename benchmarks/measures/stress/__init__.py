"""The numerical torture test: cells at and around every singular point, against 40-digit arithmetic.

Every number that has an answer in 40 digits (`references`) is compared with it.  Digits lost are those of the
relative error over the rounding of a double, 2^-53; its condition number, the relative change of the answer
per relative change of what it is computed from (r, beta, mu, zeta, ratios of masses and springs), explains
log10 of it.  What is lost beyond counts; cells with more than `ALLOWED` are listed, one by one.

Regimes at mu = 1 are proved: continuous below beta_lim, stuck from beta_stick on; boundaries of 40 digits say
on which side a double lies.  Between them motions stop, or turn more than twice a cycle.  A wrong regime is
`at rounding` where it is nearer to the boundary than the rounding of r can tell, else it is listed.  Stops
are counted by the 40-digit steady state, found from rest, or for mu = 1 from anywhere.  Where there is no
such answer, outputs have to agree with each other and their status.  Random cells (`random_cells`) follow.
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
RANDOM_CELLS = {False: (1_000_000, 600.0), True: (300, 5.0)}

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
