"""A structure followed from one slide to the next; every slide is an upward one, downward ones are
mirrored."""

import math

from ..jit import kernel
from ..one_mass.events import GRAZING, REVERSE, STOP_THEN_BACK, STOP_THEN_ON, STUCK
from .oscillators import AT_LIMIT, FAILED, ROSE, STARTS_INSIDE, scan
from .state import (
    contact_displacement,
    contact_load,
    held_period,
    hold,
    largest_load_to_come,
    mirror,
    release,
    vibrates_in_step,
)

#: What follows a slide, beside the codes of `one_mass.events`: a stop that is not known to end, or to last.
NO_RELEASE = 5

#: In place of a force at the start of a slide: it is under way already.
UNDER_WAY = -1.0

#: Excess of the load over mu beta, relative to it, below which slides take off no more than rounding.
_CREEPING = 1e-9

_TURN = 2.0 * math.pi


@kernel
def slide_on(st, beta, contact_force, state, c, s, limit, scratch):
    """An upward slide to the zero of the velocity, or for `limit` steps; see `oscillators.scan`.

    It starts with no velocity under `contact_force` >= 0, friction taken off; or contact_force = MOVING.
    """
    slope = contact_force * st.inverse_mass / (st.rate * st.rate) if contact_force >= 0.0 else STARTS_INSIDE
    return scan(st.free, beta, 0.0, math.inf, slope, state, c, s, limit, scratch)


@kernel
def wait_for_release(st, mu_beta, z, held, c, s, allowed, scratch):
    """A stop at z, to where the load exceeds mu beta: (end, cos, sin, duration in tau, dload/dx).

    `end` is FELL or ROSE (the load left through -mu beta or mu beta), AT_LIMIT (never) or FAILED (not in
    `allowed` tau).
    """
    level = st.stiffness * z
    wait = 0.0
    period = _TURN / st.h
    repeat = 0.0
    # in step with the load the motion creeps to where the load never exceeds mu beta, by ever shorter slides
    most = mu_beta * (1.0 + _CREEPING) if vibrates_in_step(st) else mu_beta
    while True:
        if largest_load_to_come(st, held, z, c, s) <= most:
            return AT_LIMIT, c, s, wait, 0.0
        n, end, c, s, slope = scan(
            st.held, 0.0, -mu_beta - level, mu_beta - level, STARTS_INSIDE, held, c, s, period, scratch
        )
        wait += n * st.h
        if end != AT_LIMIT:
            return end, c, s, wait, slope
        if repeat == 0.0:
            repeat = held_period(st)
        if wait > (repeat - 0.5) * _TURN:
            return AT_LIMIT, c, s, wait, 0.0
        if not wait < allowed:
            return FAILED, c, s, wait, 0.0


@kernel
def after_slide(st, beta, mu_beta, state, held, c, s, allowed, scratch):
    """What follows an upward slide that ended in this free state.

    Returns (code, cos, sin, contact_force, wait, load, slope): as `events.after_slide`, `contact_force` at
    the start of the next slide; `load` at the end of this one, and its slope dload/dx at the end of the stop.
    The state becomes the one from which the next upward slide starts; a stop that lasts leaves it.
    """
    load = contact_load(st, state, c, s)
    if load > mu_beta:
        mirror(st, state)
        return REVERSE, -c, -s, load - beta, 0.0, load, 0.0
    if load < -mu_beta:
        return GRAZING, c, s, -load - beta, 0.0, load, 0.0
    z = contact_displacement(st, state, c, s)
    hold(st, state, z, c, s, held)
    end, c, s, wait, slope = wait_for_release(st, mu_beta, z, held, c, s, allowed, scratch)
    if end == AT_LIMIT:
        return STUCK, c, s, 0.0, math.inf, load, 0.0
    if end == FAILED:
        return NO_RELEASE, c, s, 0.0, wait, load, 0.0
    release(st, held, z, c, s, state)
    if end == ROSE:
        mirror(st, state)
        return STOP_THEN_BACK, -c, -s, mu_beta - beta, wait, load, slope
    return STOP_THEN_ON, c, s, mu_beta - beta, wait, load, slope
