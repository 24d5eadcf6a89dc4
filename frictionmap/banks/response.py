"""One steady motion in time, as labelled variables."""

from typing import Any

import numpy as np
import xarray as xr

from ..datasets.labels import CONTACT_TRACES, LABELS, OLDER_NAMES
from ..datasets.variables import coordinate, label_variable
from ..general.dataset import contact_coordinates, refuse_static
from ..general.response import contact_trace, load_over, of_cell
from ..model.settings import HARMONICS, Solver
from ..model.system import System
from ..phases.cycle import SECTION, cycle_values
from ..phases.dataset import has_output
from .cycle import BankCycle, find_cycle
from .dataset import TABLE, limit_variables
from .given import check_ratios
from .motion import at_times


def _base_motion(cycle: BankCycle, tau: np.ndarray) -> np.ndarray:
    """Displacement of the base."""
    base = cycle.system.at_frequency(cycle.r).contact_system.base
    return np.sum([(one * np.exp(1j * n * tau)).real for n, one in base.items()], axis=0) + 0.0 * tau


def _displacements(cycle: BankCycle, q: np.ndarray, tau: np.ndarray) -> np.ndarray:
    """Displacements in the contacts, (N, T)."""
    problem = cycle.found.problem
    return np.asarray(problem.chi @ q - problem.moved[:, np.newaxis] * _base_motion(cycle, tau))


def _traces(cycle: BankCycle, tau: np.ndarray) -> dict[str, np.ndarray]:
    """Motion of masses and contacts, and the forces, over tau; a contact is held while no element slips."""
    steps, phi = cycle.steps, cycle.modal.phi
    found, general = at_times(steps, cycle.modal.squares.size, tau), cycle.system.contact_system
    slips = steps.level[found.step].T > 0
    traces = {
        "x": phi @ found.q, "v": phi @ found.rate, "z": _displacements(cycle, found.q, tau),
        "friction": found.friction,
        "direction": np.where(slips, steps.sense[found.step].T, 0).astype(np.int8),
    }  # fmt: skip
    if cycle.system.load is None and not general.base:
        traces["load"] = load_over(general, tau)
    return traces


def _events(cycle: BankCycle) -> dict[str, np.ndarray]:
    """Where a contact begins to slip, and where it turns, from tau = 0 on."""
    steps = cycle.steps
    state = np.where(steps.level > 0, steps.sense, 0)
    k, j = np.nonzero(state != np.roll(state, 1, axis=0))
    tau = np.mod(steps.begins[k] + SECTION, 2.0 * np.pi)
    order = np.argsort(tau, kind="stable")
    tau, k, j = tau[order], k[order], j[order]
    q = at_times(steps, cycle.modal.squares.size, tau).q
    values: dict[str, np.ndarray] = {
        "event_tau": tau,
        "event_direction": state[k, j].astype(np.int8),
        "event_z": _displacements(cycle, q, tau)[j, np.arange(j.size)],
    }
    if state.shape[1] > 1:
        values["event_contact"] = j + 1
    return values


def bank_response(
    system: System, r: float, beta: float, mu: float, solver: Solver, points: int
) -> xr.Dataset:
    """Compute one steady motion in time; see `response`."""
    general = system.contact_system
    refuse_static(general, np.array([mu]))
    check_ratios(system, np.array([r]))
    cycle = find_cycle(system, r, beta, solver)
    tau = np.linspace(0.0, 2.0 * np.pi, points + 1)
    variables = {
        name: contact_trace(name, values, general.count)
        if name in CONTACT_TRACES
        else label_variable(name, values)
        for name, values in _traces(cycle, tau).items()
    }
    variables |= {name: label_variable(name, one) for name, one in _events(cycle).items()}
    for old, new in OLDER_NAMES["response"].items():
        variables[old] = variables[new].copy(deep=False)
    numbers = {name: cycle.found.numbers[name] for name in TABLE if has_output(name, general)}
    for name, values in (numbers | cycle_values(cycle, HARMONICS)).items():  # type: ignore[arg-type]
        variables[name] = of_cell(
            name, np.asarray(values).astype(LABELS[name].dtype), general.count, "response"
        )
    variables |= {name: one.squeeze() for name, one in limit_variables(system, np.array([r])).items()}
    own: dict[str, Any] = {
        "tau": tau, "dof": np.array(system.dofs.numbers), "harmonic": np.arange(HARMONICS + 1),
        "part": np.array(["real", "imaginary"]), "r": r, "beta": beta, "mu": mu,
    }  # fmt: skip
    coords = {name: coordinate(name, values) for name, values in own.items()}
    return xr.Dataset(variables, coords=coords | contact_coordinates(system))
