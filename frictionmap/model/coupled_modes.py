"""A structure whose damping couples its undamped modes: participating modes, and responses to loads."""

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from .free_structure import FreeStructure, coupled_structure, modal_structure
from .modes import ZERO_PRODUCT, ModalModel, load_rate, solve_held, times, weighted_sum

#: Responses above this many times the load over the stiffness are checked for an undamped resonance, where
#: only rounding error keeps them finite.
_SUSPECT = 1e8

#: Least length of the part of a unit direction outside a span for it to count as independent: far above
#: rounding error.
_NEW = 1e-8


def _groups(w: np.ndarray) -> list[np.ndarray]:
    """Group the modes of equal frequency, by frequency."""
    return np.split(np.arange(w.size), np.flatnonzero(np.diff(w)) + 1)


def _unit(direction: np.ndarray, least: float) -> np.ndarray:
    """Normalise a direction (k,) to a column of length 1; no column if its length is not above `least`."""
    size = np.linalg.norm(direction)
    return direction[:, np.newaxis] / size if size > least else np.zeros((direction.size, 0))


def _reached_directions(
    product: np.ndarray, group: np.ndarray, found: np.ndarray, least: float
) -> np.ndarray:
    """Orthonormal columns: directions of a group that the directions (n, l) excite through the damping."""
    left, sizes, _ = np.linalg.svd(product[group] @ found, full_matrices=False)
    return left[:, sizes > least]


def _new_directions(part: np.ndarray, found: np.ndarray) -> np.ndarray:
    """Orthonormal columns of the part of `part` outside the span of `found`, both orthonormal."""
    left, sizes, _ = np.linalg.svd(part - found @ (found.T @ part), full_matrices=False)
    return left[:, sizes > _NEW]


def sort_participating(
    w: np.ndarray, phi: np.ndarray, damping: np.ndarray, contact: np.ndarray, rounding: float
) -> tuple[np.ndarray, np.ndarray]:
    """Rotate modes of equal frequency, and find those that friction excites, directly or through the damping.

    The participating directions are the smallest set that contains the contact's direction and is invariant
    under stiffness and damping.  At each frequency the modes are rotated so that they are either in this set
    or orthogonal to it, and so that either part is diagonal in the damping.

    Returns
    -------
    phi : (n, n)
    participating : (n,) bool; no coupling exists between these modes and the others
    """
    product, chi, groups = phi.T @ damping @ phi, contact @ phi, _groups(w)
    least = rounding * float(np.diag(product).max(initial=0.0))
    found = [np.zeros((group.size, 0)) for group in groups]
    new = [_unit(chi[group], rounding * float(np.linalg.norm(chi))) for group in groups]
    while any(part.size for part in new):
        reached = np.zeros((w.size, sum(part.shape[1] for part in new)))
        column = 0
        for k, (group, part) in enumerate(zip(groups, new, strict=True)):
            found[k] = np.column_stack((found[k], part))
            reached[group, column : column + part.shape[1]] = part
            column += part.shape[1]
        for k, group in enumerate(groups):
            whole = found[k].shape[1] == group.size
            part = _reached_directions(product, group, reached[:, : 0 if whole else None], least)
            new[k] = _new_directions(part, found[k])
    turned, coupled_to_contact = phi.copy(), np.zeros(w.size, dtype=bool)
    for group, part in zip(groups, found, strict=True):
        coupled_to_contact[group[: part.shape[1]]] = True
        if group.size > 1:
            turned[:, group] = phi[:, group] @ _damped_apart(part, product[np.ix_(group, group)])
    return turned, coupled_to_contact


def _damped_apart(part: np.ndarray, damping: np.ndarray) -> np.ndarray:
    """Orthogonal matrix of columns in the span of `part`, then of the others, each part diagonal in the
    damping.
    """
    whole = np.linalg.svd(part, full_matrices=True)[0] if part.shape[1] else np.eye(len(part))
    columns = [whole[:, : part.shape[1]], whole[:, part.shape[1] :]]
    return np.column_stack([c @ np.linalg.eigh(c.T @ damping @ c)[1] if c.shape[1] else c for c in columns])


