"""Points of a structure given by modes: what moves them, and the flexibility of modes that are left out.

    x = Phi q + R p - R c^T f,    z = c x

R is the residual flexibility: all that the modes left out add at frequencies far below theirs.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from ..errors import InputError

#: Least eigenvalue of the flexibility of the contacts over the largest: below, rounding errors of the modes
#: and of the residual decide about forces.
_LEAST = 1e-6

#: Flexibility between contacts, over that of the contacts themselves, that is rounding error.
_APART = 1e-12

#: Part of the modes, the highest ones, of which the share in the flexibility of a contact is looked at.
_HIGHEST = 3
_MOST_SHARE = 0.01


@dataclass(frozen=True, eq=False)
class Points:
    """Points with contacts, loads or outputs, dimensionless; p points, m modes, N contacts."""

    shapes: np.ndarray  # (p, m) Phi, of unit modal mass
    vectors: np.ndarray  # (N, p) c
    loads: Mapping[int, np.ndarray]  # phasors (p,) of the loads, by order
    offset: np.ndarray  # (p,) constant loads
    residual: np.ndarray | None  # (p, p) R
    participation: np.ndarray | None = None  # (m,) loads on the modes by a unit acceleration of the base
    influence: np.ndarray | None = None  # (p,) displacements by a unit one of the base; None: 1
    base_residual: np.ndarray | None = None  # (p,) displacements by that load which the modes leave out

    @property
    def carried(self) -> np.ndarray:
        """Displacements of the points by a unit displacement of the base, as of a rigid body, (p,)."""
        return np.ones(len(self.shapes)) if self.influence is None else self.influence

    @property
    def sag(self) -> np.ndarray:
        """Displacements of the points by that acceleration beside those of the modes, (p,).

        Raises
        ------
        InputError
            A residual flexibility is given without them.
        """
        if self.residual is None:
            return np.zeros(len(self.shapes))
        if self.base_residual is None:
            raise InputError(
                "cannot use",
                "residual",
                "under a motion of the base without base_residual: this load displaces points beside the "
                "modes; give base_residual, or omit residual",
            )
        return self.base_residual

    @property
    def of_contacts(self) -> np.ndarray:
        """R c^T: displacements of the points by unit forces in the contacts beside those by modes, (p, N)."""
        if self.residual is None:
            return np.zeros(self.vectors.shape[::-1])
        return np.asarray(self.residual @ self.vectors.T)

    @property
    def own(self) -> np.ndarray:
        """R_cc: the part of the flexibility of each contact that the modes leave out, (N,)."""
        return np.einsum("jp,pj->j", self.vectors, self.of_contacts)

    def flexibility(self, stiffness: np.ndarray) -> np.ndarray:
        """F = Kt^-1 + R_cc (N, N), of contacts with these stiffnesses (N,)."""
        return np.asarray(self.vectors @ self.of_contacts + np.diag(1.0 / stiffness))

    def couples(self, stiffness: np.ndarray) -> bool:
        """Whether a force in a contact displaces another one beside the modes."""
        if self.residual is None:
            return False
        whole = self.flexibility(stiffness)
        between = np.abs(whole - np.diag(np.diag(whole)))
        return bool(between.max(initial=0.0) > _APART * np.diag(whole).max())

    @property
    def loaded(self) -> list[int]:
        """Points under load, by row."""
        return np.flatnonzero(np.any([np.abs(load) for load in self.loads.values()], axis=0)).tolist()

    def pushed(self, order: int) -> np.ndarray:
        """R p: displacements of the points by a harmonic of the load beside those by modes, (p,)."""
        load = self.loads.get(order, np.zeros(len(self.shapes)))
        return np.zeros_like(load) if self.residual is None else self.residual @ load

    def shaken(self, turn: np.ndarray) -> np.ndarray:
        """Displacements (n_r, p) beside those by modes as the base moves by cos(n tau); turn = n r (n_r,)."""
        return np.asarray(self.carried + np.outer(turn**2, self.sag))

    def static(self, w: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Displacements in the contacts (N,) and of the points (p,) under the constant loads; w (m,)."""
        elastic = w > 0.0  # the place along rigid-body modes is arbitrary
        parts = self.shapes[:, elastic] / w[elastic]
        x = parts @ (parts.T @ self.offset)
        if self.residual is not None:
            x = x + self.residual @ self.offset
        return self.vectors @ x, x

    def displacements(self, beside: np.ndarray, modes: np.ndarray, forces: np.ndarray) -> np.ndarray:
        """Displacements (n_r, p) by a harmonic of modes (n_r, m) and of forces in contacts (n_r, N).

        beside : (p,) or (n_r, p) those that the load and the base add
        """
        with np.errstate(invalid="ignore"):  # an infinite one
            found = modes @ self.shapes.T + beside
            if self.residual is not None:
                found = found - forces @ self.of_contacts.T
        return np.asarray(found)


class Group(Protocol):
    """What is checked of a contact."""

    @property
    def stiffness(self) -> float | None: ...
    @property
    def name(self) -> str: ...


def check_residual(points: Points, groups: tuple[Group, ...]) -> None:
    """Refuse a residual flexibility with contacts for which it makes no model, or none that is computed."""
    if points.residual is None:
        return
    remedy = "give contact stiffnesses, or leave the residual out"
    rigid = [group.name for group in groups if group.stiffness is None]
    if rigid:
        raise InputError(
            "cannot use",
            "residual",
            f"with the rigid contact {rigid[0]}: it would be a spring in the contact that the structure has "
            f"not; {remedy}",
        )
    whole = points.flexibility(np.array([group.stiffness for group in groups]))
    values = np.linalg.eigvalsh(whole)
    if values[0] <= _LEAST * values[-1]:
        raise InputError(
            "residual",
            f"must leave the contacts a positive flexibility, with eigenvalues above {_LEAST:g} of the "
            f"largest; got {values[0]:.3g} of {values[-1]:.3g}",
        )


def missing_flexibility(points: Points, squares: np.ndarray, groups: tuple[Group, ...]) -> str:
    """Warn of elastic contacts whose flexibility the highest modes still change; empty if none does.

    squares : (m,) w^2 of the modes
    """
    if points.residual is not None:
        return ""
    chi = points.vectors @ points.shapes
    last = chi[:, len(squares) - len(squares) // _HIGHEST :]
    high = squares[len(squares) - len(squares) // _HIGHEST :]
    for group, row in zip(groups, last, strict=True):
        if group.stiffness is not None:
            share = group.stiffness * float((row**2 / high).sum())
            if share > _MOST_SHARE:
                return (
                    f"the highest third of the modes has {share:.1%} of the flexibility of {group.name}: "
                    f"give a residual flexibility, or more modes"
                )
    return ""
