"""Recurrence detection: whether a motion has returned to an earlier state."""

import math

from ..compiler import kernel
from ..long_periods import LONGEST_RECURRENCE, RETURNED_AFTER_LONG
from .memory import CLOSER, TIME, Recurrence, halves_between
from .motion import motion_size, recurrence_distance
from .periods import full_period

#: Longest recurrence [half periods of the excitation] looked for in every half period.
_LONGEST_SOON = 16

#: Largest number of candidates compared per half period of the longest recurrence: symmetric motions need one
#: or a few, subharmonic ones more.
_MOST_RECURRENCES = 4


@kernel
def find_recurrence(motion, contact_state, events, any_will_do, shortest):
    """Find the earlier anchor that the present one nearly equals, as a `Recurrence`.

    Parameters
    ----------
    motion : a kind of motion, see `motion`
    contact_state : ContactState at the present anchor
    events : number of anchors so far
    any_will_do : True accepts any distance, because the steady state is unique
    shortest : True stops the search at the first recurrence
    """
    threshold = math.inf if any_will_do else min(motion.recurrence_threshold, motion.memory.wanted[CLOSER])
    return _nearest(motion, contact_state, events, threshold, _LONGEST_SOON, shortest)


@kernel
def find_long_recurrence(motion, contact_state, events):
    """Find the earlier anchor, up to 256 excitation periods ago, that the present one equals."""
    return _nearest(motion, contact_state, events, RETURNED_AFTER_LONG, LONGEST_RECURRENCE, False)


@kernel
def _nearest(motion, contact_state, events, threshold, longest, shortest):
    """Find the earlier anchor that the present one nearly equals, as a `Recurrence`.

    The shortest recurrence wins unless a longer one is at least four times closer: a subharmonic motion may
    be nearly symmetric.

    Parameters
    ----------
    motion : a kind of motion, see `motion`
    contact_state : ContactState at the present anchor
    events : number of anchors so far
    threshold : largest distance
    longest : longest recurrence [half periods of the excitation]
    shortest : True stops the search at the first recurrence
    """
    memory = motion.memory
    length = memory.events.size
    now = (events - 1) % length
    event, time = memory.events[now], memory.anchors[now, TIME]
    size = motion_size(motion, contact_state)
    best = Recurrence(0, math.inf, 0)
    returns = 0
    then = now
    for lag in range(1, min(events, length)):
        then = then - 1 if then > 0 else length - 1  # a remainder of a division takes as long as all else
        if time - memory.anchors[then, TIME] > (longest + 0.5) * math.pi:
            break
        if memory.events[then] != event:
            continue
        halves = halves_between(memory, now, then)
        if halves < 1 or full_period(halves) > longest // 2:
            continue
        distance = recurrence_distance(motion, now, then, size, threshold)
        if distance < math.inf:
            returns += 1
            if distance <= threshold:
                best = Recurrence(lag, distance, halves)
                threshold = 0.25 * distance
        if (shortest and best.lag > 0) or returns == _MOST_RECURRENCES * longest:
            break
    return best
