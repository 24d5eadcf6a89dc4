"""Records of a benchmark as JSON: machine, versions, medians and spread."""

import json
import math
import os
import platform
import statistics
import subprocess
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from importlib.metadata import version
from pathlib import Path
from typing import TypeVar

from .. import ROOT

Result = TypeVar("Result")

PACKAGES = ("numpy", "numba", "scipy", "xarray")

#: What is measured, and by what: results and pages may differ from the commit.
_MEASURED = ("frictionmap", "benchmarks", "configs", ":!benchmarks/results")


def processor() -> str:
    """Return the name of the processor."""
    try:
        for line in Path("/proc/cpuinfo").read_text().splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    except OSError:
        pass
    return platform.processor() or platform.machine()


def machine() -> dict:
    """Describe the machine and the versions of a result."""
    return {
        "processor": processor(),
        "processors": os.cpu_count(),
        "load": os.getloadavg()[0] if hasattr(os, "getloadavg") else None,
        "system": f"{platform.system()} {platform.machine()}",
        "python": platform.python_version(),
        "versions": {name: version(name) for name in PACKAGES},
    }


def commit() -> str | None:
    """Commit of the measured code, "+" after it if its files were changed since; None outside of git."""

    def git(*arguments: str) -> str:
        command = ["git", "-C", str(ROOT), *arguments]
        return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()

    try:
        changed = git("status", "--porcelain", "--", *_MEASURED)
        return git("rev-parse", "--short=10", "HEAD") + ("+" if changed else "")
    except (OSError, subprocess.CalledProcessError):
        return None


def spread(seconds: Sequence[float]) -> dict:
    """Median, minimum and maximum of repeated timings."""
    return {
        "median": statistics.median(seconds),
        "least": min(seconds),
        "most": max(seconds),
        "runs": len(seconds),
    }


def timed(function: Callable[[], Result]) -> tuple[float, Result]:
    """Measure one call: wall-clock seconds, and its return value."""
    began = time.perf_counter()
    result = function()
    return time.perf_counter() - began, result


@contextmanager
def pinned() -> Iterator[None]:
    """Keep this process on one processor, if the system can, so that timed code stays there."""
    if not hasattr(os, "sched_setaffinity"):
        yield
        return
    before = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {max(before)})
    try:
        yield
    finally:
        os.sched_setaffinity(0, before)


def table(header: Sequence[str], rows: Sequence[Sequence[object]]) -> None:
    """Print rows under a header in aligned columns; numbers with three digits."""
    words = [[f"{cell:.3g}" if isinstance(cell, float) else str(cell) for cell in row] for row in rows]
    widths = [max(map(len, column)) for column in zip(header, *words, strict=True)]
    for row in (header, ["-" * width for width in widths], *words):
        print("  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip())


def storable(content: object) -> object:
    """Round every float to six digits, more than any measurement has, which halves the files; replace those
    that are not finite by None, because JSON cannot represent them.
    """
    if isinstance(content, dict):
        return {key: storable(value) for key, value in content.items()}
    if isinstance(content, list | tuple):
        return [storable(value) for value in content]
    if isinstance(content, float):
        return float(f"{content:.6g}") if math.isfinite(content) else None
    return content


def _path(name: str, folder: Path) -> Path:
    return folder / f"{name}.json"


def _write(content: dict, path: Path) -> None:
    path.write_text(json.dumps(storable(content), indent=2, allow_nan=False) + "\n")


def save(name: str, content: dict, folder: Path) -> Path:
    """Write one result to a file, with the machine and the commit that were measured."""
    folder.mkdir(parents=True, exist_ok=True)
    path = _path(name, folder)
    _write({"machine": machine(), "commit": commit(), **content}, path)
    return path


def complete(name: str, folder: Path, seconds: float, quick: bool) -> None:
    """Note in a result that all of its benchmark was run, and how long that took."""
    path = _path(name, folder)
    _write({**json.loads(path.read_text()), "run": {"seconds": seconds, "quick": quick}}, path)


def kept(name: str, folder: Path) -> bool:
    """Whether a result is there and need not be measured again.

    It is of a complete run in full, of this commit without changes, and of this machine with its packages.
    """
    try:
        content = json.loads(_path(name, folder).read_text())
    except (OSError, ValueError):  # none, or cut off by a kill
        return False
    now, here = commit(), machine()
    same = all(content["machine"].get(key) == here[key] for key in here if key != "load")
    clean = now is not None and not now.endswith("+")
    return clean and same and content.get("commit") == now and content.get("run", {}).get("quick") is False
