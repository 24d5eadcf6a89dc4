"""Sweeps of the two-storey rig for tests."""

import numpy as np

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
