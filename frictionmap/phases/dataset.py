"""Maps as labelled variables."""

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr

from .. import checks
from .._kernels.phases.problem import ELASTIC, RIGID
from ..datasets.labels import BESIDE, LABELS, PER_CONTACT, attributes
from ..datasets.variables import coordinate, label_variable, mass_coordinates
from ..general.dataset import (
    chosen_outputs,
    contact_coordinates,
    contact_variable,
    refuse_static,
)
from ..general.normal_limits import limit_variables
from ..general.outputs import is_of_masses
from ..jobs import Progress, Watch
from ..model.general import ContactSystem, MergedContact
from ..model.settings import Solver
from ..model.system import System
from .given import changes_with_r, check_ratios, phase_system
from .quantities import TABLE
from .solve import sweep_phases

#: Outputs that contacts of one kind have, a rigid or an elastic one.
_OF_KIND = {
    **dict.fromkeys(("stops_per_cycle", "turns_per_cycle", "stuck_fraction"), RIGID),
    **dict.fromkeys(("slips_per_cycle", "slip_reversals_per_cycle", "elastic_fraction"), ELASTIC),
}

#: Outputs of contacts with a normal force that moves, and of springs.
OF_NORMAL = ("open_fraction", "separations_per_cycle", "normal_force_min", "normal_force_max")
OF_SPRINGS = ("spring_crossings", "spring_force_max")

#: Frequency of the normal spring on the mass that presses it, over omega_1, from which a contact that opens
#: makes impacts: undamped, their sequence depends on any detail.
_STIFF = 10.0


def has_output(name: str, general: ContactSystem) -> bool:
    """Whether an output says something about a system."""
    elastic = general.elastic
    if name in _OF_KIND:
        return bool((elastic if _OF_KIND[name] == ELASTIC else ~elastic).any())
    if name in OF_NORMAL:
        return any(group.normal is not None for group in general.groups)
    if name in OF_SPRINGS:
        return bool(general.springs)
    if name == "work_wall":
        return any(group.first.belt for group in general.groups)
    return name != "contact_regime" or general.count > 1


def outputs_of(general: ContactSystem, solver: Solver) -> tuple[str, ...]:
    """The outputs of a map, see `chosen_outputs`."""
    what = "contacts that open or piecewise linear springs"
    return chosen_outputs(general, solver, TABLE, has_output, what)


def spring_coordinates(system: System) -> dict[str, xr.Variable]:
    """Coordinates along the piecewise linear springs, if there are any."""
    if not system.springs:
        return {}
    names = np.array([one.label for one in system.springs])  # type: ignore[union-attr]
    return {
        "spring": coordinate("spring", np.arange(1, names.size + 1)),
        "spring_name": xr.Variable(("spring",), names, {"long_name": BESIDE["spring_name"].long_name}),
    }


def solve_cells(
    system: System, axes: Mapping[str, np.ndarray], names: Sequence[str], solver: Solver,
    threads: int | None, progress: Progress | None, watch: Watch | None,
) -> dict[str, np.ndarray]:  # fmt: skip
    """Outputs over the axes mu, r and beta; of contacts, masses and springs with a last dimension."""
    r, mu, beta = axes["r"], axes["mu"], axes["beta"]
    check_ratios(system, r)
    count = checks.threads(threads)
    if not changes_with_r(system):
        given = phase_system(system, float(r[0]))
        return sweep_phases(given, r, beta, mu, names, solver.start, solver.cycles, count, progress, watch)
    parts = []
    for k, one in enumerate(r):
        given = phase_system(system, float(one))
        at = r[k : k + 1]
        parts.append(
            sweep_phases(given, at, beta, mu, names, solver.start, solver.cycles, count, None, watch)
        )
        if progress is not None:
            progress(k + 1, r.size)
    return {name: np.concatenate([part[name] for part in parts], axis=1) for name in names}


def labelled(name: str, values: np.ndarray, general: ContactSystem) -> xr.Variable:
    """Label values (n_mu, n_r, n_beta, ...) of an output."""
    with np.errstate(invalid="ignore"):  # NaN of an unresolved cell as a whole number
        values = values.astype(LABELS[name].dtype, copy=False)
    if name in PER_CONTACT:
        return contact_variable(name, values, general.count)
    return label_variable(name, values)


def with_belt_regimes(variables: dict[str, xr.Variable], general: ContactSystem) -> None:
    """Add one-way sliding to the codes of the regimes where there is a belt."""
    if not any(group.first.belt for group in general.groups):
        return
    label = LABELS["regime"]
    full = attributes(label._replace(codes=(*label.codes, *label.also)))
    for name in ("regime", "contact_regime"):
        if name in variables:
            variables[name].attrs = full | {"long_name": LABELS[name].long_name}


def impact_rate(system: System, group: MergedContact) -> float:
    """Frequency of the normal spring on the mass that presses it, sqrt(k_n d.M^-1 d), over omega_1."""
    normal = group.normal
    assert normal is not None
    moved = np.linalg.solve(system.modes.mass, normal.direction)
    return float(np.sqrt(normal.stiffness * normal.direction @ moved))


def impact_comment(system: System, opened: np.ndarray) -> str:
    """What results are worth where a contact with a stiff normal spring opens; empty if none does.

    opened : (..., N) share of the period for which each contact is open
    """
    found = []
    for j, group in enumerate(system.contact_system.groups):
        if group.normal is None or not (np.nan_to_num(opened[..., j]) > 0.0).any():
            continue
        rate = impact_rate(system, group)
        if rate > _STIFF:
            found.append(f"{group.name} opens, with a normal spring of frequency {rate:.3g}")
    if not found:
        return ""
    return (
        f"{'; '.join(found)} (over omega_1): it makes impacts without loss, and motions may be irregular and "
        f"depend on the start; a softer spring or damping of the normal motion settles them"
    )


def phase_map(
    system: System, axes: Mapping[str, np.ndarray], solver: Solver, threads: int | None,
    progress: Progress | None, watch: Watch | None,
) -> xr.Dataset:  # fmt: skip
    """Compute outputs, `status` and boundaries over the axes mu, r and beta."""
    general = system.contact_system
    refuse_static(general, axes["mu"])
    names = outputs_of(general, solver)
    found = solve_cells(system, axes, (*names, "open_fraction"), solver, threads, progress, watch)
    variables = {name: labelled(name, found[name], general) for name in names}
    with_belt_regimes(variables, general)
    coords = {name: coordinate(name, values) for name, values in axes.items()}
    if any(is_of_masses(name) for name in names):
        coords |= mass_coordinates(system)
    coords |= contact_coordinates(system)
    if any(name in OF_SPRINGS for name in names):
        coords |= spring_coordinates(system)
    ds = xr.Dataset(variables | limit_variables(system, axes["r"], axes["mu"]), coords=coords)
    comment = impact_comment(system, found["open_fraction"])
    return ds.assign_attrs(comment=comment) if comment else ds
