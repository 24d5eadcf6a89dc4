"""Accuracy of a reduction: natural frequencies and compliances against those of the whole structure.

Both without damping, which would hide errors, and both with the contacts free and all held.  Compliances are
those between all kept degrees of freedom, away from resonances, each in the unit of its static ones; their
error is that of all together, over the larger of those free and held.

Friction that reverses at once has harmonics far above the range, and sticking depends on the mass that the
contact feels in that instant, theory.md 3, and a reduction keeps few of the masses around it separate.  So
the contacts' effective masses are reported with the errors, but have no limit.
"""

import threading
from collections.abc import Callable, Iterable
from typing import Any, NamedTuple, TypeVar

import numpy as np

from ..errors import InputError
from .craig_bampton import Reduced, factor, slowest

T = TypeVar("T")

#: Held while the whole structure is analysed; not sent to other processes.
_LOOKING = threading.Lock()

#: Number of frequencies at which compliances are compared, none nearer to a resonance than this share:
#: there the error is that of the resonance's frequency.
_SAMPLES = 60
_NEAR = 0.05

#: Frequencies, evenly spaced, beside those between resonances.
_EVEN = 9

#: Number of frequencies of the whole structure computed beyond those of the reduced one in the range.
_FURTHER = 3


class Ranges(dict[tuple[float, float], T | InputError]):
    """Cache of results, or of refusals, by range of frequency."""

    def lookup(self, low: float, high: float, find: Callable[[], T]) -> T:
        """Return the result for a range; that of a known range which contains it is returned at once.

        If several threads request one range, it is computed once.
        """
        with _LOOKING:
            found = self.get((low, high))
            if found is None:
                found = self._around(low, high)
            if found is None:
                found = self[low, high] = _found(find)
        if isinstance(found, InputError):
            raise found.renamed(found.where)  # a new one: each has a traceback of its own
        return found

    def _around(self, low: float, high: float) -> T | None:
        """Result for a known range that contains this one; part of a refused range may be valid."""
        for (least, most), found in self.items():
            if least <= low and high <= most and not isinstance(found, InputError):
                return found
        return None


def _found(find: Callable[[], T]) -> T | InputError:
    try:
        return find()
    except InputError as error:
        return error


class Accuracy(NamedTuple):
    """Largest relative errors in a range of frequency, and the effect on higher frequencies.

    contact_mass : 1/(c M^-1 c) of the reduced structure, over that of the whole one; 1 or more; the largest
        of all contacts
    """

    frequencies: float
    compliances: float
    contact_mass: float
    contacts: int = 1  # how many there are

    @property
    def worst(self) -> float:
        """The larger error."""
        return max(self.frequencies, self.compliances)

    def describe(self) -> str:
        """Describe the errors in the range."""
        if not np.isfinite(self.frequencies):
            return "natural frequencies of the whole structure are missing"
        return (
            f"natural frequencies within {self.frequencies:.1e} of the whole structure's, compliances within "
            f"{self.compliances:.1e}"
        )

    def beyond(self) -> str:
        """Describe the effect on frequencies above the range."""
        whose = (
            "the contact's effective mass is"
            if self.contacts == 1
            else "effective masses of contacts are up to"
        )
        return f"{whose} {self.contact_mass:.4g} times that of the whole structure"


class FullStructure:
    """A structure with sparse matrices, the reference for its reductions."""

    def __init__(self, mass: Any, stiffness: Any, contacts: np.ndarray, forces: np.ndarray) -> None:
        """contacts: c of each (N, n); forces (n, k): the loads whose works on each other are compliances."""
        self.contacts = contacts
        self.forces = forces
        self._mass, self._stiffness = mass, stiffness
        held = _held(contacts)
        self._pairs = ((mass, stiffness), (held.T @ mass @ held, held.T @ stiffness @ held))
        static = factor(stiffness).solve(forces)
        self.units = np.sqrt(np.einsum("ij,ij->j", forces, static))
        self.inverse_masses = _inverse_masses(mass, contacts)

    def frequencies(self, held: bool, most: float, guess: int, limit: int) -> np.ndarray:
        """Natural frequencies up to `most`, increasing, no more than `limit`; `guess`: how many may be."""
        mass, stiffness = self._pairs[int(held)]
        limit = min(limit, mass.shape[0])
        count = min(guess + _FURTHER, limit)
        while True:
            found, _ = slowest(mass, stiffness, count)
            if count == limit or found[-1] > most:
                return found[found <= most]
            count = min(2 * count, limit)

    def compliances(self, omega: float) -> np.ndarray:
        """Works of the forces on each other's motions, (k, k)."""
        from scipy.sparse.linalg import splu

        dynamic = (self._stiffness - omega * omega * self._mass).tocsc()
        return self.forces.T @ splu(dynamic).solve(self.forces)


def _inverse_masses(mass: Any, contacts: np.ndarray) -> np.ndarray:
    """c M^-1 c of each contact, (N,), over the degrees of freedom that have mass; infinite if some of their
    motions have none.
    """
    moving = np.flatnonzero(np.asarray(abs(mass).sum(axis=1)))
    pulls = contacts[:, moving]
    try:
        factors = factor(mass[moving][:, moving])
    except InputError:
        return np.full(len(contacts), np.inf)
    return np.array([pull @ factors.solve(pull) for pull in pulls])


