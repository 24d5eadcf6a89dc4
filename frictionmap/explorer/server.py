"""HTTP server of the page, for this machine only.

It listens on 127.0.0.1 and answers requests to that name only: a page of another host that has its name point
here, and requests from pages of other hosts, are refused (403).  Queries are checked (400, one line), and
no request changes anything but two: a page of motions in time takes files of records, which it reads in a
temporary folder and keeps in memory, and pulses.
"""

import contextlib
import errno
import json
import os
import select
import socket
import sys
import threading
from collections.abc import Callable
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from importlib import import_module
from importlib.resources import files
from typing import TYPE_CHECKING, Any, NamedTuple
from urllib.parse import unquote, urlsplit

from ..checks import one_line
from ..errors import InputError
from .compile_times import group_of
from .jobs import REHEARSAL, Jobs, Outdated
from .packets import pack
from .scene import Scene

if TYPE_CHECKING:
    from ..motions.configuration import Motions
    from .queries import Query
    from .views import View

#: Default port, if it is free, so that links to views remain valid.
PORT = 8712

_HOST = "127.0.0.1"
_NAMES = (_HOST, "localhost", "[::1]")

#: Where links from elsewhere may lead.
_DOORS = ("/", "/index.html")

#: Kinds of answers about a view: the module, which has the `KEYS` of the query and `read`s its values,
#: and the function, which gives a packet, or a mapping for JSON.
_VIEWS = {
    "motion": ("cell", "motion"),
    "others": ("cell", "others"),
    "cut": ("cut", "cut"),
    "goal": ("goal", "answer_goal"),
}

#: Seconds after which the last part of the rehearsal begins without a map.
_LATER = 30.0

#: Seconds that a connection may be silent.
_SILENCE = 120.0

#: Bytes of a file of a record at most.
_LARGEST_FILE = 32 * 2**20

_KINDS = {".html": "text/html", ".css": "text/css", ".js": "text/javascript"}
_TEXT, _JSON, _BYTES = "text/plain", "application/json", "application/octet-stream"

#: Everything is ours; notebooks may show the page in a frame.
_POLICY = (
    "default-src 'self'; img-src 'self' data: blob:; base-uri 'none'; form-action 'none'; "
    "frame-ancestors 'self' http://localhost:* http://127.0.0.1:* vscode-webview:"
)
_HEADERS = {
    "Content-Security-Policy": _POLICY,
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Cache-Control": "no-store",
}


class Answer(NamedTuple):
    """An HTTP response."""

    status: int
    kind: str
    body: bytes
    file: str = ""  # the name to save it under


def page_files() -> dict[str, bytes]:
    """Contents of the files of the page by name."""
    folder = files(__package__) / "page"
    return {
        entry.name: entry.read_bytes()
        for entry in folder.iterdir()
        if "." + entry.name.rpartition(".")[2] in _KINDS
    }


def _group(work: str, view: "View") -> str:
    return group_of(work, view.system, unloaded=view.unloaded)


def _text(status: int, message: object) -> Answer:
    return Answer(status, _TEXT, (" ".join(str(message).split()) + "\n").encode())


