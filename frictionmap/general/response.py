"""One steady state of a general system in time, as labelled variables."""

from collections.abc import Collection
from typing import Any

import numpy as np
import xarray as xr

from .. import regimes
from .._kernels.general.problem import SECTION
from ..datasets.labels import CONTACT_TRACES, EXCERPT, LABELS, OLDER_NAMES, PER_CONTACT
from ..datasets.variables import coordinate, label_variable, mass_coordinates
from ..model.general import ContactSystem
from ..model.settings import HARMONICS, RECORDED, Solver
from ..model.system import System
from .boundaries import Boundaries, find_boundaries
from .cycle import cycle_values
from .dataset import (
    boundary_variables,
    contact_coordinates,
    refuse_static,
    segments_of,
)
from .loops import undetermined_forces
from .observed import wants_further
from .outputs import OF_STARTS, TABLE, is_wanted, output_values
from .problem import general_of, static_offset
from .slopes import one_way_speed
from .steps import Steps, steps_of
from .still import still_masses


def _traces(system: System, steps: Steps, tau: np.ndarray) -> dict[str, np.ndarray]:
    """Motion of masses and contacts over tau, and the forces in the contacts."""
    general = general_of(system)
    offset_z, offset_x = static_offset(system)
    x, v = steps.displacements(tau), steps.displacements(tau, 1)
    g = steps.at("z", tau)
    z = (g if general.points is None else _relative(general, x, tau)) + offset_z[:, np.newaxis]
    friction = steps.at("f", tau)
    k, _ = steps.places(tau)
    sums = {}
    if general.loop:
        sums["friction_on_mass"] = -general.vectors.T @ friction
        friction = np.where(undetermined_forces(general.vectors.T, steps.senses == 0)[k].T, np.nan, friction)
    found = {
        "x": x + offset_x[:, np.newaxis],
        "v": v,
        "z": z,
        "friction": friction,
        "direction": steps.senses[k].T.astype(np.int8),
    }
    found |= sums
    if system.load is None and not general.base:
        found["load"] = load_over(general, tau)
    kt = steps.problem.spring[:, np.newaxis]
    if kt.any():
        belt = steps.problem.belt[:, np.newaxis] * tau
        y = g + offset_z[:, np.newaxis] - friction / np.where(kt > 0.0, kt, 1.0)
        found["y"] = np.where(kt > 0.0, y, np.nan) - belt
    return found


def _relative(general: ContactSystem, x: np.ndarray, tau: np.ndarray) -> np.ndarray:
    """Displacements in the contacts over tau, relative to their walls, by those of points (p, T), (N, T)."""
    assert general.points is not None
    base = sum(((u * np.exp(1j * n * tau)).real for n, u in general.base.items()), np.zeros_like(tau))
    return np.asarray(general.points.vectors @ x - np.multiply.outer(general.joined, base))


def load_over(general: ContactSystem, tau: np.ndarray) -> np.ndarray:
    """Load over tau: the sum of those on all masses."""
    phasors = {n: complex(vector.sum()) for n, vector in general.loads.items()}
    return sum((p * np.exp(1j * n * tau)).real for n, p in phasors.items()) + np.zeros_like(tau)


def _events(system: System, steps: Steps) -> dict[str, np.ndarray]:
    """Where a contact begins to slide or to stop, in order of time."""
    changed = steps.senses != np.roll(steps.senses, 1, axis=0)
    k, j = np.nonzero(changed)
    tau = steps.begins[k] + SECTION - steps.lead
    if steps.period:
        tau = np.mod(tau, 2.0 * np.pi * steps.period)
    order = np.argsort(tau, kind="stable")
    order = order[(tau[order] >= 0.0) & (tau[order] <= 2.0 * np.pi * steps.shown)]
    k, j, tau = k[order], j[order], tau[order]
    z = steps.series[:, steps.rows("z"), 0]
    found: dict[str, np.ndarray] = {
        "event_tau": tau,
        "event_direction": steps.senses[k, j].astype(np.int8),
        "event_z": z[k, j],
    }
    if steps.contacts > 1:
        found["event_contact"] = j + 1
    return found


