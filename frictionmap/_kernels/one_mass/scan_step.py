"""Motion between events of the oscillator ``r^2 z'' + 2 zeta r z' + z + b sgn(z') = cos(theta)``.

Every SDOF system has this form: divide ``z`` and ``beta`` of the theory by the amplitude A of the load in the
contact (1 for a fixed wall, |r^2 - 2 i zeta r| for a joined base-wall), and count theta from a maximum of
that load.  The state is (z, z', cos theta, sin theta); no time accumulates.

Motion is counted in scan steps of length h: ``w = h z'``, and x in [0, 1] inside a step.  One step is a fixed
affine map (`step_constants`), so that the scan calls no function.  Inside a step the solution is its Taylor
series in x (`expand`), which needs no special case for resonance, for zeta = 1 or for r -> inf, and is exact
to rounding because h is a small part of the fastest period.
"""

import math
from typing import NamedTuple

import numpy as np

from ..closed_form import fastest_rate
from ..compiler import entry, kernel
from ..compiler.vectors import LANES
from ..taylor_series import series_terms

#: Size of `Step.ahead`, and where the cosines begin in it.
TURNS = 15 * LANES
AHEAD = 17 * LANES


class Step(NamedTuple):
    """Constants of one scan step of length h; all fields depend on (r, zeta, steps) only."""

    h: float  # length in tau
    stiffness: float  # (h/r)^2
    damping: float  # 2 zeta h/r
    terms: int  # terms of the Taylor series
    series: np.ndarray  # (5, terms) series of w for unit z, w, cos, sin and constant load
    zz: float  # free motion: z <- zz z + zw w,  w <- wz z + ww w
    zw: float
    wz: float
    ww: float
    z_cos: float  # response from rest to cos(theta), sin(theta) and 1
    w_cos: float
    z_sin: float
    w_sin: float
    z_one: float
    w_one: float
    cos: float
    sin: float
    ahead: np.ndarray  # (AHEAD,) state at the next eight nodes, see `_fill_ahead`


@kernel
def _unit_series(h, stiffness, damping, terms, z, w, c, s, constant, out):
    """Compute the Taylor coefficients in x of w under the load c cos(h x) - s sin(h x) + constant.

    The recurrence is the equation of motion; the coefficients of z follow as z_k = out[k-1]/k.

    Parameters
    ----------
    h : length of the step in tau
    stiffness, damping : (h/r)^2 and 2 zeta h/r
    terms : number of coefficients
    z, w : initial state
    c, s, constant : load
    out : (terms,) filled with the coefficients
    """
    z_k = z
    next_z = w
    square = h * h
    f_this = c + constant
    f_next = -s * h
    out[0] = w
    for k in range(terms - 1):
        factor = 1.0 / ((k + 1.0) * (k + 2.0))
        new = (stiffness * (f_this - z_k) - damping * (k + 1.0) * next_z) * factor
        z_k = next_z
        next_z = new
        out[k + 1] = (k + 2.0) * new
        f_k = f_this if k > 0 else c  # a constant has no further coefficients
        f_this = f_next
        f_next = -square * factor * f_k


@kernel
def _sum_series(series, z):
    """State (z, w) at the end of the step."""
    velocity = 0.0
    rise = 0.0
    for k in range(series.size - 1, -1, -1):
        velocity += series[k]
        rise += series[k] / (k + 1.0)
    return z + rise, velocity


@kernel
def expand(step, b, z, w, acceleration, c, s, out):
    """Compute the Taylor coefficients in x of the upward velocity w.

    Parameters
    ----------
    step : Step
    b : kinetic friction over load amplitude
    z, w : state at x = 0
    acceleration : h^2 z'' there, used as given because it is known exactly at the end of a stop
    c, s : cosine and sine of the load phase there
    out : (terms,) filled with the coefficients
    """
    series = step.series
    for k in range(step.terms):
        out[k] = (
            z * series[0, k] + w * series[1, k] + c * series[2, k] + s * series[3, k]
            - b * series[4, k]
        )  # fmt: skip
    out[1] = acceleration


@kernel
def _fill_ahead(step):
    """Fill what unit z, w, cos, sin and constant load contribute to z, w and h^2 z'' at the next eight nodes,
    one node per lane; then the cosines and sines of 1, 2, ..., 8 step lengths.
    """
    ahead = step.ahead
    for k in range(LANES):
        ahead[TURNS + k], ahead[TURNS + LANES + k] = (
            math.cos((k + 1.0) * step.h),
            math.sin((k + 1.0) * step.h),
        )
    for unit in range(5):
        z = 1.0 if unit == 0 else 0.0
        w = 1.0 if unit == 1 else 0.0
        c = 1.0 if unit == 2 else 0.0
        s = 1.0 if unit == 3 else 0.0
        one = 1.0 if unit == 4 else 0.0
        for k in range(LANES):
            z_new = step.z_cos * c + step.z_sin * s + step.z_one * one + step.zz * z + step.zw * w
            w = step.w_cos * c + step.w_sin * s + step.w_one * one + step.wz * z + step.ww * w
            z = z_new
            cosine, sine = ahead[TURNS + k], ahead[TURNS + LANES + k]
            if unit == 2:
                c, s = cosine, sine
            elif unit == 3:
                c, s = -sine, cosine
            place = 3 * LANES * unit + k
            ahead[place], ahead[place + LANES] = z, w
            ahead[place + 2 * LANES] = step.stiffness * (c + one - z) - step.damping * w


@entry
def step_constants(r, zeta, steps):
    """Build the `Step` of frequency ratio r > 0 for `steps` scan steps per period of the fastest part."""
    a = 1.0 / r
    turn, terms = series_terms(steps)
    h = turn / max(1.0, fastest_rate(a, zeta))
    stiffness = (a * h) * (a * h)
    damping = 2.0 * zeta * a * h
    series = np.empty((5, terms))
    _unit_series(h, stiffness, damping, terms, 1.0, 0.0, 0.0, 0.0, 0.0, series[0])
    _unit_series(h, stiffness, damping, terms, 0.0, 1.0, 0.0, 0.0, 0.0, series[1])
    _unit_series(h, stiffness, damping, terms, 0.0, 0.0, 1.0, 0.0, 0.0, series[2])
    _unit_series(h, stiffness, damping, terms, 0.0, 0.0, 0.0, 1.0, 0.0, series[3])
    _unit_series(h, stiffness, damping, terms, 0.0, 0.0, 0.0, 0.0, 1.0, series[4])
    zz, wz = _sum_series(series[0], 1.0)
    zw, ww = _sum_series(series[1], 0.0)
    z_cos, w_cos = _sum_series(series[2], 0.0)
    z_sin, w_sin = _sum_series(series[3], 0.0)
    z_one, w_one = _sum_series(series[4], 0.0)
    step = Step(
        h, stiffness, damping, terms, series, zz, zw, wz, ww,
        z_cos, w_cos, z_sin, w_sin, z_one, w_one, math.cos(h), math.sin(h), np.empty(AHEAD),
    )  # fmt: skip
    _fill_ahead(step)
    return step
