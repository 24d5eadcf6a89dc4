"""The first minute with the page, second by second: fresh clone, virtual environment, no compiled kernels.

The benchmark records what a new user sees of `frictionmap explore` in headless Chromium: every change of
texts and pictures, and the requests without an answer. Once the motion runs, the user points at another cell,
asks for a response curve and chooses another quantity. "longest without a change" is the longest time for
which a request without an answer changed nothing on the screen, "longest without an estimate" the longest of
these times without a text that states how long it takes. The clone has the committed files of this checkout.
The quick form uses this checkout itself, with the kernels compiled so far.
"""

import contextlib
import os
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

from .. import ROOT
from ..report.record import save, spread, table, timed
from .browser import NoBrowser, chromium, skipped

CONFIG = "fig-3-12.toml"

#: Rounds, by quick.
ROUNDS = {False: 1, True: 1}

#: Milliseconds that a step may take, on a slow machine.
HANG = 600_000

#: Seconds that the user looks at the page before each step, by quick.
LOOK = {False: 2.0, True: 0.2}

#: Longest waits, in the results.
UNCHANGED, UNEXPLAINED = "longest without a change", "longest without an estimate"

#: What a step should take at most [s].
GOALS = {"boundaries": 3.0, UNEXPLAINED: 2.0}

#: Beginning of the text that states how long a wait is.
_ESTIMATE = "First use: compiling"

#: What the page shows by itself, and the condition that ends each wait.
_CELLS = "document.querySelector('#stage')?.dataset.cells ?? ''"
_DONE = "document.querySelector('#stage').dataset.state === 'done'"
SHOWN = {
    "boundaries": f"() => ({_CELLS}) !== ''",
    "map": f"() => !['', '1 1'].includes({_CELLS})",
    "finest map": f"() => {_DONE}",
    "motion runs": "() => Number(document.querySelector('#motion .time')?.value) > 0",
}

#: Conditions that end the waits for what the user asks for.
_POINTED = "() => /^r/.test(document.querySelector('#motion .where')?.innerText ?? '')"
_CURVE = "() => !document.querySelector('#cut').hidden"
_COLOURED = f"() => {_DONE} && !document.querySelector('#legend').classList.contains('outdated')"

#: Records in the page, every 50 ms, what has changed.
_NOTES = """() => {
  const pending = new Map();
  const ask = window.fetch;
  let count = 0;
  window.fetch = async (...asked) => {
    const name = new URL(asked[0], location).pathname.slice(1);
    const key = (count += 1);
    if (name !== 'state') pending.set(key, name);
    try { return await ask(...asked); } finally { pending.delete(key); }
  };
  const text = (name) => {
    const found = document.querySelector(name);
    return found && found.checkVisibility() ? found.innerText.trim().replace(/\\s+/g, ' ') : '';
  };
  const screen = () => ({
    cells: document.querySelector('#stage')?.dataset.cells ?? '',
    state: document.querySelector('#stage')?.dataset.state ?? '',
    message: text('#message'),
    motion: text('#motion .regime') || text('#motion'),
    other: text('#motion .others'),
    curve: text('#cut'),
    legend: text('#legend'),
  });
  window.noted = [];
  let last = '';
  setInterval(() => {
    const now = { screen: screen(), pending: [...pending.values()] };
    if (JSON.stringify(now) === last) return;
    last = JSON.stringify(now);
    window.noted.push({ at: (performance.timeOrigin + performance.now()) / 1000, ...now });
  }, 50);
}"""


class Program(NamedTuple):
    """An installed program: its command, folder and environment."""

    command: list[str]
    folder: Path
    environment: dict[str, str]


def _run(*command: object, **options: Any) -> None:
    subprocess.run([str(word) for word in command], check=True, stdout=subprocess.DEVNULL, **options)


def _installed(folder: Path, taken: dict[str, float]) -> Program:
    """Clone, create an environment and install, as README says; record the seconds of each."""
    clone = folder / "frictionmap"
    python = clone / ".venv" / "bin" / "python"
    taken["clone"], _ = timed(lambda: _run("git", "clone", "--quiet", ROOT, clone))
    taken["virtual environment"], _ = timed(lambda: _run(sys.executable, "-m", "venv", clone / ".venv"))
    taken["installation"], _ = timed(lambda: _run(python, "-m", "pip", "install", "--quiet", ".", cwd=clone))
    kept = {name: text for name, text in os.environ.items() if name not in ("NUMBA_CACHE_DIR", "PYTHONPATH")}
    return Program([str(python.parent / "frictionmap")], clone, kept)


def _here() -> Program:
    """The package of this checkout, with the kernels compiled so far."""
    search = os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])
    return Program([sys.executable, "-m", "frictionmap"], ROOT, {**os.environ, "PYTHONPATH": search})


