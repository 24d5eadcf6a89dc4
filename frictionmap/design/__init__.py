"""Design questions: which friction gives the least response, keeps it in a limit, holds or never stops.

=============  ==========================================================================================
module         what is in it
=============  ==========================================================================================
watching       cancelling a question while it is computed
extremes       maxima of functions of one variable, many at a time
minimum        minima and crossings of curves with kinks
band           the frequency band, and the frequencies at which curves over it are sampled
grading        frequencies at which boundaries are sampled: close together beside resonances
limits         boundaries of the regimes over a band: their least and largest values
nearest        the frequency next to a working point at which a boundary is at its friction
stops          the most friction without a stop whatever the start
responses      the response that a design is about, at points (r, beta) of any system
performance    the largest response over the band as a function of friction, with its peaks
task           checks of arguments, the range of friction that is searched
samples        uncertain friction and uncertain structures, as arguments
optimum        the friction with the smallest peak response, also for uncertain friction
sampled        the same for samples of an uncertain structure: a quantile of their curves
force_plane    the least peak in the plane of two friction forces
ranges         the ranges of friction in which the response stays within a limit
answers        answers as datasets
questions      the design questions, a file for each: its function, and what is stated about it
configuration  the table [design] of a configuration
=============  ==========================================================================================
"""

from importlib import import_module

from .questions import *  # noqa: F403 (the functions of the questions)
from .questions import __all__ as _questions
from .samples import Samples

__all__ = ["Samples", "least_median", *_questions]  # noqa: F405


def __getattr__(name: str) -> object:
    if name == "least_median":  # about motions in time, which stand below
        return import_module("frictionmap.motions.choice").least_median
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(__all__)
