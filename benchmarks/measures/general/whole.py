"""Whole maps by the public function, on one thread, and the boundaries of a frequency.

The quick form computes every tenth point of the outer axis with all cells along the inner one, and scales the
time: a cell then still has the neighbours that it has in the whole map.
"""

import numpy as np
import xarray as xr

import frictionmap as fm

from ...report.record import spread, table, timed
from .scenes import E1, ELASTIC, SCENES

FORCES = "force-force map of E1, 300 x 300"
SPRING = "map at kt = 3, 500 x 500"

_FREQUENCY = 0.5  # of the force-force map
_EVERY = {False: 1, True: 10}  # by quick
_ROUNDS = {False: 3, True: 1}

_OUTPUTS = {
    FORCES: ("regime", "stops_per_cycle", "contact_amplitude", "status"),
    SPRING: ("regime", "slip_reversals_per_cycle", "contact_amplitude", "status"),
}

#: Frequencies at which boundaries are computed, by quick.
_FREQUENCIES = {False: 60, True: 3}


def _force_force(every: int) -> xr.Dataset:
    """Regimes of E1 over the friction of both contacts."""
    system = SCENES[E1].system()
    axes = {"contacts[2].force": np.linspace(0.0, 1.5, 300)[every // 2 :: every]}
    beta = np.linspace(0.0, 1.5, 300)
    return fm.sweep(system, [_FREQUENCY], beta, axes=axes, outputs=_OUTPUTS[FORCES], threads=1)


def _spring(every: int) -> xr.Dataset:
    """Regimes of one mass with an elastic contact over frequency and friction."""
    r = np.linspace(0.1, 3.0, 500)[every // 2 :: every]
    beta = np.linspace(0.0, 4.0, 500)
    return fm.sweep(SCENES[ELASTIC].system(), r, beta, outputs=_OUTPUTS[SPRING], threads=1)


def maps(quick: bool) -> dict:
    """Measure and print whole maps; in quick a part of them, scaled."""
    content = {}
    every = _EVERY[quick]
    for name, compute in ((FORCES, _force_force), (SPRING, _spring)):
        compute(100)  # compiles
        runs = [timed(lambda c=compute: c(every)) for _ in range(_ROUNDS[quick])]
        status = runs[0][1].status.values
        content[name] = {
            "cells computed": int(status.size),
            "computed, one of": every,
            "unresolved": int((status != 0).sum()),
            "seconds, scaled to the whole": spread([every * seconds for seconds, _ in runs]),
        }
    table(
        ("maps, one thread", "cells computed", "s for the whole", "unresolved"),
        [
            (
                name, entry["cells computed"], entry["seconds, scaled to the whole"]["median"],
                entry["unresolved"],
            )
            for name, entry in content.items()
        ],
    )  # fmt: skip
    return content


def boundaries(quick: bool) -> dict:
    """Measure and print the time of all boundaries at one frequency."""
    content = {}
    for name, scene in SCENES.items():
        system, r = scene.system(), np.linspace(*scene.frequencies, _FREQUENCIES[quick])
        # `boundaries` takes no number of threads, so the process is kept on one processor
        fm.boundaries(system, r[:1])
        seconds = [timed(lambda s=system, x=r: fm.boundaries(s, x))[0] / r.size for _ in range(3)]
        content[name] = {"frequencies": r.size, "seconds a frequency": spread(seconds)}
    table(
        ("boundaries", "frequencies", "ms a frequency"),
        [
            (name, entry["frequencies"], 1e3 * entry["seconds a frequency"]["median"])
            for name, entry in content.items()
        ],
    )
    return content
