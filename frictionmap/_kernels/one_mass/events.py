"""Events of the normalised oscillator: the end of a slide, and what follows it.

The equation of motion keeps its form when (z, z', cos, sin) all change sign.  Every slide is therefore
followed upwards: a state that is about to move down is *mirrored* first.
"""

import math
from typing import NamedTuple

import numpy as np

from ..compiler import entry, inner_kernel, kernel
from ..compiler.vectors import LANES, LEADING, RAMP, delayed, lane, least, load, mask_above
from ..event_codes import GRAZING, NO_END, REVERSE, STOP_THEN_BACK, STOP_THEN_ON, STUCK
from ..taylor_series import MAX_POLISH, MAX_TERMS, NEARLY, ONE_STEP, cubic_root, first_root, reversion
from .scan_step import TURNS, expand


class Scratch(NamedTuple):
    """Arrays that kernels write into."""

    series: np.ndarray  # (MAX_TERMS,)
    left: np.ndarray  # (1,) number of scan steps that may still be taken


@entry
def make_scratch():
    """Allocate scratch arrays for one mass, without a limit on scan steps."""
    return Scratch(np.empty(MAX_TERMS), np.full(1, np.inf))


#: 1/(k+1): from the series of the velocity to that of the displacement.
_INVERSE = np.array([1.0 / (k + 1.0) for k in range(MAX_TERMS)])


@kernel
def _sum_at(p, terms, x):
    """Evaluate the polynomial p at x, and its integral from 0; even and odd powers are summed in parallel."""
    square = x * x
    even = odd = even_rise = odd_rise = 0.0
    top = terms - 1 - (terms - 1) % 2  # the highest even power
    if top + 1 < terms:
        odd = p[top + 1]
        odd_rise = p[top + 1] * _INVERSE[top + 1]
    even = p[top]
    even_rise = p[top] * _INVERSE[top]
    for k in range(top - 2, -1, -2):
        even = even * square + p[k]
        odd = odd * square + p[k + 1]
        even_rise = even_rise * square + p[k] * _INVERSE[k]
        odd_rise = odd_rise * square + p[k + 1] * _INVERSE[k + 1]
    return even + odd * x, (even_rise + odd_rise * x) * x


@kernel
def _at_root(step, b, z, c, s, x, work):
    """Refine the zero of the velocity next to x, by Newton steps of fourth order.

    The derivatives follow from the equation of motion; one step reduces an error of 1e-4 to rounding.

    Parameters
    ----------
    step : Step
    b : kinetic friction over load amplitude
    z : displacement at the start of the step
    c, s : cosine and sine of the load phase there
    x : first guess inside the step
    work : (terms,) Taylor coefficients of the velocity

    Returns
    -------
    (x, z, cos, sin) : position in the step, displacement and load phase at the zero
    """
    for _ in range(MAX_POLISH):
        velocity, rise = _sum_at(work, step.terms, x)
        displacement = z + rise
        angle = step.h * x
        cosine = math.cos(angle)
        sine = math.sin(angle)
        c1 = cosine * c - sine * s
        s1 = cosine * s + sine * c
        acceleration = step.stiffness * (c1 - b - displacement) - step.damping * velocity
        jerk = -step.stiffness * (s1 * step.h + velocity) - step.damping * acceleration
        if (
            not abs(velocity) < NEARLY * abs(acceleration)
            or not abs(velocity * jerk) < NEARLY * acceleration * acceleration
        ):
            break  # the velocity only touches zero; the reversion diverges, and x cannot be improved
        snap = -step.stiffness * (c1 * step.h * step.h + acceleration) - step.damping * jerk
        move = reversion(velocity, acceleration, jerk, snap)
        x += move
        if abs(move) < ONE_STEP:
            displacement += move * (
                velocity
                + move * (0.5 * acceleration + move * (jerk * (1.0 / 6.0) + move * snap * (1.0 / 24.0)))
            )
            angle = step.h * move
            less = 0.5 * angle * angle
            more = angle - angle * less * (1.0 / 3.0)
            c2 = c1 - more * s1 - less * c1
            s1 = s1 + more * c1 - less * s1
            c1 = c2
            break
    norm = 1.5 - 0.5 * (c1 * c1 + s1 * s1)  # back to the unit circle
    return x, displacement, norm * c1, norm * s1


