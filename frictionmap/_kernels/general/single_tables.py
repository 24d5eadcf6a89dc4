"""One mass with one rigid contact: the tables of one r, by which its motion is followed.

    z'' = -kappa z - delta z' + eta (F - f)

is its equation in an interval of the load, with the displacement z in the contact, the friction force f, and
the force F(tau) that would hold the contact at z = 0 under the load.  A slide is a sum of four motions, each
from its own state at the beginning of the interval: from z = 1, from z' = 1, under f = -1, and under F.  All
are Taylor series.  Only the last one depends on the interval.
"""

import math
from typing import NamedTuple

import numpy as np

from ..compiler import entry, inner_kernel, kernel, late_kernel
from ..compiler.vectors import LANES, filled, load, store
from .crossings import fill_controls, value_at
from .laws.kinds import RIGID, kind_of
from .problem import LONG, SECTION, TERMS, WIDTH, H, R, is_rigid
from .row import most_intervals

#: Rows of `Single.series`: displacement and velocity of the motions that all intervals share ...
PLACE, PLACE_RATE, PUSH, PUSH_RATE, YIELD, YIELD_RATE = 0, 1, 2, 3, 4, 5
_COMMON = 6

#: ... and then of every interval: the holding force, displacement and velocity under it.
_FORCE, _FORCED, _FORCED_RATE = 0, 1, 2
_PER_INTERVAL = 3

#: Places in `Single.numbers`: coefficients of the equation; w^2/chi^2, the force per displacement that holds
#: the contact; its participation; wall and its rate at the section.
KAPPA, DELTA, ETA, STIFFNESS, CHI, WALL, WALL_RATE = range(7)

#: Places in `Single.state`: displacement, its rate, and the derivatives of both by those at the section.
Z, RATE, Z_BY_Z, Z_BY_RATE, RATE_BY_Z, RATE_BY_RATE = range(6)

#: Rows of `Single.controls`: the velocities of the shared motions, then two for every interval.
_COMMON_CONTROLS, _CONTROLS = 3, 2

_UNKNOWN = -1

#: Intervals of a period for which there is memory at most: a load of 200 harmonics has 600.
_MOST_INTERVALS = 1024


class Single(NamedTuple):
    """Tables of one r, and the memory of one motion."""

    fits: np.ndarray  # (1,) int: 1 if there are tables, 0 if not, _UNKNOWN before they are needed
    numbers: np.ndarray  # (7,) see KAPPA
    series: np.ndarray  # (rows, WIDTH)
    controls: np.ndarray  # (rows, WIDTH) control points of the watched quantity, see `fill_controls`
    bounds: np.ndarray  # (rows,) bounds on their error
    ends: np.ndarray  # (rows,) the shared motions at the end of an interval, then z and z' under each force
    state: np.ndarray  # (6,) see Z
    scratch: np.ndarray  # (1, WIDTH)


@inner_kernel
def force_row(interval):
    """Row of the holding force in an interval; those of displacement and velocity under it follow."""
    return _COMMON + _PER_INTERVAL * interval + _FORCE


@inner_kernel
def control_row(interval):
    """Row of the control points of the holding force; those of the velocity under it follow."""
    return _COMMON_CONTROLS + _CONTROLS * interval


@inner_kernel
def end_row(interval):
    """Place of the displacement under the force of an interval in `Single.ends`; the velocity follows."""
    return _COMMON_CONTROLS + _CONTROLS * interval


@kernel
def is_single(problem, masses):
    """Whether this is one mass with one rigid contact, a constant normal load and no belt.

    masses : number of masses whose displacements are wanted; if the wall moves, their extremes are others;
        more than one: forces are wanted, which the tables do not have
    """
    contacts, modes = problem.chi.shape
    if masses > 1:
        return False
    if contacts != 1 or modes != 1 or kind_of(problem, 0) != RIGID or problem.belt[0] != 0.0:
        return False
    for d in range(problem.push.shape[1]):
        if problem.normal[0, d] != 0.0 or (masses > 0 and problem.base[0, d] != 0.0):
            return False
    return problem.chi[0, 0] != 0.0


@entry
def make_single(problem, masses):
    """Allocate the tables; none where they do not apply."""
    intervals = most_intervals(problem, _MOST_INTERVALS) if is_single(problem, masses) else 0
    rows = _COMMON_CONTROLS + _CONTROLS * intervals
    return Single(
        np.full(1, _UNKNOWN), np.zeros(7), np.zeros((_COMMON + _PER_INTERVAL * intervals, WIDTH)),
        np.zeros((rows, WIDTH)), np.zeros(rows), np.zeros(rows), np.zeros(6), np.zeros((1, WIDTH)),
    )  # fmt: skip


