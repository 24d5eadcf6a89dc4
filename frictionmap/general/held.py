"""Contacts that do not slide: their forces, and the friction from which they stay so.

The structure with rigid contacts held and elastic ones as springs is linear; per harmonic

    [K' - n^2 r^2 M + i n r C, W; W^T, 0] [X_n; F_n] = [p_n; s u_n],   K' = K + sum k_t c c^T

A contact sticks permanently iff half the range of its force is at most its static friction (theory.md 11);
with a varying normal load iff max(F - mu beta nu) <= min(F + mu beta nu).
"""

from collections.abc import Mapping

import numpy as np

from ..errors import InputError
from ..model.general import ContactSystem
from ..model.system import System
from .observed import observed_phasors
from .problem import general_of, is_symmetric, pull_of, refuse_loop, springs

#: Samples per period of the highest harmonic where extremes are looked for, and steps that refine them.
_SAMPLES = 16
_REFINED = 8

#: Steps to a boundary with a varying normal load.
_MOST_STEPS = 60

#: Rounding error of the linear equations, some hundred times 2^-53: a pivot below this share of the stiffness
#: is a resonance of the held structure, and a force below this share of the largest one is zero.
_ROUNDING = 1e-14

#: Parts of unit vectors that are zero, to rounding.
_SPAN = 1e-10

#: Friction above this, over the unit of the load, is infinite: the normal load of the contact vanishes at an
#: instant at which the contact is loaded, or is rounding error there.
_ENDLESS = 1e12


def base_seen_by_dampers(system: System) -> np.ndarray | None:
    """What a unit displacement of the base adds to the motion that the dampers see, (n,); None: nothing.

    Modes at points are relative to the base, all other motions are not.
    """
    points = general_of(system).shaken_points
    if (points is None) != (system.damping_reference == "base"):
        return None
    return -np.ones(system.n) if points is None else general_of(system).moved(system.modes.mass)


