"""python -m benchmarks: one sub-command for each benchmark; see the package's docstring."""

import argparse
import os
from pathlib import Path

# one thread each, before any library is loaded
for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[_name] = "1"


def main() -> None:
    """Parse and run."""
    from . import against, bound, phases, startup, structures

    benchmarks = {
        "peers": against.run,
        "startup": startup.run,
        "phases": phases.run,
        "structures": structures.run,
        "bound": bound.run,
    }
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("benchmark", choices=[*benchmarks, "all"])
    parser.add_argument("--quick", action="store_true", help="few cells and runs: does it work?")
    parser.add_argument(
        "--results",
        type=Path,
        default=Path(__file__).parent / "results" / "local",
        help="folder for the results (default: benchmarks/results/local)",
    )
    options = parser.parse_args()
    for name in benchmarks if options.benchmark == "all" else [options.benchmark]:
        benchmarks[name](options.quick, options.results)


if __name__ == "__main__":
    main()
