"""Structures that repeat round a ring, under loads that travel round it: the sectors that differ.

P turns by one sector.  Where P p(tau) = p(tau + t), t = 2 pi k/N, and the motion is unique (mu = 1), sector j
moves as sector 0 did: x_j(tau) = x_0(tau + j t).  The first s sectors say it all for which s t is a whole
turn, or half a turn where half periods of the load mirror each other:

    x_{j+s} = sign x_j,   sign = 1 or -1.

That also holds for the motion from rest: turned by s sectors, the load and the state at the start are the
same, or mirrored.  The motion has the modes q of a ring of s sectors closed with this sign, x = Phi q, and a
contact acts in all its places:

    r^2 q'' + .. = (s/N) Phi^T p - sum over the contacts kept of chi^T f,   chi = c Phi.
"""

import math
from typing import NamedTuple

import numpy as np

from .._kernels.general.fill import NUMBERS, Cells
from .._kernels.general.problem import TURN, Problem, Turn
from ..model.general import ContactSystem, rank_of
from ..model.modes import solve_modes
from ..model.system import System
from .observed import observed_rows
from .problem import ModalSystem, general_of, is_symmetric, participation, ties

#: Matrices and loads that differ by this share of their size are equal: it is above the rounding errors of
#: damping from modes, and changes a motion by as little.
_EQUAL = 1e-11

#: Numbers of contacts that change their sign with the direction in which displacements are counted.
_SIGNED = [NUMBERS.index("drift")]


class Ring(NamedTuple):
    """How a structure repeats."""

    sectors: int  # N
    order: int  # k
    kept: int  # s
    sign: float  # of x_{j+s}/x_j
    contacts: np.ndarray  # (N contacts,) int: the one, of those kept, that each moves as
    signs: np.ndarray  # (N contacts,) with this sign
    onward: list[tuple[int, float]]  # where each contact is found after a turn by one sector, and its sign


def _is_equal(found: np.ndarray, given: np.ndarray) -> bool:
    return bool(np.abs(found - given).max(initial=0.0) <= _EQUAL * np.abs(given).max(initial=0.0))


def _turned(matrix: np.ndarray, dofs: int) -> np.ndarray:
    return np.roll(matrix, dofs, axis=tuple(range(matrix.ndim)))


def _load_turns(general: ContactSystem, sectors: int, dofs: int) -> int | None:
    """Smallest k >= 0 with which the loads travel, P p(tau) = p(tau + 2 pi k/N)."""
    for k in range(sectors):
        same = True
        for order, load in general.forces.items():
            wave = np.exp(2j * math.pi * (order * k % sectors) / sectors)
            same = same and _is_equal(_turned(load, dofs) * wave, load)
        if same:
            return k
    return None


def _next_contacts(general: ContactSystem, dofs: int) -> list[tuple[int, float]] | None:
    """The contact in which each is found after a turn by these dofs, and its sign there; None without one."""
    vectors, found = general.vectors, []
    friction = [(*group.friction(0.0, 1.0), *group.friction(1.0, 1.0)) for group in general.groups]
    for j, vector in enumerate(vectors):
        turned = _turned(vector, dofs)
        alike = [
            (other, sign)
            for other in range(len(vectors))
            for sign in (1.0, -1.0)
            if _is_equal(sign * turned, vectors[other])
            and friction[j] == friction[other]
            and general.groups[j].stiffness == general.groups[other].stiffness
        ]
        if len(alike) != 1:
            return None
        found.append(alike[0])
    return found


def _turned_by(onward: list[tuple[int, float]], contact: int, sectors: int) -> tuple[int, float]:
    """Where a contact is found after a turn by some sectors, and its sign there."""
    sign = 1.0
    for _ in range(sectors):
        contact, own = onward[contact]
        sign *= own
    return contact, sign


def _kept_sectors(general: ContactSystem, sectors: int, k: int) -> tuple[int, float]:
    """Sectors that differ, and the sign with which they repeat."""
    differ = sectors // math.gcd(k, sectors)
    if is_symmetric(general) and differ % 2 == 0:
        return differ // 2, -1.0
    return differ, 1.0


def _orbits(onward: list[tuple[int, float]], sign: float) -> tuple[np.ndarray, np.ndarray] | None:
    """The first contact of those that move alike, and the sign, of every contact; None if one never moves."""
    contacts, signs = np.full(len(onward), -1), np.zeros(len(onward))
    for first in range(len(onward)):
        at, way = first, 1.0
        while contacts[at] < 0:
            contacts[at], signs[at] = first, way
            at, own = onward[at]
            way *= own * sign
        if contacts[at] == first and way != signs[at]:
            return None
    return contacts, signs


