"""Free decays for tests: marched from the equation of motion, and synthetic records with noise."""

from typing import NamedTuple

import numpy as np
from scipy.integrate import solve_ivp


class Truth(NamedTuple):
    """A decay, in Hz, mm and s, and how it was measured."""

    f_n: float
    zeta: float
    x_F: float  # noqa: N815
    X0: float
    t0: float
    centre: float
    rate: float  # samples a second
    length: float  # s
    noise: float  # mm


def marched(truth, mu, time):
    """Places at `time` and half cycles, from x'' + 2 zeta w x' + w^2 (x - c) = -w^2 x_F sign(x')."""
    w = 2.0 * np.pi * truth.f_n
    places = np.full(time.size, truth.centre + truth.X0)
    begin, place, count = truth.t0, truth.X0, 0
    while abs(place) > mu * truth.x_F and begin < time[-1]:
        push = np.sign(place) * truth.x_F  # against the motion, which goes to the centre

        def slope(_, state, push=push):
            return [state[1], -2.0 * truth.zeta * w * state[1] - w**2 * (state[0] - push)]

        def turn(t, state, begin=begin, place=place):
            return state[1] if t > begin + 1e-6 else -np.sign(place)

        turn.terminal = True
        turn.direction = np.sign(place)
        span = (begin, begin + 2.0 / truth.f_n)
        run = solve_ivp(
            slope, span, [place, 0.0], "DOP853", events=turn, rtol=1e-12, atol=1e-13, dense_output=True
        )
        inside = (time >= begin) & (time <= run.t[-1])
        places[inside] = truth.centre + run.sol(time[inside])[0]
        begin, place, count = run.t[-1], run.y[0, -1], count + 1
        places[time > begin] = truth.centre + place
    return places, count


def synthetic(truth, seed, mu=1.0):
    """A record: closed form of every half cycle, with noise of its own for every seed."""
    time = np.arange(int(truth.rate * truth.length)) / truth.rate
    w, d = 2.0 * np.pi * truth.f_n, np.sqrt(1.0 - truth.zeta**2)
    half = np.pi / (w * d)
    x = np.full(time.size, truth.X0)  # held before t0
    begin, place = truth.t0, truth.X0
    while True:
        later = time >= begin
        x[later] = place
        if abs(place) <= mu * truth.x_F or begin > time[-1]:
            break
        push = np.sign(place) * truth.x_F
        u = w * (time[later] - begin)
        x[later] = push + (place - push) * np.exp(-truth.zeta * u) * (
            np.cos(d * u) + truth.zeta / d * np.sin(d * u)
        )
        place = push - (place - push) * np.exp(-np.pi * truth.zeta / d)
        begin += half
    noise = np.random.default_rng(seed).normal(0.0, truth.noise, time.size)
    return time, truth.centre + x + noise
