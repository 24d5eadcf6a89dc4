"""Several runs that write the same file, files that appear during a run, links and permissions."""

import os
import random
import shutil
import stat
import subprocess
import time
from collections.abc import Iterator
from itertools import islice
from pathlib import Path

from .machine import prepared as preparation
from .machine import run as run_once
from .machine import said_by, start
from .moments import VERBS, Commands, Run
from .verdict import (
    ANSWER,
    CHANGED,
    HANG,
    LEFT,
    STATUS,
    TRACEBACK,
    Family,
    wrong_refusal,
    wrong_success,
)  # fmt: skip

_MINE = b"somebody's work"
_LIMIT = 300.0

#: Trials of each race, and runs that write the same file; by quick.
_ROUNDS = {False: 5, True: 1}
_RUNS = {False: 4, True: 2}

_SMALL = ["map", "small.toml", "--quiet", "-o", "out.nc"]


def _copy(prepared: Path, folder: Path) -> Path:
    shutil.rmtree(folder, ignore_errors=True)
    return Path(shutil.copytree(prepared, folder))


def _left(folder: Path, prepared: Path, *outputs: str) -> list[str]:
    known = {path.name for path in prepared.iterdir()} | set(outputs)
    return [path.name for path in folder.iterdir() if path.name not in known]


def _at_once(
    of: Run, count: int, prepared: Path, folder: Path, env: dict[str, str], overwrite: bool
) -> tuple[str | None, str]:
    """Runs write the same file: one succeeds, with --overwrite several may; the others are refused."""
    _copy(prepared, folder)
    arguments = [word for word in of.arguments if overwrite or word != "--overwrite"]
    processes: list[subprocess.Popen] = [start(arguments, folder, env) for _ in range(count)]
    said = [said_by(process, _LIMIT) for process in processes]
    words = "; ".join(map(str, said))
    if any(one.status is None for one in said):
        return HANG, words
    if any(one.traceback for one in said):
        return TRACEBACK, words
    good = sum(one.status == 0 for one in said)
    if good == 0 or (good > 1 and not overwrite):
        return (CHANGED if good else STATUS), f"{good} of {count} succeeded; {words}"
    for one in said:
        if one.status != 0 and wrong_refusal(one, ((of.output,),), (1, 2)):
            return wrong_refusal(one, ((of.output,),), (1, 2)), words
    left = [name for name in _left(folder, prepared, of.output) if name not in words]
    if left:
        return LEFT, ", ".join(left)
    return (None, words) if of.whole(folder) else (ANSWER, words)


def _appears(
    of: Run, delay: float, prepared: Path, folder: Path, env: dict[str, str]
) -> tuple[str | None, str]:
    """A file of that name appears during the run: it is not replaced."""
    _copy(prepared, folder)
    process = start([word for word in of.arguments if word != "--overwrite"], folder, env)
    time.sleep(delay)
    try:
        with open(folder / of.output, "xb") as file:
            file.write(_MINE)
    except FileExistsError:  # the run has the name already
        said = said_by(process, _LIMIT)
        return wrong_success(said), str(said)
    said = said_by(process, _LIMIT)
    if (folder / of.output).read_bytes() != _MINE:
        return CHANGED, str(said)
    left = [name for name in _left(folder, prepared, of.output) if name not in said.err]
    return (LEFT, ", ".join(left)) if left else (wrong_refusal(said, ((of.output,),), (1, 2)), str(said))


def _links(prepared: Path, folder: Path, env: dict[str, str]) -> Iterator[tuple[str, str | None, str]]:
    """Links remain, their targets are replaced; permissions remain."""
    whole = Run("map", [], "out.nc", 0.0, prepared / "given.nc")

    for target in ("kept/target.nc", "kept/new.nc"):
        _copy(prepared, folder)
        (folder / "kept").mkdir()
        (folder / "kept" / "target.nc").write_bytes(_MINE)
        (folder / "out.nc").symlink_to(target)
        said = run_once([*_SMALL, "--overwrite"], folder, env)
        if said.status == 0:
            stays = (folder / "out.nc").is_symlink() and whole.whole(folder)
            left = _left(folder / "kept", prepared, "target.nc", "new.nc")
            yield f"a link to {target}", None if stays and not left else CHANGED, str(said)
        else:
            yield f"a link to {target}", wrong_refusal(said, (("out.nc",),)), str(said)

    for mode in (0o600, 0o640, 0o664, 0o444):
        _copy(prepared, folder)
        (folder / "out.nc").write_bytes(_MINE)
        (folder / "out.nc").chmod(mode)
        said = run_once([*_SMALL, "--overwrite"], folder, env, preexec_fn=preparation(ordinary=True))
        kept = stat.S_IMODE((folder / "out.nc").stat().st_mode) == mode
        name = f"permissions {mode:o}"
        if said.status == 0:
            yield name, None if kept and whole.whole(folder) else CHANGED, str(said)
        else:
            intact = (folder / "out.nc").read_bytes() == _MINE
            yield name, wrong_refusal(said, (("out.nc",),)) if intact else CHANGED, str(said)

    _copy(prepared, folder)
    (folder / "out.nc").write_bytes(_MINE)
    os.link(folder / "out.nc", folder / "other.nc")
    said = run_once([*_SMALL, "--overwrite"], folder, env)
    yield "a name of two", None if said.status == 0 and whole.whole(folder) else CHANGED, str(said)


def run(commands: Commands, folder: Path, quick: bool) -> list[Family]:
    """Run all three families."""
    rng = random.Random(4)
    prepared, here, env = commands.prepared, folder / "here", commands.env
    several = Family("several runs to one name")
    appearing = Family("files that appear during a run")
    for verb in ["map"] if quick else [verb for verb, (_, output) in VERBS.items() if output]:
        of = commands.measured(verb)
        for k in range(_ROUNDS[quick]):
            for overwrite in (False, True)[: 2 if k == 0 and not quick else 1]:
                what = f"{_RUNS[quick]} {verb}{' --overwrite' if overwrite else ''}"
                several.add(what, *_at_once(of, _RUNS[quick], prepared, here, env, overwrite))
            delay = rng.uniform(0.2, 0.95) * of.seconds
            appearing.add(f"{verb} after {delay:.2f} s", *_appears(of, delay, prepared, here, env))
    replaced = Family("links and permissions of what is replaced")
    for what, wrong, said in islice(_links(prepared, here, env), 1 if quick else None):
        replaced.add(what, wrong, said)
    return [several, appearing, replaced]
