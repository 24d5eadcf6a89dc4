"""The page in a notebook or in a Python script."""

import html
import threading
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, SupportsFloat

from numpy.typing import ArrayLike

from ..errors import InputError
from ..model.settings import Start
from ..model.system import System
from ..units.scales import Units
from .scene import scene_of_system
from .server import Server, begin, open_server

if TYPE_CHECKING:
    from ..motions.configuration import Motions
    from ..motions.record import Record

#: Ranges that a page of maps begins with.
_R, _BETA = (0.0, 2.5), (0.0, 2.0)

#: Height of the page in a notebook [pixels].
_HEIGHT = 860


class Explorer:
    """A page served until it is closed or Python ends; a notebook displays it."""

    def __init__(self, server: Server) -> None:
        self._server = server
        self._thread = threading.Thread(target=server.serve_forever, daemon=True)
        self._thread.start()
        begin(server.page)

    @property
    def url(self) -> str:
        """The address of the page on this machine."""
        return self._server.url

    def close(self) -> None:
        """Stop serving the page; calling it again has no effect."""
        if self._thread.is_alive():
            self._server.shutdown()
            self._thread.join()
            self._server.close()

    def __enter__(self) -> "Explorer":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __repr__(self) -> str:
        return (
            f"<frictionmap page at {self.url}>" if self._thread.is_alive() else "<frictionmap page, closed>"
        )

    def _repr_html_(self) -> str:
        """HTML representation in a notebook."""
        if not self._thread.is_alive():
            return html.escape(repr(self))
        size = f'width="100%" height="{_HEIGHT}" style="border:0"'
        return f'<iframe src="{self.url}" {size} allow="clipboard-write"></iframe>'  # links are copied


def explore(
    system: System,
    r: ArrayLike = _R,
    beta: ArrayLike = _BETA,
    mu: SupportsFloat = 1.0,
    *,
    start: Start = "rest",
    units: Units | None = None,
    title: str | None = None,
    port: int | None = None,
    record: "Record | Sequence[Record] | None" = None,
    wall_speed: ArrayLike | None = None,
) -> Explorer:
    """Show an interactive map of a system, or its motions in time under records, in a browser or notebook.

    The page is served from this process and ends with it: a script that shows one ends with a line such as
    ``input(page.url)``, or the page is gone before it is seen.

    Parameters
    ----------
    system : System
    r, beta : array_like
        Ranges of the frequency ratio (>= 0) and of the friction ratio (>= 0) [-] that the page begins with:
        the first and the last value of what is given, increasing.
    mu : float
        Static over kinetic friction [-], >= 1, that it begins with.
    start : {"rest", "moving"}
        Initial state, see `Solver`.
    units : Units, optional
        Reference values in Hz and N: the page then has second axes in these units, and r and beta may
        have units as of `sweep`, such as ``("1 Hz", "10 Hz")``.
    title : str, optional
        Title of the page; default: "Regimes of motion" or "Motions in time".
    port : int, optional
        Local port of the page; default 8712, or any free port.
    record : Record or sequence of Record, optional
        The page then shows motions in time under these records.  `beta` is the friction that it begins with,
        as of `history`, default 1; r is not used.
    wall_speed : array_like, optional
        In the place of r, for a system on a belt without a load: the range of belt speeds over omega_1 P/k1
        [-] that the page begins with; with units also texts such as ``("0.1 m/s", "0.5 m/s")``.

    Returns
    -------
    Explorer
        In a notebook it shows the page; `url` is its address, `close()` ends it.

    Raises
    ------
    InputError
        An argument is of the wrong kind or out of range, or the port is taken.

    Examples
    --------
    >>> import frictionmap as fm
    >>> page = fm.explore(fm.System(), r=(0.0, 2.5), beta=(0.0, 1.2), mu=1.5)
    >>> page.url.startswith("http://127.0.0.1:")
    True
    >>> page.close()
    """
    if record is not None:
        motions = _motions(system, record, beta, mu, units, title or "Motions in time")
        for name, given, own in (("r", r, _R), ("start", start, "rest")):
            if given is not own and given != own:
                raise InputError("cannot use", name, "with record: it is of maps; omit it")
        if wall_speed is not None:
            raise InputError("cannot use", "wall_speed", "with record: it is of maps; omit it")
        return Explorer(open_server(motions, _port(port)))
    if wall_speed is not None:
        if r is not _R:
            raise InputError("cannot use", "r", "with wall_speed: there is no load; omit one of them")
        r = wall_speed
    arguments = (system, r, beta, mu, start, title or "Regimes of motion", units)
    scene = scene_of_system(*arguments, unloaded=wall_speed is not None)
    return Explorer(open_server(scene, _port(port)))


def _motions(system: System, record: Any, beta: Any, mu: Any, units: Units | None, title: str) -> "Motions":
    """What a page of motions in time shows, checked."""
    from .. import checks
    from ..motions.configuration import Motions
    from ..motions.record import checked_records
    from .in_time import check

    checks.instance(system, "system", System)
    given = {"beta": 1.0 if beta is _BETA else beta, "mu": checks.number(mu, "mu", least=1.0)}
    motions = Motions(title, "", "", (), system, units, checked_records(record, "record"), given, "beta")
    check(motions)
    return motions


def _port(port: object) -> int | None:
    from .. import checks

    return None if port is None else checks.whole(port, "port", least=0, most=65535)
