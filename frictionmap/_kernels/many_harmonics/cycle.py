"""One excitation period of the motion, and how a neighbour's motion differs after it.

Derivatives are those of the state at a fixed phase: free motion in a slide, and at each event the shift of
its phase (saltation).
"""

import math
from typing import NamedTuple

from ..closed_form import decay
from ..jit import kernel
from .slides import load_and_rate, settle, slide, wait

PERIOD = 2.0 * math.pi

#: More events in a cycle than so many for every period of the fastest part: slides without length.
_MOST_EVENTS = 40.0


class Tangent(NamedTuple):
    """Derivatives of (q, v) by (q, v) at the beginning of the cycle."""

    q_q: float
    q_v: float
    v_q: float
    v_v: float


class Cycle(NamedTuple):
    """The state after one period, and what happened in it."""

    complete: bool  # False: it hangs in slides without length
    q: float
    v: float
    tangent: Tangent
    events: int
    stops: int  # that begin
    stuck: float  # share of the period
    turn_load: float  # the least load at a turn without a stop; infinite if there is none


@kernel
def _after_slide(mass, tangent, time):
    """Neighbours after free motion."""
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
    return Tangent(tangent.q_q, tangent.q_v, factor * tangent.v_q, factor * tangent.v_v)


@kernel
def _after_stop(mass, tangent, sense, force, rate):
    """Neighbours after a stop: a later start is a velocity that lags."""
    if force == 0.0:
        return tangent  # without velocity
    lag = -sense * force / (mass.r * mass.r * rate)
    return Tangent(tangent.q_q, tangent.q_v, lag * tangent.q_q, lag * tangent.q_v)


@kernel
def follow(mass, q, v, work, samples):
    """The `Cycle` from the state (q, v) at tau = 0."""
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
