"""Names, units and meanings of motions on a belt without a load, over mu, belt speed and beta."""

import numpy as np

from .. import regimes
from .labels import BESIDE, COORDINATES, HISTORY_VARIABLES, Label, in_si, si_units
from .motion_labels import SENSES

CELL = ("mu", "wall_speed", "beta")


_REACHABLE = tuple(
    one._replace(value=1 << one.value) for one in regimes.NO_LOAD_REGIMES if one.value != regimes.UNRESOLVED
)


def _cycle_label(meaning: str, *further: str, least: float = -np.inf) -> Label:
    return Label(
        np.float64, meaning, (*CELL, *further), comment="NaN in steady sliding", least=least, nan=True
    )


def _real(
    meaning: str, comment: str = "", dims: tuple[str, ...] = CELL, least: float = -np.inf, units: str = "1"
) -> Label:
    return Label(np.float64, meaning, dims, comment=comment, least=least, nan=True, inf=True, units=units)


_NORMAL = "NaN for a contact whose normal force does not move"

_RATIOS = {
    "mu": COORDINATES["mu"],
    "wall_speed": Label(np.float64, "speed of the belt, over omega_1 P/k1", ("wall_speed",), least=0.0),
    "beta": COORDINATES["beta"],
    "dof": COORDINATES["dof"],
    "contact": BESIDE["contact"],
    "contact_name": BESIDE["contact_name"],
    "point_name": BESIDE["point_name"],
    "time": Label(np.float64, "time since the beginning, over 1/omega_1", ("time",), least=0.0),
    "friction_force": BESIDE["friction_force"],
    "friction_coefficient": BESIDE["friction_coefficient"],
    "regime": Label(
        np.int8, "motion that begins where the belt releases the mass", CELL, regimes.NO_LOAD_REGIMES
    ),
    "also_reachable": Label(
        np.uint8, "every stable motion of the cell", CELL, _REACHABLE, flags="flag_masks"
    ),
    "status": Label(np.int8, "how certain the motions are", CELL, regimes.BELT_STATUSES),
    "growth": _real("growth rate of small vibrations about steady sliding, over omega_1", "< 0: stable"),
    "growth_frequency": _real("frequency of these vibrations, over omega_1", least=0.0),
    "cycle_period": _cycle_label("period of the cycle, over 1/omega_1", least=0.0),
    "stops_per_cycle": _real("number of stops per cycle", least=0.0),
    "turns_per_cycle": _real("changes of the sense of a slide without a stop, per cycle", least=0.0),
    "stuck_fraction": _real("part of the cycle in which the mass sticks", least=0.0),
    "x_max": _real("largest displacement of the masses, over P/k1", "", (*CELL, "dof")),
    "x_min": _real("least displacement of the masses, over P/k1", "", (*CELL, "dof")),
    "z_max": _real("largest displacement in the contact, over P/k1"),
    "z_min": _real("least displacement in the contact, over P/k1"),
    "multiplier": _cycle_label("factor of a small deviation per cycle", least=0.0),
    "segment_crossings": _real("crossings of break points of the law per cycle", least=0.0),
    "open_fraction": _real("part of the cycle in which the contact is open", _NORMAL, least=0.0),
    "separations_per_cycle": _real("separations of the contact that begin per cycle", _NORMAL, least=0.0),
    "normal_force_min": _real("least normal force in the contact, over P", _NORMAL, least=0.0),
    "normal_force_max": _real("largest normal force in the contact, over P", _NORMAL, least=0.0),
    "spring_crossings": _real(
        "knots of a piecewise linear spring that its displacement passes, per cycle", "", (*CELL, "spring"),
        0.0,
    ),
    "spring_force_max": _real(
        "largest modulus of the force of a piecewise linear spring, over P", "", (*CELL, "spring"), 0.0
    ),
    "normal_force": _real("normal force in the contact, over P", _NORMAL, ("time",), 0.0),
    "open": Label(np.int8, "whether the contact is open", ("time",), HISTORY_VARIABLES["open"].codes),
    "spring_force": _real("force of a piecewise linear spring, over P", "", ("spring", "time")),
    "spring": COORDINATES["spring"],
    "spring_name": BESIDE["spring_name"],
    "unstable_maximum": _real(
        "largest displacement, in the direction of the belt, in the least unstable cycle, over P/k1",
        "NaN without one; a smaller vibration ends in steady sliding if that is stable",
    ),
    "x": _real("displacement of the masses, over P/k1", "", ("dof", "time")),
    "v": _real("velocity of the masses, over omega_1 P/k1", "", ("dof", "time")),
    "z": _real("motion in the contact, over P/k1", "", ("time",)),
    "friction": _real("friction force against the motion in the contact, over P", "", ("time",)),
    "direction": Label(np.int8, "direction of the slide over the wall", ("time",), SENSES),
    "cycle_speed_lim": _real(
        "largest belt speed with a stick-slip cycle, over omega_1 P/k1", "0: none has one; infinite: any has",
        ("mu", "beta"), 0.0,
    ),
    "sliding_speed_lim": _real(
        "belt speed above which steady sliding is stable at every speed, over omega_1 P/k1",
        "0: it is stable at all speeds", ("beta",), 0.0,
    ),
    "beta_sliding_lim": _real(
        "friction ratio from which steady sliding is unstable", "infinite where friction does not fall",
        ("wall_speed",), 0.0,
    ),
    "beta_slope_lim": _real(
        "friction ratio times slope of its fall over speed from which steady sliding on a belt is unstable",
        "", (), 0.0,
    ),
    "beta_slope_certificate": _real(
        "friction ratio times steepest slope of its fall up to which every motion ends in steady sliding",
        "for mu = 1", (), 0.0,
    ),
}  # fmt: skip

#: Variables and axes with a counterpart in SI units where the reference values are known, by measure.
MEASURES = {
    "length": ("x_max", "x_min", "unstable_maximum", "x", "z", "z_max", "z_min"),
    "time": ("cycle_period", "time"),
    "velocity": ("wall_speed", "v", "cycle_speed_lim", "sliding_speed_lim"),
    "force": (
        "beta_sliding_lim",
        "friction",
        "normal_force_min",
        "normal_force_max",
        "spring_force_max",
        "normal_force",
        "spring_force",
    ),
    "frequency": ("growth_frequency",),
}

#: Labels by name; times are over 1/omega_1, displacements over P/k1.
BELTS = _RATIOS | {
    in_si(name, measure): _RATIOS[name]._replace(
        long_name=_RATIOS[name].long_name.partition(", over ")[0], units=si_units(measure)
    )
    for measure, names in MEASURES.items()
    for name in names
}

#: Variables that have one value per contact where there are several.
OF_CONTACTS = (
    "stops_per_cycle", "turns_per_cycle", "stuck_fraction", "segment_crossings", "z", "friction", "direction",
    "z_max", "z_min", "z_m", "z_max_m", "z_min_m", "friction_N", "open_fraction",
    "separations_per_cycle", "normal_force_min",
    "normal_force_max", "normal_force", "open", "normal_force_min_N", "normal_force_max_N", "normal_force_N",
)  # fmt: skip

#: Coordinates; the others are variables.
AXES = (
    *CELL, "dof", "point_name", "time", "time_s", "contact", "contact_name", "wall_speed_m_s",
    "friction_force", "friction_coefficient", "spring", "spring_name",
)  # fmt: skip
