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
from typing import Any

from ..model.system import System

#: Seconds of compilation on the machine of the benchmark, by kind of work and of system.
_BENCHMARK = {
    "one": {
        "lines": 3.0,
        "map": 17.0,
        "quantity": 5.0,
        "motion": 8.0,
        "others": 5.0,
        "cut": 8.0,
        "goal": 15.0,
    },
    "structure": {
        "lines": 5.0,
        "map": 32.0,
        "quantity": 8.0,
        "motion": 12.0,
        "others": 8.0,
        "cut": 12.0,
        "goal": 35.0,
    },
    "general": {
        "lines": 10.0,
        "map": 30.0,
        "quantity": 5.0,
        "motion": 10.0,
        "others": 5.0,
        "cut": 10.0,
        "goal": 40.0,
    },
}

#: Turns of a loop, and the seconds that they took on that machine.
_TURNS, _LOOP = 200_000, 0.013

#: A compilation of fewer kernels than this share of the last one was partly done before, and is not kept.
_PARTLY = 0.5

_NAME = "compile-times.json"


def group_of(work: str, system: System) -> str:
    """Name of the kernels that a kind of work needs for a system, such as "map one"."""
    if system.general is not None:
        return f"{work} general"
    return f"{work} {'one' if system.normalised else 'structure'}"


def default_place() -> Path | None:
    """File of measured times; None if no folder for kernels can be written to."""
    from .._kernels.compiler.folders import folders

    return folders()[-1].parent / _NAME if folders() else None


class CompileTimes:
    """Measured and expected times of compilation."""

    def __init__(self, place: Path | None = None) -> None:
        self._place = place
        self._lock = threading.Lock()
        self._known: dict[str, dict[str, float]] = _read(place) if place else {}
        self._slowness = 0.0

    def expected(self, group: str) -> float:
        """Seconds that the kernels of a group will take."""
        with self._lock:
            if group in self._known:
                return self._known[group]["seconds"]
            self._slowness = self._slowness or _loop_time() / _LOOP
        work, _, kind = group.partition(" ")
        return self._slowness * _BENCHMARK[kind][work]

    def record(self, group: str, seconds: float, kernels: int) -> None:
        """Keep a measured time, unless most kernels of the group were there already."""
        with self._lock:
            before = self._known.get(group, {"kernels": 0})
            if kernels < _PARTLY * before["kernels"]:
                return
            self._known[group] = {"seconds": round(seconds, 3), "kernels": kernels}
            if self._place:
                _write(self._place, self._known)


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


def _read(place: Path) -> dict[str, dict[str, float]]:
    """Read times; a damaged file counts as missing."""
    try:
        content: Any = json.loads(place.read_text())
        return {
            str(group): {"seconds": _positive(one["seconds"]), "kernels": _positive(one["kernels"])}
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
