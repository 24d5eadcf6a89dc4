"""Maps of a view of a system with several contacts, springs, belts or periodic loads, for the page."""

from collections.abc import Sequence

import numpy as np

from .. import checks
from ..datasets.labels import LABELS, PER_CONTACT
from ..general.dataset import cell_values, contact_values
from ..general.maps import solve_cells
from ..general.problem import general_of, springs
from ..model.held_structure import constrained_frequencies
from ..model.system import System
from ..pictures.classes import OVERALL, OVERALL_ELASTIC, SLIPS, STOPS, Counted
from ..pictures.palette import CLASSES, ONE_WAY, ONE_WAY_LABEL, Look
from .general_lines import chosen, general_line_values, limits_of
from .views import CellQuantity, Follower, View, amplitude_quantities

#: Colour of one-way sliding: pale, as it has no stops either; pictures on paper hatch it.
_ONE_WAY = "#d5ecc8"

_OF_RIGID = (
    CellQuantity("stops_per_cycle", "stops per cycle", "stops_per_cycle", "linear"),
    CellQuantity("turns_per_cycle", "turns without a stop per cycle", "turns_per_cycle", "linear"),
    CellQuantity("stuck_fraction", "share of time stuck", "stuck_fraction", "linear"),
)
_OF_ELASTIC = (
    CellQuantity("slips_per_cycle", "slips per cycle", "slips_per_cycle", "linear"),
    CellQuantity(
        "slip_reversals_per_cycle", "slip reversals per cycle", "slip_reversals_per_cycle", "linear"
    ),
    CellQuantity("elastic_fraction", "share of time without slip", "elastic_fraction", "linear"),
)
_OF_CONTACT = (
    CellQuantity("contact_amplitude", "amplitude in the contact", "contact_amplitude", "log"),
    CellQuantity("contact_peak_to_peak", "peak to peak in the contact", "contact_peak_to_peak", "log"),
)
_ALWAYS = (
    CellQuantity("multiplier", "Floquet multiplier", "multiplier", "linear"),
    CellQuantity("period", "period in excitation cycles", "period", "linear"),
)


def general_quantities(view: View) -> tuple[CellQuantity, ...]:
    """Quantities that can colour the cells: of the contact that is shown, or of all together."""
    k = chosen(view)
    amplitudes = amplitude_quantities(view.system)
    work = CellQuantity("work_friction", "energy dissipated by friction", "work_friction", "log")
    if k is None:
        first = CellQuantity("regime", "regime of all contacts", "", "classes")
        whole = work._replace(label="energy dissipated by all contacts")
        return (first, *amplitudes, *_ALWAYS, whole)
    elastic = general_of(view.system).elastic[k]
    first = CellQuantity("regime", "regime and slips" if elastic else "regime and stops", "", "classes")
    return (first, *_OF_CONTACT, *amplitudes, *(_OF_ELASTIC if elastic else _OF_RIGID), *_ALWAYS, work)


def counted_of(view: View) -> Counted:
    """The quantity that classifies the cells, and the names of the classes."""
    elastic, k = general_of(view.system).elastic, chosen(view)
    if k is None:
        return OVERALL_ELASTIC if elastic.any() else OVERALL
    return SLIPS if elastic[k] else STOPS


def general_looks(view: View) -> tuple[Look, ...]:
    """Names and colours of the classes, with that of one-way sliding."""
    labels = counted_of(view).labels
    looks = tuple(look._replace(label=label) for look, label in zip(CLASSES, labels, strict=False))
    further = (Look(labels[len(CLASSES)], CLASSES[0].colour),) * (ONE_WAY - len(CLASSES))
    return (*looks, *further, Look(ONE_WAY_LABEL, _ONE_WAY))


def solve_general(
    view: View, wanted: Sequence[CellQuantity], axes: dict[str, np.ndarray], follower: Follower
) -> dict[str, np.ndarray]:
    """The cells of a piece as `sweep` gives them, (mu, columns, rows), and the boundaries over its columns.

    `regime` and `stops_per_cycle`, in its place slips, are those of the contact that is shown; all contacts
    together have no number of stops.
    """
    limits = limits_of(view, axes["r"], follower.watch)
    masses = any(quantity.row is not None for quantity in wanted)
    cells = solve_cells(view.system, axes, limits.beta_stick, view.solver, checks.threads(None),
                        follower.progress, follower.watch, masses)  # fmt: skip
    k = chosen(view)

    def values(name: str) -> np.ndarray:
        if name not in PER_CONTACT:
            return cell_values(name, view.system, cells).astype(LABELS[name].dtype, copy=False)
        table: np.ndarray = contact_values(name, view.system, cells).astype(LABELS[name].dtype, copy=False)
        return table.sum(axis=-1) if k is None else table[..., k]

    found = {quantity.output: values(quantity.output) for quantity in wanted if quantity.output}
    found["regime"] = cells.regime if k is None else cells.contact_regime[..., k]
    if k is not None:
        found["stops_per_cycle"] = values(counted_of(view).variable)
    lines = general_line_values(view, limits)
    return found | {name: line[np.newaxis] for name, line in lines.items()}


def held_frequencies(system: System) -> np.ndarray:
    """Natural frequencies with no contact sliding: rigid ones held, springs of elastic ones stuck."""
    general, modes = general_of(system), system.modes
    stiffness = modes.stiffness + general.vectors.T @ (springs(general)[:, np.newaxis] * general.vectors)
    return constrained_frequencies(modes.mass, stiffness, general.vectors[~general.elastic])
