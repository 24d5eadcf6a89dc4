"""One steady motion in time, as labelled variables."""

from collections.abc import Iterable
from typing import Any

import numpy as np
import xarray as xr

from .._kernels.phases.problem import SECTION
from ..datasets.labels import CONTACT_TRACES, EXCERPT, LABELS, OLDER_NAMES
from ..datasets.variables import coordinate, label_variable, mass_coordinates
from ..errors import NoSteadyState
from ..general.dataset import contact_coordinates, refuse_static
from ..general.normal_limits import limit_variables
from ..general.response import contact_trace, load_over, of_cell
from ..model.settings import HARMONICS, Solver
from ..model.system import System
from .cycle import Cycle, cycle_values, in_contacts
from .dataset import has_output, impact_comment, spring_coordinates
from .given import check_ratios, phase_system
from .motion import at_times, events, in_time
from .quantities import TABLE
from .solve import find_motion
from .system import PhaseSystem

#: Periods of a motion that does not repeat that are shown.
_SHOWN = 8


def find_cycle(system: System, given: PhaseSystem, r: float, beta: float, mu: float, solver: Solver) -> Cycle:
    """Find one steady motion.

    Raises
    ------
    NoSteadyState
        None was found.
    """
    found = find_motion(given, r, beta, mu, solver.start, solver.cycles)
    if found.steps is None:
        raise NoSteadyState(
            f"r = {r:g}, beta = {beta:g}, mu = {mu:g}: no steady state was found in "
            f"{int(found.numbers['cycles'])} periods; raise solver.cycles"
        )
    return Cycle(system, r, found, found.steps)


def _shown(cycle: Cycle) -> tuple[int, float]:
    """Periods that are shown, and the phase at which they begin: the last ones of an irregular motion.

    Its record begins after a multiple of the period, at the section.
    """
    if cycle.period:
        return cycle.period, 0.0
    shown = max(1, min(_SHOWN, cycle.found.averaged - 1))
    return shown, 2.0 * np.pi * (cycle.found.averaged - shown)


def _belts(cycle: Cycle) -> np.ndarray:
    """Velocities of the walls over omega P/k_1, (N,)."""
    groups = cycle.system.contact_system.groups
    return np.array([one.first.wall_velocity + one.first.wall_speed / cycle.r for one in groups])


def senses_of(direction: np.ndarray, opened: np.ndarray, velocity: np.ndarray) -> np.ndarray:
    """Directions of the motion in the contacts; where one is open, that of its velocity."""
    return np.where(opened == 1, np.where(velocity < 0.0, -1, 1), direction).astype(np.int8)


def _traces(cycle: Cycle, given: PhaseSystem, tau: np.ndarray, begin: float) -> dict[str, np.ndarray]:
    """Motion of masses and contacts, and the forces, over tau."""
    found, general = cycle.found, cycle.system.contact_system
    traces = in_time(given, found.problem, found.modes, cycle.steps, found.preload, tau + begin)
    traces.pop("spring_displacement")
    belts = _belts(cycle)[:, np.newaxis]
    velocity = general.vectors @ traces["v"] - belts
    traces["direction"] = senses_of(traces["direction"], traces["open"], velocity)
    moving = np.array([group.normal is not None for group in general.groups])
    traces["normal_force"] = np.where(moving[:, np.newaxis], traces["normal_force"], np.nan)
    if "y" in traces:
        traces["y"] = traces["y"] - belts * tau
    if cycle.system.load is None and not general.base:
        traces["load"] = load_over(general, tau)
    if not general.springs:
        del traces["spring_force"]
    if not moving.any():
        del traces["normal_force"], traces["open"]
    return traces


