"""Steady states of one mass in doubles, from the equation of motion alone: event-exact, compiled.

A segment (slide or stop) is followed in steps by its Taylor series, whose coefficients follow recursively
from the equation of motion. The series of the velocity is sampled inside every step, minima between samples
are examined, and the first zero is polished. A stop of one mass ends at a time given by an arccos. The march
continues from rest until the state repeats.
"""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from ..peers.body import SHORTEST_STOP, TWO_PI

#: Terms of the series, for steps of at most half a radian of the fastest part of the motion.
TERMS = 18
RADIANS = 0.5
_SAMPLES = 8
_SHORTEST_STEP = 1e-6
_MOST_EVENTS = 10_000

#: A steady state may repeat after so many periods.
LONGEST_PERIOD = 8


class Settled(NamedTuple):
    """Result of `settle`; `period` is 0 if the state did not repeat in time."""

    period: int  # excitation periods
    stops: float  # a cycle; nan where the contact sticks for good
    amplitude: float
    cycles: int
    shortest: float  # least length of a stop in the steady state
    residual: float
    stuck_fraction: float  # of the time in the steady state


@njit(cache=True, error_model="numpy")
def _series(place, velocity, cosine, sine, damping, square, friction, h, x, v):
    """Series of a slide in tau over h: x'' = square (load - friction - x) - damping x'.

    cosine, sine : F cos and F sin of the phase of the load, at the start
    """
    x[0] = place
    v[0] = velocity
    for k in range(TERMS - 1):
        constant = friction if k == 0 else 0.0
        step = h / (k + 1.0)
        x[k + 1] = step * v[k]
        v[k + 1] = step * (square * (cosine - constant - x[k]) - damping * v[k])
        cosine, sine = -step * sine, step * cosine


@njit(cache=True, error_model="numpy")
def _sum(a, t):
    total = 0.0
    for k in range(TERMS - 1, -1, -1):
        total = total * t + a[k]
    return total


@njit(cache=True, error_model="numpy")
def _slope(a, t):
    total = 0.0
    for k in range(TERMS - 1, 0, -1):
        total = total * t + k * a[k]
    return total


@njit(cache=True, error_model="numpy")
def _bisect(a, low, high, sense, derivative):
    """Time at which sense times the series (or its derivative) falls from positive to not positive."""
    for _ in range(60):
        middle = 0.5 * (low + high)
        value = _slope(a, middle) if derivative else _sum(a, middle)
        if sense * value > 0.0:
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)


@njit(cache=True, error_model="numpy")
def _first_fall(a, sign, fresh):
    """First t in (0, 1] at which sign times the series is no longer positive; 2.0 if it remains positive."""
    bend = 0.0
    for k in range(1, TERMS):
        bend += k * abs(a[k])
    left = 0.0
    value_left = sign * a[0]
    slope_left = sign * a[1]
    begun = not fresh
    for m in range(1, _SAMPLES + 1):
        right = m / _SAMPLES
        value = sign * _sum(a, right)
        slope = sign * _slope(a, right)
        if value <= 0.0:
            if begun or value_left > 0.0:
                return _bisect(a, left, right, sign, False)
            # the slide has just begun: it rises to a top inside, and falls from there
            if slope_left >= 0.0 > slope:
                top = _bisect(a, left, right, sign, True)
                if sign * _sum(a, top) > 0.0:
                    return _bisect(a, top, right, sign, False)
            return left
        near = 0.5 * bend / _SAMPLES
        if begun and slope_left < 0.0 < slope and min(value_left, value) < near:
            low = _bisect(a, left, right, -sign, True)
            if sign * _sum(a, low) <= 0.0:
                return _bisect(a, left, low, sign, False)
        begun = True
        left, value_left, slope_left = right, value, slope
    return 2.0


@njit(cache=True, error_model="numpy")
def _release(load, limit, tau, phase, z):
    """Length of a stop at z from tau, and the direction after it; the contact was able to stick."""
    wait = math.inf
    sign = 0
    theta = tau + phase
    if z + limit < load:
        wait = (-math.acos(max((z + limit) / load, -1.0)) - theta) % TWO_PI
        sign = 1
    if z - limit > -load:
        back = (math.acos(min((z - limit) / load, 1.0)) - theta) % TWO_PI
        if back < wait:
            wait = back
            sign = -1
    if wait > TWO_PI - 1e-9:  # rounding put it in the past
        wait = 0.0
    return wait, sign


