"""A motion that does not repeat: the table of phases of its last periods."""

import math

import numpy as np

from ..jit import entry, kernel
from ..one_mass.events import NO_END, STUCK
from ..structure.events import NO_RELEASE
from .measure import measure
from .motion import after_turn, at_frequency, bring_back, contact_at, keep_state, slide_to_turn, start
from .policies import NOW
from .records import known_orbit, stops_at, turns_at
from .segment_table import segment_columns

#: In place of the event at which an orbit returns: it does not.
_NEVER = -1


@kernel
def _follow(motion, contact, contact_state, moves, duration):
    """(events, moment, sign): followed for `duration` in tau, to the end of what follows the slide then.

    `sign` : -1.0 where the slide that follows is a mirror image.  No events where it sticks for good.
    """
    time = 0.0
    sign = 1.0
    events = 0
    while time < duration:
        if moves or events > 0:
            steps, contact_state = slide_to_turn(motion, contact, contact_state, duration / motion.h + 1.0)
            if steps == NO_END:
                return 0, contact_state, sign
            time += steps * motion.h
        event, contact_state, wait = after_turn(motion, contact, contact_state, math.inf)
        if event == STUCK or event == NO_RELEASE:
            return 0, contact_state, sign
        if stops_at(event):
            time += wait
        if turns_at(event):
            sign = -sign
        events += 1
    return events, contact_state, sign


@entry
def window_table(system, beta, mu, moving, before, duration):
    """The table of phases from some time `before` on, for `duration` or little longer, both in tau.

    Of the motion of a system at one frequency, as `march` follows it; no rows where it sticks for good.
    """
    motion = at_frequency(system, 0)
    contact = contact_at(system, 0, 0, beta, mu)
    contact_state = start(motion, system, 0, contact, moving)
    _, contact_state, sign = _follow(motion, contact, contact_state, moving, before)
    keep_state(motion, NOW)
    slides, _, _ = _follow(motion, contact, contact_state, True, duration)
    bring_back(motion, NOW)
    table = np.empty((2 * slides, segment_columns(system.modes)))
    measured = measure(motion, contact, known_orbit(contact_state, _NEVER, sign, slides), table)
    return table[: measured.segments]
