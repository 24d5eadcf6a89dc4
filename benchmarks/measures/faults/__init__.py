"""`faults`: the program in careless hands and on bad days: nothing lost, nothing left behind, no traceback.

    python -m benchmarks faults [--quick] [--results FOLDER] [--package CHECKOUT]

tries the checkout that it stands in, or another one, in child processes only: `faults.json` is of this one,
`faults-before.json` of another.  Whatever goes wrong is counted by what a user sees of it, with examples.

==============  =========================================================================================
module          what is in it
==============  =========================================================================================
configurations  bad configurations: every key with wrong values, whole files gone wrong, bad matrices
command_lines   bad command lines: arguments, overrides, outputs and inputs in the wrong place
refusals        runs both: refused in one line that names what is wrong, with nothing changed
calls           bad calls of the Python API, good ones in unusual dress, settings that must not be dropped
mutants         thousands of malformed files, read by `info` and `plot`
moments         what runs of every verb take and write
interrupts      SIGINT, SIGTERM and SIGKILL at random moments of every verb
races           several runs to one name, files that appear during a run, links, permissions
places          full disks, read-only folders, terminals of few letters, closed streams
caches          damaged caches of kernels, machines on which none can be written
damages         ways to damage them
malformed       makes the malformed files: of `contents`, by `other_structure`, `other_values`, `slices`
calling         makes the calls; both in the child
worker          the child's side
child           the parent's side
machine         processes of their own, and how busy the machine is
folders         what lies in a folder before and after
verdict         what is wrong with how a run ended; counts
report          table, figure, JSON
==============  =========================================================================================
"""

import contextlib
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


def _parts(child: Child, package: Path, quick: bool) -> dict[str, Part]:
    """What is tried, each in a folder of its own; those that need a long-lived child come first."""
    env = environment(package)

    def in_processes(part: Callable) -> Part:
        return lambda folder: part(moments.inputs(folder / "inputs", env, quick), folder, env, quick)

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
    with Child(tried) as child:
        for name, part in _parts(child, tried, quick).items():
            with _timed(name, seconds), tempfile.TemporaryDirectory(prefix="faults-") as folder:
                families += part(Path(folder))
    return report.write(families, seconds, results, another=package is not None)
