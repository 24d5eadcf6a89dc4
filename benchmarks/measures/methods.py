"""All methods for steady states with one interface: cells in; stops, amplitude and stop times out.

A method is prepared for a scene and a setting. Only `solve` is timed; `read` converts its return value to
results. All except "frictionmap" march the same number of excitation periods from rest and report the last.
"frictionmap" is timed without the stop times, which `response` provides.
"""

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

import frictionmap as fm
from frictionmap._kernels.engine.one_mass import OneMassSystem
from frictionmap._kernels.event_codes import REVERSE, STOP_THEN_BACK, STOP_THEN_ON
from frictionmap._kernels.one_mass import events
from frictionmap._kernels.one_mass.scan_step import step_constants
from frictionmap._kernels.structure.events import after_slide, slide_on
from frictionmap._kernels.structure.oscillators import make_scratch, make_state
from frictionmap._kernels.structure.state import contact_displacement, make_structure
from frictionmap._kernels.taylor_series import MAX_TERMS
from frictionmap.model.settings import Solver
from frictionmap.single.cells import Cells

from ..peers import cvode, heyoka, solve_ivp
from ..peers.body import SHORTEST_STOP, TWO_PI, Body, Cell
from ..peers.fixed_step import (
    MOST_STOPS,
    Problem,
    march_moreau,
    march_rk4,
    moreau_inverse,
    problem,
)
from ..peers.peer import Peer
from .own_entry import own_entry
from .own_kernel import cells_by_kernel

#: Each cell is solved so often in one timed call of ours: a call costs as much as a cell.
COPIES = 40


class Scene(NamedTuple):
    """Ranges in which random cells are drawn."""

    name: str
    contact: str
    masses: int
    frequencies: tuple[float, float]
    mu: float
    zeta: float

    @property
    def body(self) -> Body:
        """The structure as other solvers define it: contact on mass 2 of several, load on mass 1."""
        return Body(self.masses, min(2, self.masses), 1, self.zeta, self.contact)

    @property
    def system(self) -> fm.System:
        """The structure as the package defines it."""
        if self.masses == 1:
            return fm.System(contact=self.contact, damping_ratios=self.zeta)
        ones = [1.0] * self.masses
        return fm.System(
            contact_masses=[self.body.contact], load_mass=self.body.load, mass_ratios=ones,
            stiffness_ratios=ones, damping_ratios=self.zeta,
        )  # fmt: skip

    def problem(self, r: float, beta: float) -> Problem:
        """One of its cells, as the baselines define it."""
        return problem(self.body, Cell(r, beta, self.mu))


class Answer(NamedTuple):
    """Results of the last period; `begins` are the tau in [0, 2 pi) at which stops begin."""

    stops: float
    amplitude: float
    begins: list[float]


FAILED = Answer(math.nan, math.nan, [])

#: (solve, read, cells that one call solves)
Prepared = tuple[Callable[[], object], Callable[[object], list[Answer]], int]


class Method(NamedTuple):
    """A method for steady states, with a setting that trades time for accuracy."""

    name: str
    setting: str  # what is varied
    settings: Sequence[float]
    quick: Sequence[float]
    slow: bool  # few repeats
    prepare: Callable[[Scene, list[tuple[float, float]], float, int], Prepared]
    why_not: Callable[[Scene], str]


# ---------------------------------------------------------------- ours


def _sorted_copies(cells: list[tuple[float, float]]) -> tuple[np.ndarray, np.ndarray]:
    """r and beta of every cell COPIES times; the kernels take them in this order."""
    r, beta = np.array(cells).T
    return np.repeat(r, COPIES), np.repeat(beta, COPIES)


def open_cells(
    system: fm.System, r: np.ndarray, beta: np.ndarray, mu: float, solver: Solver
) -> tuple[Callable[[], object], Callable[[], list[np.ndarray]]]:
    """(solve, read) for cells (r_k, beta_k) by the kernel of maps; read gives stops, Z, perhaps status."""
    solve, out = cells_by_kernel(system, r, beta, mu, solver)
    each = np.arange(r.size)

    def read() -> list[np.ndarray]:
        kept = (out.stops_per_cycle, out.contact_amplitude, out.status)
        return [values[0, each, each] for values in kept if values.size]

    return solve, read


def _stop_times(scene: Scene, r: float, beta: float, steps: int) -> list[float]:
    """Start times of the stops of the steady state, also of one with a longer period."""
    ds = fm.response(scene.system, r, beta, scene.mu, steps=steps, points=2)
    return sorted((ds.event_tau.values[ds.event_direction.values == 0] % TWO_PI).tolist())


