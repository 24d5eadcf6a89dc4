"""When a motion with mu > 1 is searched for a long period, and when it is taken as irregular."""

from .compiler import kernel

#: Longest recurrence that is looked for [half periods of the excitation].
LONGEST_RECURRENCE = 512

#: Distance, relative to the motion, of a return after a long period.
RETURNED_AFTER_LONG = 1e-6

#: Excitation periods after which a motion that does not return, and whose averages are stationary, is taken
#: as irregular; and the share of the periods that may be followed, if that is more.  A motion that is not
#: stationary is followed twice as long.
_FEWEST_CYCLES = 512.0
_SHARE_OF_CYCLES = 0.25

#: Excitation periods shown of an irregular motion.
WINDOW = 8

#: Half periods of the excitation after which the first search for long periods is made.
_FIRST_SEARCH = 80


@kernel
def enough_cycles(cycles):
    """Excitation periods after which a motion may be taken as irregular, of `cycles` that are allowed."""
    return max(_FEWEST_CYCLES, _SHARE_OF_CYCLES * cycles)


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
