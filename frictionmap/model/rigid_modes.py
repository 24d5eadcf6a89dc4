"""Rigid-body modes of structures that no spring holds at a place: blocks, vehicles, shafts."""

from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np

from ..errors import InputError
from .general import ContactSystem
from .modes import ZERO_PRODUCT, ModalModel

_EPS = float(np.finfo(float).eps)

#: A negative eigenvalue of K is zero if it is this small beside the largest: text files of finite-element
#: programs hold eight to ten digits, and the digits left out make zero eigenvalues of either sign.  Positive
#: ones count as zero up to the size of the most negative one, or rounding: a larger one is a soft spring.
_DIGITS = 1e-8

#: Part of a direction that contacts or dashpots act on, over the largest, that is rounding error.
_UNTOUCHED = 1e-10


def count_rigid(stiffness: np.ndarray) -> int:
    """Number of rigid-body modes: of zero eigenvalues of K, see `_DIGITS`.

    Raises
    ------
    InputError
        K has a negative eigenvalue that is not zero.
    """
    values = np.linalg.eigvalsh(stiffness)
    largest = float(np.abs(values).max())
    rounding = len(values) * _EPS * largest
    if values[0] < -max(_DIGITS * largest, rounding):
        raise InputError(
            "matrices",
            f": K must be positive semi-definite; got an indefinite matrix, with eigenvalues from "
            f"{values[0]:.3g} to {values[-1]:.3g}",
        )
    return int((values <= max(rounding, -values[0])).sum())


def without_rigid(mass: np.ndarray, stiffness: np.ndarray, phi: np.ndarray) -> np.ndarray:
    """K without what its rounding errors hold against the rigid-body modes phi (n, k); exact zeros stay."""
    left = stiffness @ phi
    if np.abs(left).max() <= ZERO_PRODUCT * len(mass) * _EPS * np.abs(stiffness).max() * np.abs(phi).max():
        return stiffness
    shares = np.eye(len(mass)) - mass @ phi @ phi.T
    clean = shares @ stiffness @ shares.T
    return 0.5 * (clean + clean.T)


def sort_rigid(phi: np.ndarray, vectors: np.ndarray, damping: np.ndarray) -> np.ndarray:
    """Rotate rigid-body modes phi (n, k) so that contacts and dashpots act on as few of them as possible.

    Of the last ones, nothing but the load acts on each; any basis of rigid-body modes is valid.

    vectors : (N, n) of the contacts
    """
    if phi.shape[1] == 1:
        return phi
    parts = [vectors @ phi]
    if damping.any():
        parts.append(damping @ phi / np.abs(damping).max())
    return phi @ np.linalg.svd(np.vstack(parts))[2].T


def _cleaned(product: np.ndarray, bound: np.ndarray) -> np.ndarray:
    """A product whose entries below the rounding errors of terms of the size `bound` are zero."""
    return np.where(np.abs(product) <= ZERO_PRODUCT * len(product) * _EPS * bound, 0.0, product)


@dataclass(frozen=True)
class FreeModel(ModalModel):
    """A structure with rigid-body modes, which come first: w and zeta of these are 0."""

    modal: np.ndarray = field(default_factory=lambda: np.zeros((0, 0)))  # (n, n) C in modal coordinates

    def damping_in_modes(self) -> np.ndarray:
        """As in `ModalModel`; a rigid-body mode has a rate of damping, but no damping ratio."""
        return self.modal


def free_model(
    w: np.ndarray, phi: np.ndarray, damping: np.ndarray, rate: np.ndarray, parts: dict
) -> FreeModel:  # fmt: skip
    """Build the model of a structure whose first modes have w = 0.

    Parameters
    ----------
    w, phi : (n,), (n, n)
    damping : (n, n) C1
    rate : see `ModalModel`
    parts : the other fields
    """
    bound = np.abs(phi).T @ np.abs(damping) @ np.abs(phi)
    modal = _cleaned(phi.T @ damping @ phi, bound)
    elastic = w > 0.0
    zeta = np.where(elastic, np.diag(modal) / np.where(elastic, 2.0 * w, 1.0), 0.0)
    return FreeModel(w, phi, zeta, load_rate=rate, damping=damping, modal=modal, **parts)


class Free(Protocol):
    """What is checked of a system with rigid-body modes."""

    @property
    def rigid_modes(self) -> int: ...

    @property
    def excitation(self) -> Any: ...

    @property
    def damping_reference(self) -> str: ...

    @property
    def contact_system(self) -> ContactSystem: ...


def is_carried(system: Free, modes: ModalModel) -> np.ndarray:
    """Whether a rigid-body mode moves each contact, (N,) bool: nothing brings it back to a place."""
    vectors, rigid = system.contact_system.vectors, modes.phi[:, : system.rigid_modes]
    size = np.abs(vectors) @ np.abs(rigid)
    return (np.abs(vectors @ rigid) > ZERO_PRODUCT * len(modes.w) * _EPS * size).any(axis=1)


def check_free(system: Free, modes: ModalModel) -> None:
    """Refuse what has no steady state, or none that is computed, in a structure with rigid-body modes."""
    general, count = system.contact_system, system.rigid_modes
    what = f"the structure is free: it has {count} rigid-body mode{'s' * (count > 1)}"
    rigid = modes.phi[:, :count]
    pushed = np.abs(rigid.T @ general.offset)
    if (pushed > ZERO_PRODUCT * len(modes.w) * _EPS * (np.abs(rigid).T @ np.abs(general.offset))).any():
        raise InputError(
            "load_offset",
            f"must cancel along rigid-body modes, which nothing but friction would hold ({what}; springs to "
            f"the ground would); got {general.offset.tolist()}",
        )
    moved = any(group.base for group in general.groups)
    rounding = ZERO_PRODUCT * len(modes.w) * _EPS * np.abs(modes.stiffness).sum(axis=1)
    pulled = (np.abs(modes.stiffness.sum(axis=1)) > rounding).any()
    pulled = pulled or (system.damping_reference == "base" and modes.damping.any())
    if system.excitation == "base" and not (moved or pulled):
        raise InputError(
            "excitation",
            f"must be force where neither spring nor contact ends at the base ({what}); got 'base'; use "
            f"joined-base-wall for friction on the base",
        )
    belts = np.array([bool(group.first.belt) for group in general.groups])
    if (belts & is_carried(system, modes)).any():
        worst = next(group.first.belt for group in general.groups if group.first.belt)
        raise InputError(
            "wall_velocity",
            f"must be 0 at a contact that takes the structure along, where the wall seen from the belt is at "
            f"rest ({what}); got {worst:g}",
        )