class Terminal:
    """What the program prints, with the seconds since it was started."""

    def __init__(self, program: Program) -> None:
        self.began = time.time()
        self.lines: list[tuple[float, str]] = []
        self.process = subprocess.Popen(
            [*program.command, "explore", f"configs/{CONFIG}", "--no-browser", "--port", "0"],
            cwd=program.folder,
            env=program.environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def _read(self) -> None:
        assert self.process.stdout is not None
        for line in self.process.stdout:
            self.lines.append((time.time() - self.began, line.rstrip()))

    def address(self) -> tuple[float, str]:
        """Seconds until the server was ready, and its address."""
        while self.process.poll() is None:
            for seconds, line in list(self.lines):
                for word in line.split():
                    if word.startswith("http"):
                        return seconds, word
            time.sleep(0.005)
        raise RuntimeError(f"the server did not start: {self.lines}")

    def end(self) -> None:
        """Stop the program."""
        self.process.terminate()
        self.process.wait()


@contextlib.contextmanager
def _started(program: Program) -> Iterator[Terminal]:
    terminal = Terminal(program)
    try:
        yield terminal
    finally:
        terminal.end()


def _seen(page: Any, condition: str, began: float) -> float:
    """Seconds from a time until a condition holds in the page."""
    page.wait_for_function(condition, polling=20)
    return time.time() - began


def _steps(page: Any, look: float) -> dict[str, float]:
    """Point at a cell, ask for a response curve and choose another quantity: seconds of each."""
    taken = {}
    box = page.locator("#stage").bounding_box()

    def step(name: str, act: Any, condition: str) -> None:
        time.sleep(look)
        began = time.time()
        act()
        taken[name] = _seen(page, condition, began)

    place = box["x"] + 0.75 * box["width"], box["y"] + 0.9 * box["height"]
    step("pointed: motion", lambda: page.mouse.move(*place), _POINTED)
    page.focus("#stage")
    step("asked: response curve", lambda: page.keyboard.press("r"), _CURVE)
    step("asked: amplitude", lambda: page.select_option("#quantity", index=1), _COLOURED)
    return taken


def waits(noted: list[dict]) -> dict[str, float]:
    """Longest times [s] for which a request without an answer changed nothing on the screen.

    noted : entries {at, screen, pending} in order of time, each valid until the next
    """
    found = {UNCHANGED: 0.0, UNEXPLAINED: 0.0}
    screen: object = None
    since = 0.0
    for entry, following in pairwise(noted):
        if not entry["pending"]:
            screen = None
            continue
        if entry["screen"] != screen:
            screen, since = entry["screen"], entry["at"]
        waited = following["at"] - since
        found[UNCHANGED] = max(found[UNCHANGED], waited)
        if not entry["screen"]["message"].startswith(_ESTIMATE):
            found[UNEXPLAINED] = max(found[UNEXPLAINED], waited)
    return found


def _watched(browser: Any, program: Program, taken: dict[str, float], look: float) -> list[dict]:
    """Start the program and open its page; record the seconds, and return what was on the screen."""
    with _started(program) as terminal:
        taken["server"], url = terminal.address()
        began = terminal.began + taken["server"]
        page = browser.new_page(viewport={"width": 1280, "height": 800})
        page.set_default_timeout(HANG)
        page.add_init_script(f"({_NOTES})()")
        page.goto(url, wait_until="commit")
        for name, condition in SHOWN.items():
            taken[name] = _seen(page, condition, began)
        taken |= _steps(page, look)
        time.sleep(look)
        noted = page.evaluate("() => window.noted")
        page.close()
    return [{**entry, "at": entry["at"] - began} for entry in noted]


def _words(screen: dict) -> str:
    """The screen in one line."""
    cells = {"": "nothing", "1 1": "boundaries"}.get(
        screen["cells"], f"map {screen['cells'].replace(' ', ' x ')}"
    )
    motion = screen["motion"].partition(".")[0]
    parts = [cells, screen["message"].rstrip("."), motion, "response curve" if screen["curve"] else ""]
    return "; ".join(part for part in parts if part)


def by_seconds(noted: list[dict]) -> list[tuple[int, str, str]]:
    """What was on the screen at full seconds, and requests without an answer; repetitions are left out."""
    rows, last = [], ""
    for second in range(int(noted[-1]["at"]) + 2):
        before = [entry for entry in noted if entry["at"] <= second]
        words = _words(before[-1]["screen"]) if before else "no page"
        asked = ", ".join(sorted(set(before[-1]["pending"]))) if before else ""
        if words + asked != last:
            rows.append((second, words, asked))
        last = words + asked
    return rows


def _round(browser: Any, quick: bool) -> tuple[dict[str, float], list[dict]]:
    """Seconds of all steps, and the record of the screen."""
    taken: dict[str, float] = {}
    with tempfile.TemporaryDirectory() as folder:
        program = _here() if quick else _installed(Path(folder), taken)
        noted = _watched(browser, program, taken, LOOK[quick])
    return taken | waits(noted), noted


def run(quick: bool, results: Path) -> dict:
    """Measure, print and save."""
    try:
        with chromium() as browser:
            version = browser.version
            rounds = [_round(browser, quick) for _ in range(ROUNDS[quick])]
    except NoBrowser as missing:
        return skipped("first_minute", missing, results)
    seconds = {name: spread([taken[name] for taken, _ in rounds]) for name in rounds[0][0]}
    noted = rounds[0][1]
    table(("second", "on the screen", "requests without an answer"), by_seconds(noted))
    print()
    rows = [
        (name, entry["median"], entry["least"], entry["most"], GOALS.get(name, ""))
        for name, entry in seconds.items()
    ]
    table(("step", "seconds", "least", "most", "at most"), rows)
    content = {"browser": version, "configuration": CONFIG, "seconds": seconds, "screen": by_seconds(noted)}
    save("first_minute", content, results)
    return content