class Page:
    """Answers to the addresses of the page, independent of connections."""

    def __init__(self, scene: Scene, parent: "Page | None" = None) -> None:
        self.scene = scene
        self.jobs: Jobs = parent.jobs if parent else Jobs()
        self._files = page_files()
        self._warm: threading.Event = parent._warm if parent else threading.Event()
        self.shown = threading.Event()
        self._presets: dict[str, Page] = {}
        self._lock = threading.Lock()
        self._work: dict[str, Callable[[str, Callable[[], bool]], Answer]] = {
            "/scene": self._scene,
            "/state": self._state,
            "/ratios": self._ratios,
            "/structure.svg": self._structure,
            "/lines": self._lines,
            "/example": self._example,
            "/map": self._map,
            **{f"/{kind}": self._view_answer(kind) for kind in _VIEWS},
            "/configuration.toml": self._configuration,
            "/sizes": self._sizes,
            "/map.nc": self._download_answer(".nc"),
            "/map.csv": self._download_answer(".csv"),
        }

    def warm(self) -> None:
        """Import the computing modules, which takes longer than the browser needs to load the page."""
        try:
            self._import()
            self.jobs.listen()
        finally:
            self._warm.set()

    def _import(self) -> None:
        from . import cell, cut, example, pieces, queries, scene_description  # noqa: F401

    def rehearse(self, later: bool = False) -> None:
        """Compute small results of every kind, so that their kernels are compiled before the page needs them.

        later : rehearse what a page needs last: response curves and further quantities
        """
        from . import queries
        from .rehearsal import FIRST, LATER

        self._warm.wait()
        for work, stage in (LATER if later else FIRST).items():
            with contextlib.suppress(InputError):
                view = queries.read_query(self.scene, "").view
                try:
                    with self.jobs.enter(REHEARSAL, group=_group(work, view)) as job:
                        job.watch()
                        stage(view, job)
                except Outdated:
                    return

    def answer(self, target: str, gone: Callable[[], bool]) -> Answer:
        """Answer a request; `gone` returns whether the client has disconnected."""
        try:
            parts = urlsplit(target)
        except ValueError as error:
            return _text(400, f"the address must be one of this page; got {one_line(target)} ({error})")
        name = parts.path.removeprefix("/") or "index.html"
        if name in self._files:
            return Answer(200, _KINDS["." + name.rpartition(".")[2]], self._files[name])
        if parts.path not in self._work:
            return _text(404, f"unknown address {parts.path[:80]!r}")
        self._warm.wait()
        try:
            page, query = self._page_of(parts.query)
            return page._work[parts.path](query, gone)
        except InputError as error:
            return _text(400, error)
        except Outdated:
            return Answer(204, _TEXT, b"")
        except MemoryError:
            return _text(500, "cannot compute this view: too little memory; use a coarser map")

    def _page_of(self, query: str) -> tuple["Page", str]:
        """The page that a query is for, that of a preset if it begins with one, and the rest of the query."""
        from .presets import preset_scene

        first, _, rest = query.partition("&")
        name, _, value = first.partition("=")
        if name != "preset":
            return self, query
        key = unquote(value)
        scene = preset_scene(key)
        with self._lock:
            if key not in self._presets:
                self._presets[key] = Page(scene, self)
                begin(self._presets[key])
        return self._presets[key], rest

    def _scene(self, query: str, gone: Callable[[], bool]) -> Answer:
        from .queries import read_query
        from .scene_description import describe_scene

        return _json(describe_scene(self.scene, read_query(self.scene, query).view))

    def _structure(self, query: str, gone: Callable[[], bool]) -> Answer:
        from .structure_picture import has_picture, structure_svg

        if not has_picture(self.scene.system):
            return _text(404, "there is no picture of this system: it is for beams and plates")
        return Answer(200, "image/svg+xml", structure_svg(self.scene.system))

    def _state(self, query: str, gone: Callable[[], bool]) -> Answer:
        return _json({"compiling": self.jobs.state()})

    def _ratios(self, text: str, gone: Callable[[], bool]) -> Answer:
        from . import queries, typed

        return _json(typed.typed(queries.read_query(self.scene, text, typed.KEYS)))

    def _enter(self, kind: str, query: "Query", gone: Callable[[], bool], kernels: str = "") -> Any:
        """Start a job in the lane of the page for a kind of work, or in a lane of its own without a page.

        kernels : kind of work whose kernels it needs, if that has another name
        """
        from .queries import page_of

        page, turn = page_of(query)
        group = _group(kernels or kind, query.view)
        return self.jobs.enter(f"{kind} {page}" if page else f"{kind} {id(query)}", gone, turn, group)

    def _lines(self, text: str, gone: Callable[[], bool]) -> Answer:
        from . import queries
        from .pieces import packet_of_lines
        from .scene_description import description

        query = queries.read_query(self.scene, text, queries.LINES)
        count = queries.points_of(query)
        known = "known" in query.given
        query.view.check()
        with self._enter("lines", query, gone) as job:
            job.watch()
            arrays = packet_of_lines(query.view, count, known=known)
        return _packet(({"about": description(self.scene, query.view)}, arrays))

    def _example(self, text: str, gone: Callable[[], bool]) -> Answer:
        from . import queries
        from .example import example_cell

        query = queries.read_query(self.scene, text, queries.PAGE)
        with self._enter("example", query, gone, "map") as job:
            return _json({"cell": example_cell(query.view, job)})

    def _map(self, text: str, gone: Callable[[], bool]) -> Answer:
        from . import queries
        from .pieces import piece_of_map
        from .scene_description import description

        query = queries.read_query(self.scene, text, queries.PIECE)
        quantity, piece = queries.piece_of(query)
        with self._enter("map", query, gone, "quantity" if quantity.output else "map") as job:
            job.watch()
            header, arrays = piece_of_map(query.view, quantity, piece, job, queries.lines_of(query))
            header |= {"compiled": job.kernels > 0, "about": description(self.scene, query.view)}
        if piece.last == piece.columns:
            self.shown.set()
        return _packet((header, arrays))

    def _view_answer(self, kind: str) -> Callable[[str, Callable[[], bool]], Answer]:
        """The answer of one function to a checked query, with the units of its results."""

        def answer(text: str, gone: Callable[[], bool]) -> Answer:
            from . import queries
            from .scene_description import units_of

            place, function = _VIEWS[kind]
            module = import_module(f".{place}", __package__)
            query = queries.read_query(self.scene, text, module.KEYS)
            asked = module.read(query)
            with self._enter(kind, query, gone) as job:
                job.watch()
                found = getattr(module, function)(query.view, *asked, job)
            header, arrays = found if isinstance(found, tuple) else (found, None)
            header = {**header, **units_of(self.scene, query.view)}
            return _json(header) if arrays is None else _packet((header, arrays))

        return answer

    def _configuration(self, text: str, gone: Callable[[], bool]) -> Answer:
        from . import queries
        from .downloads import configuration_text

        query = queries.read_query(self.scene, text, queries.PIECE)
        found = configuration_text(self.scene, query.view, *queries.piece_of(query))
        return Answer(200, "application/toml", found.encode(), "view.toml")

    def _sizes(self, text: str, gone: Callable[[], bool]) -> Answer:
        from ..steady.cost import in_bytes
        from . import queries
        from .downloads import sizes

        query = queries.read_query(self.scene, text, queries.PIECE)
        found = sizes(self.scene, query.view, *queries.piece_of(query))
        return _json({ending: in_bytes(size) for ending, size in found.items()})

    def _download_answer(self, ending: str) -> Callable[[str, Callable[[], bool]], Answer]:
        def save(text: str, gone: Callable[[], bool]) -> Answer:
            from . import queries
            from .downloads import saved_map

            query = queries.read_query(self.scene, text, queries.PIECE)
            quantity, piece = queries.piece_of(query)
            with self._enter(f"save{ending}", query, gone, "quantity") as job:
                body = saved_map(self.scene, query.view, quantity, piece, ending, job)
            return Answer(200, "text/csv" if ending == ".csv" else _BYTES, body, f"map{ending}")

        return save


