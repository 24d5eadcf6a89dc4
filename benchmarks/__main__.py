"""Command line of the benchmarks: one sub-command per benchmark; see the docstring of the package."""

import argparse
import math
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterable
from importlib import import_module
from pathlib import Path

from . import RESULTS
from .report.record import complete, kept

# one thread each, before any library is loaded
for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[_name] = "1"

#: Sub-commands: each has a module of its name in `measures` with a `run`, imported only when it is asked for.
#: The seconds are those of whole runs on a quiet machine with two processors, compilation included.
BENCHMARKS = {
    "accuracy": 480,
    "peers": 100,
    "scaling": 290,
    "startup": 140,
    "stress": 550,
    "steady": 140,
    "structures": 150,
    "general": 300,
    "continuation": 60,
    "laws": 240,
    "design": 250,
    "static": 120,
    "bound": 30,
    "large": 190,
    "explore": 170,
    "first_minute": 110,
    "coupling": 130,
    "coverage": 740,
    "consistency": 430,
    "spectrum": 25,
    "histories": 60,
    "banks": 70,
    "many_contacts": 140,
    "second_starts": 180,
}


def _run(name: str, quick: bool, results: Path, **more: object) -> float:
    """Run one benchmark; return the seconds it took, including imports and compilation."""
    print(f"\n{name}", flush=True)
    began = time.perf_counter()
    run: Callable[..., dict] = import_module(f".measures.{name}", __package__).run
    run(quick, results, **more)
    taken = time.perf_counter() - began
    complete(name, results, taken, quick)
    return taken


def _run_apart(name: str, results: Path) -> float:
    """Run one of several benchmarks in a process of its own: memory and caches of another would count.

    One that fails stops none of the others; its seconds are nan.
    """
    began = time.perf_counter()
    done = subprocess.run([sys.executable, "-m", __package__, name, "--results", str(results)])
    return math.nan if done.returncode else time.perf_counter() - began


def _minutes(names: Iterable[str]) -> str:
    return f"{math.ceil(sum(BENCHMARKS[name] for name in names) / 60)} min"


def _run_all(names: list[str], results: Path) -> dict[str, float]:
    """Run benchmarks whose results are not there yet, and say before each how long the rest will take."""
    waiting = [name for name in names if not kept(name, results)]
    print("measured on this commit and machine before:", *(set(names) - set(waiting) or ["none"]))
    print(f"on a quiet machine with two processors: about {_minutes(waiting)}", flush=True)
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))  # ends the running benchmark, too
    seconds = {}
    for k, name in enumerate(waiting):
        left = f"{_minutes([name])} of {_minutes(waiting[k:])} left"
        print(f"\n{time.strftime('%H:%M')} {k + 1} of {len(waiting)}, about {left}", end="", flush=True)
        seconds[name] = _run_apart(name, results)
    return seconds


def main() -> None:
    """Parse the arguments and run."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument(
        "benchmarks",
        nargs="+",
        choices=[*BENCHMARKS, "all", "page"],
        metavar="benchmark",
        help=f"any of {', '.join(BENCHMARKS)}; all of them; or page, which quotes the results",
    )
    parser.add_argument("--quick", action="store_true", help="few cells and runs: does it work?")
    parser.add_argument(
        "--results",
        type=Path,
        help="folder of the results (default: benchmarks/results/local; page: benchmarks/results)",
    )
    parser.add_argument(
        "--package",
        type=Path,
        help="static: the checkout to compare with",
    )
    parser.add_argument("--whole", action="store_true", help="coverage: all seeds, in an hour")
    options = parser.parse_args()
    for name, alone in (("package", "static"), ("whole", "coverage")):
        if getattr(options, name) and options.benchmarks != [alone]:
            parser.error(f"--{name} goes with {alone} alone")
    more = {name: value for name in ("package", "whole") if (value := getattr(options, name))}
    if options.benchmarks == ["page"]:  # quotes what is there
        from .report.results_page import rewrite

        rewrite(options.results or RESULTS)
        return
    if "page" in options.benchmarks:
        parser.error("page goes alone: it quotes results that are there")
    names = [name for name in BENCHMARKS if {name, "all"} & set(options.benchmarks)]
    results = options.results or RESULTS / "local"
    if options.quick or len(names) == 1:
        seconds = {name: _run(name, options.quick, results, **more) for name in names}
    else:
        seconds = _run_all(names, results)
    print()
    for name, taken in seconds.items():
        print(f"{name:10} failed" if math.isnan(taken) else f"{name:10} took {taken:6.1f} s")
    if any(map(math.isnan, seconds.values())):
        sys.exit(1)


if __name__ == "__main__":
    main()
