"""Steady motions of one mass with a spring in its contact for tests: its equation of motion integrated."""

from typing import NamedTuple

import numpy as np
from scipy.integrate import solve_ivp


class Truth(NamedTuple):
    """One mass on a base of amplitude 1 and a fixed wall; the damper acts on the base, omega_n = 1."""

    r: float
    beta: float
    zeta: float
    kt: float


def cycle(truth, state, sense):
    """One cycle from a state (x, x', place of the slider): its parts, and the state and sense after it."""
    r, beta, zeta, kt = truth
    period, t = 2.0 * np.pi / r, 0.0
    parts = []

    def slope(t, y, sense):
        force = kt * (y[0] - y[2]) if sense == 0 else sense * beta
        base, speed = np.cos(r * t), -r * np.sin(r * t)
        return [y[1], base - y[0] + 2.0 * zeta * (speed - y[1]) - force, y[1] if sense else 0.0]

    def limit(side):
        def event(t, y, sense):
            return side * kt * (y[0] - y[2]) - beta

        event.terminal, event.direction = True, 1
        return event

    def turn(t, y, sense):
        return sense * y[1]

    turn.terminal, turn.direction = True, -1
    while t < period:
        events = [turn] if sense else [limit(1), limit(-1)]
        run = solve_ivp(
            slope, (t, period), state, "DOP853", args=(sense,), events=events, dense_output=True,
            rtol=1e-12, atol=1e-13, max_step=0.1 * min(1.0, 1.0 / np.sqrt(kt)),
        )  # fmt: skip
        parts.append((t, run.t[-1], run.sol))
        t, state = run.t[-1], run.y[:, -1].copy()
        if run.status == 1:
            sense = 0 if sense else (1 if run.t_events[0].size else -1)
    return parts, state, sense


def steady(truth, cycles=400, accuracy=1e-10):
    """The parts of a cycle that changes nothing."""
    state, sense = np.array([0.0, 0.1, 0.0]), 0
    for _ in range(cycles):
        parts, after, sense = cycle(truth, state, sense)
        change = np.abs(after - state).max()
        state = after
        if change < accuracy:
            return parts
    raise AssertionError(f"a cycle still changes the state by {change:.1e}")


def first_harmonic(truth):
    """X_1 over the base."""
    nodes, weights = np.polynomial.legendre.leggauss(40)
    total = 0j
    for begin, end, place in steady(truth):
        t = 0.5 * (begin + end) + 0.5 * (end - begin) * nodes
        total += 0.5 * (end - begin) * np.sum(weights * place(t)[0] * np.exp(-1j * truth.r * t))
    return truth.r / np.pi * total