@dataclass(frozen=True)
class CoupledModel(ModalModel):
    """A structure in its undamped modes, which its damping couples.

    Attributes
    ----------
    zeta : (n,) damping ratio of each single mode, phi^T C1 phi = 2 zeta w on the diagonal
    coupling : (n, n) phi^T C1 phi off the diagonal; exactly 0 between modes that are not coupled
    coupled_to_contact : (n,) bool, modes that friction excites, directly or through other modes
    """

    coupling: np.ndarray = field(default_factory=lambda: np.zeros((0, 0)))
    coupled_to_contact: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=bool))

    @property
    def coupled_modes(self) -> np.ndarray:
        """As in `ModalModel`."""
        return np.any(self.coupling != 0.0, axis=1)

    @property
    def participating(self) -> np.ndarray:
        """Participating modes, which friction in the contact excites, bool (n,)."""
        return self.coupled_to_contact

    def participating_coupling(self) -> np.ndarray:
        """Coupling of the participating modes by the damping."""
        return self.coupling[np.ix_(self.participating, self.participating)]

    @cached_property
    def free(self) -> FreeStructure:
        """The participating modes as oscillators."""
        which = self.participating
        coupling = self.participating_coupling()
        if not coupling.any():
            return modal_structure(self.w[which], self.zeta[which], self.chi[which])
        return coupled_structure(self.w[which], self.zeta[which], coupling, self.chi[which])

    def _dynamic(self, r: float) -> np.ndarray:
        """Dynamic stiffness between the modes at one frequency, complex (n, n)."""
        return np.diag(self.dynamic_stiffness(np.array([r]))[0]) + 1j * r * self.coupling

    def modal_responses(self, r: np.ndarray, loads: np.ndarray) -> np.ndarray:
        """Modal coordinates under modal loads, complex (n_r, n); infinite as in `ModalModel`."""
        found = np.empty((r.size, self.w.size), dtype=complex)
        for k, at in enumerate(r):
            stiffness, load = self._dynamic(at), loads[k].copy()
            resonant = ~stiffness.any(axis=1)  # undamped, and so coupled to none
            stiffness[resonant, resonant] = 1.0
            load[resonant] = np.where(load[resonant] != 0.0, np.inf, 0.0)
            found[k, ~resonant] = np.linalg.solve(stiffness, np.where(resonant, 0.0, load))[~resonant]
            found[k, resonant] = load[resonant]
        return found

    def damping_form(self, q: np.ndarray) -> np.ndarray:
        """As in `ModalModel`."""
        across = times(q, self.coupling)
        return super().damping_form(q) + (q.real * across.real + q.imag * across.imag).sum(axis=1)

    def response(self, r: np.ndarray, weights: np.ndarray) -> np.ndarray:
        """As in `ModalModel`."""
        r = np.asarray(r, dtype=float)
        return weighted_sum(self.modal_responses(r, self.participation(r)), weights)

    def mass_responses(self, r: np.ndarray) -> np.ndarray:
        """As in `ModalModel`."""
        r = np.asarray(r, dtype=float)
        q = self.modal_responses(r, self.participation(r))
        return np.column_stack([weighted_sum(q, row) for row in self.phi])

    def contact_response(self, r: np.ndarray) -> np.ndarray:
        """As in `ModalModel`."""
        r = np.asarray(r, dtype=float)
        return weighted_sum(self.modal_responses(r, self.relative_participation(r)), self.chi)

    def held(self, r: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """As in `ModalModel`; modes that do not participate respond as if free."""
        r = np.asarray(r, dtype=float)
        which, parts = self.participating, self.relative_participation(r)
        q = self.modal_responses(r, np.where(which, 0.0, parts))
        force = np.empty(r.size, dtype=complex)
        for k in range(r.size):
            q[k, which], force[k] = self._held_at(float(r[k]), parts[k, which])
        motion = times(np.where(np.isinf(q), 0.0, q), self.phi.T)
        motion[np.isinf(q).any(axis=1)] = np.inf
        return motion, force

    def _held_at(self, r: float, load: np.ndarray) -> tuple[np.ndarray, complex]:
        """Participating modes, and the force that holds the contact, at one frequency."""
        which, n = self.participating, load.size
        bordered = np.zeros((n + 1, n + 1), dtype=complex)
        bordered[:n, :n] = self._dynamic(r)[np.ix_(which, which)]
        bordered[:n, n] = bordered[n, :n] = self.chi[which]
        right = np.append(load, 0.0)
        with np.errstate(all="ignore"):
            try:
                solution = np.linalg.solve(bordered, right)
            except np.linalg.LinAlgError:
                solution = np.full(n + 1, np.inf)
        # at an undamped resonance of the held structure only rounding error keeps the solution finite
        small = np.abs(bordered).max() * np.abs(solution).max() <= _SUSPECT * np.abs(right).max()
        if not small:
            w, coupling = self.w[which], self.participating_coupling()
            damping = np.diag(2.0 * self.zeta[which] * w) + coupling
            solution = solve_held(
                np.eye(n), np.diag(w**2), damping, self.chi[which], np.array([r]), load[np.newaxis]
            )[0]
        return solution[:n], complex(solution[n])


def coupled_model(
    w: np.ndarray, phi: np.ndarray, damping: np.ndarray, to_base: bool, parts: dict[str, Any]
) -> CoupledModel:
    """Build the model of a structure with any damping matrix C1; `parts` are further fields of the model."""
    rounding = ZERO_PRODUCT * w.size * float(np.finfo(float).eps)
    phi, coupled_to_contact = sort_participating(w, phi, damping, parts["contact"], rounding)
    product = phi.T @ damping @ phi
    rates = np.diag(product)
    small = np.abs(product) <= rounding * rates.max()
    product[small | (coupled_to_contact[:, np.newaxis] != coupled_to_contact)] = 0.0
    return CoupledModel(
        w,
        phi,
        np.diag(product) / (2.0 * w),
        load_rate=load_rate(damping, to_base),
        damping=damping,
        coupling=product - np.diag(np.diag(product)),
        coupled_to_contact=coupled_to_contact,
        **parts,
    )
