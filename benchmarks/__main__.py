"""Command line of the benchmarks: one sub-command per benchmark; see the docstring of the package."""

import argparse
import math
import os
import subprocess
import sys
import time
from collections.abc import Callable
from importlib import import_module
from pathlib import Path

from . import RESULTS

# one thread each, before any library is loaded
for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[_name] = "1"

#: Sub-commands: each has a module of its name in `measures` with a `run`, imported only when it is asked for.
BENCHMARKS = (
    "accuracy",
    "peers",
    "scaling",
    "startup",
    "stress",
    "steady",
    "structures",
    "general",
    "laws",
    "design",
    "static",
    "bound",
    "large",
    "explore",
    "first_minute",
    "coupling",
    "coverage",
    "consistency",
    "spectrum",
    "histories",
    "banks",
)


def _run(name: str, quick: bool, results: Path, **more: Path) -> float:
    """Run one benchmark; return the seconds it took, including imports and compilation."""
    print(f"\n{name}", flush=True)
    began = time.perf_counter()
    run: Callable[..., dict] = import_module(f".measures.{name}", __package__).run
    run(quick, results, **more)
    return time.perf_counter() - began


def _run_apart(name: str, _: bool, results: Path) -> float:
    """Run one of several benchmarks in a process of its own: memory and caches of another would count.

    One that fails stops none of the others; its seconds are nan.
    """
    began = time.perf_counter()
    done = subprocess.run([sys.executable, "-m", __package__, name, "--results", str(results)])
    return math.nan if done.returncode else time.perf_counter() - began


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
    options = parser.parse_args()
    if options.package and options.benchmarks != ["static"]:
        parser.error("--package goes with static alone")
    more = {"package": options.package} if options.package else {}
    if options.benchmarks == ["page"]:  # quotes what is there
        from .report.results_page import rewrite

        rewrite(options.results or RESULTS)
        return
    if "page" in options.benchmarks:
        parser.error("page goes alone: it quotes results that are there")
    names = [name for name in BENCHMARKS if {name, "all"} & set(options.benchmarks)]
    results = options.results or RESULTS / "local"
    run = _run if options.quick or len(names) == 1 else _run_apart
    seconds = {name: run(name, options.quick, results, **more) for name in names}
    print()
    for name, taken in seconds.items():
        print(f"{name:10} failed" if math.isnan(taken) else f"{name:10} took {taken:6.1f} s")
    if any(map(math.isnan, seconds.values())):
        sys.exit(1)


if __name__ == "__main__":
    main()