def find_ring(system: System) -> Ring | None:
    """How a structure and its load repeat, if a part of the sectors says it all; None otherwise."""
    general, modes = general_of(system), system.modes
    plain = all(
        not group.first.nu and not group.first.belt and group.normal is None for group in general.groups
    )
    if general.points or general.base or general.free or general.has_law or general.springs or not plain:
        return None
    n = len(modes.mass)
    for sectors in range(n, 2, -1):
        dofs = n // sectors
        if n % sectors or not all(
            _is_equal(_turned(one, dofs), one) for one in (modes.mass, modes.stiffness, modes.damping)
        ):
            continue
        k = _load_turns(general, sectors, dofs)
        if k is None:
            continue
        kept, sign = _kept_sectors(general, sectors, k)
        onward = _next_contacts(general, dofs)
        found = (
            None
            if onward is None
            else _orbits([_turned_by(onward, j, kept) for j in range(len(onward))], sign)
        )
        if found is not None and onward is not None:
            return Ring(sectors, k, kept, sign, *found, onward)
    return None


def _folded(matrix: np.ndarray, ring: Ring) -> np.ndarray:
    """Rows (..., N n) of the structure as they act on the sectors that are kept, (..., s n)."""
    size = matrix.shape[-1] * ring.kept // ring.sectors
    parts = [matrix[..., at : at + size] for at in range(0, matrix.shape[-1], size)]
    return np.asarray(sum(part * ring.sign**j for j, part in enumerate(parts)))


class Kept(NamedTuple):
    """The sectors that differ, as arrays for the kernels."""

    ring: Ring
    modal: ModalSystem  # their modes: `phi` (N n, m) and all matrices are of the whole structure
    contacts: np.ndarray  # (kept contacts,) int: their numbers among all
    mix: np.ndarray  # (D, 2 H) the channels by cosine and sine of each order
    problem: Problem


