"""Maps and boundaries of general systems as labelled variables."""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace

import numpy as np
import xarray as xr

from .. import checks
from .._kernels.general.fill import NO_PLACES
from ..datasets.labels import LABELS, PER_CONTACT, attributes, with_contact
from ..datasets.variables import coordinate, label_variable, mass_coordinates
from ..errors import InputError
from ..jobs import Progress, Watch
from ..model.general import ContactSystem
from ..model.settings import Solver
from ..model.system import System
from .boundaries import Boundaries, find_boundaries
from .maps import solve_cells
from .observed import wants_further
from .outputs import COUNTERPARTS, OF_STARTS, TABLE, is_of_masses, is_wanted, output_values, wanted_places
from .problem import general_of

#: Outputs with a dimension that is empty where no contact has a friction law, or without springs.
_OF_PARTS = ("segment_fraction", "spring_crossings", "spring_force_max")


def chosen_outputs(
    general: ContactSystem, solver: Solver, table: Collection[str], is_wanted: Callable, what: str
) -> tuple[str, ...]:
    """The outputs of a map: those asked for, with their counterparts for elastic contacts.

    table : the outputs that are offered
    is_wanted : whether an output says something about a system
    what : the systems, for the message

    Raises
    ------
    InputError
        An output is not offered for such systems.
    """
    names: list[str] = []
    for name in solver.outputs:
        if name not in table:
            raise InputError(f"cannot compute {name} with {what}; valid outputs: {', '.join(table)}")
        counterpart = COUNTERPARTS.get(name, name)
        always = counterpart == name and name not in _OF_PARTS
        names += [one for one in (name, counterpart) if is_wanted(one, general) or always]
    if general.count > 1:
        names.append("contact_regime")
    return tuple(dict.fromkeys((*names, "status")))


def outputs_of(general: ContactSystem, solver: Solver) -> tuple[str, ...]:
    """The outputs of a map, see `chosen_outputs`."""
    what = "several contacts, springs, belts or loads of several harmonics"
    return chosen_outputs(general, solver, TABLE, is_wanted, what)


def contact_variable(name: str, values: np.ndarray, contacts: int) -> xr.Variable:
    """Label a variable with one value per contact, a dimension that one contact does without."""
    dims = with_contact(LABELS[name].dims)
    one = label_variable(name, np.ascontiguousarray(values.take(0, dims.index("contact"))))
    return one if contacts == 1 else xr.Variable(dims, values, one.attrs)


def boundary_variables(system: System, limits: Boundaries) -> dict[str, xr.Variable]:
    """Label the boundaries that a system has."""
    general = general_of(system)
    count = general.count
    if general.elastic.any():
        elastic = limits.beta_stick_contact[0][:, general.elastic]  # mu is 1 there
        none = {"beta_noslip": label_variable("beta_noslip", elastic.max(axis=1))}
        if general.elastic.all():
            return none
        return none | {"beta_stick": label_variable("beta_stick", limits.beta_stick)}
    if general.has_law or general.loop:
        return {"beta_stick": label_variable("beta_stick", limits.beta_stick)}
    found = {
        "beta_lim": limits.beta_lim,
        "beta_stick": limits.beta_stick,
        "no_stop_begin": limits.begins,
        "no_stop_end": limits.ends,
    }
    if np.isfinite(limits.wall_velocity_lim).any():
        found["wall_velocity_lim"] = limits.wall_velocity_lim
    variables = {name: label_variable(name, values) for name, values in found.items()}
    if count > 1:
        variables["beta_stick_contact"] = contact_variable(
            "beta_stick_contact", limits.beta_stick_contact, count
        )
    return variables


def segments_of(general: ContactSystem) -> np.ndarray:
    """Numbers of the segments of friction laws, counted from 1."""
    return np.arange(1, 1 + max(len(group.first.law.speed) for group in general.groups if group.first.law))


def contact_coordinates(system: System) -> dict[str, xr.Variable]:
    """Coordinates along the contacts, where there are several, and of the intervals without stops."""
    general = general_of(system)
    found = {}
    if general.count > 1:
        found["contact"] = coordinate("contact", np.arange(1, general.count + 1))
        names = np.array([group.name for group in general.groups])
        found["contact_name"] = xr.Variable(("contact",), names, {"long_name": "name of the contact"})
    return found


