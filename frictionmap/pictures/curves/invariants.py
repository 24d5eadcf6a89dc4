"""Points of response curves that friction does not change, and resonances that it makes finite."""

from typing import NamedTuple

import numpy as np

from ... import features
from ...model.system import System
from ...theory.boundary_curves import find_curves
from .families import Family


class Invariant(NamedTuple):
    """Points of one motion, and their label in the legend."""

    label: str
    places: np.ndarray  # frequencies and amplitudes, (n, 2)


def _is_contact(system: System, dof: int) -> bool:
    """Whether a mass moves with the contact."""
    return system.contact == "fixed-wall" and tuple(system.contact_masses) == (dof,)


def _frequencies(system: System, quantity: str, dof: int | None, low: float, high: float) -> np.ndarray:
    """Invariant points of a mass, or of the motion in the contact (None)."""
    if quantity == "first_harmonic":
        return features.first_harmonic_points(system, low, high)[
            -1 if dof is None else system.dofs.row(dof)
        ].all
    if dof is None:
        return features.invariant_points(system, low, high)
    return features.mass_invariant_points(system, dof, low, high)


def _seen(system: System, r: np.ndarray, beta: np.ndarray) -> np.ndarray:
    """The frequencies at which some motion with friction is continuous."""
    rubs = beta[beta > 0.0]
    if not r.size or not rubs.size:
        return r[:0]
    return r[find_curves(system, r, np.ones(1)).beta_lim[0] > rubs.min()]


def invariant_points(family: Family, quantity: str, dof: int | None) -> Invariant:
    """Invariant points of one mass, or of the motion in the contact (None).

    There are none where the file does not contain its system, with damping, or with loads that are not in
    phase.
    """
    system = family.system
    low, high = family.r.limits
    if system is None or system.modes.zeta.any() or not features.one_phase(system):
        return Invariant("", np.empty((0, 2)))
    modes = system.modes
    found = _frequencies(system, quantity, dof, max(low, 1e-3 * high), high)
    r = _seen(system, found, family.beta)
    free = modes.contact_response(r) if dof is None else modes.response(r, modes.phi[dof - 1])
    exact = quantity == "first_harmonic" or dof is None or _is_contact(system, dof)
    label = "invariant point" if exact else "invariant point (monoharmonic)"
    return Invariant(label, np.column_stack((r, np.abs(free))))


def infinite_resonances(family: Family) -> list[tuple[float, float]]:
    """Natural frequencies within the axis where some line is infinite, and the least beta of a finite one.

    Only undamped resonances are infinite, below (pi/4)|lambda_i/chi_i|, T(6.2).
    """
    system = family.system
    if system is None:
        return []
    low, high = family.r.limits
    w, least = system.modes.w, features.peak_thresholds(system)
    fed = np.abs(np.diagonal(system.modes.participation(w))) > 0.0
    infinite = (system.modes.zeta == 0.0) & fed & (w >= low) & (w <= high) & (least > family.beta.min())
    return [(float(r), float(beta)) for r, beta in zip(w[infinite], least[infinite], strict=True)]
