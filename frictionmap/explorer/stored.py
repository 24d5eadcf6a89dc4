"""The page as one file, with precomputed maps for positions of its sliders.

The file asks nothing of any host: style, modules and maps are in it, and it opens without a server.  Maps are
coloured classes, and quantities in 255 steps, the resolution of the colours; compressed, as text.  The file
also contains the motion in the cell that the page opens with.
"""

import base64
import json
import re
import zlib
from collections.abc import Iterator
from itertools import product
from pathlib import Path
from typing import Any, NamedTuple, Protocol

import numpy as np

from ..errors import InputError
from .cell import motion
from .example import example_cell
from .lines import line_names
from .packets import pack
from .pieces import classes_of, solve_piece, values_of
from .quantities import CellQuantity, quantities_of
from .queries import read_query
from .scene import Scene, Slider
from .scene_description import describe_scene, description, units_of
from .server import page_files
from .views import Follower, Piece, View

#: Cells of every map, each way, by whether they take long.
_CELLS = {False: (360, 270), True: (180, 135)}

#: Places of each slider: two sliders are moved together, further ones by themselves.
_PLACES, _TOGETHER = 7, 2

#: Share of a map that is done when its cells are computed, at most.
_PACKED = 0.99

#: Steps of a quantity; 0 is no number.
_STEPS = 255

#: What holds the page together.  Styles are set by its modules.
_POLICY = (
    "default-src 'none'; script-src 'unsafe-inline' data:; style-src 'unsafe-inline'; img-src data: blob:"
)


class MapProgress(Protocol):
    """Receiver of the number of finished maps, including the share of the current one."""

    def __call__(self, done: float, total: float) -> None: ...


class _OneOf(NamedTuple):
    """Progress of all maps while one is computed; it is never cancelled."""

    progress_of_all: MapProgress
    before: int  # maps that are done
    total: int

    def watch(self) -> None:
        """Go on."""

    def progress(self, done: float, total: float) -> None:
        """The map counts as done once it is packed."""
        self.progress_of_all(self.before + min(done / total, _PACKED), self.total)


class _Unwatched:
    """Receiver of a result that is never cancelled."""

    def watch(self) -> None:
        """Go on."""

    def progress(self, done: float, total: float) -> None:
        """Report nothing."""


class _Kept(NamedTuple):
    """Slider positions for which a file contains maps."""

    values: dict[str, list[float]]  # places of sliders
    points: list[tuple[float, ...]]  # of all those sliders


def check_page(path: Path) -> None:
    """Refuse a file name that browsers would not open as a page."""
    if path.suffix.lower() not in (".html", ".htm"):
        raise InputError(f"--export must end in .html; got {path}")


def places_of(slider: Slider) -> list[float]:
    """Values of a slider for which maps are computed, including its initial one."""
    shares = np.linspace(0.0, 1.0, _PLACES)
    if slider.scale == "log":
        found = slider.least * (slider.most / slider.least) ** shares
    else:
        found = slider.least + (slider.most - slider.least) * (
            shares**3 if slider.scale == "square" else shares
        )
    rounded = {float(f"{value:.3g}") for value in found}
    return sorted({*rounded, slider.value})


def _kept(sliders: tuple[Slider, ...]) -> _Kept:
    values = {slider.key: places_of(slider) for slider in sliders}
    own = [slider.value for slider in sliders]
    points = [(*pair, *own[_TOGETHER:]) for pair in product(*list(values.values())[:_TOGETHER])]
    for k, slider in enumerate(sliders[_TOGETHER:], start=_TOGETHER):
        others = [value for value in values[slider.key] if value != slider.value]
        points += [(*own[:k], value, *own[k + 1 :]) for value in others]
    return _Kept(values, points)


def _deflated(body: bytes) -> str:
    return base64.b64encode(zlib.compress(body, 9)).decode()


def _stepped(values: np.ndarray, log: bool) -> dict[str, Any]:
    """Quantise a quantity in linear or logarithmic steps; infinite values get the last one."""
    known = values[np.isfinite(values) & ((values > 0.0) | (not log))]
    low, high = (float(known.min()), float(known.max())) if known.size else (1.0, 1.0)
    high = high if high > low else low + 1.0
    share = np.log(values / low) / np.log(high / low) if log else (values - low) / (high - low)
    steps = 1.0 + np.rint((_STEPS - 1) * np.clip(share, 0.0, 1.0))
    steps[np.isnan(values)] = 0.0
    return {"low": low, "high": high, "log": log, "steps": _deflated(steps.astype(np.uint8).tobytes())}


