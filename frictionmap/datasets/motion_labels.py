"""Names, types and valid values of motions in time under records, and of their spectra."""

import re

import numpy as np
import xarray as xr

from .. import regimes
from .labels import SI, Label

#: Dimensions of variables of every motion.
CELL = ("record", "scale", "mu", "beta")

STATUSES = (
    regimes.Code(0, "resolved", "followed to the end that was wanted"),
    regimes.Code(1, "ringing", "contacts may move on after the longest time; give a time as `after`"),
    regimes.Code(2, "creeping", "a contact slides ever slower and never stops; it rests at `residual`"),
    regimes.Code(3, "too_many_events", "chattering: more than 2000 events between two samples"),
    regimes.Code(4, "record_too_short", "it ended before all contacts were at rest permanently"),
    regimes.Code(5, "undetermined", "contacts close a loop in a common stop, and their forces are not "
                 "determined"),
    regimes.Code(6, "not_computed", "of a block of a store that is not computed yet"),
)  # fmt: skip

#: Status in cells of a store that are not computed.
NOT_COMPUTED = STATUSES[-1].value

_KINDS = (
    regimes.Code(-1, "none", "no event: there are fewer than in other motions"),
    regimes.Code(0, "stop", "a slide ends"),
    regimes.Code(1, "start", "a slide begins"),
    regimes.Code(2, "turn", "the sense of a slide changes without a stop"),
    regimes.Code(3, "opening", "the contact opens"),
    regimes.Code(4, "closing", "the contact closes"),
    regimes.Code(5, "knot", "a piecewise linear spring, whose number `event_contact` is, passes a knot"),
)

OPENINGS = (
    regimes.Code(0, "closed", "the contact has a normal force"),
    regimes.Code(1, "open", "the contact is open: it has no normal force"),
)  # fmt: skip

SENSES = (
    regimes.Code(-1, "sliding_down", "the contact slides towards smaller z"),
    regimes.Code(0, "sticking", "the contact sticks, or its spring does not slip"),
    regimes.Code(1, "sliding_up", "the contact slides towards larger z"),
)

_X, _V, _A, _F, _E = "over P/k1", "over omega_1 P/k1", "over omega_1^2 P/k1", "over P", "over P^2/k1"
_REST = "NaN where contacts may move again"


def _real(meaning: str, *dims: str, comment: str = "", least: float = -np.inf, units: str = "1") -> Label:
    return Label(
        np.float64, meaning, (*CELL, *dims), comment=comment, least=least, nan=True, inf=True, units=units
    )


def _size(meaning: str, *dims: str, comment: str = "") -> Label:
    return _real(meaning, *dims, comment=comment, least=0.0)


