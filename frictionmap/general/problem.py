"""A general system over r, as arrays for the kernels."""

from typing import NamedTuple

import numpy as np

from .._kernels.general.problem import FLAT, UNCOUPLED, Coupling, Law, Problem
from ..errors import InputError
from ..model.friction_law import FrictionLaw
from ..model.general import LOOP, ContactSystem, refuse_banks, refuse_law
from ..model.points import Points
from ..model.system import System
from .certificate import certified_friction

#: Largest rate of the fastest part of the motion, in tau.
_HIGHEST_RATE = 1e4


#: A sum of vectors that leaves less of another vector, relative to the size of its terms, is equal to it:
#: vectors hold whole numbers, or those of a reduced structure with its rounding error.
_TIED = 1e-12


class Channel(NamedTuple):
    """A function of time and what it drives, see `_kernels.general.problem`."""

    phasors: dict[int, complex]
    push: np.ndarray  # (n,) load on the masses
    base: np.ndarray  # (N,) displacement of the walls
    normal: np.ndarray  # (N,) variation of the normal loads
    rate: int = 0  # how many times r times the derivative is taken of these phasors: that drives
    place: np.ndarray | None = None  # (p,) displacement of points beside that by modes


class PointRows(NamedTuple):
    """Displacements of points of a structure given by modes, as sums of series."""

    shapes: np.ndarray  # (p, m) per mode
    loads: np.ndarray  # (p, D) per channel
    forces: np.ndarray  # (p, N) per friction force


class ModalSystem(NamedTuple):
    """A general system in modal coordinates, independent of r."""

    squares: np.ndarray  # (m,) w^2
    phi: np.ndarray  # (n, m), modal mass 1
    damping: np.ndarray  # (m, m) C in modal coordinates
    chi: np.ndarray  # (N, m)
    mass: np.ndarray  # (n, n)
    stiffness: np.ndarray
    viscous: np.ndarray  # C1
    points: PointRows | None = None  # of a structure given by modes

    def displacements(
        self, q: np.ndarray, loads: np.ndarray, forces: np.ndarray, row: int | slice = slice(None)
    ) -> np.ndarray:
        """Displacements of the masses, or points, from those of modes (m, k), channels (D, k), and forces
        (N, k); of one row or all.
        """
        if self.points is None:
            return np.asarray(self.phi[row] @ q)
        shapes, by_loads, by_forces = (one[row] for one in self.points)
        return np.asarray(shapes @ q + by_loads @ loads + by_forces @ forces)


def general_of(system: System) -> ContactSystem:
    """The general parts of a system that has some."""
    assert system.general is not None
    return system.general


def participation(vectors: np.ndarray, phi: np.ndarray) -> np.ndarray:
    """Displacements in the contacts per mode, (N, m), without those that are rounding error."""
    chi = np.asarray(vectors @ phi)
    small = (
        64.0 * np.finfo(float).eps * np.linalg.norm(phi, axis=0) * np.linalg.norm(vectors, axis=1)[:, None]
    )
    chi[np.abs(chi) <= small] = 0.0
    return chi


def modal_system(system: System) -> ModalSystem:
    """Modes of the structure without friction, and the participation of the contacts."""
    modes = system.modes
    general = general_of(system)
    phi, w = modes.phi, modes.w
    damping = modes.damping_in_modes()
    chi = participation(general.vectors, phi)
    found = ModalSystem(w**2, phi, damping, chi, modes.mass, modes.stiffness, modes.damping)
    if general.points is None:
        return found
    points, channels = general.points, channels_of(system, found)
    places = [np.zeros(system.n) if one.place is None else one.place for one in channels]
    return found._replace(points=PointRows(points.shapes @ phi, np.array(places).T, -points.of_contacts))


def _channels_of_points(points: Points) -> list[Channel]:
    """A channel for every point under load: it pushes modes, and by the residual moves points."""
    found = []
    residual = np.zeros((len(points.shapes),) * 2) if points.residual is None else points.residual
    for row in points.loaded:
        phasors = {order: complex(load[row]) for order, load in points.loads.items() if load[row] != 0.0}
        place = residual[row]
        found.append(
            Channel(phasors, points.shapes[row], -(points.vectors @ place), 0.0 * points.own, place=place)
        )
    return found


