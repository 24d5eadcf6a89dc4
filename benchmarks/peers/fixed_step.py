"""Fixed-step methods that are common for dry friction, compiled.

The structure has unit masses. The coordinates are the displacements of the masses (for one mass, of the
contact):

    r^2 x'' + C x' + K x + e_j f = e_l (load_cos cos(tau) + load_sin sin(tau))

with f = beta sgn(x_j') while the contact slides and |f| <= mu beta while it sticks (x_j' = 0).

`march_rk4` is the classical Runge-Kutta method of order 4. It tests for sticking where x_j' has changed its
sign: at the end of the step or, with `located`, at the zero, found by regula falsi with shorter steps. A stop
ends in the same way. The load at the nodes is tabulated over a period. `march_moreau` is the time stepping of
Moreau and Jean with theta = 1/2: velocity and impulse are the unknowns, friction is implicit, and its impulse
is a projection on [-h beta, h beta]. It has no separate static coefficient: mu = 1.

All march from rest, x = x' = 0 at tau = 0, and report the last excitation period.
"""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from .body import SHORTEST_STOP, SLIDE_END, TWO_PI, Body, Cell, load_in_contact, matrices

#: Stops that a period can hold, at most, and parts that a step can be cut into by events.
MOST_STOPS = 64
_MOST_PARTS = 100
_HALVINGS = 50


class Problem(NamedTuple):
    """One structure at one frequency; see the module."""

    stiffness: np.ndarray  # (n, n)
    damping: np.ndarray  # (n, n), r C1
    inertia: float  # r^2
    contact: int  # counted from 0
    load: int
    load_cos: float
    load_sin: float
    beta: float
    mu: float


class Marched(NamedTuple):
    """Results of the last period: stops that begin in it, max |x_j|, and its state in the fastest slide."""

    stops: int
    peak: float
    begins: np.ndarray  # (MOST_STOPS,) tau at which they begin, from the start of the period
    tau: float  # of the state, in the period
    place: np.ndarray  # (n,)
    velocity: np.ndarray  # (n,)


def problem(body: Body, cell: Cell) -> Problem:
    """One cell of a body; a single mass in the displacement of its contact."""
    stiffness, damping = matrices(body)
    amplitude, phase = load_in_contact(body.wall, cell.r, body.zeta) if body.masses == 1 else (1.0, 0.0)
    return Problem(
        stiffness, cell.r * damping, cell.r**2, body.contact - 1, body.load - 1,
        amplitude * math.cos(phase), -amplitude * math.sin(phase), cell.beta, cell.mu,
    )  # fmt: skip


# ---------------------------------------------------------------- Runge-Kutta


@njit(cache=True, error_model="numpy")
def _load(p, tau):
    return p.load_cos * math.cos(tau) + p.load_sin * math.sin(tau)


@njit(cache=True, error_model="numpy")
def _holding_force(p, x, v, load):
    """Friction force that keeps the contact where it is."""
    j = p.contact
    force = load if p.load == j else 0.0
    for k in range(x.size):
        force -= p.stiffness[j, k] * x[k] + p.damping[j, k] * v[k]
    return force


@njit(cache=True, error_model="numpy")
def _accelerate(p, x, v, load, sign, a):
    """x'' while the contact slides in the direction `sign`; 0: while it sticks."""
    n = x.size
    for i in range(n):
        force = load if i == p.load else 0.0
        if i == p.contact:
            force -= sign * p.beta
        for k in range(n):
            force -= p.stiffness[i, k] * x[k] + p.damping[i, k] * v[k]
        a[i] = force / p.inertia
    if sign == 0:
        a[p.contact] = 0.0


@njit(cache=True, error_model="numpy")
def _rk4_one_mass(p, x, v, loads, h, friction, x_new, v_new):
    """Step of one mass, without loops; friction 0: it sticks."""
    if friction == 0.0:
        x_new[0], v_new[0] = x, v
        return
    square = 1.0 / p.inertia
    damping = p.damping[0, 0] * square
    square *= p.stiffness[0, 0]
    half = 0.5 * h
    pushes = ((loads[0] - friction) * square, (loads[1] - friction) * square, (loads[2] - friction) * square)
    a1 = pushes[0] - square * x - damping * v
    v2 = v + half * a1
    a2 = pushes[1] - square * (x + half * v) - damping * v2
    v3 = v + half * a2
    a3 = pushes[1] - square * (x + half * v2) - damping * v3
    v4 = v + h * a3
    a4 = pushes[2] - square * (x + h * v3) - damping * v4
    x_new[0] = x + h / 6.0 * (v + 2.0 * (v2 + v3) + v4)
    v_new[0] = v + h / 6.0 * (a1 + 2.0 * (a2 + a3) + a4)


