"""Maps at mu > 1: time of this checkout and of another one, in turn, one thread each.

    python -m benchmarks static [--package CHECKOUT]

Every scene is computed in a new process that has loaded its kernels.  Processes of this checkout and of the
other follow each other, and medians are compared, and the regimes of cells that both resolve.
"""

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

from .. import ROOT
from ..report.record import save, spread, table

#: Computes one scene and prints seconds; keeps what its cells are.
_CHILD = """
import json, statistics, sys, time
import numpy as np
import frictionmap as fm
scene, kept = json.loads(sys.argv[1]), sys.argv[2]
if "config" in scene:
    config = fm.load_config(scene["config"])
    system, r, beta = config.system, config.r, config.beta
    mu = scene.get("mu", config.mu)
else:
    system = fm.System(**scene["system"])
    r, beta = np.linspace(0.05, 3.0, scene["cells"]), np.linspace(0.01, 3.0, scene["cells"])
    mu = scene["mu"]
r, beta = r[:: scene["every"]], beta[:: scene["every"]]
names = ["regime", "status", "cycles"]
few = max(1, min(r.size, beta.size) // 20)
fm.sweep(system, r[::few], beta[::few], mu, outputs=names, threads=1)  # loads the kernels of open cells, too
seconds = []
for _ in range(scene.get("calls", 1)):
    began = time.perf_counter()
    ds = fm.sweep(system, r, beta, mu, outputs=names, threads=1)
    seconds.append(time.perf_counter() - began)
print(statistics.median(seconds))
np.savez(kept, **{name: ds[name].values for name in names})
"""

_FIVE = {
    "contact_masses": [3], "load_mass": 1, "mass_ratios": [1.0] * 5, "stiffness_ratios": [1.0] * 5,
    "damping_ratios": 0.02,
}  # fmt: skip

#: Scenes; those that take milliseconds are computed several times by each process.  The last two are calls
#: with a few cells, as in a loop over designs.
SCENES: dict[str, dict] = {
    "five masses, mu = 1": {"system": _FIVE, "cells": 400, "mu": [1.0], "calls": 5},
    "five masses, mu = 1.3": {"system": _FIVE, "cells": 400, "mu": [1.3]},
    "T Fig. 6.7": {"config": "fig-6-7.toml"},
    "T Fig. 6.14": {"config": "fig-6-14.toml"},
    "T Fig. 3.12, mu = 1": {"config": "fig-3-12.toml", "mu": [1.0], "calls": 25},
    "T Fig. 3.12, mu = 1.5": {"config": "fig-3-12.toml", "mu": [1.5], "calls": 25},
    "one mass, design loop": {"system": {}, "cells": 2, "mu": [1.3], "calls": 300, "every": 1},
    "five masses, design loop": {"system": _FIVE, "cells": 2, "mu": [1.3], "calls": 300, "every": 1},
}

#: Repetitions, and the part of the grid; by quick.
_ROUNDS = {False: 3, True: 1}
_EVERY = {False: 1, True: 10}

#: Scenes of the quick form: a configuration of one mass, and repeated calls with a structure.
_QUICK = ("T Fig. 3.12, mu = 1", "five masses, design loop")


def _computed(package: Path, scene: dict, folder: Path) -> tuple[float, dict[str, np.ndarray]]:
    """Seconds of a scene, and what its cells are."""
    kept = folder / "cells.npz"
    environment = {**os.environ, "PYTHONPATH": str(package)}
    said = subprocess.run(
        [sys.executable, "-c", _CHILD, json.dumps(scene), str(kept)],
        env=environment, cwd=folder, capture_output=True, text=True, check=True,
    )  # fmt: skip
    with np.load(kept) as cells:
        return float(said.stdout.splitlines()[-1]), dict(cells)


def _compared(ours: dict[str, np.ndarray], theirs: dict[str, np.ndarray]) -> dict:
    """How the cells of two checkouts differ."""
    both = (ours["status"] == 0) & (theirs["status"] == 0)
    return {
        "cells": int(both.size),
        "resolved by both": int(both.sum()),
        "other regimes": int((ours["regime"] != theirs["regime"])[both].sum()),
        "cycles": [int(cells["cycles"].sum()) for cells in (ours, theirs)],
    }


def _measure(scene: dict, packages: dict[str, Path], rounds: int, folder: Path) -> dict:
    """Times of one scene by every checkout, in turn."""
    for package in packages.values() if rounds > 1 else ():
        _computed(package, scene, folder)  # compiles
    seconds: dict[str, list[float]] = {name: [] for name in packages}
    cells = {}
    for _ in range(rounds):
        for name, package in packages.items():
            taken, cells[name] = _computed(package, scene, folder)
            seconds[name].append(taken)
    found = {name: spread(taken) for name, taken in seconds.items()}
    result: dict = {"seconds": found, "cells": int(cells["this"]["regime"].size)}
    result["unresolved"] = int((cells["this"]["regime"] < 0).sum())
    if "other" in packages:
        result["ratio"] = found["other"]["median"] / found["this"]["median"]
        result["compared"] = _compared(cells["this"], cells["other"])
    return result


def run(quick: bool, results: Path, package: Path | None = None) -> dict:
    """Measure, print and save."""
    packages = {"this": ROOT} | ({"other": package.resolve()} if package else {})
    scenes = {}
    with tempfile.TemporaryDirectory(prefix="static-") as folder:
        for name in _QUICK if quick else SCENES:
            scene = SCENES[name]
            whole = {"every": _EVERY[quick]} | scene
            if "config" in scene:
                whole["config"] = str(ROOT / "configs" / scene["config"])
            scenes[name] = _measure(whole, packages, _ROUNDS[quick], Path(folder))
    rows = [
        (name, entry["cells"], entry["seconds"]["this"]["median"], entry.get("ratio", float("nan")))
        for name, entry in scenes.items()
    ]
    table(("scene", "cells", "s", "times as fast as the other"), rows)
    content = {"scenes": scenes, "compared with another checkout": package is not None}
    save("static", content, results)
    return content
