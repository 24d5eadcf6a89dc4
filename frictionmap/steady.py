"""One steady state in time: motion of the mass and of the contact, friction force, starts and stops."""

import math

import numpy as np
import xarray as xr

from . import checks, regimes
from ._kernels.continuous import Oscillator
from ._kernels.cycle import Limits
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
from .curves import OneMass, boundary_variables, one_mass_curves
from .errors import InputError, NoSteadyState
from .labels import CELL_VARIABLES, coordinate, label_variable, stamp
from .maps import one_mass, plan
from .settings import Solver
from .system import System

#: Samples of a time history per excitation period.
POINTS = 2000

_TURN = 2.0 * math.pi


def _slides(
    found: OneMass, beta: float, mu: float, solver: Solver, zeta: float
) -> tuple[Step, float, np.ndarray, float]:
    """(step, b, rows, rest): the slides of the steady state over one period; none where stuck at `rest`."""
    f = found.frequencies
    work = plan(found, np.array([mu]), np.array([beta]), solver)
    r, load, phase = f.r[0], f.load[0], f.phase[0]
    if r == 0.0:
        raise InputError("r must be > 0: at r = 0 there is no motion in time; got 0")
    step = step_constants(r, zeta, float(solver.steps))
    oscillator = Oscillator(r, zeta, f.v_abs[0], f.v_arg[0], f.u[0], f.g[0])
    b, mu_b = normalised_friction(beta, load, mu, found.curves.beta_stick[0, 0])
    scratch = np.empty(MAX_TERMS)
    rest = 0.0
    rows = np.empty((0, COLUMNS))
    if work.cells:
        limits = Limits(float(solver.cycles), solver.tolerance, solver.steady == "solved")
        cell = integrate_one(
            beta, mu, found.lim[0, 0], found.curves.beta_stick[0, 0], load, phase, oscillator, step,
            step_constants(r, zeta, max(float(solver.steps), FINE_STEPS)), limits, solver.start == "moving",
        )  # fmt: skip
        if cell.period == 0:
            status = next(code for code in regimes.STATUSES if code.value == cell.status)
            raise NoSteadyState(f"r = {r:g}, beta = {beta:g}, mu = {mu:g}: {status.meaning}")
        regime, rest = cell.regime, cell.sign * cell.z
        rows = np.empty((cell.events, COLUMNS))
    else:
        regime = regimes.CONTINUOUS if work.low[0] else regimes.PERMANENT_STICKING
    if regime == regimes.PERMANENT_STICKING:
        return step, b, rows, rest
    if rows.size:
        orbit_slides(step, r, b, mu_b, cell.z, cell.cos, cell.sin, cell.sign, rows, scratch)
    elif math.isinf(oscillator.v_abs):
        raise NoSteadyState(
            f"r = {r:g}, beta = {beta:g}: an undamped resonance; the motion grows without bound"
        )
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


