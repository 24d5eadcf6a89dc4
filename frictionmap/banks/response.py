"""One steady motion in time, as labelled variables."""

import numpy as np
import xarray as xr

from ..datasets.variables import label_variable
from ..general.dataset import refuse_static
from ..general.response import load_over
from ..model.settings import Solver
from ..model.system import System
from ..phases.cycle import SECTION, in_contacts
from ..phases.response import motion_dataset
from .cycle import BankCycle, find_cycle, stretch_at_maximum
from .dataset import TABLE, limit_variables
from .given import check_ratios
from .motion import at_times


def _traces(cycle: BankCycle, tau: np.ndarray) -> dict[str, np.ndarray]:
    """Motion of masses and contacts, and the forces, over tau; a contact is held while no element slips."""
    steps, phi = cycle.steps, cycle.shapes
    found, general = at_times(steps, cycle.modal.squares.size, tau), cycle.system.contact_system
    slips = steps.level[found.step].T > 0
    traces = {
        "x": phi @ found.q, "v": phi @ found.rate,
        "z": in_contacts(cycle, cycle.found.problem.chi @ found.q, tau),
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
        "event_z": in_contacts(cycle, cycle.found.problem.chi @ q, tau)[j, np.arange(j.size)],
    }
    if state.shape[1] > 1:
        values["event_contact"] = j + 1
    return values


def bank_response(
    system: System, r: float, beta: float, mu: float, solver: Solver, points: int
) -> xr.Dataset:
    """Compute one steady motion in time; see `response`."""
    refuse_static(system.contact_system, np.array([mu]))
    check_ratios(system, np.array([r]))
    cycle = find_cycle(system, r, beta, solver)
    tau = np.linspace(0.0, 2.0 * np.pi, points + 1)
    limits = limit_variables(system, np.array([r]))
    ds = motion_dataset(cycle, beta, mu, tau, _traces(cycle, tau), _events(cycle), limits, TABLE)
    ds["elongation"] = label_variable("elongation", stretch_at_maximum(cycle, beta))
    return ds
