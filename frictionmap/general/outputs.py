"""Outputs of maps and responses of general systems: what each is computed from, and for which contacts.

Names, types, units and meanings are those of `datasets.labels`.  A map and a response take the same values
from the `Cells` that kernels fill.
"""

from collections.abc import Callable, Iterable
from typing import NamedTuple

import numpy as np

from .. import regimes
from .._kernels.general.fill import ALL_PLACES, NO_PLACES, NUMBERS, SOME_PLACES, Cells
from .._kernels.general.laws.kinds import ELASTIC, RIGID
from ..datasets.labels import LABELS, PER_CONTACT
from ..model.general import ContactSystem
from ..model.rigid_modes import is_carried
from ..model.system import System
from .problem import general_of

#: Displacement over a period, over the range of the motion, that is no drift but the error of a steady state.
DRIFTS = 1e-9

#: Laws by number, and all of them.
_ALL = (RIGID, ELASTIC)


class Solved(NamedTuple):
    """Cells of a system, split into contacts and masses."""

    cells: Cells
    laws: np.ndarray  # (N,)
    rests: np.ndarray  # (..., N) bool: whether a contact sticks permanently
    contacts: tuple[np.ndarray, np.ndarray]  # (..., N) lowest and highest displacements
    masses: tuple[np.ndarray, np.ndarray]  # (..., n)
    drifts: tuple[np.ndarray, np.ndarray]  # (..., n) of storeys; of no columns unless they are recorded
    accelerations: tuple[np.ndarray, np.ndarray]  # (..., n)
    base: tuple[np.ndarray, np.ndarray]  # (..., 1) force on the base


class Output(NamedTuple):
    """One output."""

    values: Callable[[Solved], np.ndarray]  # (..., N) of contacts, (..., n) of masses, else (...)
    laws: tuple[int, ...] = _ALL  # contacts that have it; it is NaN for others
    moving: bool = False  # whether only contacts that move have it
    placed: tuple[int, ...] = ()  # laws with which it depends on the places of contacts at rest
    wanted: Callable[[ContactSystem], bool] = lambda _: True  # systems that have it
    free: bool = False  # whether only contacts that rigid-body modes move have it


def _cell(name: str) -> Callable[[Solved], np.ndarray]:
    """Values of a cell as kernels store them."""
    return lambda solved: getattr(solved.cells, name)


def number(name: str, cells: Cells) -> np.ndarray:
    """Numbers of contacts as kernels store them, (..., N); see `NUMBERS`."""
    return cells.numbers[NUMBERS.index(name)]


def _number(name: str) -> Callable[[Solved], np.ndarray]:
    return lambda solved: number(name, solved.cells)


def _zero_at_rest(values: Callable[[Solved], np.ndarray]) -> Callable[[Solved], np.ndarray]:
    """Values that are 0 by definition of a rigid contact at rest."""
    return lambda solved: np.where(solved.rests & (solved.laws == RIGID), 0.0, values(solved))


