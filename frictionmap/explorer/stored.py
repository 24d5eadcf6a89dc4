"""The page as one file, with precomputed maps for positions of its sliders.

The file asks nothing of any host: style, modules and maps are in it, and it opens without a server.  Maps are
coloured classes, and quantities in 255 steps, the resolution of the colours; compressed, as text.  The file
also contains motions: in the cell that the page opens with, and in cells over every map.
"""

import base64
import json
import re
import struct
import threading
import zlib
from collections.abc import Iterator, Sequence
from itertools import product
from pathlib import Path
from typing import Any, NamedTuple, Protocol

import numpy as np

from .. import checks
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

#: Cells of a map for each motion that is stored, each way: of the first map, and of others.
_PER_MOTION = {False: (24, 72), True: (12, 36)}

#: One sample of how many is stored, and bits of the numbers: as many as a chart shows.
_EVERY, _BITS = 4, 0xFFFFF000

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


def _points_of(sliders: Sequence[Slider]) -> list[tuple[float, ...]]:
    """Positions of the sliders with a map: the initial one, each slider by itself, the first two together."""
    own = tuple(slider.value for slider in sliders)
    values = [places_of(slider) for slider in sliders]
    alone = [(*own[:k], one, *own[k + 1 :]) for k, several in enumerate(values) for one in several]
    both = [(*pair, *own[_TOGETHER:]) for pair in product(*values[:_TOGETHER])]
    return list(dict.fromkeys([own, *alone, *both]))


def chosen_sliders(scene: Scene, keys: Sequence[str] | None) -> tuple[Slider, ...]:
    """The sliders of these keys, in the order of the page; None: all.

    Raises
    ------
    InputError
        There is no such slider.
    """
    known = [slider.key for slider in scene.sliders]
    for key in keys or ():
        if key not in known:
            raise InputError(
                f"unknown slider {key!r}{checks.nearest(key, known)}; valid: {', '.join(known) or 'none'}"
            )
    return tuple(slider for slider in scene.sliders if keys is None or slider.key in keys)


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


def _rounded(values: np.ndarray) -> np.ndarray:
    """Curves with as many digits as a chart shows: they take half the room."""
    if values.dtype != np.float32:
        return values
    return (np.ascontiguousarray(values).view(np.uint32) & np.uint32(_BITS)).view(np.float32)


