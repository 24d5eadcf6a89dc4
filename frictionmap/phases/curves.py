"""Response curves, cell by cell."""

from collections.abc import Callable, Mapping
from contextlib import suppress

import numpy as np
import xarray as xr

from .. import regimes
from ..datasets.labels import LABELS, OLDER_NAMES
from ..datasets.variables import coordinate
from ..errors import InputError, NoSteadyState
from ..general.curves import of_cells
from ..general.cycle import equivalent_of, first_harmonics, parts, phase_values
from ..general.dataset import contact_coordinates, refuse_static
from ..general.normal_limits import limit_variables
from ..jobs import Progress, Watch
from ..model.settings import CurveSettings, Solver
from ..model.system import System
from .cycle import Cycle, harmonic_phasors, work_values
from .dataset import has_output
from .given import check_ratios, phase_system
from .response import find_cycle

#: Scalars of every cell.
_ALWAYS = (
    "regime", "contact_regime", "stops_per_cycle", "slips_per_cycle", "open_fraction",
    "separations_per_cycle", "period", "status",
)  # fmt: skip

_OFFERED = ("amplitude", "phase", "first_harmonic", "energy", "harmonics", "drift")


def _cell(cycle: Cycle, asked: CurveSettings) -> dict[str, np.ndarray]:
    """The requested numbers of one cell."""
    quantities, numbers = asked.quantities, cycle.found.numbers
    values = {name: numbers[name] for name in _ALWAYS}
    phasors = harmonic_phasors(cycle, max(1, asked.harmonics))
    if "amplitude" in quantities:
        for name in ("amplitude", "contact_amplitude", "peak_to_peak", "contact_peak_to_peak"):
            values[name] = numbers[name]
    if "drift" in quantities:
        values["drift"] = numbers["drift"]
    if "phase" in quantities:
        values |= phase_values(cycle)  # type: ignore[arg-type]  # it has what is needed of `Steps`
    if "first_harmonic" in quantities:
        values |= first_harmonics(phasors)
    if "harmonics" in quantities:
        values |= {name: parts(value) for name, value in phasors.items()}
    if "energy" in quantities:
        values |= work_values(cycle) | equivalent_of(phasors)
        values["sliding_distance"] = numbers["sliding_distance"]
    return values


def check_quantities(asked: CurveSettings, what: str) -> None:
    """Refuse quantities that are not on offer; `what`: the systems, for the message."""
    for quantity in asked.quantities:
        if quantity not in _OFFERED:
            raise InputError(
                f"cannot compute {quantity} with {what}; valid quantities: {', '.join(_OFFERED)}"
            )


def phase_curves(
    system: System, axes: Mapping[str, np.ndarray], solver: Solver, asked: CurveSettings,
    progress: Progress | None, watch: Watch | None,
) -> xr.Dataset:  # fmt: skip
    """Compute response curves over the axes mu, r and beta; see `curves`."""
    check_quantities(asked, "contacts that open or piecewise linear springs")
    refuse_static(system.contact_system, axes["mu"])
    check_ratios(system, axes["r"])
    r = axes["r"]
    given = [phase_system(system, float(one)) for one in r]

    def find(i: int, beta: float, mu: float) -> Cycle:
        return find_cycle(system, given[i], float(r[i]), beta, mu, solver)

    limits = limit_variables(system, r, axes["mu"])
    return curve_dataset(system, axes, asked, find, limits, progress, watch)


def curve_dataset(
    system: System, axes: Mapping[str, np.ndarray], asked: CurveSettings,
    find: Callable[[int, float, float], Cycle], limits: Mapping[str, xr.Variable],
    progress: Progress | None, watch: Watch | None,
) -> xr.Dataset:  # fmt: skip
    """The requested numbers of all cells, and the boundaries `limits`, labelled.

    find : the steady motion at a number of r, beta and mu; it raises `NoSteadyState`
    """
    mu, r, beta = axes["mu"], axes["r"], axes["beta"]
    shape = (mu.size, r.size, beta.size)
    tables: dict[str, np.ndarray] = {}
    for done, (m, i, b) in enumerate(np.ndindex(shape), 1):
        values: dict[str, np.ndarray] = {"status": np.array(regimes.NOT_REACHED)}
        with suppress(NoSteadyState):
            values = _cell(find(i, float(beta[b]), float(mu[m])), asked)
        for name, value in values.items():
            if name not in tables:
                tables[name] = np.full((*shape, *np.shape(value)), LABELS[name].unresolved, dtype=float)
            tables[name][m, i, b] = value
        if watch is not None:
            watch()
        if progress is not None:
            progress(done, int(np.prod(shape)))
    for old, new in OLDER_NAMES["curves"].items():
        if new in tables:
            tables[old] = tables[new]
    general = system.contact_system
    variables = {
        name: of_cells(name, one, general.count) for name, one in tables.items() if has_output(name, general)
    }
    coords = {name: coordinate(name, values) for name, values in axes.items()} | contact_coordinates(system)
    return xr.Dataset(variables | dict(limits), coords=coords)
