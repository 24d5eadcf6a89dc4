"""One excitation period of the motion, with the derivative of the final state by the initial one.

Derivatives are those of the state at a fixed phase: free motion in a slide, and at each event the shift of
its phase (saltation).
"""

import math
from typing import NamedTuple

from ..closed_form import decay
from ..compiler import kernel
from .slides import load_and_rate, settle, slide, wait

PERIOD = 2.0 * math.pi

#: Largest number of events per period of the fastest part; more events are slides of zero length.
_MOST_EVENTS = 40.0


class Tangent(NamedTuple):
    """Derivatives of (q, v) by (q, v) at the start of the cycle."""

    q_q: float
    q_v: float
    v_q: float
    v_v: float


class Cycle(NamedTuple):
    """State after one period, and the events in it."""

    complete: bool  # False: the cycle consists of ever shorter slides
    q: float
    v: float
    tangent: Tangent
    events: int
    stops: int  # number of stops that begin
    stuck: float  # share of the period that the mass is stuck
    turn_load: float  # least load at a turn without a stop; infinite if there is none


@kernel
def _after_slide(mass, tangent, time):
    """Propagate the derivatives through a slide."""
    q, e = decay(mass.zeta, time / mass.r)
    d = e + 2.0 * mass.zeta * q
    rate = q / mass.r
    push = q * mass.r
    return Tangent(
        d * tangent.q_q + push * tangent.v_q, d * tangent.q_v + push * tangent.v_v,
        e * tangent.v_q - rate * tangent.q_q, e * tangent.v_v - rate * tangent.q_v,
    )  # fmt: skip


@kernel
def _scaled_speed(tangent, factor):
    """Multiply the derivatives of the velocity by a factor."""
    return Tangent(tangent.q_q, tangent.q_v, factor * tangent.v_q, factor * tangent.v_v)


@kernel
def _after_stop(mass, tangent, sense, force, rate):
    """Propagate the derivatives through the end of a stop: a later start appears as a lower velocity."""
    if force == 0.0:
        return tangent  # without velocity
    lag = -sense * force / (mass.r * mass.r * rate)
    return Tangent(tangent.q_q, tangent.q_v, lag * tangent.q_q, lag * tangent.q_v)


@kernel
def follow(mass, q, v, work, samples):
    """Follow one `Cycle` from the state (q, v) at tau = 0."""
    tangent = Tangent(1.0, 0.0, 0.0, 1.0)
    sense, force = math.copysign(1.0, v), 0.0
    if v == 0.0:
        sense, force = settle(mass, q, load_and_rate(mass.load, 0.0)[0])
        tangent = _scaled_speed(tangent, math.fabs(sense))
    tau = 0.0
    stops = 0
    stuck = 0.0
    turn_load = math.inf
    most = int(_MOST_EVENTS * max(float(mass.load.size), 1.0 / mass.r))
    for event in range(most):
        begin = tau
        if sense == 0.0:
            tau, sense = wait(mass, tau, q, PERIOD, work, samples)
            stuck += (tau - begin) / PERIOD
            if tau >= PERIOD:
                return Cycle(True, q, 0.0, tangent, event, stops, stuck, turn_load)
            force = mass.static_friction - mass.friction
            tangent = _after_stop(mass, tangent, sense, force, load_and_rate(mass.load, tau)[1])
            v = 0.0
        else:
            tau, q, v, turned = slide(mass, tau, sense, q, v, force, PERIOD, work, samples)
            tangent = _after_slide(mass, tangent, tau - begin)
            if not turned:
                return Cycle(True, q, v, tangent, event, stops, stuck, turn_load)
            load = load_and_rate(mass.load, tau)[0]
            before = sense * (load - q) - mass.friction  # pulls back: < 0
            after_sense, force = settle(mass, q, load)
            if after_sense == 0.0:
                stops += 1
                tangent = _scaled_speed(tangent, 0.0)
            else:
                turn_load = min(turn_load, abs(load - q))
                tangent = _scaled_speed(tangent, sense * after_sense * force / before)
            sense = after_sense
    return Cycle(False, q, v, tangent, most, stops, stuck, turn_load)
