"""Further outputs of a cell: details and quantities, as far as they are requested.

Both are built for one frequency and written for a cell in the same way.  The implementation is chosen by the
class of the request (`by_class`), so that nothing is compiled without a request.  The segment table of a
periodic orbit is measured once for both.
"""

from typing import NamedTuple

import numpy as np

from ..compiler import by_class, entry, kernel
from ..compiler.packed import packed
from ..structure.newton import Workspace, make_workspace
from ..structure.oscillators import Scratch, make_scratch
from ..structure.sliding_orbit import Continuous
from ..structure.state import Loads, Model, StructureAtFrequency, make_structure
from .details import (
    Details,
    DetailsAtFrequency,
    continuous_details,
    details_at,
    periodic_details,
    stuck_details,
)
from .measure import orbit_table
from .quantities import (
    Quantities,
    QuantitiesAtFrequency,
    continuous_quantities,
    periodic_quantities,
    quantities_at,
    stuck_quantities,
)


class NotRequested(NamedTuple):
    """Placeholder for details or quantities without a request."""

    size: int


class Common(NamedTuple):
    """Data over a whole map that details and quantities share."""

    r: np.ndarray
    model: Model
    loads: Loads
    orbit: Continuous
    steps: float


class CommonAtFrequency(NamedTuple):
    """Data at one frequency that details and quantities share; at r = 0 a placeholder (r = 1) that is never
    read.
    """

    i: int
    r: float
    st: StructureAtFrequency
    work: Workspace
    scratch: Scratch


class Requested(NamedTuple):
    """Further outputs over a whole map."""

    common: Common | NotRequested
    details: Details | NotRequested
    quantities: Quantities | NotRequested


class OrbitTable(NamedTuple):
    """Request of the segment table of a periodic orbit, from which details and quantities are read."""

    oscillators: int


class RequestedAtFrequency(NamedTuple):
    """Further outputs at one frequency."""

    table: OrbitTable | NotRequested
    details: DetailsAtFrequency | NotRequested
    quantities: QuantitiesAtFrequency | NotRequested


@kernel
def _not_requested(requested, _):
    """Return the placeholder itself."""
    return requested


@entry
def _common_at(common, i):
    """Build the shared data for the i-th frequency."""
    r = common.r[i] if common.r[i] > 0.0 else 1.0
    st = make_structure(common.model, common.loads, i, r, common.steps)
    return CommonAtFrequency(i, r, st, make_workspace(st.n), make_scratch(st.n))


@by_class((NotRequested, _not_requested), (Common, _common_at))
def _shared_at(common, i):
    """Build the shared data for the i-th frequency."""


@kernel
def _part_not_requested(part, common, shared):
    """Return the placeholder itself."""
    return part


@by_class((NotRequested, _part_not_requested), (Details, details_at), (Quantities, quantities_at))
def _part_at(part, common, shared):
    """Build details or quantities from the data that they share, over the map and at a frequency."""


@kernel
def _orbit_table(common, shared):
    """Request the segment table."""
    return OrbitTable(shared.st.n)


@by_class((NotRequested, _not_requested), (Common, _orbit_table))
def _table_at(common, shared):
    """Request the segment table if anything is requested."""


@entry
def requested_at(requested, i):
    """Build the data for the i-th frequency."""
    common = requested.common
    shared = _shared_at(common, i)
    return RequestedAtFrequency(
        _table_at(common, shared), _part_at(requested.details, common, shared),
        _part_at(requested.quantities, common, shared),
    )  # fmt: skip


@kernel
def _no_stuck(part, m, j):
    """Write nothing."""


@by_class(
    (NotRequested, _no_stuck), (DetailsAtFrequency, stuck_details), (QuantitiesAtFrequency, stuck_quantities)
)
def _stuck(part, m, j):
    """Write details or quantities of a cell whose contact sticks."""


@kernel
def write_stuck(requested, m, j):
    """Write the further outputs of a cell whose contact sticks; m, j: indices of mu and beta."""
    _stuck(requested.details, m, j)
    _stuck(requested.quantities, m, j)


@kernel
def _no_continuous(part, m, j, beta):
    """Write nothing."""


@by_class(
    (NotRequested, _no_continuous), (DetailsAtFrequency, continuous_details),
    (QuantitiesAtFrequency, continuous_quantities),
)  # fmt: skip
def _continuous(part, m, j, beta):
    """Write details or quantities of a cell on the continuous orbit."""


@kernel
def write_continuous(requested, m, j, beta):
    """Write the further outputs of a cell on the continuous orbit; m, j: indices of mu and beta."""
    _continuous(requested.details, m, j, beta)
    _continuous(requested.quantities, m, j, beta)


@kernel
def _no_periodic(part, m, j, beta, table):
    """Write nothing."""


@by_class(
    (NotRequested, _no_periodic), (DetailsAtFrequency, periodic_details),
    (QuantitiesAtFrequency, periodic_quantities),
)  # fmt: skip
def _periodic(part, m, j, beta, table):
    """Write details or quantities of a cell from the segment table of its periodic orbit."""


@kernel
def _no_orbit(table, requested, motion, contact, found, m, j, beta):
    """Write nothing.

    Parameters
    ----------
    table, requested, motion, contact, found, m, j, beta : see `write_orbit`
    """


@kernel
def _orbit(table, requested, motion, contact, found, m, j, beta):
    """Measure the segment table of a periodic orbit and write what is requested.

    Parameters
    ----------
    table, requested, motion, contact, found, m, j, beta : see `write_orbit`
    """
    segments = orbit_table(motion, contact, found, table.oscillators)
    _periodic(requested.details, m, j, beta, segments)
    _periodic(requested.quantities, m, j, beta, segments)


@by_class((NotRequested, _no_orbit), (OrbitTable, _orbit))
def write_orbit(table, requested, motion, contact, found, m, j, beta):
    """Write the further outputs of a cell on a periodic orbit.

    Parameters
    ----------
    table : OrbitTable or NotRequested, of `requested`
    requested : RequestedAtFrequency
    motion : a kind of motion, at the anchor of the orbit
    contact : Contact, in the units of the motion
    found : Cell
    m, j : indices of mu and beta
    beta : kinetic friction force, in the units of the map
    """


# For the only cell of a map: one entry per branch, so that only the branch in use is compiled.


@kernel
def _only_stuck(quantities):
    """Write the quantities of a cell that sticks."""
    stuck_quantities(packed(quantities), 0, 0)


@kernel
def _only_continuous(quantities, beta):
    """Write the quantities of a cell on the continuous orbit."""
    continuous_quantities(packed(quantities), 0, 0, beta)


@kernel
def _only_periodic(quantities, beta, table):
    """Write the quantities of a cell with a segment table."""
    periodic_quantities(packed(quantities), 0, 0, beta, table)


@entry
def stuck_cell_quantities(common, quantities):
    """Write the quantities of the only cell of a map, whose contact sticks."""
    _only_stuck(quantities_at(quantities, common, _common_at(common, 0)))


@entry
def continuous_cell_quantities(common, quantities, beta):
    """Write the quantities of the only cell of a map, on the continuous orbit of the closed form."""
    _only_continuous(quantities_at(quantities, common, _common_at(common, 0)), beta)


@entry
def table_cell_quantities(common, quantities, beta, table):
    """Write the quantities of the only cell of a map, from its segment table."""
    _only_periodic(quantities_at(quantities, common, _common_at(common, 0)), beta, table)
