"""Start-up in new processes: import, --help, first run (kernels compiled), second run, plot.

Every round starts with an empty cache of kernels, and every measurement is a new process. The map of T Fig.
3.12 represents one mass. A structure (T Fig. 7.7, two damped masses) has kernels of its own, which take
longer to compile. The second run must write the same file as the first. The peak memory of the maps is that
of their processes. The quick form compiles nothing: it has the usual cache, and no runs of a structure.
"""

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import NamedTuple

import xarray as xr

from .. import ROOT
from ..report.record import pinned, save, spread, table

ONE_MASS, STRUCTURE = (ROOT / "configs" / name for name in ("fig-3-12.toml", "fig-7-7-zeta-0.1.toml"))

#: Rounds, and how many of them have runs of a structure too; by quick.
ROUNDS = {False: 3, True: 1}
STRUCTURE_ROUNDS = {False: 2, True: 0}

NOTHING = "python, doing nothing"
IMPORT, IMPORT_SWEEP, HELP = "import frictionmap", "import of frictionmap.sweep", "frictionmap --help"
FIRST, SECOND, PLOT = "map of one mass, first run", "map of one mass, second run", "plot of the map"
FIRST_STRUCTURE, SECOND_STRUCTURE = "map of two masses, first run", "map of two masses, second run"

#: Processes whose memory is reported: they take more than this one.
MAPS = {FIRST, SECOND, FIRST_STRUCTURE, SECOND_STRUCTURE}


class Taken(NamedTuple):
    """What a process took."""

    seconds: float
    memory: float  # at its peak [MB]; the memory of this process is counted if it is larger


def _process(arguments: list[str], cache: str | None, folder: str) -> Taken:
    """Run one new Python process; without a cache of its own it has the usual one."""
    search = os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])
    environment = {**os.environ, "PYTHONPATH": search} | ({"NUMBA_CACHE_DIR": cache} if cache else {})
    command = [sys.executable, *arguments]
    began = time.perf_counter()
    process = subprocess.Popen(command, env=environment, cwd=folder, stdout=subprocess.DEVNULL)
    _, status, used = os.wait4(process.pid, 0)
    seconds = time.perf_counter() - began
    process.returncode = os.waitstatus_to_exitcode(status)
    if status:
        raise RuntimeError(f"{' '.join(command)} ended with {process.returncode}")
    return Taken(seconds, used.ru_maxrss / 1024.0)


def _both_runs(config: Path, cache: str | None, folder: str) -> tuple[Taken, Taken]:
    """Measure the first and the second run of a map, which must write the same file."""
    taken = [
        _process(["-m", "frictionmap", "map", str(config), "-o", name, "--threads", "1"], cache, folder)
        for name in ("first.nc", "second.nc")
    ]
    with (
        xr.open_dataset(Path(folder) / "first.nc") as first,
        xr.open_dataset(Path(folder) / "second.nc") as second,
    ):
        if not first.equals(second):
            raise RuntimeError(f"{config.name}: first and second run differ")
    return taken[0], taken[1]


def _round(structure: bool, quick: bool) -> dict[str, Taken]:
    """Measure each process, in the order in which a new user starts them."""
    taken = {}
    with tempfile.TemporaryDirectory() as empty, tempfile.TemporaryDirectory() as folder:
        cache = None if quick else empty
        taken[NOTHING] = _process(["-c", "pass"], cache, folder)
        taken[IMPORT] = _process(["-c", "import frictionmap"], cache, folder)
        taken[IMPORT_SWEEP] = _process(["-c", "from frictionmap import System, sweep"], cache, folder)
        taken[HELP] = _process(["-m", "frictionmap", "--help"], cache, folder)
        taken[FIRST], taken[SECOND] = _both_runs(ONE_MASS, cache, folder)
        taken[PLOT] = _process(["-m", "frictionmap", "plot", "first.nc"], cache, folder)
    if structure:
        with tempfile.TemporaryDirectory() as cache, tempfile.TemporaryDirectory() as folder:
            taken[FIRST_STRUCTURE], taken[SECOND_STRUCTURE] = _both_runs(STRUCTURE, cache, folder)
    return taken


def run(quick: bool, results: Path) -> dict:
    """Measure, print and save."""
    with pinned():  # the processes started inherit it
        rounds = [_round(k < STRUCTURE_ROUNDS[quick], quick) for k in range(ROUNDS[quick])]
    seconds = {name: spread([one[name].seconds for one in rounds if name in one]) for name in rounds[0]}
    memory = {
        name: max(one[name].memory for one in rounds if name in one) for name in rounds[0] if name in MAPS
    }
    table(
        ("fresh process", "seconds", "least", "most", "runs", "MB"),
        [
            (name, entry["median"], entry["least"], entry["most"], entry["runs"], memory.get(name, ""))
            for name, entry in seconds.items()
        ],
    )
    content: dict = {"seconds": seconds, "MB": memory}
    if quick:
        content["skipped"] = "empty caches and runs of a structure: compiling takes longer than a quick look"
        print(f"skipped, {content['skipped']}")
    save("startup", content, results)
    return content