def _held(contacts: np.ndarray) -> Any:
    """Motions (n, m) that leave all contacts alone, sparse.

    Degrees of freedom that contacts between them join move as one; joined to a wall, not at all.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    n = contacts.shape[1]
    ends = [np.flatnonzero(contact) for contact in contacts]
    pairs = np.array([(rows[0], rows[1] if rows.size > 1 else n) for rows in ends])  # n: the wall
    joined = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(n + 1, n + 1))
    part = connected_components(joined, directed=False)[1]
    rows = np.flatnonzero(part[:n] != part[n])
    columns = np.unique(part[rows], return_inverse=True)[1]
    count = int(columns.max(initial=-1)) + 1
    return coo_array((np.ones(rows.size), (rows, columns)), shape=(n, count)).tocsr()


class Comparison:
    """Reduced structures against a whole one, from one frequency to another; the whole is solved once."""

    def __init__(self, whole: FullStructure, low: float, high: float) -> None:
        self._whole = whole
        self._range = low, high
        self._frequencies: tuple[np.ndarray, ...] = ()
        self._limit = 0  # no more of them were looked for
        self._samples: list[tuple[float, np.ndarray]] = []

    def accuracy(self, reduced: Reduced) -> Accuracy:
        """The errors of a reduced structure."""
        mass, stiffness = reduced.arrays["M"], reduced.arrays["K"]
        contacts = self._whole.contacts @ reduced.motions
        forces = reduced.motions.T @ self._whole.forces
        own = _own_frequencies(mass, stiffness, contacts)
        high = (1.0 + _NEAR) * self._range[1]  # a resonance just beyond the range is felt in it
        if not self._frequencies or max(map(len, self._frequencies)) >= self._limit:
            self._limit = mass.shape[0] + 1  # one too many suffices to show that some are missing
            self._frequencies = tuple(
                self._whole.frequencies(bool(k), high, int((one <= high).sum()), self._limit)
                for k, one in enumerate(own)
            )
            self._samples = [(at, self._whole.compliances(at)) for at in self._places()]

        def compliances(omega: float) -> np.ndarray:
            return forces.T @ np.linalg.solve(stiffness - omega * omega * mass, forces)

        frequencies = max(_difference(w, one) for w, one in zip(self._frequencies, own, strict=True))
        pulls = np.linalg.lstsq(forces, contacts.T, rcond=None)[0]
        pairs = ((compliances(omega), true) for omega, true in self._samples)
        inverse_masses = np.einsum("kn,nk->k", contacts, np.linalg.solve(mass, contacts.T))
        return Accuracy(
            frequencies,
            largest_error(pairs, self._whole.units, pulls),
            float(np.max(self._whole.inverse_masses / inverse_masses)),
            len(contacts),
        )

    def _places(self) -> np.ndarray:
        """Frequencies at which compliances are compared."""
        low, high = self._range
        poles = np.unique(np.concatenate(self._frequencies))
        between = 0.5 * (poles[1:] + poles[:-1])
        places = np.unique(np.concatenate((between[between >= low], np.linspace(low, high, _EVEN))))
        if poles.size:
            distance = np.abs(places[:, np.newaxis] - poles).min(axis=1) / np.maximum(places, poles[0])
            far = distance > _NEAR
            if not far.any():  # a range so narrow: where it is furthest off, if it is off
                far = (distance == distance.max()) & (distance > 0.0)
            places = places[far]
        return places[:: max(1, -(-places.size // _SAMPLES))]


def largest_error(
    pairs: Iterable[tuple[np.ndarray, np.ndarray]], units: np.ndarray, pulls: np.ndarray
) -> float:
    """Largest relative difference of compliances (k, k), found and true, free and with the contacts held.

    units : (k,) roots of the static compliances; pulls : (k, N) each contact's force as a sum of the forces
    """
    scale = np.outer(units, units)
    worst = 0.0
    for found, true in pairs:
        free, held = found / scale, _with_held(found, pulls) / scale
        true_free, true_held = true / scale, _with_held(true, pulls) / scale
        # either may vanish at an antiresonance
        size = max(np.linalg.norm(true_free), np.linalg.norm(true_held))
        off = max(np.linalg.norm(free - true_free), np.linalg.norm(held - true_held))
        worst = max(worst, float(off / size))
    return worst


def _with_held(compliances: np.ndarray, pulls: np.ndarray) -> np.ndarray:
    """Compliances with the contacts held by the forces that leave them no motion; zero if all do that."""
    across = compliances @ pulls
    left = compliances - across @ np.linalg.solve(pulls.T @ across, across.T)
    nothing = np.linalg.norm(left) <= 1e-9 * np.linalg.norm(compliances)
    return compliances if nothing else left


def _own_frequencies(
    mass: np.ndarray, stiffness: np.ndarray, contacts: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Natural frequencies of reduced matrices, free and held."""
    from scipy.linalg import eigh

    basis = np.linalg.svd(contacts)[2][len(contacts) :].T  # motions that leave the contacts alone
    found = [eigh(stiffness, mass, eigvals_only=True)]
    if basis.size:
        found.append(eigh(basis.T @ stiffness @ basis, basis.T @ mass @ basis, eigvals_only=True))
    else:
        found.append(np.empty(0))
    free, held = (np.sqrt(np.maximum(one, 0.0)) for one in found)
    return free, held


def _difference(true: np.ndarray, found: np.ndarray) -> float:
    """Largest relative difference, one by one; infinite if some are missing."""
    if found.size < true.size:
        return np.inf
    return float(np.max(np.abs(found[: true.size] / true - 1.0), initial=0.0))