def _thinned(arrays: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """The curves of a motion with fewer samples."""
    count = arrays["tau"].size if "tau" in arrays else 0
    return {
        name: _rounded(one[..., ::_EVERY]) if count and one.shape[-1] == count else one
        for name, one in arrays.items()
    }


def _motion_counts(shape: tuple[int, int], per_motion: int) -> tuple[int, int]:
    """Motions over a map of this number of cells, each way."""
    columns, rows = shape
    return max(1, columns // per_motion), max(1, rows // per_motion)


def _motions(scene: Scene, view: View, per_motion: int) -> dict[str, Any]:
    """Motions in cells over a map, row by row from the lowest friction, each after its number of bytes."""
    shape = _cells(view)
    axes = view.axes(*shape)
    columns, rows = _motion_counts(shape, per_motion)
    # in the middle of a cell of the map: the middle of its range is often the resonance
    across, up = (
        (np.arange(count) + 0.5) * cells // count for count, cells in zip((columns, rows), shape, strict=True)
    )
    units, packets = units_of(scene, view), []
    for beta in axes["beta"][up.astype(int)]:
        for r in axes["r"][across.astype(int)]:
            header, arrays = motion(view, float(r), float(beta), _Unwatched())
            packet = pack({**header, **units, "others": False}, _thinned(arrays))
            packets.append(struct.pack("<I", len(packet)) + packet)
    return {"columns": columns, "rows": rows, "packets": _deflated(b"".join(packets))}


class StoredPage:
    """A page as one file that grows map by map; what has been computed can be written at any time.

    sliders : keys of the sliders that it keeps; None: all
    """

    def __init__(self, scene: Scene, sliders: Sequence[str] | None = None) -> None:
        self._scene = scene
        self._lock = threading.Lock()
        self._systems: list[dict[str, Any]] = []  # few of them: not all sliders change them
        self._maps: dict[tuple[float, ...], dict[str, Any]] = {}  # by the positions of all sliders
        self._example: dict[str, Any] | None = None
        self._view = read_query(scene, "").view
        self._per_motion = _PER_MOTION[not self._view.is_quick]
        self.keep(sliders)

    def keep(self, sliders: Sequence[str] | None) -> None:
        """Keep these sliders only; of the maps so far the initial one stays."""
        self.sliders = chosen_sliders(self._scene, sliders)
        self._points = _points_of(self.sliders)
        self._maps = dict(zip(self._points[:1], list(self._maps.values())[:1], strict=False))

    @property
    def count(self) -> int:
        """Number of maps of the complete page."""
        return len(self._points)

    @property
    def done(self) -> int:
        """Number of maps so far."""
        return len(self._maps)

    @property
    def size(self) -> float:
        """Bytes of its maps so far."""
        with self._lock:
            return sum(_size(one) for one in self._maps.values())

    @property
    def expected_size(self) -> float:
        """Bytes of the complete page, as the maps so far have."""
        return self.size + self._next_size * (self.count - self.done)

    @property
    def _next_size(self) -> float:
        """Bytes of the next map: like the others; after the first one, which has more motions, fewer."""
        with self._lock:
            first, *others = list(self._maps.values())
        if others:
            return sum(map(_size, others)) / len(others)
        motions, fewer = first["motions"], _motion_counts(_cells(self._view), self._per_motion[True])
        share = fewer[0] * fewer[1] / (motions["columns"] * motions["rows"])
        return _size(first) - (1.0 - share) * len(motions["packets"])

    def compute(self, progress: MapProgress, most: float = np.inf, only_first: bool = False) -> None:
        """Compute the maps that are missing, until the file would have more than `most` bytes."""
        for point in self._points[: 1 if only_first else None]:
            if point in self._maps:
                continue
            if self._maps and self.size + self._next_size > most:
                return
            found = self._computed(point, progress)
            with self._lock:
                self._maps[point] = found
            progress(self.done, self.count)

    def _computed(self, point: tuple[float, ...], progress: MapProgress) -> dict[str, Any]:
        """A map with its motions; the first one comes with the example."""
        text = "&".join(f"{slider.key}={value!r}" for slider, value in zip(self.sliders, point, strict=True))
        view = read_query(self._scene, text).view
        found = _map(view, quantities_of(view), _OneOf(progress, self.done, self.count))
        found["motions"] = _motions(self._scene, view, self._per_motion[bool(self._maps)])
        if not self._maps:
            self._example = _example(self._scene, view)
        about = description(self._scene, view)
        with self._lock:
            if about not in self._systems:
                self._systems.append(about)
        return {**found, "about": self._systems.index(about)}

    def _content(self) -> dict[str, Any]:
        """What the page contains: places of sliders have a map with the other sliders as they were."""
        with self._lock:
            maps, systems = dict(self._maps), list(self._systems)
        own = self._points[0]
        alone = [
            sorted({point[k] for point in maps if point[:k] + point[k + 1 :] == own[:k] + own[k + 1 :]})
            for k in range(len(own))
        ]
        named = {
            ",".join(str(values.index(value)) for value, values in zip(point, alone, strict=True)): one
            for point, one in maps.items()
            if all(value in values for value, values in zip(point, alone, strict=True))
        }
        columns, rows = _cells(self._view)
        described = {
            **describe_scene(self._scene, self._view),
            "sliders": [one._asdict() for one in self.sliders],
        }
        return {
            "scene": described,
            "r": self._scene.r, "beta": self._scene.beta, "columns": columns, "rows": rows,
            "values": {slider.key: values for slider, values in zip(self.sliders, alone, strict=True)},
            "first": next(iter(named)), "maps": named, "systems": systems, "example": self._example,
        }  # fmt: skip

    def page(self) -> bytes:
        """The file with the maps so far, one at least."""
        return _page(self._content()).encode()


def _size(found: dict[str, Any]) -> int:
    """Bytes of a map in the file, about."""
    texts = [found["classes"], found["limits"], found["motions"]["packets"]]
    return sum(map(len, (*texts, *(one["steps"] for one in found["values"].values()))))


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

    Places of sliders: all of the first one together with all of the next one; of further ones each by itself,
    with the others where the scene has them.  Its sliders move to places only that have a map.
    """
    page = StoredPage(scene)
    page.compute(progress)
    return page.page()
