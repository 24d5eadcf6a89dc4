"""Several contacts, elastic contacts and periodic loads: time per cell, whole maps, against other solvers.

All times are those of one thread with everything compiled, medians over rounds, mu = 1.

========  =============================================================================================
scenes    systems that are measured, as the package and as the other solvers define them
kernels   cells by the kernels of the package: rows of a map, and single cells from rest
cost      time per stick-slip cell in rows of a map, also over the number of contacts
whole     whole maps, and the boundaries of a frequency
against   time against error: DOP853 and heyoka with switching logic, Moreau-Jean time stepping
balance   time against error for an elastic contact: harmonic balance
picture   the picture
========  =============================================================================================
"""

from pathlib import Path

from ...report.record import pinned, save
from .against import other_solvers
from .balance import harmonic_balance
from .cost import cell_costs, costs_over_contacts
from .picture import draw
from .whole import boundaries, maps


def run(quick: bool, results: Path) -> dict:
    """Measure, print, save and draw."""
    with pinned():
        content = {
            "cells": cell_costs(quick),
            "contacts": costs_over_contacts(quick),
            "maps": maps(quick),
            "boundaries": boundaries(quick),
            "harmonic balance": harmonic_balance(quick),
            "other solvers": other_solvers(quick),
        }
    save("general", content, results)
    draw(content, results / "general.png")
    return content
