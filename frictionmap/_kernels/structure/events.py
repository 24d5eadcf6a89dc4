"""Events of a structure: the end of a slide, and what follows it.

Every slide is followed upwards; downward slides are mirrored.
"""

import math

from ..compiler import kernel
from ..event_codes import GRAZING, REVERSE, STOP_THEN_BACK, STOP_THEN_ON, STUCK
from .block import scan
from .oscillators import AT_LIMIT, FAILED, ROSE, STARTS_INSIDE
from .state import (
    contact_displacement,
    contact_load,
    held_period,
    hold,
    load_never_exceeds,
    mirror,
    release,
    vibrates_in_step,
)

#: Code in addition to those of `event_codes`: it was not determined whether the stop ends.
NO_RELEASE = 5

#: Value of `contact_force` for a slide that is already under way.
UNDER_WAY = -1.0

#: Relative excess of the load over mu beta below which a slide changes the displacement by rounding error
#: only.
_CREEPING = 1e-9

_TURN = 2.0 * math.pi


@kernel
def slide_on(st, beta, contact_force, state, c, s, limit, scratch):
    """Follow an upward slide to the zero of the velocity, or for `limit` scan steps.

    Parameters
    ----------
    st : StructureAtFrequency
    beta : kinetic friction force
    contact_force : contact force less the friction, >= 0, of a slide that starts from rest; or UNDER_WAY
    state : (2, n) free state; replaced by the state at the end
    c, s : cosine and sine of the load phase
    limit : scan steps allowed, including a fraction
    scratch : Scratch

    Returns
    -------
    (steps, end, cos, sin, slope) : see `oscillators.scan`
    """
    slope = contact_force * st.inverse_mass / (st.rate * st.rate) if contact_force >= 0.0 else STARTS_INSIDE
    return scan(st.free, st.free_block, beta, 0.0, math.inf, slope, state, c, s, limit, scratch)


@kernel
def wait_for_release(st, mu_beta, z, held, c, s, allowed, scratch):
    """Follow a stop at z until the load exceeds mu beta.

    Parameters
    ----------
    st : StructureAtFrequency
    mu_beta : static friction force
    z : contact displacement
    held : (2, m) held state; replaced by the state at the end
    c, s : cosine and sine of the load phase
    allowed : time in tau after which to give up
    scratch : Scratch

    Returns
    -------
    (end, cos, sin, duration, slope) : FELL or ROSE where the load leaves through -mu beta or mu beta,
        AT_LIMIT where it never does, FAILED where it does not within `allowed`; the load phase; duration in
        tau; dload/dx
    """
    level = st.stiffness * z
    wait = 0.0
    period = _TURN / st.h
    repeat = 0.0
    # resonant with the load, the motion creeps by ever shorter slides to where the load never exceeds mu beta
    most = mu_beta * (1.0 + _CREEPING) if vibrates_in_step(st) else mu_beta
    while True:
        if load_never_exceeds(st, held, z, c, s, most):
            return AT_LIMIT, c, s, wait, 0.0
        n, end, c, s, slope = scan(
            st.held, st.held_block, 0.0, -mu_beta - level, mu_beta - level, STARTS_INSIDE, held, c, s, period,
            scratch,
        )  # fmt: skip
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
    """Determine what follows an upward slide.

    Parameters
    ----------
    st : StructureAtFrequency
    beta, mu_beta : kinetic and static friction force
    state : (2, n) free state at the end of the slide; replaced by the state at the start of the next upward
        slide, but left unchanged by a stop that lasts
    held : (2, m) work array, the held state
    c, s : cosine and sine of the load phase
    allowed : time in tau after which to give up waiting
    scratch : Scratch

    Returns
    -------
    (code, cos, sin, contact_force, wait, load, slope) : code of `one_mass.events` or NO_RELEASE; the load
        phase and the contact force less the friction at the start of the next slide; duration of the stop in
        tau; load at the end of this slide; dload/dx at the end of the stop
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
