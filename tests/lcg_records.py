"""Records of a linear congruential generator: the same bits everywhere."""

import numpy as np


def lcg(seed, n, ar, envelope):
    """A coloured, modulated noise of n samples with the largest modulus 1."""
    state, values = seed, np.zeros(n)
    before, last = 0.0, 0.0
    for k in range(n):
        drawn = []
        for _ in range(4):
            state = (6364136223846793005 * state + 1442695040888963407) % 2**64
            drawn.append((state >> 11) * 2.0**-53)
        last, before = (
            (ar[0] * last + ar[1] * before) + (((drawn[0] + drawn[1]) + drawn[2]) + drawn[3] - 2),
            last,
        )
        rises, falls = envelope
        factor = k / rises if k < rises else (n - 1 - k) / (n - 1 - falls) if k > falls else 1.0
        values[k] = last * factor
    return values / np.abs(values).max()
