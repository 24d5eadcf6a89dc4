"""What is asked of every peer, whatever it solves."""

from collections.abc import Sequence
from importlib import import_module
from importlib.metadata import version as installed_version

from .body import Body, Cell, Outcome

#: Phases in one run: far above any honest one, so that nothing hangs.
MAX_PHASES = 1_000_000


class Peer:
    """A solver under test, made for one body.

    Set-up (imports, compilation) is done in `__init__`, so that a caller can time it apart from `run`.  A
    subclass names itself and its package.
    """

    name = ""
    package = ""
    distribution = ""  # where that has another name than the package

    def __init__(self, body: Body) -> None:
        self.body = body

    def run(
        self, cell: Cell, cycles: int, periods: int = 1, begins: list[float] | None = None
    ) -> Outcome:  # fmt: skip
        """March `cycles` excitation periods from rest; stops a period and max |z| of the last `periods`.

        `begins`, a list, is filled with the tau at which the stops among these began.  Raises RuntimeError
        where the solver gives up.
        """
        raise NotImplementedError

    def run_all(self, cells: Sequence[Cell], cycles: int) -> list[Outcome]:
        """All cells, one by one but where a peer knows better."""
        return [self.run(cell, cycles) for cell in cells]

    @classmethod
    def why_missing(cls) -> str:
        """Return why this peer cannot run here, or "" if it can."""
        try:
            import_module(cls.package)
        except ImportError as error:
            return f"{cls.package} cannot be imported ({error})"
        return ""

    @classmethod
    def version(cls) -> str:
        """Version of the package behind this peer."""
        return installed_version(cls.distribution or cls.package)
