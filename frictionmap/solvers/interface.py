"""What an engine answers about a system."""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, ClassVar, NamedTuple

import numpy as np

from ..datasets.labels import CONTACT_TRACES, PER_CONTACT
from ..jobs import Progress, Watch
from ..model.settings import CurveSettings, Solver
from ..model.sizes import Sizes, Wanted
from ..model.system import System

if TYPE_CHECKING:
    import xarray as xr

    from ..single.points import States


#: Variables of a steady state with one value, or one row, per contact.
OF_CONTACTS = frozenset((*PER_CONTACT, *CONTACT_TRACES))


class Limits(NamedTuple):
    """Boundaries over mu and r; NaN where a system has none of the kind."""

    beta_lim: np.ndarray  # (n_mu, n_r) end of the first interval without stops
    beta_stick: np.ndarray  # (n_mu, n_r) friction from which all contacts stick permanently
    beta_stick_contact: np.ndarray  # (n_mu, n_r, N) and from which each does, the others held
    begins: np.ndarray  # (n_mu, n_r, intervals) of the intervals without stops that are looked for
    ends: np.ndarray


class Motion(NamedTuple):
    """A steady state in time as arrays, by the names of the dataset of `response`.

    values : numbers (), of masses (n,) and contacts (N,), over time (n, tau) and (N, tau), harmonics
        (..., harmonic, part)
    limits : the boundaries at its frequency
    comment : which part of an irregular motion it is; empty of others
    """

    values: dict[str, np.ndarray]
    limits: Limits
    comment: str


def traced_motion(ds: "xr.Dataset", limits: Limits) -> Motion:
    """A steady state as arrays, from the dataset of `response`."""
    several = "contact" in ds.dims
    values = {
        str(name): one.values if several or name not in OF_CONTACTS else one.values[np.newaxis]
        for name, one in ds.variables.items()
    }
    values.setdefault("contact_regime", values["regime"][np.newaxis])  # of the only one
    return Motion(values, limits, ds.attrs.get("comment", ""))


