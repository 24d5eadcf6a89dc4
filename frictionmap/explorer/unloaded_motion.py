"""One motion on a belt without a load, as the page shows it: in numbers, words and curves."""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from .. import regimes
from ..errors import NoSteadyState
from ..no_load.belts import belts_of
from ..no_load.response import belt_response
from ..pictures.palette import NO_LOAD
from .belt_classes import LOOKS
from .drawing import OPEN, drawing_of, mass_names, vectors_of
from .numbers import Number
from .quantities import name_of_mass
from .unloaded import limits_of, one_cell
from .views import Follower, View

Packet = tuple[dict[str, Any], dict[str, np.ndarray]]

#: Samples of a motion, as many as a period has under a load.
_SAMPLES = 400

#: What the contact does, by regime.
_DOES = {
    regimes.STEADY_SLIDING: "The belt slides steadily under the structure, which does not vibrate",
    regimes.STICK_SLIP_CYCLE: "The belt carries the contact along until it tears off, slips back and sticks "
    "again",
    regimes.CYCLE_WITHOUT_STOPS: "The structure vibrates, and the contact never sticks to the belt",
}

_OF_CONTACT = (
    Number("stops_per_cycle", "stops per cycle"),
    Number("stuck_fraction", "share of time stuck", "%"),
    Number("open_fraction", "share of time open", "%"),
    Number("normal_force_min", "least normal force", "force"),
    Number("normal_force_max", "largest normal force", "force"),
    Number("peak_to_peak", "peak to peak in the contact", "length"),
)
_OF_MASS = (
    Number("x_max", "largest displacement of", "length"),
    Number("x_min", "least displacement of", "length"),
)
_OF_CELL = (
    Number("cycle_frequency", "frequency of the cycle", "frequency"),
    Number("multiplier", "factor of a small deviation per cycle"),
    Number("growth", "growth rate of small vibrations", "growth"),
    Number("growth_frequency", "frequency of small vibrations", "frequency"),
    Number("cycle_speed_lim", "largest belt speed with a stick-slip cycle", "velocity"),
    Number("beta_sliding_lim", "β at which steady sliding loses stability"),
)


def motion(view: View, speed: float, beta: float, follower: Follower) -> Packet:
    """The motion in a cell for the page; see `cell.motion`.

    `tau` is 2 pi after a period of the cycle; of motions without a period it is the time over 1/omega_1.
    """
    follower.watch()
    header: dict[str, Any] = {"r": speed, "beta": beta, "others": False}
    start = "moving" if view.solver.start == "moving" else None
    try:
        ds = belt_response(view.system, speed, beta, view.mu, _SAMPLES, None, start)
    except NoSteadyState as error:
        return {**header, "class": 0, "none": str(error)}, {}
    follower.watch()
    values = {str(name): one.values for name, one in {**ds.variables}.items()}
    found = one_cell(view, speed, beta)
    limits = {name: float(one[0]) for name, one in
              limits_of(view, np.array([speed]), np.array([beta])).items()}  # fmt: skip
    entries = list(_entries(view, values, limits))
    period = float(values["cycle_period"])
    several = len(view.contacts) > 1
    header |= {
        "class": found, "regime": NO_LOAD[int(values["regime"])].label.capitalize(),
        "summary": _sentences(view, values, limits, LOOKS[found].label, (speed, beta)),
        "entries": [entry._asdict() for entry, _ in entries], "comment": "", "dofs": mass_names(view.system),
        "contacts": [one.name for one in view.contacts] if several else [],
        "listed": list(range(len(view.contacts)))[:8],
        "contact": view.contacts[0].name if view.contact is not None else "",
        "still": ["stuck"] * len(view.contacts), "drawing": drawing_on_belt(view, speed),
        "rate": 2.0 * np.pi / period if np.isfinite(period) else 1.0,
        "clock": "period of the cycle" if np.isfinite(period) else "2π/ω₁",
    }  # fmt: skip
    return header, {**_curves(view, values, speed, period), "numbers": np.array([one for _, one in entries])}


def drawing_on_belt(view: View, speed: float) -> dict[str, Any]:
    """The drawing of the system, without loads, its walls as fast as the belt moves them."""
    found = drawing_of(view.system, view.shown)
    share = belts_of(view.system).share
    walls = [{**one, "belt": float(speed * share[one["row"]])} for one in found["contacts"]]
    return {**found, "loaded": [], "contacts": walls}


