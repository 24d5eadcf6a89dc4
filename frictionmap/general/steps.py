"""One steady state, or a part of an irregular motion, as the Taylor series of its steps."""

from dataclasses import dataclass

import numpy as np

from .. import regimes
from .._kernels.general.counts import (
    MOVED,
    REVERSALS,
    SLIPS,
    STOPS,
    TURNS,
)
from .._kernels.general.fill import Cells, store_motion
from .._kernels.general.problem import LONG, SECTION, Problem
from .._kernels.general.record import Record
from .._kernels.general.series import Friction
from .._kernels.general.steady import AVERAGED, REPEATS
from .._kernels.long_periods import WINDOW
from ..errors import NoSteadyState
from ..model.settings import Solver
from ..model.system import System
from .boundaries import friction_lines, stays_at_rest
from .certificate import certified_beta
from .held import least_static_friction
from .maps import put_offset
from .observed import observed_rows, of_contacts_last
from .outputs import allocate, drifts
from .problem import ModalSystem, general_of, problem_of
from .recorded import Memory, recorded_state
from .starts import initial_states
from .still import put_still

#: Steps for which there is room at first.
_FIRST = 512

#: Gauss nodes per step for integrals with harmonics.
_GAUSS = 24


@dataclass(frozen=True)
class Steps:
    """A steady state over its period, or the last periods of a motion that does not repeat.

    The steps begin at the phase `SECTION`: of the period, or of the one before those that are shown.
    """

    problem: Problem
    modal: ModalSystem
    friction: Friction
    r: float
    begins: np.ndarray  # (steps,) time since the section
    lengths: np.ndarray  # (steps,)
    h: float
    series: np.ndarray  # (steps, rows, WIDTH)
    senses: np.ndarray  # (steps, N)
    cells: Cells  # one cell
    period: int  # 0: the motion does not repeat, and numbers are averages
    shown: int  # periods of the load that are shown, from tau = 0 on
    span: int  # periods that the steps cover
    cycles: float
    drifts: bool = False  # whether the motion is displaced after each period, of a free structure

    @property
    def contacts(self) -> int:
        """Number of contacts."""
        return self.senses.shape[1]

    @property
    def lead(self) -> float:
        """Time before tau = 0 at which the first period with steps begins."""
        return 2.0 * np.pi * (self.span - self.shown)

    def rows(self, name: str) -> slice:
        """Rows of the series of the modes, of z, w, f."""
        modes, channels = self.problem.push.shape
        first, count = modes + channels, self.contacts
        return {
            "q": slice(0, modes), "L": slice(modes, first), "z": slice(first, first + count),
            "w": slice(first + count, first + 2 * count),
            "f": slice(first + 2 * count, first + 3 * count),
        }[name]  # fmt: skip

    def places(self, tau: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The step that each phase lies in, and the place x in it."""
        since = np.mod(tau - SECTION + self.lead, 2.0 * np.pi * self.span)
        k = np.clip(np.searchsorted(self.begins, since, side="right") - 1, 0, self.begins.size - 1)
        return k, (since - self.begins[k]) / self.h

    def at(self, name: str, tau: np.ndarray, order: int = 0) -> np.ndarray:
        """Values at phases tau, (rows, tau.size); `order` 1 for the derivative by tau."""
        k, x = self.places(tau)
        return self.values(self.series[k, self.rows(name)], x[:, np.newaxis], order).T

    def displacements(self, tau: np.ndarray, order: int = 0, row: int | slice = slice(None)) -> np.ndarray:
        """Displacements of the masses, or points, as of `at`; of one row or all."""
        q, loads, forces = (self.at(name, tau, order) for name in "qLf")
        return self.modal.displacements(q, loads, forces, row)

    def displacement_harmonics(self, highest: int) -> np.ndarray:
        """Harmonics of the displacements of the masses, or points, as of `harmonics`."""
        q, loads, forces = (self.harmonics(name, highest) for name in "qLf")
        return self.modal.displacements(q, loads, forces)

    def values(self, series: np.ndarray, x: np.ndarray, order: int) -> np.ndarray:
        """Values of series at x, or with `order` 1 derivatives by tau."""
        value = np.zeros(series.shape[:-1])
        slope = np.zeros(series.shape[:-1])
        for n in range(LONG - 1, -1, -1):
            slope = slope * x + value
            value = value * x + series[..., n]
        return slope / self.h if order else value

    def harmonics(self, name: str, highest: int) -> np.ndarray:
        """Harmonics 0 to `highest` of the rows, complex (rows, highest + 1): x = Re sum X_n e^{i n tau}."""
        nodes, weights = np.polynomial.legendre.leggauss(_GAUSS)
        x = 0.5 * (1.0 + nodes) * (self.lengths[:, np.newaxis] / self.h)  # (steps, nodes)
        series = self.series[:, self.rows(name)]
        values = self.values(series[:, :, np.newaxis, :], x[:, np.newaxis, :], 0)  # (steps, rows, nodes)
        tau = SECTION + self.begins[:, np.newaxis] + x * self.h
        weight = 0.5 * weights * self.lengths[:, np.newaxis]
        orders = np.arange(highest + 1)
        waves = np.exp(-1j * orders[:, np.newaxis, np.newaxis] * tau) * weight
        found = np.einsum("skg,nsg->kn", values, waves) / (np.pi * self.span)
        found[:, 0] *= 0.5
        return found


def _rests(system: System, problem: Problem, i: int, friction: Friction) -> bool:
    """Whether all contacts stick permanently, by closed form."""
    if problem.loops:  # the motion decides
        return False
    needed = least_static_friction(system, problem.r[i : i + 1])[0]
    return bool((friction.static >= needed).all())


def _cells(system: System, problem: Problem, counts: np.ndarray, halves: int, record: Record) -> Cells:
    """Store what was measured over some half periods, as a map does it."""
    general = general_of(system)
    cells = allocate((1, 1, 1), general.count, len(record.masses), problem.law.speed.shape[1])
    store_motion(problem, cells, counts, halves, record)
    cells = of_contacts_last(system, cells)
    put_offset(system, cells)
    put_still(general, cells.contact_regime, cells.lowest, cells.highest)
    return cells


def _centre(problem: Problem, series: np.ndarray, lengths: np.ndarray, h: float) -> None:
    """Move a free structure so that the mean of each rigid-body mode over the steps is 0.

    series : (steps, rows, WIDTH), changed
    lengths : (steps,)
    """
    rigid = np.flatnonzero(problem.squares == 0.0)
    x = lengths / h
    powers = x[:, np.newaxis] ** np.arange(1, LONG + 1) / np.arange(1, LONG + 1)
    whole = np.einsum("srk,sk->r", series[:, rigid, :LONG], h * powers)
    means = whole / lengths.sum()
    first = sum(problem.push.shape)  # the rows of z follow those of modes and channels
    series[:, rigid, 0] -= means
    series[:, first : first + problem.spring.size, 0] -= problem.chi[:, rigid] @ means


def steps_of(
    system: System, r: float, beta: float, mu: float, solver: Solver, further: bool = False
) -> Steps:
    """Find the steady state of one cell; `further` as in `cell_steps`.

    Raises
    ------
    NoSteadyState
        None was found.
    """
    problem, modal = problem_of(system, np.array([r]), beta, loops=True)
    return cell_steps(system, problem, modal, 0, beta, mu, solver, further)


def cell_steps(
    system: System, problem: Problem, modal: ModalSystem, i: int, beta: float, mu: float, solver: Solver,
    further: bool = False,
) -> Steps:  # fmt: skip
    """Find the steady state at r[i] of a problem; see `steps_of`.

    further : whether drifts, accelerations and the force on the base are recorded
    """
    kinetic, static = friction_lines(system, np.array([mu]))
    friction = Friction(kinetic @ np.array([beta, 1.0]), static[0] @ np.array([beta, 1.0]))
    start = initial_states(system, problem, modal, solver.start)[i]
    rows = observed_rows(system, modal, further)
    equal = bool((friction.static == friction.kinetic).all())
    unique = equal and beta <= certified_beta(system)
    from_rest = stays_at_rest(system, solver.start)
    rests = (unique or from_rest) and _rests(system, problem, i, friction)
    limits = friction
    if rests and not unique:  # rounding must not decide whether a load at the limit moves it
        limits = friction._replace(static=np.full_like(friction.static, np.inf))
    found, halves, multiplier, counts, record, h, count = recorded_state(
        problem, i, limits, start, (solver.cycles, solver.tolerance),
        Memory(problem, rows, _FIRST), settled=not system.rigid_modes,
    )  # fmt: skip
    if found.status not in (REPEATS, AVERAGED):
        raise NoSteadyState(
            f"r = {problem.r[i]:g}, beta = {beta:g}, mu = {mu:g}: no steady state was found in "
            f"{found.cycles:.0f} periods; raise solver.cycles"
        )
    if rests:
        counts[[STOPS, TURNS, SLIPS, REVERSALS, MOVED]] = 0.0  # contacts at their limit, by rounding
    span, averaged = halves // 2, halves // 2
    period = shown = span
    if found.status == AVERAGED:
        period, shown, averaged = 0, WINDOW, found.halves // 2
    lengths = record.patterns[:count, -1] * h
    begins = np.concatenate(([0.0], np.cumsum(lengths)[:-1]))
    own = lengths > 0.0
    series = record.steps[:count][own]
    if system.rigid_modes:
        _centre(problem, series, lengths[own], h)
    cells = _cells(system, problem, counts, 2 * averaged, record)
    cells.status[:] = regimes.RESOLVED if period else regimes.IRREGULAR
    cells.unique[:] = unique
    cells.origin[:] = regimes.PERIODIC_ORBIT if period else regimes.INTEGRATED
    cells.period[:], cells.multiplier[:], cells.cycles[:] = period, multiplier, np.ceil(found.cycles)
    return Steps(
        problem, modal, friction, float(problem.r[i]), begins[own], lengths[own], h,
        series, record.patterns[:count][own][:, :-1].astype(np.int8), cells,
        period, shown, span, found.cycles, bool(system.rigid_modes and drifts(system, cells).any()),
    )  # fmt: skip
