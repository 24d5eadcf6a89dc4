"""What follows an event: which contacts are held, which slide, and in which sense.

With several contacts one arrival can make others let go, and a contact that lets go can stop another.  For
contacts with mu = 1 the answer is unique: the forces are those of the box law a = 0, |f| <= beta, or
f = beta sgn(a).  Contacts with mu > 1 are held first, and the one with the largest excess over its static
friction lets go, until none is above it.
"""

import math

from ..compiler import kernel
from .crossings import slope_at
from .laws.coulomb import TOGETHER
from .laws.kinds import has_constraint, is_constrained, keeps_force
from .laws.speed import factor_at
from .problem import F, H, P, Q, force_row, normal_row, slide_velocity
from .row import set_channels
from .series import factor_held, solve_held

#: Loads within this share of the largest excess let go together.
_TIED = 1e-9

#: Share of a load or an acceleration that rounding errors may be, and patterns of the box law after which it
#: counts: it takes fewer where nothing is tied.
_TIE, _TIED_FROM = 1e-12, 30

#: Rounds of the box law in which all that is wrong is flipped though there is not less of it than before.
_PATIENCE = 3

#: Patterns of the box law that are tried by blocks, at most, and altogether: 64 contacts take some 7 from any
#: start, and some 190 one by one.
_MOST_BLOCKS, _MOST_PIVOTS = 100, 2000

#: Rows of the scratch of `settle`: accelerations in the contacts without forces of the participants; forces
#: and accelerations of the participants; 1 for those that take part; kinetic friction; 1 for those that may
#: slide; static friction; forces that would hold all participants; 1 where a contact would do otherwise if
#: all overloaded ones were released at once; sense; the only side of its range that a force can leave, or 0;
#: size of the terms of ACCELERATION; limits of a force, and size of the terms of all modes, see `loops`.
(
    FREE, FORCE, ACCELERATION, PARTICIPATES, KINETIC, MAY_SLIDE, STATIC, HOLDING, ORDER_MATTERS, _SENSE,
    _SIDE, TERMS_SIZE, LOWER, UPPER, WHOLE,
) = range(15)  # fmt: skip
BOX_ROWS = 15


@kernel
def fill_free_accelerations(problem, row, motion, box):
    """Fill the accelerations FREE in the contacts with no force from those that take part."""
    modes, channels = problem.push.shape
    contacts = problem.spring.size
    series = motion.series
    for j in range(contacts):
        box[FREE, j] = 0.0
        for d in range(channels):
            box[FREE, j] -= problem.base[j, d] * (2.0 * series[modes + d, 2])
    for m in range(modes):
        found = -row.stiffness[m] * motion.state[Q, m]
        if problem.coupled:
            for other in range(modes):
                found -= row.damping[m, other] * motion.state[P, other]
        else:
            found -= row.damping[m, m] * motion.state[P, m]
        for d in range(channels):
            found += row.push[d, m] * series[modes + d, 0]
        for j in range(contacts):
            if box[PARTICIPATES, j] == 0.0:
                found -= row.reaction[j, m] * series[force_row(problem, j), 0]
        for j in range(contacts):
            box[FREE, j] += problem.chi[j, m] * found


@kernel
def _forces_of_choice(problem, row, motion, box):
    """Fill FORCE and ACCELERATION of the participants for the choice in `motion.sense`."""
    contacts = motion.sense.size
    if not factor_held(problem, row, motion):
        return False
    right = motion.solve[contacts]
    for j in range(contacts):
        if box[PARTICIPATES, j] != 0.0 and motion.sense[j] != 0:
            box[FORCE, j] = motion.sense[j] * box[KINETIC, j]
    for a in range(motion.held[contacts]):
        j = motion.held[a]
        right[a] = box[FREE, j]
        for other in range(contacts):
            if box[PARTICIPATES, other] != 0.0 and motion.sense[other] != 0:
                right[a] -= row.mobility[j, other] * box[FORCE, other]
    solve_held(motion, right)
    for a in range(motion.held[contacts]):
        box[1, motion.held[a]] = right[a]
    for j in range(contacts):
        box[ACCELERATION, j] = 0.0
        if box[PARTICIPATES, j] != 0.0 and motion.sense[j] != 0:
            box[ACCELERATION, j] = box[FREE, j]
            box[TERMS_SIZE, j] = abs(box[FREE, j])
            for other in range(contacts):
                if box[PARTICIPATES, other] != 0.0:
                    part = row.mobility[j, other] * box[FORCE, other]
                    box[ACCELERATION, j] -= part
                    box[TERMS_SIZE, j] += abs(part)
    return True