def _cells(view: View) -> tuple[int, int]:
    """Cells of every map of a system, each way."""
    return _CELLS[not view.is_quick]


def _map(view: View, offered: tuple[CellQuantity, ...], follower: Follower) -> dict[str, Any]:
    """The map of a view, with all quantities."""
    columns, rows = _cells(view)
    found = solve_piece(view, offered, Piece(columns, rows, 0, columns), follower)
    names = line_names(view)
    header, arrays = classes_of(found, names)
    limits = np.concatenate([arrays[name] for name in names])
    with np.errstate(divide="ignore", invalid="ignore"):
        values = {
            quantity.key: _stepped(values_of(found, quantity).astype(float), quantity.scale == "log")
            for quantity in offered
            if quantity.output
        }
    packed = {"classes": _deflated(arrays["classes"].tobytes()), "limits": _deflated(limits.tobytes())}
    return {**header, **packed, "values": values}


def _example(scene: Scene, view: View) -> dict[str, Any] | None:
    """The cell that the page opens with, and its motion; None if no cell moves."""
    cell = example_cell(view, _Unwatched())
    if cell is None:
        return None
    header, arrays = motion(view, *cell, _Unwatched())
    return {
        "cell": cell,
        "motion": _deflated(pack({**header, **units_of(scene, view), "others": False}, arrays)),
    }


def _name(kept: _Kept, point: tuple[float, ...]) -> str:
    """Name of a map: the positions of its sliders, counted from 0."""
    places = (values.index(value) for values, value in zip(kept.values.values(), point, strict=True))
    return ",".join(map(str, places))


def _content(scene: Scene, progress: MapProgress) -> dict[str, Any]:
    """Content of a saved page."""
    kept = _kept(scene.sliders)
    first = read_query(scene, "")
    offered = quantities_of(first.view)
    maps, count = {}, len(kept.points)
    systems: list[dict[str, Any]] = []  # few of them: not all sliders change them
    for done, point in enumerate(kept.points):
        text = "&".join(f"{key}={value!r}" for key, value in zip(kept.values, point, strict=True))
        query = read_query(scene, text)
        of_map = _map(query.view, offered, _OneOf(progress, done, count))
        about = description(scene, query.view)
        if about not in systems:
            systems.append(about)
        maps[_name(kept, point)] = {**of_map, "about": systems.index(about)}
        progress(done + 1, count)
    columns, rows = _cells(first.view)
    own = tuple(slider.value for slider in scene.sliders)
    return {
        "scene": describe_scene(scene, first.view),
        "r": scene.r, "beta": scene.beta, "columns": columns, "rows": rows,
        "values": kept.values, "first": _name(kept, own), "maps": maps, "systems": systems,
        "example": _example(scene, first.view),
    }  # fmt: skip


def _modules(files: dict[str, bytes]) -> Iterator[tuple[str, str]]:
    """Modules by bare names, as a page in one file has no file names to import from."""
    for name, body in files.items():
        if name.endswith(".js"):
            text = re.sub(r'from "\./([a-z]+)\.js"', r'from "\1"', body.decode())
            yield name.removesuffix(".js"), text


def _page(content: dict[str, Any]) -> str:
    files = page_files()
    modules = dict(_modules(files))
    main = modules.pop("main")
    where = {
        name: f"data:text/javascript;base64,{base64.b64encode(text.encode()).decode()}"
        for name, text in modules.items()
    }
    # "<" begins a tag wherever it stands in a script
    data, imports = (
        json.dumps(part, ensure_ascii=False).replace("<", "\\u003c") for part in (content, {"imports": where})
    )
    head = (
        f'<meta http-equiv="Content-Security-Policy" content="{_POLICY}">\n'
        f"<style>{files['page.css'].decode()}</style>\n"
        f'<script type="application/json" id="stored">{data}</script>\n'
        f'<script type="importmap">{imports}</script>\n'
        f'<script type="module">{main}</script>'
    )
    links = re.compile(r'  <link rel="stylesheet".*?</script>', re.DOTALL)
    return links.sub(lambda _: head, files["index.html"].decode(), count=1)


def write_page(scene: Scene, progress: MapProgress) -> bytes:
    """The page of a scene as one file.

    Places of sliders: all of mu together with all of the next slider; of further ones each by itself, with
    the others where the scene has them.  Its sliders move to places only that have a map.
    """
    return _page(_content(scene, progress)).encode()
