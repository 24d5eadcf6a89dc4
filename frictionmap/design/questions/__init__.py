"""The design questions, a file for each: its function, and a record of everything that is stated about it.

The functions import what computes the answer when they are called: the records are read by every command
that reads a configuration.

=============  ==========================================================================================
module         what is in it
=============  ==========================================================================================
record         the record of a question
keys           keys of the table [design] that several questions have
sentences      answers in sentences, and numbers with units
rows           rows of summaries that several questions have
at_most        all friction with which a response stays within a limit over a band
least_peak     the friction with the smallest peak response over a band of frequencies
robust         the friction whose worst response within its spread, or over samples, is least
two_forces     the two friction forces with the least largest response over a band
no_stop        the most friction without a stop anywhere in a band
stuck          the least friction that holds over a band
no_squeal      the least belt speed without squeal
no_separation  the least friction, or preload, from which contacts never open over a band
margin         how far a working point is from the boundaries of its regime
=============  ==========================================================================================
"""

from .at_most import AT_MOST, at_most
from .least_peak import LEAST_PEAK, least_peak
from .margin import MARGIN, margin
from .no_separation import NO_SEPARATION, no_separation
from .no_squeal import NO_SQUEAL, no_squeal
from .no_stop import NO_STOP, no_stop
from .robust import ROBUST, robust
from .stuck import STUCK, stuck
from .two_forces import TWO_FORCES, two_forces

__all__ = [
    "at_most", "least_peak", "margin", "no_separation", "no_squeal", "no_stop", "robust", "stuck",
    "two_forces",
]  # fmt: skip

#: All questions, in the order of menus; the first one is the default.
RECORDS = (LEAST_PEAK, NO_STOP, STUCK, AT_MOST, MARGIN, ROBUST, TWO_FORCES, NO_SQUEAL, NO_SEPARATION)
