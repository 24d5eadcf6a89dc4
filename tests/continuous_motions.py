"""Continuous motions that several tests take, and their closed form in as many digits as mpmath is set to."""

import math

import mpmath as mp
import numpy as np
from structures import chain

import frictionmap as fm

#: contact, load, gamma, kappa, zeta.
CASES = [
    (("wall", 1), 1, [1.0], [1.0], 0.05),
    (("base", 1), 1, [1.0], [1.0], 0.3),
    (("wall", 2), 1, [1.0, 0.7], [1.0, 1.3], [0.02, 1.2]),
    (("base", 1), 1, [1.0, 1.5], [1.0, 0.8], [0.1, 0.03]),
    (("masses", 1, 3), 2, [1.0, 0.7, 1.4], [1.0, 1.3, 0.6], [0.02, 0.03, 1.0]),
    (("masses", 2, 3), 1, [1.0, 2.0, 0.5], [1.0, 0.7, 1.4], [0.01, 0.05, 0.02]),
    (("base", 3), 1, [1.0] * 5, [1.0] * 5, 0.03),
    (("wall", 3), 5, [1.0, 2.0, 1.0, 0.5, 1.0], [1.0, 0.5, 1.0, 1.0, 2.0], [0.1, 0.2, 0.01, 0.5, 2.0]),
]


def as_system(contact, load, gamma, kappa, zeta):
    return chain({"contact": contact, "load": load, "gamma": gamma, "kappa": kappa}, zeta)


def beta_lim(system, r, mu=1.0):
    return fm.boundaries(system, [r], mu).beta_lim.item()


def random_system(rng, damped=True):
    """Any contact, 1 to 5 masses, a load with phases or a base that moves, any damping."""
    n = int(rng.integers(1, 6))
    contact = str(rng.choice(["fixed-wall", "joined-base-wall", "between-masses"][: 3 if n > 1 else 2]))
    masses = sorted(rng.choice(np.arange(1, n + 1), 2 if contact == "between-masses" else 1, replace=False))
    settings = {}
    if contact == "joined-base-wall" or rng.random() < 0.3:
        settings = {"excitation": "base", "damping_reference": str(rng.choice(["ground", "base"]))}
    elif rng.random() < 0.5:
        settings = {"load": list(rng.normal(size=n) + 1j * rng.normal(size=n))}
    return fm.System(
        contact=contact,
        contact_masses=[int(mass) for mass in masses],
        mass_ratios=[1.0, *rng.uniform(0.3, 3.0, n - 1)],
        stiffness_ratios=[1.0, *rng.uniform(0.3, 3.0, n - 1)],
        damping_ratios=list(rng.choice([0.005, 0.1, 0.6, 1.0, 1.7], n)) if damped else 0.0,
        **settings,
    )


def below_the_boundary(rng, system):
    """(r, beta) of a continuous motion."""
    while True:
        r = float(rng.uniform(0.25, 3.0))
        beta = float(rng.uniform(0.05, 0.99)) * beta_lim(system, r)
        if 0.0 < beta < math.inf:
            return r, beta


