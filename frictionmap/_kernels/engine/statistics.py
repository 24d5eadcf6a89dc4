"""What a motion that does not repeat does on average, and when to try Newton's method on one that may."""

from typing import NamedTuple

from ..jit import inner_kernel, kernel
from .records import SHORTEST_STOP, TURN

#: Excitation periods over which a motion that does not repeat is averaged.
AVERAGED = 100.0


class Window(NamedTuple):
    """What a motion did since `opened`."""

    opened: float
    stops: int
    stuck: float  # time
    largest: float  # displacement


class Windows(NamedTuple):
    """The last whole window, and the one under way."""

    length: float
    end: float
    last: Window
    now: Window


@kernel
def open_windows(cycles):
    """Windows of a motion that is followed for so many excitation periods."""
    length = TURN * min(AVERAGED, 0.5 * cycles)
    return Windows(length, length, Window(0.0, 0, 0.0, 0.0), Window(0.0, 0, 0.0, 0.0))


@inner_kernel
def count_event(windows, time, size, stopped, wait):
    """The windows after a slide that ended at `time` and displacement `size`, and after the stop then."""
    last, now, end = windows.last, windows.now, windows.end
    if time >= end:
        last, now, end = now, Window(time, 0, 0.0, 0.0), end + windows.length
    stops = now.stops + 1 if stopped and wait > SHORTEST_STOP else now.stops
    stuck = now.stuck + wait if stopped else now.stuck
    return Windows(windows.length, end, last, Window(now.opened, stops, stuck, max(now.largest, size)))


class NewtonSchedule(NamedTuple):
    """The schedule of Newton's method, in half periods of the excitation."""

    made: int
    delay: int  # from the last try to the next; longer after each failure
    due: int  # when the next is


@kernel
def first_schedule():
    """The schedule of a motion that starts."""
    return NewtonSchedule(0, 1, 2)


@kernel
def postpone(schedule, half):
    """The schedule after a try that failed."""
    delay = schedule.delay + 1 + schedule.delay // 4
    return NewtonSchedule(schedule.made + 1, delay, half + delay)