#: Variables by name; times are in 1/omega_1, or in seconds with units.
MOTIONS = {
    "record": Label(np.int64, "record, counted from 1", ("record",), least=1),
    "scale": Label(np.float64, "factor of the record", ("scale",)),
    "mu": Label(np.float64, "ratio of static to kinetic friction force", ("mu",), least=1.0),
    "beta": Label(np.float64, "kinetic friction force, over P", ("beta",), least=0.0),
    "period": Label(np.float64, "natural period, over 1/omega_1", ("period",), least=0.0, inf=True),
    "time": Label(np.float64, "time since the beginning of the record, over 1/omega_1", ("time",), least=0.0),
    "dof": Label(np.int64, "mass, counted from 1", ("dof",), least=1),
    "contact": Label(np.int64, "contact, counted from 1", ("contact",), least=1),
    "contact_name": Label(np.str_, "name of the contact", ("contact",)),
    "spring": Label(np.int64, "piecewise linear spring, counted from 1", ("spring",), least=1),
    "spring_name": Label(np.str_, "name of the spring", ("spring",)),
    "record_name": Label(np.str_, "name of the record", ("record",)),
    "point_name": Label(np.str_, "name of the point", ("dof",)),
    "x": _real(f"displacement of the masses, {_X}", "dof", "time"),
    "v": _real(f"velocity of the masses, {_V}", "dof", "time"),
    "acceleration": _real(f"absolute acceleration of the masses, {_A}", "dof", "time"),
    "z": _real(f"motion in the contact, {_X}", "time"),
    "friction": _real(f"friction force against the motion in the contact, {_F}", "time"),
    "direction": Label(np.int8, "direction of the motion in the contact", (*CELL, "time"), SENSES),
    "y": _real(
        f"displacement of the slider of an elastic contact, {_X}", "time",
        comment="of a bank the mean over its elements by their stiffness",
    ),
    "normal_force": _size(
        f"normal force in the contact, {_F}", "time", comment="NaN where the motion does not change it"
    ),
    "open": Label(np.int8, "whether the contact is open", (*CELL, "time"), OPENINGS),
    "piecewise_force": _real(f"force of a piecewise linear spring, {_F}", "spring", "time"),
    "drive": _real("the record: a force over P, or the acceleration of the base over omega_1^2 P/k1", "time"),
    "stored_energy": _real(f"energy of masses and springs, also of the springs in contacts, {_E}", "time"),
    "lost_friction": _real(f"lost in the contact since the beginning, {_E}", "time"),
    "lost_damping": _real(f"lost in the damping since the beginning, {_E}", "time"),
    "event_time": _real("time of the event, over 1/omega_1", "event", comment="padded with NaN"),
    "event_contact": Label(
        np.int64, "contact that the event is of, counted from 1; 0: none", (*CELL, "event"), least=0
    ),
    "event_kind": Label(np.int8, "kind of the event", (*CELL, "event"), _KINDS),
    "events": Label(np.int64, "number of events", CELL, least=0),
    "amplitude": _size(f"largest displacement of the masses, {_X}", "dof"),
    "acceleration_amplitude": _size(f"largest absolute acceleration of the masses, {_A}", "dof"),
    "contact_amplitude": _size(f"largest motion in the contact, {_X}"),
    "friction_amplitude": _size(f"largest force in the contact, {_F}"),
    "amplitude_time": _size("time of the largest displacement of the masses", "dof"),
    "acceleration_amplitude_time": _size("time of the largest absolute acceleration of the masses", "dof"),
    "contact_amplitude_time": _size("time of the largest motion in the contact"),
    "friction_amplitude_time": _size("time of the largest force in the contact"),
    "x_max": _real(f"largest displacement of the masses, {_X}", "dof"),
    "x_min": _real(f"least displacement of the masses, {_X}", "dof"),
    "z_max": _real(f"largest motion in the contact, {_X}"),
    "z_min": _real(f"least motion in the contact, {_X}"),
    "acceleration_max": _real(f"largest absolute acceleration of the masses, {_A}", "dof"),
    "acceleration_min": _real(f"least absolute acceleration of the masses, {_A}", "dof"),
    "friction_max": _real(f"largest force in the contact, {_F}"),
    "friction_min": _real(f"least force in the contact, {_F}"),
    "residual": _real(f"place where the masses come to rest, {_X}", "dof", comment=_REST),
    "contact_residual": _real(f"place where the contact comes to rest, {_X}", comment=_REST),
    "modal_place": _real(f"displacement q of the given modes at the end, x = Phi q {_X}", "mode"),
    "modal_velocity": _real(f"velocity of these modes at the end, {_V}", "mode"),
    "stops": _size("stops: ends of slides"),
    "slips": _size("slips of an elastic contact"),
    "turns": _size("changes of the sense of a slide without a stop"),
    "stuck_fraction": Label(
        np.float64, "share of the time in which the contact does not slide", CELL, least=0.0, most=1.0,
        nan=True,
    ),
    "separations": _size("openings of the contact"),
    "open_fraction": Label(
        np.float64, "share of the time in which the contact is open", CELL, least=0.0, most=1.0, nan=True
    ),
    "normal_force_max": _size(f"largest normal force in the contact, {_F}"),
    "normal_force_min": _size(f"least normal force in the contact, {_F}"),
    "spring_force_max": _size(f"largest force of a piecewise linear spring, {_F}", "spring"),
    "spring_crossings": _size("knots that a piecewise linear spring passes", "spring"),
    "element_contact": Label(np.int64, "contact of each element of a bank", ("element",), least=1),
    "elongation": _real(
        f"elongation of the spring of each element of a bank at the end, {_X}", "element",
        comment="elements of one contact in the order in which they slip",
    ),
    "sliding_distance": _size(f"sliding distance, {_X}"),
    "largest_slide": _size(f"longest distance of a slide, {_X}"),
    "work_load": _real(f"work of the load, {_E}", comment="of -M iota a where the base moves"),
    "work_friction": _real(f"work lost in the contact, {_E}"),
    "work_damping": _real(f"work lost in the damping, {_E}"),
    "work_walls": _real(f"work of walls that move, belts included, {_E}"),
    "energy": _real(f"energy at the end, of the springs in contacts, too, {_E}"),
    "base_force": _size(
        f"largest force of springs and dampers on the base, {_F}",
        comment="(K x + C x') ones; without the friction of walls, which base_force of maps includes",
    ),
    "base_force_max": _real(f"largest force of the base on springs and dampers, {_F}"),
    "base_force_min": _real(f"least force of the base on springs and dampers, {_F}"),
    "spring_force": _size(f"largest force in the spring below each mass of a chain, {_F}", "dof"),
    "beta_hold": Label(
        np.float64, "friction, over P, from which no contact ever moves", ("record", "scale", "mu"),
        least=0.0, nan=True, inf=True,
    ),
    "end_time": _size("time at the end, over 1/omega_1"),
    "asleep_time": _size(
        "time from which no contact moves again, over 1/omega_1",
        comment="the first sample at which this is proved; NaN where it is not",
    ),
    "first_motion": _size(
        "time at which the first slide begins, over 1/omega_1",
        comment="0 of a contact that slides at the beginning; NaN where none slides",
    ),
    "status": Label(np.int8, "how the motion ended", CELL, STATUSES),
}  # fmt: skip