@kernel
def _is_wrong(motion, box, j, tie):
    """Whether a contact that may slide is held beyond its friction, or slides against its acceleration.

    tie : share of a load or an acceleration that is none
    """
    if box[PARTICIPATES, j] == 0.0 or box[MAY_SLIDE, j] == 0.0:
        return False
    if motion.sense[j] != 0:
        return motion.sense[j] * box[ACCELERATION, j] < tie * box[TERMS_SIZE, j]
    load = abs(box[FORCE, j]) if box[_SIDE, j] == 0.0 else box[_SIDE, j] * box[FORCE, j]
    return load > box[KINETIC, j] + tie * abs(box[KINETIC, j])


@kernel
def _flip(motion, box, j):
    """Hold a contact that slides, or let a held one slide in the sense of its load."""
    if motion.sense[j] != 0:
        motion.sense[j] = 0
    elif box[_SIDE, j] != 0.0:
        motion.sense[j] = int(box[_SIDE, j])
    else:
        motion.sense[j] = 1 if box[FORCE, j] > 0.0 else -1


@kernel
def _wrong_ones(motion, box, tie):
    """How many contacts are wrong, the first and the last of them; `tie`: see `_is_wrong`."""
    count, first, last = 0, -1, -1
    for j in range(motion.sense.size):
        if _is_wrong(motion, box, j, tie):
            count += 1
            last = j
            if first < 0:
                first = j
    return count, first, last


@kernel
def box_law(problem, row, motion, box, solved):
    """Flip contacts that are wrong, of those that may slide, until none is.

    All of them are flipped at once, as long as there are fewer from time to time, else the last one alone.
    Contacts in a row reach their limits together: rounding errors decide which of them are wrong, without an
    end, until what they can be counts as nothing.  Should that not help, the first one alone is flipped.

    Parameters
    ----------
    problem, row, motion, box : see `settle`; the pattern in the motion is where it begins
    solved : whether FORCE and ACCELERATION are those of this pattern

    Returns
    -------
    int : patterns that were tried; 0 if the contacts do not determine their forces
    """
    fewest, patience = motion.sense.size + 1, _PATIENCE
    for pivot in range(_MOST_PIVOTS):
        if not (solved and pivot == 0) and not _forces_of_choice(problem, row, motion, box):
            return 0
        tie = _TIE if pivot >= _TIED_FROM else 0.0
        count, first, last = _wrong_ones(motion, box, tie)
        if count == 0:
            return pivot + 1
        patience = _PATIENCE if count < fewest else patience - 1
        fewest = min(fewest, count)
        if pivot >= _MOST_BLOCKS:
            _flip(motion, box, first)
        elif patience < 0:
            _flip(motion, box, last)
        else:
            for j in range(motion.sense.size):
                if _is_wrong(motion, box, j, tie):
                    _flip(motion, box, j)
    return 0


@kernel
def _release_loads(motion, box, least):
    """Let every held contact with mu > 1 slide whose force is at least `least` times its static friction."""
    for j in range(motion.sense.size):
        if (
            box[PARTICIPATES, j] != 0.0
            and box[MAY_SLIDE, j] == 0.0
            and abs(box[FORCE, j]) >= least * box[STATIC, j]
        ):
            box[MAY_SLIDE, j] = 1.0
            motion.sense[j] = 1 if box[FORCE, j] > 0.0 else -1


