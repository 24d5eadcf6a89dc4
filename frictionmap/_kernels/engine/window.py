"""A motion that does not repeat: the table of phases of its last periods."""

import math

import numpy as np

from ..compiler import entry, kernel
from ..one_mass.events import NO_END, STUCK
from ..structure.events import NO_RELEASE
from .answers import known_orbit, stops_at, turns_at
from .measure import measure
from .motion import after_turn, at_frequency, bring_back, contact_at, keep_state, slide_to_turn, start
from .phase_table import phase_columns
from .policies import NOW

#: In place of the event at which an orbit returns: it does not.
_NEVER = -1


@kernel
def _follow(motion, contact, at, moves, duration):
    """(events, moment, sign): followed for `duration` in tau, to the end of what follows the slide then.

    `sign` : -1.0 where the slide that follows is a mirror image.  No events where it sticks for good.
    """
    time = 0.0
    sign = 1.0
    events = 0
    while time < duration:
        if moves or events > 0:
            steps, at = slide_to_turn(motion, contact, at, duration / motion.h + 1.0)
            if steps == NO_END:
                return 0, at, sign
            time += steps * motion.h
        event, at, wait = after_turn(motion, contact, at, math.inf)
        if event == STUCK or event == NO_RELEASE:
            return 0, at, sign
        if stops_at(event):
            time += wait
        if turns_at(event):
            sign = -sign
        events += 1
    return events, at, sign


@entry
def window_table(system, beta, mu, moving, before, duration):
    """The table of phases from some time `before` on, for `duration` or little longer, both in tau.

    Of the motion of a system at one frequency, as `march` follows it; no rows where it sticks for good.
    """
    motion = at_frequency(system, 0)
    contact = contact_at(system, 0, 0, beta, mu)
    at = start(motion, system, 0, contact, moving)
    _, at, sign = _follow(motion, contact, at, moving, before)
    keep_state(motion, NOW)
    slides, _, _ = _follow(motion, contact, at, True, duration)
    bring_back(motion, NOW)
    table = np.empty((2 * slides, phase_columns(system.modes)))
    measured = measure(motion, contact, known_orbit(at, _NEVER, sign, slides), table)
    return table[: measured.phases]
