"""Whether a record is a free decay: its turning points, and how far a fit may be from the samples."""

import numpy as np

from ...errors import InputError
from ..signals.samples import largest_gap
from ..signals.turning_points import (
    TurningPoints,
    grows,
    noise_level,
    regular_run,
    resolution,
    turning_points,
    undersampled,
    without_spikes,
)
from ..statistics.least_squares import undetermined
from ..statistics.levels import MISFIT, MISFIT_SHARE
from .fit import DecayFit
from .problem import Record

#: Correlated noise swings farther than that between samples suggests: turning points are sought beyond
#: these multiples of the noise, until nearly all of them are half a period apart, but not with fewer points.
_MORE_NOISE, _MOSTLY_REGULAR, _FEW = (2.0, 3.0, 4.0), 0.9, 5

#: Slopes, each over its length, whose least singular value is below this share of the largest do not
#: determine all unknowns: an error of a millionth, as of a corner frequency, would move them by all they are.
_SEPARATE = 1e-6

#: Spikes make turning points that are not half a period apart; noise and a mass that is held make few.
_REGULAR = 0.5


def checked_turning_points(time: np.ndarray, x: np.ndarray) -> TurningPoints:
    """Turning points of a record that is a free decay.

    Raises
    ------
    InputError
        Nothing moves, there are too few samples per cycle or fewer than 3 extrema, or the amplitude grows.
    """
    if float(np.ptp(x)) <= 2.0 * resolution(x):
        raise InputError(
            f"cannot fit x: it does not move by more than its resolution ({resolution(x):g}); check the data"
        )
    if wrong := undersampled(x):
        raise InputError(f"cannot fit x: sampling rate too low, {wrong}; sample faster")
    points = _turning_points(time, x)
    if points.time.size < 2:  # the last extremum is where it rests, or where the record ends
        gap = largest_gap(time)
        outside = f" outside a gap of {gap:.4g} s" if gap else ""
        raise InputError(
            f"cannot estimate damping: record too short, fewer than 3 extrema in {x.size} samples"
            f"{outside}; measure more cycles"
        )
    if grows(points, noise_level(x)):
        raise InputError(
            f"cannot fit x as a free decay: its amplitude grows (swings grow from "
            f"{abs(points.place[1] - points.place[0]):.4g} to {abs(points.place[-1] - points.place[-2]):.4g}"
            "); choose a window of one decay"
        )
    return points


def _turning_points(time: np.ndarray, x: np.ndarray) -> TurningPoints:
    """Turning points; if many are noise or spikes, those beyond more noise, or of a record without spikes."""
    points = turning_points(time, x)
    for larger in _MORE_NOISE:
        if points.time.size < _FEW or _share_regular(points) > _MOSTLY_REGULAR:
            break
        fewer = turning_points(time, x, larger)
        if fewer.time.size < _FEW:
            break
        if _share_regular(fewer) > _share_regular(points):
            points = fewer
    if points.time.size < 2 or _share_regular(points) > _REGULAR:
        return points
    calm = turning_points(time, without_spikes(x))
    return calm if calm.time.size > 1 and _share_regular(calm) > _share_regular(points) else points


def _share_regular(points: TurningPoints) -> float:
    """The share of turning points in the longest run of those half a period apart."""
    run = regular_run(points)
    return (run.stop - run.start) / points.time.size


def check_misfit(x: np.ndarray, rms: float) -> None:
    """Refuse a fit whose residuals are far above the noise between samples.

    Raises
    ------
    InputError
        The record does not follow a free decay, or no fit of it was found.
    """
    noise = noise_level(x)
    if rms > MISFIT * noise and rms > MISFIT_SHARE * float(np.std(x)):
        raise InputError(
            f"cannot fit x as a free decay: the residuals ({rms:.4g} rms) are far above the noise between "
            f"samples ({noise:.4g}); choose a window of one decay, without gaps, impacts or other motion"
        )


def check_identifiable(record: Record, fit: DecayFit) -> None:
    """Refuse a record that does not determine parameters separately.

    Polynomials of a wander may take the place of a slow state of a filter and of the zero: these then have
    large errors, which are stated.

    Raises
    ------
    InputError
        The samples see of several parameters, or of parameters and states of filters, only what they have
        in common.
    """
    indices, _ = undetermined(fit.problem, fit.solution, _SEPARATE)
    together = [record.names[index] for index in indices if index < len(record.names)]
    if not together or record.terms:
        return
    words = " and ".join(together)
    if (indices >= len(record.names)).any() and record.sensor is not None:
        raise InputError(
            f"cannot identify {words}: not identifiable beside the state of the filters at the beginning of "
            f"this record; omit a filter that is too slow to be seen in it, or hold {together[-1]} in known"
        )
    raise InputError(
        f"cannot identify {words} together: not identifiable from this record; hold one of them in known"
    )
