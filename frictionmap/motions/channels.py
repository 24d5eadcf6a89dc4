"""What a record drives: loads on the masses, walls of contacts, normal loads."""

from typing import NamedTuple

import numpy as np

from ..errors import InputError
from ..model.general import ContactSystem
from ..model.system import System
from .pieces import SAME, Pieces, derivative, extremes, integral, on_times, padded, scaled
from .record import Record

#: A sum within this share of its terms is 0.
_SAME = 1e-12


class Channel(NamedTuple):
    """A function of time and what it drives, see `_kernels.general.problem`."""

    pieces: Pieces
    push: np.ndarray  # (n,) load on the masses
    base: np.ndarray  # (N,) displacement of the walls
    normal: np.ndarray  # (N,) variation of the normal loads
    moves_on: bool = False  # whether it goes on at its last rate after the record, as a base does
    of_base: bool = False  # whether it is the displacement of the base
    place: np.ndarray | None = None  # (p,) displacement of points beside that by modes


class Drive(NamedTuple):
    """All channels of a record on common intervals; times are dimensionless."""

    times: np.ndarray  # (K + 1,) the samples; the last one is the end of the record
    steps: np.ndarray  # (K + 1,) lengths of the intervals, the last one of those after the record
    terms: np.ndarray  # (K + 1, D, terms) polynomials; the last ones are those after the record
    jumps: np.ndarray  # (K + 1,) bool: whether a channel jumps where an interval begins
    push: np.ndarray  # (n, D)
    base: np.ndarray  # (N, D)
    normal: np.ndarray  # (N, D)
    acceleration: np.ndarray  # (D,) 1 where the channel is the acceleration of the base
    of_base: np.ndarray  # (D,) bool: whether the channel is the displacement of the base
    place: np.ndarray  # (p, D) displacements of masses, or points, beside those by modes
    direct: np.ndarray  # (N, D) what of `base` these displacements are


class Scale(NamedTuple):
    """Factors that make a record dimensionless."""

    time: float  # omega_1
    value: float


def _force(system: System, general: ContactSystem, record: Record, pieces: Pieces) -> list[Channel]:
    vector = np.zeros(system.n)
    if record.vector is not None:
        if len(record.vector) != system.n:
            raise InputError(
                "vector", f"must have one number per mass ({system.n}); got {len(record.vector)}"
            )
        vector[:] = record.vector
    else:
        mass = system.load_mass if record.mass is None else record.mass
        vector[system.dofs.row(system.dofs.number(1 if mass is None else mass, "mass"))] = 1.0
    still, points = np.zeros(general.count), general.points
    if points is None:
        return [Channel(pieces, vector, still, still)]
    push = points.shapes.T @ vector
    if points.residual is None:
        return [Channel(pieces, push, still, still)]
    place = points.residual @ vector
    return [Channel(pieces, push, -(points.vectors @ place), still, place=place)]


def _motion_of_base(record: Record, given: Pieces) -> tuple[Pieces, Pieces, Pieces]:
    """Displacement, velocity and acceleration of the base; it begins at rest, at 0 where it is not given."""
    if record.quantity == "displacement":
        velocity = derivative(given)
        return given, velocity, derivative(velocity)
    if record.quantity == "velocity":
        return integral(given), given, derivative(given)
    velocity = integral(given)
    return integral(velocity), velocity, given


def is_relative_damping(system: System) -> bool:
    """Whether the damping sees velocities relative to the base: a force-excited structure has no other."""
    return system.excitation != "base" or system.damping_reference == "base"


def _iota(system: System, general: ContactSystem) -> np.ndarray:
    """Coordinates of the structure by a unit displacement of the base: of modes their participation, (n,)."""
    points = general.points
    if points is None:
        return np.ones(system.n)
    if points.participation is None:
        raise InputError(
            "cannot follow motions of the base of a structure given by modes without participation: it is "
            "their load by a base that moves; give participation, or a beam or plate with a support"
        )
    return points.participation


def _under_base(system: System, general: ContactSystem, acceleration: Pieces) -> Channel:
    """The inertia of a structure whose base moves, relative to which it vibrates."""
    push, still = -system.modes.mass @ _iota(system, general), np.zeros(general.count)
    points = general.points
    if points is None or points.residual is None:
        return Channel(acceleration, push, still, still)
    place = -points.sag
    return Channel(acceleration, push, -(points.vectors @ place), still, place=place)


class Ground(NamedTuple):
    """What the motion of the base does to contacts that open and to piecewise linear springs.

    It is added to their displacements relative to the base: the ground does not move.
    """

    normal: np.ndarray  # (N,) d.x per motion of the base
    along: np.ndarray  # (S,) displacements of the springs

    @property
    def acts(self) -> bool:
        """Whether the place of the base matters to any of them."""
        return bool(self.normal.any() or self.along.any())


def ground_of(general: ContactSystem) -> Ground:
    """The sums of the directions, which are those of a motion of all masses; of two masses they are 0."""
    normal = [0.0 if one.normal is None else _sum(one.normal.direction) for one in general.groups]
    return Ground(np.array(normal), np.array([_sum(one.direction) for one in general.springs]))


def _sum(direction: np.ndarray) -> float:
    """Sum of a direction without rounding error."""
    found = float(direction.sum())
    return found if abs(found) > _SAME * np.abs(direction).sum() else 0.0


def sees_place(system: System) -> bool:
    """Whether the displacement of the base acts on a structure, too."""
    return bool(system.contact_system.wall_shares.any()) or ground_of(system.contact_system).acts


