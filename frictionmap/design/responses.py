"""The response that a design is about, at points (r, beta), of any system."""

from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any, Literal, NamedTuple, get_args

import numpy as np

from .. import checks, regimes
from ..errors import InputError
from ..general.dataset import cell_values, contact_values
from ..general.maps import solve_cells
from ..model.general import contacts_of
from ..model.settings import Output, Solver, Start
from ..model.system import System
from ..single.maps import compute
from ..single.quantity_data import quantity_request, read_result
from ..single.scattered import scattered_cells
from ..solvers.choose import engine_of
from .limits import starts_matter, stick_limit
from .watching import current_watch, look

#: What is made small: the largest displacement of a mass, its first harmonic, the largest displacement in a
#: contact, or the largest force on the ground.
ResponseQuantity = Literal["amplitude", "first_harmonic", "contact", "transmitted_force"]
QUANTITIES: tuple[str, ...] = get_args(ResponseQuantity)
_GENERAL = ("amplitude", "contact")

#: Variables of cells over a cycle, by quantity.
_OF_CYCLE = {"first_harmonic": "first_harmonic_amplitude", "transmitted_force": "transmitted_force"}
_OUTPUTS: dict[str, Output] = {"amplitude": "amplitude", "contact": "contact_amplitude"}
#: Points computed together, neighbours in beta: cells that formulas decide are filled for every beta between.
_TOGETHER = 128

_ALWAYS: tuple[Output, ...] = ("regime", "stops_per_cycle", "status")


class Response(NamedTuple):
    """A quantity of the steady state, over P/k1 (Y) or, of a force, over P."""

    quantity: str
    mass: int = 1  # counted from 1
    contact: int = 1

    def describe(self) -> str:
        """Describe the quantity."""
        if self.quantity == "contact":
            return f"displacement in contact {self.contact}"
        if self.quantity == "transmitted_force":
            return "transmitted force"
        what = "amplitude" if self.quantity == "amplitude" else "first harmonic"
        return f"{what} of mass {self.mass}"

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
    if system.general is not None and quantity not in _GENERAL:
        raise InputError(
            f"cannot use quantity {quantity!r} with several contacts, springs, belts or loads of several "
            f"harmonics: it is not computed; use one of {', '.join(_GENERAL)}"
        )
    number = checks.whole(mass, "mass", least=1, most=int(system.dofs.numbers[-1]))
    if number not in system.dofs.numbers:
        kept = ", ".join(str(kept) for kept in system.dofs.numbers)
        raise InputError(f"mass must be one of {kept}; got {number}")
    most = system.contact_system.count
    return Response(quantity, number, checks.whole(contact, "contact", least=1, most=most))