def prepare_solved(scene: Scene, cells: list[tuple[float, float]], setting: float, cycles: int) -> Prepared:
    """Prepare the package with its default method, for a number of scan steps."""
    solve, values = open_cells(scene.system, *_sorted_copies(cells), scene.mu, Solver(steps=int(setting)))

    def read(_result: object) -> list[Answer]:
        stops, amplitudes = (column[::COPIES] for column in values()[:2])
        return [
            Answer(float(s), float(z), _stop_times(scene, *cell, int(setting)))
            for s, z, cell in zip(stops, amplitudes, cells, strict=True)
        ]

    return solve, read, COPIES * len(cells)


@own_entry
def _march_one_mass(r, beta, zeta, load, phase, mu, steps, cycles, out, begins):
    """Integrator of one mass alone, from rest; out (cells, 2): stops, Z; begins (cells, MOST_STOPS)."""
    work = np.empty(MAX_TERMS)
    for k in range(r.size):
        step = step_constants(r[k], zeta, steps)
        b = beta[k] / load[k]
        mu_b = mu * b
        c, s = math.cos(phase[k]), math.sin(phase[k])
        code, z, c, s, force, wait = events.after_slide(b, mu_b, 0.0, c, s)
        sign = -1.0 if code in (REVERSE, STOP_THEN_BACK) else 1.0
        tau = wait
        window = TWO_PI * (cycles - 1)
        stops = 0
        peak = 0.0
        while tau < window + TWO_PI:
            n, z, c, s = events.slide(step, b, z, 0.0, step.stiffness * force, c, s, 1e9, work)
            tau += n * step.h
            inside = window <= tau < window + TWO_PI
            began = math.atan2(sign * s, sign * c) - phase[k]
            if inside:
                peak = max(peak, abs(z))
            code, z, c, s, force, wait = events.after_slide(b, mu_b, z, c, s)
            if inside and wait > SHORTEST_STOP:
                begins[k, stops] = began % TWO_PI
                stops += 1
            tau += wait
            if code in (REVERSE, STOP_THEN_BACK):
                sign = -sign
        out[k, 0] = stops
        out[k, 1] = peak * load[k]


@own_entry
def _march_structure(model, loads, r, beta, mu, steps, cycles, out, begins):
    """Integrator of structures alone, from rest; arguments as in `_march_one_mass`."""
    n = model.modes.shape[1]
    state, held, scratch = make_state(n), make_state(n - 1), make_scratch(n)
    for k in range(r.size):
        st = make_structure(model, loads, k, r[k], steps)
        state[:] = 0.0
        mu_beta = mu * beta[k]
        code, c, s, force, wait, _, _ = after_slide(st, beta[k], mu_beta, state, held, 1.0, 0.0, 1e6, scratch)
        sign = -1.0 if code in (REVERSE, STOP_THEN_BACK) else 1.0
        tau = wait
        window = TWO_PI * (cycles - 1)
        stops = 0
        peak = 0.0
        while tau < window + TWO_PI:
            steps_done, _, c, s, _ = slide_on(st, beta[k], force, state, c, s, 1e9, scratch)
            tau += steps_done * st.h
            inside = window <= tau < window + TWO_PI
            began = math.atan2(sign * s, sign * c)
            if inside:
                peak = max(peak, abs(contact_displacement(st, state, c, s)))
            code, c, s, force, wait, _, _ = after_slide(
                st, beta[k], mu_beta, state, held, c, s, 1e6, scratch
            )  # fmt: skip
            stopped = code in (STOP_THEN_BACK, STOP_THEN_ON)
            if inside and stopped and wait > SHORTEST_STOP:
                begins[k, stops] = began % TWO_PI
                stops += 1
            tau += wait
            if code in (REVERSE, STOP_THEN_BACK):
                sign = -sign
        out[k, 0] = stops
        out[k, 1] = peak


def prepare_marched(scene: Scene, cells: list[tuple[float, float]], setting: float, cycles: int) -> Prepared:
    """Prepare the exact fixed-step integrator alone, for the same number of periods as the other solvers."""
    r, beta = np.array(cells).T
    found = Cells(scene.system, r, beta, np.array([scene.mu]), Solver())
    out, begins = np.empty((r.size, 2)), np.empty((r.size, MOST_STOPS))
    if isinstance(found.motion, OneMassSystem):
        f = found.motion.frequencies
        arguments = (
            r, beta, scene.zeta, f.load, f.phase, scene.mu, float(setting), cycles, out, begins
        )  # fmt: skip
        function = _march_one_mass
    else:
        arguments = (
            found.motion.model, found.motion.loads, r, beta, scene.mu, float(setting), cycles, out, begins
        )  # fmt: skip
        function = _march_structure

    def read(_result: object) -> list[Answer]:
        return [
            Answer(stops, z, sorted(times[: int(stops)].tolist()))
            for (stops, z), times in zip(out.tolist(), begins, strict=True)
        ]

    return lambda: function(*arguments), read, r.size


