"""Harmonic balance with alternating frequency and time for one elastic contact (Jenkins element), compiled.

The displacement in the contact is a sum of odd harmonics, as the response to one harmonic is antiperiodic:

    z_n = V_n - A_n F_n(z),   n = 1, 3, ..., H

V_n is the response without the contact, A_n the receptance of the structure at the contact.  The harmonics
F_n of the contact force are those of its hysteresis on samples of half a period.  The derivative of the force
by the harmonics is exact on these samples, and Newton's method with a line search solves the equations.  As
codes of this kind do, a row of cells is solved by continuation: each cell starts from the solution of the
cell before it.
"""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from .body import TWO_PI
from .contacts import ContactBody

#: Samples per period: so many per period of the highest harmonic, and so many at least.
_SAMPLES, _LEAST_SAMPLES = 32, 128

#: Passes over half a period: the hysteresis loop closes in the first pass with a slip.
_PASSES = 3

#: Newton steps at most, halvings of a step, and the residual, over the response, that ends them.
_MOST_STEPS, _HALVINGS = 60, 12
_SETTLED = 1e-11

#: Points of the sum of harmonics at which its largest value is looked for.
_POINTS = 4096


class Balance(NamedTuple):
    """Equations of one frequency for h harmonics; unknowns: their real parts, then the imaginary ones."""

    orders: np.ndarray  # (h,)
    waves: np.ndarray  # (samples, 2 h) z at the samples per unknown, over half a period
    free: np.ndarray  # (2 h,) V
    receptance: np.ndarray  # (2 h, 2 h) A
    stiffness: float  # of the contact


@njit(cache=True, error_model="numpy")
def _forces(waves, stiffness, beta, z, forces, slopes):
    """Contact forces at the samples, and their derivatives by the unknowns; the force is antiperiodic."""
    count, unknowns = waves.shape
    force, place = 0.0, -z[count - 1]
    rate, wave = np.zeros(unknowns), -waves[count - 1]
    for turn in range(_PASSES):
        for k in range(count):
            force += stiffness * (z[k] - place)
            slips = abs(force) > beta
            if slips:
                force = math.copysign(beta, force)
            for u in range(unknowns):
                rate[u] = 0.0 if slips else rate[u] + stiffness * (waves[k, u] - wave[u])
                wave[u] = waves[k, u]
            place = z[k]
            forces[k] = force
            slopes[k] = rate
        if turn < _PASSES - 1:
            force, place = -force, -place
            rate, wave = -rate, -wave


@njit(cache=True, error_model="numpy")
def _residual(balance, beta, unknowns, forces, slopes):
    """Residual of the equations; fills forces and slopes."""
    _forces(balance.waves, balance.stiffness, beta, balance.waves @ unknowns, forces, slopes)
    harmonics = (2.0 / forces.size) * (balance.waves.T @ forces)
    return unknowns - balance.free + balance.receptance @ harmonics


@njit(cache=True, error_model="numpy")
def _newton(balance, beta, unknowns, forces, slopes):
    """Solve one cell from the unknowns given; whether the residual is small."""
    identity = np.eye(unknowns.size)
    size = np.abs(balance.free).max()
    residual = _residual(balance, beta, unknowns, forces, slopes)
    for _ in range(_MOST_STEPS):
        norm = np.abs(residual).max()
        if norm <= _SETTLED * size:
            return True
        if not norm < np.inf:
            return False
        harmonics = (2.0 / forces.size) * (balance.waves.T @ slopes)
        step = np.linalg.solve(identity + balance.receptance @ harmonics, residual)
        before = unknowns.copy()
        share = 1.0
        for _ in range(_HALVINGS):
            unknowns[:] = before - share * step
            residual = _residual(balance, beta, unknowns, forces, slopes)
            if np.abs(residual).max() < norm:
                break
            share *= 0.5
    return np.abs(residual).max() <= _SETTLED * size


@njit(cache=True, error_model="numpy")
def solve_row(balance, beta, stuck, found):
    """Solve the cells of one frequency in turn; fills found (cells, 2 h), NaN where it does not converge.

    The first cell, and any that does not converge from the one before it, starts from `stuck`, the response
    with a contact that does not slip.
    """
    samples, unknowns = balance.waves.shape
    forces, slopes = np.empty(samples), np.empty((samples, unknowns))
    state = stuck.copy()
    for k in range(beta.size):
        good = _newton(balance, beta[k], state, forces, slopes)
        if not good:
            state[:] = stuck
            good = _newton(balance, beta[k], state, forces, slopes)
        if good:
            found[k] = state
        else:
            found[k, :] = np.nan
            state[:] = stuck


def _stacked(values: np.ndarray) -> np.ndarray:
    """Real parts, then imaginary parts."""
    return np.concatenate((values.real, values.imag))


def amplitudes(orders: np.ndarray, stacked: np.ndarray) -> np.ndarray:
    """Largest abs(z) of sums of odd harmonics, (cells,); the maximum between points is that of a parabola."""
    angles = np.outer(TWO_PI / (2 * _POINTS) * np.arange(_POINTS), orders)
    z = np.abs(stacked @ np.hstack((np.cos(angles), -np.sin(angles))).T)
    k = z.argmax(axis=1)
    cells = np.arange(len(z))
    before, at, after = z[cells, k - 1], z[cells, k], z[cells, (k + 1) % _POINTS]
    bend = before - 2.0 * at + after
    return at - (after - before) ** 2 / (8.0 * np.where(bend < 0.0, bend, -np.inf))


def _multiplication(factors: np.ndarray) -> np.ndarray:
    """Matrix that multiplies stacked numbers by complex factors."""
    real, imaginary = np.diag(factors.real), np.diag(factors.imag)
    return np.block([[real, -imaginary], [imaginary, real]])


class HarmonicBalance:
    """Harmonic balance of the odd harmonics up to `highest`."""

    name = "harmonic balance (AFT)"

    def __init__(self, body: ContactBody, stiffness: float, highest: int) -> None:
        self.body, self.stiffness = body, stiffness
        self.orders = np.arange(1.0, highest + 1.0, 2.0)
        samples = max(_LEAST_SAMPLES, _SAMPLES * highest) // 2
        angles = np.outer(TWO_PI / (2 * samples) * np.arange(samples), self.orders)
        self.waves = np.hstack((np.cos(angles), -np.sin(angles)))

    def prepare(self, r: float) -> tuple[Balance, np.ndarray]:
        """The equations of one frequency, and the response with a contact that does not slip."""
        k, c = self.body.structure
        w = self.body.vectors[:, 0]
        free, receptance = (np.empty(self.orders.size, complex) for _ in range(2))
        for i, n in enumerate(self.orders):
            dynamic = k - (n * r) ** 2 * np.eye(len(k)) + 1j * n * r * c
            free[i] = w @ np.linalg.solve(dynamic, np.eye(len(k))[0]) * self.body.load.get(int(n), 0.0)
            receptance[i] = w @ np.linalg.solve(dynamic, w)
        stuck = _stacked(free / (1.0 + self.stiffness * receptance))
        balance = Balance(
            self.orders, self.waves, _stacked(free), _multiplication(receptance), self.stiffness
        )
        return balance, stuck

    def solve(self, r: float, beta: np.ndarray) -> np.ndarray:
        """Harmonics of z, (beta.size, 2 h), for one row of cells."""
        balance, stuck = self.prepare(r)
        found = np.empty((beta.size, stuck.size))
        solve_row(balance, beta, stuck, found)
        return found