@inner_kernel
def _steps_above(step, b, z, w, acceleration, c, s, error, error_growth, first):
    """How many of the next eight steps the velocity certainly stays above zero.

    Parameters
    ----------
    step : Step
    b : kinetic friction over load amplitude
    z, w, acceleration, c, s : state at the present node and load phase there, see `slide`
    error, error_growth : largest error of the cubic in the first step, and its growth per step
    first : 0, or in the first step of a slide from rest: 1 if the velocity rises in it, 2 if it may not

    Returns
    -------
    (passed, z, w, acceleration, w1, acceleration1) : number of steps; the state at the node after them, and
        the velocity and acceleration at the node after that
    """
    ahead = step.ahead
    speed = z * load(ahead, LANES) + w * load(ahead, 4 * LANES) + c * load(ahead, 7 * LANES)
    speed = speed + (s * load(ahead, 10 * LANES) - b * load(ahead, 13 * LANES))
    bend = z * load(ahead, 2 * LANES) + w * load(ahead, 5 * LANES) + c * load(ahead, 8 * LANES)
    bend = bend + (s * load(ahead, 11 * LANES) - b * load(ahead, 14 * LANES))
    start = delayed(w, speed)
    left = start + delayed(acceleration, bend) * (1.0 / 3.0)
    right = speed - bend * (1.0 / 3.0)
    lowest = least(least(start, speed), least(left, right))
    above = mask_above(lowest, error + error_growth * load(RAMP, 0))
    if first > 0:
        above = (above & ~1) | (first & 1)
    passed = LEADING[above]
    after = min(passed, LANES - 1)
    w1, acceleration1 = lane(speed, after), lane(bend, after)
    if passed > 0:
        place = z * load(ahead, 0) + w * load(ahead, 3 * LANES) + c * load(ahead, 6 * LANES)
        place = place + (s * load(ahead, 9 * LANES) - b * load(ahead, 12 * LANES))
        z, w, acceleration = lane(place, passed - 1), lane(speed, passed - 1), lane(bend, passed - 1)
    return passed, z, w, acceleration, w1, acceleration1


@inner_kernel
def _turned_by(step, steps, c, s):
    """Rotate the load phase by 1 to 8 steps."""
    turn_c, turn_s = step.ahead[TURNS + steps - 1], step.ahead[TURNS + LANES + steps - 1]
    return turn_c * c - turn_s * s, turn_c * s + turn_s * c


