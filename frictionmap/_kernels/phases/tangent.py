"""Derivatives of the motion by its state at the beginning.

Coordinates are q, p and the forces of elastic contacts; a force that slips or is open is given by q, and its
row follows from theirs.
"""

from ..compiler import kernel
from ..general.problem import LONG, TERMS
from .problem import ELASTIC, NORMAL, RIGID, UP
from .series import begin_terms, dot, expand, is_held, observe, solve_held
from .watch import put_watched, watch_row

#: Rows of `Motion.scratch`: change of the velocities and forces per time before an event, and the derivatives
#: of what is watched.
_BEFORE, _WATCHED, _AFTER = 0, 1, 2


@kernel
def slave_tangent(problem, motion):
    """Set the derivatives of elastic forces that are given."""
    modes, tangent = problem.squares.size, motion.tangent
    for j in range(problem.law.size):
        if problem.law[j] == ELASTIC and not is_held(problem, motion, j):
            factor = motion.sense[j] * problem.lift[j]  # 0 where it is open
            for c in range(tangent.shape[1]):
                sum_ = 0.0
                for i in range(modes):
                    sum_ += problem.normal[j, i] * tangent[i, c]
                tangent[problem.place[j], c] = factor * sum_


@kernel
def hold_tangent(problem, row, motion):
    """Take velocities in the contacts held from the derivatives."""
    modes, tangent, right = problem.squares.size, motion.tangent, motion.column.right
    count = motion.held[problem.law.size]
    if count == 0:
        return
    for c in range(tangent.shape[1]):
        for a in range(count):
            right[a] = 0.0
            for i in range(modes):
                right[a] += problem.chi[motion.held[a], i] * tangent[modes + i, c]
        solve_held(problem, motion, right)
        for a in range(count):
            for i in range(modes):
                tangent[modes + i, c] -= row.reaction[motion.held[a], i] * right[a]


@kernel
def begin_tangent(problem, row, motion):
    """Begin with the derivatives of the state by itself, as far as it is free."""
    tangent = motion.tangent
    for a in range(tangent.shape[0]):
        for b in range(tangent.shape[1]):
            tangent[a, b] = 1.0 if a == b else 0.0
    hold_tangent(problem, row, motion)
    slave_tangent(problem, motion)


@kernel
def _put_column(problem, motion, c):
    """Begin the series of one column."""
    modes, column = problem.squares.size, motion.column
    for i in range(modes):
        column.moves[0, i] = motion.tangent[i, c]
        column.moves[1, i] = motion.tangent[modes + i, c]
    for j in range(problem.law.size):
        column.force[0, j] = motion.tangent[problem.place[j], c] if problem.place[j] >= 0 else 0.0


@kernel
def advance_tangent(problem, row, cell, motion, x):
    """Move the derivatives on by x of the present step."""
    modes, column, tangent = problem.squares.size, motion.column, motion.tangent
    for c in range(tangent.shape[1]):
        _put_column(problem, motion, c)
        expand(problem, row, cell, motion, column, TERMS, 0.0)
        for i in range(modes):
            q, p = 0.0, 0.0
            for k in range(LONG - 1, -1, -1):
                p = p * x + q
                q = q * x + column.moves[k, i]
            tangent[i, c], tangent[modes + i, c] = q, p
        for j in range(problem.law.size):
            if problem.place[j] >= 0:
                f = 0.0
                for k in range(TERMS - 1, -1, -1):
                    f = f * x + column.force[k, j]
                tangent[problem.place[j], c] = f


@kernel
def _watched_derivatives(problem, row, cell, motion, who, what, out):
    """Derivatives of the quantity that has become zero, and its rate.

    Parameters
    ----------
    problem, row, cell, motion : Problem, Row, Cell, Motion at the event, with the pattern before it
    who, what : the event
    out : filled with the derivatives

    Returns
    -------
    float : rate of the quantity
    """
    j, column = who, motion.column
    observe(problem, row, motion, False)
    put_watched(problem, cell, motion, j, what)
    rate = motion.series[watch_row(problem), 1]
    for c in range(motion.tangent.shape[1]):
        _put_column(problem, motion, c)
        expand(problem, row, cell, motion, column, 1, 0.0)
        pressed = column.press[0, j]
        if what == NORMAL:
            out[c] = (-1.0 if motion.open[j] != 0 else 1.0) * problem.pressed[j] * pressed
        elif motion.sense[j] != 0:
            out[c] = motion.sense[j] * dot(problem.chi, j, column.moves[1])
            if problem.law[j] != RIGID:
                out[c] *= problem.spring[j]
                out[c] -= problem.lift[j] * dot(problem.normal, j, column.moves[1])
        else:
            sign = 1.0 if what == UP else -1.0
            out[c] = cell.static[j] * problem.lift[j] * pressed - sign * column.force[0, j]
    return rate


@kernel
def _put_rates(problem, motion, out):
    """Rates of velocities and forces by the series at an event."""
    modes = problem.squares.size
    for i in range(modes):
        out[modes + i] = 2.0 * motion.terms.moves[2, i]
    for j in range(problem.law.size):
        if problem.place[j] >= 0:
            out[problem.place[j]] = motion.terms.force[1, j]


@kernel
def before_event(problem, row, cell, motion, who, what):
    """Keep what `through_event` needs; the rate of what is watched, 0.0 where no rate of the state jumps."""
    contacts = problem.law.size
    if who >= contacts:
        return 0.0
    rigid, held = problem.law[who] == RIGID, motion.sense[who] == 0
    if what == NORMAL:
        jumps = problem.law[who] == ELASTIC and motion.open[who] != 0
    else:
        jumps = rigid and not (held and cell.static[who] <= 1.0)
    if not jumps:
        return 0.0
    begin_terms(problem, row, cell, motion, 2)
    _put_rates(problem, motion, motion.scratch[_BEFORE])
    return _watched_derivatives(problem, row, cell, motion, who, what, motion.scratch[_WATCHED])


@kernel
def through_event(problem, row, cell, motion, rate):
    """Carry the derivatives through an event: J += (F+ - F-) (g J)/(g F-)."""
    modes, tangent = problem.squares.size, motion.tangent
    if rate != 0.0:
        begin_terms(problem, row, cell, motion, 2)
        after = motion.scratch[_AFTER]
        _put_rates(problem, motion, after)
        for a in range(modes, tangent.shape[0]):
            jump = (after[a] - motion.scratch[_BEFORE, a]) / rate
            for c in range(tangent.shape[1]):
                tangent[a, c] += jump * motion.scratch[_WATCHED, c]
    hold_tangent(problem, row, motion)
    slave_tangent(problem, motion)
