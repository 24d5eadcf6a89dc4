"""Groups of cells of one mass: around both boundaries, between them, and at both ends of every parameter."""

import numpy as np

from ...references.closed_forms import Number, mp
from .bodies import one_mass, one_mass_rows
from .check_cells import check_cells
from .group import Group
from .points import around, exponents
from .row import Row

#: Stops next to the boundaries are counted in every so many rows: a march takes a second.
_EVERY = 19


def _check_edge(group: Group, row: Row, edge: Number, index: int, quick: bool) -> None:
    """Check cells around a boundary; stops are counted in a few rows only, because this is slow."""
    check_cells(group, row, around(edge, exponents(quick)))
    if index % _EVERY == 0:
        check_cells(group, row, around(edge, (3, 6)), count=True)


def cells_at_lim(quick: bool) -> Group:
    """Cells at beta = beta_lim (1 +- 10^-k), mu = 1."""
    group = Group("cells, beta around beta_lim")
    for index, (body, r) in enumerate(one_mass_rows(quick)):
        row = Row.of(body, r)
        if row.lim != 0 and row.lim <= row.stick:
            _check_edge(group, row, row.lim, index, quick)
    return group


def cells_at_stick(quick: bool) -> Group:
    """Cells at beta = beta_stick (1 +- 10^-k), mu = 1."""
    group = Group("cells, beta around beta_stick")
    for index, (body, r) in enumerate(one_mass_rows(quick)):
        row = Row.of(body, r)
        _check_edge(group, row, row.stick, index, quick)
    return group


def cells_without_friction(quick: bool) -> Group:
    """Cells at beta = 0 and 10^-k."""
    group = Group("cells, beta = 0 and 10^-k")
    for body, r in one_mass_rows(quick):
        check_cells(group, Row.of(body, r), [(None, 0.0), *((k, 10.0**-k) for k in exponents(quick))])
    return group


def cells_inside(quick: bool) -> Group:
    """Cells in the strip between the boundaries, mu = 1."""
    group = Group("cells inside the strip, stops counted")
    rng = np.random.default_rng(5)
    for body, r in one_mass_rows(quick)[:: 1 if quick else 3]:
        row = Row.of(body, r)
        if row.lim < row.stick:
            share = mp.mpf(rng.uniform(0.02, 0.98))
            check_cells(group, row, [(None, float(row.lim + share * (row.stick - row.lim)))], count=True)
    return group


def cells_at_mu(quick: bool) -> Group:
    """Cells at mu = 1 + 10^-k, from rest."""
    group = Group("cells, mu = 1 + 10^-k, stops counted")
    places = (
        ((0.3, 0.0), (1.2, 0.05)) if quick else ((0.1, 0.0), (0.3, 0.0), (0.7, 0.02), (1.2, 0.05), (3.0, 0.3))
    )
    for r, zeta in places:
        for k in exponents(quick)[:: 1 if quick else 2]:
            row = Row.of(one_mass(zeta), r, 1.0 + 10.0**-k)
            check_cells(group, row, [(k, float(row.lim + (row.stick - row.lim) / 3))], count=True)
    return group


def cells_chattering(quick: bool) -> Group:
    """Cells at low r with many short stops per cycle."""
    group = Group("cells, chattering (r to 0.015), stops counted")
    for r in (0.03,) if quick else (0.03, 0.015):
        for zeta in (0.0, 0.02):
            row = Row.of(one_mass(zeta), r)
            betas = (0.5,) if quick else (0.2, 0.5, 0.9)
            check_cells(group, row, [(None, beta) for beta in betas], count=True)
    return group


def cells_far(quick: bool) -> Group:
    """Cells at r from 1e-6 to 1e6."""
    group = Group("cells, r = 1e-6 to 1e6")
    for e in (-2, 3, 6) if quick else range(-6, 7):
        for zeta in (0.0, 0.05, 2.0) if e > -5 else (0.0,):
            # undamped there are 10^4 and more slides a cycle, each with its stop
            shares = (0.5,) if e < -3 and zeta == 0.0 else (0.01, 0.3, 0.7, 0.99)
            row = Row.of(one_mass(zeta), 10.0**e)
            cells = [(None, float(row.lim + mp.mpf(share) * (row.stick - row.lim))) for share in shares]
            check_cells(
                group,
                row,
                [*cells, (None, float(row.lim / 2)), (None, 2.0)],
                count=e >= 0,
                cycles=2000 if e > -5 else 20,
            )
    return group


def million_cycles(quick: bool) -> Group:
    """Cells marched for up to 10^6 cycles: the digits that remain of the closed form."""
    group = Group("marched, cycles = 10^6" if not quick else "marched, cycles = 10^4")
    cycles = 10**4 if quick else 10**6
    for r, zeta, share in ((0.999, 0.0, 0.01), (0.97, 1e-5, 0.001), (5.0, 0.0, 0.9), (20.0, 0.0, 0.5)):
        row = Row.of(one_mass(zeta), r)
        check_cells(
            group, row, [(None, float(share * row.lim))], cycles=cycles, skip="none", steady="marched",
            tolerance=1e-15,
        )  # fmt: skip
        check_cells(
            group, row, [(None, float(row.lim + (row.stick - row.lim) / 2))], cycles=cycles, skip="none",
            steady="marched", tolerance=1e-15, count=True,
        )  # fmt: skip
    return group
