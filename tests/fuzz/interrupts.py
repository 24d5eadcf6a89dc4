"""Interrupts at random moments of all commands: each run ends at once, nothing is lost, nothing is left
behind.
"""

import contextlib
import random
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from . import machine
from .folders import Change, snapshot
from .machine import ended, said_by, slowness, start
from .moments import SIGNALS, VERBS, Commands, Run, wait_for_new
from .verdict import ANSWER, CHANGED, HANG, LEFT, LINES, SLOW, STATUS, TRACEBACK, Family, Said

#: Seconds that a run may take to end, on a machine of its own.
_ALLOWED = 2.0

#: Times that until a run that has not ended hangs.
_HANGS = 5.0

#: By quick: moments of each verb and signal, and so many more while the output is being written.
_MOMENTS = {False: (5, 3), True: (1, 0)}

#: Verbs of the quick form.
_QUICK = ("map", "plot")

#: How a run may end: by the signal itself, with the status for interrupts, or it was through.
_STATUSES = {
    "SIGINT": (130, -signal.SIGINT, 0),
    "SIGINT twice": (130, -signal.SIGINT, 0),
    "SIGTERM": (130, 143, -signal.SIGTERM, 0),
    "SIGHUP": (130, -signal.SIGHUP, 0),
    "SIGKILL": (-signal.SIGKILL, 0),
}

#: What only Python's own start can say: an interrupt came before the program was loaded.
_OURS = ("frictionmap", "numba", "xarray", "matplotlib", "numpy")


@dataclass(frozen=True)
class Moment:
    """When a run is interrupted, and the content of its folder before."""

    of: Run
    signal: str
    delay: float  # seconds after the start, or after the first file appears
    writing: bool
    existing: bool

    def __str__(self) -> str:
        where = "after the first file appeared" if self.writing else f"of {self.of.seconds:.2f}"
        there = ", with an output there" if self.existing else ""
        return f"{self.of.verb}: {self.signal} after {self.delay:.3f} s {where}{there}"


def moments_of(
    runs: list[Run], start_up: float, counts: tuple[int, int], rng: random.Random
) -> Iterator[Moment]:
    """Moments spread evenly over the duration of a run, after the start of Python itself."""
    spread, writing = counts
    for one in runs:
        for name in SIGNALS:
            for k in range(spread):
                delay = start_up + (1.05 * one.seconds - start_up) * (k + rng.random()) / spread
                yield Moment(one, name, delay, False, bool(one.output) and k % 2 == 0)
            for k in range(writing if one.output else 0):
                yield Moment(one, name, rng.random() * 0.3 * one.seconds, True, k % 2 == 0)


def _start_up() -> float:
    """Seconds until Python itself has started."""
    taken = []
    for _ in range(3):
        began = time.perf_counter()
        subprocess.run([sys.executable, "-c", "pass"], check=True)
        taken.append(time.perf_counter() - began)
    return 1.5 * max(taken)


def _interrupted(moment: Moment, folder: Path, env: dict[str, str], limit: float) -> Said:
    """Start the run and interrupt it; the seconds are counted from the interrupt."""
    known = {path.name for path in folder.iterdir()}
    process = start(moment.of.arguments, folder, env)
    with ended(process):
        if moment.writing:
            wait_for_new(folder, known, time.perf_counter() + 3.0 * moment.of.seconds)
        with contextlib.suppress(subprocess.TimeoutExpired):
            process.wait(moment.delay)
        for one in SIGNALS[moment.signal]:
            process.send_signal(one)  # nothing, if it has ended
            with contextlib.suppress(subprocess.TimeoutExpired):
                process.wait(0.05 if moment.signal.endswith("twice") else 0.0)
        return said_by(process, limit)


def _before_the_program(said: Said) -> bool:
    """Whether the interrupt came while Python itself was starting."""
    return said.traceback and not any(f"{name}/" in said.err for name in _OURS)


def wrong_end(moment: Moment, said: Said, allowed: float) -> str | None:
    """Check how a run ended; return the defect."""
    if said.status is None:
        return HANG
    if said.traceback and not _before_the_program(said):
        return TRACEBACK
    if said.status not in _STATUSES[moment.signal] and not _before_the_program(said):
        return STATUS
    if said.seconds > allowed:
        return SLOW
    return LINES if len(said.lines) > 1 and not _before_the_program(said) else None


def _wrong_files(
    moment: Moment, said: Said, folder: Path, before: dict, env: dict[str, str]
) -> tuple[str | None, str]:
    """Check the files after the run; return the defect."""
    change = Change.between(before, snapshot(folder))
    others = [name for name in change.lost if name != moment.of.output]
    if others or (moment.of.output in change.lost and not moment.of.whole(folder)):
        return CHANGED, str(change)
    left = [name for name in change.new if name != moment.of.output]
    if moment.of.output in change.new and not moment.of.whole(folder):
        left.append(moment.of.output)
    if left and moment.signal == "SIGKILL":
        left = _after_the_next_run(folder, left, env)
    if left:
        return LEFT, ", ".join(left)
    written = moment.of.output in (*change.lost, *change.new)
    return (ANSWER, str(said)) if written and "nothing was written" in said.err else (None, "")


def _after_the_next_run(folder: Path, left: list[str], env: dict[str, str]) -> list[str]:
    """Defects that remain after the next run has written to the same folder."""
    machine.run(["map", "small.toml", "-o", "next.nc", "--quiet"], folder, env)
    return [name for name in left if (folder / name).exists()]


def _try(
    moment: Moment, prepared: Path, folder: Path, env: dict[str, str], allowed: float
) -> tuple[str | None, str]:
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(prepared, folder)
    if moment.existing:
        (folder / moment.of.output).write_text("somebody's work")
    before = snapshot(folder)
    said = _interrupted(moment, folder, env, _HANGS * allowed)
    wrong = wrong_end(moment, said, allowed)
    if wrong is not None:
        return wrong, f"{said.seconds:.1f} s, {said}"
    return _wrong_files(moment, said, folder, before, env)


def run(commands: Commands, folder: Path, quick: bool) -> list[Family]:
    """One family per signal."""
    runs = [commands.measured(verb) for verb in (_QUICK if quick else VERBS)]
    rng = random.Random(3)
    families = {name: Family(f"interrupts: {name}") for name in SIGNALS}
    moments = list(moments_of(runs, _start_up(), _MOMENTS[quick], rng))
    for moment in moments:
        allowed = _ALLOWED * slowness()
        tried = _try(moment, commands.prepared, folder / "here", commands.env, allowed)
        families[moment.signal].add(moment, *tried)
    return list(families.values())
