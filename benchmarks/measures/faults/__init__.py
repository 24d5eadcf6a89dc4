"""`faults`: invalid input, interrupts and damaged files: nothing lost, nothing left behind, no traceback.

    python -m benchmarks faults [--quick] [--results FOLDER] [--package CHECKOUT]

tests this checkout, or another one, in child processes only.  `faults.json` contains the results of this
checkout, `faults-before.json` those of another.  Failures are counted by what a user sees, with examples.

==============  =========================================================================================
module          what is in it
==============  =========================================================================================
configurations  invalid configurations: every key with wrong values, invalid files, invalid matrices
command_lines   invalid command lines: arguments, overrides, outputs and inputs
refusals        runs both: refused in one line that names the cause, with nothing changed
calls           invalid calls of the Python API, valid ones in unusual form, settings
mutants         thousands of malformed files, read by `info` and `plot`
moments         duration and output of every command
interrupts      SIGINT, SIGTERM and SIGKILL at random moments of every command
races           several runs that write the same file, files that appear during a run, links
places          full disks, read-only folders, terminals with few characters, closed streams
caches          damaged caches of kernels, read-only machines
damages         damage to a cache
malformed       makes malformed files from `contents` by `other_structure`, `other_values`, `slices`
calling         makes the calls; runs in the child
worker          the child's side
child           the parent's side
machine         new processes, and how busy the machine is
folders         content of a folder before and after
verdict         defects of a run; counts
report          table, figure, JSON
==============  =========================================================================================
"""

import contextlib
import functools
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path

from ... import ROOT
from . import caches, calls, interrupts, moments, mutants, places, races, refusals, report
from .child import Child
from .machine import environment
from .verdict import Family

Part = Callable[[Path], list[Family]]


def _parts(child: Child, package: Path, shared: Path, quick: bool) -> dict[str, Part]:
    """All parts, each in its own folder; those that need a long-lived child come first.

    shared : folder of the inputs that several parts use
    """
    env = environment(package)

    @functools.cache
    def commands() -> moments.Commands:
        return moments.Commands(moments.inputs(shared / "inputs", env, quick), env)

    def in_processes(part: Callable) -> Part:
        return lambda folder: part(commands(), folder, quick)

    return {
        "command line": lambda folder: refusals.run(child, folder, quick),
        "Python": lambda folder: calls.run(child, refusals.template(folder / "prepared"), quick),
        "malformed files": lambda folder: mutants.run(child, folder, quick),
        "interrupts": in_processes(interrupts.run),
        "several runs": in_processes(races.run),
        "places": in_processes(places.run),
        "caches": lambda folder: caches.run(package, folder / "cache", quick),
    }


@contextlib.contextmanager
def _timed(name: str, seconds: dict[str, float]) -> Iterator[None]:
    began = time.perf_counter()
    yield
    seconds[name] = time.perf_counter() - began
    print(f"{name}: {seconds[name]:.0f} s", flush=True)


def run(quick: bool, results: Path, package: Path | None = None) -> dict:
    """Try everything, print, save and draw."""
    families: list[Family] = []
    seconds: dict[str, float] = {}
    tried = (package or ROOT).resolve()
    with Child(tried) as child, tempfile.TemporaryDirectory(prefix="faults-") as shared:
        for name, part in _parts(child, tried, Path(shared), quick).items():
            with _timed(name, seconds), tempfile.TemporaryDirectory(prefix="faults-") as folder:
                families += part(Path(folder))
    return report.write(families, seconds, results, another=package is not None)