#: Statistics of a stationary motion by their ends of names, and the quantities that have them.
AVERAGES = {
    "mean": "mean of the {}", "mean_error": "standard error of the mean of the {}",
    "variance": "variance of the {}", "variance_error": "standard error of the variance of the {}",
    "peak": "mean of the largest modulus of the {} in a window",
    "peak_error": "standard error of the mean largest modulus of the {}",
    "batch_correlation": "correlation of the means of neighbouring batches of the {}",
}  # fmt: skip
AVERAGED = {
    "x": "length",
    "v": "velocity",
    "acceleration": "acceleration",
    "z": "length",
    "friction": "force",
}


def _average(of: str, end: str) -> Label:
    words, _, over = MOTIONS[of].long_name.partition(", ")
    least = 0.0 if end.startswith("peak") or end.endswith("error") or end == "variance" else -np.inf
    squared = f", squared {over}" if "variance" in end else f", {over}"
    dims = [dim for dim in MOTIONS[of].dims[len(CELL) :] if dim != "time"]
    return _real(AVERAGES[end].format(words) + ("" if "correlation" in end else squared), *dims, least=least)


MOTIONS |= {f"{of}_{end}": _average(of, end) for of in AVERAGED for end in AVERAGES}

#: Meaning of `drive` where all records are forces, or move the base.
DRIVES = {
    "force": "the record: a force, over P",
    "base": "the record: acceleration of the base, over omega_1^2 P/k1",
}

