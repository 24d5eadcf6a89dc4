"""`ring_down`: frequency and damping of a decay over its amplitude, from its turning points."""

from typing import NamedTuple

import numpy as np
import xarray as xr

from .. import checks
from ..datasets.labels import SCALES
from ..errors import InputError

#: Halvings of an interval to a turning point, to rounding.
_HALVINGS = 54

#: Share of the largest velocity that is rounding error.
_ROUNDING = 1e-12

_NEEDED = ("time", "x", "v", "acceleration", "drive")


class _Turns(NamedTuple):
    """Where a displacement turns."""

    time: np.ndarray
    x: np.ndarray


def ring_down(ds: xr.Dataset, *, dof: int = 1, start: float | None = None) -> xr.Dataset:
    """Frequency and damping ratio over amplitude of a motion that rings down.

    Two swings s_1, s_2 between three turning points in a row, from t_0 to t_2, have the amplitude
    sqrt(s_1 s_2)/2, the frequency 1/(t_2 - t_0), and with d = ln(s_1/s_2) the damping ratio
    d/sqrt(pi^2 + d^2).  Of one linear mode these are exact; of a joint its numbers at this amplitude.
    Swings need no zero, so that a place of rest beside the middle does no harm.

    Parameters
    ----------
    ds : Dataset
        One motion of `history` with its samples.
    dof : int
        The mass.
    start : float, optional
        Time from which turning points count, in the unit of `time`; default: the end of the load.

    Returns
    -------
    xarray.Dataset
        Over `turn`, the middle ones of three: `time` and `x` of the turning point, `amplitude` (unit of `x`),
        `frequency` in Hz where `time` is in seconds, else angular over omega_1, and `damping_ratio`.

    Raises
    ------
    InputError
        It is no single motion with its samples, or has fewer than three turning points.

    Notes
    -----
    Between samples the velocity is a cubic: with 20 samples in a period frequencies are right to 1e-5.

    Examples
    --------
    >>> import frictionmap as fm
    >>> silence = fm.Record([0.0, 0.0], dt=0.1, quantity="force")
    >>> ds = fm.history(fm.System(), silence, beta=0.1, start={"x": [2.0], "v": [0.0]})
    >>> found = fm.ring_down(ds)
    >>> found.frequency.values.round(6).tolist()[:2], found.x.values.round(6).tolist()[:2]
    ([1.0, 1.0], [-1.8, 1.6])
    """
    time, x, v, acceleration, drive = _histories(ds, dof)
    loaded = np.flatnonzero(drive)
    ends = time[loaded[-1]] if loaded.size else time[0]
    begin = ends if start is None else checks.number(start, "start", least=0.0)
    there = time >= begin
    seconds = ds["time"].attrs.get("units") == "s"
    omega = 2.0 * np.pi * ds.attrs[SCALES["frequency"]] if seconds else 1.0
    turns = _turns(time[there] * omega, x[there], v[there], acceleration[there])
    if turns.x.size < 3:
        raise InputError(
            "start", f"must leave three turning points at least; got {turns.x.size} from {begin:g} on"
        )
    swing = np.abs(np.diff(turns.x))
    fall = np.log(swing[:-1] / swing[1:])
    rate = 2.0 * np.pi / (turns.time[2:] - turns.time[:-2])
    over = "Hz" if seconds else "1"
    frequency = {"long_name": "frequency" + ("" if seconds else ", over omega_1"), "units": over}
    found = {
        "time": (turns.time[1:-1] / omega, dict(ds["time"].attrs)),
        "x": (turns.x[1:-1], dict(ds["x"].attrs)),
        "amplitude": (
            0.5 * np.sqrt(swing[:-1] * swing[1:]), {"long_name": "amplitude, over P/k1", "units": "1"}
        ),
        "frequency": (rate * (omega / (2.0 * np.pi) if seconds else 1.0), frequency),
        "damping_ratio": (
            fall / np.sqrt(np.pi**2 + fall**2), {"long_name": "damping ratio", "units": "1"}
        ),
    }  # fmt: skip
    return xr.Dataset({name: ("turn", *one) for name, one in found.items()})


def _histories(ds: xr.Dataset, dof: int) -> list[np.ndarray]:
    """Time, displacement, velocity and acceleration of a mass, and the load, of one motion."""
    checks.instance(ds, "ds", xr.Dataset)
    missing = [name for name in _NEEDED if name not in ds.variables]
    if missing:
        raise InputError("ds", f"must be of history with its samples; got no {missing[0]}")
    if dof not in ds["dof"].values:
        raise InputError("dof", f"must be one of {checks.one_line(ds['dof'].values.tolist())}; got {dof}")
    one = ds[list(_NEEDED[1:])]
    one = one.sel(dof=dof) if "dof" in one.dims else one
    several = [dim for dim in one.dims if dim != "time" and one.sizes[dim] > 1]
    if several:
        raise InputError("ds", f"must be one motion; got {one.sizes[several[0]]} of {several[0]}")
    return [ds["time"].values, *(one[name].values.ravel() for name in _NEEDED[1:])]


def _turns(time: np.ndarray, x: np.ndarray, v: np.ndarray, slope: np.ndarray) -> _Turns:
    """Turning points, of a velocity that is a cubic between samples by its values and slopes there."""
    # a velocity that is zero to rounding has the sign that it had before
    moves = np.abs(v) > _ROUNDING * np.abs(v).max(initial=0.0)
    moving = np.maximum.accumulate(np.where(moves, np.arange(v.size), 0))
    sense, h = np.sign(v)[moving], np.diff(time)
    k = np.flatnonzero((sense[:-1] * sense[1:] < 0.0) & (h > 0.0))
    rise, left, right = v[k + 1] - v[k], h[k] * slope[k], h[k] * slope[k + 1]
    cubic = (v[k], left, 3.0 * rise - 2.0 * left - right, left + right - 2.0 * rise)
    low, high = np.zeros(k.size), np.ones(k.size)
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        value = ((cubic[3] * middle + cubic[2]) * middle + cubic[1]) * middle + cubic[0]
        ahead = sense[k] * value > 0.0
        low, high = np.where(ahead, middle, low), np.where(ahead, high, middle)
    way = ((cubic[3] / 4.0 * low + cubic[2] / 3.0) * low + cubic[1] / 2.0) * low + cubic[0]
    found = _Turns(time[k] + low * h[k], x[k] + h[k] * low * way)
    if moves[0]:
        return found
    return _Turns(np.append(time[0], found.time), np.append(x[0], found.x))  # released from rest