def _rows(values: Mapping[str, np.ndarray], name: str) -> np.ndarray:
    """Traces or numbers of contacts, with a row for the only one."""
    one = values[name]
    of_one = 1 if name in ("z", "friction", "direction", "open") else 0
    return one[np.newaxis] if one.ndim == of_one else one


def _curves(
    view: View, values: Mapping[str, np.ndarray], speed: float, period: float
) -> dict[str, np.ndarray]:
    """Curves of a motion, float32: of the contact that is shown, or one row per contact."""
    belts = belts_of(view.system)
    k, several = view.shown, view.shown is None
    tau = values["time"] * (2.0 * np.pi / period if np.isfinite(period) else 1.0)
    direction = _rows(values, "direction")
    rate = vectors_of(view.system) @ values["v"]
    rate = np.where(direction == 0, speed * belts.share[:, np.newaxis], rate)  # stuck, it is that of the belt
    opened = _rows(values, "open") if "open" in values else np.zeros_like(direction)
    states = np.where(opened == 1, OPEN, direction).astype(np.int8)
    traces = {"z": _rows(values, "z"), "z_rate": rate, "friction": _rows(values, "friction")}
    rows = {name: one if several else one[k] for name, one in traces.items()}
    drawn = {"tau": tau, "x": values["x"], **rows, "stretched": np.zeros(direction.shape)}
    return {
        **{name: np.ascontiguousarray(one, np.float32) for name, one in drawn.items()},
        "states": states,
        "direction": np.ascontiguousarray(direction if several else direction[k]).astype(np.int8),
    }


def _entries(
    view: View, values: Mapping[str, np.ndarray], limits: Mapping[str, float]
) -> Iterator[tuple[Number, float]]:
    """The list of a motion; without unknown numbers, and in steady sliding without those of a cycle."""
    groups = view.system.contact_system.groups
    moves = np.isfinite(values["cycle_period"]) or int(values["regime"]) != regimes.STEADY_SLIDING
    of_contacts = {number.name: _rows(values, number.name) for number in _OF_CONTACT if number.name in values}
    of_contacts["peak_to_peak"] = _rows(values, "z_max") - _rows(values, "z_min")
    for j in range(len(groups)) if view.shown is None else [view.shown]:
        for number in _OF_CONTACT if moves else ():
            value = float(of_contacts[number.name][j]) if number.name in of_contacts else np.nan
            if np.isfinite(value):
                of = groups[j].name if len(groups) > 1 else ""
                yield number._replace(group=of), 100.0 * value if number.unit == "%" else value
    whole = "masses and all contacts" if len(groups) > 1 else ""
    for number in _OF_MASS:
        for mass, value in zip(view.system.dofs.numbers[:12], values[number.name].tolist(), strict=False):
            yield (
                number._replace(label=f"{number.label} {name_of_mass(view.system, mass)}", group=whole),
                value,
            )
    known = {**{name: float(one) for name, one in values.items() if one.ndim == 0}, **limits}
    known["cycle_frequency"] = 2.0 * np.pi / known["cycle_period"]
    for number in _OF_CELL:
        if np.isfinite(known.get(number.name, np.nan)):
            yield number._replace(group=whole), known[number.name]


def _sentences(
    view: View, values: Mapping[str, np.ndarray], limits: Mapping[str, float], stable: str,
    cell: tuple[float, float],
) -> list[str]:  # fmt: skip
    """What happens, what else may happen, and where the cell lies beside the limits."""
    regime, status = int(values["regime"]), int(values["status"])
    stuck = 100.0 * np.atleast_1d(values["stuck_fraction"]).max()
    much = f"; it sticks {stuck:.3g} % of the time" if regime == regimes.STICK_SLIP_CYCLE else ""
    found = [f"{_DOES[regime]}{much}."]
    if ";" in stable or " and " in stable:
        found.append(f"Stable here: {stable}. The initial state decides.")
    growth = float(values["growth"])
    decays = "decay" if growth < 0.0 else "grow"
    found.append(f"Small vibrations about steady sliding {decays} (growth rate {growth:.3g} ω₁).")
    speed = limits.get("cycle_speed_lim", np.nan)
    if np.isfinite(speed):
        place = "below" if cell[0] < speed else "at or above"
        found.append(f"v = {cell[0]:.4g} lies {place} v_cycle = {speed:.4g}, the largest belt speed with a "
                     "stick-slip cycle.")  # fmt: skip
    if status != regimes.RESOLVED:
        advice = next(one.meaning for one in regimes.BELT_STATUSES if one.value == status)
        found.append(f"{advice[0].upper()}{advice[1:]}.")
    return found
