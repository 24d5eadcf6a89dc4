"""Boundaries of the regimes over frequency, with response functions and features, as datasets."""

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from .. import checks
from ..datasets.labels import BOUNDARIES, LABELS
from ..datasets.physical import with_units
from ..datasets.variables import coordinate, label_variable, stamp
from ..features import (
    all_mass_invariant_points,
    first_harmonic_points,
    high_frequency_limits,
    invariant_points,
    one_phase,
    peak_thresholds,
)
from ..model.modes import wrapped
from ..model.system import System
from ..units.axes import KINDS, ratios
from ..units.scales import Units, scales_of
from .boundary_curves import Curves, find_curves
from .refinement import boundary_check

#: Number of invariant points listed in addition to one per mode, from the highest down; below them hardly any
#: motion is continuous.  Points of masses are listed for up to `_LISTED_MASSES` masses, because their cost
#: grows with the square of that number.
_LISTED_POINTS = 40
_LISTED_MASSES = 12

#: A point at an end of the axis may be found slightly outside it: the search range is extended by `_REACH`,
#: and points within `_ON_END` of the axis are kept.
_REACH = 1e-6
_ON_END = 1e-13


def boundary_variables(found: Curves) -> dict[str, xr.Variable]:
    """Label beta_lim, beta_lim_modal and beta_stick, dims (mu, r)."""
    return {name: label_variable(name, getattr(found, name)) for name in BOUNDARIES}


def _padded(rows: list[np.ndarray]) -> np.ndarray:
    """Combine rows of different lengths into one array, padded with NaN."""
    table = np.full((len(rows), max(row.size for row in rows)), np.nan)
    for row, values in zip(table, rows, strict=True):
        row[: values.size] = values
    return table


def _invariants(system: System, r: np.ndarray) -> dict[str, np.ndarray]:
    """Find the invariant points within the axis; empty variables are omitted, as NetCDF requires."""
    positive = r[r > 0.0]
    if positive.size < 2:
        return {}
    first = positive[0]
    low, high = first * (1.0 - _ON_END), r[-1] * (1.0 + _ON_END)
    end = min(r[-1] * (1.0 + _REACH), checks.LARGEST_RATIO)
    reach = first * (1.0 - _REACH), end, _LISTED_POINTS + system.n
    lists = {"invariant_point": [invariant_points(system, *reach)]}
    if system.n <= _LISTED_MASSES and one_phase(system) and not system.modes.zeta.any():
        lists["mass_invariant_point"] = all_mass_invariant_points(system, *reach)
        *masses, contact = (points.all for points in first_harmonic_points(system, *reach))
        lists |= {"invariant_first_harmonic": masses, "contact_invariant_first_harmonic": [contact]}
    found = {}
    for name, rows in lists.items():
        inside = [row[(row >= low) & (row <= high)] for row in rows]
        if any(row.size for row in inside):
            found[name] = _padded(inside) if len(LABELS[name].dims) > 1 else inside[0]
    return found


def _feature_variables(system: System, r: np.ndarray, mu: np.ndarray) -> dict[str, xr.Variable]:
    """Compute the features of theory.md 7 that are curves or lists."""
    modes = system.modes
    limits = [high_frequency_limits(system, value) for value in mu]
    found = {
        "natural_frequency": modes.w,
        "peak_threshold": peak_thresholds(system),
        "beta_lim_high": np.array([limit.beta_lim for limit in limits]),
        "beta_stick_high": np.array([limit.beta_stick for limit in limits]),
        **_invariants(system, r),
    }
    if system.n > 1:  # one mass held does not vibrate, and NetCDF has no empty dimension
        found["held_frequency"] = modes.held_frequencies()
    variables = {name: label_variable(name, values) for name, values in found.items()}
    return variables | held_variables(system, r)


def held_variables(system: System, r: np.ndarray) -> dict[str, xr.Variable]:
    """Compute amplitude and phase of every mass with the contact held, dims (dof, r); `r` is a checked axis.

    A mass at rest, or in resonance, has no phase: NaN.
    """
    modes = system.modes
    if system.n > 1:
        motion = modes.held_response(r)
        motion[:, modes.held_at_rest()] = 0.0
    else:
        motion = np.full((r.size, 1), modes.base_motion, dtype=complex)
    size = np.abs(motion)
    moves = (size > 0.0) & np.isfinite(size)
    phase = np.where(moves, wrapped(-np.angle(np.where(moves, motion, 1.0))), np.nan)
    return {
        "held_response": label_variable("held_response", size.T),
        "held_phase": label_variable("held_phase", phase.T),
    }


