"""Quantities that kernels do not compute: at r = 0, and at resonances of modes that do not participate."""

import math

import numpy as np

from .. import regimes
from .._kernels.engine.extremes import PHASE, VALUE
from .._kernels.engine.quantities import (
    BY_DAMPING,
    BY_FRICTION,
    BY_LOAD,
    DISTANCE,
    EQUIVALENT,
    LAG,
    MODULUS,
    Results,
)
from ..model.system import System


def _lags(phasors: np.ndarray) -> np.ndarray:
    """Phase lags -arg in (-pi, pi]; NaN for zero phasors."""
    lags = -np.angle(phasors) + 0.0  # not -0.0
    lags[lags == -math.pi] = math.pi
    return np.where(phasors == 0.0, np.nan, lags)


def put_static(system: System, beta: np.ndarray, cell_status: np.ndarray, found: Results) -> np.ndarray:
    """Fill the sliding cells at r = 0, the first frequency; return the amplitude in the contact (n_mu,
    n_beta).

    Without friction the motion is the static response to the load.  With friction only the end of a slide is
    known, K x = p - beta c, with the sign of the load.  NaN where the contact sticks.

    cell_status : (n_mu, n_beta) of these cells
    """
    amplitude = np.full(cell_status.shape, np.nan)
    quasi_static = cell_status == regimes.QUASI_STATIC
    if beta[0] == 0.0 and not system.base_motion:
        phasors = _static_phasors(system)
        amplitude[:, 0] = abs(phasors[-1])
        _put_linear(phasors, found)
    if not system.modes.load.imag.any():  # with other phases a slide ends later or earlier
        for j in np.flatnonzero(quasi_static.any(axis=0)):
            displacements = _ends(system, float(beta[j]))
            amplitude[quasi_static[:, j], j] = abs(displacements[-1])
            if found.extremes.size:
                _put_ends(displacements, quasi_static[:, j], int(j), found)
    return amplitude


def _static_phasors(system: System) -> np.ndarray:
    """Static phasors of the masses, of the transmitted force and of the contact, without friction."""
    modes = system.modes
    x = modes.static_response()
    return np.concatenate((x, [modes.load.sum(), modes.contact @ x]))


def _put_linear(phasors: np.ndarray, found: Results) -> None:
    masses = phasors.size - 2
    for array, modulus, lag in ((found.extremes, VALUE, PHASE), (found.firsts, MODULUS, LAG)):
        if array.size:
            array[:, 0, 0, :, modulus], array[:, 0, 0, :, lag] = np.abs(phasors), _lags(phasors)
    if found.harmonics.size:
        found.harmonics[:, 0, 0] = 0.0
        found.harmonics[:, 0, 0, :, 1] = np.where(np.arange(phasors.size) == masses, 0.0, phasors)
    if found.work_terms.size:
        for column in (BY_FRICTION, BY_LOAD, BY_DAMPING, EQUIVALENT):
            found.work_terms[:, 0, 0, column] = 0.0
        found.work_terms[:, 0, 0, DISTANCE] = 4.0 * abs(phasors[-1])


def _ends(system: System, beta: float) -> np.ndarray:
    """Displacements of the masses and of the contact at tau = 0, where a slide under a slow load ends."""
    modes = system.modes
    # the contact slides in the direction of its motion without friction
    sense = math.copysign(1.0, float(modes.contact @ modes.static_response().real))
    x = np.linalg.solve(modes.stiffness, modes.load.real - sense * beta * modes.contact)
    return np.append(x, modes.contact @ x)


def _put_ends(displacements: np.ndarray, where: np.ndarray, j: int, found: Results) -> None:
    masses = displacements.size - 1
    rows = np.append(np.arange(masses), masses + 1)
    lags = np.where(displacements > 0.0, 0.0, math.pi)
    for m in np.flatnonzero(where):
        found.extremes[m, 0, j, rows, VALUE] = np.abs(displacements)
        found.extremes[m, 0, j, rows, PHASE] = np.where(displacements == 0.0, np.nan, lags)


def put_resonance(system: System, r: np.ndarray, resonant: np.ndarray, found: Results) -> None:
    """Fill in infinite motion of masses at resonances of modes that do not participate, in every regime.

    They lag the load on the mode by a quarter of a period.  resonant : (n_r, n_dof)
    """
    modes = system.modes
    for i in np.flatnonzero(resonant.any(axis=1)).tolist():
        at = r[i : i + 1]
        mode = (modes.chi == 0.0) & (modes.dynamic_stiffness(at)[0] == 0.0)
        push = modes.phi[:, mode] @ modes.participation(at)[0, mode]
        for k in np.flatnonzero(resonant[i]).tolist():
            _put_unbounded(-1j * push[k], i, k, found)
        if found.work_terms.size:
            found.work_terms[:, i, :, BY_LOAD] = np.where(
                np.isnan(found.work_terms[:, i, :, BY_LOAD]), np.nan, np.inf
            )


def _put_unbounded(direction: complex, i: int, k: int, found: Results) -> None:
    lag = float(_lags(np.array([direction]))[0])
    for array, modulus, angle in ((found.extremes, VALUE, PHASE), (found.firsts, MODULUS, LAG)):
        if array.size:
            row = array[:, i, :, k]
            moves = ~np.isnan(row[..., modulus])
            row[moves, modulus], row[moves, angle] = np.inf, lag
    if found.harmonics.size:
        row = found.harmonics[:, i, :, k, 1]
        parts = (np.copysign(np.inf, part) if part else 0.0 for part in (direction.real, direction.imag))
        row[~np.isnan(row)] = complex(*parts)
