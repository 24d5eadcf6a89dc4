"""Names, units and meanings of motions of one mass on a belt without a load, over mu, belt speed and beta."""

import numpy as np

from .. import regimes
from .labels import COORDINATES, Label

CELL = ("mu", "wall_speed", "beta")

#: How certain the motions of a cell are.
_STATUSES = (
    regimes.Code(regimes.RESOLVED, "resolved", "all motions were found"),
    regimes.Code(
        regimes.NOT_REACHED, "not_reached", "it is not proved that there are no further cycles without stops"
    ),
    regimes.Code(regimes.MARGINAL, "marginal", "nothing damps or drives small vibrations"),
)

_REACHABLE = tuple(
    one._replace(value=1 << one.value) for one in regimes.NO_LOAD_REGIMES if one.value != regimes.UNRESOLVED
)


def _cycle_label(meaning: str, least: float = -np.inf) -> Label:
    return Label(np.float64, meaning, CELL, comment="NaN in steady sliding", least=least, nan=True)


def _real(meaning: str, comment: str = "", dims: tuple[str, ...] = CELL, least: float = -np.inf) -> Label:
    return Label(np.float64, meaning, dims, comment=comment, least=least, nan=True, inf=True)


#: Variables by name; times are over 1/omega_1, displacements over P/k1.
BELTS = {
    "mu": COORDINATES["mu"],
    "wall_speed": Label(np.float64, "speed of the belt, over omega_1 P/k1", ("wall_speed",), least=0.0),
    "beta": COORDINATES["beta"],
    "regime": Label(
        np.int8, "motion that begins where the belt releases the mass", CELL, regimes.NO_LOAD_REGIMES
    ),
    "also_reachable": Label(
        np.uint8, "every stable motion of the cell", CELL, _REACHABLE, flags="flag_masks"
    ),
    "status": Label(np.int8, "how certain the motions are", CELL, _STATUSES),
    "growth": _real("growth rate of small vibrations about steady sliding, over omega_1", "< 0: stable"),
    "growth_frequency": _real("frequency of these vibrations, over omega_1", least=0.0),
    "cycle_period": _cycle_label("period of the cycle, over 1/omega_1", least=0.0),
    "stops_per_cycle": Label(np.float64, "number of stops per cycle", CELL, least=0.0),
    "stuck_fraction": Label(np.float64, "part of the cycle in which the mass sticks", CELL, least=0.0),
    "x_max": _real("largest displacement, over P/k1"),
    "x_min": _real("least displacement, over P/k1"),
    "multiplier": _cycle_label("factor of a small deviation per cycle", least=0.0),
    "segment_crossings": Label(np.float64, "crossings of break points of the law per cycle", CELL, least=0.0),
    "unstable_maximum": _real(
        "maximum of the least unstable cycle, over P/k1",
        "NaN without one; a vibration with a smaller maximum ends in steady sliding if that is stable",
    ),
    "cycle_speed_lim": _real(
        "largest belt speed with a stick-slip cycle, over omega_1 P/k1", "0: none has one; infinite: any has",
        ("mu", "beta"), 0.0,
    ),
    "beta_slope_lim": _real(
        "beta times the slope of a fall of friction at which steady sliding loses stability", "", (), 0.0
    ),
    "beta_slope_certificate": _real(
        "beta times the slope of a fall of friction below which every motion ends in steady sliding", "", (),
        0.0,
    ),
}  # fmt: skip
