"""Names, types and valid values of the answers to design questions."""

from functools import cache

import numpy as np

from .. import checks, regimes
from .labels import Label
from .questions import records

#: How the least peak comes about.
#: "threshold": from there on nothing moves.
KINDS_OF_OPTIMUM = ("smooth", "two equal peaks", "plateau", "at the bound", "threshold")

_PEAK, _SEARCH, _OVER_R = ("peak",), ("beta_search",), ("r_search",)

#: Meanings.
FRICTION = "ratio of kinetic friction force to load amplitude"
RESPONSE = "largest response over the band, over P/k1 (Y), or of a force over P"


def beta_label(meaning: str, dims: tuple[str, ...] = (), *, nan: bool = False, inf: bool = True) -> Label:
    """A friction ratio."""
    return Label(np.float64, meaning, dims, least=0.0, nan=nan, inf=inf)


def size_label(meaning: str, dims: tuple[str, ...] = (), *, nan: bool = False, units: str = "1") -> Label:
    """A response or a force."""
    return Label(np.float64, meaning, dims, least=0.0, nan=nan, inf=True, units=units)


def r_label(meaning: str, dims: tuple[str, ...] = (), *, nan: bool = False) -> Label:
    """A frequency ratio."""
    return Label(np.float64, meaning, dims, least=0.0, most=checks.LARGEST_RATIO, nan=nan)


#: Axes and variables that several questions have; those of one are in its record.
_COMMON = {
    "peak": size_label(f"peaks at the answer, from the highest down: {RESPONSE}", _PEAK),
    "beta_search": beta_label(f"{FRICTION}, searched", _SEARCH, inf=False),
    "r_search": r_label("frequency ratios, searched", _OVER_R),
    "offset": Label(np.float64, "relative change of the friction", ("offset",), least=-1.0),
    "curve": beta_label(f"{FRICTION} of a response curve; infinite: stuck", ("curve",)),
    "beta": beta_label(f"{FRICTION}: the answer; of margin the working point"),
    "mu": Label(np.float64, "ratio of static to kinetic friction force", (), least=1.0),
    "kind": Label(np.str_, "kind of optimum", (), texts=KINDS_OF_OPTIMUM),
    "peak_r": r_label("frequency ratio of the peak", _PEAK),
    "peak_regime": Label(
        np.int8,
        "motion regime at the peak",
        _PEAK,
        regimes.REGIMES,
        also=regimes.BELT_REGIMES[len(regimes.REGIMES) :],
    ),
    "peak_stops": Label(
        np.float64, "stops per cycle at the peak, the most of all contacts", _PEAK, least=0.0, nan=True
    ),
    "peak_of_beta": size_label(RESPONSE, _SEARCH),
    "unknown_of_beta": Label(
        np.int32,
        "cells of the band without a periodic steady state; there the largest response is infinite",
        _SEARCH,
        least=0,
    ),
    "peak_at_offset": size_label(f"{RESPONSE}, with other friction than the answer", ("offset",), nan=True),
    "second_beta": beta_label("friction ratio of the second-best minimum within 5 %", nan=True),
    "second_peak": Label(np.float64, f"{RESPONSE}, at the second-best minimum", (), least=0.0, nan=True),
    "beta_no_stop": beta_label(
        "largest friction ratio without a stop anywhere in the band; NaN if that depends on the start",
        nan=True,
    ),
    "beta_stuck": beta_label("least friction ratio that holds over the band, whatever the start", nan=True),
    "beta_no_stop_some_starts": beta_label(
        "largest friction ratio with which motions without stops exist all "
        "over the band: from some starts, not from all",
        nan=True,
    ),
    "beta_stuck_some_starts": beta_label(
        "least friction ratio with which contacts that are stuck stay so over "
        "the band: from some starts (one mass: from rest), not from all"
    ),
    "beta_unique": beta_label(
        "friction ratio up to which the steady state is proved to be the same from every start"
    ),
    "at_r": r_label("frequency ratio that decides, or of the working point", nan=True),
    "beta_lim_of_r": beta_label("boundary of motion without stops", _OVER_R, nan=True),
    "beta_stick_of_r": beta_label("boundary to permanent sticking", _OVER_R),
    "beta_stuck_of_r": beta_label("friction ratio from which every motion comes to rest", _OVER_R),
    "response_of_r": size_label(
        "response over P/k1 (Y), or of a force over P", ("curve", "r_search"), nan=True
    ),
    "friction_force": size_label("kinetic friction force: the answer", units="N"),
    "peak_frequency": Label(np.float64, "frequency of the peak", _PEAK, least=0.0, units="Hz"),
    "peak_m": size_label("peaks at the answer", _PEAK, units="m"),
    "peak_N": size_label("peaks at the answer", _PEAK, units="N"),
}


@cache
def answer_labels() -> dict[str, Label]:
    """Labels of all axes and variables of answers."""
    question = Label(np.str_, "design question", (), texts=tuple(one.name for one in records()))
    own = {name: label for one in records() for name, label in one.labels.items()}
    return {"question": question, **_COMMON, **own}


def answer_axes() -> tuple[str, ...]:
    """Names of the axes of answers."""
    return tuple(name for name, label in answer_labels().items() if label.dims == (name,))
