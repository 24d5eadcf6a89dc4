"""What maps and curves will cost: memory, compared with what the machine has, and time, from a small part."""

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
from ..model.settings import CurveSettings, Solver
from ..model.system import System
from ..units.scales import Units

if TYPE_CHECKING:
    from .quantity_data import Asked

#: Bytes that a process takes before it has any cells.
_BASE = 400e6

#: Bytes, beside the cells, for each value of beta, for each (mu, r), and for each (mu, r) and mass; measured.
_PER_BETA, _PER_FREQUENCY, _PER_MASS = 40.0, 200.0, 300.0

#: Where a container says what it may take and what it has taken, in both versions of control groups.
_GROUP = Path("/sys/fs/cgroup")
_LIMITS = (
    ("memory.max", "memory.current"),
    ("memory/memory.limit_in_bytes", "memory/memory.usage_in_bytes"),
)

#: What cells take while they are written, over what they take in memory; measured: 1.05.
_WRITING = 1.1

#: A part of the map that takes so long (s) tells what the rest will take.
_SAMPLE = 0.5

#: Values of an axis in that part, to begin with and at most.
_FEWEST, _MOST = 8, 256


#: Values of an axis of which cells are counted, at most.
_COUNTED = {"mu": 3, "r": 12, "beta": 12}

#: Seconds, measured: of a cell that a formula decides; of a period of a cell that is followed, a part for
#: whatever r and one times r, of one mass; the same of structures, the latter part growing with the masses.
_DECIDED = 1e-7
_ONE_MASS = (1e-6, 3e-7)
_RETURN, _STEP, _STEP_OF_MASS = 6e-6, 5e-7, 2e-7


def memory_of_map(
    counts: Mapping[str, int], masses: int, outputs: tuple[str, ...], units: Units | None = None
) -> float:
    """Bytes that a map with so many values of mu, r and beta takes at its peak."""
    from ..datasets.labels import CELL_VARIABLES
    from .quantity_data import asked_for

    of_cycle = [name for name in outputs if CELL_VARIABLES[name].needs == "cycle"]
    return _memory({**counts, "dof": masses}, _also_in_si({*outputs, "status"}, units), asked_for(of_cycle))


def memory_of_curves(
    counts: Mapping[str, int], masses: int, settings: CurveSettings, units: Units | None = None
) -> float:
    """Bytes that response curves at so many values of mu, r and beta take at their peak."""
    from .curves import cycle_variables, plain_outputs
    from .quantity_data import asked_for

    sizes = {**counts, "dof": masses, "harmonic": settings.harmonics + 1, "part": 2}
    names = cycle_variables(settings)
    variables = _also_in_si({*plain_outputs(settings), *names}, units)
    return _memory(sizes, variables, asked_for(names, settings.harmonics), "curves")


def _also_in_si(names: Collection[str], units: Units | None) -> set[str]:
    """The names of variables, and of the same in SI units, at most."""
    from ..datasets.labels import MEASURE_OF, in_si

    beside = [in_si(name, MEASURE_OF[name]) for name in names if name in MEASURE_OF]
    return {*names, *(beside if units is not None else ())}


def _memory(counts: Mapping[str, int], names: Collection[str], asked: "Asked", what: str = "") -> float:
    """Bytes of so many values of every dimension: variables of cells, and the results of cycles.

    what : the kind of the dataset, see `labels_of`
    """
    from ..datasets.labels import labels_of
    from .quantity_data import results

    masses, labels = counts["dof"], labels_of(what)
    points = counts.get("points", 1)  # along further axes
    kept = sum(array.nbytes for array in results((1, 1, 1), masses, asked))
    one = float(kept) * counts["mu"] * counts["r"] * counts["beta"]  # of a map; they are not kept
    cells = 0.0
    for name in names:
        label = labels[name]
        cells += np.dtype(label.dtype).itemsize * math.prod(float(counts[dim]) for dim in label.dims)
    frequency = _PER_FREQUENCY + (_PER_MASS * masses if masses > 1 else 0.0)
    rows = counts["mu"] * counts["r"]
    return _BASE + _WRITING * (points * cells + one) + points * rows * frequency + counts["beta"] * _PER_BETA


def available_memory() -> float:
    """Bytes that this process may still take; infinite where the machine does not tell."""
    found = [_of_machine()]
    for most, used in _LIMITS:
        with contextlib.suppress(OSError, ValueError):
            found.append(float((_GROUP / most).read_text()) - float((_GROUP / used).read_text()))
    return min(found)


def _of_machine() -> float:
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
    """Refuse a map that this machine has no memory for, before any is taken.

    Raises
    ------
    InputError
        With what is needed and what there is.
    """
    _refuse(counts, memory_of_map(counts, system.n, tuple(solver.outputs), units), "outputs")


def refuse_curves_without_memory(
    counts: Mapping[str, int], system: System, _: Solver, curves: CurveSettings, units: Units | None
) -> None:
    """The same of response curves."""
    _refuse(counts, memory_of_curves(counts, system.n, curves, units), "quantities or harmonics")


def _refuse(counts: Mapping[str, int], needed: float, fewer: str) -> None:
    """Refuse cells that need more memory than there is; `fewer`: of what else there might be fewer."""
    there = available_memory()
    checks.cells(counts["mu"], counts["r"], counts["beta"], points=counts["points"])
    if needed > there:
        cells = counts["mu"] * counts["r"] * counts["beta"] * counts["points"]
        raise InputError(
            f"grid must fit in memory: its {cells:,} cells need about {in_bytes(needed)}, available are "
            f"{in_bytes(there)}; make it coarser, ask for fewer {fewer}, or insist with --yes"
        )


def seconds_of_map(
    system: System, r: np.ndarray, beta: np.ndarray, mu: np.ndarray, solver: Solver, threads: int | None
) -> float:
    """About how long a map takes, from one with fewer frequencies and friction ratios."""
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
    from ..datasets.labels import CELL_VARIABLES
    from .maps import FOLLOWED, LOOKED_AT, LOOKED_AT_SMOOTH, solve_map

    names = [name for name in solver.outputs if CELL_VARIABLES[name].needs != "coexistence"]
    looked_at = len(names) < len(solver.outputs)
    counting = replace(solver, outputs=tuple(dict.fromkeys((*names, "cycles"))))
    some = {name: _spread(values, _COUNTED[name]) for name, values in axes.items()}
    cycles = solve_map(system, some, counting, threads, None)[0]["cycles"]
    seconds = cycles * _seconds_of_period(system.n, some["r"])[:, np.newaxis] + _DECIDED
    if looked_at:  # the motions from other starts; they cost what a cell does that is followed
        others = np.where(some["mu"] == 1.0, LOOKED_AT_SMOOTH, LOOKED_AT) / FOLLOWED
        seconds *= 1.0 + others[:, np.newaxis, np.newaxis]
    return float(seconds.mean())


def _spread(values: np.ndarray, most: int) -> np.ndarray:
    """So many values of an axis at most: the middles of equal parts of it."""
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
    """As in 1.5 GB."""
    for unit in ("MB", "GB"):
        size /= 1000.0 if unit == "GB" else 1e6
        if size < 1000.0 or unit == "GB":
            break
    return f"{size:.2g} {unit}" if size < 100.0 else f"{size:,.0f} {unit}"


def in_time(seconds: float) -> str:
    """As in 40 s, 3 min, 2.5 h."""
    if seconds < 100.0:
        return f"{max(seconds, 1.0):.0f} s"
    return f"{seconds / 60.0:.0f} min" if seconds < 6000.0 else f"{seconds / 3600.0:.1f} h"
