"""Motions without a load of contacts that open, and beside piecewise linear springs; see `phases`."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import xarray as xr

from .. import checks, regimes
from ..errors import InputError, NoSteadyState
from ..jobs import Progress, Watch
from ..model.system import System
from ..phases.arrays import grid_of, modal
from ..phases.dataset import OF_NORMAL, OF_SPRINGS, has_output, impact_comment
from ..phases.free import at_speed, response_free, sweep_free
from ..phases.given import phase_system
from ..phases.response import senses_of
from ..phases.sliding import steady_sliding
from ..phases.system import PhaseSystem
from .belts import Belts

#: Starts by their names: at rest, and far from steady sliding.
STARTS = {"rest": "rest", "moving": "far"}

#: Outputs that are shown as they are, and the ranges by their names.
_AS_THEY_ARE = (
    "regime", "also_reachable", "status", "growth", "growth_frequency", "cycle_period", "multiplier",
    "stops_per_cycle", "turns_per_cycle", "stuck_fraction",
)  # fmt: skip
_RANGES = {"x": ("midpoint", "peak_to_peak"), "z": ("contact_midpoint", "contact_peak_to_peak")}

#: Time that is shown of steady sliding, over 1/omega_1.
_SLIDING = 2.0 * np.pi


def given_of(system: System, belts: Belts) -> tuple[PhaseSystem, float]:
    """The system without its load, the speeds of its walls over that of the first one, and the latter's sign.

    Raises
    ------
    InputError
        A contact rests on no belt, or has a key that is not offered.
    """
    whole = phase_system(system, 1.0)
    contacts = []
    for k, (one, share) in enumerate(zip(whole.contacts, belts.share.tolist(), strict=True), 1):
        if share == 0.0 and not (one.normal is not None and one.friction == 0.0):
            raise InputError(
                "cannot use",
                f"contacts[{k}]",
                "without a belt beside contacts that open or piecewise linear springs, without a load: this "
                "is not offered; omit it",
            )
        contacts.append(replace(one, wall_speed=share, wall_velocity=0.0))
    first = next(share for share in belts.share.tolist() if share)
    return replace(whole, contacts=contacts, loads={}, offset=None), first


def _names(system: System) -> list[str]:
    """The outputs of a system."""
    general = system.contact_system
    own = [name for name in (*OF_NORMAL, *OF_SPRINGS) if has_output(name, general)]
    return [*_AS_THEY_ARE, *own]


def _values(system: System, given: PhaseSystem, found: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Variables of cells, whose axes come first; steady sliding has no stops, and its own forces."""
    values = {name: np.asarray(found[name]) for name in _names(system)}
    for name, (middle, whole) in _RANGES.items():
        half = 0.5 * np.asarray(found[whole])
        values[f"{name}_max"], values[f"{name}_min"] = found[middle] + half, found[middle] - half
    still = (values["regime"] == regimes.STEADY_SLIDING)[..., np.newaxis]
    directions = np.array([one.direction for one in given.contacts])
    x = values["x_max"]
    for name in ("z_max", "z_min"):
        values[name] = np.where(still, x @ directions.T, values[name])
    for name in ("stops_per_cycle", "turns_per_cycle", "stuck_fraction"):
        values[name] = np.where(still, 0.0, values[name])
    if "open_fraction" in values:
        opened = np.where(values["normal_force_max"] == 0.0, 1.0, 0.0)
        presses = np.array([one.normal is not None for one in given.contacts])
        values["open_fraction"] = np.where(still & presses, opened, values["open_fraction"])
        values["separations_per_cycle"] = np.where(still & presses, 0.0, values["separations_per_cycle"])
    if given.springs:
        force = np.stack([np.abs(one(x @ one.direction)) for one in given.springs], axis=-1)
        values["spring_force_max"] = np.where(still, force, values["spring_force_max"])
        values["spring_crossings"] = np.where(still, 0.0, values["spring_crossings"])
    return {name: _contact_shaped(name, one, len(given.contacts)) for name, one in values.items()}


def _contact_shaped(name: str, values: np.ndarray, count: int) -> np.ndarray:
    """Values of contacts, of a single one without a dimension."""
    of_contacts = (*OF_NORMAL, "stops_per_cycle", "turns_per_cycle", "stuck_fraction", "z_max", "z_min")
    return values[..., 0] if count == 1 and name in of_contacts else values


_NEEDED = (*_AS_THEY_ARE, *OF_NORMAL, *OF_SPRINGS, *(name for pair in _RANGES.values() for name in pair))


