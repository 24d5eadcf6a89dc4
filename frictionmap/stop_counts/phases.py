"""Slides and stops as affine maps of the state, for many frequencies, friction ratios and times at once.

The state is (q, r q') of the participating modes.  In t = tau/r a slide follows

    q'' + D q' + W^2 q = Re(lambda(r) e^{i tau}) - sense beta chi,

and a stop the same with the force F that keeps chi.q constant; B is the number of cases.
"""

from functools import cached_property
from typing import NamedTuple

import numpy as np
from scipy.linalg import expm

from ..model.system import System

#: Eigenvectors with a condition number above this lose too many digits; the exponential is computed anew.
_DEFECTIVE = 1e6


class Affine(NamedTuple):
    """Maps Y -> matrix Y + shift; (B, 2m, 2m) and (B, 2m)."""

    matrix: np.ndarray
    shift: np.ndarray

    def __call__(self, state: np.ndarray) -> np.ndarray:
        return _applied(self.matrix, state) + self.shift

    def after(self, first: "Affine") -> "Affine":
        """This map after another one."""
        return Affine(self.matrix @ first.matrix, self(first.shift))


class Exponential:
    """exp(A t) of one matrix for many t."""

    def __init__(self, matrix: np.ndarray) -> None:
        self._matrix = matrix
        none = (np.empty(0), np.empty((0, 0)))
        rates, vectors = np.linalg.eig(matrix) if matrix.size else none
        self._rates: np.ndarray = rates
        self._vectors: np.ndarray = vectors
        self._defective = bool(matrix.size) and np.linalg.cond(self._vectors) > _DEFECTIVE
        self._inverse = None if self._defective else np.linalg.inv(self._vectors)

    def __call__(self, t: np.ndarray) -> np.ndarray:
        """(B, n, n) for t (B,)."""
        if self._defective:
            return expm(self._matrix * t[:, np.newaxis, np.newaxis])
        growth = np.exp(t[:, np.newaxis] * self._rates)
        return ((self._vectors * growth[:, np.newaxis]) @ self._inverse).real


class Drive(NamedTuple):
    """Frequencies, and the phasors at them; (B,), (B, m)."""

    r: np.ndarray
    load: np.ndarray  # lambda
    sliding: np.ndarray  # of q in a slide
    held: np.ndarray  # of the coordinates of the held structure


