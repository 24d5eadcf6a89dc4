"""Permanent sticking of contacts that close a loop: only the sums of their forces over cuts are determined.

With W F = f known, forces within the limits exist iff |f.y| <= sum mu_i beta_i |g_i| for every elementary
vector g = W^T y: a vector of the row space of W that vanishes in as many contacts as possible.  For contacts
between masses these are the cuts of their graph.  Duality of linear programming.
"""

from itertools import combinations

import numpy as np

from ..errors import InputError
from ..model.general import LOOP, ContactSystem
from ..model.system import System
from .held import half_range, held_forces_of
from .problem import general_of

#: Parts of unit vectors that are zero, to rounding.
_ZERO = 1e-10


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


def independent_contacts(w: np.ndarray) -> list[int]:
    """Contacts with linearly independent vectors that span those of all, in order; w (n, N)."""
    found: list[int] = []
    for j in range(w.shape[1]):
        if np.linalg.matrix_rank(w[:, [*found, j]], tol=_ZERO) > len(found):
            found.append(j)
    return found


def _refuse(general: ContactSystem) -> None:
    """Refuse loops for which forces of one time do not decide."""
    even = [n for n in general.orders if n % 2 == 0]
    further = any(group.first.nu or group.first.belt or group.base for group in general.groups)
    if even or further or general.elastic.any():
        raise InputError(
            "cannot use",
            "contacts",
            f"{general.loop} together: {LOOP}; beta_stick of a loop is found for rigid contacts under "
            f"odd harmonics only, without belts, joined walls or varying normal loads",
        )


def loop_stick_scales(system: System, r: np.ndarray, mu: np.ndarray) -> np.ndarray:
    """Find the beta from which contacts that close a loop stick permanently, (n_mu, n_r)."""
    general = general_of(system)
    _refuse(general)
    w = general.vectors.T
    held = independent_contacts(w)
    forces, _ = held_forces_of(system, r, np.array(held))
    vectors = elementary_vectors(w)
    cuts = {n: force @ vectors[:, held].T for n, force in forces.items()}
    needed = half_range(cuts)  # (n_r, vectors)
    found = np.zeros((mu.size, r.size))
    for m, value in enumerate(mu):
        own = np.abs(vectors) @ [group.friction(0.0, float(value))[1] for group in general.groups]
        whole = np.abs(vectors) @ [group.friction(1.0, float(value))[1] for group in general.groups]
        rest, slope = np.maximum(needed - own, 0.0), whole - own
        with np.errstate(divide="ignore", invalid="ignore"):
            found[m] = np.where(rest > 0.0, rest / slope, 0.0).max(axis=1)
    return found