class Responses:
    """The response at points, from both starts where the start may matter (mu > 1)."""

    def __init__(self, system: System, response: Response, mu: float, threads: int | None) -> None:
        self.system, self.response, self.mu = system, response, mu
        self._threads = checks.threads(threads)
        self._row = [*system.dofs.numbers].index(response.mass)
        self._request = None
        outputs = [*_ALWAYS]
        if response.quantity in _OUTPUTS:
            outputs.append(_OUTPUTS[response.quantity])
        else:
            self._request = quantity_request((_OF_CYCLE[response.quantity],))
        engine_of(system).check_static(np.array([mu]))
        starts: Sequence[Start] = ("rest", "moving") if starts_matter(system, mu) else ("rest",)
        self._solvers = [Solver(start=start, outputs=outputs) for start in starts]

    def on_grid(self, r: np.ndarray, beta: np.ndarray) -> Values:
        """Values on a grid, (n_r, n_beta); r > 0 and beta >= 0 increase."""
        if self.system.general is not None:
            return self._general_on_grid({"r": r, "beta": beta})
        axes = {"mu": np.array([self.mu]), "r": r, "beta": beta}
        parts = []
        for solver in self._solvers:
            cells, out = compute(
                self.system, axes, solver, self._request, self._threads, None, current_watch()
            )
            rows, columns = np.broadcast_arrays(r[:, np.newaxis], beta)
            parts.append(self._with_seen(self._read(cells, out, (0,)), rows, columns, solver))
        return _largest(parts)

    def at(self, r: np.ndarray, beta: np.ndarray) -> Values:
        """Values at points r > 0 and beta >= 0, (k,)."""
        if self.system.general is not None:
            return self._general_at(r, beta)
        order = np.argsort(beta, kind="stable")
        chunks = [order[first : first + _TOGETHER] for first in range(0, r.size, _TOGETHER)]
        found = joined_values([self._scattered(r[chunk], beta[chunk]) for chunk in chunks])
        back = np.argsort(order, kind="stable")
        return Values(*(array[back] for array in found))

    def _scattered(self, r: np.ndarray, beta: np.ndarray) -> Values:
        look()
        order = np.argsort(r, kind="stable")
        parts = []
        for solver in self._solvers:
            found = scattered_cells(self.system, r[order], beta[order], self.mu, solver, self._request)
            read = self._read(found.cells, found.out, (0, np.arange(r.size), found.column))
            parts.append(self._with_seen(read, r[order], beta[order], solver))
        values = _largest(parts)
        back = np.argsort(order, kind="stable")
        return Values(*(array[back] for array in values))

    def _read(self, cells: Any, out: Any, place: tuple) -> Values:
        quantity = self.response.quantity
        if quantity in _OF_CYCLE:
            name = _OF_CYCLE[quantity]
            size = read_result(name, cells.results)
        else:
            size = getattr(out, _OUTPUTS[quantity])
        if size.ndim == 4:
            size = size[..., self._row]
        return _values(size[place], out.regime[place], out.stops_per_cycle[place], out.status[place])

    @cached_property
    def _twin(self) -> "Responses":
        """Responses by the engine for any number of contacts."""
        system = replace(self.system, contacts=contacts_of(self.system))
        return Responses(system, self.response, self.mu, self._threads)

    def _with_seen(self, values: Values, r: np.ndarray, beta: np.ndarray, solver: Solver) -> Values:
        """Values with the largest amplitude seen of irregular motions, of which masses have none so far."""
        which = np.isnan(values.irregular) & (self.response.quantity == "amplitude")
        if not which.any():
            return values
        axes = {"mu": np.array([self.mu]), "r": r[which], "beta": beta[which][:, np.newaxis]}
        seen = self._twin._general(axes, solver).size[:, 0]
        size, irregular = values.size.copy(), values.irregular.copy()
        size[which] = irregular[which] = seen
        return values._replace(size=size, irregular=irregular)

    def _general(self, axes: dict[str, np.ndarray], solver: Solver) -> Values:
        stick = stick_limit(self.system, axes["r"], self.mu)[np.newaxis]
        found = solve_cells(
            self.system, axes, stick, solver, self._threads, None, current_watch(), masses=True
        )
        if self.response.quantity == "amplitude":
            size = cell_values("amplitude", self.system, found)[0, ..., self._row]
        else:
            size = contact_values("contact_amplitude", self.system, found)[0, ..., self.response.contact - 1]
        stops = np.where(np.isnan(found.stops[0]), 0.0, found.stops[0]).max(axis=-1)
        return _values(size, found.regime[0], stops, found.status[0])

    def _general_at(self, r: np.ndarray, beta: np.ndarray) -> Values:
        """Points as rows of a grid with a beta of their own."""
        points, back = np.unique(np.stack((r, beta)), axis=1, return_inverse=True)
        found = self._general_on_grid({"r": points[0], "beta": points[1, :, np.newaxis]})
        return Values(*(values[back.ravel(), 0] for values in found))

    def _general_on_grid(self, axes: dict[str, np.ndarray]) -> Values:
        """Values on a grid, those of the worst start."""
        axes = axes | {"mu": np.array([self.mu])}
        return _largest([self._general(axes, solver) for solver in self._solvers])


def _values(size: np.ndarray, regime: np.ndarray, stops: np.ndarray, status: np.ndarray) -> Values:
    """Values of one start."""
    return Values(size, regime, stops, np.where(status == regimes.IRREGULAR, size, 0.0))


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