def cell_arrays(
    system: System, axes: Mapping[str, np.ndarray], names: Sequence[str], solver: Solver,
    threads: int | None, progress: Progress | None, watch: Watch | None, searched: bool = True,
) -> tuple[dict[str, np.ndarray], Boundaries]:  # fmt: skip
    """Outputs over the axes mu, r and beta, those of contacts (n_mu, n_r, n_beta, N), and the boundaries.

    searched : see `find_boundaries`
    """
    general = general_of(system)
    masses, further = any(is_of_masses(name) for name in names), wants_further(system, names)
    placed = wanted_places(names, general)
    threads = checks.threads(threads)
    limits = find_boundaries(system, axes["r"], axes["mu"], threads, watch, searched=searched)
    cells = solve_cells(
        system, axes, limits.beta_stick, solver, threads, progress, watch, masses, placed, further
    )
    found = {name: output_values(name, system, cells) for name in names}
    if OF_STARTS in names and not cells.unique.all():
        other = replace(solver, start="rest" if solver.start == "moving" else "moving")
        more = solve_cells(system, axes, limits.beta_stick, other, threads, None, watch, False, NO_PLACES)
        found[OF_STARTS] |= output_values(OF_STARTS, system, more)
    return found, limits


def general_map(
    system: System, axes: Mapping[str, np.ndarray], solver: Solver, threads: int | None,
    progress: Progress | None, watch: Watch | None,
) -> xr.Dataset:  # fmt: skip
    """Compute outputs, `status` and boundaries of a general system over the axes mu, r and beta."""
    general = general_of(system)
    refuse_static(general, axes["mu"])
    names = outputs_of(general, solver)
    found, limits = cell_arrays(system, axes, names, solver, threads, progress, watch)
    variables: dict[str, xr.Variable] = {}
    for name, values in found.items():
        if name in PER_CONTACT:
            variables[name] = contact_variable(name, values, general.count)
        else:
            variables[name] = label_variable(name, values)
    if any(group.first.belt for group in general.groups):
        label = LABELS["regime"]
        full = attributes(label._replace(codes=(*label.codes, *label.also)))
        for name in ("regime", "contact_regime"):
            if name in variables:
                variables[name].attrs = full | {"long_name": LABELS[name].long_name}
    coords = {name: coordinate(name, values) for name, values in axes.items()}
    if any(is_of_masses(name) for name in names):
        coords |= mass_coordinates(system)
    if "segment_fraction" in found:
        coords["segment"] = coordinate("segment", segments_of(general))
    return xr.Dataset(
        variables | boundary_variables(system, limits), coords=coords | contact_coordinates(system)
    )


def refuse_static(general: ContactSystem, mu: np.ndarray) -> None:
    """Refuse mu > 1 with elastic contacts alone."""
    if general.elastic.all() and (mu != 1.0).any():
        raise InputError(
            "mu",
            "must be 1 with contact_stiffness: the spring would jump at break-away; omit contact_stiffness, "
            f"or put a small mass between the spring and a rigid contact; got {mu.max():g}",
        )


def general_boundaries(system: System, r: np.ndarray, mu: np.ndarray) -> xr.Dataset:
    """Boundaries of a system with several contacts, springs, belts or harmonics."""
    from .limit_kinds import find_limits
    from .loops import loop_stick_scales
    from .slopes import slope_limits

    contacts = general_of(system)
    refuse_static(contacts, mu)
    axes = {"mu": mu, "r": r}
    coords = {name: coordinate(name, axis) for name, axis in axes.items()} | contact_coordinates(system)
    coords |= mass_coordinates(system)
    if contacts.loop:
        variables = {"beta_stick": label_variable("beta_stick", loop_stick_scales(system, r, mu))}
    else:
        limits = find_boundaries(system, r, mu)
        variables = boundary_variables(system, limits)
        if not contacts.elastic.any() and not contacts.has_law:
            ended = find_limits(system, r, limits)
            variables["limit_kind"] = label_variable("limit_kind", ended.kind)
            if contacts.count > 1:
                variables["limiting_contact"] = label_variable("limiting_contact", ended.contact)
    if contacts.has_law and contacts.count == 1:
        slopes = slope_limits(system)
        variables["beta_slope_lim"] = label_variable("beta_slope_lim", np.array(slopes.limit))
        variables["beta_slope_certificate"] = label_variable(
            "beta_slope_certificate", np.array(slopes.certificate)
        )
    return xr.Dataset(variables, coords=coords)