@kernel
def _overloads(motion, box):
    """Largest and smallest share, above 1, that the force of a held contact with mu > 1 has of its static
    friction; 1 where none is overloaded.
    """
    worst, least = 1.0, math.inf
    for j in range(motion.sense.size):
        if box[PARTICIPATES, j] != 0.0 and box[MAY_SLIDE, j] == 0.0 and abs(box[FORCE, j]) > box[STATIC, j]:
            share = abs(box[FORCE, j]) / box[STATIC, j]
            worst, least = max(worst, share), min(least, share)
    return worst, min(least, worst)


@kernel
def _release(problem, row, motion, box, released, at_once):
    """Let contacts go until no load exceeds its static friction, beginning with all participants held.

    Parameters
    ----------
    problem, row, motion, box : see `settle`; FORCE holds all participants
    released : contact that is released; -1: none
    at_once : whether all overloaded contacts with mu > 1 let go at once; else the most overloaded one

    Returns
    -------
    (determined, several) : whether the contacts determine their forces; whether several were overloaded at
        once, and not tied
    """
    if released >= 0:
        box[MAY_SLIDE, released] = 1.0
        motion.sense[released] = 1 if box[FORCE, released] > 0.0 else -1
        _release_loads(motion, box, 1.0 - _TIED)
    if box_law(problem, row, motion, box, released < 0) == 0:
        return False, False
    several = False
    for _ in range(motion.sense.size):
        worst, least = _overloads(motion, box)
        if worst == 1.0:
            break
        several = several or least < worst * (1.0 - _TIED)
        _release_loads(motion, box, (least if at_once else worst) * (1.0 - _TIED))
        if box_law(problem, row, motion, box, False) == 0:
            return False, several
    return True, several


@kernel
def _hold_participants(motion, box):
    """Hold all that take part; those with mu = 1 may slide."""
    for j in range(motion.sense.size):
        if box[PARTICIPATES, j] != 0.0:
            motion.sense[j] = 0
        box[MAY_SLIDE, j] = 1.0 if box[STATIC, j] <= box[KINETIC, j] else 0.0
        box[_SIDE, j] = 0.0


@kernel
def _mark_order(problem, row, motion, box, released):
    """Mark the contacts that would do otherwise if all overloaded ones were released at once: ORDER_MATTERS.

    The pattern stays that of the rule; see `settle`.
    """
    contacts = motion.sense.size
    for j in range(contacts):
        box[_SENSE, j] = motion.sense[j]
        box[FORCE, j] = box[HOLDING, j]
    _hold_participants(motion, box)
    determined, _ = _release(problem, row, motion, box, released, True)
    for j in range(contacts):
        box[ORDER_MATTERS, j] = 1.0 if determined and motion.sense[j] != box[_SENSE, j] else 0.0
        motion.sense[j] = int(box[_SENSE, j])
    return _forces_of_choice(problem, row, motion, box)


@kernel
def is_still(problem, row, motion, j):
    """Whether the velocity in a contact is zero, up to rounding errors."""
    modes, channels = problem.push.shape
    series = motion.series
    w = -row.numbers[H] * problem.belt[j]
    size = abs(w)
    for m in range(modes):
        part = problem.chi[j, m] * motion.state[P, m]
        w += part
        size += abs(part)
    for d in range(channels):
        w -= problem.base[j, d] * series[modes + d, 1]
    return abs(w) <= TOGETHER * size


@kernel
def _arrives_too(problem, row, motion, box, j):
    """Whether a slider reaches velocity zero together with the contact whose arrival was found."""
    return is_still(problem, row, motion, j) and motion.sense[j] * box[FREE, j] <= 0.0


@kernel
def stop_exactly(problem, row, motion):
    """Take the rounding error of their velocities from the participants; `motion.held` lists them."""
    contacts, modes = problem.chi.shape
    right = motion.solve[contacts]
    for a in range(motion.held[contacts]):
        right[a] = slide_velocity(problem, row, motion, motion.held[a])
    solve_held(motion, right)
    for a in range(motion.held[contacts]):
        for m in range(modes):
            motion.state[P, m] -= row.reaction[motion.held[a], m] * right[a]