def _modulus(ends: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
    low, high = ends
    return np.maximum(np.abs(low), np.abs(high))


def _range(ends: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
    low, high = ends
    return high - low


def _middle(ends: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
    low, high = ends
    return 0.5 * (low + high)


def _finite_middle(ends: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
    return np.where(np.isfinite(_range(ends)), _middle(ends), np.nan)


def _several(general: ContactSystem) -> bool:
    return general.count > 1


def _laws(general: ContactSystem) -> bool:
    return general.has_law


def _shares_of_segments(solved: Solved) -> np.ndarray:
    """Shares of the period in the segments of the friction laws, (..., N, S); NaN where a law has fewer."""
    return np.moveaxis(solved.cells.numbers[len(NUMBERS) :], 0, -1)


def _belts(general: ContactSystem) -> bool:
    return any(group.first.belt for group in general.groups)


def _bits(solved: Solved) -> np.ndarray:
    """Bits of the regimes of one start; those of others are added to them."""
    regime = solved.cells.regime
    return np.where(regime >= 0, 1 << np.maximum(regime, 0), 0)


TABLE = {
    "regime": Output(_cell("regime")),
    "stops_per_cycle": Output(_number("stops"), (RIGID,), moving=True),
    "contact_amplitude": Output(_zero_at_rest(lambda s: _modulus(s.contacts)), placed=(ELASTIC,)),
    "stuck_fraction": Output(_number("stuck"), (RIGID,)),
    "period": Output(_cell("period")),
    "origin": Output(_cell("origin")),
    "cycles": Output(_cell("cycles")),
    "status": Output(_cell("status")),
    "stops_per_cycle_error": Output(_number("stops_error"), (RIGID,), moving=True),
    "stuck_fraction_error": Output(_number("stuck_error"), (RIGID,)),
    "multiplier": Output(_cell("multiplier")),
    "also_reachable": Output(_bits),
    "amplitude": Output(lambda s: _modulus(s.masses), placed=_ALL),
    "sliding_distance": Output(_number("distance")),
    # rounding may be negative in a contact that hardly slides
    "work_friction": Output(lambda s: np.maximum(number("work_friction", s.cells), 0.0)),
    "contact_regime": Output(_cell("contact_regime"), wanted=_several),
    "turns_per_cycle": Output(_number("turns"), (RIGID,), moving=True),
    "slips_per_cycle": Output(_number("slips"), (ELASTIC,)),
    "slip_reversals_per_cycle": Output(_number("reversals"), (ELASTIC,)),
    "elastic_fraction": Output(_number("stuck"), (ELASTIC,)),
    "least_slip": Output(_number("least_slip"), (ELASTIC,)),
    "contact_peak_to_peak": Output(_zero_at_rest(lambda s: _range(s.contacts))),
    "contact_midpoint": Output(lambda s: _finite_middle(s.contacts), placed=_ALL),
    "peak_to_peak": Output(lambda s: _range(s.masses)),
    "midpoint": Output(lambda s: _middle(s.masses), placed=_ALL),
    "work_wall": Output(_number("work_wall"), wanted=_belts),
    "drift": Output(lambda s: 0.5 * _range(s.drifts)),
    "acceleration_amplitude": Output(lambda s: _modulus(s.accelerations)),
    "base_force": Output(lambda s: _modulus(s.base)[..., 0]),
    "mean_velocity": Output(
        lambda s: ways(s.cells) / (2.0 * np.pi),
        wanted=lambda general: general.free,
        free=True,
    ),
    "release_order": Output(_cell("release_order"), wanted=_several),
    "segment_crossings": Output(_number("crossings"), (RIGID,), moving=True, wanted=_laws),
    "segment_fraction": Output(_shares_of_segments, wanted=_laws),
    "unique": Output(_cell("unique"), wanted=_laws),
}

#: The output of several starts: a response is of one.
OF_STARTS = "also_reachable"

#: Outputs of elastic contacts that take the place of those of rigid ones.
COUNTERPARTS = {"stops_per_cycle": "slips_per_cycle", "stuck_fraction": "elastic_fraction"}


def laws_of(general: ContactSystem) -> np.ndarray:
    """The law of each contact, (N,)."""
    return np.where(general.elastic, ELASTIC, RIGID)


def is_wanted(name: str, general: ContactSystem) -> bool:
    """Whether a variable says something about a system."""
    if name not in TABLE:
        return True
    output = TABLE[name]
    return output.wanted(general) and bool(np.isin(laws_of(general), output.laws).any())


def is_of_masses(name: str) -> bool:
    """Whether an output has a value for every mass."""
    return "dof" in LABELS[name].dims


def depends_on_places(name: str, general: ContactSystem) -> bool:
    """Whether an output depends on the places of contacts at rest."""
    return bool(np.isin(laws_of(general), TABLE[name].placed).any())


def wanted_places(names: Iterable[str], general: ContactSystem) -> int:
    """In which cells outputs depend on the places of contacts at rest, see `fill.NO_PLACES`.

    Where all contacts rest, the largest displacement in a rigid one is 0.  Where others move, they move about
    the place that the contacts at rest leave to them.
    """
    some = [name for name in names if TABLE[name].placed]
    if any(depends_on_places(name, general) for name in some):
        return ALL_PLACES
    return SOME_PLACES if some else NO_PLACES


def output_values(name: str, system: System, cells: Cells) -> np.ndarray:
    """Values of an output for every cell, (n_mu, n_r, n_beta), and contact, (..., N), or mass, (..., n)."""
    general, output = general_of(system), TABLE[name]
    laws, count = laws_of(general), general.count
    rests = cells.contact_regime == regimes.PERMANENT_STICKING
    low, high = cells.lowest, cells.highest
    if system.rigid_modes:
        low, high = about_middle(system, cells)
    ends = np.cumsum((count, system.n, system.n, system.n))
    parts = zip(np.split(low, ends, axis=-1), np.split(high, ends, axis=-1), strict=True)
    values = output.values(Solved(cells, laws, rests, *parts))
    if (general.loop and output.placed == _ALL) or (name == "contact_amplitude" and general.loop):
        some = rests.any(axis=-1)
        values = np.where(some.reshape(*some.shape, *[1] * (values.ndim - some.ndim)), np.nan, values)
    if output.free:
        values = np.where(carried_contacts(system), values, np.nan)
    if name in ("contact_midpoint", "midpoint") and system.rigid_modes:  # of motions at any place
        values = np.full_like(values, np.nan)
    if name in PER_CONTACT and (output.laws != _ALL or output.moving):
        without = ~np.isin(laws, output.laws) | (rests & output.moving)
        values = np.where(without, np.nan, values)
    return values.astype(LABELS[name].dtype, copy=False)


def carried_contacts(system: System) -> np.ndarray:
    """Whether a rigid-body mode moves each contact, (N,) bool."""
    return is_carried(system, system.modes)


def ways(cells: Cells) -> np.ndarray:
    """Displacements (..., N) in the contacts of a free structure over a period of the load."""
    found = number("drift", cells)
    ranges = (cells.highest - cells.lowest)[..., : found.shape[-1]]
    with np.errstate(invalid="ignore"):  # an unresolved cell
        none = (np.abs(found) <= DRIFTS * ranges) | (cells.contact_regime == regimes.PERMANENT_STICKING)
    return np.where(none, 0.0, found)


def drifts(system: System, cells: Cells) -> np.ndarray:
    """Whether the motion is another one after each period by a displacement, bool (...)."""
    own = np.where(carried_contacts(system), ways(cells), 0.0)
    return np.asarray((np.abs(own) > 0.0).any(axis=-1))


def about_middle(system: System, cells: Cells) -> tuple[np.ndarray, np.ndarray]:
    """Lowest and highest displacements (..., N + n) of a free structure, about the middle of the motion.

    Its place is arbitrary.  A motion has no ends that drifts, or that wanders without repeating.
    """
    half, carried = 0.5 * (cells.highest - cells.lowest), carried_contacts(system)
    lost = drifts(system, cells) | (cells.status == regimes.IRREGULAR)
    places = carried.size + system.n
    first = np.arange(half.shape[-1] - places) == 0  # of a chain the first storey alone is carried along
    placed = np.concatenate((carried, np.ones(system.n, dtype=bool), first))[: half.shape[-1]]
    half = np.where(lost[..., np.newaxis] & placed, np.nan, half)
    low, high = cells.lowest.copy(), cells.highest.copy()
    last = places + system.n  # forces have a zero of their own
    low[..., :last], high[..., :last] = -half[..., :last], half[..., :last]
    return low, high


def allocate(shape: tuple[int, int, int], contacts: int, masses: int, segments: int = 0) -> Cells:
    """Allocate unresolved cells; `segments` of friction laws at most."""

    def unresolved(name: str, *further: int) -> np.ndarray:
        return np.full((*shape, *further), LABELS[name].unresolved, LABELS[name].dtype)

    values = {name: unresolved(name) for name in Cells._fields if name in LABELS and name not in PER_CONTACT}
    values["contact_regime"] = unresolved("contact_regime", contacts)
    values["numbers"] = np.full((len(NUMBERS) + segments, *shape, contacts), np.nan)
    values["lowest"], values["highest"] = (np.full((*shape, contacts + masses), np.nan) for _ in range(2))
    return Cells(**values)
