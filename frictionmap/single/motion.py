"""One steady state in time, as arrays: motion of masses and contact, friction force, events."""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from .. import regimes
from .._kernels.continuous_motion import orbit_phase
from .._kernels.engine import segment_table
from .._kernels.engine.fill import one_cell
from .._kernels.engine.further import (
    continuous_cell_quantities,
    stuck_cell_quantities,
    table_cell_quantities,
)
from .._kernels.engine.records import Cell
from .._kernels.engine.time_history import Samples, sample_segments
from .._kernels.engine.window import window_table
from .._kernels.long_periods import WINDOW
from .._kernels.structure.newton import make_workspace
from .._kernels.structure.oscillators import make_scratch
from .._kernels.structure.state import make_structure
from ..datasets.labels import EXCERPT
from ..errors import NoSteadyState
from ..model.settings import HARMONICS, Solver
from ..model.system import System
from ..theory.boundary_curves import Curves
from .cells import Cells, limits
from .kernel_data import StructureArrays
from .maps import plan
from .quantity_data import VARIABLES, quantity_request, read_result

_TURN = 2.0 * math.pi

#: All variables of the quantities of response curves.
CYCLE = tuple(name for names in VARIABLES.values() for name in names)


@dataclass(frozen=True)
class MotionRequest:
    """One requested steady state."""

    system: System
    r: float
    beta: float
    mu: float
    solver: Solver
    points: int


@dataclass(frozen=True)
class History:
    """A steady state in time; events are the starts of slides and stops, in order."""

    period: int
    tau: np.ndarray
    x: np.ndarray  # (n, tau.size)
    v: np.ndarray
    z: np.ndarray  # (tau.size,)
    friction: np.ndarray
    direction: np.ndarray  # -1, 0, 1: sliding down, sticking, sliding up
    events: tuple[np.ndarray, np.ndarray, np.ndarray]  # tau, direction of the segment that starts, z
    durations: np.ndarray  # durations of the stops
    amplitude: float
    stuck: bool  # whether the contact sticks permanently


@dataclass(frozen=True)
class FoundMotion:
    """Steady state of a cell, or a window of a motion that does not repeat.

    recurrence : segments of one recurrence, mirrored or not; None where the closed form gives the motion
    """

    table: np.ndarray | None  # segments of one period, or of the window; None where it sticks permanently
    status: int
    stuck_at: float = 0.0  # z where it sticks
    averages: Cell | None = None  # averages of a motion that does not repeat
    recurrence: np.ndarray | None = None


class SteadyMotion(NamedTuple):
    """A steady state in time, and its scalars.

    summary : regime, stops per cycle, contact amplitude, share stuck, period, status
    cycle : its quantities of response curves; (n,) for masses, (..., 2) for harmonics
    curves : the boundaries there, (1, 1)
    comment : remark on a motion that does not repeat; else empty
    """

    history: History
    summary: dict[str, float]
    cycle: dict[str, np.ndarray]
    curves: Curves
    comment: str


def _times(period: int, points: int) -> np.ndarray:
    return np.linspace(0.0, _TURN * period, points * period + 1)


def _since(tau: np.ndarray, start: float, total: float) -> np.ndarray:
    """Times since `start`, within one steady period."""
    since = np.mod(tau - start, total)
    since[since > total * (1.0 - 1e-15)] = 0.0  # rounding must not move a sample past the end
    return since


def _no_steady_state(request: MotionRequest, why: str) -> NoSteadyState:
    return NoSteadyState(f"r = {request.r:g}, beta = {request.beta:g}, mu = {request.mu:g}: {why}")


_UNBOUNDED = "an undamped resonance; the motion grows without bound"


def _decided(cells: Cells, request: MotionRequest) -> int:
    """Regime given by a closed form; unresolved where the cell is open."""
    beta, mu = np.array([request.beta]), np.array([request.mu])
    work = plan(cells, np.array([request.r]), mu, beta, request.solver)
    if work.cells:
        return regimes.UNRESOLVED
    return regimes.CONTINUOUS if work.low[0] else regimes.PERMANENT_STICKING


def _with_mirror_image(table: np.ndarray) -> np.ndarray:
    """Segment table over one steady period: twice as long where the motion recurs as its mirror image."""
    length = float(table[:, segment_table.LENGTH].sum())
    if round(length / math.pi) % 2 == 0:
        return table
    mirrored = table.copy()
    mirrored[:, segment_table.SIGN] *= -1.0
    mirrored[:, segment_table.BEGIN] += length
    return np.concatenate((table, mirrored))


