"""A periodic orbit once round: what it does, and its table of phases."""

from typing import NamedTuple

from ..jit import kernel
from ..one_mass.events import NO_END
from ..one_mass.newton import half_periods
from .motion import after_turn, bring_back, has_returned, keep_state, put_slide, put_stop, slide_to_turn
from .policies import ANCHOR
from .records import SHORTEST_STOP, TURN, stops_at, turns_at
from .segment_table import CONTACT_FORCE, EVENT, put_segment

#: Longest slide of an orbit, in periods of its slower part: one that was followed once has none so long.
_LONGEST_SLIDE = 100.0


class Measured(NamedTuple):
    """A periodic orbit from an anchor to its return, mirrored or not."""

    slides: int
    segments: int  # of the table
    halves: int  # half periods of the excitation; 0 where it does not return
    stops: int
    amplitude: float
    stuck: float  # share of the time


@kernel
def measure(motion, contact, orbit, table):
    """The orbit that returns to its anchor after its number of slides, or sooner.

    table : becomes the phases, two rows for every slide, see `segment_table`; or (0, 0) where it is not wanted.
    The state is that of the anchor, before and after.
    """
    writes = table.shape[0] > 0
    keep_state(motion, ANCHOR)
    contact_state, sign = orbit.contact_state, orbit.sign
    time = stuck = amplitude = 0.0
    stops = segments = count = 0
    longest = _LONGEST_SLIDE * TURN * max(1.0, motion.r) / motion.h
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
    bring_back(motion, ANCHOR)
    share = stuck / time if time > 0.0 else 0.0
    return Measured(count, segments, half_periods(time), stops, amplitude, share)


@kernel
def proven_stops(measured, contact):
    """The stops: one in each half period where none was seen but one there must be.

    From b_lim on, and with mu = 1, no motion with two turns a period is without stops.  Next to b_lim they
    last shorter than rounding can tell.
    """
    proved = contact.unique and contact.b >= contact.b_lim
    if measured.stops == 0 and measured.slides <= measured.halves and proved:
        return measured.halves
    return measured.stops
