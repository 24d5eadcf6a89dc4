"""Sizes of steady states on a grid and at scattered points."""

from dataclasses import replace
from typing import Any

import numpy as np

from ..jobs import Watch
from ..model.settings import Output, Solver
from ..model.sizes import Sizes, Wanted
from ..model.system import System
from .maps import compute
from .quantity_data import QuantityRequest, quantity_request, read_result
from .scattered import scattered_cells

#: Variables of cells over a cycle, and outputs of maps, by quantity.
_OF_CYCLE = {"first_harmonic": "first_harmonic_amplitude", "transmitted_force": "transmitted_force"}
_OUTPUTS: dict[str, Output] = {"amplitude": "amplitude", "contact": "contact_amplitude"}

_ALWAYS: tuple[Output, ...] = ("regime", "stops_per_cycle", "status")

#: Points computed together, neighbours in beta: cells that formulas decide are filled for every beta between.
_TOGETHER = 128

QUANTITIES = (*_OUTPUTS, *_OF_CYCLE)


def _settings_and_request(wanted: Wanted, solver: Solver) -> tuple[Solver, QuantityRequest | None]:
    """Settings and request that give a size."""
    if wanted.quantity in _OUTPUTS:
        return replace(solver, outputs=[*_ALWAYS, _OUTPUTS[wanted.quantity]]), None
    return replace(solver, outputs=_ALWAYS), quantity_request((_OF_CYCLE[wanted.quantity],))


def _read(wanted: Wanted, cells: Any, out: Any, place: tuple) -> Sizes:
    if wanted.quantity in _OF_CYCLE:
        size = read_result(_OF_CYCLE[wanted.quantity], cells.results)
    else:
        size = getattr(out, _OUTPUTS[wanted.quantity])
    if size.ndim == 4:
        size = size[..., wanted.row]
    return Sizes(size[place], out.regime[place], out.stops_per_cycle[place], out.status[place])


def sizes_on_grid(
    system: System, wanted: Wanted, axes: dict[str, np.ndarray], solver: Solver, threads: int,
    watch: Watch | None,
) -> Sizes:  # fmt: skip
    """Sizes over the axes r and beta, at one mu, (n_r, n_beta)."""
    settings, request = _settings_and_request(wanted, solver)
    cells, out = compute(system, axes, settings, request, threads, None, watch)
    return _read(wanted, cells, out, (0,))


def sizes_at(
    system: System, wanted: Wanted, r: np.ndarray, beta: np.ndarray, mu: float, solver: Solver,
    watch: Watch | None,
) -> Sizes:  # fmt: skip
    """Sizes at points (k,); `watch` may end the computation."""
    settings, request = _settings_and_request(wanted, solver)
    by_beta = np.argsort(beta, kind="stable")
    parts, places = [], []
    for first in range(0, r.size, _TOGETHER):
        if watch is not None:
            watch()
        some = by_beta[first : first + _TOGETHER]
        some = some[np.argsort(r[some], kind="stable")]
        found = scattered_cells(system, r[some], beta[some], mu, settings, request)
        parts.append(_read(wanted, found.cells, found.out, (0, np.arange(some.size), found.column)))
        places.append(some)
    back = np.argsort(np.concatenate(places), kind="stable")
    return Sizes(*(np.concatenate(arrays)[back] for arrays in zip(*parts, strict=True)))
