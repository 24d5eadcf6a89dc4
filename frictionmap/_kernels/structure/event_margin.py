"""How far from a periodic orbit a motion may be and still have the orbit's events.

Events change where the velocity touches zero inside a slide or only just reaches it, where the load at the
end of a slide equals mu beta in size, or where the load in a stop touches an end of its range.  On the orbit
each of these quantities keeps a distance from that value; divided by how much a deviation of unit energy
changes it, the least one is the margin.  This is a theory of first order: a motion should be well within the
margin.
"""

import math

from ..compiler import kernel
from ..event_codes import REVERSE, STOP_THEN_BACK, STOP_THEN_ON
from .block import extremes
from .events import UNDER_WAY, after_slide, slide_on
from .newton import copy_state
from .oscillators import F1, FC, FELL, FS, D, K, derivatives, turned
from .state import LOAD, LOAD_RATE, contact_displacement, contact_load, hold

#: Longest slide or stop of an orbit, in tau: the longest period that is looked for.
_LONGEST = 512.0 * math.pi


@kernel
def _load_slope(st, beta, state, c, s):
    """Change of the load in the contact per scan step at the end of a slide."""
    table, h = st.free, st.h
    slope = h * (st.free_sin * c - st.free_cos * s)
    for i in range(st.n):
        force = table[i, FC] * c + table[i, FS] * s + table[i, F1] * beta
        acceleration = force - table[i, K] * state[0, i] - table[i, D] * state[1, i]
        slope += st.modes[LOAD, i] * state[1, i] + st.modes[LOAD_RATE, i] * (st.rate * acceleration)
    return slope


@kernel
def _passed_by(slope, bend):
    """How far a parabola with this slope at a zero and this second derivative goes beyond the zero."""
    return 0.5 * slope * slope / bend if bend > 0.0 else math.inf


@kernel
def _slide_margin(st, beta, mu_beta, begin, began, steps, state, c, s):
    """Margin of a slide and of what follows its end, as an energy norm.

    Parameters
    ----------
    st : StructureAtFrequency
    beta, mu_beta : kinetic and static friction force
    begin, state : (2, n) state at the start, moved on, and at the end
    began : load phase (cos, sin) at the start
    steps : scan steps of the slide
    c, s : cosine and sine of the load phase at the end
    """
    per_speed = st.rate / math.sqrt(st.inverse_mass)  # energy per velocity in one scan step
    low, _ = extremes(st.free, st.free_block, beta, begin, began[0], began[1], steps)
    _, slope, bend, _ = derivatives(st.free, beta, state, c, s)
    load = contact_load(st, state, c, s)
    # the end moves in time, and the load with it
    per_load = st.reach + abs(_load_slope(st, beta, state, c, s) / slope) / per_speed
    return min(
        per_speed * min(low, _passed_by(slope, bend)), min(abs(load - mu_beta), load + mu_beta) / per_load
    )


@kernel
def _stop_margin(st, mu_beta, begin, c, s, wait, held):
    """Margin of a stop, as an energy norm.

    Parameters
    ----------
    st : StructureAtFrequency
    mu_beta : static friction force
    begin : (2, n) free state at its start
    c, s : cosine and sine of the load phase there
    wait : duration in tau
    held : (2, m) held state at the end, overwritten
    """
    z = contact_displacement(st, begin, c, s)
    level = st.stiffness * z
    c_end, s_end = turned(c, s, wait)
    _, slope, bend, _ = derivatives(st.held, 0.0, held, c_end, s_end)
    release = _passed_by(slope, -bend if slope > 0.0 else bend)
    hold(st, begin, z, c, s, held)
    low, high = extremes(st.held, st.held_block, 0.0, held, c, s, wait / st.h)
    return min(release, mu_beta - level - high, mu_beta + level + low) / st.reach


@kernel
def event_margin(st, beta, mu_beta, state, c, s, slides, work, scratch):
    """Largest distance (energy norm) from an orbit at which a motion has the orbit's events, to first order.

    Parameters
    ----------
    st : StructureAtFrequency
    beta, mu_beta : kinetic and static friction force
    state : (2, n) state of the orbit within a slide, overwritten
    c, s : cosine and sine of its load phase
    slides : slides after which the orbit recurs
    work, scratch : Workspace, Scratch

    Returns
    -------
    float : 0 where the orbit is not followed to its end, because of a grazing event or a contact that sticks
        permanently
    """
    margin = math.inf
    contact_force = UNDER_WAY
    for _ in range(slides + 1):  # the slide that the state is in, from its middle and from its start
        copy_state(state, work.trial, st.n)
        began = (c, s)
        steps, end, c, s, _ = slide_on(st, beta, contact_force, state, c, s, _LONGEST / st.h, scratch)
        if end != FELL:
            return 0.0
        margin = min(margin, _slide_margin(st, beta, mu_beta, work.trial, began, steps, state, c, s))
        copy_state(state, work.trial, st.n)
        ended = (c, s)
        event, c, s, contact_force, wait, _, _ = after_slide(
            st, beta, mu_beta, state, work.held, c, s, _LONGEST, scratch
        )
        if event == STOP_THEN_BACK or event == STOP_THEN_ON:
            margin = min(margin, _stop_margin(st, mu_beta, work.trial, ended[0], ended[1], wait, work.held))
        elif event != REVERSE:
            return 0.0
    return margin
