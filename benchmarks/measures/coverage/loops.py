"""Damper tests with known true values: friction is marched in small steps, identified by `loop`."""

from collections.abc import Mapping, Sequence
from functools import partial
from typing import NamedTuple

import numpy as np

import frictionmap as fm

from .case import Case, Made

#: Small steps between two samples; their error at turning points is 1e-3 of the noise at most.
_FINE = 20

#: True values are drawn between the nominal ones over this and times this.
_SPREAD = 1.2

#: Parameters of which the distance from one is drawn so.
_OF_ONE = ("mu", "factor_1", "factor_2")

#: Of u, u' and u'' in mm, mm/s and mm/s^2: forces in N of springs in N/mm, of dampers, of masses in kg.
_SCALES = np.array([1.0, 1.0, 1e-3])


class Actuator(NamedTuple):
    """A displacement A cos(phase) [mm], or a triangle, of one frequency or of two."""

    amplitude: float
    frequency: float  # Hz
    last: float | None = None  # Hz, at the end
    joined: bool = False  # it has the last frequency from the middle on, or its frequency rises to that
    triangle: bool = False

    def phase(self, begin: float, time: np.ndarray, length: float) -> np.ndarray:
        """Phase and its derivatives by time, shape (3, times); `begin`: at time 0."""
        last = self.frequency if self.last is None else self.last
        first, change = 2.0 * np.pi * self.frequency, 2.0 * np.pi * (last - self.frequency)
        if not self.joined:
            rate = change / length
            return np.array(
                [begin + first * time + 0.5 * rate * time**2, first + rate * time, np.full(time.size, rate)]
            )
        turns = np.round((0.5 * first * length + begin) / np.pi)  # joined where it turns back
        later = np.maximum(time - (turns * np.pi - begin) / first, 0.0)
        return np.array([begin + first * time + change * later, first + change * (later > 0.0), 0.0 * time])

    def corners(self, begin: float, end: float) -> np.ndarray:
        """Times at which a triangle turns, which must be among the small steps."""
        if not self.triangle:
            return np.empty(0)
        half_turns = np.arange(1, int(2.0 * self.frequency * end) + 3)
        times = (half_turns * np.pi - begin) / (2.0 * np.pi * self.frequency)
        return times[(times > 0.0) & (times < end)]

    def motion(self, begin: float, time: np.ndarray, length: float) -> np.ndarray:
        """Displacement, velocity and acceleration, shape (3, times)."""
        phase, speed, change = self.phase(begin, time, length)
        sine, cosine = np.sin(phase), np.cos(phase)
        if self.triangle:
            share = 2.0 / np.pi
            return self.amplitude * np.array(
                [share * np.arcsin(cosine), -share * speed * np.sign(sine), 0.0 * time]
            )
        return self.amplitude * np.array([cosine, -speed * sine, -(speed**2) * cosine - change * sine])


class Damper(NamedTuple):
    """A damper, how it is moved, and what is fitted; N, mm, s, kg."""

    truth: Mapping[str, float]
    actuator: Actuator
    noise: tuple[float, float]  # of the motion and of the force
    rate: float = 200.0
    length: float = 6.4
    speeds: tuple[float, ...] | None = None  # knots of the speed law
    velocity: bool = False
    steps: tuple[float, float] | None = None  # of the converters of the motion and of the force
    known: tuple[str, ...] = ()
    bounded: Mapping[str, float] = {}  # true values that are not drawn: only bounds of them are fitted


def marched(
    truth: Mapping[str, float], speeds: Sequence[float] | None, u: np.ndarray, v: np.ndarray
) -> np.ndarray:
    """Force of the contact [N]: its spring follows every small step, until friction is overcome."""
    play, mu = 0.5 * truth.get("backlash", 0.0), truth.get("mu", 1.0)
    stiffness, asymmetry = truth["contact_stiffness"], truth.get("asymmetry", 0.0)
    strength = {sense: truth["friction"] * (1.0 + sense * asymmetry) for sense in (-1.0, 1.0)}
    knots = speeds or (0.0,)
    g = np.interp(np.abs(v), knots, [1.0, *(truth[f"factor_{k}"] for k in range(1, len(knots)))])
    force, carried, slips = np.empty(u.size), 0.0, 0.0
    for k, step in enumerate(np.diff(u, prepend=u[0])):
        sense = 1.0 if step > 0.0 else -1.0
        if slips and sense != slips:
            carried, slips = slips * (strength[slips] / stiffness + play), 0.0
        carried += step
        if not slips and sense * carried >= max(mu, g[k]) * strength[sense] / stiffness + play:
            slips = sense
        stretched = np.sign(carried) * max(abs(carried) - play, 0.0)
        force[k] = slips * strength[slips] * g[k] if slips else stiffness * stretched
    return force


