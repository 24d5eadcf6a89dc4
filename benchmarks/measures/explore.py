"""Response times of the interactive page in headless Chromium.

Times are measured in the page: from the input event, or from the start of loading, to the task after the
frame that shows the result. "loaded" refers to a new server process, which imports and loads its kernels;
"loaded again" to a server that is running. The map has 500 x 500 pixels. "outdated" is the time from the
request that cancels a slow computation to its end. Kernels are compiled beforehand, but not for the quick
form; processes, servers and pages are new in every round.
"""

import contextlib
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from .. import ROOT
from ..report.record import save, spread, table
from .browser import NoBrowser, chromium, skipped

#: Pixels of the map each way.
PIXELS = 500

#: Rounds, and inputs of each kind in a round; by quick.
ROUNDS = {False: 3, True: 1}
INPUTS = {False: 15, True: 1}

#: What is measured where, and what it should take at most on two idle processors [ms].
ONE, FIVE = "one mass", "five masses"
CONFIGS = {ONE: "fig-3-12.toml", FIVE: "fig-6-17.toml"}
GOALS = {
    (ONE, "loaded to painted"): 1000.0,
    (ONE, "loaded again to painted"): 1000.0,
    (ONE, "slider to painted"): 120.0,
    (ONE, "hover to motion"): 30.0,
    (FIVE, "first picture"): 300.0,
    (FIVE, "full picture"): 3000.0,
    (FIVE, "outdated"): 50.0,
}

#: What the page is given to measure itself with.
_TOOLS = """() => {
  const stage = document.querySelector('#stage');
  const heard = (element, fits) => new Promise((done) => {
    const listen = (event) => {
      if (!fits(event.detail)) return;
      element.removeEventListener('painted', listen);
      setTimeout(() => done(performance.now()));
    };
    element.addEventListener('painted', listen);
  });
  window.measured = {
    size: async (pixels) => {
      Object.assign(stage.style, { flex: 'none', width: `${pixels + 80}px`, height: `${pixels + 68}px` });
      await window.measured.whole(pixels);
    },
    whole: (pixels) => heard(stage, ({ columns, whole }) => whole && columns === pixels),
    slide: async (name, value, pixels) => {
      const range = document.querySelector(`input[type=range][name='${name}']`);
      const [first, whole] = [heard(stage, () => true), window.measured.whole(pixels)];
      const began = performance.now();
      range.value = value;
      range.dispatchEvent(new Event('input'));
      return [await first - began, await whole - began];
    },
    hover: async (across, up) => {
      const { left, top, width, height } = stage.getBoundingClientRect();
      const at = { clientX: left + 64 + across * (width - 80), clientY: top + 18 + (1 - up) * (height - 68) };
      const shown = heard(document.querySelector('#motion'), () => true);
      const began = performance.now();
      stage.dispatchEvent(new PointerEvent('pointermove', { ...at, pointerType: 'mouse', bubbles: true }));
      return await shown - began;
    },
    outdate: async (slow, quick) => {
      const first = fetch(`map?${slow}&page=measured`);
      await new Promise((done) => setTimeout(done, 400));
      const began = performance.now();
      const second = fetch(`map?${quick}&page=measured`);
      const { status } = await first;
      const ended = performance.now();
      await second;
      return [status, ended - began];
    },
  };
}"""


@contextlib.contextmanager
def _served(config: str) -> Iterator[str]:
    """Start a server in a new process and return its address."""
    search = os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])
    command = [sys.executable, "-m", "frictionmap", "explore", str(ROOT / "configs" / config)]
    process = subprocess.Popen(
        [*command, "--no-browser", "--port", "0", "--set", "grid.mu=1.0"],
        env={**os.environ, "PYTHONPATH": search},
        stdout=subprocess.PIPE,
        text=True,
    )
    try:
        assert process.stdout is not None
        yield next(word for word in process.stdout.readline().split() if word.startswith("http"))
    finally:
        process.terminate()
        process.communicate()


def _opened(browser: Any, url: str) -> tuple[Any, float]:
    """Open a page; return it with the milliseconds from the start of loading to its finest map."""
    page = browser.new_page(viewport={"width": 1280, "height": 900})
    page.set_default_timeout(600_000)
    page.goto(url)
    page.wait_for_selector("#stage[data-state=done]")
    return page, float(page.evaluate("performance.getEntriesByName('first whole picture')[0].startTime"))


