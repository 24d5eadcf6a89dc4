"""Response curves of general systems, cell by cell."""

from collections.abc import Mapping

import numpy as np
import xarray as xr

from .. import regimes
from ..datasets.labels import LABELS, OLDER_NAMES, PER_CONTACT, labels_of
from ..datasets.variables import coordinate, label_variable
from ..errors import InputError, NoSteadyState
from ..jobs import Progress
from ..model.settings import RECORDED, CurveSettings, Solver
from ..model.system import System
from .boundaries import find_boundaries, stays_at_rest
from .certificate import certified_beta
from .cycle import equivalent_of, first_harmonics, harmonic_values, parts, phase_values, work_values
from .dataset import boundary_variables, contact_coordinates, refuse_static
from .held import held_displacements
from .maps import solve_cells
from .observed import wants_further
from .outputs import is_wanted, output_values
from .problem import general_of, problem_of
from .response import scalars
from .steps import Steps, cell_steps

#: Scalars of every cell.
_ALWAYS = ("regime", "contact_regime", "stops_per_cycle", "slips_per_cycle", "period", "status")

_OFFERED = ("amplitude", "phase", "first_harmonic", "energy", "harmonics", *RECORDED)


def _cell(system: System, steps: Steps, asked: CurveSettings) -> dict[str, np.ndarray]:
    """The requested numbers of one cell."""
    quantities = asked.quantities
    found = scalars(system, steps, quantities)
    values = {name: found[name] for name in (*_ALWAYS, *RECORDED) if name in found}
    phasors = harmonic_values(system, steps, max(1, asked.harmonics))
    if "amplitude" in quantities:
        for name in ("amplitude", "contact_amplitude", "peak_to_peak", "contact_peak_to_peak"):
            values[name] = found[name]
    if "phase" in quantities:
        values |= phase_values(steps)
    if "first_harmonic" in quantities:
        values |= first_harmonics(phasors)
    if "harmonics" in quantities:
        values |= {name: parts(value) for name, value in phasors.items()}
    if "energy" in quantities:
        values |= work_values(system, steps)
        values |= {"sliding_distance": found["sliding_distance"], "work_wall": found["work_wall"]}
        values |= equivalent_of(phasors)
    return values


def _stuck(
    system: System, asked: CurveSettings, point: tuple[float, float, float], stick: float, solver: Solver
) -> dict[str, np.ndarray]:
    """Numbers of a cell that sticks permanently: those of the structure held at the places that it comes to.

    point, stick : mu, r and beta; beta_stick
    """
    general = general_of(system)
    axes = {name: np.array([value]) for name, value in zip(("mu", "r", "beta"), point, strict=True)}
    further, r = wants_further(system, asked.quantities), axes["r"]
    cells = solve_cells(
        system, axes, np.array([[stick]]), solver, 1, None, None, masses=True, further=further
    )  # fmt: skip
    values = {"regime": np.array(regimes.PERMANENT_STICKING), "status": cells.status[0, 0, 0],
              "period": np.array(1), "contact_regime": np.zeros(general.count)}  # fmt: skip
    values |= {
        name: output_values(name, system, cells)[0, 0, 0] for name in RECORDED if name in asked.quantities
    }
    low, high = cells.lowest[0, 0, 0], cells.highest[0, 0, 0]
    ranges = high - low
    moduli = 0.5 * ranges if system.rigid_modes else np.maximum(high, -low)  # about the middle, as of maps
    if "amplitude" in asked.quantities:
        rigid = ~general.elastic
        for name, table in (("amplitude", moduli), ("peak_to_peak", ranges)):
            values[name] = table[general.count : general.count + system.n]
            values[f"contact_{name}"] = np.where(rigid, 0.0, table[: general.count])
    motions = held_displacements(system, r)
    if "first_harmonic" in asked.quantities and 1 in motions:
        first = motions[1][0]
        finite = np.isfinite(first)
        values["first_harmonic_amplitude"] = np.abs(first)
        values["first_harmonic_phase"] = np.where(finite, -np.angle(np.where(finite, first, 1.0)), np.nan)
    return values


def of_cells(name: str, values: np.ndarray, contacts: int) -> xr.Variable:
    """Label values (n_mu, n_r, n_beta, ...); those of contacts get that dimension at its place."""
    label = labels_of("curves")[name]
    values = values.astype(label.dtype, copy=False)
    if name not in PER_CONTACT:
        return label_variable(name, values, "curves")
    first = values[:, :, :, 0]
    attrs = label_variable(name, first, "curves").attrs
    if contacts == 1:
        return xr.Variable(label.dims, first, attrs)
    return xr.Variable((*label.dims[:3], "contact", *label.dims[3:]), values, attrs)


def general_curves(
    system: System, axes: Mapping[str, np.ndarray], solver: Solver, asked: CurveSettings,
    progress: Progress | None,
) -> xr.Dataset:  # fmt: skip
    """Compute the response curves of a general system over the axes mu, r and beta; see `curves`."""
    for quantity in asked.quantities:
        if quantity not in _OFFERED:
            raise InputError(
                f"cannot compute {quantity} with several contacts, springs, belts or loads of several "
                f"harmonics; valid quantities: {', '.join(_OFFERED)}"
            )
    mu, r, beta = axes["mu"], axes["r"], axes["beta"]
    general = general_of(system)
    refuse_static(general, mu)
    if r[0] == 0.0:
        raise InputError("r", "must be > 0 for response curves of such systems; got 0")
    count = general.count
    limits = find_boundaries(system, r, mu)
    problem, modal = problem_of(system, r, float(beta.max()))
    from_rest = stays_at_rest(system, solver.start)
    equal, certified = [general.has_equal_friction(float(one)) for one in mu], certified_beta(system)
    further = wants_further(system, asked.quantities)
    shape = (mu.size, r.size, beta.size)
    tables: dict[str, np.ndarray] = {}
    for done, (m, i, b) in enumerate(np.ndindex(shape), 1):
        values: dict[str, np.ndarray] = {"status": np.array(regimes.NOT_REACHED)}
        try:
            proved = from_rest or (equal[m] and beta[b] <= certified)
            if proved and solver.skip == "exact" and beta[b] >= limits.beta_stick[m, i]:
                point = float(mu[m]), float(r[i]), float(beta[b])
                values = _stuck(system, asked, point, float(limits.beta_stick[m, i]), solver)
            else:
                steps = cell_steps(system, problem, modal, i, float(beta[b]), float(mu[m]), solver, further)
                values = _cell(system, steps, asked)
        except NoSteadyState:
            pass
        for name, value in values.items():
            if name not in tables:
                label = LABELS[name]
                tables[name] = np.full((*shape, *value.shape), label.unresolved, dtype=float)
            tables[name][m, i, b] = value
        if progress is not None:
            progress(done, int(np.prod(shape)))
    for old, new in OLDER_NAMES["curves"].items():
        if new in tables:
            tables[old] = tables[new]
    variables = {
        name: of_cells(name, values, count) for name, values in tables.items() if is_wanted(name, general)
    }
    coords = {name: coordinate(name, values) for name, values in axes.items()} | contact_coordinates(system)
    return xr.Dataset(variables | boundary_variables(system, limits), coords=coords)