def _continuous_table(request: MotionRequest, cells: Cells) -> np.ndarray:
    """Segment table of the continuous orbit, one segment."""
    found = cells.structure_arrays
    orbit, n = found.orbit, found.participating.size
    st = make_structure(found.model, found.loads, 0, request.r, float(request.solver.steps))
    table = np.empty((1, segment_table.segment_columns(n)))
    phase = orbit_phase(orbit.v_abs[0], orbit.v_arg[0], orbit.u[0], request.beta)
    segment_table.continuous_segment(st, orbit, 0, request.beta, phase, table[0], make_workspace(n))
    return table


def _window(request: MotionRequest, cells: Cells, cell: Cell) -> FoundMotion:
    """Segment table of the last periods of a motion that does not repeat."""
    before = _TURN * max(0.0, cell.cycles - WINDOW - 2.0)
    moving = request.solver.start == "moving"
    table = window_table(
        cells.motion, request.beta, request.mu, moving, before, _TURN * (WINDOW + 2.0)
    )  # fmt: skip
    averages = cell._replace(amplitude=cells.unit * cell.amplitude)
    return FoundMotion(table, cell.status, averages=averages)


def _find(request: MotionRequest, cells: Cells) -> FoundMotion:
    """Find the steady state, or raise NoSteadyState."""
    regime, stuck_at = _decided(cells, request), 0.0
    status = regimes.RESOLVED
    table = np.empty((0, 0))
    if regime == regimes.UNRESOLVED:
        solver = request.solver
        moving = solver.start == "moving"
        cell, table = one_cell(cells.motion, request.beta, request.mu, limits(solver), moving)
        status = cell.status
        if status == regimes.IRREGULAR:
            return _window(request, cells, cell)
        if cell.period == 0:
            raise _no_steady_state(request, regimes.status_meaning(status))
        regime, stuck_at = cell.regime, cells.unit * cell.sign * cell.contact_state.z
    if regime == regimes.PERMANENT_STICKING:
        return FoundMotion(None, status, stuck_at)
    recurrence = table if table.shape[0] else None
    if recurrence is None:
        if math.isinf(cells.structure_arrays.orbit.v_abs[0]):
            raise _no_steady_state(request, _UNBOUNDED)
        table = _continuous_table(request, cells)
        marginal = bool(cells.structure_arrays.marginal[0]) and request.beta > 0.0
        status = regimes.MARGINAL if marginal else status
    return FoundMotion(_with_mirror_image(table), status, recurrence=recurrence)


def _stuck_history(request: MotionRequest, cells: Cells, stuck_at: float) -> History:
    """Time history with the contact held at `stuck_at` permanently."""
    found = cells.structure_arrays
    tau = _times(1, request.points)
    turn = np.exp(1j * tau)
    held = found.held[0][:, np.newaxis] * turn
    offset = found.outputs.static_shape[:, np.newaxis] * stuck_at
    force = request.system.modes.held_load(np.array([request.r]))[0] * turn
    return History(
        1, tau, held.real + offset, -held.imag, np.full(tau.size, stuck_at),
        force.real - found.model.stiffness * stuck_at, np.zeros(tau.size, np.int8),
        (np.empty(0), np.empty(0), np.empty(0)), np.empty(0), 0.0, True,
    )  # fmt: skip