def boundaries(
    system: System, r: ArrayLike, mu: ArrayLike = 1.0, *, units: Units | None = None
) -> xr.Dataset:
    """Compute the boundaries of the regimes over frequency.

    Parameters
    ----------
    system : System
    r : array_like, shape (n_r,)
        Frequency ratios omega/omega_1 [-], >= 0, increasing; omega_1 = sqrt(k_1/m_1) for a chain, else the
        system's frequency_scale.
    mu : array_like, shape (n_mu,)
        Ratios of static to kinetic friction [-], >= 1, increasing.
    units : Units, optional
        Reference values that convert ratios to Hz and N, as in `sweep`; r may then be frequencies.

    Returns
    -------
    xarray.Dataset
        On (mu, r): `beta_lim` (continuous motion below it, theory.md 3), `beta_lim_modal` (T(5.65) with
        (5.55)) and `beta_stick` (at or above it the contact can stay stuck, theory.md 4).

        On r: the response function of z, `V` (real part) and `V_imag`, and `U`, `G`, `H`, `S`.

        Features (theory.md 7): for each mode `natural_frequency` and `peak_threshold`; `held_frequency`; for
        each mu the limits for r -> infinity, `beta_lim_high` and `beta_stick_high`; on (dof, r)
        `held_response` and `held_phase`, amplitude and phase lag [radian] of each mass with the contact held,
        infinite and NaN at its resonances.

        Within the axis: `invariant_point`, where friction does not change z (with damping: its phase);
        without damping, on (dof, mass_invariant), `mass_invariant_point`, where it does not change the
        monoharmonic amplitude of a mass; on (dof, root) `invariant_first_harmonic`, where it does not change
        the amplitude of the first harmonic; on (contact_root) `contact_invariant_first_harmonic`, the same
        for z, theory.md 9.  Rows with fewer points are padded with NaN.  About 40 points plus one per mode
        are listed, from the highest down, and those of masses for up to 12 masses; a variable without points
        is omitted.  `frictionmap.features` computes all points.

        Where C couples modes, `beta_lim_modal` and `peak_threshold`, which treat modes separately, are NaN.

    Raises
    ------
    InputError
        An axis is empty, not finite, not increasing or out of range.

    Examples
    --------
    >>> import frictionmap as fm
    >>> ds = fm.boundaries(fm.System(contact="joined-base-wall"), r=[0.5, 2.0])
    >>> ds.beta_stick.values
    array([[0.25, 4.  ]])
    """
    checks.instance(system, "system", System)
    scales = scales_of(units, system)
    r = checks.axis(ratios(r, "r", KINDS["r"], scales), "r", least=0.0, most=checks.LARGEST_RATIO)
    mu = checks.axis(mu, "mu", least=1.0)
    system.costs(r)
    if system.general is not None:
        return with_units(_general_boundaries(system, r, mu, units), scales)
    found = find_curves(system, r, mu)
    functions = {
        "V": found.v.real,
        "V_imag": np.where(np.isinf(found.v.real), 0.0, found.v.imag),
        "U": found.u,
        "G": found.g,
        "H": found.h,
        "S": found.s,
    }
    variables = boundary_variables(found)
    variables |= {name: label_variable(name, v) for name, v in functions.items()}
    variables |= _feature_variables(system, r, mu)
    axes = {"mu": mu, "r": r, "dof": np.array(system.dofs.numbers)}
    ds = xr.Dataset(variables, coords={name: coordinate(name, axis) for name, axis in axes.items()})
    title = "Boundaries of the motion regimes"
    ds = stamp(ds, "boundaries", title, system, {"r": r, "mu": mu}, units=units)
    ds.attrs |= boundary_check(system, r, mu)
    return with_units(ds, scales)


def _general_boundaries(system: System, r: np.ndarray, mu: np.ndarray, units: Units | None) -> xr.Dataset:
    """Boundaries of a system with several contacts, springs, belts or harmonics."""
    from ..general.boundaries import find_boundaries
    from ..general.dataset import boundary_variables as general_variables
    from ..general.dataset import contact_coordinates, refuse_static
    from ..general.limit_kinds import find_limits
    from ..general.loops import loop_stick_scales

    assert system.general is not None
    refuse_static(system.general, mu)
    axes = {"mu": mu, "r": r, "dof": np.array(system.dofs.numbers)}
    coords = {name: coordinate(name, axis) for name, axis in axes.items()} | contact_coordinates(system)
    if system.general.loop:
        variables = {"beta_stick": label_variable("beta_stick", loop_stick_scales(system, r, mu))}
    else:
        limits = find_boundaries(system, r, mu)
        variables = general_variables(system, limits)
        if not system.general.elastic.any():
            ended = find_limits(system, r, mu, limits)
            variables["limit_kind"] = label_variable("limit_kind", ended.kind)
            if system.general.count > 1:
                variables["limiting_contact"] = label_variable("limiting_contact", ended.contact)
    ds = xr.Dataset(variables, coords=coords)
    return stamp(
        ds, "boundaries", "Boundaries of the motion regimes", system, {"r": r, "mu": mu}, units=units
    )
