"""One view: the changed system, ranges of r and beta, mu."""

from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np

from .. import checks
from ..errors import InputError
from ..model.general import MergedContact
from ..model.settings import Solver
from ..model.system import System
from ..solvers.choose import engine_of
from ..solvers.interface import Engine
from .scene_parts import BELT_SPEED, FREQUENCY, Across

#: Pixels of a picture each way, and together: those of the largest screens.
MOST_PIXELS, MOST_CELLS = 8192, 2**25


@dataclass(frozen=True)
class View:
    """Ranges and system shown on a page."""

    system: System
    r: tuple[float, float]  # without a load the belt speeds
    beta: tuple[float, float]
    mu: float
    solver: Solver
    contact: int | None = None  # of a system with several, counted from 0; None: all together
    unloaded: bool = False  # on a belt, without a load

    @property
    def across(self) -> Across:
        """The axis that goes across."""
        return BELT_SPEED if self.unloaded else FREQUENCY

    @property
    def engine(self) -> Engine:
        """The engine that answers for the system."""
        return engine_of(self.system)

    @property
    def shown(self) -> int | None:
        """The contact that is shown, counted from 0; None: all together."""
        return 0 if self.system.contact_system.count == 1 else self.contact

    @property
    def contacts(self) -> tuple[MergedContact, ...]:
        """The contacts that are shown."""
        groups = self.system.contact_system.groups
        return groups if self.shown is None else (groups[self.shown],)

    @property
    def is_elastic(self) -> bool:
        """Whether a contact that is shown has a spring."""
        return any(one.stiffness is not None for one in self.contacts)

    @property
    def is_quick(self) -> bool:
        """Whether its cells take microseconds: others take up to some hundred times as long."""
        return not self.unloaded and self.engine.kernels == "one"

    def check(self, r: float | None = None) -> None:
        """Refuse a range, or a frequency, at which the error of a reduced structure exceeds its limit."""
        if self.unloaded:  # its structure is not reduced for frequencies
            return
        inside = r is None or self.r[0] <= r <= self.r[1]
        self.system.costs(np.array(self.r if inside else (r, r)))

    def axes(self, columns: int, rows: int) -> dict[str, np.ndarray]:
        """Axes of a map at the centres of the pixels."""
        return {
            "mu": np.array([self.mu]),
            "r": middles(self.r, columns, "columns"),
            "beta": middles(self.beta, rows, "rows"),
        }


def middles(ends: tuple[float, float], count: int, name: str) -> np.ndarray:
    """Centres of equal parts of a range, as `start`, `stop` and `num` of an axis give them."""
    half = 0.5 * (ends[1] - ends[0]) / count
    found = np.linspace(ends[0] + half, ends[1] - half, count)
    if count > 1 and not (np.diff(found) > 0.0).all():
        raise InputError(
            f"cannot place distinct {name} between {ends[0]!r} and {ends[1]!r}: range too narrow; widen it"
        )
    return found


class Piece(NamedTuple):
    """Columns of a map of a view."""

    columns: int
    rows: int
    first: int
    last: int  # the one after the last

    def check(self) -> None:
        """Refuse an invalid piece of a map."""
        checks.whole(self.columns, "columns", least=1, most=MOST_PIXELS)
        checks.whole(self.rows, "rows", least=1, most=MOST_PIXELS)
        checks.whole(self.first, "first", least=0, most=self.columns - 1)
        checks.whole(self.last, "last", least=self.first + 1, most=self.columns)
        cells = (self.last - self.first) * self.rows
        if cells > MOST_CELLS:
            raise InputError(f"columns times rows must be <= {MOST_CELLS}; got {cells}")


class Follower(Protocol):
    """Receiver of a map; `watch` raises if it no longer waits."""

    def watch(self) -> None: ...

    def progress(self, done: float, total: float) -> None: ...
