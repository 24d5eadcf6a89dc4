"""Full disks, read-only folders, terminals with few characters, closed standard streams."""

import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

from .folders import Change, snapshot
from .machine import prepared as preparation
from .machine import run as run_once
from .moments import VERBS, Commands
from .verdict import (
    CHANGED,
    LEFT,
    LINES,
    TRACEBACK,
    Family,
    Said,
    wrong_answer_or_refusal,
    wrong_refusal,
    wrong_success,
)

#: Bytes that the disk still takes.
_ROOM = (0, 512, 4096, 16384)

_TITLE = 'title="Reibung \u03bc \u2265 1, \u00dcbersicht"'


def _outputs() -> Iterator[tuple[list[str], str]]:
    """Arguments of every command that writes, and its output."""
    for given, output in VERBS.values():
        if output:
            name = f"wanted{Path(output).suffix}"
            yield [*given, "-o", name], name


def _untouched(
    said: Said, words: tuple, statuses: tuple[int, ...], before: dict, folder: Path
) -> tuple[str | None, str]:
    """Check for a refusal that changes nothing."""
    change = Change.between(before, snapshot(folder))
    if change:
        return (CHANGED if change.lost else LEFT), f"{change}; {said}"
    return wrong_refusal(said, words, statuses), str(said)


def _full(prepared: Path, folder: Path, env: dict[str, str], quick: bool) -> Family:
    """No space for the output: a line that names it, and no partial file."""
    family = Family("full disk")
    for room in _ROOM[:1] if quick else _ROOM:
        for arguments, name in list(_outputs())[: 1 if quick else None]:
            for overwrite in (True,) if quick else (False, True):
                shutil.rmtree(folder, ignore_errors=True)
                shutil.copytree(prepared, folder)
                if overwrite:
                    (folder / name).write_text("somebody's work")
                before = snapshot(folder)
                given = [*arguments, *(["--overwrite"] if overwrite else [])]
                said = run_once(given, folder, env, preexec_fn=preparation(file_size=room))
                what = f"{' '.join(given)} with room for {room} bytes"
                family.add(what, *_untouched(said, ((name,),), (1, 2), before, folder))
    return family


def _read_only(prepared: Path, folder: Path, env: dict[str, str], quick: bool) -> Family:
    """Read-only folder, and unreadable files."""
    family = Family("read-only folder, unreadable files")
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(prepared, folder)
    (folder / "secret.toml").write_text("")
    (folder / "secret.toml").chmod(0)
    (folder / "secret.nc").write_bytes((folder / "given.nc").read_bytes())
    (folder / "secret.nc").chmod(0)
    cases = list(_outputs())
    cases += [(["map", "small.toml", "--quiet"], "small.nc"), (["plot", "given.nc", "--quiet"], "given.png")]
    cases += [(["map", "secret.toml"], "secret.toml"), (["info", "secret.nc"], "secret.nc")]
    folder.chmod(0o555)
    try:
        before = snapshot(folder)
        for arguments, name in cases[:: 6 if quick else 1]:
            said = run_once(arguments, folder, env, preexec_fn=preparation(ordinary=True))
            family.add(" ".join(arguments), *_untouched(said, ((name,),), (1, 2), before, folder))
    finally:
        folder.chmod(0o755)
    return family


def _shell(command: str, folder: Path, env: dict[str, str]) -> Said:
    """A shell command; {} stands for the program."""
    line = command.format(f"'{sys.executable}' -m frictionmap")
    done = subprocess.run(
        ["bash", "-c", f"set -o pipefail; {line}"],
        cwd=folder,
        env=env,
        capture_output=True,
        timeout=300,
        check=False,
    )
    return Said(done.returncode, done.stdout.decode(errors="replace"), done.stderr.decode(errors="replace"))


def _no_traceback(said: Said) -> str | None:
    """A run whose reader was closed: any status, no traceback."""
    return TRACEBACK if said.traceback or "Exception ignored" in said.err else None


def _quiet_end(said: Said) -> str | None:
    """A run whose reader was closed: no traceback, and at most one line."""
    return _no_traceback(said) or (LINES if len(said.lines) > 1 else None)


def _one_line(said: Said) -> str | None:
    return wrong_refusal(said, (), (1, 2))


_ASCII = {"PYTHONIOENCODING": "ascii", "LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}
_LATIN = {"PYTHONIOENCODING": "latin-1"}

#: A line of a shell, what it may do, and what is different about the terminal.
_LINES: tuple[tuple[str, Callable[[Said], str | None], dict[str, str]], ...] = (
    ("{} info named.nc", wrong_success, _ASCII),
    ("{} info named.nc", wrong_success, _LATIN),
    ("{} plot named.nc --quiet -o n.png --overwrite", wrong_success, _ASCII),
    ("{} map small.toml --quiet -o n.nc --overwrite --set 'title=\u03bc'", wrong_answer_or_refusal, _ASCII),
    ("{} map nothere-\u03bc.toml", _one_line, _ASCII),
    ("{} map small.toml --quiet --set '\u03bc=1' -o x.nc", _one_line, _ASCII),
    ("{} info named.nc | head -1", _quiet_end, {}),
    ("{} info named.nc | true", _quiet_end, {}),
    ("{} --help | true", _quiet_end, {}),
    ("{} map small.toml -o n.nc --overwrite | true", _no_traceback, {}),
    ("{} info named.nc >/dev/full", _one_line, {}),
    ("{} --help >/dev/full", _quiet_end, {}),
    ("{} map small.toml -o full.nc >/dev/full", _no_traceback, {}),
    ("{} info named.nc >&-", _quiet_end, {}),
    ("{} map small.toml -o n.nc --overwrite >&-", _no_traceback, {}),
    ("{} map small.toml --quiet -o n.nc --overwrite 2>&-", wrong_success, {}),
    ("{} map nothere.toml 2>&-", lambda said: None if said.status == 2 else TRACEBACK, {}),
    ("{} map nothere.toml 2>/dev/full", lambda said: None if said.status == 2 else TRACEBACK, {}),
    ("{} map small.toml --quiet -o n.nc --overwrite <&-", wrong_success, {}),
    ("mkdir gone && cd gone && rmdir ../gone && {} map small.toml", _one_line, {}),
    ("mkdir gone && cd gone && rmdir ../gone && {} info nothere.nc", _one_line, {}),
    ("{}", _one_line, {}),
    ("{} --version", wrong_success, _ASCII),
    ("{} map --help", wrong_success, _ASCII),
)  # fmt: skip


def _terminals(prepared: Path, folder: Path, env: dict[str, str], quick: bool) -> Family:
    """Streams that accept no or few characters, or are closed."""
    family = Family("terminals and closed streams")
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(prepared, folder)
    run_once(["map", "small.toml", "-o", "named.nc", "--set", _TITLE], folder, env)
    for command, judge, more in _LINES[::8] if quick else _LINES:
        said = _shell(command, folder, env | more)
        family.add(f"{command.format('frictionmap')} {' '.join(more)}", judge(said), said)
    return family


def run(commands: Commands, folder: Path, quick: bool) -> list[Family]:
    """Run all three families."""
    given = commands.prepared, folder / "here", commands.env, quick
    return [_full(*given), _read_only(*given), _terminals(*given)]
