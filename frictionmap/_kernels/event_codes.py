"""Codes of the events that end a slide, of one mass and of structures, and sequences of them."""

from typing import NamedTuple

import numpy as np

#: Event codes: what follows the end of a slide.
REVERSE = 0  # turns without a stop
STOP_THEN_BACK = 1  # stops, then slides in the opposite direction
STOP_THEN_ON = 2  # stops, then slides on in the same direction
GRAZING = 3  # the velocity touches zero and the slide continues: the load exceeds mu b in its direction
STUCK = 4  # sticks permanently

#: Code for a slide whose end was not found within the scan steps allowed.
NO_END = -1


class EventSequence(NamedTuple):
    """Events that end the slides of one recurrence, in order."""

    events: np.ndarray  # ring buffer of event codes
    first: int  # index of the first event in it
    count: int
