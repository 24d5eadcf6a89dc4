"""Cost of maps and curves: memory compared with the available memory, and time extrapolated from a part."""

import contextlib
import math
import os
import time
from collections.abc import Collection, Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from .. import checks
from ..errors import InputError
from ..model.friction_law import MOST_POINTS
from ..model.settings import RECORDED, CurveSettings, Solver
from ..model.system import System
from ..solvers.choose import engine_of
from ..units.scales import Units

if TYPE_CHECKING:
    from ..single.quantity_data import QuantityRequest

#: Bytes that a process uses without any cells.
_BASE = 400e6

#: Bytes in addition to the cells for each value of beta, for each (mu, r), and for each (mu, r) and mass;
#: measured.
_PER_BETA, _PER_FREQUENCY, _PER_MASS = 40.0, 200.0, 300.0

#: Files with the limit and the present use of memory in a container, for both versions of control groups.
_GROUP = Path("/sys/fs/cgroup")
_LIMITS = (
    ("memory.max", "memory.current"),
    ("memory/memory.limit_in_bytes", "memory/memory.usage_in_bytes"),
)

#: Memory of cells while they are written, over their memory before; measured: 1.05.
_WRITING = 1.1

#: Shortest time [s] of a part of the map from which the whole time is extrapolated.
_SAMPLE = 0.5

#: Smallest and largest number of values of an axis in that part.
_FEWEST, _MOST = 8, 256


#: Values of an axis of which cells are counted, at most.
_COUNTED = {"mu": 3, "r": 12, "beta": 12}

#: Seconds, measured: per cell that a formula decides; per integrated period of one mass, a constant and a
#: part in proportion to 1/r; the same for a structure, where the latter part grows with the number of masses.
_DECIDED = 1e-7
_ONE_MASS = (1e-6, 3e-7)
_RETURN, _STEP, _STEP_OF_MASS = 6e-6, 5e-7, 2e-7


def memory_of_map(
    counts: Mapping[str, int], masses: int, outputs: tuple[str, ...], units: Units | None = None
) -> float:
    """Estimate the peak memory in bytes of a map with these numbers of values of mu, r and beta."""
    from ..datasets.labels import LABELS
    from ..single.quantity_data import quantity_request

    of_cycle = [name for name in outputs if LABELS[name].needs == "cycle"]
    sizes = {**counts, "dof": masses, "segment": MOST_POINTS}
    return _memory(sizes, _also_in_si({*outputs, "status"}, units), quantity_request(of_cycle))


def memory_of_curves(
    counts: Mapping[str, int], masses: int, settings: CurveSettings, units: Units | None = None
) -> float:
    """Estimate the peak memory in bytes of response curves with these numbers of values of mu, r and beta."""
    from ..single.curves import cycle_variables, older_names, plain_outputs
    from ..single.quantity_data import quantity_request

    sizes = {**counts, "dof": masses, "harmonic": settings.harmonics + 1, "part": 2}
    names = cycle_variables(settings)
    recorded = {name for name in settings.quantities if name in RECORDED}
    variables = _also_in_si({*plain_outputs(settings), *names, *older_names(names), *recorded}, units)
    return _memory(sizes, variables, quantity_request(names, settings.harmonics), "curves")


def _also_in_si(names: Collection[str], units: Units | None) -> set[str]:
    """Names of variables, and of all their possible counterparts in SI units."""
    from ..datasets.labels import MEASURE_OF, in_si

    beside = [in_si(name, MEASURE_OF[name]) for name in names if name in MEASURE_OF]
    return {*names, *(beside if units is not None else ())}


def _memory(
    counts: Mapping[str, int], names: Collection[str], request: "QuantityRequest", what: str = ""
) -> float:
    """Estimate the bytes of the variables of all cells, and of their results over a cycle.

    what : kind of the dataset, see `labels_of`
    """
    from ..datasets.labels import labels_of
    from ..single.quantity_data import results

    masses, labels = counts["dof"], labels_of(what)
    points = counts.get("points", 1)  # along further axes
    kept = sum(array.nbytes for array in results((1, 1, 1), masses, request))
    one = float(kept) * counts["mu"] * counts["r"] * counts["beta"]  # for one map; they are not kept
    cells = 0.0
    for name in names:
        label = labels[name]
        cells += np.dtype(label.dtype).itemsize * math.prod(
            float(counts.get(dim, 1))
            for dim in label.dims  # those of contacts and springs: `bytes_per_cell`
        )
    frequency = _PER_FREQUENCY + (_PER_MASS * masses if masses > 1 else 0.0)
    rows = counts["mu"] * counts["r"]
    return _BASE + _WRITING * (points * cells + one) + points * rows * frequency + counts["beta"] * _PER_BETA


def available_memory() -> float:
    """Bytes that this process may still allocate; infinite where the system does not report it."""
    found = [_machine_memory()]
    for most, used in _LIMITS:
        with contextlib.suppress(OSError, ValueError):
            found.append(float((_GROUP / most).read_text()) - float((_GROUP / used).read_text()))
    return min(found)


