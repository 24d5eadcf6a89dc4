"""Permanent sticking of contacts that close a loop: only the sums of their forces over cuts are determined.

With W F = f known, forces within the limits exist iff |f.y| <= sum mu_i beta_i |g_i| for every elementary
vector g = W^T y: a vector of the row space of W that vanishes in as many contacts as possible.  For contacts
between masses these are the cuts of their graph.  Duality of linear programming.

Where there are many of these vectors, the worst one is found from instants: the linear program of one instant
has it as its dual solution, and a vector has an instant at which it is worst (`_worst_cut`).
"""

from collections.abc import Mapping
from itertools import combinations
from math import comb

import numpy as np

from ..errors import InputError
from ..model.general import LOOP, ContactSystem
from ..model.system import System
from .held import half_range, independent_contacts, orders_of, possible_forces
from .problem import general_of

#: Parts of unit vectors that are zero, to rounding.
_ZERO = 1e-10

#: Elementary vectors are listed up to this number of sets of contacts in which they can vanish: some 20 ms.
_MOST_SETS = 500

#: Instants of half a period, per order of the highest harmonic, from which the worst vector is looked for,
#: and the steps there, at most: they found the worst of all vectors in 200 random systems.
_INSTANTS, _STEPS = 8, 30

#: Cost of friction that the grid does not give, over that of the grid's, in the linear program of an instant.
_PENALTY = 1e6


def elementary_vectors(w: np.ndarray) -> np.ndarray:
    """Vectors of least support in the row space of w (n, N), each once, largest entry 1; (vectors, N)."""
    _, sizes, right = np.linalg.svd(w)
    rank = int((sizes > _ZERO * sizes[0]).sum())
    basis = right[:rank]
    # vectors of least support with the same support are multiples: else a combination had a smaller one
    found: dict[tuple[int, ...], np.ndarray] = {}
    for zeros in combinations(range(w.shape[1]), rank - 1):
        _, values, directions = np.linalg.svd(basis[:, zeros].T)
        if rank > 1 and values[-1] <= _ZERO:
            continue
        g = directions[-1] @ basis
        g = g / g[np.argmax(np.abs(g))]
        g[np.abs(g) <= _ZERO] = 0.0
        found.setdefault(tuple(np.flatnonzero(g).tolist()), g)
    return np.array([*found.values()])


def undetermined_forces(w: np.ndarray, held: np.ndarray) -> np.ndarray:
    """Forces that forces without an effect can change, bool (steps, N).

    w : (n, N)
    held : (steps, N) whether a contact is held
    """
    found = np.zeros(held.shape, dtype=bool)
    kinds, which = np.unique(held, axis=0, return_inverse=True)
    for k, kind in enumerate(kinds):
        stuck = np.flatnonzero(kind)
        if not stuck.size:
            continue
        _, sizes, right = np.linalg.svd(w[:, stuck])
        rank = int((sizes > _ZERO * sizes[0]).sum())
        free = (np.abs(right[rank:]) > _ZERO).any(axis=0)
        found[np.ix_(which.ravel() == k, stuck[free])] = True
    return found


def refuse_further_loops(general: ContactSystem, mu: np.ndarray) -> None:
    """Refuse loops whose forces or motions are not unique, or not found."""
    further = any(group.first.nu or group.first.belt or group.base for group in general.groups)
    if further or general.elastic.any() or general.has_law:
        raise InputError(
            "cannot use",
            "contacts",
            f"{general.loop} together: {LOOP}; contacts that close a loop must all be rigid, without belts, "
            f"joined walls, laws or varying normal loads",
        )
    for value in mu:
        if not general.has_equal_friction(float(value)):
            raise InputError(
                "mu",
                f"must be 1 for motions of contacts that close a loop ({general.loop}): which of them let go "
                f"together is not determined otherwise; got {value:g}",
            )


