"""Systems on a belt without a load: what moves with the belt, and what has no meaning there."""

from typing import NamedTuple

import numpy as np

from ..errors import InputError
from ..model.friction_law import FrictionLaw
from ..model.general import MergedContact
from ..model.system import System

#: Keys of loads, and of what acts on them alone.
_LOADS = ("load_harmonics", "load_file", "waveform", "harmonics", "load", "load_offset")

#: Keys of contacts for which motions without a load are not offered.
_OF_CONTACTS = ("stiffness", "normal_load", "normal_record", "wall_velocity")

_IN_SYSTEM = {"stiffness": "contact_stiffness"}


class Belts(NamedTuple):
    """The contacts of a system, and how the belt of the grid moves their walls."""

    groups: tuple[MergedContact, ...]
    share: np.ndarray  # (N,) velocity of each wall over that of the belt; 0: at rest

    @property
    def laws(self) -> list[FrictionLaw]:
        """Friction over speed in every contact."""
        return [group.first.law or FrictionLaw() for group in self.groups]


def is_one_mass(system: System) -> bool:
    """Whether a system is one mass with the mass and the stiffness 1, which is solved in closed form."""
    modes = system.modes
    one = system.n == 1 and not system.by_modes
    return one and modes.mass[0, 0] == 1.0 and modes.stiffness[0, 0] == 1.0


def shapes_of(system: System) -> np.ndarray:
    """Displacements of the masses, or points, by the coordinates of a structure, (n, m)."""
    points = system.contact_system.points
    return np.eye(len(system.modes.mass)) if points is None else points.shapes


def is_phases(system: System) -> bool:
    """Whether a system has contacts that open, or piecewise linear springs."""
    general = system.contact_system
    return bool(general.springs) or any(group.normal is not None for group in general.groups)


def belts_of(system: System) -> Belts:
    """The contacts of a system without a load.

    The belt of the grid is the wall of the first contact with a wall_speed; further ones keep the quotient of
    their speeds.  Where no contact has one, it is the wall of every fixed-wall contact.

    Raises
    ------
    InputError
        The system has a load, or something that motions without a load are not offered for; it names the key.
    """
    _refuse_loads(system)
    groups = system.contact_system.groups
    for k, group in enumerate(groups, 1):
        _refuse_contact(system, k, group)
    speeds = np.array([group.first.wall_speed for group in groups])
    if not speeds.any():
        speeds = np.array([float(group.first.kind == "fixed-wall") for group in groups])
    if not speeds.any():
        raise InputError(
            "contact", "must be a fixed-wall without a load: no belt moves the others; got none of this kind"
        )
    return Belts(groups, speeds / abs(speeds[speeds != 0.0][0]))


def _refuse_loads(system: System) -> None:
    for name in _LOADS:
        if getattr(system, name) is not None:
            raise InputError("cannot use", name, "without a load: belt speeds take its place; omit it")
    if system.excitation == "base":
        raise InputError("cannot use", "excitation", "= 'base' without a load: the base is at rest; omit it")
    if system.load_mass != system.dofs.numbers[0]:
        raise InputError("cannot use", "load_mass", "without a load: belt speeds take its place; omit it")
    if system.rigid_modes:
        raise InputError(
            "cannot compute motions without a load of a free structure: no spring holds it at a place; add a "
            "spring to the ground"
        )


def _refuse_contact(system: System, k: int, group: MergedContact) -> None:
    for name in _OF_CONTACTS:
        if getattr(group.first, name):
            key = f"contacts[{k}].{name}" if system.contacts is not None else f"contact_{name}"
            key = name if key in ("contact_wall_velocity", "contact_normal_load") else key
            remedy = (
                "give wall_speed in [grid]" if name == "wall_velocity" else "this is not offered; omit it"
            )
            raise InputError("cannot use", key, f"without a load: {remedy}")
