"""Duration of the runs of every command, for interrupts at any moment, and the files they leave."""

import os
import shutil
import signal
import time
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import xarray as xr
from matplotlib.image import imread

from .folders import CONFIG
from .machine import run

#: A map that takes about a second to compute, and some tenths to write; in the quick form a fifth of that.
_CELLS = {False: 500, True: 220}
_LONG = """\
[system]
contact = "joined-base-wall"
damping_ratios = 0.01

[grid]
r = {{ start = 0.2, stop = 2.0, num = {r} }}
beta = {{ start = 0.01, stop = 2.0, num = {beta} }}
mu = [1.0, 1.5]

[solver]
outputs = ["regime", "stops_per_cycle", "contact_amplitude", "stuck_fraction", "period", "cycles", "status"]
"""
_LOW = CONFIG.replace("[1.0, 1.5]", "[1.0]")

#: Verb: arguments without the output, and the output; quiet, so that every line is an error.
VERBS: dict[str, tuple[tuple[str, ...], str]] = {
    "map": (("map", "long.toml", "--quiet"), "out.nc"),
    "boundaries": (("boundaries", "curves.toml", "--quiet"), "out.nc"),
    "response": (("response", "low.toml", "--r", "0.002", "--beta", "0.5", "--quiet"), "out.nc"),
    "plot": (("plot", "given.nc", "--quiet"), "out.png"),
    "info": (("info", "given.nc"), ""),
}


def inputs(folder: Path, env: dict[str, str], quick: bool) -> Path:
    """Folder with all inputs of the commands; given.nc is the map of small.toml."""
    folder.mkdir(parents=True)
    long = _LONG.format(r=_CELLS[quick], beta=_CELLS[quick])
    curves = _LONG.format(r=200_000, beta=500)
    for name, text in (("long", long), ("curves", curves), ("low", _LOW), ("small", CONFIG)):
        (folder / f"{name}.toml").write_text(text)
    said = run(["map", "small.toml", "-o", "given.nc", "--quiet"], folder, env)
    if said.status != 0:
        raise RuntimeError(f"map: {said}")
    return folder


def same_file(one: Path, other: Path) -> bool:
    """Whether two outputs have the same content, apart from the time of writing."""
    try:
        if one.suffix == ".png":
            return bool(np.array_equal(imread(one), imread(other)))
        with xr.open_dataset(one) as first, xr.open_dataset(other) as second:
            return first.equals(second)
    except Exception:  # a damaged file is another one
        return False


@dataclass(frozen=True)
class Run:
    """One command: its duration and its output without interrupts."""

    verb: str
    arguments: list[str]
    output: str
    seconds: float
    result: Path | None

    @classmethod
    def measured(cls, verb: str, prepared: Path, env: dict[str, str], folder: Path) -> "Run":
        """Run a command twice in a new folder; the second run counts, with complete caches."""
        given, output = VERBS[verb]
        arguments = [*given, *(["-o", output, "--overwrite"] if output else [])]
        shutil.copytree(prepared, folder)
        for _ in range(2):
            said = run(arguments, folder, env)
            if said.status != 0:
                raise RuntimeError(f"{verb}: {said}")
        return cls(verb, arguments, output, said.seconds, folder / output if output else None)

    def whole(self, folder: Path) -> bool:
        """Whether the output in a folder is that of an uninterrupted run."""
        return self.result is None or same_file(folder / self.output, self.result)


@dataclass(frozen=True)
class Commands:
    """All commands of a package: their inputs, and each one's run without interrupts, which is made once."""

    prepared: Path
    env: dict[str, str]
    _runs: dict[str, Run] = field(default_factory=dict)

    def measured(self, verb: str) -> Run:
        """Duration and output of a command."""
        if verb not in self._runs:
            folder = self.prepared.with_name(f"whole-{verb}")
            self._runs[verb] = Run.measured(verb, self.prepared, self.env, folder)
        return self._runs[verb]


def wait_for_new(folder: Path, known: set[str], until: float) -> bool:
    """Wait until a new file appears; False if none appeared in time."""
    while time.perf_counter() < until:
        if set(os.listdir(folder)) - known:
            return True
        time.sleep(0.002)
    return False


#: Names of signals, with those that come twice.
SIGNALS: dict[str, tuple[signal.Signals, ...]] = {
    "SIGINT": (signal.SIGINT,),
    "SIGTERM": (signal.SIGTERM,),
    "SIGHUP": (signal.SIGHUP,),
    "SIGKILL": (signal.SIGKILL,),
    "SIGINT twice": (signal.SIGINT, signal.SIGINT),
}