@njit(cache=True, error_model="numpy")
def settle(r, zeta, load, phase, beta, mu, most_cycles, tolerance):
    """March one mass from rest under load cos(tau + phase) until the remaining change is below the tolerance.

    z'' = (load cos(tau + phase) - beta sgn(z') - z)/r^2 - 2 zeta z'/r
    """
    square = 1.0 / (r * r)
    damping = 2.0 * zeta / r
    limit = mu * beta
    h_most = RADIANS * min(1.0, r, r / (2.0 * zeta) if zeta > 0.0 else 1.0)
    x, v = np.empty(TERMS), np.empty(TERMS)
    memory = np.zeros((LONGEST_PERIOD + 1, 3))  # z, r z' and direction at tau = 0 of the last periods
    counts = np.zeros(LONGEST_PERIOD + 1)  # stops that began, by period
    peaks = np.zeros(LONGEST_PERIOD + 1)
    shorts = np.full(LONGEST_PERIOD + 1, math.inf)
    stuck = np.zeros(LONGEST_PERIOD + 1)  # time in stops
    before = np.full(LONGEST_PERIOD + 1, math.inf)  # residuals a while ago
    z, w, tau = 0.0, 0.0, 0.0
    sign = 0
    push = load * math.cos(phase)
    wait = 0.0
    if abs(push) > limit:
        sign = 1 if push > 0.0 else -1
    else:
        wait, sign = _release(load, limit, 0.0, phase, 0.0)
        if sign == 0:
            return Settled(1, math.nan, 0.0, 0, math.inf, 0.0, 1.0)
    fresh = True
    residual = math.inf
    for cycle in range(1, most_cycles + 1):
        slot = cycle % (LONGEST_PERIOD + 1)
        counts[slot], peaks[slot], shorts[slot], stuck[slot] = 0.0, abs(z), math.inf, 0.0
        events = 0
        while tau < TWO_PI:
            if wait > 0.0:
                passed = min(wait, TWO_PI - tau)
                wait -= passed
                stuck[slot] += passed
                tau = TWO_PI if wait > 0.0 else tau + passed
                continue
            # a dip soon after the start is the one to miss: short steps there
            h = min(0.125 * h_most if fresh else h_most, TWO_PI - tau)
            angle = tau + phase
            _series(
                z, w, load * math.cos(angle), load * math.sin(angle), damping, square, sign * beta, h, x, v
            )
            # a slide that has just begun does not end at once: what is below rounding is not looked at
            t = 2.0 if fresh and h < _SHORTEST_STEP else _first_fall(v, sign, fresh)
            if t > 1.0:
                z, w = _sum(x, 1.0), _sum(v, 1.0)
                tau = TWO_PI if h == TWO_PI - tau else tau + h
                fresh = fresh and h < _SHORTEST_STEP
                peaks[slot] = max(peaks[slot], abs(z))
                continue
            events += 1
            if events > _MOST_EVENTS:
                return Settled(0, math.nan, math.nan, cycle, 0.0, math.inf, math.nan)
            z, w = _sum(x, t), 0.0
            tau += t * h
            peaks[slot] = max(peaks[slot], abs(z))
            fresh = True
            push = load * math.cos(tau + phase) - z
            if abs(push) > limit:
                sign = 1 if push > 0.0 else -1
            else:
                wait, sign = _release(load, limit, tau, phase, z)
                if sign == 0:
                    return Settled(1, math.nan, 0.0, cycle, math.inf, 0.0, 1.0)
                if wait > SHORTEST_STOP:
                    counts[slot] += 1.0
                    shorts[slot] = min(shorts[slot], wait)
        tau = 0.0
        memory[slot, 0], memory[slot, 1], memory[slot, 2] = z, r * w, wait
        scale = max(peaks[slot], 1e-3 * load)
        for period in range(1, min(LONGEST_PERIOD, cycle - 1) + 1):
            other = (slot - period) % (LONGEST_PERIOD + 1)
            residual = math.hypot(z - memory[other, 0], r * w - memory[other, 1]) + abs(
                wait - memory[other, 2]
            )
            rate = (residual / before[period]) ** (period / 16.0) if cycle > 40 else 1.0
            if cycle % 16 == 0:
                before[period] = residual
            done = residual <= 4e-16 * scale
            if not done and rate < 1.0 and cycle % 16 == 0:
                done = residual * rate / (1.0 - rate) <= tolerance * scale
            if done:
                stops, peak, short, still = 0.0, 0.0, math.inf, 0.0
                for k in range(period):
                    place = (slot - k) % (LONGEST_PERIOD + 1)
                    stops += counts[place]
                    peak = max(peak, peaks[place])
                    short = min(short, shorts[place])
                    still += stuck[place] / (TWO_PI * period)
                return Settled(period, stops / period, peak, cycle, short, residual, still)
    return Settled(
        0, counts[slot], peaks[slot], most_cycles, shorts[slot], residual, stuck[slot] / TWO_PI
    )  # fmt: skip