def _cut_at(w: np.ndarray, force: np.ndarray, own: np.ndarray, slope: np.ndarray) -> np.ndarray:
    """Elementary vector that needs the largest scale at an instant, (N,), its largest entry 1 or -1.

    It is the dual solution of: least scale with forces f, W f = W F, |f| <= own + scale slope.

    Parameters
    ----------
    w : (n, N)
    force : (N,) any forces F that hold the contacts at this instant
    own, slope : (N,) static friction at the scale 0, and per scale
    """
    from scipy.optimize import linprog

    count = own.size
    limits = np.column_stack((-slope, -np.ones(count)))
    size = np.abs(force).max()
    solved = linprog(
        np.append(np.zeros(count), (1.0, _PENALTY)),
        A_ub=np.vstack((np.hstack((np.eye(count), limits)), np.hstack((-np.eye(count), limits)))),
        b_ub=np.tile(own / size, 2), A_eq=np.hstack((w, np.zeros((len(w), 2)))), b_eq=w @ (force / size),
        bounds=[(None, None)] * count + [(0.0, None)] * 2, method="highs-ds",
    )  # fmt: skip
    g = solved.eqlin.marginals @ w
    largest = np.abs(g).max()
    if largest == 0.0:
        return g
    g = g / largest
    g[np.abs(g) <= _ZERO] = 0.0
    return g


def _scale_of(needed: np.ndarray, own: np.ndarray, slope: np.ndarray) -> np.ndarray:
    """Scales at which the friction of cuts is what they need; infinite where it does not grow."""
    rest = np.maximum(needed - own, 0.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(rest > 0.0, rest / slope, 0.0)


def _worst_cut(w: np.ndarray, forces: Mapping[int, np.ndarray], own: np.ndarray, slope: np.ndarray) -> float:
    """Scale that the worst elementary vector needs under forces (N,) by order.

    From each instant the worst vector leads to the instant at which it is worst, while the scale grows.
    """
    orders = np.array(list(forces))
    phasors = np.array(list(forces.values()))
    tau = np.linspace(0.0, np.pi, 64 * int(orders.max()), endpoint=False)  # the other half mirrors this one
    waves = np.exp(1j * np.outer(tau, orders))
    worst = 0.0
    for start in range(0, tau.size, tau.size // (_INSTANTS * int(orders.max()))):
        at, scale = start, -1.0
        for _ in range(_STEPS):
            force = (waves[at] @ phasors).real
            g = _cut_at(w, force, own, slope) if force.any() else np.zeros(own.size)
            needed = half_range({n: (one @ g)[np.newaxis, np.newaxis] for n, one in forces.items()})[0, 0]
            found = float(_scale_of(needed, np.abs(g) @ own, np.abs(g) @ slope))
            if not found > scale:
                break
            scale, at = found, int(np.abs((waves @ (phasors @ g)).real).argmax())
        worst = max(worst, scale)
    return worst


def _by_instants(
    system: System, w: np.ndarray, forces: Mapping[int, np.ndarray], own: np.ndarray, slope: np.ndarray
) -> np.ndarray:
    """Scales over r of the worst elementary vectors, (n_r,); forces (n_r, N) by order."""
    orders = orders_of(general_of(system))
    finite = np.all([np.isfinite(forces[n]).all(axis=1) for n in orders], axis=0)
    found = np.full(finite.size, np.inf)
    for i in np.flatnonzero(finite):
        found[i] = _worst_cut(w, {n: forces[n][i] for n in orders}, own, slope)
    return found


def loop_stick_scales(system: System, r: np.ndarray, mu: np.ndarray, kinetic: bool = False) -> np.ndarray:
    """Find the beta from which contacts that close a loop stick permanently, (n_mu, n_r).

    NaN under even harmonics: the best places of the contacts depend on each other.

    kinetic : whether kinetic friction alone holds them, so that every motion comes to rest
    """
    general = general_of(system)
    refuse_further_loops(general, np.ones(0))
    if any(n % 2 == 0 for n in general.orders):
        return np.full((mu.size, r.size), np.nan)
    w = general.vectors.T
    held = independent_contacts(w)
    forces, _ = possible_forces(system, r)
    found = np.zeros((mu.size, r.size))
    few = comb(w.shape[1], len(held) - 1) <= _MOST_SETS
    if few:
        vectors = elementary_vectors(w)
        needed = half_range({n: force @ vectors.T for n, force in forces.items()})  # (n_r, vectors)
    which = 0 if kinetic else 1
    for m, value in enumerate(mu):
        own = np.array([group.friction(0.0, float(value))[which] for group in general.groups])
        slope = np.array([group.friction(1.0, float(value))[which] for group in general.groups]) - own
        if few:
            sizes = np.abs(vectors)
            found[m] = _scale_of(needed, sizes @ own, sizes @ slope).max(axis=1)
        else:
            found[m] = _by_instants(system, w, forces, own, slope)
    return found
