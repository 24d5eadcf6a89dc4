"""One motion on a belt without a load in time, over one cycle."""

from typing import SupportsFloat

import numpy as np
import xarray as xr

from .. import checks, regimes
from .._kernels.general.problem import Problem
from .._kernels.general.series import Friction
from .._kernels.no_load.ride import fill_rates, fly
from ..errors import InputError, NoSteadyState
from ..model.system import System
from ..units.axes import ratios, require
from ..units.scales import Units, scales_of
from .belts import belts_of, is_phases
from .dataset import belt_dataset
from .opening import STARTS as OPENING_STARTS
from .opening import opening_motion
from .structure import Motion, Ride
from .structure_map import OF_CELLS, OF_CONTACTS, OF_MASSES, sliding_of, starts

#: Starts by their names: where the belt releases the mass, and a large vibration.
STARTS = {"release": "release", "moving": "large"}

#: Time that is shown of a motion without a period, over 1/omega_1.
_SHOWN = 40.0 * np.pi
_SLIDING = 2.0 * np.pi


def belt_response(
    system: System, wall_speed: SupportsFloat | str, beta: SupportsFloat | str, mu: SupportsFloat,
    points: int, units: Units | None, start: str | None = None,
) -> xr.Dataset:  # fmt: skip
    """Compute one motion on a belt in time.

    Parameters
    ----------
    system : System
    wall_speed, beta, mu : belt speed > 0, friction ratio >= 0, ratio of static to kinetic friction >= 1
    points : samples per cycle
    units : Units, optional
    start : "release", where the belt releases the mass (default), or "moving", a large vibration; with
        contacts that open or piecewise linear springs "rest" (default) or "moving"

    Raises
    ------
    InputError
        An argument has the wrong type or is out of range.
    NoSteadyState
        None was found.
    """
    belts = belts_of(system)
    valid = OPENING_STARTS if is_phases(system) else STARTS
    start = checks.choice(next(iter(valid)) if start is None else start, "start", tuple(valid))
    scales = scales_of(units, system)
    require(scales, wall_speed=("velocity", wall_speed), beta=("force", beta))
    given = _single(ratios(wall_speed, "wall_speed", "velocity", scales))
    speed = checks.number(given, "wall_speed", above=0.0)
    friction = checks.number(_single(ratios(beta, "beta", "force", scales)), "beta", least=0.0)
    mu = checks.number(mu, "mu", least=1.0)
    axes = {name: np.array(one) for name, one in (("mu", mu), ("wall_speed", speed), ("beta", friction))}
    title = "Motion on a belt without a load"
    if is_phases(system):
        values = opening_motion(system, belts, (speed, friction, mu), points, start)
        return belt_dataset("response", title, system, axes, values, units, scales)
    sliding = sliding_of(system, belts, speed, friction, mu)
    ride = Ride(system, belts, speed, friction)
    found = Friction(sliding.kinetic, sliding.static)
    motion = ride.end_of(found, sliding, *starts(sliding, system, belts)[STARTS[start]])
    if motion.regime == regimes.UNRESOLVED:
        raise NoSteadyState(
            f"no motion was found at wall_speed = {speed:g}, beta = {friction:g}, mu = {mu:g}: it chatters "
            "or settles too slowly; change wall_speed or beta slightly"
        )
    values = _cell_values(motion) | _samples(ride, found, motion, points)
    values |= {"growth": np.array(sliding.growth), "growth_frequency": np.array(sliding.frequency)}
    return belt_dataset("response", title, system, axes, values, units, scales)


def _single(given: object) -> object:
    return given[0] if isinstance(given, list) and len(given) == 1 else given


def _cell_values(motion: Motion) -> dict[str, np.ndarray]:
    """Numbers of the cell; of a single contact without a dimension."""
    values = {name: np.asarray(getattr(motion, field)) for name, field in OF_CELLS.items()}
    for name, field in OF_CONTACTS.items():
        one = getattr(motion, field)
        values[name] = one[0] if one.size == 1 else one
    types = {"regime": np.int8, "status": np.int8}
    values = {name: np.asarray(one, types.get(name, np.float64)) for name, one in values.items()}
    return values | {name: getattr(motion, field) for name, field in OF_MASSES.items()}


def _samples(ride: Ride, friction: Friction, motion: Motion, points: int) -> dict[str, np.ndarray]:
    """Displacements, velocities, forces and senses at equal times over the cycle, both ends included."""
    whole = motion.period if np.isfinite(motion.period) else _SHOWN
    whole = _SLIDING if motion.regime == regimes.STEADY_SLIDING else whole
    contacts, modes = ride.modal.chi.shape
    states = np.empty((points, 2, modes))
    forces, senses = np.empty((contacts, points)), np.empty((contacts, points), np.int8)
    memory, problem = ride.flight, ride.problem
    ride.put(motion.state, motion.senses)
    for k in range(points):
        if k > 0:
            fly(problem, friction, memory, whole / (points - 1) / ride.h, False, False)
        fill_rates(problem, friction, memory)
        states[k] = memory.motion.state[:2, :modes]
        for j in range(contacts):
            forces[j, k] = memory.motion.series[_force_row(problem) + j, 0]
        senses[:, k] = memory.motion.sense
    x, v = ride.shapes @ states[:, 0].T, ride.shapes @ states[:, 1].T / ride.h
    z = ride.modal.chi @ states[:, 0].T
    of_contacts: dict[str, np.ndarray] = {"z": z, "friction": forces, "direction": senses}
    if contacts == 1:
        of_contacts = {name: one[0] for name, one in of_contacts.items()}
    return {"time": np.linspace(0.0, whole, points), "x": x, "v": v, **of_contacts}


def _force_row(problem: Problem) -> int:
    """Row of the friction force of the first contact in the series of a step."""
    modes, channels = problem.push.shape
    return int(modes + channels + 2 * problem.spring.size)


def refuse_settings(given: dict[str, object]) -> None:
    """Refuse settings that have no meaning without a load."""
    for name, value in given.items():
        if value is not None and name != "start":
            raise InputError("cannot use", name, "with wall_speed: there is no load; omit one of them")
