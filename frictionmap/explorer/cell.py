"""One cell of a view: its motion in numbers, words and curves, and that from another initial state."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from .. import regimes
from ..errors import NoSteadyState
from ..model.general import refuse_general
from ..model.settings import Output, Start
from ..model.system import System
from ..pictures.classes import of_cells
from ..pictures.palette import UNRESOLVED
from ..single.maps import solve_map
from ..single.motion import MotionRequest, SteadyMotion, find_motion
from .drawing import drawing_curves, drawing_of
from .views import Follower, View, name_of_mass

#: Samples per excitation period: a curve a few hundred pixels wide is smooth with them.
_SAMPLES = 400

#: Masses whose numbers are listed one by one.
_LISTED = 12

#: Relative difference of amplitudes above which two initial states lead to different motions.
_OTHER = 1e-6

Packet = tuple[dict[str, Any], dict[str, np.ndarray]]


class Entry(NamedTuple):
    """A number of a cell, as the page lists it."""

    name: str
    label: str
    unit: str  # "length" and "energy" are named by the page, as the load is a force or a base's motion
    why: str = ""  # reason why there is no number


_ENTRIES = (
    Entry("stops_per_cycle", "stops per cycle", ""),
    Entry("stuck_fraction", "share of time stuck", "%"),
    Entry("contact_amplitude", "amplitude in the contact", "length"),
    Entry("contact_first_harmonic_amplitude", "first harmonic in the contact", "length"),
    Entry("contact_first_harmonic_phase", "phase lag of this harmonic", "rad"),
    Entry("amplitude", "amplitude of", "length"),
    Entry("phase_lag", "phase lag of", "rad"),
    Entry("work_friction", "energy dissipated by friction per cycle", "energy"),
    Entry("work_damping", "energy dissipated by damping per cycle", "energy"),
    Entry("equivalent_damping", "equivalent damping of the contact, cω/k₁", ""),
    Entry("period", "period, in excitation periods", ""),
    Entry("beta_lim", "β_lim at this r", ""),
    Entry("beta_stick", "β_stick at this r", ""),
)

#: What a motion without slides has, and what else a list would only repeat.
_MOVING = ("stops_per_cycle", "contact_amplitude", "contact_first_harmonic_amplitude",
           "contact_first_harmonic_phase", "work_friction", "equivalent_damping")  # fmt: skip


def motion(view: View, r: float, beta: float, follower: Follower) -> Packet:
    """The motion in a cell for the page.

    Arrays over `tau`: `z`, its velocity `z_rate`, `friction`, `direction` (-1, 0, 1), `x` (masses, tau).
    Moduli of harmonics 0 to 7: `z_harmonics`, `friction_harmonics`.  `numbers` are those of the header's
    `entries`; its `dofs` are the numbers of the masses.  Its `drawing` describes what is drawn in motion,
    with the arrays of `drawing_curves`.

    Where there is no steady state, the header says why under `none`, and there are no arrays.
    """
    view.check(r)
    follower.watch()
    if view.system.general is not None:
        from .general_cell import general_motion  # this module is needed for few systems

        return general_motion(view, r, beta)
    # what a map is asked for beside the motion would take as long again
    solver = replace(view.solver, outputs=("regime",))
    try:
        found = find_motion(MotionRequest(view.system, r, beta, view.mu, solver, _SAMPLES))
    except NoSteadyState as error:
        return {"r": r, "beta": beta, "class": UNRESOLVED, "none": str(error)}, {}
    values = _numbers(found)
    regime, stops = (np.array([values[name]]) for name in ("regime", "stops_per_cycle"))
    entries, numbers = _listed(view.system, values)
    header = {
        "r": r,
        "beta": beta,
        "class": int(of_cells(regime, stops)[0]),
        "regime": next(code.name for code in regimes.REGIMES if code.value == regime[0]),
        "summary": describe_motion(beta, values),
        "entries": [entry._asdict() for entry in entries],
        "comment": found.comment,
        "dofs": view.system.dofs.numbers,
        "drawing": drawing_of(view.system),
    }
    return header, {**curves_of(view, found), "numbers": np.array(numbers)}


def _numbers(found: SteadyMotion) -> dict[str, Any]:
    """The numbers of a cell, as a dataset would have them."""
    limits = {name: float(getattr(found.curves, name)[0, 0]) for name in ("beta_lim", "beta_stick")}
    return {**found.cycle, **found.summary, **limits}


def _listed(system: System, values: Mapping[str, Any]) -> tuple[list[Entry], list[float]]:
    """Entries of the list of a cell and their numbers, those of masses one by one."""
    entries: list[Entry] = []
    numbers: list[float] = []
    stuck = values["regime"] == regimes.PERMANENT_STICKING
    for entry in _ENTRIES:
        if stuck and entry.name in _MOVING:
            continue
        of_masses = np.ndim(values[entry.name]) == 1
        for row, value in enumerate(np.atleast_1d(values[entry.name])[:_LISTED].tolist()):
            mass = f" {name_of_mass(system, system.dofs.numbers[row])}" if of_masses else ""
            none = entry.name == "phase_lag" and np.isnan(value)
            why = _reason_for_no_lag(values, row) if none else ""
            entries.append(entry._replace(label=entry.label + mass, why=why))
            numbers.append(100.0 * value if entry.unit == "%" else float(value))
    return entries, numbers


def _reason_for_no_lag(values: Mapping[str, Any], k: int) -> str:
    """Explain why mass k, counted from 0, has no lag: its maximum has no single phase in the cycle."""
    period = int(values["period"])
    if period != 1:
        return f"the period is {period} cycles" if period else "the motion has no period"
    if values["amplitude"][k] == 0.0:
        return "the mass is at rest"
    begin, end = (f"{values[name][k]:.3f}".replace("-", "−") for name in ("phase_begin", "phase_end"))
    return f"held at its maximum from {begin} to {end} rad"


def curves_of(view: View, found: SteadyMotion) -> dict[str, np.ndarray]:
    """Curves of a motion for the page, float32."""
    system, history = view.system, found.history
    rate = system.contact_vector @ history.v + system.base_motion * np.sin(history.tau)
    drawn = {
        "tau": history.tau,
        "z": history.z,
        "z_rate": np.where(history.direction == 0, 0.0, rate),  # at rest to the bit, not to rounding
        "friction": history.friction,
        "x": history.x,
        "z_harmonics": _moduli(found.cycle["contact_harmonic"]),
        "friction_harmonics": _moduli(found.cycle["friction_harmonic"]),
    }
    arrays = {name: values.astype(np.float32) for name, values in drawn.items()}
    return {**arrays, **drawing_curves(system, history.tau), "direction": history.direction}


def _moduli(harmonics: np.ndarray) -> np.ndarray:
    return np.hypot(harmonics[..., 0], harmonics[..., 1])


def describe_motion(beta: float, numbers: Mapping[str, Any]) -> list[str]:
    """Describe in sentences what the contact does in a cell, and why."""
    sentences = [_describe_regime(numbers)]
    lim, stick = numbers["beta_lim"], numbers["beta_stick"]
    if beta >= stick:
        why = f"β = {beta:.4g} reaches β_stick = {stick:.4g}: friction can hold the contact permanently."
    elif beta < lim:
        why = f"β = {beta:.4g} lies below β_lim = {lim:.4g}: the contact can slide without stopping."
    else:
        why = (
            f"β = {beta:.4g} lies between β_lim = {lim:.4g} and β_stick = {stick:.4g}: friction stops the "
            "contact, but cannot hold it permanently."
        )
    sentences.append(why)
    status = int(numbers["status"])
    if status != regimes.RESOLVED:
        meaning = regimes.status_meaning(status)
        sentences.append(f"{meaning[0].upper()}{meaning[1:]}.")
    return sentences


def _describe_regime(numbers: Mapping[str, Any]) -> str:
    regime = numbers["regime"]
    if regime == regimes.PERMANENT_STICKING:
        return "The contact never slides: friction holds it permanently."
    if regime == regimes.CONTINUOUS:
        return "The contact slides to and fro without stopping."
    if regime == regimes.UNRESOLVED:
        return "No steady state was found."
    stops, stuck = numbers["stops_per_cycle"], 100.0 * numbers["stuck_fraction"]
    plural = "stop" if stops == 1.0 else "stops"
    return f"The contact slides and stops: {stops:.4g} {plural} per cycle; stuck {stuck:.3g} % of the time."


_STARTS: dict[str, Start] = {"rest": "moving", "moving": "rest"}


def others(view: View, r: float, beta: float, follower: Follower) -> Packet:
    """Stability of a cell, its reachable regimes, and the motion from the other initial state.

    The header has `start`, the other one, `same`, `summary` and the `reachable` regimes; the arrays
    `multiplier` and, of another motion, what `motion` has of it.
    """
    refuse_general(view.system, "compare initial states")
    view.check(r)
    start = _STARTS[view.solver.start]
    there = replace(view, solver=replace(view.solver, start=start))
    own = _one(view, r, beta, follower, "contact_amplitude", "multiplier", "also_reachable")
    other_end = _one(there, r, beta, follower, "contact_amplitude")
    flags = int(own["also_reachable"])
    header: dict[str, Any] = {
        "r": r,
        "beta": beta,
        "start": start,
        "same": _alike(own, other_end),
        "summary": [],
        "reachable": [code.name for code in regimes.REACHABLE if flags & code.value],
    }
    arrays = {"multiplier": np.array([float(own["multiplier"])])}
    if not header["same"]:
        other, curves = motion(there, r, beta, follower)
        header["summary"] = [other["none"]] if "none" in other else other["summary"][:1]
        arrays |= curves
    return header, arrays


def _one(view: View, r: float, beta: float, follower: Follower, *outputs: Output) -> dict[str, Any]:
    """Compute a map of one cell."""
    axes = {"mu": np.array([view.mu]), "r": np.array([r]), "beta": np.array([beta])}
    solver = replace(view.solver, outputs=("regime", *outputs))
    found, _ = solve_map(view.system, axes, solver, 1, None, follower.watch)
    return {name: values[0, 0, 0] for name, values in found.items()}


def _alike(one: Mapping[str, Any], other: Mapping[str, Any]) -> bool:
    """Whether two initial states lead to the same regime with the same amplitude."""
    if one["regime"] != other["regime"]:
        return False
    sizes = float(one["contact_amplitude"]), float(other["contact_amplitude"])
    return bool(np.isclose(*sizes, rtol=_OTHER, atol=_OTHER, equal_nan=True))