def measured(
    rng: np.random.Generator, test: Damper, truth: Mapping[str, float]
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Times, the motion and the force with noise."""
    count, delay = int(test.rate * test.length), truth.get("delay", 0.0)
    fine = np.arange(count * _FINE) / (test.rate * _FINE)
    time, begin = fine[::_FINE], rng.uniform(0.0, 2.0 * np.pi)
    every = np.union1d(fine, test.actuator.corners(begin, float(fine[-1])) + delay)
    later = test.actuator.motion(begin, every - delay, test.length)
    beside = [truth.get(name, 0.0) for name in ("parallel_stiffness", "slope", "mass")] @ (
        later.T * _SCALES
    ).T
    force = (marched(truth, test.speeds, later[0], later[1]) + beside)[np.searchsorted(every, time)]
    force += truth.get("offset", 0.0) + truth.get("drift", 0.0) * (time - delay)
    moved = test.actuator.motion(begin, time, test.length)[int(test.velocity)]
    channels = [
        values + rng.normal(0.0, noise, count)
        for values, noise in zip((moved, force), test.noise, strict=True)
    ]
    if test.steps:
        channels = [np.round(one / step) * step for one, step in zip(channels, test.steps, strict=True)]
    return time, channels[0], channels[1]


def _made(rng: np.random.Generator, test: Damper) -> Made:
    """A damper with values near the nominal ones; its intervals of bounds count as well."""
    truth = {name: value * _SPREAD ** rng.uniform(-1.0, 1.0) for name, value in test.truth.items()}
    for name in truth:
        if name in _OF_ONE:
            truth[name] = 1.0 + (test.truth[name] - 1.0) * _SPREAD ** rng.uniform(-1.0, 1.0)
    truth |= test.bounded
    time, moved, force = measured(rng, test, truth)
    known = {name: truth[name] for name in test.known}
    arguments = {
        "velocity" if test.velocity else "displacement": moved,
        "known": known,
        "free": [name for name in truth if name not in known],
        "law_speeds": test.speeds,
    }
    return Made(truth, lambda: fm.identify.loop(time, force, **arguments))


def _contact(friction: float, stiffness: float, **others: float) -> dict[str, float]:
    return {"friction": friction, "contact_stiffness": stiffness, "offset": 2.0, **others}


_SINE, _RISING = Actuator(2.0, 0.6), Actuator(2.0, 0.4, 2.0)

#: The tests, by their names.
TESTS = {
    "sine": Damper(_contact(120.0, 400.0), _SINE, (0.004, 0.6)),
    "triangle": Damper(_contact(120.0, 400.0), Actuator(2.0, 0.6, triangle=True), (0.004, 0.6)),
    "play, and friction that depends on the direction": Damper(
        _contact(60.0, 150.0, backlash=0.3, asymmetry=0.08), _SINE, (0.003, 0.4)
    ),
    "static friction": Damper(_contact(80.0, 250.0, mu=1.25), _SINE, (0.003, 0.5), rate=157.3, length=8.0),
    "spring beside, and drift": Damper(
        _contact(200.0, 900.0, parallel_stiffness=25.0, drift=0.4), _SINE, (0.003, 1.5)
    ),
    "viscous damping, rising frequency": Damper(
        _contact(50.0, 200.0, parallel_stiffness=4.0, slope=0.6), _RISING, (0.003, 0.4)
    ),
    "speed law, rising frequency": Damper(
        _contact(100.0, 300.0, factor_1=0.8, factor_2=0.65), Actuator(4.0, 0.3, 2.0), (0.005, 0.6),
        speeds=(0.0, 15.0, 60.0),
    ),
    "mass and delay, two frequencies": Damper(
        _contact(90.0, 350.0, parallel_stiffness=6.0, mass=4.0, delay=0.003),
        Actuator(2.0, 0.9, 4.5, joined=True), (0.002, 0.5), rate=400.0, length=3.4,
    ),
    "known mass, coarse converters": Damper(
        _contact(45.0, 120.0, parallel_stiffness=2.0, mass=2.5), Actuator(1.5, 1.0), (0.004, 0.3),
        rate=250.0, length=4.8, steps=(0.01, 1.0), known=("mass",),
    ),
    "velocity": Damper(_contact(70.0, 180.0, slope=0.3), _RISING, (0.05, 0.6), velocity=True),
    "nearly rigid contact": Damper(
        {"friction": 40.0, "parallel_stiffness": 1.0, "offset": 2.0}, Actuator(5.0, 0.8), (0.01, 0.5),
        rate=100.0, bounded={"contact_stiffness": 3e4},
    ),
}  # fmt: skip

#: Seeds of every test.
_SEEDS = 200

CASES = tuple(Case(name, partial(_made, test=test), _SEEDS) for name, test in TESTS.items())