def _page(browser: Any, url: str) -> tuple[Any, float]:
    """Open a page with a map of the measured size; return it with the milliseconds of loading."""
    page, loaded = _opened(browser, url)
    page.evaluate(_TOOLS)
    page.evaluate("(pixels) => window.measured.size(pixels)", PIXELS)
    page.wait_for_selector("#stage[data-state=done]")
    return page, loaded


def _loaded_again(browser: Any, url: str) -> float:
    """Milliseconds of loading a page whose server has loaded its kernels."""
    page, loaded = _opened(browser, url)
    page.close()
    return loaded


def _slides(page: Any, count: int) -> list[list[float]]:
    """Times to the first and to the finest map of a slider that is moved step by step."""
    found = []
    for k in range(count):
        found.append(
            page.evaluate(
                "([value, pixels]) => window.measured.slide('damping_ratios', value, pixels)",
                [60 + 12 * k, PIXELS],
            )
        )
        page.wait_for_selector("#stage[data-state=done]")
        page.wait_for_timeout(300)  # what follows a view that stands still is done
    return found


def _hovers(page: Any, count: int) -> list[float]:
    found = []
    for k in range(count):
        at = [0.1 + 0.8 * (k + 0.5) / count, 0.05 + 0.5 * (k + 0.5) / count]
        found.append(page.evaluate("(at) => window.measured.hover(...at)", at))
        page.wait_for_timeout(400)
    return found


def _outdated(page: Any, count: int) -> list[float]:
    slow = "columns=800&rows=800&mu=1.9&r=0.02,0.5&beta=0.01,1"
    found = []
    for k in range(count):
        status, took = page.evaluate(
            "([slow, quick]) => window.measured.outdate(slow, quick)",
            [slow, f"columns=3&rows={3 + k}&mu=1.9"],
        )
        if status != 204:
            raise RuntimeError(f"a slow request ended by itself, with {status}")
        found.append(took)
    return found


def _warm(browser: Any, config: str) -> None:
    """Compile everything that the scene needs."""
    with _served(config) as url:
        page, _ = _page(browser, url)
        _slides(page, 1)
        _hovers(page, 1)
        page.close()


def _scene(browser: Any, name: str, rounds: int, inputs: int) -> dict[str, list[float]]:
    """Milliseconds of all measurements of a scene."""
    taken: dict[str, list[float]] = {
        "started to address": [],
        "loaded to painted": [],
        "loaded again to painted": [],
    }
    if rounds > 1:
        _warm(browser, CONFIGS[name])
    for _ in range(rounds):
        began = time.perf_counter()
        with _served(CONFIGS[name]) as url:
            taken["started to address"].append(1000.0 * (time.perf_counter() - began))
            page, loaded = _page(browser, url)
            taken["loaded to painted"].append(loaded)
            taken["loaded again to painted"].append(_loaded_again(browser, url))
            slides = _slides(page, inputs)
            if name == ONE:
                taken.setdefault("slider to painted", []).extend(whole for _, whole in slides)
            else:
                taken.setdefault("first picture", []).extend(first for first, _ in slides)
                taken.setdefault("full picture", []).extend(whole for _, whole in slides)
            taken.setdefault("hover to motion", []).extend(_hovers(page, inputs))
            if name == FIVE:
                taken.setdefault("outdated", []).extend(_outdated(page, inputs))
            page.close()
    return taken


def run(quick: bool, results: Path) -> dict:
    """Measure, print and save."""
    try:
        with chromium() as browser:
            version = browser.version
            names = [ONE] if quick else [ONE, FIVE]
            found = {name: _scene(browser, name, ROUNDS[quick], INPUTS[quick]) for name in names}
    except NoBrowser as missing:
        return skipped("explore", missing, results)
    scenes = {name: {what: spread(times) for what, times in taken.items()} for name, taken in found.items()}
    rows = [
        (
            name,
            what,
            entry["median"],
            entry["least"],
            entry["most"],
            GOALS.get((name, what), ""),
            entry["runs"],
        )
        for name, taken in scenes.items()
        for what, entry in taken.items()
    ]
    table(("scene", "what", "ms", "least", "most", "at most", "runs"), rows)
    content = {"browser": version, "pixels": PIXELS, "milliseconds": scenes}
    save("explore", content, results)
    return content
