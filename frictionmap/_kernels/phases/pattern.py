"""The phase from a state, and which rigid contacts slide after an event."""

from ..compiler import kernel
from ..general.problem import LONG
from .problem import ELASTIC, RIGID, SMOOTH
from .series import begin_terms, dot, factor_held, is_held, is_tied, limit_at, slave_forces, sliding_velocity

#: Excess of a holding force over the limit, relative to it, that is rounding: forces are sums of some ten
#: terms that may be larger.
_ROUNDING = 1e-12

#: Share of the velocities of its modes below which a contact is at rest.
_AT_REST = 1e-13

#: Columns of a decision: whether a contact takes part in it.
_PART, _BEST = 0, 1


@kernel
def is_at_rest(problem, row, motion, j):
    """Whether a contact does not move relative to its wall, apart from rounding errors."""
    size = abs(row.belt[j]) + abs(problem.moved[j] * motion.drive[1, problem.squares.size])
    for i in range(problem.squares.size):
        size += abs(problem.chi[j, i] * motion.p[i])
    return abs(sliding_velocity(problem, row, motion, j)) <= _AT_REST * size


@kernel
def _is_consistent(problem, row, cell, motion):
    """Whether contacts that take part are held within their limits, or speed up the way they slide."""
    if not factor_held(problem, row, motion):
        return False
    begin_terms(problem, row, cell, motion, 1)
    for j in range(problem.law.size):
        if motion.trial[_PART, j] == 0:
            continue
        if motion.sense[j] == 0:
            most = cell.static[j] * limit_at(problem, cell, j, motion.terms.press[0, j])
            if abs(motion.terms.force[0, j]) > most * (1.0 + _ROUNDING):
                return False
        else:
            rate = dot(problem.chi, j, motion.terms.moves[2])
            rate -= problem.moved[j] * motion.drive[2, problem.squares.size]
            if motion.sense[j] * rate < 0.0:
                return False
    return True


@kernel
def _try_all(problem, row, cell, motion):
    """The first consistent pattern of the contacts that take part, those with many held first."""
    contacts, many = problem.law.size, 1
    taking = 0
    for j in range(contacts):
        if motion.trial[_PART, j] != 0:
            many *= 3
            taking += 1
    for sliding in range(taking + 1):
        for code in range(many):
            rest, slides = code, 0
            for j in range(contacts):
                if motion.trial[_PART, j] != 0:
                    digit = rest % 3
                    motion.sense[j] = digit if digit < 2 else -1
                    slides += digit > 0
                    rest //= 3
            if slides == sliding and _is_consistent(problem, row, cell, motion):
                return True
    return False


@kernel
def settle(problem, row, cell, motion, contact, sense):
    """Decide which rigid contacts slide where one has come to rest, or lets go and its friction drops.

    Parameters
    ----------
    problem, row, cell : Problem, Row, Cell
    motion : Motion at the event
    contact : the contact; -1 for all that are at rest
    sense : of its slide before, or, where it lets go, of the slide that begins with the opposite sign

    Returns
    -------
    bool : False if no pattern is consistent
    """
    for j in range(problem.law.size):
        held = problem.law[j] == RIGID and is_held(problem, motion, j)
        motion.trial[_PART, j] = 1 if held or j == contact else 0
        motion.trial[_BEST, j] = motion.sense[j]
    if contact < 0:
        return _try_all(problem, row, cell, motion)
    if sense != 0:
        motion.sense[contact] = 0
        if _is_consistent(problem, row, cell, motion):
            return True
        motion.sense[contact] = -sense
        if _is_consistent(problem, row, cell, motion):
            return True
    if _try_all(problem, row, cell, motion):
        return True
    for j in range(problem.law.size):
        motion.sense[j] = motion.trial[_BEST, j]
    return False


@kernel
def release_contact(problem, row, cell, motion, contact, sense):
    """Let a rigid contact go whose friction drops; False if no pattern is consistent."""
    for j in range(problem.law.size):
        held = problem.law[j] == RIGID and is_held(problem, motion, j) and j != contact
        motion.trial[_PART, j] = 1 if held else 0
    motion.sense[contact] = sense
    return _is_consistent(problem, row, cell, motion) or _try_all(problem, row, cell, motion)


