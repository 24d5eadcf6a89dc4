"""One steady state in time: motion of the masses and of the contact, friction force, starts and stops."""

import math
from dataclasses import dataclass, replace
from typing import SupportsFloat, Unpack

import numpy as np
import xarray as xr

from . import checks, regimes
from ._kernels.continuous import Oscillator, orbit_phase
from ._kernels.history import (
    COLUMNS,
    COS,
    LENGTH,
    SIGN,
    SIN,
    WAIT,
    Z_END,
    Z,
    continuous_slides,
    orbit_slides,
    sample_slides,
)
from ._kernels.orbits import SHORTEST_STOP
from ._kernels.phases import MAX_TERMS, Step, step_constants
from ._kernels.sweep import FINE_STEPS, integrate_one, normalised_friction
from .cells import Cells, OneMassCells, StructureCells, limits, make_cells
from .curves import boundary_variables
from .errors import InputError, NoSteadyState
from .labels import CELL_VARIABLES, coordinate, label_variable, stamp
from .maps import plan, sweep
from .settings import Output, Solver, SolverSettings, merged
from .system import System

#: Samples of a time history per excitation period.
POINTS = 2000
_MOST_POINTS = 10**6

_TURN = 2.0 * math.pi


@dataclass(frozen=True)
class Question:
    """One steady state that is asked for."""

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
    phase: np.ndarray
    events: tuple[np.ndarray, np.ndarray, np.ndarray]  # tau, phase that begins, z
    durations: np.ndarray  # of the stops
    amplitude: float
    stuck: bool  # for good


def _times(period: int, points: int) -> np.ndarray:
    return np.linspace(0.0, _TURN * period, points * period + 1)


def _since(tau: np.ndarray, start: float, total: float) -> np.ndarray:
    """Times from `start` on, within one steady period."""
    since = np.mod(tau - start, total)
    since[since > total * (1.0 - 1e-15)] = 0.0  # rounding must not place a sample past the end
    return since


def _no_steady_state(question: Question, why: str) -> NoSteadyState:
    return NoSteadyState(f"r = {question.r:g}, beta = {question.beta:g}, mu = {question.mu:g}: {why}")


_UNBOUNDED = "an undamped resonance; the motion grows without bound"


def _decided(cells: Cells, question: Question) -> int:
    """The regime that a formula gives; unresolved where the cell is open."""
    beta, mu = np.array([question.beta]), np.array([question.mu])
    work = plan(cells, np.array([question.r]), mu, beta, question.solver)
    if work.cells:
        return regimes.UNRESOLVED
    return regimes.CONTINUOUS if work.low[0] else regimes.PERMANENT_STICKING


def _slides(question: Question, cells: OneMassCells) -> tuple[Step, float, np.ndarray, float]:
    """(step, b, rows, rest): the slides of the steady state over one period; none where stuck at `rest`."""
    r, beta, mu, solver, zeta = (
        question.r, question.beta, question.mu, question.solver, question.system.zeta
    )  # fmt: skip
    found, f = cells.found, cells.found.frequencies
    load, phase = f.load[0], f.phase[0]
    step = step_constants(r, zeta, float(solver.steps))
    oscillator = Oscillator(r, zeta, f.v_abs[0], f.v_arg[0], f.u[0], f.g[0], f.marginal[0])
    b, mu_b = normalised_friction(beta, load, mu, found.curves.beta_stick[0, 0])
    scratch = np.empty(MAX_TERMS)
    rest = 0.0
    rows = np.empty((0, COLUMNS))
    regime = _decided(cells, question)
    if regime == regimes.UNRESOLVED:
        cell = integrate_one(
            beta, mu, found.lim[0, 0], found.curves.beta_stick[0, 0], load, phase, oscillator, step,
            step_constants(r, zeta, max(float(solver.steps), FINE_STEPS)), limits(solver),
            solver.start == "moving",
        )  # fmt: skip
        if cell.period == 0:
            raise _no_steady_state(question, regimes.status_meaning(cell.status))
        regime, rest = cell.regime, cell.sign * cell.z
        rows = np.empty((cell.events, COLUMNS))
    if regime == regimes.PERMANENT_STICKING:
        return step, b, np.empty((0, COLUMNS)), rest
    if rows.size:
        orbit_slides(step, r, b, mu_b, cell.z, cell.cos, cell.sin, cell.sign, rows, scratch)
    elif math.isinf(oscillator.v_abs):
        raise _no_steady_state(question, _UNBOUNDED)
    else:
        rows = np.empty((2, COLUMNS))
        continuous_slides(step, oscillator, b, rows, scratch)
    halves = round(float(rows[:, LENGTH].sum() + rows[:, WAIT].sum()) / math.pi)
    if halves % 2:  # it returned as its mirror image
        mirrored = rows.copy()
        mirrored[:, SIGN] *= -1.0
        rows = np.concatenate((rows, mirrored))
    return step, b, rows, 0.0