def response(
    system: System,
    r: float,
    beta: float,
    mu: float = 1.0,
    *,
    solver: Solver | None = None,
    points: int = POINTS,
    **settings: object,
) -> xr.Dataset:
    """One steady state in time.

    Parameters
    ----------
    system : System
    r, beta, mu : float
        Frequency ratio (> 0), friction ratio (>= 0), static over kinetic friction (>= 1) [-].
    solver : Solver, optional
        Settings; or give them one by one as keywords.
    points : int
        Samples per excitation period.

    Returns
    -------
    xarray.Dataset
        Over `tau` (0 to 2 pi times the period): `x(dof, tau)`, `v(dof, tau)`, `z`, `friction` (over P)
        and `phase` (-1, 0, 1).  Over `event`: `event_tau`, `event_phase` (the phase that begins) and
        `event_z`.  Scalars: `regime`, `stops_per_cycle`, `contact_amplitude`, `stuck_fraction`, `period`
        and the boundaries.  tau = 0 is a maximum of the load (of the base's displacement).

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
    solver = solver or Solver(**settings)  # type: ignore[arg-type]
    r = checks.number(r, "r", least=0.0, most=checks.LARGEST_RATIO)
    beta = checks.number(beta, "beta", least=0.0)
    mu = checks.number(mu, "mu", least=1.0)
    checks.whole(points, "points", least=2)
    one_mass(system)
    found = one_mass_curves(system, np.array([r]), np.array([mu]))
    load, lead = found.frequencies.load[0], found.frequencies.phase[0]
    step, b, rows, rest = _slides(found, beta, mu, solver, system.zeta)

    durations = rows[:, LENGTH] + rows[:, WAIT]
    total = float(durations.sum())
    period = max(1, round(total / _TURN))
    tau = np.linspace(0.0, _TURN * period, points * period + 1)
    z = np.full(tau.size, rest)
    v = np.zeros(tau.size)
    friction = np.cos(tau + lead) - rest
    phase = np.zeros(tau.size, dtype=np.int8)
    event_tau, event_phase, event_z = np.empty((3, 0))
    if rows.size:
        begin = np.concatenate(([0.0], np.cumsum(durations)[:-1]))
        start = math.atan2(rows[0, SIGN] * rows[0, SIN], rows[0, SIGN] * rows[0, COS]) - lead
        since = np.mod(tau - start, total)
        since[since > total * (1.0 - 1e-15)] = 0.0  # rounding must not place a sample past the end
        order = np.argsort(since, kind="stable")
        places, speeds, forces = np.empty((3, tau.size))
        senses = np.empty(tau.size, dtype=np.int8)
        sample_slides(step, b, rows, since[order], places, speeds, forces, senses, np.empty(MAX_TERMS))
        z[order], v[order], friction[order] = places, speeds, forces
        phase[order] = senses
        event_tau, event_phase, event_z = _events(rows, begin)
        event_tau = np.mod(event_tau + start, total)
        order = np.argsort(event_tau, kind="stable")
        event_tau, event_phase, event_z = event_tau[order], event_phase[order], event_z[order]

    stuck = rows[:, WAIT][rows[:, WAIT] > SHORTEST_STOP]
    summary = {
        "regime": regimes.STICK_SLIP if stuck.size else regimes.CONTINUOUS,
        "stops_per_cycle": stuck.size / period,
        "contact_amplitude": load * np.abs(rows[:, Z_END]).max(initial=0.0),
        "stuck_fraction": stuck.sum() / total if rows.size else 1.0,
        "period": period,
    }
    if not rows.size:
        summary |= {"regime": regimes.PERMANENT_STICKING, "stops_per_cycle": math.nan}

    base = system.base_motion
    z, v, friction = load * z, load * v, load * friction
    variables = {
        "x": (("dof", "tau"), (z + base * np.cos(tau))[np.newaxis]),
        "v": (("dof", "tau"), (v - base * np.sin(tau))[np.newaxis]),
        "z": (("tau",), z),
        "friction": (("tau",), friction),
        "phase": (("tau",), phase),
        "event_tau": (("event",), event_tau),
        "event_phase": (("event",), event_phase.astype(np.int8)),
        "event_z": (("event",), load * event_z),
    }
    ds = xr.Dataset(
        {name: label_variable(name, dims, values) for name, (dims, values) in variables.items()},
        coords={"tau": coordinate("tau", tau), "dof": coordinate("dof", np.arange(1, 2))},
    )
    ds = ds.assign({name: v[0, 0] for name, v in boundary_variables(found.curves).items()})
    ds = ds.assign(
        {name: label_variable(name, (), CELL_VARIABLES[name].dtype(value)) for name, value in summary.items()}
    )
    cell = {"r": r, "beta": beta, "mu": mu}
    ds = ds.assign_coords({name: coordinate(name, value) for name, value in cell.items()})
    return stamp(ds, "Steady state in time", system)