class Engine(ABC):
    """Answers about one system.

    Axes are mappings of mu, r and beta to increasing arrays; datasets come with variables and coordinates,
    without provenance.  Arrays have an axis for the contacts (N,) even where there is one.
    """

    #: Whether beta_lim is a closed form; else motions are followed for it, a thousand times as long.
    has_closed_limits: ClassVar[bool]

    #: Number of intervals without stops that its boundaries have beside `beta_lim`.
    intervals: ClassVar[int]

    #: Whether maps always have `status`; else only where any cell is unresolved or averaged.
    states_status: ClassVar[bool]

    #: Whether the motions from rest and from a large sliding motion can be compared in a cell.
    compares_starts: ClassVar[bool]

    #: Distance of the orders of harmonics in the friction force.
    order_step: ClassVar[int]

    def __init__(self, system: System) -> None:
        self.system = system

    @property
    @abstractmethod
    def kernels(self) -> str:
        """Name of the kernels that it compiles."""

    @property
    @abstractmethod
    def least_ratio(self) -> float:
        """Least r > 0 at which motions are computed."""

    @property
    @abstractmethod
    def least_stick_ratio(self) -> float:
        """Least r at which the boundary to permanent sticking is computed."""

    @abstractmethod
    def check_static(self, mu: np.ndarray) -> None:
        """Refuse static-to-kinetic ratios that the contacts cannot have.

        Raises
        ------
        InputError
            mu > 1, and all contacts are elastic.
        """

    @property
    @abstractmethod
    def outputs(self) -> tuple[str, ...]:
        """Outputs of cells on offer."""

    @property
    @abstractmethod
    def bytes_per_cell(self) -> float:
        """Bytes of results of a map in a cell beside its outputs."""

    @abstractmethod
    def needed_friction(self, r: np.ndarray) -> np.ndarray:
        """Friction with which each contact holds, over the load, (n_r, N): half the range of its force."""

    @abstractmethod
    def no_stop_limit(self, r: np.ndarray, mu: float, watch: Watch | None) -> np.ndarray:
        """beta_lim, (n_r,), of a system without elastic contacts."""

    @abstractmethod
    def limits(self, r: np.ndarray, mu: np.ndarray, watch: Watch | None = None) -> Limits:
        """Boundaries of the regimes over r and mu as arrays."""

    def known_limits(self, r: np.ndarray, mu: np.ndarray) -> Limits:
        """The boundaries that take no search; NaN in the place of others."""
        return self.limits(r, mu)

    @abstractmethod
    def boundaries(self, r: np.ndarray, mu: np.ndarray) -> "xr.Dataset":
        """Boundaries of the regimes over r and mu; see `frictionmap.boundaries`."""

    @abstractmethod
    def map(
        self, axes: Mapping[str, np.ndarray], solver: Solver, threads: int | None, progress: Progress | None,
        watch: Watch | None = None,
    ) -> "xr.Dataset":  # fmt: skip
        """Outputs, `status` and boundaries of all cells; `watch` may end the computation."""

    @abstractmethod
    def cells(
        self, axes: Mapping[str, np.ndarray], names: Sequence[str], solver: Solver, threads: int | None,
        progress: Progress | None, watch: Watch | None, searched: bool = True,
    ) -> tuple[dict[str, np.ndarray], Limits]:  # fmt: skip
        """Arrays of these outputs and of `regime` and `contact_regime` over all cells, and the boundaries.

        searched : whether boundaries are wanted that take a search; else those of `known_limits` are enough
        """

    @abstractmethod
    def curves(
        self, axes: Mapping[str, np.ndarray], solver: Solver, asked: CurveSettings, threads: int | None,
        progress: Progress | None, watch: Watch | None = None,
    ) -> "xr.Dataset":  # fmt: skip
        """Response curves; `axes` may also hold the axes of masses and harmonics."""

    @abstractmethod
    def motion(self, r: float, beta: float, mu: float, solver: Solver, points: int) -> "xr.Dataset":
        """One steady state in time; the attribute `comment` says what part of an irregular motion it is.

        Raises
        ------
        NoSteadyState
            None exists, or none was found.
        """

    def traced(self, r: float, beta: float, mu: float, solver: Solver, points: int) -> Motion:
        """One steady state in time as arrays, see `motion`."""
        ds = self.motion(r, beta, mu, solver, points)
        return traced_motion(ds, self.limits(np.array([r]), np.array([mu])))

    @property
    @abstractmethod
    def sizes(self) -> tuple[str, ...]:
        """Quantities of `Wanted` on offer."""

    @abstractmethod
    def sizes_on_grid(
        self, wanted: Wanted, axes: dict[str, np.ndarray], solver: Solver, threads: int, watch: Watch | None
    ) -> Sizes:
        """Sizes over r and beta at one mu, (n_r, n_beta); the outputs of the settings do not matter."""

    @abstractmethod
    def sizes_at(
        self, wanted: Wanted, r: np.ndarray, beta: np.ndarray, mu: float, solver: Solver, threads: int,
        watch: Watch | None,
    ) -> Sizes:  # fmt: skip
        """Sizes at points r > 0 and beta >= 0, (k,); the outputs of the settings do not matter."""

    @abstractmethod
    def states(self, r: np.ndarray, beta: np.ndarray, mu: float) -> "list[States]":
        """First harmonics of the possible steady states at points (k,); see `steady.points`."""


class FollowingEngine(Engine):
    """An engine that follows every motion from a phase of the load to the next return."""

    has_closed_limits = False
    intervals = 1
    states_status = True
    compares_starts = False
    order_step = 1

    @property
    def least_stick_ratio(self) -> float:
        return 0.0

    def check_static(self, mu: np.ndarray) -> None:
        from ..general.dataset import refuse_static

        refuse_static(self.system.contact_system, mu)