def _segment_starts(table: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Sense of the segments that start, and z there."""
    sign = table[:, segment_table.SIGN]
    # a segment starts where the previous one ended
    return sign * table[:, segment_table.SENSE], np.roll(sign * table[:, segment_table.Z_END], 1)


def _align_times(
    found: FoundMotion, tau: np.ndarray, begin: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Align the segment table, whose segments start at `begin` after the first one, with the load phase.

    Returns the times of the samples since the first segment; which segments start among them, in order; and
    when.
    """
    table = found.table
    assert table is not None
    sign = table[0, segment_table.SIGN]
    start = math.atan2(sign * table[0, segment_table.SIN], sign * table[0, segment_table.COS])
    if found.averages is None:
        total = float(table[:, segment_table.LENGTH].sum())
        times = np.mod(begin + start, total)
        order = np.argsort(times, kind="stable")
        return _since(tau, start, total), order, times[order]
    skipped = -start % _TURN  # to the first maximum of the load
    inside = np.flatnonzero((begin >= skipped) & (begin <= skipped + tau[-1]))
    return tau + skipped, inside, begin[inside] - skipped


def _displacements(
    request: MotionRequest,
    numbers: StructureArrays,
    coordinates: np.ndarray,
    velocities: np.ndarray,
    tau: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """x and x' in tau (n_dof, tau.size), from coordinates and velocities of the oscillators (n, tau.size)."""
    modes, n = request.system.modes, len(coordinates)
    if not modes.free.coupled:
        outputs = numbers.outputs.free[:, :n]
        return outputs @ coordinates, outputs @ velocities
    r, loads = request.r, numbers.loads
    feedthrough = np.outer(loads.free_feedthrough_cos[0], np.cos(tau)) + np.outer(
        loads.free_feedthrough_sin[0], np.sin(tau)
    )
    motion = modes.free.to_modes @ np.concatenate((coordinates, r * velocities - feedthrough))
    phi = modes.phi[:, numbers.participating]
    return phi @ motion[:n], phi @ motion[n:] / r


def _moving_history(request: MotionRequest, cells: Cells, found: FoundMotion) -> History:
    """Time history of a sliding motion, sampled from its segment table."""
    numbers, table = cells.structure_arrays, found.table
    assert table is not None
    if numbers.resonant.any():
        raise _no_steady_state(request, _UNBOUNDED)
    n = numbers.participating.size
    lengths = table[:, segment_table.LENGTH]
    period = WINDOW if found.averages else max(1, round(float(lengths.sum()) / _TURN))
    tau = _times(period, request.points)
    since, shown, times = _align_times(found, tau, table[:, segment_table.BEGIN])
    order = np.argsort(since, kind="stable")
    st = make_structure(numbers.model, numbers.loads, 0, request.r, float(request.solver.steps))
    coordinates, velocities = np.empty((2, n, tau.size))
    z, friction = np.empty((2, tau.size))
    sense = np.empty(tau.size, dtype=np.int8)
    samples = Samples(coordinates, velocities, z, friction, sense)
    sample_segments(st, request.beta, table, since[order], samples, make_workspace(n), make_scratch(n))
    back = np.empty_like(order)
    back[order] = np.arange(order.size)
    uncoupled = numbers.uncoupled[0][:, np.newaxis] * np.exp(1j * tau)
    x, v = _displacements(request, numbers, coordinates[:, back], velocities[:, back], tau)
    begins, places = _segment_starts(table)
    return History(
        period, tau, x + uncoupled.real, v - uncoupled.imag, z[back], friction[back], sense[back],
        (times, begins[shown], places[shown]), lengths[table[:, segment_table.SENSE] == 0.0],
        float(np.abs(table[:, segment_table.Z_END]).max()), False,
    )  # fmt: skip


def _summary(history: History, found: FoundMotion) -> dict[str, float]:
    """Scalars of the cell; those of a motion that does not repeat are averages, and it has no period."""
    averages = found.averages
    if averages is not None:
        return {
            "regime": averages.regime,
            "stops_per_cycle": averages.stops,
            "contact_amplitude": averages.amplitude,
            "stuck_fraction": averages.stuck,
            "period": 0,
            "status": found.status,
        }
    stops = history.durations.size
    regime = regimes.STICK_SLIP if stops else regimes.CONTINUOUS
    return {
        "regime": regimes.PERMANENT_STICKING if history.stuck else regime,
        "stops_per_cycle": math.nan if history.stuck else stops / history.period,
        "contact_amplitude": history.amplitude,
        "stuck_fraction": 1.0 if history.stuck else history.durations.sum() / (_TURN * history.period),
        "period": history.period,
        "status": found.status,
    }


def _cycle(request: MotionRequest, cells: Cells, found: FoundMotion) -> dict[str, np.ndarray]:
    """Quantities of response curves of the cell; NaN for a motion that does not repeat."""
    if found.averages is None:
        if found.table is None:
            stuck_cell_quantities(cells.common, cells.quantities)
        elif found.recurrence is None:
            continuous_cell_quantities(cells.common, cells.quantities, request.beta)
        else:
            table_cell_quantities(cells.common, cells.quantities, request.beta, found.recurrence)
    return {name: read_result(name, cells.results)[0, 0, 0] for name in CYCLE}


def _history(request: MotionRequest, cells: Cells, found: FoundMotion) -> History:
    if found.table is None:
        return _stuck_history(request, cells, found.stuck_at)
    return _moving_history(request, cells, found)


def find_motion(request: MotionRequest) -> SteadyMotion:
    """Find the steady state of a cell in time, and its scalars.

    Raises
    ------
    NoSteadyState
        None exists, or none was found.
    """
    system, solver = request.system, request.solver
    r, beta, mu = (np.array([value]) for value in (request.r, request.beta, request.mu))
    cells = Cells(system, r, beta, mu, solver, quantity_request(CYCLE, HARMONICS))
    found = _find(request, cells)
    history = _history(request, cells, found)
    comment = ""
    if found.averages is not None:
        comment = EXCERPT.format(shown=WINDOW, followed=math.ceil(found.averages.cycles))
    return SteadyMotion(
        history, _summary(history, found), _cycle(request, cells, found), cells.curves, comment
    )
