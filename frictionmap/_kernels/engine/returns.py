"""The recogniser of returns."""

import math

from ..compiler import kernel
from .memory import TIME, Near, could_return, halves_between
from .motion import return_distance, size_now

#: Anchors looked back over for a return: symmetric motions need one or a few, sub-harmonic ones more.
_MAX_RETURN = 64

#: Half periods of the longest return.
_LONGEST_RETURN = 16


@kernel
def near_return(motion, at, events, any_will_do, shortest):
    """When the motion was nearly where it is now, a `Near`.

    The shortest return, or the one beyond which a longer one is not closer by far: a sub-harmonic motion may
    be nearly symmetric.  Where there is one steady state any start will do to look for it.
    """
    memory = motion.memory
    length = memory.events.size
    now = (events - 1) % length
    size = size_now(motion, at)
    best = Near(0, math.inf, 0)
    near = math.inf if any_will_do else motion.near_return
    returns = 0
    for lag in range(1, min(events, length)):
        then = (events - 1 - lag) % length
        if memory.anchors[now, TIME] - memory.anchors[then, TIME] > (_LONGEST_RETURN + 0.5) * math.pi:
            break
        if memory.events[then] != memory.events[now]:
            continue
        halves = halves_between(memory, now, then)
        if not could_return(halves):
            continue
        distance = return_distance(motion, now, then, size)
        if distance < math.inf:
            returns += 1
            if distance <= near:
                best = Near(lag, distance, halves)
                near = 0.25 * distance
        if (shortest and best.lag > 0) or returns == _MAX_RETURN:
            break
    return best