def _channels_of_base(system: System, modal: ModalSystem) -> list[Channel]:
    """The motion of the base.  Modes at points are relative to it, and see its acceleration and dashpots."""
    general = general_of(system)
    base, points, still = dict(general.base), general.shaken_points, np.zeros(general.count)
    relative, viscous = system.damping_reference == "base", general.moved(modal.viscous)
    if points is None:
        found = [Channel(base, general.moved(modal.stiffness), general.joined, still)]
    else:
        inertia = general.moved(modal.mass)
        found = [
            Channel(base, 0.0 * inertia, general.wall_shares, still, place=points.carried),
            Channel(base, -inertia, points.vectors @ points.sag, still, rate=2, place=-points.sag),
        ]
    if relative == (points is None) and modal.viscous.any():
        found.append(Channel(base, viscous if relative else -viscous, still, still, rate=1))
    return found


def channels_of(system: System, modal: ModalSystem) -> list[Channel]:
    """The functions of time that drive a system."""
    general = general_of(system)
    n, count = len(modal.mass), general.count
    none, still = np.zeros(n), np.zeros(count)
    found = [] if general.points is None else _channels_of_points(general.points)
    for row in range(n if general.points is None else 0):
        phasors = {order: complex(v[row]) for order, v in general.forces.items() if v[row] != 0.0}
        if phasors:
            found.append(Channel(phasors, np.eye(n)[row], still, still))
    if general.base:
        found += _channels_of_base(system, modal)
    for j, group in enumerate(general.groups):
        if group.first.nu:
            found.append(Channel(dict(group.first.nu), none, still, np.eye(count)[j]))
    return found


def _phasors(channels: list[Channel], orders: tuple[int, ...], r: np.ndarray) -> np.ndarray:
    """cos and sin parts of the channels, (n_r, 2, D, H)."""
    table = np.zeros((r.size, len(channels), len(orders)), dtype=complex)
    for d, channel in enumerate(channels):
        for order, phasor in channel.phasors.items():
            factor = (1j * order * r) ** channel.rate if channel.rate else np.ones_like(r)
            table[:, d, orders.index(order)] = phasor * factor
    return np.ascontiguousarray(np.stack((table.real, -table.imag), axis=1))


def _norms(modal: ModalSystem, spring: np.ndarray) -> tuple[float, float]:
    """Norms of the modal matrices, of damping and of stiffness with all springs."""
    stiffness = np.diag(modal.squares) + modal.chi.T @ pull_of(spring, modal.chi)
    return float(np.linalg.norm(modal.damping, 2)), float(np.linalg.eigvalsh(stiffness)[-1])


def fastest(modal: ModalSystem, spring: np.ndarray, damping: np.ndarray | None = None) -> float:
    """Bound on the rate of the fastest part of the motion, in t = tau/r.

    Holding contacts lowers natural frequencies or leaves them below the highest one; springs raise them.  The
    roots of l^2 + c l + k have moduli of (c + sqrt(c^2 + 4 k))/2 at most.

    damping : (N,) moduli of the derivatives of friction forces by velocities
    """
    c, k = _norms(modal, spring)
    if damping is not None:
        c += float(damping @ (modal.chi**2).sum(axis=1))
    return 0.5 * (c + np.sqrt(c * c + 4.0 * k))


def _rates(
    modal: ModalSystem, spring: np.ndarray, orders: tuple[int, ...], r: np.ndarray, damping: np.ndarray
) -> np.ndarray:
    """Bound on the rate of the fastest part of the motion, (n_r,), in tau."""
    return np.maximum(fastest(modal, spring, damping) / np.where(r > 0.0, r, 1.0), float(max(orders)))


