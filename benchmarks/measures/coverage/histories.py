"""Records of any shape with known true values: a mass is marched in small steps, identified by `history`.

The matrix exponential of the mass and of a cubic load gives every small step; turns, stops and starts are
roots in it. Bases are sums of waves or a rising sine, not the splines that the package draws through their
samples; the blows of a hammer are a spline, as a force that a gate cuts has no other shape.
"""

from collections.abc import Callable, Mapping
from functools import partial
from typing import NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.linalg import expm
from scipy.optimize import brentq

import frictionmap as fm

from .case import Case, Made

#: Small steps between two samples, and samples of a record.
_FINE, _SAMPLES = 20, 600

#: True values are drawn between the nominal ones over this and times this; mu by its distance from one.
_SPREAD = 1.2

#: Time before the first sample at which the mass is released [s]: its state at the first sample is unknown.
_LEAD = 1.0

#: Waves of a random drive.
_WAVES = 16

#: Small steps by which the mass is read later than the base, least and most.
_DELAYS = 3, 9

#: Blows of a hammer: times [s], peaks [N], length [s]; samples below the least force are 0.
_BLOWS, _BLOW, _LEAST_FORCE = ((0.1, 400.0), (1.3, -300.0)), 0.04, 4.0

Shape = Callable[[np.random.Generator, np.ndarray], np.ndarray]


class Mass(NamedTuple):
    """A mass on a spring, with friction; mm and s."""

    w: float
    zeta: float
    x_F: float  # noqa: N815
    mu: float = 1.0


class March:
    """u'' + 2 zeta w u' + w^2 (u + x_F sgn(u')) = w^2 p, p a cubic in every small step."""

    def __init__(self, mass: Mass, step: float, load: np.ndarray) -> None:
        """load : p at the ends of small steps, shape (n + 1,)"""
        self.mass, self.step = mass, step
        self.matrix = np.diag([1.0, 0.0, 1.0, 1.0, 1.0], 1)  # of u, u', p, p', p'', p'''
        self.matrix[1, :3] = -(mass.w**2), -2.0 * mass.zeta * mass.w, mass.w**2
        self.p = CubicSpline(np.arange(load.size) * step, load).c[::-1].T * [1.0, 1.0, 2.0, 6.0]
        self.u, self.v, self.side = (np.zeros(load.size) for _ in range(3))

    def _inside(self, k: int, side: float, state: np.ndarray, begin: float, end: float) -> np.ndarray:
        """u and u' at one time of a step from those at another, (2,)."""
        p = expm(self.matrix[2:, 2:] * begin) @ self.p[k]
        p[0] -= side * self.mass.x_F
        return (expm(self.matrix * (end - begin)) @ np.concatenate((state, p)))[:2]

    def _pull(self, k: int, u: float, time: float) -> float:
        """Force of spring and load over the stiffness, at rest."""
        return float((expm(self.matrix[2:, 2:] * time) @ self.p[k])[0]) - u

    def _next(self, k: int, side: float, state: np.ndarray, begin: float) -> tuple[float, np.ndarray, float]:
        """The side, state and time after the next event in a step, or at its end."""
        if side == 0.0:
            over = self.mass.mu * self.mass.x_F

            def excess(time: float) -> float:
                return abs(self._pull(k, state[0], time)) - over

            if excess(self.step) <= 0.0:
                return side, state, self.step
            at = begin if excess(begin) >= 0.0 else float(brentq(excess, begin, self.step))
            return float(np.sign(self._pull(k, state[0], at))), state, at
        end = self._inside(k, side, state, begin, self.step)
        if side * end[1] > 0.0:
            return side, end, self.step

        def speed(time: float) -> float:
            return side * float(self._inside(k, side, state, begin, time)[1])

        soon = begin + 1e-6 * (self.step - begin)  # it begins with speed 0 after a start or turn
        at = float(brentq(speed, soon, self.step)) if speed(soon) > 0.0 else soon
        u = self._inside(k, side, state, begin, at)[0]
        pull = self._pull(k, u, at)
        stays = abs(pull) <= self.mass.mu * self.mass.x_F
        return 0.0 if stays else float(np.sign(pull)), np.array([u, 0.0]), at

    def run(self) -> "March":
        """From rest at 0."""
        whole = expm(self.matrix * self.step)[:2]
        forced = self.p @ whole[:, 2:].T
        own, friction = whole[:, :2], whole[:, 2] * self.mass.x_F
        side, state = 0.0, np.zeros(2)
        for k in range(self.u.size - 1):
            end = own @ state + forced[k] - side * friction
            if side != 0.0 and side * end[1] > 0.0:
                state = end
            else:
                time = 0.0
                while time < self.step:
                    side, state, time = self._next(k, side, state, time)
            self.u[k + 1], self.v[k + 1], self.side[k + 1] = *state, side
        return self