class MotionPage(Page):
    """Answers to the addresses of the page of motions in time under records."""

    def __init__(self, motions: "Motions") -> None:
        self.motions = motions
        self.jobs = Jobs()
        self._files = page_files()
        self._files["index.html"] = self._files["in_time.html"]
        self._warm, self.shown = threading.Event(), threading.Event()
        self._lock = threading.Lock()
        self._work = {
            "/scene": self._scene,
            "/state": self._state,
            "/ratios": self._ratios,
            "/motion": self._motion,
        }

    def _import(self) -> None:
        from . import in_time  # noqa: F401

    def rehearse(self, later: bool = False) -> None:
        """Compute the first motion, so that kernels are compiled before the page needs them."""
        if not later:
            with contextlib.suppress(InputError, Outdated):
                self._motion("", lambda: False)

    def _page_of(self, query: str) -> tuple["Page", str]:
        return self, query

    def _scene(self, query: str, gone: Callable[[], bool]) -> Answer:
        from .in_time import describe

        return _json(describe(self.motions))

    def _ratios(self, text: str, gone: Callable[[], bool]) -> Answer:
        from .in_time import read

        return _json(read(self.motions, text)._asdict())

    def _motion(self, text: str, gone: Callable[[], bool]) -> Answer:
        from .in_time import motion, read

        asked = read(self.motions, text)
        with self.jobs.enter(f"motion {id(asked)}", gone) as job:
            found = motion(self.motions, asked, job)
        self.shown.set()
        return _packet(found)

    #: Addresses that take a record: as a file, or as the numbers of a pulse.
    taken = ("/record", "/pulse")

    def receive(self, path: str, query: str, body: bytes) -> Answer:
        """Add the record in a file, or a pulse."""
        from .in_time import describe, named_file, with_file, with_pulse

        self._warm.wait()
        try:
            with self._lock:
                if path == "/pulse":
                    self.motions = with_pulse(self.motions, query)
                else:
                    self.motions = with_file(self.motions, named_file(query), body)
                number = len(self.motions.records)
            return _json({"record": number, "records": describe(self.motions)["records"]})
        except InputError as error:
            return _text(400, error)