# ---------------------------------------------------------------- fixed-step baselines


def _within(times: np.ndarray) -> list[float]:
    """Sort angles and reduce them to [0, 2 pi)."""
    return sorted(np.mod(times, TWO_PI).tolist())


def prepare_rk4(located: bool) -> Callable[..., Prepared]:
    """Prepare RK4, with or without located events."""

    def prepare(scene: Scene, cells: list[tuple[float, float]], setting: float, cycles: int) -> Prepared:
        problems = [scene.problem(*cell) for cell in cells]
        march_rk4(problems[0], 16, 1, located)  # compiles

        def read(found: object) -> list[Answer]:
            return [Answer(m.stops, m.peak, _within(m.begins[: m.stops])) for m in found]

        return lambda: [march_rk4(p, int(setting), cycles, located) for p in problems], read, len(cells)

    return prepare


def prepare_moreau(scene: Scene, cells: list[tuple[float, float]], setting: float, cycles: int) -> Prepared:
    """Prepare Moreau-Jean time stepping."""
    problems = [scene.problem(*cell) for cell in cells]
    march_moreau(problems[0], moreau_inverse(problems[0], 16), 16, 1)  # compiles
    steps = int(setting)

    def read(found: object) -> list[Answer]:
        return [Answer(stops, peak, _within(begins[:stops])) for stops, peak, begins in found]

    return (
        lambda: [march_moreau(p, moreau_inverse(p, steps), steps, cycles) for p in problems],
        read,
        len(cells),
    )


# ---------------------------------------------------------------- general-purpose solvers


def _run(peer: Peer, cell: Cell, cycles: int) -> Answer:
    begins: list[float] = []
    try:
        outcome = peer.run(cell, cycles, begins=begins)
    except RuntimeError:
        return FAILED
    return Answer(outcome.stops, outcome.Z, _within(np.array(begins)))


def prepare_peer(make: Callable[..., Peer], settings: Callable[[float], dict]) -> Callable[..., Prepared]:
    """Prepare another solver for a body; `settings` translates the setting of the method."""

    def prepare(scene: Scene, cells: list[tuple[float, float]], setting: float, cycles: int) -> Prepared:
        peer = make(scene.body, **settings(setting))
        of_peer = [Cell(*cell, scene.mu) for cell in cells]
        return lambda: [_run(peer, cell, cycles) for cell in of_peer], lambda found: found, len(cells)

    return prepare


def _tolerances(relative: float) -> dict:
    return {"rtol": relative, "atol": absolute(relative)}


def absolute(tolerance: float) -> float:
    """Absolute tolerance that belongs to a relative one: displacements are about 1."""
    return max(1e-3 * tolerance, 1e-14)


def _always(_scene: Scene) -> str:
    return ""


def _one_friction_coefficient(scene: Scene) -> str:
    return "" if scene.mu == 1.0 else "it has no separate static friction (mu = 1 only)"


STEPS = (2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 100, 200)
_NODES = (16, 32, 64, 128, 256, 512, 1024, 2048, 4096, 10_000)
_FEW_NODES = (32, 256, 2048)
_TOLERANCES = (1e-3, 1e-6, 1e-9, 1e-12)
_FEW = (1e-6,)
_EPS = float(np.finfo(float).eps)

SOLVED = "frictionmap"
MARCHED = "frictionmap, marched"

METHODS = (
    Method(SOLVED, "steps", STEPS, (2, 24, 200), False, prepare_solved, _always),
    Method(MARCHED, "steps", STEPS, (2, 24, 200), False, prepare_marched, _always),
    Method("RK4, events located", "steps a period", _NODES, _FEW_NODES, False, prepare_rk4(True), _always),
    Method("RK4", "steps a period", _NODES, _FEW_NODES, False, prepare_rk4(False), _always),
    Method(
        "Moreau-Jean", "steps a period", _NODES, _FEW_NODES, False, prepare_moreau,
        _one_friction_coefficient,
    ),
    Method(
        "solve_ivp DOP853", "rtol", _TOLERANCES, _FEW, True,
        prepare_peer(solve_ivp.peer, lambda t: {"method": "DOP853", **_tolerances(t)}),
        lambda _: solve_ivp.OneMassSolveIvp.why_missing(),
    ),
    Method(
        "heyoka", "tol", (*_TOLERANCES, _EPS), (1e-6, _EPS), False,
        prepare_peer(heyoka.peer, lambda t: {"tol": t}),
        lambda _: heyoka.OneMassHeyoka.why_missing(),
    ),
    Method(
        "CVODE", "rtol", _TOLERANCES, _FEW, True,
        prepare_peer(cvode.peer, _tolerances),
        lambda _: cvode.OneMassCvode.why_missing(),
    ),
)  # fmt: skip