class Phases:
    """The maps of one system with one rigid contact under one harmonic load."""

    def __init__(self, system: System) -> None:
        modes = system.modes
        self._modes = modes
        self._which = modes.participating
        w = modes.w[self._which]
        self.chi = modes.chi[self._which]
        self.m = w.size
        damping = np.diag(2.0 * modes.zeta[self._which] * w)
        coupling = modes.participating_coupling()
        self._damping = damping if coupling is None else damping + coupling
        self._stiffness = np.diag(w**2)
        m = self.m
        self._slide = Exponential(
            np.block([[np.zeros((m, m)), np.eye(m)], [-self._stiffness, -self._damping]])
        )
        unit = self.chi / np.linalg.norm(self.chi)
        self._basis = np.linalg.svd(unit[np.newaxis])[2][1:].T  # (m, m - 1), chi.basis = 0
        self._unit = unit / np.linalg.norm(self.chi)  # q of z = 1
        k, d = (self._basis.T @ a @ self._basis for a in (self._stiffness, self._damping))
        self._held_stiffness, self._held_damping = k, d
        n = m - 1
        self._held = Exponential(np.block([[np.zeros((n, n)), np.eye(n)], [-k, -d]]))
        pull = self._basis.T @ self._stiffness @ self._unit
        self._static = -np.linalg.solve(k, pull) if n else np.empty(0)
        self._enter, self._leave = np.zeros((2 * n, 2 * m)), np.zeros((2 * m, 2 * n))
        self._enter[:n, :m], self._enter[n:, m:] = self._basis.T, self._basis.T
        self._enter[:n, :m] -= np.outer(self._static, self.chi)
        self._leave[:m, :n], self._leave[m:, n:] = self._basis, self._basis
        self._stays = np.zeros((2 * m, 2 * m))
        self._stays[:m, :m] = np.outer(self._basis @ self._static + self._unit, self.chi)
        self._rest = -np.concatenate((self.chi / np.diag(self._stiffness), np.zeros(m)))

    @cached_property
    def fastest(self) -> float:
        """Largest natural frequency."""
        return float(np.sqrt(self._stiffness.max()))

    def drive(self, r: np.ndarray) -> Drive:
        """Phasors at frequencies r (B,)."""
        load = self._modes.relative_participation(r)[:, self._which]
        return Drive(
            r, load, _phasors(self._stiffness, self._damping, r, load),
            _phasors(self._held_stiffness, self._held_damping, r, load @ self._basis),
        )  # fmt: skip

    def slide(self, drive: Drive, begin: np.ndarray, end: np.ndarray, force: np.ndarray) -> Affine:
        """From begin to end (B,) in tau, against a friction force (B,) of the sign of the slide."""
        grown = self._slide((end - begin) / drive.r)
        rest = force[:, np.newaxis] * self._rest
        before = _forced(drive.sliding, drive.r, begin) + rest
        return Affine(grown, _forced(drive.sliding, drive.r, end) + rest - _applied(grown, before))

    def stop(self, drive: Drive, begin: np.ndarray, end: np.ndarray) -> Affine:
        """From begin to end (B,) in tau with the contact held."""
        cases, size = drive.r.size, self._stays.shape
        if self.m == 1:
            return Affine(np.broadcast_to(self._stays, (cases, *size)), np.zeros((cases, size[0])))
        grown = self._held((end - begin) / drive.r)
        moved = _forced(drive.held, drive.r, end)
        moved = moved - _applied(grown, _forced(drive.held, drive.r, begin))
        return Affine(self._leave @ grown @ self._enter + self._stays, moved @ self._leave.T)

    def velocity(self, state: np.ndarray) -> np.ndarray:
        """r z' of states (B, 2m)."""
        return state[:, self.m :] @ self.chi

    def force(self, drive: Drive, state: np.ndarray, tau: np.ndarray) -> np.ndarray:
        """Force F that would hold the contact in states (B, 2m)."""
        return self._free_force(drive, state, tau) @ self.chi / (self.chi @ self.chi)

    def acceleration(self, drive: Drive, state: np.ndarray, tau: np.ndarray, force: np.ndarray) -> np.ndarray:
        """r^2 z'' against a friction force."""
        return self._free_force(drive, state, tau) @ self.chi - force * (self.chi @ self.chi)

    def force_rate(self, drive: Drive, state: np.ndarray, tau: np.ndarray) -> np.ndarray:
        """dF/dtau in a stop."""
        held = self.force(drive, state, tau)
        speeding = self._free_force(drive, state, tau) - held[:, np.newaxis] * self.chi
        rate = drive.r[:, np.newaxis] * (1j * drive.load * np.exp(1j * tau)[:, np.newaxis]).real
        rate -= state[:, self.m :] @ self._stiffness + speeding @ self._damping
        return rate @ self.chi / (self.chi @ self.chi) / drive.r

    def _free_force(self, drive: Drive, state: np.ndarray, tau: np.ndarray) -> np.ndarray:
        load = (drive.load * np.exp(1j * tau)[:, np.newaxis]).real
        return load - state[:, : self.m] @ self._stiffness - state[:, self.m :] @ self._damping


def _applied(matrix: np.ndarray, state: np.ndarray) -> np.ndarray:
    """Products of matrices (B, n, n) and states (B, n)."""
    return (matrix @ state[..., np.newaxis])[..., 0]


def _phasors(stiffness: np.ndarray, damping: np.ndarray, r: np.ndarray, load: np.ndarray) -> np.ndarray:
    """Phasors (B, n) of K - r^2 + i r D under loads (B, n)."""
    if not stiffness.size:
        return np.empty((r.size, 0), dtype=complex)
    r = r[:, np.newaxis, np.newaxis]
    matrix = stiffness - r * r * np.eye(len(stiffness)) + 1j * r * damping
    return np.linalg.solve(matrix, load[..., np.newaxis])[..., 0]


def _forced(phasors: np.ndarray, r: np.ndarray, tau: np.ndarray) -> np.ndarray:
    """State (B, 2n) of the forced motion at tau."""
    turned = phasors * np.exp(1j * tau)[:, np.newaxis]
    return np.concatenate((turned.real, (1j * r[:, np.newaxis] * turned).real), axis=1)