@njit(cache=True, error_model="numpy")
def _rk4_step(p, x, v, loads, h, sign, x_new, v_new, scratch):
    """One step; loads at its start, middle and end; scratch (3, n): stage, its velocity, its acceleration."""
    n = x.size
    if n == 1:
        _rk4_one_mass(p, x[0], v[0], loads, h, sign * p.beta, x_new, v_new)
        return
    place, velocity, a = scratch[0], scratch[1], scratch[2]
    _accelerate(p, x, v, loads[0], sign, a)
    for i in range(n):
        x_new[i] = x[i] + h / 6.0 * v[i]
        v_new[i] = v[i] + h / 6.0 * a[i]
        place[i] = x[i] + 0.5 * h * v[i]
        velocity[i] = v[i] + 0.5 * h * a[i]
    for stage in range(2):
        _accelerate(p, place, velocity, loads[1], sign, a)
        reach = 0.5 * h if stage == 0 else h
        for i in range(n):
            x_new[i] += h / 3.0 * velocity[i]
            v_new[i] += h / 3.0 * a[i]
            place[i] = x[i] + reach * velocity[i]
            velocity[i] = v[i] + reach * a[i]
    _accelerate(p, place, velocity, loads[2], sign, a)
    for i in range(n):
        x_new[i] += h / 6.0 * velocity[i]
        v_new[i] += h / 6.0 * a[i]


@njit(cache=True, error_model="numpy")
def _left(p, x, v, load, sign):
    """Positive while the segment lasts: velocity along the slide, or remaining capacity of the contact to
    stick.
    """
    if sign != 0:
        return sign * v[p.contact]
    return p.mu * p.beta - abs(_holding_force(p, x, v, load))


@njit(cache=True, error_model="numpy")
def _part_step(p, x, v, tau, h, sign, x_new, v_new, scratch):
    """Step of any length from any time; returns `_left` at its end."""
    loads = (_load(p, tau), _load(p, tau + 0.5 * h), _load(p, tau + h))
    _rk4_step(p, x, v, loads, h, sign, x_new, v_new, scratch)
    return _left(p, x_new, v_new, loads[2], sign)


@njit(cache=True, error_model="numpy")
def _locate(p, x, v, tau, h, sign, x_new, v_new, scratch):
    """Length of the step to the end of the segment, by regula falsi (Illinois); sets the state there."""
    high = h
    left_high = _part_step(p, x, v, tau, high, sign, x_new, v_new, scratch)
    low = 0.0
    left_low = _left(p, x, v, _load(p, tau), sign)
    halvings = 0
    while left_low <= -SLIDE_END and halvings < _HALVINGS:  # the phase has just begun: a point inside it
        low = h * 0.5 ** (halvings + 1)
        left_low = _part_step(p, x, v, tau, low, sign, x_new, v_new, scratch)
        if left_low < 0.0:
            high, left_high = low, left_low
        halvings += 1
    side = 0
    middle = high
    for _ in range(_HALVINGS):
        middle = (low * left_high - high * left_low) / (left_high - left_low)
        left = _part_step(p, x, v, tau, middle, sign, x_new, v_new, scratch)
        if abs(left) <= 1e-15 or high - low <= 1e-15 * h:
            break
        if left > 0.0:
            low, left_low = middle, left
            left_high = 0.5 * left_high if side == 1 else left_high
            side = 1
        else:
            high, left_high = middle, left
            left_low = 0.5 * left_low if side == -1 else left_low
            side = -1
    return middle


