"""The recogniser of returns."""

import math

from ..jit import kernel
from .memory import TIME, Recurrence, could_recur, halves_between
from .motion import motion_size, recurrence_distance

#: Anchors looked back over for a return: symmetric motions need one or a few, sub-harmonic ones more.
_MOST_RECURRENCES = 64

#: Half periods of the longest return.
_LONGEST_RECURRENCE = 16


@kernel
def find_recurrence(motion, contact_state, events, any_will_do, shortest):
    """When the motion was nearly where it is now, a `Recurrence`.

    The shortest return, or the one beyond which a longer one is not closer by far: a sub-harmonic motion may
    be nearly symmetric.  Where there is one steady state any start will do to look for it.
    """
    memory = motion.memory
    length = memory.events.size
    now = (events - 1) % length
    size = motion_size(motion, contact_state)
    best = Recurrence(0, math.inf, 0)
    threshold = math.inf if any_will_do else motion.recurrence_threshold
    returns = 0
    for lag in range(1, min(events, length)):
        then = (events - 1 - lag) % length
        if memory.anchors[now, TIME] - memory.anchors[then, TIME] > (_LONGEST_RECURRENCE + 0.5) * math.pi:
            break
        if memory.events[then] != memory.events[now]:
            continue
        halves = halves_between(memory, now, then)
        if not could_recur(halves):
            continue
        distance = recurrence_distance(motion, now, then, size)
        if distance < math.inf:
            returns += 1
            if distance <= threshold:
                best = Recurrence(lag, distance, halves)
                threshold = 0.25 * distance
        if (shortest and best.lag > 0) or returns == _MOST_RECURRENCES:
            break
    return best