@kernel
def take_part(problem, row, friction, tau, motion, box):
    """Decide which contacts take part in what follows an event, and their friction there."""
    contacts = motion.sense.size
    series = motion.series
    set_channels(problem, row, tau, -1, motion)
    for j in range(contacts):
        nu = 1.0
        for d in range(problem.push.shape[1]):
            nu += problem.normal[j, d] * series[problem.push.shape[0] + d, 0]
        box[KINETIC, j] = friction.kinetic[j] * nu
        box[STATIC, j] = friction.static[j] * nu
        box[PARTICIPATES, j] = 0.0
        if is_constrained(problem, motion, j):
            box[PARTICIPATES, j] = 1.0
        series[force_row(problem, j), 0] = motion.sense[j] * box[KINETIC, j]
        if motion.sense[j] != 0:
            series[force_row(problem, j), 0] *= factor_at(problem, row, motion, j)
        if keeps_force(problem, motion, j):
            series[force_row(problem, j), 0] = motion.state[F, j]
    fill_free_accelerations(problem, row, motion, box)
    for j in range(contacts):
        if (
            box[PARTICIPATES, j] == 0.0
            and has_constraint(problem, j)
            and _arrives_too(problem, row, motion, box, j)
        ):
            box[PARTICIPATES, j] = 1.0


@kernel
def settle(problem, row, friction, tau, motion, box, arrived, released):
    """Decide the pattern after a contact has arrived at velocity zero, or was released with a drop of force.

    Parameters
    ----------
    problem, row, friction : Problem, Row, Friction
    tau : phase of the load
    motion : Motion; state and pattern of the instant; the pattern is replaced
    box : (BOX_ROWS, N) scratch, see FREE
    arrived : contact that has arrived; -1: none
    released : contact that is released; -1: none

    Returns
    -------
    bool : False if the contacts do not determine their forces
    """
    contacts = motion.sense.size
    take_part(problem, row, friction, tau, motion, box)
    if arrived >= 0:
        box[PARTICIPATES, arrived] = 1.0
    fill_free_accelerations(problem, row, motion, box)
    _hold_participants(motion, box)
    if not _forces_of_choice(problem, row, motion, box):
        return False
    for j in range(contacts):
        box[HOLDING, j] = box[FORCE, j]
        box[ORDER_MATTERS, j] = 0.0
    stop_exactly(problem, row, motion)
    determined, several = _release(problem, row, motion, box, released, False)
    if determined and several:
        return _mark_order(problem, row, motion, box, released)
    return determined


@kernel
def release_by_rates(problem, row, friction, motion, x, before, box):
    """Hold those contacts again, of several that let go at one instant without a drop of force, that stay.

    Where a contact lets go, the rates of all other forces jump.  Each of them stays at its limit with a rate
    that leads inside, or goes with the third derivative of its displacement: the box law of the rates.

    Parameters
    ----------
    problem, row, friction, motion : Problem, Row, Friction, Motion; the pattern is that of after the event
    x : place of the event in the step
    before : (N,) the pattern before it
    box : scratch of `settle`

    Returns
    -------
    bool : False if the contacts do not determine their forces
    """
    contacts = motion.sense.size
    series, count = motion.series, 0
    for j in range(contacts):
        held = before[j] == 0.0 and has_constraint(problem, j)
        box[PARTICIPATES, j] = 1.0 if held else 0.0
        goes = held and motion.sense[j] != 0 and friction.static[j] > 0.0  # without friction none stays
        box[MAY_SLIDE, j] = 1.0 if goes else 0.0
        box[_SIDE, j] = motion.sense[j]
        count += box[MAY_SLIDE, j] != 0.0
    if count < 2:
        return True
    for j in range(contacts):
        box[KINETIC, j] = friction.static[j] * slope_at(series, normal_row(problem, j), x)
        box[FREE, j] = 0.0
        for other in range(contacts):
            if box[PARTICIPATES, other] != 0.0:
                rate = slope_at(series, force_row(problem, other), x)
                box[FREE, j] += row.mobility[j, other] * rate
    if box_law(problem, row, motion, box, False) == 0:
        return False
    for j in range(contacts):
        if box[MAY_SLIDE, j] != 0.0 and motion.sense[j] == 0:
            motion.fresh[j] = 0
    return True
