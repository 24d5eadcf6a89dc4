"""The response that a design is about, at points (r, beta), of any system."""

from collections.abc import Sequence
from typing import Any, Literal, NamedTuple, get_args

import numpy as np

from .. import checks, regimes
from ..datasets.amounts import SHARE_LOST
from ..errors import InputError
from ..model.settings import Solver, Start
from ..model.sizes import SEPARATION, Sizes, Wanted
from ..model.system import System
from ..solvers.choose import engine_of
from ..structures.dofs import Dofs
from .limits import starts_matter, unique_friction
from .watching import current_watch, look

#: What is made small: the largest displacement of a mass, its first harmonic, the largest displacement in a
#: contact, or the largest force on the ground.
ResponseQuantity = Literal["amplitude", "first_harmonic", "contact", "transmitted_force"]
QUANTITIES: tuple[str, ...] = get_args(ResponseQuantity)

#: Periods that motions of contacts that open and of gaps are followed at most: many of them never repeat, and
#: what has not come close to a cycle by then is taken for one of these.
_PERIODS = 500


class Response(NamedTuple):
    """A quantity of the steady state, over P/k1 (Y) or, of a force, over P."""

    quantity: str
    mass: int = 1  # counted from 1
    contact: int = 1

    def describe(self, dofs: Dofs) -> str:
        """Describe the quantity; `dofs`: those of the system, for the name of its mass or point."""
        if self.quantity == "contact":
            return f"displacement in contact {self.contact}"
        if self.quantity == "transmitted_force":
            return "transmitted force"
        if self.quantity == SEPARATION:
            return SHARE_LOST
        what = "amplitude" if self.quantity == "amplitude" else "first harmonic"
        return f"{what} of {dofs.name(self.mass)}"

    def as_config(self) -> dict[str, Any]:
        """Return the table `response` of a configuration."""
        of_mass = {"mass": self.mass} if self.quantity in ("amplitude", "first_harmonic") else {}
        of_contact = {"contact": self.contact} if self.quantity == "contact" else {}
        return {"quantity": self.quantity, **of_mass, **of_contact}


class Values(NamedTuple):
    """Results at points or on a grid, all of one shape."""

    size: np.ndarray  # the response; NaN where no steady state was found
    regime: np.ndarray
    stops: np.ndarray  # per cycle, the most of all contacts
    irregular: np.ndarray  # the largest response seen of an irregular motion; 0 where there is none


def checked_response(system: System, quantity: object, mass: object, contact: object) -> Response:
    """Check what a design is about."""
    quantity = checks.choice(quantity, "quantity", QUANTITIES)
    offered = engine_of(system).sizes
    if quantity not in offered:
        raise InputError(
            "cannot use",
            "quantity",
            f"{quantity!r} with several contacts, springs, belts or loads of several "
            f"harmonics: it is not computed; use one of {', '.join(offered)}",
        )
    number = system.dofs.number(mass, "mass")
    most = system.contact_system.count
    return Response(quantity, number, checks.whole(contact, "contact", least=1, most=most))


class Responses:
    """The response at points, from both starts where the start may matter: mu > 1, or a falling law."""

    def __init__(self, system: System, response: Response, mu: float, threads: int | None) -> None:
        self.system, self.response, self.mu = system, response, mu
        self._engine = engine_of(system)
        self._threads = checks.threads(threads)
        row = [*system.dofs.numbers].index(response.mass)
        self._wanted = Wanted(response.quantity, row, response.contact - 1)
        self._engine.check_static(np.array([mu]))
        starts: Sequence[Start] = ("rest", "moving") if _several_states(system, mu) else ("rest",)
        cycles = _PERIODS if system.contact_system.has_phases else Solver().cycles
        self._solvers = [Solver(start=start, cycles=cycles) for start in starts]
        # with a law, less friction than this needs one start
        self._unique = unique_friction(system, mu) if system.contact_system.has_law else -1.0

    def on_grid(self, r: np.ndarray, beta: np.ndarray) -> Values:
        """Values on a grid, (n_r, n_beta); r > 0 and beta >= 0 increase."""
        found = self._grid_from(self._solvers[0], r, beta)
        more = beta > self._unique
        for solver in self._solvers[1:] if more.any() else ():
            both = [Values(*(one[:, more] for one in found)), self._grid_from(solver, r, beta[more])]
            for one, larger in zip(found, _largest(both), strict=True):
                one[:, more] = larger
        return found

    def _grid_from(self, solver: Solver, r: np.ndarray, beta: np.ndarray) -> Values:
        """Values on a grid from one start."""
        axes = {"mu": np.array([self.mu]), "r": r, "beta": beta}
        look()
        return _values(self._engine.sizes_on_grid(self._wanted, axes, solver, self._threads, current_watch()))

    def at(self, r: np.ndarray, beta: np.ndarray) -> Values:
        """Values at points r > 0 and beta >= 0, (k,)."""
        found = self._at_from(self._solvers[0], r, beta)
        more = beta > self._unique
        for solver in self._solvers[1:] if more.any() else ():
            both = [Values(*(one[more] for one in found)), self._at_from(solver, r[more], beta[more])]
            for one, larger in zip(found, _largest(both), strict=True):
                one[more] = larger
        return found

    def _at_from(self, solver: Solver, r: np.ndarray, beta: np.ndarray) -> Values:
        """Values at points from one start."""
        look()
        return _values(
            self._engine.sizes_at(self._wanted, r, beta, self.mu, solver, self._threads, current_watch())
        )


def _several_states(system: System, mu: float) -> bool:
    """Whether both starts are followed: where they may matter, and a large sliding motion exists."""
    if system.contact_system.has_phases:
        return bool(system.modes.damping.any())
    return starts_matter(system, mu)


def _values(found: Sizes) -> Values:
    """Values of one start."""
    largest = np.where(found.status == regimes.IRREGULAR, found.size, 0.0)
    return Values(found.size, found.regime, found.stops, largest)


def _largest(parts: list[Values]) -> Values:
    """The state with the largest response of several at each point; NaN where one was not found."""
    if len(parts) == 1:
        return parts[0]
    sizes = np.stack([part.size for part in parts])
    missing = np.isnan(sizes)
    which = np.argmax(np.where(missing, np.inf, sizes), axis=0)
    size, regime, stops = (np.choose(which, [part[k] for part in parts]) for k in range(3))
    return Values(size, regime, stops, np.max([part.irregular for part in parts], axis=0))


def joined_values(parts: list[Values]) -> Values:
    """Values of several groups of points in one."""
    return Values(*(np.concatenate(arrays) for arrays in zip(*parts, strict=True)))


def unresolved(values: Values) -> np.ndarray:
    """Where no steady state was found, nor an irregular motion of which the response was seen."""
    return np.isnan(values.size) | (values.regime == regimes.UNRESOLVED)
