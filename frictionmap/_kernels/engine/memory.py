"""Ring buffer of past anchors, and the phase distance between two of them."""

import math
from typing import NamedTuple

import numpy as np

from ..compiler import entry, inner_kernel, kernel
from .periods import half_periods

#: Least and largest number of anchors kept; a steady period with more anchors is not recognised.
_SHORTEST = 2048
_LONGEST = 2**18

#: Columns of `Memory.anchors`; the numbers of the state follow.
COS, SIN, TIME, SIGN, STATE = 0, 1, 2, 3, 4


#: Columns of `Memory.wanted`: the recurrence distance that the orbit found last asks for, and how near one
#: a motion must be, as a share of the margin of the orbit's events.
CLOSER, SHARE = 0, 1
_WANTED = 2

#: The share at first, and of a motion that approaches slowly.  With 0.3 all of 650,000 random cells ended as
#: they do where Newton's method waits for a recurrence of 1e-5, with 0.5 all but one, with 1 from the
#: beginning all but four; marching ends those that differed as waiting does.
_WELL_WITHIN, _WITHIN = 0.3, 1.0


class Memory(NamedTuple):
    """The most recent anchors, in ring buffers."""

    events: np.ndarray  # (length,) events that ended the preceding slides
    anchors: np.ndarray  # (length, STATE + numbers of a state)
    wanted: np.ndarray  # (_WANTED,) what an orbit must fulfil to be the one that the motion approaches


class Recurrence(NamedTuple):
    """An earlier anchor that nearly equals the present one."""

    lag: int  # slides since that anchor; 0 if no recurrence was found
    distance: float  # distance between the two anchors, relative to the size of the motion
    halves: int  # half periods of the excitation between them


@entry
def make_memory(h, size):
    """Allocate a memory that holds at least the anchors of four excitation periods.

    Its length depends on the scan step h only, so that the search for recurrences never depends on another
    frequency of the map.

    Parameters
    ----------
    h : scan step in tau
    size : numbers that describe the state at an anchor
    """
    length = int(min(max(_SHORTEST, math.ceil(2.0 / h)), _LONGEST))
    return Memory(np.empty(length), np.empty((length, STATE + size)), np.empty(_WANTED))


@kernel
def reset_acceptance(memory):
    """Ask of the next orbit what a new motion asks: that it is well within the margin."""
    memory.wanted[CLOSER], memory.wanted[SHARE] = math.inf, _WELL_WITHIN


@kernel
def relax_acceptance(memory):
    """Ask of the next orbit that the motion is within the margin."""
    if memory.wanted[SHARE] < _WITHIN:
        memory.wanted[CLOSER], memory.wanted[SHARE] = math.inf, _WITHIN


@inner_kernel
def record_anchor(memory, column, event, contact_state, time, sign):
    """Record an anchor except for its state."""
    memory.events[column] = event
    memory.anchors[column, COS] = contact_state.cos
    memory.anchors[column, SIN] = contact_state.sin
    memory.anchors[column, TIME] = time
    memory.anchors[column, SIGN] = sign


@inner_kernel
def turned(memory, now, then):
    """Distance between the load phases of two recorded anchors, |delta cos| + |delta sin|."""
    anchors = memory.anchors
    return abs(anchors[now, COS] - anchors[then, COS]) + abs(anchors[now, SIN] - anchors[then, SIN])


@inner_kernel
def halves_between(memory, now, then):
    """Half periods between two anchors; 0 if one cannot be the recurrence of the other."""
    anchors = memory.anchors
    halves = half_periods(anchors[now, TIME] - anchors[then, TIME])
    # after an odd number of half periods the motion recurs as its mirror image
    mirrored = anchors[now, SIGN] != anchors[then, SIGN]
    return halves if (halves % 2 == 1) == mirrored else 0


@kernel
def settled(distance, old_distance, tolerance):
    """Whether marching has converged: the geometric extrapolation of two recurrence distances is below
    tolerance.
    """
    rate = min(distance / old_distance, 0.999999) if old_distance > 0.0 else 0.0
    return distance * rate <= 10.0 * tolerance * (1.0 - rate)