def _machine_memory() -> float:
    with contextlib.suppress(OSError, ValueError, IndexError):
        for line in Path("/proc/meminfo").read_text().splitlines():
            if line.startswith("MemAvailable:"):
                return 1024.0 * float(line.split()[1])
    with contextlib.suppress(OSError, ValueError, AttributeError):
        return float(os.sysconf("SC_PAGE_SIZE")) * float(os.sysconf("SC_PHYS_PAGES"))
    return float("inf")


def refuse_map_without_memory(
    counts: Mapping[str, int], system: System, solver: Solver, _: CurveSettings, units: Units | None
) -> None:
    """Refuse a map that exceeds the available memory, before any is allocated.

    Raises
    ------
    InputError
        States the memory needed and the memory available.
    """
    needed = memory_of_map(counts, system.n, tuple(solver.outputs), units)
    needed += engine_of(system).bytes_per_cell * counts["mu"] * counts["r"] * counts["beta"]
    _refuse(counts, needed, "outputs")


def refuse_curves_without_memory(
    counts: Mapping[str, int], system: System, _: Solver, curves: CurveSettings, units: Units | None
) -> None:
    """Refuse response curves that exceed the available memory; see `refuse_map_without_memory`."""
    _refuse(counts, memory_of_curves(counts, system.n, curves, units), "quantities or harmonics")


def _refuse(counts: Mapping[str, int], needed: float, fewer: str) -> None:
    """Refuse cells that need more memory than is available; `fewer` names what could be requested less."""
    there = available_memory()
    checks.cells(counts["mu"], counts["r"], counts["beta"], points=counts["points"])
    if needed > there:
        cells = counts["mu"] * counts["r"] * counts["beta"] * counts["points"]
        raise InputError(
            f"cannot fit the grid in memory: its {cells:,} cells need about {in_bytes(needed)}, "
            f"{in_bytes(there)} are available; use a coarser grid, request fewer {fewer}, or override "
            f"with --yes"
        )


def seconds_of_map(
    system: System, r: np.ndarray, beta: np.ndarray, mu: np.ndarray, solver: Solver, threads: int | None
) -> float:
    """Estimate the time of a map in seconds from one with fewer frequencies and friction ratios."""
    from .sweep import sweep

    values = _FEWEST
    while True:
        some_r, some_beta = (axis[:: max(1, axis.size // values)] for axis in (r, beta))
        began = time.perf_counter()
        sweep(system, some_r, some_beta, mu, solver=solver, threads=threads)
        took = time.perf_counter() - began
        if values > _FEWEST and (took > _SAMPLE or values >= _MOST):  # the first one compiles
            return took * (r.size * beta.size) / (some_r.size * some_beta.size)
        values *= 2


def seconds_of_cells(
    system: System, axes: Mapping[str, np.ndarray], solver: Solver, threads: int | None = None
) -> float:
    """Seconds that a cell of a map takes on average, on one thread of a common processor; > 0.

    They are counted, not timed: from the excitation periods that some cells are followed for, to the bit the
    same at every call.  Within a factor 3 of what cells take.
    """
    from ..datasets.labels import LABELS
    from ..single.maps import FOLLOWED, SEARCHED, SEARCHED_UNIQUE
    from .sweep import regime_map

    names = [name for name in solver.outputs if LABELS[name].needs != "coexistence"]
    looked_at = len(names) < len(solver.outputs)
    counting = replace(solver, outputs=tuple(dict.fromkeys((*names, "cycles"))))
    some = {name: _spread(values, _COUNTED[name]) for name, values in axes.items()}
    cycles = regime_map(system, some, counting, threads, None)["cycles"].values
    seconds = cycles * _seconds_of_period(system.n, some["r"])[:, np.newaxis] + _DECIDED
    if looked_at:  # the motions from other starts; they cost what a cell does that is followed
        others = np.where(some["mu"] == 1.0, SEARCHED_UNIQUE, SEARCHED) / FOLLOWED
        seconds *= 1.0 + others[:, np.newaxis, np.newaxis]
    return float(seconds.mean())


def _spread(values: np.ndarray, most: int) -> np.ndarray:
    """At most `most` values of an axis: the middles of equal parts of it."""
    count = min(values.size, most)
    return values[((np.arange(count) + 0.5) * values.size / count).astype(int)]


def _seconds_of_period(masses: int, r: np.ndarray) -> np.ndarray:
    """Seconds to follow a cell for an excitation period, over r; a longer period has more steps.

    At r = 0 nothing is followed.
    """
    of_return, of_step = _ONE_MASS if masses == 1 else (_RETURN, _STEP + _STEP_OF_MASS * masses)
    steps = np.divide(of_step, r, out=np.zeros_like(r), where=r > 0.0)
    return of_return + steps


def in_bytes(size: float) -> str:
    """Format a size, such as 1.5 GB."""
    for unit in ("MB", "GB"):
        size /= 1000.0 if unit == "GB" else 1e6
        if size < 1000.0 or unit == "GB":
            break
    return f"{size:.2g} {unit}" if size < 100.0 else f"{size:,.0f} {unit}"


def in_time(seconds: float) -> str:
    """Format a time, such as 40 s, 3 min or 2.5 h."""
    if seconds < 100.0:
        return f"{max(seconds, 1.0):.0f} s"
    return f"{seconds / 60.0:.0f} min" if seconds < 6000.0 else f"{seconds / 3600.0:.1f} h"