def _events(cycle: Cycle, shown: int, begin: float) -> dict[str, np.ndarray]:
    """Where a contact slides, stops, opens or closes, in order of time."""
    found = events(cycle.steps)
    tau = found["event_tau"] - begin
    if cycle.period:
        tau = np.mod(tau, 2.0 * np.pi * cycle.period)
    order = np.argsort(tau, kind="stable")
    order = order[(tau[order] >= 0.0) & (tau[order] <= 2.0 * np.pi * shown)]
    contact, tau = found["event_contact"][order] - 1, tau[order]
    own, length = np.arange(tau.size), 2.0 * np.pi * cycle.found.averaged
    chi = cycle.found.problem.chi
    motion = at_times(cycle.steps, cycle.modal.squares.size, np.mod(tau + begin - SECTION, length))
    places = in_contacts(cycle, chi @ motion.q, tau + begin)
    velocity = in_contacts(cycle, chi @ motion.rate, tau + begin, 1)[contact, own] - _belts(cycle)[contact]
    opened = found["event_open"][order]
    values: dict[str, np.ndarray] = {
        "event_tau": tau,
        "event_direction": senses_of(found["event_direction"][order], opened, velocity),
        "event_z": places[contact, own],
    }
    general = cycle.system.contact_system
    if any(group.normal is not None for group in general.groups):
        values["event_open"] = opened
    if general.count > 1:
        values["event_contact"] = contact + 1
    return values


def motion_dataset(
    cycle: Cycle, beta: float, mu: float, tau: np.ndarray, traces: dict[str, np.ndarray],
    happened: dict[str, np.ndarray], limits: dict[str, xr.Variable], outputs: Iterable[str],
) -> xr.Dataset:  # fmt: skip
    """Label one steady motion: traces over tau, events, outputs and quantities of its cycle, boundaries."""
    system, general = cycle.system, cycle.system.contact_system
    variables: dict[str, xr.Variable] = {}
    for name, values in traces.items():
        is_of_contact = name in CONTACT_TRACES
        variables[name] = (
            contact_trace(name, values, general.count) if is_of_contact else label_variable(name, values)
        )
    variables |= {name: label_variable(name, one) for name, one in happened.items()}
    for old, new in OLDER_NAMES["response"].items():
        variables[old] = variables[new].copy(deep=False)
    numbers = {name: cycle.found.numbers[name] for name in outputs if has_output(name, general)}
    for name, values in (numbers | cycle_values(cycle, HARMONICS)).items():
        variables[name] = of_cell(
            name, np.asarray(values).astype(LABELS[name].dtype), general.count, "response"
        )
    variables |= {name: one.squeeze() for name, one in limits.items()}
    own: dict[str, Any] = {
        "tau": tau, "dof": np.array(system.dofs.numbers), "harmonic": np.arange(HARMONICS + 1),
        "part": np.array(["real", "imaginary"]), "r": cycle.r, "beta": beta, "mu": mu,
    }  # fmt: skip
    coords = {name: coordinate(name, values) for name, values in own.items()} | mass_coordinates(system)
    return xr.Dataset(variables, coords=coords | contact_coordinates(system) | spring_coordinates(system))


def phase_response(
    system: System, r: float, beta: float, mu: float, solver: Solver, points: int
) -> xr.Dataset:
    """Compute one steady motion in time; see `response`.

    An irregular motion has the comment on it among its attributes.
    """
    refuse_static(system.contact_system, np.array([mu]))
    check_ratios(system, np.array([r]))
    given = phase_system(system, r)
    cycle = find_cycle(system, given, r, beta, mu, solver)
    shown, begin = _shown(cycle)
    tau = np.linspace(0.0, 2.0 * np.pi * shown, points * shown + 1)
    traces, happened = _traces(cycle, given, tau, begin), _events(cycle, shown, begin)
    limits = limit_variables(system, np.array([r]), np.array([mu]))
    ds = motion_dataset(cycle, beta, mu, tau, traces, happened, limits, TABLE)
    comment = impact_comment(system, np.asarray(cycle.found.numbers["open_fraction"]))
    if not cycle.period:
        comment = EXCERPT.format(shown=shown, followed=int(cycle.found.numbers["cycles"]))
    return ds.assign_attrs(comment=comment) if comment else ds
