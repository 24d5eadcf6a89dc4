"""When Newton's method is tried, and when a motion is searched for long periods."""

from typing import NamedTuple

from ..compiler import kernel

#: Half periods of the excitation after which the first search for long periods is made.
_FIRST_SEARCH = 80


class NewtonSchedule(NamedTuple):
    """Times at which Newton's method is tried, in half periods of the excitation."""

    made: int
    delay: int  # between the last attempt and the next; grows after each failure
    due: int  # time of the next attempt


@kernel
def first_schedule():
    """Return the schedule at the start of a motion."""
    return NewtonSchedule(0, 1, 2)


@kernel
def postpone(schedule, half):
    """Return the schedule after a failed attempt."""
    delay = schedule.delay + 1 + schedule.delay // 4
    return NewtonSchedule(schedule.made + 1, delay, half + delay)


@kernel
def first_search():
    """Half periods after which a motion is first searched for a long period."""
    return _FIRST_SEARCH


@kernel
def next_search(half):
    """Half periods after which it is searched again, having been searched at `half`."""
    if half < 128:
        return 128
    if half < 256:
        return half + 64
    if half < 1024:
        return half + 128
    if half < 2048:
        return half + 256
    return 2 * half
