"""Records with known true values: steady motions of `references.shaken`, identified by `record`."""

from collections.abc import Callable
from functools import lru_cache, partial

import numpy as np

import frictionmap as fm

from ...references.shaken import Rig, Steady, steady
from .case import Case, Made, robust
from .disturbances import clipped, outliers, wander, without_gap

#: Samples per second, length [s], and standard deviations of the noise of mass and base [mm].
RATE, LENGTH = 80.0, 8.0
NOISE, BASE_NOISE = 0.01, 0.003

#: The record of the specification, which sticks and slips, and the same with more static friction.
STICK_SLIP = Rig(3.13, 0.0055, 0.8372, 1.0, -0.1, 1.001, (0.0, 1.82 * np.exp(0.7j), 0.02 * np.exp(2.0j)))
STATIC = STICK_SLIP._replace(mu=1.25)

#: Parameters that are fitted with a spring in the contact.
_OF_SPRING = ["f_n", "zeta", "x_F", "contact_stiffness", "offset_x"]

#: Rigs are drawn anew until the motion repeats after one cycle, at most so often.
_DRAWS = 20

#: Times and places of the mass as they are measured in the end, and which samples there are.
Disturbed = tuple[np.ndarray, np.ndarray]
Disturbance = Callable[[np.random.Generator, Rig, np.ndarray, np.ndarray], Disturbed]

settled = lru_cache(maxsize=4)(steady)


def _random(rng: np.random.Generator, heavy: bool = False) -> Rig:
    """Random rig with a base frequency of 0.8 to 1.6 Hz, a quarter to 1.6 times the natural frequency."""
    f, r = rng.uniform(0.8, 1.6), 10.0 ** rng.uniform(-0.6, 0.2)
    wall_moves = bool(rng.uniform() < 0.3)
    zeta = rng.uniform(0.08, 0.12) if heavy else rng.uniform(0.002, 0.05)
    turns = np.exp(2j * np.pi * rng.uniform(size=3))
    amplitude = rng.uniform(0.5, 3.0)
    base = (0.02 * amplitude, *(amplitude * np.array([1.0, 0.011, 0.003]) * turns))
    friction = rng.uniform(0.15, 0.65) * amplitude * (r**2 if wall_moves else 1.0)
    return Rig(
        f / r, zeta, friction, 1.0, rng.uniform(-0.3, 0.3), f, base, wall_moves, bool(rng.uniform() < 0.5)
    )


def _with_spring(rng: np.random.Generator) -> Rig:
    """Random rig with a spring in its contact."""
    rig = _random(rng)
    return rig._replace(spring=10.0 ** rng.uniform(-0.3, 1.3))


def _settled(rng: np.random.Generator, draw: Callable[[np.random.Generator], Rig]) -> Steady:
    """Steady motion of a rig whose motion has the period of the base, and whose elastic contact slips."""
    for _ in range(_DRAWS):
        motion = settled(draw(rng))
        if motion.settled and (motion.stops or not motion.rig.spring):
            return motion
    raise RuntimeError(f"none of {_DRAWS} rigs settled")


def measured(rng: np.random.Generator, motion: Steady) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Times, base and mass, both with noise."""
    rig, time = motion.rig, np.arange(int(RATE * LENGTH)) / RATE
    base = np.exp(2j * np.pi * rig.f * np.multiply.outer(time, np.arange(len(rig.base)))) @ np.array(rig.base)
    shakes = base.real + rng.normal(0.0, BASE_NOISE, time.size)
    return time, shakes, motion.places(time) + rng.normal(0.0, NOISE, time.size)


def _made(
    rng: np.random.Generator,
    draw: Callable[[np.random.Generator], Rig] = _random,
    change: Disturbance | None = None,
    known: dict[str, float] | None = None,
    **arguments: object,
) -> Made:
    """Add noise to a steady motion, then a disturbance of the mass."""
    motion = _settled(rng, draw)
    rig = motion.rig
    time, shakes, x = measured(rng, motion)
    kept = np.ones(time.size, dtype=bool)
    if change is not None:
        kept, x = change(rng, rig, time, x)
    truth = {"f_n": rig.f_n, "zeta": rig.zeta, "x_F": rig.x_F, "mu": rig.mu, "offset_x": rig.offset}
    if rig.spring:
        del truth["mu"]
        truth["contact_stiffness"] = rig.spring
        known, arguments = {}, {"free": _OF_SPRING, **arguments}
    truth["beta"] = rig.x_F / abs(rig.base[1])
    words = {
        "contact": "joined-base-wall" if rig.wall_moves else "fixed-wall",
        "damping_reference": "base" if rig.damper_on_base else "ground",
        "known": {"mu": 1.0} if known is None else known,
    }
    return Made(truth, lambda: fm.identify.record(time[kept], shakes[kept], x[kept], **words, **arguments))


def _all(time: np.ndarray) -> np.ndarray:
    return np.ones(time.size, dtype=bool)


def _gap(rng: np.random.Generator, rig: Rig, time: np.ndarray, x: np.ndarray) -> Disturbed:
    """Gap of 1 to 1.5 cycles of the base, in both channels."""
    length = rng.uniform(1.0, 1.5) / rig.f
    return without_gap(time, rng.uniform(0.1, LENGTH - length - 0.1), length), x


def _drift(rng: np.random.Generator, rig: Rig, time: np.ndarray, x: np.ndarray) -> Disturbed:
    """Drift of the zero of the mass of up to 0.05 mm/s; the offset is that at the middle of the record."""
    return _all(time), x + rng.uniform(-0.05, 0.05) * (time - np.mean(time[[0, -1]]))


def _wander(rng: np.random.Generator, rig: Rig, time: np.ndarray, x: np.ndarray) -> Disturbed:
    return _all(time), x + wander(rng, time, NOISE)


def _outliers(rng: np.random.Generator, rig: Rig, time: np.ndarray, x: np.ndarray) -> Disturbed:
    return _all(time), x + outliers(rng, time.size, NOISE)


def _clipped(rng: np.random.Generator, rig: Rig, time: np.ndarray, x: np.ndarray) -> Disturbed:
    """Limit the range of the mass to 80 to 95 % of its amplitude."""
    return _all(time), clipped(x, float(np.mean(x)), rng.uniform(0.8, 0.95))


CASES = (
    Case("noise only", _made),
    Case("gap of 1 to 1.5 cycles", partial(_made, change=_gap)),
    Case("drift of the mass", partial(_made, change=_drift)),
    Case("wander of the zero", partial(_made, change=_wander)),
    Case("outliers", partial(_made, change=_outliers, **robust(fm.identify.record))),
    Case("clipped", partial(_made, change=_clipped)),
    Case("zeta 0.08 to 0.12", partial(_made, draw=partial(_random, heavy=True))),
    Case("mu 1.25, fitted", partial(_made, draw=lambda rng: STATIC, known={}), 100),
    Case("spring in the contact", partial(_made, draw=_with_spring), 100),
)
