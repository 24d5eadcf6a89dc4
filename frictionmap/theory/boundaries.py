"""Boundaries of one rigid contact under one harmonic load, with response functions and features, as a
dataset.
"""

from collections.abc import Sequence

import numpy as np
import xarray as xr

from .. import checks
from ..datasets.labels import BOUNDARIES, LABELS
from ..datasets.variables import coordinate, label_variable
from ..features import (
    all_mass_invariant_points,
    first_harmonic_points,
    high_frequency_limits,
    invariant_points,
    one_phase,
    peak_thresholds,
)
from ..model.modes import wrapped
from ..model.settings import CURVE_OUTPUTS
from ..model.system import System
from .boundary_curves import Curves, find_curves

#: Number of invariant points listed in addition to one per mode, from the highest down; below them hardly any
#: motion is continuous.  Points of masses are listed for up to `_LISTED_MASSES` masses, because their cost
#: grows with the square of that number.
_LISTED_POINTS = 40
_LISTED_MASSES = 12

#: A point at an end of the axis may be found slightly outside it: the search range is extended by `_REACH`,
#: and points within `_ON_END` of the axis are kept.
_REACH = 1e-6
_ON_END = 1e-13


def boundary_variables(found: Curves, asked: Sequence[str] = ()) -> dict[str, xr.Variable]:
    """Label beta_lim and beta_stick, and beta_lim_modal if asked for, dims (mu, r)."""
    names = [name for name in ("beta_lim", *CURVE_OUTPUTS, "beta_stick") if name in (*BOUNDARIES, *asked)]
    return {name: label_variable(name, getattr(found, name)) for name in names}


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


def one_contact_boundaries(system: System, r: np.ndarray, mu: np.ndarray) -> xr.Dataset:
    """Boundaries of a system of one rigid contact under one harmonic load; `r` and `mu` are checked axes."""
    found = find_curves(system, r, mu)
    functions = {
        "V": found.v.real,
        "V_imag": np.where(np.isinf(found.v.real), 0.0, found.v.imag),
        "U": found.u,
        "G": found.g,
        "H": found.h,
        "S": found.s,
    }
    variables = boundary_variables(found, CURVE_OUTPUTS)
    variables |= {name: label_variable(name, v) for name, v in functions.items()}
    variables |= _feature_variables(system, r, mu)
    axes = {"mu": mu, "r": r, "dof": np.array(system.dofs.numbers)}
    return xr.Dataset(variables, coords={name: coordinate(name, axis) for name, axis in axes.items()})