def accelerations(march: March) -> np.ndarray:
    """u'' at the ends of small steps."""
    mass, load = march.mass, np.append(march.p[:, 0], np.nan)
    moving = mass.w**2 * (load - march.u - march.side * mass.x_F) - 2.0 * mass.zeta * mass.w * march.v
    return np.where(march.side != 0.0, moving, 0.0)


def _waves(rng: np.random.Generator, time: np.ndarray, band: tuple[float, float], size: float) -> np.ndarray:
    """Waves of normal amplitudes with frequencies in a band [Hz], of a standard deviation."""
    frequency, parts = rng.uniform(*band, _WAVES), rng.normal(size=(2, _WAVES))
    parts *= size * np.sqrt(2.0) / np.linalg.norm(parts)
    phase = 2.0 * np.pi * np.multiply.outer(time, frequency)
    return np.cos(phase) @ parts[0] + np.sin(phase) @ parts[1]


def _run_up(rng: np.random.Generator, time: np.ndarray) -> np.ndarray:
    """A sine whose frequency rises from 0.7 to 6 Hz in 7.5 s."""
    return 1.5 * np.cos(2.0 * np.pi * (0.7 * time + 0.5 * (5.3 / 7.5) * time**2 + rng.uniform()))


def _quake(rng: np.random.Generator, time: np.ndarray) -> np.ndarray:
    """Accelerations [mm/s^2] that grow and die away in 6 s."""
    return np.sin(np.pi * np.clip(time / 6.0, 0.0, 1.0)) ** 2 * _waves(rng, time, (0.5, 6.0), 1200.0)


def _hammer(rng: np.random.Generator, time: np.ndarray) -> np.ndarray:
    """Two blows [N], as a spline through the samples that are above a gate."""
    samples = time[::_FINE]
    force = np.zeros(samples.size)
    for begin, peak in _BLOWS:
        share = np.clip((samples - begin - rng.uniform(0.0, 0.1)) / _BLOW, 0.0, 1.0)
        force += peak * rng.uniform(0.8, 1.0) * np.sin(np.pi * share) ** 2
    return np.asarray(CubicSpline(samples, np.where(np.abs(force) < _LEAST_FORCE, 0.0, force))(time))


class Test(NamedTuple):
    """What drives a mass, what is fitted, and the noise of the mass and of what drives it."""

    truth: Mapping[str, float]
    shape: Shape
    noise: tuple[float, float]
    rate: float = 80.0
    kind: str = "base"  # or "force", or "acceleration" of the base on which the mass rubs


def _drawn(rng: np.random.Generator, nominal: Mapping[str, float]) -> dict[str, float]:
    truth = {name: value * _SPREAD ** rng.uniform(-1.0, 1.0) for name, value in nominal.items()}
    if "mu" in truth:
        truth["mu"] = 1.0 + (nominal["mu"] - 1.0) * _SPREAD ** rng.uniform(-1.0, 1.0)
    return truth


