"""One cell of a view: its motion in numbers, words and curves, and that from another initial state."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from .. import checks, regimes
from ..errors import InputError, NoSteadyState
from ..model.general import refuse_general
from ..model.settings import Start
from ..pictures.classes import of_cells
from ..pictures.palette import UNRESOLVED
from .drawing import OPEN, drawing_curves, drawing_of, mass_names, vectors_of
from .lines import values_of_lines
from .numbers import listed_contacts, numbers_of
from .quantities import counted_of
from .queries import PAGE, Query, needed
from .sentences import describe_motion
from .views import Follower, View

#: Samples per excitation period: a curve a few hundred pixels wide is smooth with them.
_SAMPLES = 400

#: Relative difference of amplitudes above which two initial states lead to different motions.
_OTHER = 1e-6

Packet = tuple[dict[str, Any], dict[str, np.ndarray]]

#: Keys of its query.
KEYS = ("at", *PAGE)


def read(query: Query) -> tuple[float, float]:
    """r and beta of a cell."""
    parts = needed(query.given, "at").split(",")
    if len(parts) != 2:
        got = checks.one_line(query.given["at"])
        raise InputError(f"at must be {query.view.across.key} and beta separated by a comma; got {got}")
    r, beta = query.cell(*parts)
    r = checks.number(r, query.view.across.key, above=0.0, most=checks.LARGEST_RATIO)
    return r, checks.number(beta, "beta", least=0.0)


def motion(view: View, r: float, beta: float, follower: Follower) -> Packet:
    """The motion in a cell for the page.

    Arrays over `tau`: `z`, its velocity `z_rate`, `friction`, `direction` (-1, 0, 1), `x` (masses, tau).
    Moduli of harmonics 0 to 7: `z_harmonics`, `friction_harmonics`.  They are those of the contact that is
    shown; all contacts together have one row per contact, and their names under `contacts`.  `numbers` are
    those of the header's `entries`; its `dofs` are the numbers of the masses.  Its `drawing` describes what
    is drawn in motion, with the arrays of `drawing_curves`, the directions in all contacts, `states`, and how
    far their springs are `stretched`.

    Where there is no steady state, the header says why under `none`, and there are no arrays.
    """
    if view.unloaded:
        from . import unloaded_motion

        return unloaded_motion.motion(view, r, beta, follower)
    view.check(r)
    if view.system.varies:
        view = replace(view, system=view.system.at_frequency(r))
    follower.watch()
    header: dict[str, Any] = {"r": r, "beta": beta, "others": view.engine.compares_starts}
    try:
        values, at_r, comment = view.engine.traced(r, beta, view.mu, view.solver, _SAMPLES)
    except NoSteadyState as error:
        return {**header, "class": UNRESOLVED, "none": str(error)}, {}
    limits = values_of_lines(view, at_r)
    entries, numbers = numbers_of(view, values, limits)
    k, several = view.shown, view.system.contact_system.count > 1
    header |= {
        **_regime(view, values), "summary": describe_motion(view, beta, values, limits),
        "entries": [entry._asdict() for entry in entries],
        "comment": comment, "dofs": mass_names(view.system),
        "contacts": [one.name for one in view.contacts] if k is None else [],
        "listed": listed_contacts(view, values),
        "contact": view.contacts[0].name if k is not None and several else "",
        "still": ["stuck" if one.stiffness is None else "without slip" for one in view.contacts],
        "drawing": drawing_of(view.system, k),
    }  # fmt: skip
    return header, {**curves_of(view, values), "numbers": numbers}


def _regime(view: View, values: Mapping[str, np.ndarray]) -> dict[str, Any]:
    """Class and regime of the contact shown, or of all: its name, or a heading where it has none."""
    by, k = counted_of(view), view.shown
    regime = np.array([values["regime"] if k is None else values["contact_regime"][k]])
    stops = np.array([values[by.variable][k]]) if by.variable else None
    found = int(of_cells(regime, stops)[0])
    if k is not None and not view.is_elastic:
        names = {code.value: code.name for code in regimes.BELT_REGIMES}
        return {"class": found, "regime": names[int(regime[0])]}
    label = by.labels[int(of_cells(regime, None)[0])]
    if regime[0] == regimes.STICK_SLIP:
        label = "stick-slip" if k is None else "slips and rests"
    return {"class": found, "regime": label[0].upper() + label[1:]}


def curves_of(view: View, values: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Curves of a motion for the page, float32: of the contact that is shown, or one row per contact."""
    system, k = view.system, view.shown
    tau, direction = values["tau"], values["direction"]
    traces = {
        "z": values["z"],
        "z_rate": _rates(view, values),
        "friction": values["friction"],
        "z_harmonics": _moduli(values["contact_harmonic"]),
        "friction_harmonics": _moduli(values["friction_harmonic"]),
    }
    rows = {name: table if k is None else table[k] for name, table in traces.items()}
    drawn = {"tau": tau, "x": values["x"], **rows, "stretched": _stretched(view, values["friction"])}
    return {
        **{name: table.astype(np.float32) for name, table in drawn.items()},
        **drawing_curves(system, tau, k),
        "states": np.where(values.get("open", np.zeros_like(direction)) == 1, OPEN, direction).astype(
            np.int8
        ),
        "direction": np.ascontiguousarray(direction if k is None else direction[k]).astype(np.int8),
    }


def _rates(view: View, values: Mapping[str, np.ndarray]) -> np.ndarray:
    """Velocity z' in every contact; that of its wall, where a rigid one is stuck."""
    contacts, tau = view.system.contact_system, values["tau"]
    base = sum(-n * (u * np.exp(1j * n * tau)).imag for n, u in contacts.base.items()) + np.zeros_like(tau)
    rows = []
    vectors = vectors_of(view.system)
    for group, vector, direction in zip(contacts.groups, vectors, values["direction"], strict=True):
        rate = vector @ values["v"] - group.base * base
        stuck = (direction == 0) & (group.stiffness is None)  # to the bit, not to rounding
        rows.append(np.where(stuck, group.first.wall_velocity, rate))
    return np.array(rows)


def _stretched(view: View, friction: np.ndarray) -> np.ndarray:
    """How far the spring of every contact is stretched; a rigid one has none."""
    stiffness = np.array([[one.stiffness or np.inf] for one in view.system.contact_system.groups])
    return friction / stiffness


def _moduli(harmonics: np.ndarray) -> np.ndarray:
    return np.hypot(harmonics[..., 0], harmonics[..., 1])


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


def _one(view: View, r: float, beta: float, follower: Follower, *names: str) -> dict[str, Any]:
    """Compute a map of one cell."""
    axes = {"mu": np.array([view.mu]), "r": np.array([r]), "beta": np.array([beta])}
    found, _ = view.engine.cells(axes, names, view.solver, 1, None, follower.watch)
    return {name: values.item() for name, values in found.items()}


def _alike(one: Mapping[str, Any], other: Mapping[str, Any]) -> bool:
    """Whether two initial states lead to the same regime with the same amplitude."""
    if one["regime"] != other["regime"]:
        return False
    sizes = float(one["contact_amplitude"]), float(other["contact_amplitude"])
    return bool(np.isclose(*sizes, rtol=_OTHER, atol=_OTHER, equal_nan=True))
