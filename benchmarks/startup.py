"""Start-up in fresh processes: --help, first run (every kernel compiled), second run."""

import os
import subprocess
import sys
import tempfile
from pathlib import Path

from .record import save, spread, timed

CONFIG = Path(__file__).resolve().parent.parent / "configs" / "fig-3-12.toml"


def _run(arguments: list[str], cache: str, folder: str) -> float:
    environment = {**os.environ, "NUMBA_CACHE_DIR": cache}
    command = [sys.executable, "-m", "frictionmap", *arguments]
    seconds, _ = timed(
        lambda: subprocess.run(command, env=environment, cwd=folder, check=True, capture_output=True)
    )
    return seconds


def run(quick: bool, results: Path) -> dict:
    """Measure, print and save."""
    repeats = 1 if quick else 5
    timings: dict[str, list[float]] = {"--help": [], "first run": [], "second run": [], "plot": []}
    for _ in range(repeats):
        with tempfile.TemporaryDirectory() as cache, tempfile.TemporaryDirectory() as folder:
            command = ["map", str(CONFIG), "-o", "map.nc", "--overwrite"]
            timings["--help"].append(_run(["--help"], cache, folder))
            timings["first run"].append(_run(command, cache, folder))
            timings["second run"].append(_run(command, cache, folder))
            timings["plot"].append(_run(["plot", "map.nc"], cache, folder))
    content = {name: spread(seconds) for name, seconds in timings.items()}
    for name, entry in content.items():
        print(f"{name:10}: {entry['median']:.2f} s ({entry['least']:.2f} to {entry['most']:.2f})")
    save("startup", {"seconds": content}, results)
    return content