def _events(rows: np.ndarray, begin: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Times from the first slide, phases that begin and z there, of all slides and stops."""
    stops = rows[:, WAIT] > 0.0
    times = np.concatenate((begin, (begin + rows[:, LENGTH])[stops]))
    phases = np.concatenate((rows[:, SIGN], np.zeros(int(stops.sum()))))
    places = np.concatenate((rows[:, SIGN] * rows[:, Z], (rows[:, SIGN] * rows[:, Z_END])[stops]))
    return times, phases, places


def _one_mass_history(question: Question, cells: OneMassCells) -> History:
    f = cells.found.frequencies
    load, lead = f.load[0], f.phase[0]
    step, b, rows, rest = _slides(question, cells)
    durations = rows[:, LENGTH] + rows[:, WAIT]
    total = float(durations.sum())
    period = max(1, round(total / _TURN))
    tau = _times(period, question.points)
    z = np.full(tau.size, rest)
    v = np.zeros(tau.size)
    friction = np.cos(tau + lead) - rest
    phase = np.zeros(tau.size, dtype=np.int8)
    events = (np.empty(0), np.empty(0), np.empty(0))
    if rows.size:
        begin = np.concatenate(([0.0], np.cumsum(durations)[:-1]))
        start = math.atan2(rows[0, SIGN] * rows[0, SIN], rows[0, SIGN] * rows[0, COS]) - lead
        since = _since(tau, start, total)
        order = np.argsort(since, kind="stable")
        places, speeds, forces = np.empty((3, tau.size))
        senses = np.empty(tau.size, dtype=np.int8)
        sample_slides(step, b, rows, since[order], places, speeds, forces, senses, np.empty(MAX_TERMS))
        z[order], v[order], friction[order] = places, speeds, forces
        phase[order] = senses
        times, begins, at = _events(rows, begin)
        times = np.mod(times + start, total)
        order = np.argsort(times, kind="stable")
        events = (times[order], begins[order], load * at[order])
    base = question.system.base_motion
    z, v = load * z, load * v
    return History(
        period, tau, (z + base * np.cos(tau))[np.newaxis], (v - base * np.sin(tau))[np.newaxis], z,
        load * friction, phase, events, rows[:, WAIT][rows[:, WAIT] > SHORTEST_STOP],
        load * np.abs(rows[:, Z_END]).max(initial=0.0), not rows.size,
    )  # fmt: skip


def _structure_phases(question: Question, cells: StructureCells) -> tuple[np.ndarray, float]:
    """(rows, rest): the phases of the steady state over one period; none where stuck at `rest`."""
    from ._kernels import structure_history as history
    from ._kernels.oscillators import make_scratch
    from ._kernels.returns import make_workspace
    from ._kernels.structure import make_structure
    from ._kernels.structure_sweep import one_structure

    found, solver, beta = cells.found, question.solver, question.beta
    n = found.seen.size
    steps = float(solver.steps)
    columns = history.STATE + 2 * n
    regime = _decided(cells, question)
    events = 0
    rest = 0.0
    state = np.empty((2, n))
    if regime == regimes.UNRESOLVED:
        cell = one_structure(
            beta, question.mu, cells.curves.beta_lim[0, 0], question.r, found.model, found.loads, found.orbit,
            bool(found.marginal[0]), cells.starts, steps, limits(solver), state,
        )  # fmt: skip
        if cell.period == 0:
            raise _no_steady_state(question, regimes.status_meaning(cell.status))
        regime, events, rest = cell.regime, cell.events, cell.sign * cell.z
    if regime == regimes.PERMANENT_STICKING:
        return np.empty((0, columns)), rest
    st = make_structure(found.model, found.loads, 0, question.r, steps)
    work = make_workspace(n)
    if events:
        rows = np.empty((2 * events, columns))
        state[1] /= st.rate
        count = history.orbit_phases(
            st, beta, question.mu * beta, state, cell.cos, cell.sin, cell.sign, cell.net, events, rows, work,
            make_scratch(n),
        )  # fmt: skip
        rows = rows[:count]
    elif math.isinf(found.orbit.v_abs[0]):
        raise _no_steady_state(question, _UNBOUNDED)
    else:
        rows = np.empty((1, columns))
        orbit = found.orbit
        phase = orbit_phase(orbit.v_abs[0], orbit.v_arg[0], orbit.u[0], beta)
        history.continuous_phase(st, orbit, 0, beta, phase, rows, work)
    if round(float(rows[:, history.LENGTH].sum()) / math.pi) % 2:  # it returned as its mirror image
        mirrored = rows.copy()
        mirrored[:, history.SIGN] *= -1.0
        rows = np.concatenate((rows, mirrored))
    return rows, 0.0


def _structure_history(question: Question, cells: StructureCells) -> History:
    from ._kernels import structure_history as history
    from ._kernels.oscillators import make_scratch
    from ._kernels.returns import make_workspace
    from ._kernels.structure import make_structure

    found = cells.found
    if found.resonant.any():
        raise _no_steady_state(question, _UNBOUNDED)
    rows, rest = _structure_phases(question, cells)
    n = found.seen.size
    total = float(rows[:, history.LENGTH].sum())
    period = max(1, round(total / _TURN))
    tau = _times(period, question.points)
    turn = np.exp(1j * tau)
    if not rows.size:
        held = found.held[0][:, np.newaxis] * turn
        force = question.system.modes.held_load(np.array([question.r]))[0] * turn
        return History(
            period, tau, held.real + found.shapes.lift[:, np.newaxis] * rest, -held.imag,
            np.full(tau.size, rest), force.real - found.model.stiffness * rest, np.zeros(tau.size, np.int8),
            (np.empty(0), np.empty(0), np.empty(0)), np.empty(0), 0.0, True,
        )  # fmt: skip
    sign = rows[0, history.SIGN]
    start = math.atan2(sign * rows[0, history.SIN], sign * rows[0, history.COS])
    since = _since(tau, start, total)
    order = np.argsort(since, kind="stable")
    st = make_structure(found.model, found.loads, 0, question.r, float(question.solver.steps))
    coordinates, velocities = np.empty((2, n, tau.size))
    z, friction = np.empty((2, tau.size))
    sense = np.empty(tau.size, dtype=np.int8)
    history.sample_phases(
        st, question.beta, rows, rows.shape[0], since[order], coordinates, velocities, z, friction, sense,
        make_workspace(n), make_scratch(n),
    )  # fmt: skip
    back = np.empty_like(order)
    back[order] = np.arange(order.size)
    alone = (found.alone_re[0] + 1j * found.alone_im[0])[:, np.newaxis] * turn
    begin = np.concatenate(([0.0], np.cumsum(rows[:, history.LENGTH])[:-1]))
    times = np.mod(begin + start, total)
    # a slide starts where the phase before it ended
    places = np.roll(rows[:, history.SIGN] * rows[:, history.Z_END], 1)
    chosen = np.argsort(times, kind="stable")
    stops = rows[:, history.SENSE] == 0.0
    return History(
        period, tau, (found.shapes.free @ coordinates)[:, back] + alone.real,
        (found.shapes.free @ velocities)[:, back] - alone.imag, z[back], friction[back], sense[back],
        (times[chosen], (rows[:, history.SIGN] * rows[:, history.SENSE])[chosen], places[chosen]),
        rows[stops, history.LENGTH], float(np.abs(rows[:, history.Z_END]).max()), False,
    )  # fmt: skip


def _further(question: Question, names: list[Output]) -> dict[str, xr.Variable]:
    """Outputs of a map's cell that the motion in time does not show."""
    if not names:
        return {}
    solver = replace(question.solver, outputs=names)
    ds = sweep(question.system, question.r, question.beta, question.mu, solver=solver, threads=1)
    cell = ds.isel(mu=0, r=0, beta=0, missing_dims="ignore")
    return {name: cell[name].variable for name in names}


def response(
    system: System,
    r: SupportsFloat,
    beta: SupportsFloat,
    mu: SupportsFloat = 1.0,
    *,
    solver: Solver | None = None,
    points: int = POINTS,
    **settings: Unpack[SolverSettings],
) -> xr.Dataset:
    """One steady state in time.

    Parameters
    ----------
    system : System
    r, beta, mu : float
        Frequency ratio (> 0), friction ratio (>= 0), static over kinetic friction (>= 1) [-].
    solver : Solver, optional
        Settings; or give them one by one as keywords, each in place of the solver's own.
    points : int
        Samples per excitation period, up to 10^6.

    Returns
    -------
    xarray.Dataset
        Over `tau` (0 to 2 pi times the period): `x(dof, tau)`, `v(dof, tau)`, `z`, `friction` (over P)
        and `phase` (-1, 0, 1).  Over `event`: `event_tau`, `event_phase` (the phase that begins) and
        `event_z`.  Scalars: `regime`, `stops_per_cycle`, `contact_amplitude`, `stuck_fraction`, `period`,
        the boundaries and what else `outputs` asks for.  tau = 0 is a maximum of the load (of the base's
        displacement).

    Raises
    ------
    InputError
        An argument is out of range.
    NoSteadyState
        There is none, or none was found.

    Examples
    --------
    >>> import frictionmap as fm
    >>> ds = fm.response(fm.System(), r=0.3, beta=0.5)
    >>> int((ds.event_phase == 0).sum())
    2
    """
    checks.instance(system, "system", System)
    solver = merged(solver, settings)
    r = checks.number(r, "r", least=0.0, most=checks.LARGEST_RATIO)
    beta = checks.number(beta, "beta", least=0.0)
    mu = checks.number(mu, "mu", least=1.0)
    points = checks.whole(points, "points", least=2, most=_MOST_POINTS)
    if r == 0.0:
        raise InputError("r must be > 0: at r = 0 there is no motion in time; got 0")
    question = Question(system, r, beta, mu, solver, points)
    cells = make_cells(system, np.array([r]), np.array([beta]), np.array([mu]), solver)
    if isinstance(cells, OneMassCells):
        history = _one_mass_history(question, cells)
    else:
        assert isinstance(cells, StructureCells)
        history = _structure_history(question, cells)
    stops = history.durations.size
    regime = regimes.STICK_SLIP if stops else regimes.CONTINUOUS
    summary = {
        "regime": regimes.PERMANENT_STICKING if history.stuck else regime,
        "stops_per_cycle": math.nan if history.stuck else stops / history.period,
        "contact_amplitude": history.amplitude,
        "stuck_fraction": 1.0 if history.stuck else history.durations.sum() / (_TURN * history.period),
        "period": history.period,
    }
    times, begins, places = history.events
    variables = {
        "x": history.x,
        "v": history.v,
        "z": history.z,
        "friction": history.friction,
        "phase": history.phase,
        "event_tau": times,
        "event_phase": begins.astype(np.int8),
        "event_z": places,
    }
    dofs = np.arange(1, system.n + 1)
    ds = xr.Dataset(
        {name: label_variable(name, values) for name, values in variables.items()},
        coords={"tau": coordinate("tau", history.tau), "dof": coordinate("dof", dofs)},
    )
    ds = ds.assign({name: v[0, 0] for name, v in boundary_variables(cells.curves).items()})
    ds = ds.assign(
        {name: label_variable(name, CELL_VARIABLES[name].dtype(value)) for name, value in summary.items()}
    )
    ds = ds.assign(_further(question, [name for name in solver.outputs if name not in ds]))
    cell = {"r": r, "beta": beta, "mu": mu}
    ds = ds.assign_coords({name: coordinate(name, value) for name, value in cell.items()})
    return stamp(ds, "response", "Steady state in time", system, cell, solver)