@kernel
def slide(step, b, z, w, acceleration, c, s, max_steps, work):
    """Follow an upward slide from (z, w >= 0) to the first zero of the velocity.

    Parameters
    ----------
    step : Step
    b : kinetic friction over load amplitude
    z, w, acceleration : state; `acceleration` = h^2 z'' exactly, > 0, or 0 with a rising load where w = 0
    c, s : cosine and sine of the load phase
    max_steps : scan steps allowed
    work : (MAX_TERMS,) scratch

    Returns
    -------
    (steps, z, c, s) : `steps` is the number of scan steps taken, including a fraction; NO_END if no zero was
        found

    Notes
    -----
    A step is passed without a closer look when the cubic through the velocities and accelerations at its ends
        has Bernstein coefficients above the cubic's largest error, max|w''''|/384, which follows from the
        energy of the motion of z'': no dip of the velocity can be missed.
    """
    stiffness, damping, h = step.stiffness, step.damping, step.h
    omega = math.sqrt(stiffness)
    square = h * h
    # |z3| + omega |z2| can grow by the load only: by stiffness h^2 per step.  (zk: k-th x-derivative)
    jerk = -stiffness * (s * h + w) - damping * acceleration
    energy = omega * abs(acceleration) + abs(jerk)
    growth = stiffness * square
    fourth = (damping + omega) * (energy + growth) + growth  # bound on |z4| in the step
    # |w''''| = |z5| <= stiffness (h^3 + |z3|) + damping |z4|, |z4| <= (damping + omega) energy + growth
    per_energy = (stiffness + damping * (damping + omega)) / 384.0
    error = per_energy * (energy + growth) + (stiffness * square * h + damping * growth) / 384.0
    error_growth = per_energy * growth
    curve = (damping + omega) * growth
    n = 0.0
    first = 0
    if w == 0.0:
        first = 1 if acceleration >= 0.0 and acceleration + jerk - 0.5 * fourth > 0.0 else 2
    while n < max_steps and w >= 0.0:  # NaN ends the loop too
        passed, z, w, acceleration, w1, acceleration1 = _steps_above(
            step, b, z, w, acceleration, c, s, error, error_growth, first
        )
        if passed > 0:
            c, s = _turned_by(step, passed, c, s)
            n += passed
            error += passed * error_growth
            fourth += passed * curve
            first = 0
        if passed == LANES:
            continue
        expand(step, b, z, w, acceleration, c, s, work)
        if w > 0.0 and w1 <= 0.0 and max(acceleration, acceleration1) + 0.125 * fourth < 0.0:
            x = cubic_root(w, acceleration, w1, acceleration1)  # w falls: one root
        else:
            start = 0
            if first > 0:
                start = 1 if acceleration != 0.0 else 2  # skip the root at the start
            x = first_root(work, start, step.terms)
        if x <= 1.0:
            x, z, c, s = _at_root(step, b, z, c, s, x, work)
            return n + x, z, c, s
        z, w = (
            (step.z_cos * c + step.z_sin * s - step.z_one * b) + (step.zz * z + step.zw * w),
            (step.w_cos * c + step.w_sin * s - step.w_one * b) + (step.wz * z + step.ww * w),
        )
        c, s = step.cos * c - step.sin * s, step.cos * s + step.sin * c
        acceleration = stiffness * (c - b - z) - damping * w
        n += 1.0
        error += error_growth
        fourth += curve
        first = 0
    return float(NO_END), z, c, s


@inner_kernel
def slide_within(step, b, z, w, acceleration, c, s, max_steps, scratch):
    """Follow a slide as `slide` does within the scan steps left; subtract those taken, at least one.

    Parameters
    ----------
    step, b, z, w, acceleration, c, s, max_steps : see `slide`
    scratch : Scratch
    """
    allowed = max(min(max_steps, scratch.left[0]), 0.0)
    steps, z, c, s = slide(step, b, z, w, acceleration, c, s, allowed, scratch.series)
    scratch.left[0] -= 1.0 + (allowed if steps == NO_END else steps)
    return steps, z, c, s


@kernel
def after_slide(b, mu_b, z, c, s):
    """Determine what follows an upward slide that ended at displacement z and load phase (c, s).

    The contact sticks if |load| <= mu b (equality sticks); a stop ends when |load| exceeds mu b.

    Returns
    -------
    (code, z, c, s, contact_force, wait) : event code; the state from which the next upward slide starts,
        mirrored if the motion reverses; contact_force = r^2 z'' at its start; duration of the stop in tau
    """
    load = z - c
    if load > mu_b:
        return REVERSE, -z, -c, -s, load - b, 0.0
    if load < -mu_b:
        return GRAZING, z, c, s, -load - b, 0.0
    c_back = z - mu_b  # the load exceeds mu b upwards where cos falls through this value ...
    c_on = z + mu_b  # ... and downwards where cos rises through this one
    falls = c_back > -1.0
    rises = c_on < 1.0
    if not (falls or rises):
        return STUCK, z, c, s, 0.0, math.inf
    falling = s > 0.0 or (s == 0.0 and c > 0.0)
    back = falls and (falling or not rises)
    at_once = falling if back else not falling  # released within the present half turn of the load
    c_end = c_back if back else c_on
    s_end = math.sqrt(max(0.0, (1.0 - c_end) * (1.0 + c_end)))
    if not back:
        s_end = -s_end
    wait = math.atan2(s_end * c - c_end * s, c_end * c + s_end * s)
    if at_once:
        wait = max(wait, 0.0)  # by rounding the load may already be slightly past the release
    elif wait <= 0.0:
        wait += 2.0 * math.pi
    contact_force = mu_b - b
    if back:
        return STOP_THEN_BACK, -z, -c_end, -s_end, contact_force, wait
    return STOP_THEN_ON, z, c_end, s_end, contact_force, wait
