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


def marched_signal(truth, order, time, low_pass=None, ac_coupling=None):
    """What a sensor shows at `time`: motion and filters integrated together, without noise; mu = 1.

    order : 0 displacement from the centre, 1 velocity, 2 acceleration, in mm and s
    low_pass : (1 or 2, Hz), of order 2 with the damping ratio 1/sqrt(2); ac_coupling : Hz, of order 1
    """
    w, corner = 2.0 * np.pi * truth.f_n, 2.0 * np.pi * (low_pass[1] if low_pass else 0.0)
    couple = 2.0 * np.pi * (ac_coupling or 0.0)

    def output(state, push, moving):
        slope = -2.0 * truth.zeta * w * state[1] - w**2 * (state[0] - push)
        raw = (state[0], state[1], slope if moving else 0.0 * slope)[order]
        return raw if low_pass is None else state[2]

    def slopes(_, state, push, moving):
        acceleration = -2.0 * truth.zeta * w * state[1] - w**2 * (state[0] - push) if moving else 0.0
        raw = (state[0], state[1], acceleration)[order]
        filtered, rate = raw, 0.0
        first = second = 0.0
        if low_pass and low_pass[0] == 1:
            first, filtered = corner * (raw - state[2]), state[2]
        elif low_pass:
            first, rate, filtered = state[3], state[3], state[2]
            second = corner**2 * (raw - state[2]) - np.sqrt(2.0) * corner * rate
        return [state[1] * moving, acceleration, first, second, couple * (filtered - state[4])]

    held = truth.X0 if order == 0 else 0.0
    state, begin = np.array([truth.X0, 0.0, held, 0.0, held]), truth.t0
    shown = np.full(time.size, 0.0 if ac_coupling else held)
    while begin < time[-1]:
        moving = abs(state[0]) > truth.x_F
        push = np.sign(state[0]) * truth.x_F

        side = np.sign(state[0])

        def turn(t, state, push, moving, begin=begin, side=side):
            return state[1] if moving and t > begin + 1e-6 else -side

        turn.terminal, turn.direction = True, side
        end = begin + 1.0 / truth.f_n if moving else time[-1] + 1.0
        run = solve_ivp(
            slopes, (begin, end), state, "DOP853", args=(push, moving), events=turn, rtol=1e-11, atol=1e-12,
            dense_output=True,
        )  # fmt: skip
        inside = (time >= begin) & (time <= run.t[-1])
        states = run.sol(time[inside])
        shown[inside] = output(states, push, moving) - (states[4] if ac_coupling else 0.0)
        begin, state = run.t[-1], run.y[:, -1] * [1.0, 0.0, 1.0, 1.0, 1.0]
    return shown


def simulate_falling(time, omega, zeta, friction, slope, first=9.0):
    """Places of a mass let go at `first` under friction x_F (1 + slope V) and damping: Runge-Kutta steps."""
    place, y, begin = np.full(time.size, np.nan), [first, 0.0], 0.0
    while begin < time[-1] and abs(y[0]) > friction:
        side = -np.sign(y[0])

        def rates(_, y, side=side):
            pull = side * friction * (1.0 + slope * abs(y[1]))
            return [y[1], -(omega**2) * (y[0] + pull) - 2.0 * zeta * omega * y[1]]

        def turn(_, y, side=side):
            return side * y[1]

        turn.terminal, turn.direction = True, -1.0
        found = solve_ivp(rates, (begin, time[-1]), y, rtol=1e-9, atol=1e-11, events=turn, dense_output=True,
                          first_step=1e-5)  # fmt: skip
        inside = (time >= begin) & (time <= found.t[-1])
        place[inside] = found.sol(time[inside])[0]
        begin, y = found.t[-1], [found.y[0, -1], 0.0]
    return np.where(np.isnan(place), y[0], place)
