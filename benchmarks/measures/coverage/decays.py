"""Free decays with known true values: closed form by half cycles, identified by `free_decay`."""

from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import numpy as np

import frictionmap as fm

from .case import Case, Made, cramer_rao, robust
from .disturbances import clipped, outliers, wander, without_gap


class Decay(NamedTuple):
    """A decay and its sampling; Hz, mm, s."""

    f_n: float
    zeta: float
    x_F: float  # noqa: N815
    X0: float
    t0: float
    centre: float
    mu: float = 1.0
    noise: float = 0.03
    rate: float = 200.0
    length: float = 4.0

    @property
    def half(self) -> float:
        """Time between turning points."""
        return 0.5 / (self.f_n * np.sqrt(1.0 - self.zeta**2))


#: Times and places as they are measured in the end, and further parameters.
Disturbed = tuple[np.ndarray, np.ndarray, dict[str, float]]
Disturbance = Callable[[np.random.Generator, Decay, np.ndarray, np.ndarray], Disturbed]

#: Fitted parameters, the first ones of `Decay`.
PARAMETERS = Decay._fields[:6]

#: Decays of the specification, one that gaps and one that heavy damping made hard to fit.
MIXED = Decay(3.086, 0.012, 0.15, 12.0, -0.02, -0.4, 1.0, 0.03, 250.0, 6.0)
NOISY = Decay(3.13, 0.006, 0.4, 10.0, -0.05, 0.1, 1.0, 0.4, 100.0, 3.5)
WITH_GAP = Decay(3.0, 0.01, 0.5, 10.0, -0.02, 0.0, 2.0, 0.03)
HEAVY = Decay(1.2, 0.3, 0.2, 10.0, -0.05, 0.1, 1.0, 0.05, 200.0, 5.0)

#: Where the gaps of the third one begin [s]: before it rests.
PLACES = np.linspace(0.05, 1.5, 45)


def _next(decay: Decay, place: float) -> float:
    """Next turning point: X_{j+1} = -q X_j + (1 + q) s_j x_F, from the centre."""
    q = np.exp(-np.pi * decay.zeta / np.sqrt(1.0 - decay.zeta**2))
    return -q * place + (1.0 + q) * np.sign(place) * decay.x_F


def half_cycles(decay: Decay) -> int:
    """Number of half cycles before rest, or before the end of the record."""
    place, count = decay.X0, 0
    while abs(place) > decay.mu * decay.x_F and decay.t0 + count * decay.half < decay.length:
        place, count = _next(decay, place), count + 1
    return count


def places(decay: Decay, count: int, time: np.ndarray) -> np.ndarray:
    """Displacement without noise: held before t0, at rest after `count` half cycles."""
    points = [decay.X0]
    for _ in range(count):
        points.append(_next(decay, points[-1]))
    d = np.sqrt(1.0 - decay.zeta**2)
    j = np.clip(np.floor((time - decay.t0) / decay.half).astype(int), 0, count)
    u = 2.0 * np.pi * decay.f_n * np.maximum(time - decay.t0 - j * decay.half, 0.0)
    begin = np.array(points)[j]
    about = np.sign(begin) * decay.x_F
    swing = np.exp(-decay.zeta * u) * (np.cos(d * u) + decay.zeta / d * np.sin(d * u))
    return decay.centre + np.where(j == count, begin, about + (begin - about) * swing)


def _made(
    rng: np.random.Generator,
    draw: Callable[[np.random.Generator], Decay],
    change: Disturbance | None = None,
    **arguments: object,
) -> Made:
    """Add noise to a decay, then a disturbance; the bound is that of the noise on the remaining samples."""
    decay = draw(rng)
    time, count = np.arange(int(decay.rate * decay.length)) / decay.rate, half_cycles(decay)
    x = places(decay, count, time) + rng.normal(0.0, decay.noise, time.size)
    truth = {name: getattr(decay, name) for name in PARAMETERS}
    if change is not None:
        time, x, more = change(rng, decay, time, x)
        truth |= more

    def model(values: np.ndarray) -> np.ndarray:
        own, drift = np.split(values, [len(PARAMETERS)])
        one = decay._replace(**dict(zip(PARAMETERS, own.tolist(), strict=True)))
        return places(one, count, time) + np.sum(drift) * time

    bound = cramer_rao(model, truth, decay.noise)
    return Made(truth, lambda: fm.identify.free_decay(time, x, **arguments), bound)


