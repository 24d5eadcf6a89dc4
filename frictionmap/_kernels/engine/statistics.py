"""Averages of a motion that does not repeat, and the schedule of Newton's method."""

from typing import NamedTuple

from ..compiler import inner_kernel, kernel
from .records import SHORTEST_STOP, TURN

#: Excitation periods in one averaging window.
AVERAGED = 100.0


class Window(NamedTuple):
    """Events of a motion since the time `opened`."""

    opened: float
    stops: int
    stuck: float  # time stuck
    largest: float  # largest displacement


class Windows(NamedTuple):
    """The last full averaging window and the present one."""

    length: float
    end: float
    last: Window
    now: Window


@kernel
def open_windows(cycles):
    """Open the averaging windows of a motion that is followed for this many excitation periods."""
    length = TURN * min(AVERAGED, 0.5 * cycles)
    return Windows(length, length, Window(0.0, 0, 0.0, 0.0), Window(0.0, 0, 0.0, 0.0))


@inner_kernel
def count_event(windows, time, size, stopped, wait):
    """Add a slide that ended at `time` with displacement `size`, and the stop after it, to the windows."""
    last, now, end = windows.last, windows.now, windows.end
    if time >= end:
        last, now, end = now, Window(time, 0, 0.0, 0.0), end + windows.length
    stops = now.stops + 1 if stopped and wait > SHORTEST_STOP else now.stops
    stuck = now.stuck + wait if stopped else now.stuck
    return Windows(windows.length, end, last, Window(now.opened, stops, stuck, max(now.largest, size)))


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
