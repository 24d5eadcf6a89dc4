"""Records of a mass whose friction is not that of the model: elastic contact, or falling with speed."""

from typing import NamedTuple

import numpy as np


class Rig(NamedTuple):
    """One mass on a shaken base, in Hz, mm and s."""

    x_F: float  # noqa: N815  friction at high speed, over the stiffness
    rise: float = 0.0  # static over that, less 1
    fall: float = 8.0  # speed [mm/s] over which it falls
    contact: float = 40.0  # stiffness of the contact, over that of the spring
    f_n: float = 3.13
    zeta: float = 0.0055
    f: float = 1.0
    base: tuple = (0.0, 1.82 * np.exp(0.7j), 0.02 * np.exp(2.0j))


#: Samples per second, length [s], noise of mass and base [mm], cycles until the motion is steady.
RATE, LENGTH, NOISE, BASE_NOISE, SETTLED = 250, 10, 0.005, 0.003, 12

#: Steps per sample; the contact spring swings in 8 ms.
_STEPS = 16


def measured(rig, seed):
    """Times, base and mass: one cycle marched until it repeats, in all cycles, with noise."""
    time = np.arange(RATE * LENGTH + 1) / RATE
    n = np.arange(len(rig.base))
    base = (np.exp(2j * np.pi * rig.f * np.multiply.outer(time, n)) @ np.array(rig.base)).real
    rng = np.random.default_rng(seed)
    x = np.interp(np.mod(time, 1.0 / rig.f), *_cycle(rig))
    return time, base + rng.normal(0.0, BASE_NOISE, time.size), x + rng.normal(0.0, NOISE, time.size)


def _cycle(rig):
    """Phases [s] and places of the last of some cycles, by the symplectic Euler method."""
    steps = int(RATE * _STEPS / rig.f)
    dt = 1.0 / (rig.f * steps)
    t = np.arange(steps + 1) * dt
    n = np.arange(len(rig.base))
    turns = np.exp(2j * np.pi * rig.f * np.multiply.outer(t, n))
    shakes = (turns @ np.array(rig.base)).real.tolist()
    speeds = (turns @ (2j * np.pi * rig.f * n * np.array(rig.base))).real.tolist()
    w = 2.0 * np.pi * rig.f_n
    x = v = slip = 0.0
    places = np.empty(steps + 1)
    for _ in range(SETTLED):
        for k in range(steps):
            places[k] = x
            most = rig.x_F * (1.0 + rig.rise * np.exp(-abs(v) / rig.fall))
            force = rig.contact * (x - slip)
            if abs(force) > most:
                force = most if force > 0.0 else -most
                slip = x - force / rig.contact
            v += dt * (w * w * (shakes[k] - x - force) - 2.0 * rig.zeta * w * (v - speeds[k]))
            x += dt * v
        places[steps] = x
    return t, places
