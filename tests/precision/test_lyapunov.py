"""Lyapunov exponents of motions from rest with the load on the mass in contact, which begin with a slide.

Of one mass they are compared with two motions side by side, each followed by the closed forms of its slides
and stops in plain Python; of structures with the motion under the opposite load, which begins with a turn.
"""

import cmath
import math

import numpy as np
import pytest
from scipy.optimize import brentq

import frictionmap as fm
from frictionmap import regimes

OUTPUTS = ["status", "lyapunov_exponent", "lyapunov_exponent_error"]

TWO_PI = 2.0 * math.pi

#: Phase at which two motions are compared, and their distance there: its square, and the errors of events
#: over it, are both some 1e-8.
SECTION, APART = 0.3, 1e-7

#: Samples of a velocity per period; brentq sharpens the first change of sign.
SAMPLES = 200


class Mass:
    """r^2 x'' + 2 zeta r x' + x = cos tau - f, |f| = beta in a slide and <= mu beta in a stop."""

    def __init__(self, r, zeta, beta, mu):
        self.beta, self.limit = beta, mu * beta
        self.root = complex(-zeta, math.sqrt(1.0 - zeta * zeta)) / r
        self.response = 1.0 / complex(1.0 - r * r, 2.0 * zeta * r)

    def slide(self, tau, x, v, sense):
        """Functions of tau: displacement and velocity of the slide that begins with x and v."""
        forced, root = self.response, self.root
        wave = forced * cmath.exp(1j * tau)
        a, b = x - wave.real + sense * self.beta, v - (1j * wave).real
        free = complex(a, (root.real * a - b) / root.imag)

        def place(t):
            decay = free * np.exp(root * (t - tau))
            return (forced * np.exp(1j * t)).real - sense * self.beta + decay.real

        def speed(t):
            return (1j * forced * np.exp(1j * t) + free * root * np.exp(root * (t - tau))).real

        return place, speed

    def release(self, tau, x):
        """When a stop at x ends, and the sense after it: where |cos tau - x| rises to mu beta."""
        found = [(math.inf, 0)]
        for side in (1, -1):
            level = x + side * self.limit
            if abs(level) < 1.0:
                t = -side * math.acos(level)
                found.append((t + TWO_PI * math.ceil((tau - t) / TWO_PI), side))
        return min(found)

    def follow(self, tau, x, v, sense, end):
        """The state (x, v, sense) at `end`; sense 0 for a stop."""
        while True:
            load = math.cos(tau) - x
            if sense == 0 and abs(load) > self.limit:
                sense = 1 if load > 0.0 else -1
            elif sense == 0:
                tau, sense = self.release(tau, x)
                if tau >= end:
                    return x, 0.0, 0
            place, speed = self.slide(tau, x, v, sense)
            times = np.linspace(tau, end, max(8, int(SAMPLES * (end - tau) / TWO_PI)))
            ended = np.flatnonzero(sense * speed(times[1:]) <= 0.0)
            if not ended.size:
                return float(place(end)), float(speed(end)), sense
            first = times[ended[0]] if ended[0] else tau + 1e-3 * (times[1] - tau)
            tau = brentq(speed, first, times[ended[0] + 1], xtol=1e-15, rtol=1e-15)
            x, v = float(place(tau)), 0.0
            load = math.cos(tau) - x
            sense = 0 if abs(load) <= self.limit else (1 if load > 0.0 else -1)


def growth_of_a_distance(mass, r, cycles):
    """Exponent per cycle of two motions, brought together again every cycle, and its standard error."""
    motion = mass.follow(0.0, 0.0, 0.0, 0, SECTION)
    dx, dv = APART, 0.0
    growth = np.empty(cycles)
    for k in range(cycles):
        other = (motion[0] + dx, motion[1] + dv if motion[2] else 0.0, motion[2])
        motion, other = (mass.follow(SECTION, *one, SECTION + TWO_PI) for one in (motion, other))
        dx, dv = other[0] - motion[0], other[1] - motion[1]
        size = math.hypot(dx, r * dv)
        growth[k] = math.log(size / APART)
        dx, dv = APART / size * dx, APART / size * dv
    used = growth[cycles // 3 :]
    means = [part.mean() for part in np.array_split(used, 10)]
    return used.mean(), np.std(means, ddof=1) / math.sqrt(len(means))


@pytest.mark.parametrize(
    ("r", "zeta", "beta", "mu"),
    [
        (0.44835413476092023, 0.003, 0.15509277537623492, 2.364765966407888),
        (0.45112326145497167, 0.003, 0.17684502231404398, 1.6223289260452691),
        (0.36887494702214557, 0.001, 0.1681226207375457, 2.6527754983443814),
        (0.3582923284991711, 0.001, 0.1501280896758226, 2.7090535612906854),
    ],
)
def test_exponents_are_those_of_two_motions_side_by_side(r, zeta, beta, mu):
    ds = fm.sweep(fm.System(damping_ratios=zeta), [r], [beta], [mu], outputs=OUTPUTS)
    assert ds.status.item() == regimes.IRREGULAR
    wanted, error = growth_of_a_distance(Mass(r, zeta, beta, mu), r, 2000)
    own = ds.lyapunov_exponent_error.item()
    assert 0.0 < own < 0.1 * ds.lyapunov_exponent.item()
    assert abs(ds.lyapunov_exponent.item() - wanted) <= 3.0 * math.hypot(own, error)


@pytest.mark.parametrize(
    ("n", "zeta", "mu", "r", "beta"),
    [
        (2, 0.003, 2.6067566809382403, 1.1518939803197084, 0.31332332295090864),
        (2, 0.01, 2.486478316309865, 0.21255191411428181, 0.11585055639118932),
        (3, 0.01, 1.8552157598941497, 0.9814019117270365, 0.28253308217961365),
    ],
)
def test_the_opposite_load_has_the_same_exponent(n, zeta, mu, r, beta):
    """Its motion is the mirror image; the disturbances differ, but not after some cycles."""
    shared = {"mass_ratios": [1.0] * n, "stiffness_ratios": [1.0] * n, "damping_ratios": zeta}
    opposite = np.zeros(n)
    opposite[1] = -1.0
    one, other = (
        fm.sweep(fm.System(contact_masses=[2], **load, **shared), [r], [beta], [mu], outputs=OUTPUTS)
        for load in ({"load_mass": 2}, {"load": opposite})
    )
    assert one.status.item() == other.status.item() == regimes.IRREGULAR
    error = one.lyapunov_exponent_error.item()
    assert abs(one.lyapunov_exponent.item() - other.lyapunov_exponent.item()) <= 0.01 * error
