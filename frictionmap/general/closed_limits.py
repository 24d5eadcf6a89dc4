"""Friction without stops in closed form: one rigid contact under one harmonic load (theory.md 3)."""

from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from .. import regimes
from ..model.general import KEYS
from ..model.system import System
from ..theory.boundary_curves import find_curves, over_square
from .problem import general_of


class ClosedLimits(NamedTuple):
    """What ends the first interval of friction without stops, (n_mu, n_r)."""

    beta: np.ndarray
    kind: np.ndarray  # codes `regimes.LIMIT_KINDS`


def has_closed_limits(system: System) -> bool:
    """Whether a system is one rigid contact under one harmonic load, with friction in proportion to beta."""
    general = general_of(system)
    if general.shaken_points is not None:  # the modes are relative to the base, and the formulas are not
        return False
    if general.free or general.count > 1 or general.elastic.any() or len(general.orders) > 1:
        return False
    contact = general.groups[0]
    return (
        contact.first.law is None
        and not contact.first.belt
        and not contact.first.nu
        and contact.friction(0.0, 1.0)[0] == 0.0
    )


def _plain(system: System) -> tuple[System, float]:
    """The same system in the form with one contact, and the size of its base motion over that of the form."""
    general = general_of(system)
    (order,) = general.orders
    contact = general.groups[0].first
    changed: dict[str, Any] = {name: None for name in (*KEYS, "harmonics")}
    changed |= {
        "wall_velocity": 0.0,
        "wall_speed": 0.0,
        "contact": contact.kind,
        "contact_masses": contact.masses,
    }
    if general.base:
        return replace(system, **changed), abs(general.base[order])
    load = tuple(general.loads[order].tolist())
    return replace(system, **changed, load=load, load_mass=None), 1.0


def closed_limits(system: System, r: np.ndarray, mu: np.ndarray) -> ClosedLimits:
    """Find the first limits of a system for which `has_closed_limits` holds; NaN at r = 0.

    The n-th harmonic at r is the first one at n r.
    """
    general = general_of(system)
    plain, size = _plain(system)
    at = general.orders[0] * r
    kinetic = general.groups[0].friction(1.0, 1.0)[0]
    static = np.array([general.groups[0].friction(1.0, float(value))[1] for value in mu])
    found = find_curves(plain, at, static / kinetic)
    turns = found.h + (static / kinetic)[:, np.newaxis] * over_square(plain.modes.inverse_mass, at)
    kind = np.where(found.s > turns, regimes.INSIDE, regimes.TURN)
    beta = np.where(r > 0.0, size / kinetic * found.beta_lim, np.nan)
    return ClosedLimits(beta, kind.astype(np.int8))
