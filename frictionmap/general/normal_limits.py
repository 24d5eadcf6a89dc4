"""Boundaries of a system with contacts whose normal force moves with the structure, in closed form.

They hold for any friction at preload, because the phasors of the held structure do not depend on it.
"""

from dataclasses import replace

import numpy as np
import xarray as xr

from .. import regimes
from ..datasets.labels import LABELS
from ..datasets.variables import coordinate, label_variable
from ..errors import InputError
from ..model.general import MergedContact, contacts_of
from ..model.normal_contact import MovingNormal
from ..model.system import System
from .normal_force import NormalSpring, Structure, locks_itself, sliding_limit
from .normal_resting import is_known, resting_friction
from .problem import general_of

#: Kinds of `friction_lim` by what `normal_force.Limit` names them.
_KINDS = {"": regimes.NO_LIMIT, "flutter": regimes.FLUTTER, "divergence": regimes.DIVERGENCE}


def _parts(system: System) -> tuple[Structure, MergedContact, MovingNormal, NormalSpring] | None:
    """The structure and its contact; None where these closed forms do not hold.

    They are for one contact, with a wall that does not move with the base, and without other springs.
    """
    general = general_of(system)
    group = general.groups[0]
    if general.count > 1 or general.springs or group.normal is None or group.base:
        return None
    modes, normal = system.modes, group.normal
    structure = Structure(modes.mass, modes.damping, modes.stiffness)
    return structure, group, normal, NormalSpring(group.vector, normal.direction, normal.stiffness)


def no_slip_friction(system: System, r: np.ndarray, mu: np.ndarray) -> np.ndarray:
    """Friction ratio from which the contacts can rest permanently, (n_mu, n_r); 0 if one locks itself, NaN
    where no closed form holds.

    Of one contact with a given preload it is the friction at preload, phi N0.
    Contacts on a belt cannot rest.
    """
    general = general_of(system)
    if not is_known(system) or any(group.first.belt for group in general.groups):
        return np.full((mu.size, r.size), np.nan)
    if general.count == 1 and general.groups[0].first.has_preload:
        system = _without_preload(system)
    return np.stack([resting_friction(system, r, float(one)) for one in mu])


def _without_preload(system: System) -> System:
    """A system of one contact whose friction at preload is beta."""
    (contact,) = contacts_of(system)
    normal = replace(contact.normal, preload=None)
    return replace(system, contacts=[replace(contact, normal=normal)])


def _resting_variable(system: System, r: np.ndarray, mu: np.ndarray) -> dict[str, xr.Variable]:
    """The boundary to contacts at rest permanently: beta_noslip if one is elastic, else beta_stick."""
    found = no_slip_friction(system, r, mu)
    if np.isnan(found).any():
        return {}
    if general_of(system).elastic.any():
        return {"beta_noslip": label_variable("beta_noslip", found[0])}
    return {"beta_stick": label_variable("beta_stick", found)}


def _contact_variables(system: System, mu: np.ndarray) -> dict[str, xr.Variable]:
    """Whether the contact locks itself, and on a belt the friction from which steady sliding is unstable."""
    parts = _parts(system)
    if parts is None:
        return {}
    structure, group, normal, contact = parts
    locks = [locks_itself(structure, contact, normal.friction * group.first.static_ratio(one)) for one in mu]
    found: dict[str, np.ndarray] = {"self_locking": np.array(locks, dtype=LABELS["self_locking"].dtype)}
    if group.first.belt:
        limit = sliding_limit(structure, contact, -1 if group.first.belt > 0.0 else 1)
        found["friction_lim"] = np.array(limit.phi)
        found["friction_lim_kind"] = np.array(_KINDS[limit.kind], dtype=np.int8)
    return {name: label_variable(name, values) for name, values in found.items()}


def limit_variables(system: System, r: np.ndarray, mu: np.ndarray) -> dict[str, xr.Variable]:
    """The boundaries that a system has, labelled."""
    return _resting_variable(system, r, mu) | _contact_variables(system, mu)


def normal_boundaries(system: System, r: np.ndarray, mu: np.ndarray) -> xr.Dataset:
    """Boundaries of a system with contacts whose normal force moves with the structure.

    Raises
    ------
    InputError
        There is no closed form for the system.
    """
    if _parts(system) is None and not is_known(system):
        raise InputError(
            "cannot compute boundaries of contacts that open or of piecewise linear springs: closed forms "
            "are for contacts with friction and without such springs; use map"
        )
    axes = {"mu": mu, "r": r, "dof": np.array(system.dofs.numbers)}
    coords = {name: coordinate(name, axis) for name, axis in axes.items()}
    return xr.Dataset(limit_variables(system, r, mu), coords=coords)
