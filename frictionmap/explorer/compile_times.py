"""Time that kernels take to compile on this machine: the last measured time, else a scaled benchmark.

Measured times are kept in a file beside the folders of compiled kernels, so that they outlast a new version.
"""

import contextlib
import json
import math
import os
import tempfile
import threading
import time
from pathlib import Path
from typing import Any, NamedTuple

from ..model.system import System
from ..solvers.choose import engine_of


class Compilation(NamedTuple):
    """Compile time and number of kernels of a group."""

    seconds: float
    kernels: float


#: Compilation on the machine of the benchmark, by kind of system and of work: what the work before it leaves.
_BENCHMARK = {
    "one": {
        "lines": Compilation(1.3, 12),
        "map": Compilation(7.4, 133),
        "motion": Compilation(16.0, 120),
        "others": Compilation(13.0, 75),
        "cut": Compilation(2.3, 5),
        "quantity": Compilation(2.1, 4),
        "goal": Compilation(23.0, 236),
    },
    "structure": {
        "lines": Compilation(2.9, 23),
        "map": Compilation(15.0, 186),
        "motion": Compilation(13.0, 85),
        "others": Compilation(10.5, 46),
        "cut": Compilation(2.5, 5),
        "quantity": Compilation(2.1, 4),
        "goal": Compilation(25.0, 236),
    },
    "phases": {
        "lines": Compilation(0.5, 2),
        "map": Compilation(40.0, 150),
        "motion": Compilation(5.0, 20),
        "others": Compilation(1.0, 2),
        "cut": Compilation(1.0, 2),
        "quantity": Compilation(1.0, 2),
        "goal": Compilation(26.0, 145),
    },
    "banks": {
        "lines": Compilation(0.5, 2),
        "map": Compilation(15.0, 60),
        "motion": Compilation(1.0, 2),
        "others": Compilation(1.0, 2),
        "cut": Compilation(1.0, 2),
        "quantity": Compilation(1.0, 2),
        "goal": Compilation(1.0, 2),
    },
    "belt": {
        "lines": Compilation(3.0, 20),
        "map": Compilation(6.0, 40),
        "motion": Compilation(25.0, 100),
    },
    "general": {
        "lines": Compilation(16.0, 135),
        "map": Compilation(18.0, 139),
        "motion": Compilation(1.0, 2),
        "others": Compilation(1.0, 2),
        "cut": Compilation(1.0, 2),
        "quantity": Compilation(1.0, 2),
        "goal": Compilation(26.0, 145),
    },
}

#: The same of work without a measurement: what a map and a motion need is there.
_FEW = Compilation(1.0, 2)

#: Turns of a loop, and the seconds that they took on that machine.
_TURNS, _LOOP = 200_000, 0.006

#: A compilation of fewer kernels than this share of the last one was partly done before, and is not kept.
_PARTLY = 0.5

_NAME = "compile-times.json"


def group_of(work: str, system: System, *, unloaded: bool = False) -> str:
    """Name of the kernels that a kind of work needs for a system, such as "map one"."""
    return f"{work} {'belt' if unloaded else engine_of(system).kernels}"


def default_place() -> Path | None:
    """File of measured times; None if no folder for kernels can be written to."""
    from .._kernels.compiler.folders import folders

    return folders()[-1].parent / _NAME if folders() else None


class CompileTimes:
    """Measured and expected times of compilation."""

    def __init__(self, place: Path | None = None) -> None:
        self._place = place
        self._lock = threading.Lock()
        self._known: dict[str, Compilation] = _read(place) if place else {}
        self._slowness = 0.0

    def expected(self, group: str) -> Compilation:
        """Estimate the compilation of a group of kernels."""
        with self._lock:
            if group in self._known:
                return self._known[group]
            self._slowness = self._slowness or _loop_time() / _LOOP
        work, _, kind = group.partition(" ")
        benchmark = _BENCHMARK[kind].get(work, _FEW)
        return benchmark._replace(seconds=self._slowness * benchmark.seconds)

    def record(self, group: str, seconds: float, kernels: int) -> None:
        """Keep a measured time, unless most kernels of the group were there already."""
        with self._lock:
            if group in self._known and kernels < _PARTLY * self._known[group].kernels:
                return
            self._known[group] = Compilation(round(seconds, 3), kernels)
            if self._place:
                _write(self._place, {name: one._asdict() for name, one in self._known.items()})


def _loop_time() -> float:
    """Seconds of a short loop, the shortest of three."""
    found = []
    for _ in range(3):
        began = time.perf_counter()
        total = 0
        for k in range(_TURNS):
            total += k * k
        found.append(time.perf_counter() - began)
    return min(found)


def _read(place: Path) -> dict[str, Compilation]:
    """Read times; a damaged file counts as missing."""
    try:
        content: Any = json.loads(place.read_text())
        return {
            str(group): Compilation(_positive(one["seconds"]), _positive(one["kernels"]))
            for group, one in content.items()
        }
    except (OSError, ValueError, TypeError, KeyError, AttributeError):
        return {}


def _positive(value: object) -> float:
    number = float(value)  # type: ignore[arg-type]
    if not (math.isfinite(number) and number > 0.0):
        raise ValueError
    return number


def _write(place: Path, content: object) -> None:
    """Write the file completely or not at all; without permission, keep nothing."""
    with contextlib.suppress(OSError):
        handle, name = tempfile.mkstemp(prefix="new-", dir=place.parent)
        with open(handle, "w") as file:
            json.dump(content, file)
        os.replace(name, place)