def marched(test: Test, truth: Mapping[str, float], step: float, drive: np.ndarray) -> np.ndarray:
    """What the sensor of the mass shows at the ends of small steps, without noise [mm or m/s^2]."""
    w, zeta = 2.0 * np.pi * truth["f_n"], truth["zeta"]
    mass = Mass(w, zeta, truth["x_F"], truth.get("mu", 1.0))
    if test.kind == "acceleration":
        return 1e-3 * (accelerations(March(mass, step, -drive / w**2).run()) + drive)
    load = drive / truth.get("stiffness", 1.0)
    if test.kind == "base":
        load = load + 2.0 * zeta / w * CubicSpline(np.arange(drive.size) * step, drive)(
            np.arange(drive.size) * step, 1
        )
    return truth.get("gain", 1.0) * March(mass, step, load).run().u + truth["offset_x"]


def _made(rng: np.random.Generator, test: Test) -> Made:
    """A mass with values near the nominal ones."""
    truth, step = _drawn(rng, test.truth), 1.0 / (test.rate * _FINE)
    later = int(rng.integers(*_DELAYS)) if "delay" in truth else 0
    if later:
        truth["delay"] = later * step
    lead = round(_LEAD / step) if test.kind == "base" else 0
    drive = test.shape(rng, (np.arange(lead + _SAMPLES * _FINE + 1) - lead) * step)
    x = marched(test, truth, step, drive)
    at = lead + _FINE * np.arange(_SAMPLES)
    size = 1e-3 if test.kind == "acceleration" else 1.0
    x = x[at - later] + rng.normal(0.0, test.noise[0], _SAMPLES)
    seen = size * drive[at] + rng.normal(0.0, test.noise[1], _SAMPLES)
    options: dict[str, object] = {"base": seen, "damping_reference": "base"}
    if test.kind == "force":
        options = {"force": seen, "gate": 0.5 * _LEAST_FORCE}
    if test.kind == "acceleration":
        options |= {"units": ("m/s^2", "m/s^2"), "contact": "joined-base-wall"}
    known = {} if "mu" in truth else {"mu": 1.0}
    options |= {"sigma_x": test.noise[0], "sigma_drive": test.noise[1], "known": known, "free": list(truth)}
    return Made(truth, lambda: fm.identify.history(np.arange(_SAMPLES) / test.rate, x, **options))


def _mass(f_n: float, zeta: float, x_F: float, **others: float) -> dict[str, float]:  # noqa: N803
    return {"f_n": f_n, "zeta": zeta, "x_F": x_F, "offset_x": 0.2, **others}


_RANDOM = partial(_waves, band=(0.5, 5.0), size=1.1)

#: The tests, by their names.
TESTS = {
    "random base": Test(_mass(3.1, 0.01, 0.8), _RANDOM, (0.02, 0.004)),
    "run-up": Test(_mass(3.1, 0.012, 0.6), _run_up, (0.02, 0.004)),
    "accelerations of a quake": Test(
        {"f_n": 1.6, "zeta": 0.03, "x_F": 4.0}, _quake, (0.015, 0.004), 100.0, "acceleration"
    ),
    "delay and gain": Test(_mass(2.7, 0.015, 0.5, delay=0.004, gain=1.05), _RANDOM, (0.02, 0.004)),
    "hammer, gate": Test(_mass(5.0, 0.01, 0.25, stiffness=12.0), _hammer, (0.01, 0.4), 250.0, "force"),
    "static friction": Test(
        _mass(3.1, 0.008, 0.8, mu=1.25), partial(_waves, band=(0.3, 3.5), size=1.2), (0.015, 0.003)
    ),
    "noise of the base": Test(
        _mass(3.1, 0.006, 0.6), partial(_waves, band=(0.5, 4.5), size=1.5), (0.01, 0.06)
    ),
}

#: Seeds of a test: a fit takes half a second.
_SEEDS = 200

CASES = tuple(Case(name, partial(_made, test=test), _SEEDS) for name, test in TESTS.items())
