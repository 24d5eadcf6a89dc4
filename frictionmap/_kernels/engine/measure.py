"""A periodic orbit once round: what it does, and its table of phases."""

from typing import NamedTuple

from ..compiler import kernel
from ..one_mass.events import NO_END
from ..one_mass.newton import half_periods
from .answers import SHORTEST_STOP, TURN, stops_at, turns_at
from .motion import after_turn, back_at, bring_back, keep_state, put_slide, put_stop, slide_to_turn
from .phase_table import CONTACT_FORCE, EVENT, put_phase
from .policies import ANCHOR

#: Longest slide of an orbit, in periods of its slower part: one that was followed once has none so long.
_LONGEST_SLIDE = 100.0


class Measured(NamedTuple):
    """A periodic orbit from an anchor to its return, mirrored or not."""

    slides: int
    phases: int  # of the table
    halves: int  # half periods of the excitation; 0 where it does not return
    stops: int
    amplitude: float
    stuck: float  # share of the time


@kernel
def measure(motion, contact, orbit, table):
    """The orbit that returns to its anchor after its number of slides, or sooner.

    table : becomes the phases, two rows for every slide, see `phase_table`; or (0, 0) where it is not wanted.
    The state is that of the anchor, before and after.
    """
    writes = table.shape[0] > 0
    keep_state(motion, ANCHOR)
    at, sign = orbit.at, orbit.sign
    time = stuck = amplitude = 0.0
    stops = phases = count = 0
    longest = _LONGEST_SLIDE * TURN * max(1.0, motion.r) / motion.h
    for _ in range(orbit.slides):
        if writes:
            put_slide(motion, at, table[phases])
            table[phases, CONTACT_FORCE] = motion.load * at.contact_force
        steps, at = slide_to_turn(motion, contact, at, longest)
        if steps == NO_END:
            time = 0.0
            break
        end = at.z
        amplitude = max(amplitude, abs(end))
        if writes:
            put_phase(table[phases], time, steps * motion.h, 1.0, sign, motion.load * end)
            put_stop(motion, at, table[phases + 1])
        time += steps * motion.h
        happened, at, wait = after_turn(motion, contact, at, longest * motion.h)
        if writes:
            table[phases, EVENT] = happened
        phases += 1
        if stops_at(happened) and wait > SHORTEST_STOP:
            if writes:
                put_phase(table[phases], time, wait, 0.0, sign, motion.load * end)
            phases += 1
            stops += 1
            stuck += wait
            time += wait
        sign = -sign if turns_at(happened) else sign
        count += 1
        if happened == orbit.event and back_at(motion, ANCHOR, orbit.at, at):
            break
    bring_back(motion, ANCHOR)
    share = stuck / time if time > 0.0 else 0.0
    return Measured(count, phases, half_periods(time), stops, amplitude, share)


@kernel
def certain_stops(measured, contact):
    """The stops: one in each half period where none was seen but one there must be.

    From b_lim on, and with mu = 1, no motion with two turns a period is without stops.  Next to b_lim they
    last shorter than rounding can tell.
    """
    proved = contact.unique and contact.b >= contact.b_lim
    if measured.stops == 0 and measured.slides <= measured.halves and proved:
        return measured.halves
    return measured.stops