@kernel
def _opens_at_zero(problem, row, cell, motion, j):
    """Whether a contact that touches without force opens, by the first term that is not zero."""
    begin_terms(problem, row, cell, motion, LONG - 2)
    for k in range(1, LONG):
        pressed = dot(problem.normal, j, motion.terms.moves[k])
        if pressed != 0.0:
            motion.lead[j, 0] = k
            return pressed < 0.0
    return False


@kernel
def find_piece(problem, motion, s):
    """Piece of a spring by its displacement."""
    stretched = dot(problem.along, s, motion.q)
    piece = 0
    while piece < problem.knot_count[s] and stretched > problem.knots[s, piece]:
        piece += 1
    motion.piece[s] = piece


@kernel
def rest_tied(problem, cell, motion):
    """Let elastic contacts rest, at the limit if they slip, whose ends rigid ones keep at rest."""
    for j in range(problem.law.size):
        motion.idle[j] = motion.open[j] == 0 and is_tied(problem, motion, j)
        if motion.idle[j] and motion.sense[j] != 0:
            motion.f[j] = motion.sense[j] * limit_at(problem, cell, j, dot(problem.normal, j, motion.q))
            motion.sense[j] = 0


@kernel
def begin_pattern(problem, row, cell, motion):
    """Find the pattern of a state that begins a motion; elastic contacts begin without force, if they can."""
    for s in range(motion.piece.size):
        find_piece(problem, motion, s)
    for j in range(problem.law.size):
        motion.sense[j] = motion.open[j] = 0
        if problem.presses[j]:
            force = cell.preload[j] + problem.pressed[j] * dot(problem.normal, j, motion.q)
            motion.open[j] = 1 if force < 0.0 else 0
        at_rest = is_at_rest(problem, row, motion, j)
        if problem.law[j] == RIGID and motion.open[j] == 0 and not at_rest:
            motion.sense[j] = 1 if sliding_velocity(problem, row, motion, j) > 0.0 else -1
    slave_forces(problem, cell, motion)
    found = settle(problem, row, cell, motion, -1, 0) and factor_held(problem, row, motion)
    for j in range(problem.law.size):
        force = cell.preload[j] + problem.pressed[j] * dot(problem.normal, j, motion.q)
        touches = problem.presses[j] and motion.open[j] == 0 and force == 0.0
        if touches and _opens_at_zero(problem, row, cell, motion, j):
            motion.open[j], motion.sense[j] = 1, 0
    rest_tied(problem, cell, motion)
    return found and factor_held(problem, row, motion)


@kernel
def repair_pattern(problem, row, cell, motion):
    """Adapt the pattern to a state that Newton's method led to, and forces to their limits."""
    for s in range(motion.piece.size):
        find_piece(problem, motion, s)
    for j in range(problem.law.size):
        was_open = motion.open[j]
        pressed = dot(problem.normal, j, motion.q)
        if problem.presses[j]:
            motion.open[j] = 1 if cell.preload[j] + problem.pressed[j] * pressed < 0.0 else 0
        if motion.open[j] != 0 or problem.law[j] == SMOOTH:
            motion.sense[j] = 0
            continue
        w = sliding_velocity(problem, row, motion, j)
        if problem.law[j] == RIGID and (motion.sense[j] != 0 or was_open != 0):
            motion.sense[j] = 1 if w > 0.0 else -1
        if problem.law[j] == ELASTIC:
            most = limit_at(problem, cell, j, pressed)
            rate = problem.lift[j] * dot(problem.normal, j, motion.p)
            if motion.sense[j] != 0 and motion.sense[j] * problem.spring[j] * w < rate:
                motion.f[j] = motion.sense[j] * most
                motion.sense[j] = 0
            motion.f[j] = min(max(motion.f[j], -most), most)
    slave_forces(problem, cell, motion)
    rest_tied(problem, cell, motion)
    return factor_held(problem, row, motion)
