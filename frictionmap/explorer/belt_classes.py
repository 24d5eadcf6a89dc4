"""Motions on a belt without a load on the page: classes of cells, and quantities that colour them."""

from collections.abc import Sequence

import numpy as np

from .. import regimes
from ..pictures.palette import NO_LOAD, Look
from .scene_parts import CellQuantity
from .views import View

#: Sets of stable motions in the order of their classes, the first one after that of unresolved cells.
_SETS = tuple(
    sum(1 << regime for regime in each)
    for each in (
        (regimes.STEADY_SLIDING,),
        (regimes.CYCLE_WITHOUT_STOPS,),
        (regimes.STICK_SLIP_CYCLE,),
        (regimes.STEADY_SLIDING, regimes.STICK_SLIP_CYCLE),
        (regimes.STEADY_SLIDING, regimes.CYCLE_WITHOUT_STOPS),
        (regimes.CYCLE_WITHOUT_STOPS, regimes.STICK_SLIP_CYCLE),
        (regimes.STEADY_SLIDING, regimes.CYCLE_WITHOUT_STOPS, regimes.STICK_SLIP_CYCLE),
    )
)

#: Cells with several stable motions: paler than those of the cycle alone if steady sliding is one of them.
_SEVERAL = (
    Look("stick-slip cycle; steady sliding is stable too", "#fff1c9"),
    Look("cycle without stops; steady sliding is stable too", "#cbd6a6"),
    Look("stick-slip cycle and cycle without stops", "#b08a2e"),
    Look("both cycles and steady sliding", "#dcc383"),
)
LOOKS = (
    NO_LOAD[regimes.UNRESOLVED],
    NO_LOAD[regimes.STEADY_SLIDING],
    NO_LOAD[regimes.CYCLE_WITHOUT_STOPS],
    NO_LOAD[regimes.STICK_SLIP_CYCLE],
    *_SEVERAL,
)

#: Kinds of classes that a page opens with the motion of, the first ones first.
EXAMPLES = ((3, 4, 6, 7), (2, 5), (1,))


def belt_quantities(view: View, masses: Sequence[CellQuantity]) -> tuple[CellQuantity, ...]:
    """What can colour the cells: of the contact that is shown, of the masses, of the cell."""
    of_contact = (
        CellQuantity("contact_peak_to_peak", "peak to peak in the contact", "contact_peak_to_peak", "log"),
        CellQuantity("stuck_fraction", "share of time stuck", "stuck_fraction", "linear"),
    )
    opens = CellQuantity("open_fraction", "share of time open", "open_fraction", "linear")
    normal = view.shown is not None and view.contacts[0].normal is not None
    return (
        CellQuantity("regime", "regime and stability", "", "classes"),
        *(of_contact if view.shown is not None else ()),
        *((opens,) if normal else ()),
        *masses,
        CellQuantity("cycle_period", "period of the cycle × ω₁", "cycle_period", "linear"),
        CellQuantity("growth", "growth rate / ω₁ of small vibrations", "growth", "log"),
    )


def classes_of_cells(regime: np.ndarray, reachable: np.ndarray) -> np.ndarray:
    """Classes by the stable motions of the cells, uint8: indices into `LOOKS`."""
    known = regime != regimes.UNRESOLVED
    stable = np.where(known, reachable.astype(int) | (1 << np.where(known, regime, 0).astype(int)), 0)
    found = np.zeros(regime.shape, np.uint8)
    for index, flags in enumerate(_SETS, 1):
        found[stable == flags] = index
    return found