def least_ratio(system: System) -> float:
    """Least r > 0 at which motions of a system are followed; see `_refuse_low`."""
    return fastest(modal_system(system), spring_matrix(general_of(system))) / _HIGHEST_RATE


def is_symmetric(general: ContactSystem) -> bool:
    """Whether x(tau + pi) = -x(tau) is a motion if x is one."""
    loads = (*general.forces, *general.base)
    normal = [n for group in general.groups for n in group.first.nu]
    belts = any(group.first.belt for group in general.groups)
    return all(n % 2 == 1 for n in loads) and all(n % 2 == 0 for n in normal) and not belts


def static_offset(system: System) -> tuple[np.ndarray, np.ndarray]:
    """Displacements in the contacts (N,) and of the masses (n,) under the constant loads."""
    general, modes = general_of(system), system.modes
    if general.points is not None:
        return general.points.static(modes.w)
    if system.rigid_modes:  # the place of which is arbitrary: that with the masses' centre at 0
        elastic = modes.phi[:, system.rigid_modes :] / modes.w[system.rigid_modes :]
        x = elastic @ (elastic.T @ general.offset)
    else:
        x = np.linalg.solve(modes.stiffness, general.offset)
    return general.vectors @ x, x


def springs(general: ContactSystem) -> np.ndarray:
    """Stiffness of every contact, 0 where it is rigid, (N,)."""
    return general.stiffnesses


def spring_matrix(general: ContactSystem) -> np.ndarray:
    """Stiffness of every contact, (N,); of coupled ones F^-1, (N, N)."""
    flexibility = general.flexibility
    return np.linalg.inv(flexibility) if flexibility.size else springs(general)


def pull_of(spring: np.ndarray, vectors: np.ndarray) -> np.ndarray:
    """Forces in contacts per coordinate, (N, n), of springs as of `spring_matrix` with vectors (N, n)."""
    return np.asarray(spring @ vectors if spring.ndim == 2 else spring[:, np.newaxis] * vectors)


def coupling_of(general: ContactSystem) -> Coupling:
    """How forces in contacts displace others beside the modes."""
    flexibility = general.flexibility
    if not flexibility.size:
        return UNCOUPLED
    return Coupling(np.ascontiguousarray(flexibility), np.diag(np.linalg.inv(flexibility)).copy())


def refuse_loop(general: ContactSystem) -> None:
    """Refuse contacts that close a loop where these are not offered."""
    if general.loop:
        raise InputError(
            "cannot use",
            "contacts",
            f"{general.loop} together: {LOOP}; leave one out, or use map, response, curves, design or "
            f"boundaries",
        )


def _refuse_low(rates: np.ndarray, r: np.ndarray) -> None:
    """Refuse frequencies at which a period of the load has too many steps."""
    low = (r > 0.0) & (rates > _HIGHEST_RATE)
    if low.any():
        worst = int(np.flatnonzero(low)[0])
        raise InputError(
            "r",
            f"must be 0, or >= {r[worst] * rates[worst] / _HIGHEST_RATE:.3g} for this system: below, a "
            f"period of the load has more than 10^4 periods of the fastest free motion; got {r[worst]:g}",
        )


def ties(vectors: np.ndarray, moved: np.ndarray, belt: np.ndarray, spring: np.ndarray) -> np.ndarray:
    """The rigid contacts that together keep both ends of a spring at rest, (N, N) bool, a row per spring.

    The vector of the spring is a sum of theirs, and the motion of its wall is the same sum of those of their
    walls.  The sum is unique, because rigid contacts do not close loops.  Rows without one are False.

    Parameters
    ----------
    vectors : (N, n)
    moved : (N,) 1 for walls that move with the base, else 0
    belt : (N,) velocities of the walls
    spring : (N,) stiffness, 0 for rigid contacts
    """
    found = np.zeros((spring.size, spring.size), dtype=bool)
    rigid, n = np.flatnonzero(spring == 0.0), vectors.shape[1]
    whole = np.column_stack((vectors, moved, belt))
    for j in np.flatnonzero(spring != 0.0) if rigid.size else ():
        shares = np.linalg.lstsq(vectors[rigid].T, vectors[j])[0]
        shares[np.abs(shares) <= _TIED * np.abs(shares).max()] = 0.0
        rest = np.abs(whole[j] - shares @ whole[rigid])
        size = np.abs(whole[j]) + np.abs(shares) @ np.abs(whole[rigid])
        size[:n] = size[:n].max()
        if (rest <= _TIED * size).all():
            found[j, rigid] = shares != 0.0
    return found


