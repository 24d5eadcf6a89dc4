"""Motions of structures on belts without a load over mu, belt speed and beta."""

from typing import Any

import numpy as np

from .. import checks, regimes
from .._kernels.general.series import Friction
from ..jobs import Job, Progress, Watch, run_counted
from ..model.system import System
from .belts import Belts, shapes_of
from .steady import Sliding
from .structure import Motion, Ride

#: Vibration about steady sliding with which a motion begins near it, over the displacement there.
_SMALL = 1e-3

#: The same of a large motion.
_LARGE = 5.0

#: Variables and the fields of `Motion` that they show; of all contacts, of all masses, of the cell.
OF_CONTACTS = {
    "stops_per_cycle": "stops", "turns_per_cycle": "turns", "stuck_fraction": "stuck",
    "segment_crossings": "crossings", "z_max": "contact_highest", "z_min": "contact_lowest",
}  # fmt: skip
OF_MASSES = {"x_max": "highest", "x_min": "lowest"}
OF_CELLS = {"regime": "regime", "status": "status", "cycle_period": "period", "multiplier": "multiplier"}

_TYPES = {"regime": np.int8, "also_reachable": np.uint8, "status": np.int8}


def starts(sliding: Sliding, system: System, belts: Belts) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Displacements and velocities that motions begin with: release, and small and large vibrations.

    At the release the masses on belts move with them under the static friction, and the others are at rest.
    A small vibration begins only where steady sliding is unstable: it is known where it ends elsewhere.
    """
    vectors = np.array([group.vector for group in belts.groups])
    moves = belts.share != 0.0
    release = np.linalg.lstsq(vectors, sliding.speeds * moves)[0]
    pull = vectors.T @ (np.sign(sliding.speeds) * sliding.static * moves)
    modes, seen = system.modes, shapes_of(system)
    largest = np.abs(seen @ modes.phi).max(axis=0)
    shape = (modes.phi / np.where(largest > 0.0, largest, np.inf)).sum(axis=1)
    size = float(np.abs(seen @ sliding.place).max() + np.abs(sliding.speeds).max() / modes.w[0])
    still = np.zeros(len(modes.mass))
    found = {"release": (np.linalg.solve(modes.stiffness, pull), release)}
    if sliding.followed >= 0.0:
        found["small"] = (sliding.place + _SMALL * size * shape, still)
    found["large"] = (sliding.place + _LARGE * size * shape, still)
    return found


def motions_of(ride: Ride, sliding: Sliding, system: System, belts: Belts) -> dict[str, Motion]:
    """Where the motions from all starts end."""
    friction = Friction(sliding.kinetic, sliding.static)
    return {
        name: ride.end_of(friction, sliding, *start) for name, start in starts(sliding, system, belts).items()
    }


def sliding_of(system: System, belts: Belts, speed: float, beta: float, mu: float) -> Sliding:
    """Steady sliding in one cell."""
    pairs = np.array([group.friction(beta, mu) for group in belts.groups], dtype=float)
    return Sliding(system, belts, speed, pairs[:, 0].copy(), pairs[:, 1].copy())


def structure_values(
    system: System, belts: Belts, axes: dict[str, np.ndarray], threads: int | None,
    progress: Progress | None, watch: Watch | None,
) -> dict[str, np.ndarray]:  # fmt: skip
    """Variables of all cells of a structure."""
    shape = tuple(axes[name].size for name in ("mu", "wall_speed", "beta"))
    found = _allocate(shape, len(belts.groups), system.n)
    jobs: list[Job] = [(_fill, (system, belts, axes, i, found)) for i in range(axes["wall_speed"].size)]
    run_counted(jobs, checks.threads(threads), progress, watch)
    if len(belts.groups) == 1:
        found |= {name: found[name][..., 0] for name in OF_CONTACTS}
    return found


def _allocate(shape: tuple[int, ...], contacts: int, masses: int) -> dict[str, np.ndarray]:
    names = {name: (contacts,) for name in OF_CONTACTS} | {name: (masses,) for name in OF_MASSES}
    cells = (*OF_CELLS, "also_reachable", "growth", "growth_frequency")
    names |= {name: () for name in cells}  # type: ignore[misc]
    return {name: np.zeros((*shape, *more), _TYPES.get(name, np.float64)) for name, more in names.items()}


def _fill(
    system: System, belts: Belts, axes: dict[str, np.ndarray], i: int, found: dict[str, np.ndarray]
) -> None:
    """Fill the cells of one belt speed."""
    speed = float(axes["wall_speed"][i])
    ride = Ride(system, belts, speed, float(axes["beta"].max()))
    for m, mu in enumerate(axes["mu"].tolist()):
        for b, beta in enumerate(axes["beta"].tolist()):
            sliding = sliding_of(system, belts, speed, beta, mu)
            motions = motions_of(ride, sliding, system, belts)
            _put(found, (m, i, b), sliding, motions)


def _put(
    found: dict[str, np.ndarray], at: tuple[int, int, int], sliding: Sliding, motions: dict[str, Motion]
) -> None:
    """Fill a cell."""
    shown = motions["release"]
    for name, field in (OF_CONTACTS | OF_MASSES | OF_CELLS).items():
        found[name][at] = getattr(shown, field)
    found["growth"][at], found["growth_frequency"][at] = sliding.growth, sliding.frequency
    if (sliding.growth < 0.0) != (sliding.followed < 0.0) and shown.status == regimes.RESOLVED:
        found["status"][at] = regimes.BREAK_POINTS
    bits = 1 << regimes.STEADY_SLIDING if sliding.growth < 0.0 else 0
    for motion in motions.values():
        ends: Any = motion.regime
        if ends in (regimes.STICK_SLIP_CYCLE, regimes.CYCLE_WITHOUT_STOPS):
            bits |= 1 << ends
    found["also_reachable"][at] = bits
