"""Places of patterns in tables: patterns are found by their words, and those looked for last are kept.

A pattern is a digit per contact, a bit if it is only held or not.  Where the tables have room for all of
them, its number is its place.  Else a hash of its words names some places, one of which is its own, and a new
pattern takes that of them which was not looked for the longest.
"""

from typing import NamedTuple

import numpy as np

from ..compiler import entry, kernel

#: Bits of a word: whole digits of 1, 2, ... 16 bits, and no sign.
_WORD = 48

#: Places that the hash of a pattern names.
_WAYS = 8

#: A prime above the number of places: words are added up modulo it, each times a power of the second number.
_PRIME, _BASE = 1_000_003, 31


class Keys(NamedTuple):
    """The patterns of P places; their last rows belong to the pattern that is looked for."""

    words: np.ndarray  # (P + 1, W) int
    used: np.ndarray  # (P + 1,) int: when the pattern of a place was last looked for, 0: none yet; now


@entry
def make_keys(contacts, bits, places):
    """Allocate the keys of patterns with a digit of a number of bits per contact."""
    words = (contacts * bits + _WORD - 1) // _WORD
    return Keys(np.zeros((places + 1, words), np.int64), np.zeros(places + 1, np.int64))


@kernel
def forget_keys(keys):
    """Empty all places."""
    for k in range(keys.used.size - 1):
        keys.used[k] = 0


@kernel
def begin_key(keys):
    """Begin the pattern that is looked for: all digits are 0."""
    for w in range(keys.words.shape[1]):
        keys.words[keys.used.size - 1, w] = 0


@kernel
def put_digit(keys, bits, j, digit):
    """Set the digit of contact j, of the given number of bits."""
    keys.words[keys.used.size - 1, j * bits // _WORD] += digit << (j * bits % _WORD)


@kernel
def _is_at(keys, k):
    """Whether the pattern that is looked for has place k."""
    same = keys.used[k] != 0
    for w in range(keys.words.shape[1]):
        same = same and keys.words[k, w] == keys.words[keys.used.size - 1, w]
    return same


@kernel
def _first_place(keys, direct):
    """First of the places of the pattern that is looked for, and their number; `direct`: see `find_key`."""
    places = keys.used.size - 1
    if direct:
        return keys.words[places, 0], 1
    ways = min(_WAYS, places)
    hashed = 0
    for w in range(keys.words.shape[1]):
        hashed = (hashed * _BASE + keys.words[places, w]) % _PRIME
    return hashed % (places // ways) * ways, ways


@kernel
def find_key(keys, direct):
    """Return (place, whether it is new there) of the pattern that is looked for.

    direct : whether its only word is its place
    """
    places = keys.used.size - 1
    keys.used[places] += 1
    first, ways = _first_place(keys, direct)
    oldest = first
    for k in range(first, first + ways):
        if _is_at(keys, k):
            keys.used[k] = keys.used[places]
            return k, False
        if keys.used[k] < keys.used[oldest]:
            oldest = k
    for w in range(keys.words.shape[1]):
        keys.words[oldest, w] = keys.words[places, w]
    keys.used[oldest] = keys.used[places]
    return oldest, True