def scalars(system: System, steps: Steps, further: Collection[str] = ()) -> dict[str, np.ndarray]:
    """Numbers of a steady state: of all, (), of each contact, (N,), of each mass, (n,).

    further : names of those among `RECORDED` that are wanted
    """
    names = [name for name in TABLE if (name not in RECORDED or name in further) and name != OF_STARTS]
    return {name: output_values(name, system, steps.cells)[0, 0, 0] for name in names}


def of_cell(name: str, values: np.ndarray, contacts: int, what: str = "") -> xr.Variable:
    """Label numbers of one cell; those of each contact have its dimension where there are several."""
    values = values.astype(LABELS[name].dtype, copy=False) if name in LABELS else values
    if name not in PER_CONTACT:
        return label_variable(name, values, what)
    one = label_variable(name, values[0], what)
    return one if contacts == 1 else xr.Variable(("contact", *one.dims), values, one.attrs)


def contact_trace(name: str, values: np.ndarray, contacts: int) -> xr.Variable:
    """Label values (N, T) over time; one contact has no dimension of its own."""
    if contacts == 1:
        return label_variable(name, values[0])
    return xr.Variable(("contact", "tau"), values, label_variable(name, values[0]).attrs)


def general_response(
    system: System, r: float, beta: float, mu: float, solver: Solver, points: int
) -> tuple[xr.Dataset, Boundaries]:
    """Compute one steady state of a general system in time, see `response`, and the boundaries there.

    An irregular motion has the comment on it among its attributes.
    """
    general = general_of(system)
    refuse_static(general, np.array([mu]))
    steps = steps_of(system, r, beta, mu, solver, wants_further(system, solver.outputs))
    tau = np.linspace(0.0, 2.0 * np.pi * steps.shown, points * steps.shown + 1)
    traces, found = _traces(system, steps, tau), scalars(system, steps, solver.outputs)
    count = general.count
    rests = found["contact_regime"] == regimes.PERMANENT_STICKING
    for i in np.flatnonzero(still_masses(general, rests)):
        traces["x"][i], traces["v"][i] = found["midpoint"][i], 0.0
    variables: dict[str, xr.Variable] = {}
    for name, values in traces.items():
        if name in CONTACT_TRACES:
            variables[name] = contact_trace(name, values, count)
        else:
            variables[name] = label_variable(name, values)
    events = _events(system, steps)
    variables |= {name: label_variable(name, values) for name, values in events.items()}
    for old, new in OLDER_NAMES["response"].items():
        variables[old] = variables[new].copy(deep=False)
    found |= cycle_values(system, steps, HARMONICS)
    for name, values in found.items():
        if is_wanted(name, general):
            variables[name] = of_cell(name, values, count, "response")
    limits = find_boundaries(system, np.array([r]), np.array([mu]))
    variables |= {
        name: v[0, 0] for name, v in boundary_variables(system, limits).items() if v.dims[0] == "mu"
    }
    if general.has_law and count == 1 and general.groups[0].first.belt:
        speed = np.array(one_way_speed(system, r, beta))
        variables["wall_speed_lim"] = label_variable("wall_speed_lim", speed)
    own: dict[str, Any] = {
        "tau": tau,
        "harmonic": np.arange(HARMONICS + 1),
        "part": np.array(["real", "imaginary"]),
        "r": r,
        "beta": beta,
        "mu": mu,
    }
    if general.has_law:
        own["segment"] = segments_of(general)
    coords = {name: coordinate(name, values) for name, values in own.items()}
    coords |= mass_coordinates(system)
    ds = xr.Dataset(variables, coords=coords | contact_coordinates(system))
    if not steps.period:
        followed = int(np.ceil(steps.cycles))
        ds.attrs["comment"] = EXCERPT.format(shown=steps.shown, followed=followed)
    return ds, limits
