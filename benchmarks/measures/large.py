"""Large maps: overhead of a store, memory and time over the size of a map, killed runs.

overhead        processor time of a store against the same map in memory, alternating, in one process
size            memory and time of complete commands, in memory and as a store, on finer grids of T Fig. 3.12
workers         the same study on one and on two dask processes, and the start of the processes
study           random variations (5 % on masses and springs) of five masses, over a small map
kills           runs that are killed with SIGKILL at random moments until one finishes; same bytes?
ahead           10^10 cells on 100 machines, estimated from the above
"""

import filecmp
import functools
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

import numpy as np

import frictionmap as fm
from frictionmap.stores.run import fill_store, in_this_process
from frictionmap.stores.study import study_of

from .. import ROOT
from ..report.record import save, spread, table

LARGEST_R, LARGEST_BETA = 2.5, 4.0
OVERHEAD = {False: 4096, True: 512}
SIZES = {False: (4096, 8192, 16384), True: (256,)}
IN_MEMORY = {False: 4096, True: 512}  # the largest that is made in memory, too
SAMPLES = {False: 1000, True: 24}
WORKERS_SAMPLES = {False: 250, True: 24}
KILLED_SAMPLES = 24
SMALL_MAP = {False: 60, True: 15}
KILLS = {False: 20, True: 1}
RUNS = {False: 3, True: 1}

GRID = """
[system]
contact = "joined-base-wall"
[grid]
r = {{ start = 0.0, stop = {r}, num = {n} }}
beta = {{ start = 0.0, stop = {beta}, num = {n} }}
"""
STUDY = """
[system]
mass_ratios = [1.0, 1.0, 1.0, 1.0, 1.0]
stiffness_ratios = [1.0, 1.0, 1.0, 1.0, 1.0]
damping_ratios = 0.01
contact_masses = [3]
[grid]
r = {{ start = 0.05, stop = 2.0, num = {n} }}
beta = {{ start = 0.0, stop = 1.2, num = {n} }}
[axes]
sample = {{ file = "variants.csv" }}
"""