def _json(content: object) -> Answer:
    return Answer(200, _JSON, json.dumps(content, ensure_ascii=False, allow_nan=False).encode())


def _packet(found: tuple[dict, dict]) -> Answer:
    return Answer(200, _BYTES, pack(*found))


class _Handler(BaseHTTPRequestHandler):
    """Handler of one connection."""

    protocol_version = "HTTP/1.1"
    server_version, sys_version = "frictionmap", ""
    disable_nagle_algorithm = True
    timeout = _SILENCE
    server: "Server"

    def do_GET(self) -> None:
        self._reply(self._refusal() or self._answer())

    def do_HEAD(self) -> None:
        self.do_GET()

    def do_POST(self) -> None:
        page, target = self.server.page, urlsplit(self.path)
        if not isinstance(page, MotionPage) or target.path not in page.taken:
            self.send_error(HTTPStatus.NOT_IMPLEMENTED, "Unsupported method ('POST')")
            return
        refusal = self._refusal() or self._too_large()
        if refusal:
            self.close_connection = True  # what follows is not read
            self._reply(refusal)
            return
        body = self.rfile.read(int(self.headers["Content-Length"]))
        try:
            answer = page.receive(target.path, target.query, body)
        except Exception as error:  # the page shows any error in one line
            answer = _text(500, f"frictionmap failed: {type(error).__name__}: {error}")
        self._reply(answer)

    def _too_large(self) -> Answer | None:
        length = self.headers.get_all("Content-Length") or []
        if len(length) != 1 or not (length[0].isascii() and length[0].isdigit()):
            return _text(411, "the length of the file must be given")
        if int(length[0][:12]) > _LARGEST_FILE:
            return _text(413, f"a file of a record must have at most {_LARGEST_FILE >> 20} MB; got more")
        return None

    def _refusal(self) -> Answer | None:
        """Refusal of requests that do not come from the page itself."""
        port = self.server.server_address[1]
        own = {f"{name}:{port}" for name in _NAMES} | ({*_NAMES} if port == 80 else set())
        host, origins = (self.headers.get_all(name) or [] for name in ("Host", "Origin"))
        if len(host) != 1 or host[0].lower() not in own:
            return _text(403, f"this page is served to this machine only, at http://{_HOST}:{port}")
        if not {origin.lower() for origin in origins} <= {f"http://{name}" for name in own}:
            return _text(403, "requests from other hosts are refused")
        # a link in a letter may lead to the page, but to no work
        linked = self.headers.get("Sec-Fetch-Mode") == "navigate" and self.path.partition("?")[0] in _DOORS
        if not linked and self.headers.get("Sec-Fetch-Site", "none") not in ("same-origin", "none"):
            return _text(403, "requests from other hosts are refused")
        return None

    def _answer(self) -> Answer:
        try:
            return self.server.page.answer(self.path, self._gone)
        except Exception as error:  # the page shows any error in one line
            return _text(500, f"frictionmap failed: {type(error).__name__}: {error}")

    def _gone(self) -> bool:
        """Whether the client has closed the connection."""
        try:
            readable, _, _ = select.select([self.connection], [], [], 0.0)
            return bool(readable) and not self.connection.recv(1, socket.MSG_PEEK)
        except (OSError, ValueError):
            return True

    def _reply(self, answer: Answer) -> None:
        self.send_response(answer.status)
        kind = answer.kind if answer.kind == _BYTES else f"{answer.kind}; charset=utf-8"
        headers = {"Content-Type": kind, "Content-Length": str(len(answer.body)), **_HEADERS}
        if answer.file:
            headers["Content-Disposition"] = f'attachment; filename="{answer.file}"'
        for name, value in headers.items():
            self.send_header(name, value)
        with contextlib.suppress(OSError):  # it has gone in the meantime
            self.end_headers()
            if self.command != "HEAD":
                self.wfile.write(answer.body)

    def send_error(self, code: int, message: str | None = None, explain: str | None = None) -> None:
        """Send one line for requests that the library refuses: other methods, lines too long."""
        self.close_connection = True
        refusal = self._refusal() if code == HTTPStatus.NOT_IMPLEMENTED else None
        self._reply(refusal or _text(code, message or HTTPStatus(code).phrase))

    def log_message(self, format: str, *args: object) -> None:
        """Log nothing to the terminal."""


