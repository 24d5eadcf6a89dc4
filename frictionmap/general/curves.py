"""Response curves of general systems, cell by cell."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import xarray as xr

from .. import regimes
from ..datasets.labels import LABELS, OLDER_NAMES, PER_CONTACT, labels_of
from ..datasets.variables import coordinate, label_variable
from ..errors import InputError, NoSteadyState
from ..jobs import Progress
from ..model.general import rank_of
from ..model.settings import RECORDED, CurveSettings, Solver
from ..model.system import System
from .boundaries import find_boundaries, stays_at_rest
from .certificate import certified_beta
from .cycle import equivalent_of, first_harmonics, harmonic_values, parts, phase_values, work_values
from .dataset import boundary_variables, contact_coordinates, refuse_static
from .held import base_seen_by_dampers, held_ranges, possible_forces
from .loops import undetermined_forces
from .maps import solve_cells
from .observed import wants_further
from .outputs import is_wanted, output_values
from .problem import general_of, problem_of
from .response import scalars
from .steps import Steps, cell_steps

#: Scalars of every cell.
_ALWAYS = ("regime", "contact_regime", "stops_per_cycle", "slips_per_cycle", "period", "status")

#: Numbers of the quantity "amplitude".
_SIZES = ("amplitude", "contact_amplitude", "peak_to_peak", "contact_peak_to_peak")

_OFFERED = ("amplitude", "phase", "first_harmonic", "energy", "harmonics", *RECORDED)

#: Parts of a period, per harmonic, among which extremes are looked for.
_PARTS = 8

#: Displacement over the largest that is rounding error.
_ROUNDING = 1e-12


def _cell(system: System, steps: Steps, asked: CurveSettings) -> dict[str, np.ndarray]:
    """The requested numbers of one cell."""
    quantities = asked.quantities
    found = scalars(system, steps, quantities)
    values = {name: found[name] for name in (*_ALWAYS, *RECORDED) if name in found}
    phasors = harmonic_values(system, steps, max(1, asked.harmonics))
    if "amplitude" in quantities:
        values |= {name: found[name] for name in _SIZES}
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


@dataclass(frozen=True)
class _Held:
    """A structure with all contacts at rest: harmonics about the places that it comes to."""

    phasors: dict[str, np.ndarray]  # as of `harmonic_values`
    damping: float  # work per period
    period: int = 1
    drifts: bool = False

    @property
    def begins(self) -> np.ndarray:
        """As many as there are parts of a period among which extremes are looked for."""
        return np.zeros(_PARTS * self.phasors["displacement_harmonic"].shape[1])

    def displacements(self, tau: np.ndarray, order: int = 0, row: int | slice = slice(None)) -> np.ndarray:
        """Displacements of the masses or points, or with `order` 1 their derivatives by tau; see `Steps`."""
        x = self.phasors["displacement_harmonic"][row]
        n = np.arange(x.shape[-1])
        return np.asarray(((1j * n) ** order * x @ np.exp(1j * np.outer(n, tau))).real)


def _held(system: System, r: float, lowest: np.ndarray, highest: int) -> _Held:
    """The motion with all contacts at rest, with harmonics up to `highest` or those of the load.

    lowest : (N + n,) least displacements in the contacts and of the masses
    """
    general, at = general_of(system), np.array([r])
    count, n = general.count, system.n
    forces, motions = possible_forces(system, at)
    whole = max(highest, *motions)
    x, z, f = (np.zeros((rows, whole + 1), dtype=complex) for rows in (n, count, count))
    damping, moved = 0.0, general.joined
    seen = base_seen_by_dampers(system)
    for order, motion in motions.items():
        u = general.base.get(order, 0.0)
        x[:, order] = general.displacements(order, at, motion, forces[order])[0]
        f[:, order] = forces[order][0]
        vectors = general.vectors if general.points is None else general.points.vectors
        z[:, order] = np.where(general.elastic, vectors @ x[:, order] - u * moved, 0.0)
        rate = order * (motion[0] if seen is None else motion[0] + u * seen)
        damping += np.pi * r * float((rate.conj() @ system.modes.damping @ rate).real)
    x[np.abs(x) <= _ROUNDING * np.abs(x).max()] = 0.0  # masses that contacts hold
    if not system.rigid_modes:  # which come to any place
        place = lowest[: count + n] - held_ranges(system, at)[0][0]
        z[:, 0], x[:, 0] = place[:count], place[count:]
    f[:, 0] = _constant_forces(system, x[:, 0].real)
    if general.loop:
        f[undetermined_forces(general.vectors.T, np.ones((1, count), dtype=bool))[0]] = np.nan
    return _Held({"displacement_harmonic": x, "contact_harmonic": z, "friction_harmonic": f}, damping)


def _constant_forces(system: System, place: np.ndarray) -> np.ndarray:
    """Means of the forces in contacts that hold a structure at a place (n,), (N,); NaN where others would."""
    general = general_of(system)
    if general.points is not None or rank_of(general.vectors) < general.count:
        return np.full(general.count, np.nan)
    return np.linalg.lstsq(general.vectors.T, general.offset - system.modes.stiffness @ place)[0]


def _held_quantities(held: _Held, asked: CurveSettings) -> dict[str, np.ndarray]:
    """The requested numbers that follow from harmonics; see `_cell`."""
    quantities = asked.quantities
    values: dict[str, np.ndarray] = {}
    phasors = {name: one[:, : max(1, asked.harmonics) + 1] for name, one in held.phasors.items()}
    if "phase" in quantities:
        values |= phase_values(held)  # type: ignore[arg-type]  # it has what is needed of `Steps`
    if "first_harmonic" in quantities:
        values |= first_harmonics(phasors)
    if "harmonics" in quantities:
        values |= {name: parts(value) for name, value in phasors.items()}
    if "energy" in quantities:
        values |= equivalent_of(phasors)
        values |= {"work_input": np.array(held.damping), "work_damping": np.array(held.damping)}
    return values


def _stuck(
    system: System, asked: CurveSettings, point: tuple[float, float, float], stick: float, solver: Solver
) -> dict[str, np.ndarray]:
    """Numbers of a cell that sticks permanently: those of the structure held at the places that it comes to.

    point, stick : mu, r and beta; beta_stick
    """
    axes = {name: np.array([value]) for name, value in zip(("mu", "r", "beta"), point, strict=True)}
    cells = solve_cells(
        system, axes, np.array([[stick]]), solver, 1, None, None, masses=True,
        further=wants_further(system, asked.quantities),
    )  # fmt: skip
    names = [*_ALWAYS, *(name for name in RECORDED if name in asked.quantities)]
    if "amplitude" in asked.quantities:
        names += _SIZES
    if "energy" in asked.quantities:
        names += ["sliding_distance", "work_friction", "work_wall"]
    values = {name: output_values(name, system, cells)[0, 0, 0] for name in names}
    held = _held(system, point[1], cells.lowest[0, 0, 0], asked.harmonics)
    return values | _held_quantities(held, asked)


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
    problem, modal = problem_of(system, r, float(beta.max()), loops=True)
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
    if set(tables) == {"status"}:  # no cell is resolved: names and shapes are those of a cell at rest
        point = float(mu[0]), float(r[0]), float(beta[0])
        like = _stuck(system, asked, point, 0.0, replace(solver, skip="exact"))
        tables |= {
            name: np.full((*shape, *value.shape), LABELS[name].unresolved, dtype=float)
            for name, value in like.items()
            if name not in tables
        }
    for old, new in OLDER_NAMES["curves"].items():
        if new in tables:
            tables[old] = tables[new]
    variables = {
        name: of_cells(name, values, count) for name, values in tables.items() if is_wanted(name, general)
    }
    coords = {name: coordinate(name, values) for name, values in axes.items()} | contact_coordinates(system)
    return xr.Dataset(variables | boundary_variables(system, limits), coords=coords)