def law_of(system: System, modal: ModalSystem) -> Law:
    """Friction over the speed of every contact, as arrays; see `_kernels.general.problem`."""
    general = general_of(system)
    if not general.has_law:
        return FLAT
    laws = [group.first.law or FrictionLaw() for group in general.groups]
    count = np.array([len(law.speed) for law in laws])
    speed, factor, slope = (np.zeros((count.size, count.max())) for _ in range(3))
    for j, law in enumerate(laws):
        speed[j, : count[j]], factor[j, : count[j]], slope[j, : count[j]] = law.speed, law.factor, law.slopes
    steepest = np.abs(slope).max(axis=1) * (modal.chi**2).sum(axis=1)
    norms = np.array(_norms(modal, springs(general)))
    return Law(speed, factor - slope * speed, slope, count, certified_friction(system), steepest, norms)


def law_damping(general: ContactSystem, beta: float) -> np.ndarray:
    """Largest modulus of the derivative of each friction force by its velocity up to a beta, (N,)."""
    slopes = [max(map(abs, (group.first.law or FrictionLaw()).slopes)) for group in general.groups]
    return np.array(slopes) * np.array([group.friction(beta, 1.0)[0] for group in general.groups])


def problem_of(
    system: System, r: np.ndarray, beta: float | None = None, loops: bool = False
) -> tuple[Problem, ModalSystem]:
    """Build the arrays of a system over r; values at r = 0 are placeholders.

    beta : the largest one; needed only where friction depends on the speed, and is damping by that
    loops : whether contacts that close loops are offered
    """
    general = general_of(system)
    refuse_banks(system, "compute this")
    if not loops:
        refuse_loop(general)
    modal = modal_system(system)
    channels, orders = channels_of(system, modal), general.orders
    phasors = _phasors(channels, orders, r)
    spring = springs(general)
    if general.has_law and beta is None:
        refuse_law(system, "compute this")
    rates = _rates(modal, spring_matrix(general), orders, r, law_damping(general, beta or 0.0))
    _refuse_low(rates, r)
    if general.free and (r == 0.0).any():
        raise InputError("r", "must be > 0 for a free structure, which no slow load leaves at a place; got 0")
    push = modal.phi.T @ np.array([channel.push for channel in channels]).T
    load = np.abs(push[np.newaxis]) @ np.hypot(phasors[:, 0], phasors[:, 1]).sum(axis=2)[:, :, np.newaxis]
    sizes = (load[:, :, 0] / (modal.squares + (r * r)[:, np.newaxis])).max(axis=1)
    belt = np.array([group.first.wall_velocity for group in general.groups])
    moved = general.joined if general.shaken_points is None else general.wall_shares
    tied = ties(general.vectors, moved, belt, spring)
    # a slider under a varying normal load slips between ends at rest, too: it is watched there
    tied[[bool(group.first.nu) for group in general.groups]] = False
    problem = Problem(
        modal.squares, modal.damping, bool((modal.damping != np.diag(np.diag(modal.damping))).any()),
        np.ascontiguousarray(modal.chi), np.ascontiguousarray(push),
        np.ascontiguousarray(np.array([channel.base for channel in channels]).T),
        np.ascontiguousarray(np.array([channel.normal for channel in channels]).T),
        spring, belt, tied, np.array(orders, dtype=float), r, phasors,
        rates, np.where(sizes > 0.0, sizes, 1.0), is_symmetric(general), law_of(system, modal),
        bool(general.loop), coupling_of(general),
    )  # fmt: skip
    return problem, modal
