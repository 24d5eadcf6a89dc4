"""Interface of every solver that is compared."""

from collections.abc import Sequence
from importlib import import_module
from importlib.metadata import version as installed_version

from .body import Body, Cell, Outcome

#: Phases in one run: far above any honest one, so that nothing hangs.
MAX_PHASES = 1_000_000


class Peer:
    """A solver, made for one body.

    Set-up (imports, compilation) is done in `__init__`, so that a caller can time it separately from `run`. A
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
        """March `cycles` excitation periods from rest; stops per period and max |z| of the last `periods`.

        `begins`, a list, is filled with the tau at which the stops of these periods began. Raises
        RuntimeError if the solver fails.
        """
        raise NotImplementedError

    def run_all(self, cells: Sequence[Cell], cycles: int) -> list[Outcome]:
        """Run all cells, one by one unless a solver has a faster way."""
        return [self.run(cell, cycles) for cell in cells]

    @classmethod
    def why_missing(cls) -> str:
        """Return why this solver cannot run here, or "" if it can."""
        try:
            import_module(cls.package)
        except ImportError as error:
            return f"{cls.package} cannot be imported ({error})"
        return ""

    @classmethod
    def version(cls) -> str:
        """Version of the package behind this peer."""
        return installed_version(cls.distribution or cls.package)