class Server(ThreadingHTTPServer):
    """Server of the page of a scene on this machine."""

    daemon_threads = True
    allow_reuse_address = sys.platform != "win32"  # there it would let two programs have one port
    request_queue_size = 64

    def __init__(self, scene: "Scene | Motions", port: int) -> None:
        super().__init__((_HOST, port), _Handler)
        self.page = Page(scene) if isinstance(scene, Scene) else MotionPage(scene)
        threading.Thread(target=self.page.warm, daemon=True).start()

    @property
    def url(self) -> str:
        """The address of the page."""
        return f"http://{_HOST}:{self.server_address[1]}/"

    def handle_error(self, request: object, client_address: object) -> None:
        """Ignore broken connections."""

    def close(self) -> None:
        """Stop listening, and cancel running jobs."""
        self.page.jobs.close()
        self.server_close()


def open_server(scene: "Scene | Motions", port: int | None = None) -> Server:
    """Open a server; without a port on the default one, or any free one.

    Raises
    ------
    InputError
        The port is taken, or may not be had.
    """
    tried = (PORT, 0) if port is None else (port,)
    for number in tried:
        try:
            return Server(scene, number)
        except (OSError, OverflowError) as error:
            reason = getattr(error, "strerror", None) or str(error)
            free = getattr(error, "errno", None) in (errno.EADDRINUSE, errno.EACCES)
            if number == tried[-1] or not free:
                raise InputError(f"--port must be a free port; got {number} ({reason})") from None
    raise AssertionError("there is always a last one")


def begin(page: Page) -> None:
    """Compute the first answers in the background; what a page needs last, once it shows a map."""

    def work() -> None:
        page.rehearse()
        page.shown.wait(_LATER)
        page.rehearse(later=True)

    threading.Thread(target=work, daemon=True).start()


def show(url: str) -> None:
    """Open the page in the user's browser, where there is a screen for one."""
    import webbrowser

    if sys.platform not in ("win32", "darwin") and not {"DISPLAY", "WAYLAND_DISPLAY"} & set(os.environ):
        return
    threading.Thread(target=webbrowser.open, args=(url,), daemon=True).start()