class Precise:
    """theory.md 1 and 2 for a chain, written from the equations, in 40 digits; imports nothing."""

    def __init__(self, contact, load, gamma, kappa, zeta, r, beta):
        n = len(gamma)
        r, beta = mp.mpf(r), mp.mpf(beta)
        gamma, kappa = [mp.mpf(value) for value in gamma], [*(mp.mpf(value) for value in kappa), mp.mpf(0)]
        zeta = [mp.mpf(value) for value in (zeta if isinstance(zeta, list) else [zeta] * n)]
        K = mp.zeros(n)
        for i in range(n):
            K[i, i] = kappa[i] + kappa[i + 1]
            if i + 1 < n:
                K[i, i + 1] = K[i + 1, i] = -kappa[i + 1]
        scale = mp.diag([1 / mp.sqrt(value) for value in gamma])
        squares, shapes = mp.eigsy(scale * K * scale)
        phi, w = scale * shapes, [mp.sqrt(value) for value in squares]
        c = mp.zeros(n, 1)
        c[contact[-1] - 1] = 1
        if contact[0] == "masses":
            c[contact[1] - 1] = -1
        s = int(contact[0] == "base")
        chi = [(c.T * phi[:, i])[0] for i in range(n)]
        C = mp.zeros(n)
        for i in range(n):
            momentum = mp.diag(gamma) * phi[:, i]
            C += 2 * zeta[i] * w[i] * momentum * momentum.T
        self.M, self.C, self.K, self.c, self.s, self.load, self.n = (
            r**2 * mp.diag(gamma), r * C, K, c, s, load, n
        )  # fmt: skip
        poles = [w[i] ** 2 - r**2 + 2j * zeta[i] * w[i] * r for i in range(n)]
        part = [phi[load - 1, i] / poles[i] for i in range(n)]
        V = sum(chi[i] * part[i] for i in range(n)) - s
        self.w, self.zeta, self.r, self.beta, self.V = w, zeta, r, beta, V
        self.u, self.g = zip(*(self._damping(w[i], zeta[i]) for i in range(n)), strict=True)
        U = sum((chi[i] / w[i]) ** 2 * self.u[i] for i in range(n))
        G = sum((chi[i] / w[i]) ** 2 * self.g[i] for i in range(n))
        root = mp.sqrt(abs(V) ** 2 - (beta * U) ** 2)
        self.Z = root - beta * G
        self.phase = mp.atan2(-beta * U, root) - mp.arg(V)
        self.harmonic = [
            sum(phi[k, i] * part[i] for i in range(n)) * mp.expjpi(self.phase / mp.pi) for k in range(n)
        ]
        self.weights = [[phi[k, i] * chi[i] / w[i] ** 2 for i in range(n)] for k in range(n)]

    @staticmethod
    def _root(zeta):
        # the double root at zeta = 1 by a limit that costs no digit of those compared
        return mp.sqrt(mp.mpc(1 - zeta**2)) if zeta != 1 else mp.mpc(mp.mpf(10) ** (-mp.mp.dps // 3))

    def _damping(self, w, zeta):
        """u and g, T(7.11), (7.12)."""
        s, a = self._root(zeta), w / self.r
        angle, x = mp.pi * s * a, mp.pi * zeta * a
        below = mp.cosh(x) + mp.cos(angle)
        return mp.re(mp.sin(angle) / s * a / below), mp.re((mp.sinh(x) - zeta / s * mp.sin(angle)) / below)

    def h(self, i, t):
        """The answer of mode i with d and q of T(B.8)."""
        zeta, theta = self.zeta[i], t * self.w[i] / self.r
        s = self._root(zeta)
        envelope = mp.exp(-zeta * theta)
        d = mp.re(envelope * (mp.cos(s * theta) + zeta / s * mp.sin(s * theta)))
        q = mp.re(envelope * mp.sin(s * theta) / s)
        return 1 - (1 + self.g[i]) * d - self.u[i] * self.r / self.w[i] * q

    def half(self, k, t):
        """x_k over the half period from a maximum of z on, T(7.28) as corrected."""
        harmonic = mp.re(self.harmonic[k] * mp.expjpi(t / mp.pi))
        return harmonic + self.beta * sum(self.weights[k][i] * self.h(i, t) for i in range(self.n))

    def turn(self, k, start):
        """The time near `start` where x_k turns."""
        return mp.findroot(lambda t: mp.diff(lambda s: self.half(k, s), t), mp.mpf(start))

    def x(self, k, tau):
        """x_k at a time of the load."""
        t = tau - self.phase
        turns = mp.floor(t / mp.pi)
        return (-1) ** int(turns) * self.half(k, t - turns * mp.pi)


#: Enough for the fastest modes of `random_system` over half a period.
NODES, WEIGHTS = np.polynomial.legendre.leggauss(120)


def half_nodes(motion):
    """Gauss-Legendre nodes (times of the load) and weights of the two smooth halves of a period."""
    x, weights = NODES, WEIGHTS
    first = motion.contact_phase + 0.5 * math.pi * (x + 1.0)
    return np.concatenate((first, first + math.pi)), np.tile(0.5 * math.pi * weights, 2)