def opening_values(
    system: System, belts: Belts, axes: dict[str, np.ndarray], threads: int | None,
    progress: Progress | None, watch: Watch | None,
) -> dict[str, np.ndarray]:  # fmt: skip
    """Variables of all cells."""
    given, sign = given_of(system, belts)
    found = sweep_free(
        given, sign * axes["wall_speed"], axes["beta"], axes["mu"], _NEEDED,
        threads=checks.threads(threads), progress=progress, watch=watch,
    )  # fmt: skip
    return _values(system, given, found)


def opening_motion(
    system: System, belts: Belts, cell: tuple[float, float, float], points: int, start: str
) -> dict[str, np.ndarray]:
    """Variables of one motion in time.

    Parameters
    ----------
    system, belts : System, Belts
    cell : belt speed, friction ratio, ratio of static to kinetic friction
    points : samples per cycle
    start : "rest", or "moving", far from steady sliding
    """
    speed, beta, mu = cell
    given, sign = given_of(system, belts)
    given = at_speed(given, sign * speed)
    found = response_free(given, beta, mu, points - 1, STARTS[start])
    if found["regime"] == regimes.UNRESOLVED:
        raise NoSteadyState(
            f"no motion was found at wall_speed = {speed:g}, beta = {beta:g}, mu = {mu:g}: it chatters "
            "or settles too slowly; change wall_speed or beta slightly"
        )
    values = _values(system, given, found)
    slides = values["regime"] == regimes.STEADY_SLIDING
    traces = _sliding_traces(given, beta, mu, points) if slides else _traces(given, found)
    if not has_output("open_fraction", system.contact_system):
        del traces["normal_force"], traces["open"]
    if not given.springs:
        del traces["spring_force"]
    if len(given.contacts) == 1:
        of_contacts = [name for name in traces if name not in ("time", "x", "v", "spring_force")]
        traces |= {name: traces[name][0] for name in of_contacts}
    return values | traces


def described(ds: xr.Dataset, system: System) -> xr.Dataset:
    """Say where motions begin, and what impacts of a stiff contact that opens are worth."""
    ds["regime"].attrs["long_name"] = "motion that begins at rest"
    opened = ds.get("open_fraction")
    if opened is None:
        return ds
    shares = opened.values if "contact" in opened.dims else opened.values[..., np.newaxis]
    comment = impact_comment(system, shares)
    return ds.assign_attrs(comment=comment) if comment else ds


def _traces(given: PhaseSystem, found: Mapping[str, Any]) -> dict[str, np.ndarray]:
    """Traces of a cycle; NaN as the normal force of contacts in which it does not move."""
    names = ("x", "v", "z", "friction", "open", "normal_force", "spring_force")
    traces = {"time": found["tau"], **{name: found[name] for name in names}}
    vectors = np.array([one.direction for one in given.contacts])
    belts = np.array([one.belt for one in given.contacts])
    velocity = vectors @ traces["v"] - belts[:, np.newaxis]
    traces["direction"] = senses_of(found["direction"], found["open"], velocity)
    presses = np.array([one.normal is not None for one in given.contacts])
    traces["normal_force"] = np.where(presses[:, np.newaxis], traces["normal_force"], np.nan)
    return traces


def _sliding_traces(given: PhaseSystem, beta: float, mu: float, points: int) -> dict[str, np.ndarray]:
    """Traces of steady sliding."""
    grid = grid_of(given, modal(given), np.array([beta]), mu, 1)
    sliding = steady_sliding(given, grid.limit[0], grid.preload[0])
    moves = np.array([one.normal is not None for one in given.contacts])
    share = np.array([one.friction for one in given.contacts])
    friction = np.where(moves, share * sliding.normal_force, grid.limit[0])
    senses = -np.sign([one.belt for one in given.contacts])
    vectors = np.array([one.direction for one in given.contacts])
    one_time = {
        "x": sliding.place, "v": np.zeros(given.n), "z": vectors @ sliding.place,
        "friction": senses * friction, "direction": senses.astype(np.int8),
        "open": (moves & (sliding.normal_force == 0.0)).astype(np.int8),
        "normal_force": np.where(moves, sliding.normal_force, np.nan),
        "spring_force": np.array([float(one(one.direction @ sliding.place)) for one in given.springs]),
    }  # fmt: skip
    traces = {name: np.tile(one[:, np.newaxis], points) for name, one in one_time.items()}
    return {"time": np.linspace(0.0, _SLIDING, points), **traces}