#: Variables with one value per contact: the dimension `contact` stands before `time`, if there are several.
OF_CONTACTS = (
    "z", "friction", "direction", "y", "contact_amplitude", "friction_amplitude", "contact_amplitude_time",
    "friction_amplitude_time", "z_max", "z_min", "friction_max", "friction_min", "contact_residual", "stops",
    "slips", "turns", "stuck_fraction", "sliding_distance", "largest_slide", "work_friction",
    "lost_friction", "normal_force", "open", "normal_force_max", "normal_force_min", "separations",
    "open_fraction",
)  # fmt: skip

#: Times: in seconds where the natural frequency is known.
TIMES = (
    "time", "event_time", "amplitude_time", "acceleration_amplitude_time", "contact_amplitude_time",
    "friction_amplitude_time", "end_time", "asleep_time", "first_motion", "period",
)  # fmt: skip

#: Variables with a counterpart in SI units, by measure.
IN_SI: dict[str, tuple[str, ...]] = {
    "length": (
        "x", "z", "y", "amplitude", "contact_amplitude", "x_max", "x_min", "z_max", "z_min", "residual",
        "contact_residual", "sliding_distance", "largest_slide", "elongation",
    ),
    "velocity": ("v",),
    "acceleration": ("acceleration", "acceleration_amplitude", "acceleration_max", "acceleration_min"),
    "force": (
        "friction", "friction_amplitude", "friction_max", "friction_min", "base_force", "base_force_max",
        "base_force_min", "spring_force", "beta_hold", "normal_force", "normal_force_max",
        "normal_force_min", "piecewise_force", "spring_force_max",
    ),
    "work": ("work_load", "work_friction", "work_damping", "work_walls", "energy",
             "stored_energy", "lost_friction", "lost_damping"),
}  # fmt: skip

_SQUARED = "squared "
for _of, _measure in AVERAGED.items():
    IN_SI[_measure] += tuple(f"{_of}_{end}" for end in ("mean", "mean_error", "peak", "peak_error"))
    _square = _SQUARED + _measure
    IN_SI[_square] = (*IN_SI.get(_square, ()), f"{_of}_variance", f"{_of}_variance_error")

#: SI units by measure: as in CF conventions, and at the end of a name.
SI_UNITS = {
    **SI,
    f"{_SQUARED}length": ("m2", "m2"), f"{_SQUARED}velocity": ("m2 s-2", "m2_s2"),
    f"{_SQUARED}acceleration": ("m2 s-4", "m2_s4"), f"{_SQUARED}force": ("N2", "N2"),
}  # fmt: skip


def spans(time: np.ndarray, happens: np.ndarray) -> np.ndarray:
    """Beginnings and ends (k, 2) of the times in which something happens, of a bool at every sample."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], happens, [False])).astype(int)))
    return time[np.minimum(edges, time.size - 1)].reshape(-1, 2)


def stuck_times(time: np.ndarray, directions: np.ndarray) -> np.ndarray:
    """Beginnings and ends of the times in which all contacts stick, of directions (contact, time)."""
    return spans(time, (directions == 0).all(axis=0))


def si_name(name: str, measure: str) -> str:
    """Name of a variable in its SI unit."""
    return f"{name}_{SI_UNITS[measure][1]}"


def _si_label(name: str, measure: str) -> Label:
    label = MOTIONS[name]
    return label._replace(
        long_name=re.split(", (?:squared )?over ", label.long_name)[0],
        comment="",
        units=SI_UNITS[measure][0],
    )


SI_LABELS = {
    si_name(name, measure): _si_label(name, measure) for measure, names in IN_SI.items() for name in names
}


def motion_labels() -> dict[str, Label]:
    """Labels of all variables and axes."""
    return {**MOTIONS, **SI_LABELS}


def axes_of_motions(ds: xr.Dataset) -> list[str]:
    """Further axes of motions or spectra: dimensions before those of every motion."""
    return [str(dim) for dim in ds["status"].dims if dim not in (*CELL, "period")] if "status" in ds else []