def linear_parts(
    system: System, stiffness: np.ndarray, order: int, r: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Dynamic stiffness (n_r, n, n) and load (n_r, n) of a harmonic, without forces in contacts."""
    general, modes = general_of(system), system.modes
    square = (order * r)[:, np.newaxis]
    matrix = stiffness - square[:, np.newaxis] ** 2 * modes.mass + 1j * square[:, np.newaxis] * modes.damping
    load = np.zeros((r.size, len(stiffness)), dtype=complex)
    load += general.forces.get(order, 0.0)
    u, of_points = general.base.get(order, 0.0), general.shaken_points is not None
    if of_points:
        load += square**2 * u * general.moved(modes.mass)
    else:
        load += u * modes.stiffness.sum(axis=1)
    if of_points != (system.damping_reference == "base"):
        load += 1j * square * (-u if of_points else u) * general.moved(modes.damping)
    return matrix, load


def orders_of(general: ContactSystem) -> list[int]:
    """Orders of the harmonics that move the structure."""
    return sorted({*general.forces, *general.base})


def held_forces(system: System, r: np.ndarray) -> tuple[dict[int, np.ndarray], dict[int, np.ndarray]]:
    """Forces F_n (n_r, N) in the contacts and displacements X_n (n_r, n), by order; inf at a resonance."""
    general = general_of(system)
    refuse_loop(general)
    return held_forces_of(system, r, np.arange(general.count))


def possible_forces(system: System, r: np.ndarray) -> tuple[dict[int, np.ndarray], dict[int, np.ndarray]]:
    """Forces and displacements as of `held_forces`; in contacts that close loops, forces that hold them."""
    general = general_of(system)
    if not general.loop:
        return held_forces(system, r)
    held = np.array(independent_contacts(general.vectors.T))
    forces, motions = held_forces_of(system, r, held)
    found = {n: np.zeros((r.size, general.count), dtype=complex) for n in forces}
    for n, force in forces.items():
        found[n][:, held] = force
    return found, motions


def independent_contacts(w: np.ndarray) -> list[int]:
    """Contacts with linearly independent vectors that span those of all, in order; w (n, N)."""
    found: list[int] = []
    for j in range(w.shape[1]):
        if np.linalg.matrix_rank(w[:, [*found, j]], tol=_SPAN) > len(found):
            found.append(j)
    return found


def held_forces_of(
    system: System, r: np.ndarray, which: np.ndarray
) -> tuple[dict[int, np.ndarray], dict[int, np.ndarray]]:
    """Forces and displacements as of `held_forces`, with the contacts `which` (N',) alone."""
    general = general_of(system)
    elastic, vectors = general.elastic[which], general.vectors[which]
    n = vectors.shape[1]
    moved = np.array([float(general.groups[j].base) for j in which])
    kt, flexibility = springs(general)[which], general.flexibility
    if flexibility.size:
        kt = np.linalg.inv(flexibility[np.ix_(which, which)])
    w, pull = vectors[~elastic].T, pull_of(kt, vectors).T
    stiffness = system.modes.stiffness + pull @ vectors
    for j in which:
        normal = general.groups[j].normal  # a contact that is held is closed
        if normal is not None:
            stiffness = stiffness + normal.stiffness * np.outer(normal.direction, normal.direction)
    forces, motions = {}, {}
    for order in orders_of(general):
        matrix = np.zeros((r.size, n + w.shape[1], n + w.shape[1]), dtype=complex)
        right = np.zeros((r.size, n + w.shape[1]), dtype=complex)
        matrix[:, :n, :n], right[:, :n] = linear_parts(system, stiffness, order, r)
        matrix[:, :n, n:], matrix[:, n:, :n] = w, w.T
        u = general.base.get(order, 0.0)
        right[:, :n] += u * pull @ moved
        direct = direct_displacements(general, order, r)[..., which]
        right[:, n:] = u * moved[~elastic] - direct[..., ~elastic]
        right[:, :n] -= (pull @ direct.T).T
        found = solve_each(matrix, right)
        x = found[:, :n]
        force = np.empty((r.size, which.size), dtype=complex)
        force[:, ~elastic] = found[:, n:]
        with np.errstate(invalid="ignore"):  # an infinite x
            place = x @ vectors[elastic].T - u * moved[elastic] + direct[..., elastic]
            force[:, elastic] = place @ kt if flexibility.size else kt[elastic] * place
        forces[order], motions[order] = force, x
    return forces, motions


def direct_displacements(general: ContactSystem, order: int, r: np.ndarray) -> np.ndarray:
    """Displacements in the contacts by load and base at an order beside those of modes, (N,) or (n_r, N)."""
    if general.points is None:
        return np.zeros(general.count)
    return np.asarray((general.points.vectors @ general.direct_motion(order, r).T).T)


def held_displacements(system: System, r: np.ndarray) -> dict[int, np.ndarray]:
    """Displacements (n_r, n) of masses, or points, with all contacts held, by order; inf at a resonance."""
    general = general_of(system)
    forces, motions = possible_forces(system, r)
    return {n: general.displacements(n, r, motion, forces[n]) for n, motion in motions.items()}


def held_ranges(system: System, r: np.ndarray, further: bool = False) -> tuple[np.ndarray, np.ndarray]:
    """Lowest and highest displacements in the contacts, then of the masses, (n_r, N + n), all held.

    Infinite at a resonance; 0 in rigid contacts.  With `further` also what else is observed, see `observed`.
    """
    general = general_of(system)
    motions = held_displacements(system, r)
    orders = np.array(list(motions), dtype=float)
    x = np.stack(list(motions.values()), axis=-1)  # (n_r, n, H)
    more = [observed_phasors(system, n, r, one) for n, one in motions.items()] if further else []
    vectors = general.vectors if general.points is None else general.points.vectors
    z = np.einsum("jn,rnh->rjh", vectors, x)
    for j, group in enumerate(general.groups):
        if group.base:
            z[:, j] -= np.array([general.base.get(int(n), 0.0) for n in orders])
        if group.stiffness is None:
            z[:, j] = 0.0
    both = np.concatenate((z, x, np.stack(more, axis=-1)) if further else (z, x), axis=1)
    finite = np.isfinite(both).all(axis=-1)
    both = np.where(finite[..., np.newaxis], both, 0.0)
    high, low = largest(orders, both), -largest(orders, -both)
    return np.where(finite, low, -np.inf), np.where(finite, high, np.inf)


def sliding_phasors(system: System, r: np.ndarray) -> np.ndarray:
    """Displacements in the contacts without friction, (n_r, N, H) by order; inf at a resonance."""
    general = general_of(system)
    moved = general.joined
    found = []
    for order in orders_of(general):
        x = solve_each(*linear_parts(system, system.modes.stiffness, order, r))
        with np.errstate(invalid="ignore"):  # an infinite x
            z = x @ general.vectors.T - general.base.get(order, 0.0) * moved
            found.append(z if general.points is None else z + direct_displacements(general, order, r))
    return np.stack(found, axis=-1)


def belt_limit(system: System, r: np.ndarray) -> np.ndarray:
    """Belt velocity from which the only contact slides one way, (n_r,): the largest speed without friction.

    NaN where there is no belt, infinite at an undamped resonance.
    """
    general = general_of(system)
    if general.count > 1 or not general.groups[0].first.belt:
        return np.full(r.size, np.nan)
    orders = np.array(orders_of(general), dtype=float)
    speeds = 1j * orders * sliding_phasors(system, r)[:, 0]
    grows = ~np.isfinite(speeds).all(axis=1)
    sign = np.sign(general.groups[0].first.belt)
    found = largest(orders, sign * np.where(grows[:, np.newaxis], 0.0, speeds))
    return np.where(grows, np.inf, found)


def _solve_one(matrix: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Solve for one r; inf where the matrix is singular."""
    try:
        return np.linalg.solve(matrix, right)
    except np.linalg.LinAlgError:
        return np.full_like(right, np.inf)


def solve_each(matrix: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Solve for every r; inf where the matrix is singular to rounding."""
    try:
        found = np.linalg.solve(matrix, right[..., np.newaxis])[..., 0]
    except np.linalg.LinAlgError:  # one of them is singular
        found = np.stack([_solve_one(*one) for one in zip(matrix, right, strict=True)])
    size = np.abs(matrix).max(axis=(1, 2))
    with np.errstate(invalid="ignore"):
        load = np.abs(right).max(axis=1)
        found[np.abs(found).max(axis=1) * size > load / _ROUNDING] = np.inf
    return found


def largest(orders: np.ndarray, phasors: np.ndarray) -> np.ndarray:
    """Largest value of Re sum a_n e^{i n tau} over tau; phasors (..., H)."""
    if orders.size == 1:
        return np.abs(phasors[..., 0])
    count = _SAMPLES * int(orders.max())
    tau = np.linspace(0.0, 2.0 * np.pi, count, endpoint=False)
    values = (phasors[..., np.newaxis, :] * np.exp(1j * np.outer(tau, orders))).real.sum(axis=-1)
    around = np.stack((np.roll(values, 1, axis=-1), np.roll(values, -1, axis=-1)))
    peaks = (values >= around).all(axis=0)
    places = np.broadcast_to(tau, values.shape)[peaks]
    own = np.broadcast_to(phasors[..., np.newaxis, :], (*values.shape, orders.size))[peaks]
    best = values[peaks]
    step = np.pi / count
    for _ in range(_REFINED):
        terms = own * np.exp(1j * places[:, np.newaxis] * orders)
        slope, bend = -(orders * terms.imag).sum(axis=1), -(orders**2 * terms.real).sum(axis=1)
        best = np.maximum(best, terms.real.sum(axis=1))
        move = np.where(bend < 0.0, -slope / np.where(bend < 0.0, bend, 1.0), 0.0)
        places = places + np.clip(move, -step, step)
    found = np.full(values.shape, -np.inf)
    found[peaks] = best
    return found.max(axis=-1)


def _extremes(forces: Mapping[int, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Largest forces of both signs, (n_r, N)."""
    orders = np.array(list(forces), dtype=float)
    phasors = np.stack(list(forces.values()), axis=-1)
    infinite = ~np.isfinite(phasors).all(axis=-1)
    phasors = np.where(infinite[..., np.newaxis], 0.0, phasors)
    high, low = largest(orders, phasors), largest(orders, -phasors)
    return np.where(infinite, np.inf, high), np.where(infinite, np.inf, low)


def half_range(forces: Mapping[int, np.ndarray]) -> np.ndarray:
    """Half the range of the forces, (n_r, N)."""
    high, low = _extremes(forces)
    return 0.5 * (high + low)


def _instants_without_load(normal: Mapping[int, complex]) -> np.ndarray:
    """Phases at which a normal load vanishes, to rounding.

    Least values up to `_ROUNDING` count: a contact under them is held by some friction above `_ENDLESS` only.
    """
    n, nu = np.array(sorted(normal), dtype=float), np.array([normal[k] for k in sorted(normal)])
    count = _SAMPLES * int(n.max())
    tau = np.linspace(0.0, 2.0 * np.pi, count, endpoint=False)
    values = (nu * np.exp(1j * tau[:, np.newaxis] * n)).real.sum(axis=1)
    tau = tau[(values <= np.roll(values, 1)) & (values <= np.roll(values, -1))]
    step = np.pi / count
    for _ in range(_REFINED):
        terms = nu * np.exp(1j * tau[:, np.newaxis] * n)
        slope, bend = -(n * terms.imag).sum(axis=1), -(n**2 * terms.real).sum(axis=1)
        move = np.where(bend > 0.0, -slope / np.where(bend > 0.0, bend, 1.0), -np.sign(slope) * step)
        tau = tau + np.clip(move, -step, step)
    least = 1.0 + (nu * np.exp(1j * tau[:, np.newaxis] * n)).real.sum(axis=1)
    return tau[least <= _ROUNDING * (1.0 + np.abs(nu).sum())]


def _is_loaded_without(n: np.ndarray, load: np.ndarray, instants: np.ndarray, placed: bool) -> np.ndarray:
    """Whether no friction holds a contact whose normal load vanishes at these instants, (n_r,).

    Next to an instant the normal load is of second order: the force that holds the contact must be zero
    there, up to a constant if it is `placed`, with its slope.
    """
    terms = load[:, np.newaxis, :] * np.exp(1j * instants[:, np.newaxis] * n)
    force, slope = terms.real.sum(axis=-1), -(n * terms.imag).sum(axis=-1)
    if placed:
        force = force - force[:, :1]
    # Newton's method for nu' = 0 finds the instants to rounding; some ten of its errors add up
    size = 1e2 * _ROUNDING * (n * np.abs(load)).sum(axis=-1)
    return (np.maximum(np.abs(force), np.abs(slope)) > size[:, np.newaxis]).any(axis=1)


def _least_friction(
    forces: Mapping[int, np.ndarray], normal: Mapping[int, complex], j: int, placed: bool
) -> np.ndarray:
    """Least static friction f of contact j with max(F - f nu) <= min(F + f nu), (n_r,).

    The sum max(F - f nu) + max(-F - f nu) falls with f: its zero is found by bisection.  Where no other place
    changes F by a constant (not `placed`), twice the larger of the two takes its place.
    """
    orders = sorted({*forces, *normal})
    n = np.array(orders, dtype=float)
    load = np.stack(
        [forces.get(k, np.zeros_like(next(iter(forces.values()))))[:, j] for k in orders], axis=-1
    )
    nu = np.array([normal.get(k, 0.0) for k in orders])
    infinite = ~np.isfinite(load).all(axis=-1)
    load = np.where(infinite[:, np.newaxis], 0.0, load)
    instants = _instants_without_load(normal)
    if instants.size:
        infinite |= _is_loaded_without(n, load, instants, placed)

    # where the normal load vanishes, the excess of a contact that can be held is zero from its friction on
    rounding = _ROUNDING if instants.size else 0.0

    def excess(f: np.ndarray) -> np.ndarray:
        part = f[:, np.newaxis] * nu
        high, low = largest(n, load - part), largest(n, -load - part)
        return (high + low if placed else 2.0 * np.maximum(high, low)) - (2.0 + rounding) * f

    low = np.zeros(len(load))
    high = 0.5 * excess(low)
    while (grow := (excess(high) > 0.0) & (high <= _ENDLESS)).any():
        high = np.where(grow, 2.0 * high, high)
    for _ in range(_MOST_STEPS):
        middle = 0.5 * (low + high)
        above = excess(middle) > 0.0
        low, high = np.where(above, middle, low), np.where(above, high, middle)
    return np.where(infinite | (high > _ENDLESS), np.inf, high)


def _placed(system: System) -> np.ndarray:
    """Whether another place of each contact changes the force in it by a constant, (N,) bool.

    Constant forces g in the contacts of a free structure must not push its rigid-body modes, A^T g = 0 with
    the displacements A (N, k) in the contacts.  Where each g is either 0 or any, contacts are on their own.
    """
    general, k = general_of(system), system.rigid_modes
    placed = np.ones(general.count, dtype=bool)
    if not k:
        return placed
    left, sizes, _ = np.linalg.svd(general.vectors @ system.modes.phi[:, :k])
    rank = int((sizes > _SPAN * max(float(sizes.max(initial=0.0)), 1e-300)).sum())
    free = left[:, rank:]
    own = (free**2).sum(axis=1)  # the diagonal of the projector on these g
    placed = own > _SPAN
    if not is_symmetric(general) and (placed & (own < 1.0 - _SPAN)).any():
        names = ", ".join(general.groups[j].name for j in np.flatnonzero(placed & (own < 1.0 - _SPAN)))
        raise InputError(
            "cannot use",
            "contacts",
            f"{names} on a free structure under even harmonics, odd harmonics of normal loads or belts: "
            f"constant forces in them depend on each other; leave these out, or add a spring to the ground",
        )
    return placed


def least_static_friction(system: System, r: np.ndarray) -> np.ndarray:
    """Least static friction with which all contacts stick permanently, (n_r, N); inf beside a belt."""
    general = general_of(system)
    forces, _ = held_forces(system, r)
    high, low = _extremes(forces)
    found, placed = 0.5 * (high + low), _placed(system)
    found[:, ~placed] = np.maximum(high, low)[:, ~placed]
    for j, group in enumerate(general.groups):
        if group.first.nu:
            found[:, j] = _least_friction(forces, group.first.nu, j, bool(placed[j]))
        if group.first.belt:
            found[:, j] = np.inf
    zero = _ROUNDING * np.where(np.isfinite(found), found, 0.0).max(axis=1, initial=0.0)
    return np.where(found <= zero[:, np.newaxis], 0.0, found)


def stick_scales(general: ContactSystem, needed: np.ndarray, mu: np.ndarray) -> np.ndarray:
    """beta from which each contact sticks permanently, (n_mu, n_r, N), from the static friction it needs.

    inf for a contact with a friction force of its own that is too small; 0 where it is large enough.
    """
    return np.stack([_scales(general, needed, float(value), 1) for value in mu])


def rest_scales(general: ContactSystem, needed: np.ndarray) -> np.ndarray:
    """beta from which kinetic friction is enough for each contact, (n_r, N), see `stick_scales`.

    If it is enough for all contacts, every motion comes to rest (theory.md 6, 11).
    """
    return _scales(general, needed, 1.0, 0)


def _scales(general: ContactSystem, needed: np.ndarray, mu: float, which: int) -> np.ndarray:
    """beta with which the kinetic (0) or static (1) friction of each contact is what it needs, (n_r, N)."""
    found = np.empty(needed.shape)
    for j, group in enumerate(general.groups):
        own = group.friction(0.0, mu)[which]
        per_beta = group.friction(1.0, mu)[which] - own
        rest = np.maximum(needed[:, j] - own, 0.0)
        found[:, j] = rest / per_beta if per_beta > 0.0 else np.where(rest > 0.0, np.inf, 0.0)
    return found
