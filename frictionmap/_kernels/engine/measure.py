"""Follow a periodic orbit once: its stops, amplitude and share stuck, and its segment table."""

from typing import NamedTuple

import numpy as np

from ..compiler import entry, kernel
from ..event_codes import NO_END
from ..newton_limits import LONGEST_SLIDE
from .motion import after_turn, has_returned, put_slide, put_stop, restore_state, save_state, slide_to_turn
from .periods import half_periods
from .policies import ANCHOR
from .records import SHORTEST_STOP, TURN, known_orbit, stops_at, turns_at
from .segment_table import CONTACT_FORCE, EVENT, put_segment, segment_columns


class Measured(NamedTuple):
    """One recurrence of a periodic orbit, mirrored or not."""

    slides: int
    segments: int  # rows of the segment table
    halves: int  # half periods of the excitation; 0 where the motion does not recur
    stops: int
    amplitude: float
    stuck: float  # share of the time


@kernel
def measure(motion, contact, orbit, table):
    """Follow the orbit until it returns to its anchor, for at most `orbit.slides` slides.

    The motion is at the anchor before and after the call.

    Parameters
    ----------
    motion : a kind of motion, see `motion`
    contact : Contact
    orbit : Orbit
    table : (2 orbit.slides, columns) filled with the segments, see `segment_table`; (0, 0) to skip this

    Returns
    -------
    Measured
    """
    writes = table.shape[0] > 0
    save_state(motion, ANCHOR)
    contact_state, sign = orbit.contact_state, orbit.sign
    time = stuck = amplitude = 0.0
    stops = segments = count = 0
    longest = LONGEST_SLIDE * TURN * max(1.0, motion.r) / motion.h
    for _ in range(orbit.slides):
        if writes:
            put_slide(motion, contact_state, table[segments])
            table[segments, CONTACT_FORCE] = motion.load * contact_state.contact_force
        steps, contact_state = slide_to_turn(motion, contact, contact_state, longest)
        if steps == NO_END:
            time = 0.0
            break
        end = contact_state.z
        amplitude = max(amplitude, abs(end))
        if writes:
            put_segment(table[segments], time, steps * motion.h, 1.0, sign, motion.load * end)
            put_stop(motion, contact_state, table[segments + 1])
        time += steps * motion.h
        happened, contact_state, wait = after_turn(motion, contact, contact_state, longest * motion.h)
        if writes:
            table[segments, EVENT] = happened
        segments += 1
        if stops_at(happened) and wait > SHORTEST_STOP:
            if writes:
                put_segment(table[segments], time, wait, 0.0, sign, motion.load * end)
            segments += 1
            stops += 1
            stuck += wait
            time += wait
        sign = -sign if turns_at(happened) else sign
        count += 1
        if happened == orbit.event and has_returned(motion, ANCHOR, orbit.contact_state, contact_state):
            break
    restore_state(motion, ANCHOR)
    share = stuck / time if time > 0.0 else 0.0
    return Measured(count, segments, half_periods(time), stops, amplitude, share)


@entry
def orbit_table(motion, contact, found, n):
    """Segment table of the periodic orbit of a Cell, with the motion at its anchor; n oscillators."""
    table = np.empty((2 * found.slides, segment_columns(n)))
    orbit = known_orbit(found.contact_state, found.event, found.sign, found.slides)
    return table[: measure(motion, contact, orbit, table).segments]


@kernel
def proven_stops(measured, contact):
    """Number of stops; one per half period where none was resolved but theory requires one.

    For b >= b_lim and mu = 1 every motion with two turns per period stops.  Close to b_lim these stops are
    too short to be resolved in floating point.
    """
    proved = contact.unique and contact.b >= contact.b_lim
    if measured.stops == 0 and measured.slides <= measured.halves and proved:
        return measured.halves
    return measured.stops
