"""Sweeps for tests: of the two-storey rig, and of any chain, from M, K and C."""

import numpy as np
from scipy.linalg import eigh

GAMMA, KAPPA, F_K1M1 = 0.9772, 1.1119, 2.9248318

FREQUENCIES = np.concatenate((np.linspace(0.5, 1.7, 7), np.linspace(1.97, 4.7, 16), np.linspace(5.2, 8.0, 7)))


def amplitudes(f, gamma=GAMMA, kappa=KAPPA, f_k1m1=F_K1M1):
    """|X_1|/Y of two masses on a shaken base, from M and K."""
    K = np.array([[1.0 + kappa, -kappa], [-kappa, kappa]])
    return np.array(
        [abs(np.linalg.solve(K - (one / f_k1m1) ** 2 * np.diag([1.0, gamma]), [1.0, 0.0])[0]) for one in f]
    )


def swept(seed=1, noise=0.02):
    """Frequencies and amplitudes with a relative error."""
    errors = np.random.default_rng(seed).normal(0.0, noise, FREQUENCIES.size)
    return FREQUENCIES, amplitudes(FREQUENCIES) * np.exp(errors)


def responses(f, masses, springs, zeta, f_k1m1, base_damping=False):
    """X_k/Y, shape (samples, masses), of a chain on a shaken base with damping ratios of its modes."""
    M = np.diag(masses)
    stretches = np.eye(len(masses)) - np.eye(len(masses), k=-1)
    K = stretches.T @ np.diag(springs) @ stretches
    squares, shapes = eigh(K, M)
    C = M @ shapes @ np.diag(2.0 * np.asarray(zeta) * np.sqrt(squares)) @ shapes.T @ M
    along = np.ones(len(masses))
    found = []
    for r in np.asarray(f) / f_k1m1:
        load = K @ along + 1j * r * base_damping * (C @ along)
        found.append(np.linalg.solve(K - r**2 * M + 1j * r * C, load))
    return np.array(found)


def natural_frequencies(masses, springs, f_k1m1):
    """Of a chain, increasing, Hz."""
    stretches = np.eye(len(masses)) - np.eye(len(masses), k=-1)
    return f_k1m1 * np.sqrt(eigh(stretches.T @ np.diag(springs) @ stretches, np.diag(masses))[0])
