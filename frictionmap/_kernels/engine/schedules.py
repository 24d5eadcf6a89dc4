"""When Newton's method is tried."""

from typing import NamedTuple

from ..compiler import kernel


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
