"""Steady motion of one mass with Coulomb friction on a base that moves with several harmonics, in doubles.

    x'' + 2 zeta w (x' - y') + w^2 (x - offset - y) + w^2 x_F sgn(z') = 0,   w = 2 pi f_n,   z = x or x - y

With q = x - offset, less y where the wall moves with the base, every slide is one damped oscillator under a
constant friction force and harmonic loads, and is evaluated in closed form; so is a stop, in which q is
constant.  With a spring in the contact the slider rests where the force in the spring is below the friction:
there the mass is an oscillator on both springs.  The ends of slides and stops are the first changes of sign
of the velocity and of the friction margin, which are sought on a grid and located with Brent's method.  The
motion is marched until its state repeats after one cycle.  Nothing here is shared with the package.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

#: Grid points per cycle of the natural frequency or of the highest harmonic, and points per search.
_POINTS, _BLOCK = 100, 200

#: A change of sign within the first step of a grid is sought again on a finer one, so many times.
_REFINEMENTS = 3

#: Cycles that are marched, and the change of the state over a cycle, over the base, that counts as none.
_CYCLES, _SETTLED = 400, 1e-9

#: Nodes of the Gauss-Legendre rule on each phase.
_NODES = 60


class Rig(NamedTuple):
    """One mass on a shaken base; lengths in the unit of the base."""

    f_n: float  # Hz
    zeta: float
    x_F: float  # noqa: N815  kinetic friction force over stiffness
    mu: float  # static over kinetic friction
    offset: float  # place of the unloaded mass on a base at its zero
    f: float  # Hz, of the base
    base: tuple[complex, ...]  # harmonics 0, 1, ...
    wall_moves: bool = False  # with the base
    damper_on_base: bool = True  # else on the ground
    spring: float = 0.0  # stiffness of a spring in the contact over that of the mass, mu = 1; 0: rigid


class Phase(NamedTuple):
    """A slide or a stop, with a spring a slip or an elastic phase: q(t) for begin <= t <= end in a cycle."""

    begin: float
    end: float
    place: Callable[[np.ndarray], np.ndarray]


class Steady(NamedTuple):
    """One cycle of the steady motion; `settled` is False if the state did not repeat."""

    rig: Rig
    phases: list[Phase]
    stops: int  # slips of a contact with a spring
    settled: bool

    def places(self, time: np.ndarray) -> np.ndarray:
        """x at `time` [s], shape (samples,)."""
        t = np.mod(time, 1.0 / self.rig.f)
        q = np.empty(t.size)
        for phase in self.phases:
            inside = (t >= phase.begin) & (t <= phase.end)
            q[inside] = phase.place(t[inside])
        wall = _sum(self.rig.base, self.rig.f, t) if self.rig.wall_moves else 0.0
        return q + self.rig.offset + wall

    def first_harmonic(self) -> complex:
        """X_1 of x = Re X_1 e^{2 pi i f t} + ..., by Gauss-Legendre quadrature over every phase."""
        nodes, weights = np.polynomial.legendre.leggauss(_NODES)
        total = 0j
        for begin, end, place in self.phases:
            t = 0.5 * (begin + end) + 0.5 * (end - begin) * nodes
            total += 0.5 * (end - begin) * np.sum(weights * place(t) * np.exp(-2j * np.pi * self.rig.f * t))
        return 2.0 * self.rig.f * total + (self.rig.base[1] if self.rig.wall_moves else 0.0)


def _sum(phasors: object, f: float, t: np.ndarray, derivative: int = 0) -> np.ndarray:
    """Re sum_n P_n (2 pi i n f)^derivative e^{2 pi i n f t}."""
    rates = 2j * np.pi * f * np.arange(len(phasors))
    return (np.exp(np.multiply.outer(t, rates)) @ (np.asarray(phasors) * rates**derivative)).real


def _first_change(
    function: Callable[[np.ndarray], np.ndarray], begin: float, end: float, step: float, refined: int = 0
) -> float:
    """Time at which a function that is positive just after `begin` first becomes negative; `end` if never."""
    left = begin
    while left < end:
        grid = np.minimum(left + step * np.arange(1, _BLOCK + 1), end)
        wrong = np.flatnonzero(function(grid) < 0.0)
        if wrong.size:
            right = grid[wrong[0]]
            last = grid[wrong[0] - 1] if wrong[0] else left
            if last > begin:
                return brentq(lambda t: function(np.array([t]))[0], last, right, xtol=1e-15)
            if refined == _REFINEMENTS:
                return right
            return _first_change(function, begin, right, step / _BLOCK, refined + 1)
        left = grid[-1]
    return end


class _Equation:
    """The oscillator in q, with its particular motion."""

    def __init__(self, rig: Rig) -> None:
        self.rig = rig
        self.w = 2.0 * np.pi * rig.f_n
        self.turn = turn = np.arange(len(rig.base)) * rig.f / rig.f_n
        spring = turn**2 if rig.wall_moves else np.ones(turn.size)
        damper = 2j * rig.zeta * turn * (int(rig.damper_on_base) - int(rig.wall_moves))
        self.load = np.array(rig.base) * (spring + damper)
        highest = max(rig.f_n * np.sqrt(1.0 + rig.spring), rig.f * max(1, len(rig.base) - 1))
        self.step = 1.0 / (_POINTS * highest)

    def slide(self, begin: float, q: float, speed: float, sense: float) -> tuple[Callable, Callable]:
        """q(t) and its velocity from a state, sliding in one direction."""
        return self.oscillation(begin, (q, speed), -sense * self.rig.x_F, 1.0)

    def oscillation(
        self, begin: float, state: tuple[float, float], centre: float, stiffness: float
    ) -> tuple[Callable, Callable]:
        """q(t) and its velocity from a state on a spring `stiffness` times as stiff, about a centre."""
        q, speed = state
        w, f = self.w * np.sqrt(stiffness), self.rig.f
        zeta = self.rig.zeta / np.sqrt(stiffness)
        d = w * np.sqrt(1.0 - zeta**2)
        at = np.array([begin])
        driven = self.load / (stiffness - self.turn**2 + 2j * self.rig.zeta * self.turn)
        a = q - centre - _sum(driven, f, at)[0]
        b = (speed - _sum(driven, f, at, 1)[0] + zeta * w * a) / d

        def place(t: np.ndarray) -> np.ndarray:
            u = t - begin
            free = np.exp(-zeta * w * u) * (a * np.cos(d * u) + b * np.sin(d * u))
            return centre + _sum(driven, f, t) + free

        def velocity(t: np.ndarray) -> np.ndarray:
            u = t - begin
            cosine, sine = np.cos(d * u), np.sin(d * u)
            free = np.exp(-zeta * w * u) * ((d * b - zeta * w * a) * cosine - (d * a + zeta * w * b) * sine)
            return _sum(driven, f, t, 1) + free

        return place, velocity

    def pull(self, t: np.ndarray, q: float) -> np.ndarray:
        """Load less spring force on the mass at rest at q, over the stiffness."""
        return _sum(self.load, self.rig.f, t) - q


def _cycle(equation: _Equation, q: float, speed: float) -> tuple[list[Phase], int, float, float]:
    """One cycle from a state: its segments, its stops and the state after it; at speed 0 it may stick."""
    rig, period, t = equation.rig, 1.0 / equation.rig.f, 0.0
    held = rig.mu * rig.x_F
    phases: list[Phase] = []
    stops = 0
    while t < period:
        begin = t
        if speed == 0.0:
            pull = equation.pull(np.array([t]), q)[0]
            if abs(pull) <= held:
                stops += int(t > 0.0)
                t = _first_change(lambda s, q=q: held - np.abs(equation.pull(s, q)), t, period, equation.step)
                phases.append(Phase(begin, t, lambda s, q=q: np.full(s.shape, q)))
                if t >= period:
                    break
                begin, pull = t, equation.pull(np.array([t]), q)[0]
            sense = np.sign(pull)
        else:
            sense = np.sign(speed)
        place, velocity = equation.slide(begin, q, speed, sense)
        t = _first_change(lambda s, v=velocity, sense=sense: sense * v(s), begin, period, equation.step)
        phases.append(Phase(begin, t, place))
        end = np.array([t])
        q, speed = float(place(end)[0]), float(velocity(end)[0]) if t >= period else 0.0
    return phases, stops, q, speed


def _elastic_cycle(
    equation: _Equation, q: float, speed: float, force: float, sense: float
) -> tuple[list[Phase], int, tuple[float, float, float, float]]:
    """One cycle from a state, with the force in the spring over the stiffness; sense 0: the slider rests."""
    rig, period, t = equation.rig, 1.0 / equation.rig.f, 0.0
    phases: list[Phase] = []
    slips = 0
    while t < period:
        begin = t
        if sense == 0.0:
            slider = q - force / rig.spring
            centre = rig.spring * slider / (1.0 + rig.spring)
            place, velocity = equation.oscillation(begin, (q, speed), centre, 1.0 + rig.spring)
            t = _first_change(
                lambda s, p=place, y=slider: rig.x_F - rig.spring * np.abs(p(s) - y), begin, period,
                equation.step,
            )  # fmt: skip
        else:
            place, velocity = equation.slide(begin, q, speed, sense)
            t = _first_change(lambda s, v=velocity, sense=sense: sense * v(s), begin, period, equation.step)
        phases.append(Phase(begin, t, place))
        end = np.array([t])
        q, speed = float(place(end)[0]), float(velocity(end)[0])
        if sense == 0.0:
            force = rig.spring * (q - slider)
            if t < period:
                sense = float(np.sign(force))
                force, slips = sense * rig.x_F, slips + 1
        elif t < period:
            sense, speed = 0.0, 0.0
    return phases, slips, (q, speed, force, sense)


def _steady_elastic(rig: Rig) -> Steady:
    """March a mass with a spring in its contact from a moving start until the state repeats."""
    equation = _Equation(rig)
    size = max(abs(one) for one in rig.base[1:])
    state = 0.0, size * rig.f, 0.0, 0.0
    for _ in range(_CYCLES):
        phases, slips, after = _elastic_cycle(equation, *state)
        rates = np.array([1.0, 2.0 * np.pi * rig.f, 1.0, 1.0])
        change = float(np.abs((np.array(after) - state) / rates).max())
        state = after
        if change < _SETTLED * size:
            return Steady(rig, phases, slips, True)
    return Steady(rig, phases, slips, False)


def steady(rig: Rig) -> Steady:
    """March from a moving start until the state repeats."""
    if rig.spring > 0.0:
        return _steady_elastic(rig)
    equation = _Equation(rig)
    size = max(abs(one) for one in rig.base[1:])
    q, speed = 0.0, size * rig.f
    for _ in range(_CYCLES):
        phases, stops, after, rate = _cycle(equation, q, speed)
        change = max(abs(after - q), abs(rate - speed) / (2.0 * np.pi * rig.f))
        q, speed = after, rate
        if change < _SETTLED * size:
            return Steady(rig, phases, stops, True)
    return Steady(rig, phases, stops, False)
