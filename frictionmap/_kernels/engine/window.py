"""Segment table of a motion that does not repeat."""

import math

import numpy as np

from ..compiler import entry, kernel
from ..compiler.packed import packed
from ..event_codes import NO_END, STUCK
from ..structure.events import NO_RELEASE
from .measure import measure
from .motion import after_turn, at_frequency, contact_at, restore_state, save_state, slide_to_turn, start
from .policies import NOW
from .records import known_orbit, stops_at, turns_at
from .segment_table import segment_columns

#: Event code of an orbit that never recurs.
_NEVER = -1


@kernel
def _follow(motion, contact, contact_state, moves, duration):
    """Follow the motion for at least `duration` in tau, to the end of the last event.

    Returns
    -------
    (events, contact_state, sign) : number of events, 0 where the contact sticks permanently or no event is
        found; the state after them; -1.0 where the next slide is mirrored
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


@kernel
def _count_slides(motion, system, beta, mu, moving, before, duration):
    """Follow the motion to the window, and through it to count its slides; it is then at its beginning.

    Parameters
    ----------
    motion : a kind of motion
    system, beta, mu, moving, before, duration : see `window_table`

    Returns
    -------
    Contact, ContactState at the beginning, sign there, slides
    """
    system, motion = packed(system), packed(motion)
    contact = contact_at(system, 0, 0, beta, mu)
    contact_state = start(motion, system, 0, contact, moving)
    _, contact_state, sign = _follow(motion, contact, contact_state, moving, before)
    save_state(motion, NOW)
    slides, _, _ = _follow(motion, contact, contact_state, True, duration)
    restore_state(motion, NOW)
    return contact, contact_state, sign, slides


@kernel
def _fill_table(motion, contact, contact_state, sign, slides, table):
    """Fill the segment table of the window; return the number of its rows."""
    return measure(packed(motion), contact, known_orbit(contact_state, _NEVER, sign, slides), table).segments


@entry
def window_table(system, beta, mu, moving, before, duration):
    """Segment table of a motion from the time `before` on, over at least `duration`, both in tau.

    The motion is that of a system at one frequency, followed from the same initial state as in `march`.  The
    table has no rows where the contact sticks permanently.
    """
    motion = at_frequency(system, 0)
    contact, contact_state, sign, slides = _count_slides(motion, system, beta, mu, moving, before, duration)
    table = np.empty((2 * slides, segment_columns(system.modes)))
    return table[: _fill_table(motion, contact, contact_state, sign, slides, table)]
