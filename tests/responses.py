"""Forced responses of one mass for tests: half a period solved from the equation of motion, noise on top."""

import functools
from typing import NamedTuple

import numpy as np
import records
from scipy.linalg import expm


class Truth(NamedTuple):
    """One mass on a shaken base that rubs on a fixed wall, its dashpot between base and mass."""

    f_n: float
    zeta: float
    beta: tuple  # one a set
    r: tuple


def continuous(r, beta, zeta):
    """X_1 of r^2 x'' + 2 zeta r x' + x + beta sgn(x') = Re((1 + 2 i zeta r) e^{i tau}) that never stops.

    From a maximum on x falls: y = x - beta - Re(V e^{i(tau + phi)}) is free, and x(pi) = -x(0), x'(pi) =
    -x'(0) asks for (E + 1) y(0) = (-2 beta, 0), E the propagator of half a period.  x'(0) = 0 gives phi.
    """
    V = (1.0 + 2j * zeta * r) / (1.0 - r**2 + 2j * zeta * r)
    A = np.array([[0.0, 1.0], [-1.0 / r**2, -2.0 * zeta / r]])
    y = np.linalg.solve(expm(np.pi * A) + np.eye(2), [-2.0 * beta, 0.0])
    t = np.linspace(0.0, np.pi, 400)[1:-1]
    turn = np.arcsin(y[1] / abs(V)) - np.angle(V)  # V e^{i phi} has the speed -y'(0) at tau = 0
    speed = np.array([(expm(one * A) @ y)[1] for one in t]) - abs(V) * np.sin(t + turn + np.angle(V))
    assert (speed < 0.0).all(), "this motion stops"
    # first harmonic over half a period, as the other half is its image: the free part by its own equation
    free = np.linalg.solve(A - 1j * np.eye(2), (expm(np.pi * A) * np.exp(-1j * np.pi) - np.eye(2)) @ y)[0]
    pushed = beta * 2.0 / 1j  # int_0^pi e^{-i tau}
    return V + 2.0 / np.pi * (free + pushed) * np.exp(-1j * turn)


@functools.cache
def phasors(truth):
    """X_1 of every set at every r."""
    return np.array([continuous(r, beta, truth.zeta) for beta in truth.beta for r in truth.r])


def table(truth, seed, sigma_phase=0.7, sigma_amplitude=0.01):
    """Set, frequency [Hz], lag [deg] and amplitude of every set at every r; noise of its own for a seed."""
    rng = np.random.default_rng(seed)
    sets = np.repeat(np.arange(1, len(truth.beta) + 1), len(truth.r))
    r = np.tile(truth.r, len(truth.beta))
    X = phasors(truth)
    lag = -np.degrees(np.angle(X)) + sigma_phase * rng.normal(size=r.size)
    return sets, r * truth.f_n, lag, np.abs(X) * np.exp(sigma_amplitude * rng.normal(size=r.size))


def integrated(r, beta, zeta, mu):
    """X_1 of the steady motion that `records` integrates, of one mass under a base of amplitude 1.

    A continuous motion it would take long to settle in, and has its own formula.
    """
    truth = records.Truth(1.0, zeta, beta, mu, 0.0, r, (0.0, 1.0))
    motion = records.steady(truth, cycles=200, accuracy=1e-9)
    assert motion.change < 1e-6
    nodes, weights = np.polynomial.legendre.leggauss(40)
    total = 0j
    for begin, end, place in motion.parts:
        if end > begin:
            t = 0.5 * (begin + end) + 0.5 * (end - begin) * nodes
            wave = np.exp(-2j * np.pi * r * t)
            total += 0.5 * (end - begin) * np.sum(weights * place(t) * wave)
    return 2.0 * r * total