@inner_kernel
def _expand(single, at):
    """Continue a displacement in row `at` from its first two terms, under the force in row `at - 1` if any.

    Its velocity is put in row `at + 1`.
    """
    series = single.series
    kappa, delta, eta = single.numbers[KAPPA], single.numbers[DELTA], single.numbers[ETA]
    for k in range(TERMS):
        push = eta * series[at - 1, k] if at > _COMMON else 0.0
        if at == YIELD and k == 0:
            push = eta
        now = push - kappa * series[at, k] - delta * (k + 1.0) * series[at, k + 1]
        series[at, k + 2] = now / ((k + 1.0) * (k + 2.0))
    for k in range(LONG - 1):
        series[at + 1, k] = (k + 1.0) * series[at, k + 1]


@kernel
def _fill_common(single):
    """Fill the motions that all intervals share."""
    for at in (PLACE, PUSH, YIELD):
        for k in range(WIDTH):
            single.series[at, k] = single.series[at + 1, k] = 0.0
        single.series[at, 0] = 1.0 if at == PLACE else 0.0
        single.series[at, 1] = 1.0 if at == PUSH else 0.0
        _expand(single, at)
        row = at // 2
        single.bounds[row] = fill_controls(single.series, at + 1, single.controls, row)
        single.ends[row] = value_at(single.series, at, 1.0)


@kernel
def _holding_phasor(problem, row, n):
    """Return the cos and sin parts of harmonic n of the force that holds the contact at z = 0."""
    chi, r, order = problem.chi[0, 0], row.numbers[R], problem.orders[n]
    inertia = problem.squares[0] - r * r * order * order
    damping = r * order * problem.damping[0, 0]
    even, odd = 0.0, 0.0
    for d in range(problem.push.shape[1]):
        a, b = row.phasors[0, d, n], row.phasors[1, d, n]
        wall = problem.base[0, d] / chi
        even += (problem.push[0, d] * a - wall * (inertia * a + damping * b)) / chi
        odd += (problem.push[0, d] * b - wall * (inertia * b - damping * a)) / chi
    return even, odd


@kernel
def _fill_forces(problem, row, single, intervals):
    """Fill the holding force in all intervals."""
    h = row.numbers[H]
    for interval in range(intervals):
        for k in range(0, WIDTH, LANES):
            store(filled(0.0), single.series, force_row(interval) * WIDTH + k)
    for n in range(problem.orders.size):
        even, odd = _holding_phasor(problem, row, n)
        if even == 0.0 and odd == 0.0:
            continue
        for interval in range(intervals):
            angle = problem.orders[n] * (SECTION + interval * h)
            c, s = math.cos(angle), math.sin(angle)
            here, ahead = even * c + odd * s, odd * c - even * s
            for k in range(0, WIDTH, LANES):
                at = force_row(interval) * WIDTH + k
                wave = load(row.cosines, n * WIDTH + k) * here + load(row.sines, n * WIDTH + k) * ahead
                store(load(single.series, at) + wave, single.series, at)


@kernel
def _fill_wall(problem, row, single):
    """Keep the displacement of the wall at the section, and its rate."""
    single.numbers[WALL] = single.numbers[WALL_RATE] = 0.0
    for d in range(problem.push.shape[1]):
        for n in range(problem.orders.size):
            angle = problem.orders[n] * SECTION
            c, s = math.cos(angle), math.sin(angle)
            a, b = row.phasors[0, d, n], row.phasors[1, d, n]
            single.numbers[WALL] += problem.base[0, d] * (a * c + b * s)
            single.numbers[WALL_RATE] += (
                problem.base[0, d] * row.numbers[H] * problem.orders[n] * (b * c - a * s)
            )


@kernel
def forget_row(single):
    """Forget the tables of a row."""
    single.fits[0] = _UNKNOWN


@kernel
def fits_row(problem, row, single, base):
    """Whether there are tables of a row, of `base` half periods; they are filled when first needed."""
    if single.fits[0] == _UNKNOWN:
        none = single.series.shape[0] == _COMMON or is_rigid(problem, 0)
        single.fits[0] = 0 if none or force_row(base * row.intervals[0]) > single.series.shape[0] else 1
        if single.fits[0] == 1:
            _fill(problem, row, single, base * row.intervals[0])
    return single.fits[0] == 1


@late_kernel(None)
def _fill(problem, row, single, intervals):
    """Fill the tables of a row, of some intervals."""
    chi = problem.chi[0, 0]
    single.numbers[KAPPA], single.numbers[DELTA] = row.stiffness[0], row.damping[0, 0]
    single.numbers[ETA], single.numbers[STIFFNESS] = row.mobility[0, 0], problem.squares[0] / (chi * chi)
    single.numbers[CHI] = chi
    _fill_wall(problem, row, single)
    _fill_common(single)
    _fill_forces(problem, row, single, intervals)
    for interval in range(intervals):
        at = force_row(interval)
        for k in range(WIDTH):
            single.series[at + 1, k] = single.series[at + 2, k] = 0.0
        _expand(single, at + 1)
        into = control_row(interval)
        single.bounds[into] = fill_controls(single.series, at, single.controls, into)
        single.bounds[into + 1] = fill_controls(single.series, at + 2, single.controls, into + 1)
        for part in range(2):
            single.ends[end_row(interval) + part] = value_at(single.series, at + 1 + part, 1.0)