def run(quick: bool, results: Path) -> dict:
    """Run all measurements."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        content = {
            "size": size(folder, quick),  # first: what this process holds counts for those it starts
            "workers": workers(folder, quick),
            "study": study(folder, quick),
            "kills": kills(folder, quick),
            "overhead": overhead(folder, quick),
        }
    content["ahead"] = ahead(content, quick)
    save("large", content, results)
    return content


def _command(folder: Path, *arguments: object) -> list[str]:
    return [sys.executable, "-m", "frictionmap", *map(str, arguments), "--quiet"]


def _environment() -> dict[str, str]:
    return os.environ | {"PYTHONPATH": str(ROOT)}


def _whole(folder: Path, *arguments: object) -> dict:
    """Seconds, processor seconds and peak memory [MB] of a command with its children."""
    began = time.perf_counter()
    process = subprocess.Popen(_command(folder, *arguments), cwd=folder, env=_environment())
    _, status, used = os.wait4(process.pid, 0)
    if status:
        raise RuntimeError(f"{arguments} ended with {status}")
    return {
        "seconds": time.perf_counter() - began,
        "cpu": used.ru_utime + used.ru_stime,
        "MB": used.ru_maxrss / 1024.0,
    }


def overhead(folder: Path, quick: bool) -> dict:
    """Processor seconds of the map in memory and as a store."""
    n = OVERHEAD[quick]
    system = fm.System(contact="joined-base-wall")
    axes = {
        "mu": np.array([1.0]), "r": np.linspace(0.0, LARGEST_R, n), "beta": np.linspace(0.0, LARGEST_BETA, n),
    }  # fmt: skip
    whole = study_of(system, None, axes, fm.Solver())
    few = study_of(system, None, {**axes, "r": axes["r"][:4]}, fm.Solver())
    fill_store(folder / "few.zarr", few, "few", in_this_process(None))  # libraries loaded, kernels compiled
    seconds: dict[str, list[float]] = {"in memory": [], "store": []}
    for _ in range(RUNS[quick]):
        began = time.process_time()
        fm.sweep(system, axes["r"], axes["beta"])
        between = time.process_time()
        fill_store(folder / "overhead.zarr", whole, "overhead", in_this_process(None))
        seconds["store"].append(time.process_time() - between)
        seconds["in memory"].append(between - began)
        shutil.rmtree(folder / "overhead.zarr")
    found = {name: spread(values) for name, values in seconds.items()}
    ratio = found["store"]["median"] / found["in memory"]["median"]
    print(f"CPU of a store over the map in memory, {n} x {n}: {ratio:.3f}")
    return {"n": n, "cpu seconds": found, "ratio": ratio}


def size(folder: Path, quick: bool) -> list[dict]:
    """Complete commands on successively finer grids."""
    rows = []
    for n in SIZES[quick]:
        (folder / "grid.toml").write_text(GRID.format(n=n, r=LARGEST_R, beta=LARGEST_BETA))
        row = {"n": n, "store": _whole(folder, "map", "grid.toml", "-o", f"grid{n}.zarr")}
        files = (path.stat().st_size for path in (folder / f"grid{n}.zarr").rglob("*") if path.is_file())
        row["store"]["disk MB"] = sum(files) / 1e6
        shutil.rmtree(folder / f"grid{n}.zarr")
        if n <= IN_MEMORY[quick]:
            row["file"] = _whole(folder, "map", "grid.toml", "-o", f"grid{n}.nc")
        rows.append(row)
    table(
        ("n x n", "s", "CPU s", "MB", "MB on disk"),
        [(row["n"], *(row["store"][key] for key in ("seconds", "cpu", "MB", "disk MB"))) for row in rows],
    )
    return rows


def _write_study(folder: Path, samples: int, quick: bool) -> None:
    chance = np.random.default_rng(2021)
    names = [f"{key}[{i}]" for key in ("mass_ratios", "stiffness_ratios") for i in range(2, 6)]
    rows = 1.0 + 0.05 * chance.standard_normal((samples, len(names)))
    lines = [",".join(names), *(",".join(map(repr, row)) for row in rows.tolist())]
    (folder / "variants.csv").write_text("\n".join(lines) + "\n")
    (folder / "study.toml").write_text(STUDY.format(n=SMALL_MAP[quick]))


@functools.cache
def _alone(folder: Path, samples: int, quick: bool) -> tuple[Path, dict]:
    """Compute the study without workers, once for each number of samples: its store, and what it took."""
    _write_study(folder, samples, quick)
    out = folder / f"alone{samples}.zarr"
    return out, _whole(folder, "map", "study.toml", "-o", out)


def workers(folder: Path, quick: bool) -> dict:
    """The study on one and on two processes; the study of a single sample measures their start."""
    samples = WORKERS_SAMPLES[quick]
    alone, _ = _alone(folder, samples, quick)
    seconds = {}
    for count in (1, 2)[: 1 if quick else 2]:
        out = folder / f"workers{count}.zarr"
        seconds[count] = _whole(folder, "map", "study.toml", "-o", out, "--workers", count)["seconds"]
    same = all(_same(alone, folder / f"workers{count}.zarr") for count in seconds)
    if quick:  # no more than: does it work?
        return {"samples": samples, "seconds": seconds, "same bytes": same}
    _write_study(folder, 1, quick)
    start = _whole(folder, "map", "study.toml", "-o", folder / "start.zarr", "--workers", 2)["seconds"]
    speed_up = (seconds[1] - start) / (seconds[2] - start)
    print(f"two workers {speed_up:.2f} times one (start of {start:.1f} s left out), same bytes: {same}")
    return {"samples": samples, "seconds": seconds, "start": start, "speed-up": speed_up, "same bytes": same}


def study(folder: Path, quick: bool) -> dict:
    """Random variations of five masses on all processors."""
    _, found = _alone(folder, SAMPLES[quick], quick)
    cells = SAMPLES[quick] * SMALL_MAP[quick] ** 2
    print(f"{SAMPLES[quick]} samples of five masses, {cells:,} cells: {found['seconds']:.0f} s")
    return {"samples": SAMPLES[quick], "cells": cells, **found}


def kills(folder: Path, quick: bool) -> dict:
    """Runs that are killed repeatedly at random moments."""
    well, took = _alone(folder, KILLED_SAMPLES, quick)
    chance = random.Random(1)
    killed = finished = different = 0
    while killed < KILLS[quick]:
        run = subprocess.Popen(
            _command(folder, "map", "study.toml", "-o", "killed.zarr"), cwd=folder, env=_environment()
        )
        try:
            status = run.wait(took["seconds"] * chance.uniform(0.2, 0.8))
        except subprocess.TimeoutExpired:
            run.send_signal(signal.SIGKILL)
            run.wait()
            killed += 1
            continue
        finished += 1
        different += status != 0 or not _same(well, folder / "killed.zarr")
        shutil.rmtree(folder / "killed.zarr")
    status = subprocess.run(
        _command(folder, "map", "study.toml", "-o", "killed.zarr"), cwd=folder, env=_environment()
    ).returncode
    different += status != 0 or not _same(well, folder / "killed.zarr")
    left = [name for name in os.listdir(folder) if name.startswith(".")]
    print(f"{killed} runs killed, {finished + 1} finished, {different} with other bytes; left over: {left}")
    return {"killed": killed, "finished": finished + 1, "different": different, "left over": left}


def _same(one: Path, other: Path) -> bool:
    names: Sequence[Path]
    names, others = (
        sorted(path.relative_to(folder) for path in folder.rglob("*") if path.is_file())
        for folder in (one, other)
    )
    return names == others and filecmp.cmpfiles(one, other, names, shallow=False)[1:] == ([], [])


def ahead(content: dict, quick: bool) -> dict:
    """Estimate the hours for 10^10 cells on 100 machines like this one: Fig. 3.12, and five masses."""
    finest = content["size"][-1]
    of_one = finest["store"]["seconds"] / finest["n"] ** 2
    of_five = content["study"]["seconds"] / content["study"]["cells"]
    found = {name: 1e10 * each / 100 / 60 for name, each in (("one mass", of_one), ("five masses", of_five))}
    words = ", ".join(f"{name} {minutes:.2g} min" for name, minutes in found.items())
    print(f"10^10 cells on 100 machines like this: {words}")
    return {"minutes of 1e10 cells on 100 machines": found}
