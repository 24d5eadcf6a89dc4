"""Names, types and valid values of the answers to design questions."""

import numpy as np

from .. import checks, regimes
from .labels import Label

QUESTIONS = ("least-peak", "no-stop", "stuck", "at-most", "margin", "robust", "two-forces")

#: How the least peak comes about.
#: "threshold": from there on nothing moves.
KINDS_OF_OPTIMUM = ("smooth", "two equal peaks", "plateau", "at the bound", "threshold")

_PEAK, _SEARCH, _OVER_R, _RATIO = ("peak",), ("beta_search",), ("r_search",), ("ratio_search",)
_FRICTION = "ratio of kinetic friction force to load amplitude"
_RESPONSE = "largest response over the band, over P/k1 (Y), or of a force over P"


def _beta(meaning: str, dims: tuple[str, ...] = (), *, nan: bool = False, inf: bool = True) -> Label:
    return Label(np.float64, meaning, dims, least=0.0, nan=nan, inf=inf)


def _r(meaning: str, dims: tuple[str, ...] = (), *, nan: bool = False) -> Label:
    return Label(np.float64, meaning, dims, least=0.0, most=checks.LARGEST_RATIO, nan=nan)


#: Axes of the answers.
DESIGN_AXES = {
    "peak": Label(np.float64, f"peaks at the answer, from the highest down: {_RESPONSE}", _PEAK, least=0.0,
                  inf=True),
    "beta_search": _beta(f"{_FRICTION}, searched", _SEARCH, inf=False),
    "r_search": _r("frequency ratios, searched", _OVER_R),
    "offset": Label(np.float64, "relative change of the friction", ("offset",), least=-1.0),
    "interval": Label(np.int64, "interval, counted from 1", ("interval",), least=1),
    "sample": Label(np.int64, "sample of the structure, counted from 1", ("sample",), least=1),
    "curve": _beta(f"{_FRICTION} of a response curve; infinite: stuck", ("curve",)),
    "ratio_search": Label(np.float64, "ratio of the second contact, searched", _RATIO, least=0.0),
}  # fmt: skip

#: Answers, and what explains them.
ANSWERS = {
    "question": Label(np.str_, "design question", (), texts=QUESTIONS),
    "beta": _beta(f"{_FRICTION}: the answer; of margin the working point"),
    "mu": Label(np.float64, "ratio of static to kinetic friction force", (), least=1.0),
    "kind": Label(np.str_, "kind of optimum", (), texts=KINDS_OF_OPTIMUM),
    "peak_r": _r("frequency ratio of the peak", _PEAK),
    "peak_regime": Label(
        np.int8, "motion regime at the peak", _PEAK, regimes.REGIMES,
        also=regimes.BELT_REGIMES[len(regimes.REGIMES) :],
    ),
    "peak_stops": Label(np.float64, "stops per cycle at the peak, the most of all contacts", _PEAK, least=0.0,
                        nan=True),
    "peak_of_beta": Label(np.float64, _RESPONSE, _SEARCH, least=0.0, inf=True),
    "unknown_of_beta": Label(np.int32, "cells of the band without a periodic steady state; there the largest "
                             "response is infinite", _SEARCH, least=0),
    "peak_at_offset": Label(np.float64, f"{_RESPONSE}, with other friction than the answer", ("offset",),
                            least=0.0, inf=True, nan=True),
    "second_beta": _beta("friction ratio of the second-best minimum within 5 %", nan=True),
    "second_peak": Label(np.float64, f"{_RESPONSE}, at the second-best minimum", (), least=0.0, nan=True),
    "quantile": Label(np.float64, "share of the samples whose response is at most that of the answer", (),
                      least=0.0, most=1.0),
    "peak_of_sample": Label(np.float64, f"{_RESPONSE}, of each sample at the answer", ("sample",), least=0.0,
                            inf=True),
    "second": Label(np.int64, "contact whose ratio is varied, counted from 1", (), least=1),
    "second_ratio": Label(np.float64, "friction of the second contact over beta: the answer", (), least=0.0),
    "peak_of_ratio": Label(np.float64, f"{_RESPONSE}, least over the friction at each ratio", _RATIO,
                           least=0.0, inf=True),
    "beta_of_ratio": _beta(f"{_FRICTION} with the least peak at each ratio", _RATIO),
    "spread": Label(np.float64, "relative spread of the friction", (), least=0.0, most=1.0),
    "limit": Label(np.float64, "largest response that is allowed", (), least=0.0),
    "beta_no_stop": _beta("largest friction ratio without a stop anywhere in the band; NaN if that depends "
                          "on the start", nan=True),
    "beta_stuck": _beta("least friction ratio that holds over the band, whatever the start", nan=True),
    "beta_no_stop_some_starts": _beta("largest friction ratio with which motions without stops exist all "
                                      "over the band: from some starts, not from all", nan=True),
    "beta_stuck_some_starts": _beta("least friction ratio with which contacts that are stuck stay so over "
                                    "the band: from some starts (one mass: from rest), not from all"),
    "interval_begin": _beta("friction ratio at which an allowed range begins", ("interval",)),
    "interval_end": _beta("friction ratio at which an allowed range ends", ("interval",)),
    "at_r": _r("frequency ratio that decides, or of the working point", nan=True),
    "beta_lim": _beta("boundary of motion without stops at the working point", nan=True),
    "beta_stick": _beta("boundary to permanent sticking at the working point"),
    "margin_beta_lim": Label(np.float64, "beta_lim/beta - 1", (), least=-1.0, nan=True, inf=True),
    "margin_beta_stick": Label(np.float64, "beta_stick/beta - 1", (), least=-1.0, inf=True),
    "nearest_r_on_beta_lim": _r("nearest frequency ratio at which beta_lim is beta", nan=True),
    "nearest_r_on_beta_stick": _r("nearest frequency ratio at which beta_stick is beta", nan=True),
    "margin_r": Label(np.float64, "nearest_r_on_beta_lim/r - 1", (), least=-1.0, nan=True),
    "margin_r_stick": Label(np.float64, "nearest_r_on_beta_stick/r - 1", (), least=-1.0, nan=True),
    "beta_lim_of_r": _beta("boundary of motion without stops", _OVER_R, nan=True),
    "beta_stick_of_r": _beta("boundary to permanent sticking", _OVER_R),
    "beta_stuck_of_r": _beta("friction ratio from which every motion comes to rest", _OVER_R),
    "response_of_r": Label(np.float64, "response over P/k1 (Y), or of a force over P", ("curve", "r_search"),
                           least=0.0, inf=True, nan=True),
    "friction_force": Label(np.float64, "kinetic friction force: the answer", (), least=0.0, inf=True,
                            units="N"),
    "interval_begin_N": Label(np.float64, "friction force at which an allowed range begins", ("interval",),
                              least=0.0, inf=True, units="N"),
    "interval_end_N": Label(np.float64, "friction force at which an allowed range ends", ("interval",),
                            least=0.0, inf=True, units="N"),
    "peak_frequency": Label(np.float64, "frequency of the peak", _PEAK, least=0.0, units="Hz"),
    "peak_m": Label(np.float64, "peaks at the answer", _PEAK, least=0.0, inf=True, units="m"),
    "peak_N": Label(np.float64, "peaks at the answer", _PEAK, least=0.0, inf=True, units="N"),
}  # fmt: skip

DESIGN = {**DESIGN_AXES, **ANSWERS}