def light(rng: np.random.Generator, noise: float | None = None) -> Decay:
    """Random decay with light damping; noise as a share of the first amplitude, or some 0.01 mm."""
    f_n, zeta = rng.uniform(1.5, 5.0), 10.0 ** rng.uniform(-2.5, -1.5)
    first = rng.choice([-1.0, 1.0]) * rng.uniform(6.0, 12.0)
    sigma = rng.uniform(0.02, 0.05) if noise is None else noise * abs(first)
    return Decay(
        f_n, zeta, abs(first) * rng.uniform(0.01, 0.05), first, _first_turn(rng) / (2.0 * f_n),
        rng.uniform(-0.5, 0.5), rng.uniform(1.0, 2.0), sigma,
    )  # fmt: skip


def _first_turn(rng: np.random.Generator) -> float:
    """Half cycles from the first sample to t0: moving, or held before; near 0 both give one record."""
    return float(rng.uniform(-0.4, -0.1) if rng.uniform() < 0.8 else rng.uniform(0.1, 0.5))


def _heavy(rng: np.random.Generator) -> Decay:
    """Random decay with a damping ratio of about 0.3, which has about four half cycles."""
    mild, f_n = light(rng), rng.uniform(1.0, 3.0)
    return mild._replace(
        f_n=f_n, zeta=rng.uniform(0.25, 0.35), x_F=abs(mild.X0) * rng.uniform(0.01, 0.03),
        t0=_first_turn(rng) / (2.0 * f_n),
    )  # fmt: skip


def _gap(rng: np.random.Generator, decay: Decay, time: np.ndarray, x: np.ndarray) -> Disturbed:
    """Gap of 1 to 1.6 cycles, after the first half cycle and before rest."""
    length = 2.0 * decay.half * rng.uniform(1.0, 1.6)
    rests = min(decay.t0 + decay.half * half_cycles(decay), decay.length)
    left = without_gap(time, rng.uniform(decay.half, max(rests - length, 2.0 * decay.half)), length)
    return time[left], x[left], {}


def _gap_of(length: float) -> Disturbance:
    """Gap of the given number of seconds at one of `PLACES`."""

    def change(rng: np.random.Generator, decay: Decay, time: np.ndarray, x: np.ndarray) -> Disturbed:
        left = without_gap(time, rng.choice(PLACES), length)
        return time[left], x[left], {}

    return change


def _drift(rng: np.random.Generator, decay: Decay, time: np.ndarray, x: np.ndarray) -> Disturbed:
    """Drift of up to 0.2 mm/s, to be found by the fit."""
    slope = rng.uniform(-0.2, 0.2)
    return time, x + slope * time, {"drift": slope}


def _wander(rng: np.random.Generator, decay: Decay, time: np.ndarray, x: np.ndarray) -> Disturbed:
    return time, x + wander(rng, time, decay.noise), {}


def _outliers(rng: np.random.Generator, decay: Decay, time: np.ndarray, x: np.ndarray) -> Disturbed:
    return time, x + outliers(rng, time.size, decay.noise), {}


def _clipped(rng: np.random.Generator, decay: Decay, time: np.ndarray, x: np.ndarray) -> Disturbed:
    """Limit the range to 60 to 90 % of the first amplitude."""
    return time, clipped(x, decay.centre, rng.uniform(0.6, 0.9)), {}


def _fixed(decay: Decay) -> Callable[[np.random.Generator], Decay]:
    return lambda rng: decay


CASES = (
    Case("noise only", partial(_made, draw=light)),
    Case("gap of 1 to 1.6 cycles", partial(_made, draw=light, change=_gap)),
    Case("drift, fitted", partial(_made, draw=light, change=_drift, drift=True)),
    Case("wander of the zero", partial(_made, draw=light, change=_wander)),
    Case("outliers", partial(_made, draw=light, change=_outliers, **robust(fm.identify.free_decay))),
    Case("clipped", partial(_made, draw=light, change=_clipped)),
    Case("zeta 0.25 to 0.35", partial(_made, draw=_heavy)),
    Case("4 % noise", partial(_made, draw=partial(light, noise=0.04))),
    *(
        Case(
            f"gap of {gap:g} s, 3 Hz, zeta 0.01, mu 2",
            partial(_made, draw=_fixed(WITH_GAP), change=_gap_of(gap)),
            135,
        )
        for gap in (0.35, 0.5, 0.7)
    ),
    Case("zeta 0.3, 1.2 Hz", partial(_made, draw=_fixed(HEAVY)), 100),
    Case("decay-noisy", partial(_made, draw=_fixed(NOISY)), 100),
    Case("decay-mixed", partial(_made, draw=_fixed(MIXED)), 100),
)