def _base(system: System, general: ContactSystem, record: Record, pieces: Pieces) -> list[Channel]:
    still = np.zeros(general.count)
    grounded = not is_relative_damping(system) and system.modes.damping.any()
    placed = sees_place(system)
    if record.quantity == "acceleration" and not placed and not grounded:  # no integrals
        return [_under_base(system, general, pieces)]
    place, rate, acceleration = _motion_of_base(record, pieces)
    found = [_under_base(system, general, acceleration)]
    if placed:
        none, moves_on = np.zeros(found[0].push.size), record.quantity != "displacement"
        found.append(Channel(place, none, general.wall_shares, still, moves_on, True))
    if grounded:
        push = -system.modes.damping @ _iota(system, general)
        found.append(Channel(rate, push, still, still, record.quantity != "displacement"))
    return found


def _normal_loads(general: ContactSystem, time: float) -> list[Channel]:
    found = []
    for j, group in enumerate(general.groups):
        record = group.first.normal_record
        if record is not None:
            pieces = scaled(record.pieces, time, 1.0)
            least = 1.0 + min(0.0, extremes(pieces)[0])
            if least < 0.0:
                raise InputError(
                    f"contacts[{j + 1}].normal_record",
                    f"must leave 1 + its value >= 0, as contacts that separate are another model; "
                    f"got {least:.3g} at its least",
                )
            n = group.vector.size
            found.append(Channel(pieces, np.zeros(n), np.zeros(general.count), np.eye(general.count)[j]))
    return found


def _common(channels: list[Channel]) -> tuple[np.ndarray, np.ndarray]:
    """Ends and lengths of intervals in which every channel is one polynomial."""
    first = channels[0].pieces
    if all(np.array_equal(one.pieces.times, first.times) for one in channels):
        return first.times, first.steps
    times = np.unique(np.concatenate([one.pieces.times for one in channels]))
    return times, np.diff(times)


def _goes_on(one: Channel, end: float) -> Pieces:
    """The pieces of a channel up to a common end: a base that another record outlasts keeps its place."""
    pieces = one.pieces
    rest = end - pieces.times[-1]
    if rest <= 0.0 or not (one.of_base or one.moves_on):
        return pieces
    last = np.zeros((1, pieces.terms.shape[1]))
    last[0, 0] = pieces.ends[-1]
    if one.moves_on and one.of_base:
        last[0, 1] = pieces.terms[-1] @ np.arange(last.size) / pieces.steps[-1] * rest
    return Pieces(
        np.append(pieces.times, end), np.append(pieces.steps, rest), np.vstack((pieces.terms, last))
    )


def drive_of(system: System, record: Record, scale: Scale) -> Drive:
    """Collect what a record drives in a system."""
    general = system.contact_system
    pieces = scaled(record.pieces, *scale)
    if record.quantity == "force":
        channels = _force(system, general, record, pieces)
    else:
        channels = _base(system, general, record, pieces)
    acceleration = np.zeros(len(channels))
    acceleration[0] = record.quantity != "force"
    normal = _normal_loads(general, scale.time)
    channels += normal
    times, steps = _common(channels)
    terms = [
        one.pieces.terms
        if one.pieces.times is times
        else on_times(_goes_on(one, times[-1]), times, steps).terms
        for one in channels
    ]
    most = max(own.shape[1] for own in terms)
    terms = [padded(own, most) for own in terms]
    after, step = [], float(steps.max())
    for one, own in zip(channels, terms, strict=True):
        last = np.zeros((1, own.shape[1]))
        if one.of_base or one.moves_on:
            last[0, 0] = own[-1].sum()
            if one.moves_on and one.of_base:
                last[0, 1] = _rate_at_end(own, steps) * step
            elif one.moves_on and abs(last[0, 0]) <= _SAME * np.abs(own).sum(axis=1).max():
                last[0, 0] = 0.0
        after.append(last)
    table = np.stack([np.vstack(pair) for pair in zip(terms, after, strict=True)], axis=1)
    sizes = np.abs(table).max(axis=(0, 2))
    gaps = np.abs(table[1:, :, 0] - table[:-1].sum(axis=2))
    jumps = np.concatenate(([False], (gaps > SAME * sizes).any(axis=1)))
    return Drive(
        times, np.append(steps, step), np.ascontiguousarray(table), jumps,
        np.array([one.push for one in channels]).T, np.array([one.base for one in channels]).T,
        np.array([one.normal for one in channels]).T,
        np.concatenate((acceleration, np.zeros(len(normal)))), np.array([one.of_base for one in channels]),
        *_displaced(system, channels),
    )  # fmt: skip


def _rate_at_end(terms: np.ndarray, steps: np.ndarray) -> float:
    """Rate at the end of polynomials (K, terms); a rounding error of what it was before is 0."""
    order = np.arange(terms.shape[1])
    rate, largest = float(terms[-1] @ order / steps[-1]), float((np.abs(terms) @ order / steps).max())
    return rate if abs(rate) > _SAME * largest else 0.0


def _displaced(system: System, channels: list[Channel]) -> tuple[np.ndarray, np.ndarray]:
    """What channels displace beside the modes, see `Drive`: `place` and `direct`."""
    place = [np.zeros(system.n) if one.place is None else one.place for one in channels]
    direct = [0.0 * one.base if one.place is None else one.base for one in channels]
    return np.array(place).T, np.ascontiguousarray(np.array(direct).T)