@njit(cache=True, error_model="numpy")
def march_rk4(p, steps, cycles, located):
    """March `cycles` excitation periods with `steps` steps each."""
    n = p.stiffness.shape[0]
    j = p.contact
    h = TWO_PI / steps
    table = np.empty(2 * steps + 1)
    for k in range(2 * steps + 1):
        table[k] = _load(p, 0.5 * h * k)
    x, v, x_new, v_new = np.zeros(n), np.zeros(n), np.zeros(n), np.zeros(n)
    scratch = np.empty((3, n))
    place, velocity = np.zeros(n), np.zeros(n)
    begins = np.empty(MOST_STOPS)
    limit = p.mu * p.beta
    end_of_slide = SLIDE_END if located else 0.0
    force = _holding_force(p, x, v, table[0])
    sign = 0
    if abs(force) > limit:
        sign = 1 if force > 0.0 else -1
    began = -1.0  # of the stop that lasts; from the start of the last period
    stops = 0
    peak = 0.0
    fastest, at = 0.0, 0.0
    for cycle in range(cycles):
        since = TWO_PI * (cycle - cycles + 1)  # start of this period, from the start of the last one
        last = cycle == cycles - 1
        if last:
            peak = abs(x[j])
        for k in range(steps):
            done = 0.0
            for _ in range(_MOST_PARTS):
                if done == 0.0:
                    loads = (table[2 * k], table[2 * k + 1], table[2 * k + 2])
                    _rk4_step(p, x, v, loads, h, sign, x_new, v_new, scratch)
                    left = _left(p, x_new, v_new, loads[2], sign)
                else:
                    left = _part_step(p, x, v, k * h + done, h - done, sign, x_new, v_new, scratch)
                over = left <= end_of_slide if sign != 0 else left < 0.0
                length = h - done
                if over and located:
                    length = _locate(p, x, v, k * h + done, length, sign, x_new, v_new, scratch)
                done += length
                for i in range(n):
                    x[i] = x_new[i]
                    v[i] = v_new[i]
                if over:
                    now = k * h + done
                    if sign != 0:
                        v[j] = 0.0
                        peak = max(peak, abs(x[j]))
                    force = _holding_force(p, x, v, _load(p, now))
                    if sign == 0:
                        sign = 1 if force > 0.0 else -1
                        if began >= 0.0 and since + now - began > SHORTEST_STOP and stops < MOST_STOPS:
                            begins[stops] = began
                            stops += 1
                    elif abs(force) > limit:
                        sign = 1 if force > 0.0 else -1
                    else:
                        sign = 0
                        began = since + now
                if not (over and located) or done >= h:
                    break
            if last:
                peak = max(peak, abs(x[j]))
                if abs(v[j]) > fastest:
                    fastest, at = abs(v[j]), (k + 1) * h
                    place[:] = x
                    velocity[:] = v
    if sign == 0 and began >= 0.0 and stops < MOST_STOPS:
        begins[stops] = began
        stops += 1
    return Marched(stops, peak, begins, at, place, velocity)


# ---------------------------------------------------------------- Moreau-Jean


@njit(cache=True, error_model="numpy")
def march_moreau(p, inverse, steps, cycles):
    """March with the theta scheme; `inverse` is that of r^2 + h C/2 + h^2 K/4, shape (n, n).

    A stop is a run of at least two sticking steps, because a reversal takes one.
    """
    n = p.stiffness.shape[0]
    j = p.contact
    h = TWO_PI / steps
    table = np.empty(steps)  # mean load over a step
    for k in range(steps):
        table[k] = 0.5 * (_load(p, h * k) + _load(p, h * (k + 1)))
    x, v, free = np.zeros(n), np.zeros(n), np.zeros(n)
    begins = np.empty(MOST_STOPS)
    most = h * p.beta
    sticking = 0  # steps in a row
    began = -1.0
    stops = 0
    peak = 0.0
    for cycle in range(cycles):
        if cycle == cycles - 1:
            peak = abs(x[j])
        since = TWO_PI * (cycle - cycles + 1)
        for k in range(steps):
            for i in range(n):
                free[i] = table[k] if i == p.load else 0.0
                for m in range(n):
                    free[i] -= p.stiffness[i, m] * (x[m] + 0.5 * h * v[m]) + p.damping[i, m] * v[m]
            rate = v[j]  # of the contact at the end of the step, if nothing rubbed
            for m in range(n):
                rate += h * inverse[j, m] * free[m]
            impulse = max(-most, min(most, rate / inverse[j, j]))
            sticks = abs(impulse) < most
            for i in range(n):
                new = v[i] - inverse[i, j] * impulse
                for m in range(n):
                    new += h * inverse[i, m] * free[m]
                if sticks and i == j:
                    new = 0.0
                x[i] += 0.5 * h * (v[i] + new)
                # the velocities at the start of the step are no longer needed once `free` is known
                v[i] = new
            if sticks:
                if sticking == 0:
                    began = since + (k + 1) * h
                sticking += 1
            else:
                if sticking > 1 and began >= 0.0 and stops < MOST_STOPS:
                    begins[stops] = began
                    stops += 1
                sticking = 0
            if cycle == cycles - 1:
                peak = max(peak, abs(x[j]))
    if sticking > 1 and began >= 0.0 and stops < MOST_STOPS:
        begins[stops] = began
        stops += 1
    return stops, peak, begins


def moreau_inverse(p: Problem, steps: int) -> np.ndarray:
    """Inverse that `march_moreau` needs."""
    h = TWO_PI / steps
    inertia = p.inertia * np.eye(p.stiffness.shape[0])
    return np.linalg.inv(inertia + 0.5 * h * p.damping + 0.25 * h * h * p.stiffness)