def _modal(system: System, ring: Ring, vectors: np.ndarray) -> ModalSystem:
    """Modes of the sectors that differ, and the participation of their contacts (folded vectors)."""
    modes = system.modes
    size = len(modes.mass) * ring.kept // ring.sectors
    mass, stiffness, damping = (
        _folded(one[:size], ring) for one in (modes.mass, modes.stiffness, modes.damping)
    )
    w, phi = solve_modes(mass, stiffness)
    by_modes = phi.T @ damping @ phi
    rounding = np.abs(by_modes) <= _EQUAL * np.abs(by_modes).max(initial=0.0)
    by_modes[rounding & ~np.eye(size, dtype=bool)] = 0.0
    whole = np.vstack([phi * ring.sign**j for j in range(ring.sectors // ring.kept)])
    chi = participation(vectors, phi)
    return ModalSystem(w**2, whole, by_modes, chi, modes.mass, modes.stiffness, modes.damping)


def _mixed(full: Problem) -> tuple[np.ndarray, np.ndarray]:
    """Channels by cosine and sine of each order, (D, 2 H), and the phasors of these, (n_r, 2, 2 H, H)."""
    orders = full.orders.size
    mix = np.moveaxis(full.phasors[0], 0, 2).reshape(-1, 2 * orders)  # loads on masses do not depend on r
    waves = np.zeros((full.r.size, 2, 2 * orders, orders))
    for h in range(orders):
        waves[:, 0, 2 * h, h] = waves[:, 1, 2 * h + 1, h] = 1.0
    return mix, waves


def _kept(system: System, full: Problem, ring: Ring) -> Kept:
    contacts = np.unique(ring.contacts)
    vectors, spring = _folded(general_of(system).vectors[contacts], ring), full.spring[contacts]
    modal, modes = _modal(system, ring, vectors), system.modes
    mix, waves = _mixed(full)
    push = (ring.kept / ring.sectors) * (modal.phi.T @ (modes.mass @ modes.phi @ full.push)) @ mix
    load = np.hypot(push[:, ::2], push[:, 1::2]).sum(axis=1)
    sizes = (load / (modal.squares + (full.r * full.r)[:, np.newaxis])).max(axis=1)
    none, rigid = np.zeros(contacts.size), spring == 0.0
    problem = full._replace(
        squares=modal.squares, damping=modal.damping,
        coupled=bool((modal.damping != np.diag(np.diag(modal.damping))).any()),
        chi=np.ascontiguousarray(modal.chi), push=np.ascontiguousarray(push),
        base=np.zeros((contacts.size, mix.shape[1])), normal=np.zeros((contacts.size, mix.shape[1])),
        spring=spring, belt=none, ties=ties(vectors, none, none, spring), phasors=waves,
        sizes=np.where(sizes > 0.0, sizes, 1.0), loops=rank_of(vectors[rigid]) < rigid.sum(),
    )  # fmt: skip
    return Kept(ring, modal, contacts, mix, problem)


def _with_parts(problem: Problem, kept: Kept) -> Problem:
    """The problem with the map over a part of half a period, where half periods mirror each other.

    x_{j+1}(tau) = x_j(tau + t), and t is q parts.  After a turn by the a sectors with a q = 1 + b s the
    motion is that of a part later, mirrored b times.
    """
    ring, phi = kept.ring, kept.modal.phi
    count, dofs = ring.kept, len(phi) // ring.sectors
    if not problem.symmetric or count == 1:
        return problem
    q = 2 * ring.order * count // ring.sectors
    turn = pow(q, -1, count)
    sign = ring.sign * (-1.0) ** (
        (turn * q - 1) // count
    )  # a turn back by a is one on by s - a, with its sign
    onward = [_turned_by(ring.onward, j, count - turn) for j in kept.contacts]
    back = np.roll(phi, -(count - turn) * dofs, axis=0)
    modes = sign * (ring.kept / ring.sectors) * (phi.T @ kept.modal.mass @ back)
    modes[np.abs(modes) <= _EQUAL] = 0.0
    at = np.searchsorted(kept.contacts, ring.contacts[[other for other, _ in onward]])
    signs = sign * np.array([own for _, own in onward]) * ring.signs[[other for other, _ in onward]]
    # each part is a whole number of intervals; rates in the middle of those that have this number
    intervals = np.ceil(np.ceil(problem.rates * (math.pi / TURN)) / count) * count
    rates = (intervals - 0.5) * (TURN / math.pi)
    return problem._replace(parts=count, turn=Turn(modes, at, signs), rates=rates)


def keep_sectors(system: System, full: Problem, starts: np.ndarray) -> tuple[Kept, np.ndarray] | None:
    """The sectors that differ, and their initial states; None without a ring, or where these do not repeat.

    Parameters
    ----------
    system : System
    full : Problem of the whole structure
    starts : (n_r, 3, m) initial states, see `starts`
    """
    ring = find_ring(system)
    if ring is None:
        return None
    kept = _kept(system, full, ring)
    places = system.modes.phi @ starts[:, :2].swapaxes(1, 2)  # (n_r, N n, 2)
    own = (ring.kept / ring.sectors) * (kept.modal.phi.T @ system.modes.mass @ places)
    if not _is_equal(kept.modal.phi @ own, places):
        return None
    phase = np.repeat(starts[:, 2:, :1], own.shape[1], axis=2)
    kept = kept._replace(problem=_with_parts(kept.problem, kept))
    return kept, np.concatenate((own.swapaxes(1, 2), phase), axis=1)


def kept_rows(system: System, kept: Kept, further: bool) -> np.ndarray:
    """What is recorded of the whole structure, by the modes and channels of the sectors kept; see
    `observed_rows`.
    """
    rows, modes = observed_rows(system, kept.modal, further), kept.modal.squares.size
    if not further:
        return rows
    return np.hstack((rows[:, :modes], rows[:, modes:-1] @ kept.mix, rows[:, -1:]))


def spread(cells: Cells, kept: Kept) -> Cells:
    """Cells of the whole structure from those of the sectors that are kept."""
    at = np.searchsorted(kept.contacts, kept.ring.contacts)
    signs, count = kept.ring.signs, kept.contacts.size
    numbers = cells.numbers[..., at]
    numbers[_SIGNED] *= signs
    low, high = cells.lowest[..., at], cells.highest[..., at]
    ends = np.where(signs > 0.0, low, -high), np.where(signs > 0.0, high, -low)
    lowest, highest = (
        np.concatenate((end, table[..., count:]), axis=-1)
        for end, table in zip(ends, (cells.lowest, cells.highest), strict=True)
    )
    return cells._replace(
        contact_regime=cells.contact_regime[..., at], numbers=numbers, lowest=lowest, highest=highest
    )
