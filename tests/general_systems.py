"""Systems of the general engine for tests: from reference rows, and random ones."""

import numpy as np

import frictionmap as fm
from frictionmap._kernels.general.problem import Problem
from frictionmap._kernels.general.series import Friction
from frictionmap._kernels.general.steady import REPEATS
from frictionmap.general.problem import ties
from frictionmap.general.recorded import Memory, recorded_state

KINDS = {"wall": "fixed-wall", "base": "joined-base-wall", "masses": "between-masses"}


def phasors(harmonics):
    """Harmonics {"n": [[re, im], ...]} of a row as vectors."""
    return {int(n): np.array([complex(*value) for value in vector]) for n, vector in harmonics.items()}


def chain(system, zeta, **further):
    """A chain of the reference files, with the load in `further`."""
    kind, *masses = system["contact"]
    return fm.System(
        KINDS[kind], masses, mass_ratios=system["gamma"], stiffness_ratios=system["kappa"],
        damping_ratios=zeta, **further,
    )  # fmt: skip


class Solved:
    """Steady state of a structure with contacts of any vector and a load, at the level of the kernels.

    Unlike a `System`, it takes walls that move while the load is given for itself, and belts between masses.
    """

    def __init__(self, mass, stiffness, damping, w, r, loads, friction, **further):
        from scipy.linalg import eigh

        squares, phi = eigh(stiffness, mass)
        count, n = w.shape[1], len(mass)
        zero = np.zeros(count)
        walls = np.asarray(further.get("walls", zero), dtype=float)
        normal = further.get("normal", {})
        channels = [(np.eye(n)[k], zero, zero, {q: v[k] for q, v in loads.items()}) for k in range(n)]
        channels.append((np.zeros(n), walls, zero, {1: 1.0}))
        channels.append((np.zeros(n), zero, np.ones(count), normal))
        orders = sorted({q for *_, own in channels for q in own})
        table = np.zeros((1, 2, len(channels), len(orders)))
        for d, (*_, own) in enumerate(channels):
            for q, value in own.items():
                table[0, :, d, orders.index(q)] = np.real(value), -np.imag(value)
        c = phi.T @ damping @ phi
        coupled = bool(np.abs(c - np.diag(np.diag(c))).max() > 1e-15)
        spring = np.asarray(further.get("spring", zero), dtype=float)
        belt = np.asarray(further.get("belt", zero), dtype=float)
        chi = w.T @ phi
        fastest = np.sqrt(np.linalg.eigvalsh(np.diag(squares) + chi.T @ np.diag(spring) @ chi)[-1])
        rate = max((fastest + np.linalg.norm(c, 2)) / r, float(max(orders)))
        odd = all(q % 2 for q in (*loads, *([1] if walls.any() else [])))
        even = all(q % 2 == 0 for q in normal)
        problem = Problem(
            squares, c, coupled, np.ascontiguousarray(chi),
            np.ascontiguousarray(phi.T @ np.array([one[0] for one in channels]).T),
            np.ascontiguousarray(np.array([one[1] for one in channels]).T),
            np.ascontiguousarray(np.array([one[2] for one in channels]).T),
            spring, belt, ties(w.T, walls, belt, spring), np.array(orders, dtype=float), np.array([r]), table,
            np.array([rate]),
            np.array([np.abs(list(loads.values())).max() / (squares[0] + r * r)]),
            bool(odd and even and not belt.any()),
        )  # fmt: skip
        start = np.zeros((2, n))
        start[0] = phi.T @ mass @ np.asarray(further.get("start", np.zeros(n)), dtype=float)
        if "state" in further:
            start = np.asarray(further["state"], dtype=float)
        kinetic, static = (np.asarray(values, dtype=float) for values in friction)
        self.found, halves, self.multiplier, self.counts, self.record, *_ = recorded_state(
            problem,
            0,
            Friction(kinetic, static),
            start,
            (2000, 1e-12),
            Memory(problem, np.ascontiguousarray(phi), 0),
        )
        self.resolved = self.found.status == REPEATS
        self.period = halves // 2
        lowest, highest = self.record.ranges
        self.highest, self.lowest = ((ends[:count], ends[count:]) for ends in (highest, lowest))


def matrices(gamma, kappa, zeta):
    """M, K and C1 of a chain with the same damping ratio for all modes."""
    from scipy.linalg import eigh

    kappa = np.asarray(kappa, dtype=float)
    stiffness = np.diag(kappa) + np.diag(np.append(kappa[1:], 0.0))
    stiffness -= np.diag(kappa[1:], 1) + np.diag(kappa[1:], -1)
    mass = np.diag(np.asarray(gamma, dtype=float))
    squares, phi = eigh(stiffness, mass)
    shape = mass @ phi
    return mass, stiffness, shape @ np.diag(2.0 * zeta * np.sqrt(squares)) @ shape.T


def vector(contact, n):
    """W (n, 1) of a contact ["wall", k] or ["masses", a, b]."""
    kind, *masses = contact
    w = np.zeros((n, 1))
    w[masses[-1] - 1] = 1.0
    if kind == "masses":
        w[masses[0] - 1] = -1.0
    return w


def frame(storeys, friction=None, stiffness=None, zeta=0.03):
    """A frame of equal storeys with a damper in each, loaded at the top.

    friction : ratios of the dampers, from the ground up; default: 1 to 0.4
    stiffness : of their springs; default: rigid
    """
    ratios = np.linspace(1.0, 0.4, storeys) if friction is None else np.broadcast_to(friction, storeys)
    contacts = [
        fm.Contact(
            "between-masses" if k else "fixed-wall", (k, k + 1) if k else 1, ratio=float(ratios[k]),
            stiffness=stiffness,
        )
        for k in range(storeys)
    ]  # fmt: skip
    ones = [1.0] * storeys
    return fm.System(
        contacts=contacts, mass_ratios=ones, stiffness_ratios=ones, damping_ratios=zeta, load_mass=storeys
    )
