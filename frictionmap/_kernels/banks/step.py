"""One step: Taylor series of the motion, and the first event on them.

The length of a step is chosen for the event that is expected, and its series have as many terms as this
length needs: the steps between the elements of a bank are short.
"""

import math

import numpy as np

from ..compiler import kernel
from ..general.crossings import NONE, first_zero
from ..general.problem import INVERSE as _INVERSE
from ..general.problem import LONG, TERMS, WIDTH
from ..general.problem import TURN as LARGEST
from .level import NOTHING, TURN, YIELD, has_threshold, threshold


def _terms_of(angle):
    """Terms of a force whose fastest part turns by this angle: angle^n/n! is below rounding."""
    count, size = 1, angle
    while size > LARGEST**TERMS / math.factorial(TERMS) and count < TERMS:
        count += 1
        size *= angle / count
    return count


#: Number of terms by the angle in a step, in parts of the largest one.
_PARTS = 32
_COUNTS = np.array([_terms_of(LARGEST * (k + 1.0) / _PARTS) for k in range(_PARTS)])

#: 1/(k + 1): factors of the terms of a wave.
_PARTS_OF = 1.0 / np.arange(1.0, LONG + 1.0)

#: A step is this much longer than the way to the event expected, and not shorter than this part of the
#: largest one, which has seven terms less than twice its length has.
_BEYOND, _SHORTEST = 1.25, 1.0 / 16.0

#: Steps to a zero of a monotonic series, at most.
_MOST_STEPS = 120

#: Rounding error of a place in a step of length 1.
_ROUNDING = 2.0**-53


@kernel
def put_waves(row, tau, motion):
    """Set the cosines and sines of the load, and the load, at a phase."""
    width = motion.loads.shape[1]
    for i in range(width):
        motion.loads[0, i] = motion.loads[1, i] = 0.0
    for n in range(row.orders.size):
        c, s = math.cos(row.orders[n] * tau), math.sin(row.orders[n] * tau)
        motion.waves[0, n], motion.waves[1, n] = c, s
        for i in range(width):
            motion.loads[0, i] += row.phasors[0, n, i] * c + row.phasors[1, n, i] * s
        # the rate of the base motion
        slope = row.phasors[1, n, width - 1] * c - row.phasors[0, n, width - 1] * s
        motion.loads[1, width - 1] += row.orders[n] * slope


@kernel
def _put_loads(row, count, length, motion):
    """Fill the series of the load from its waves; of the modes per acceleration q''."""
    loads, phasors, modes = motion.loads, row.phasors, motion.loads.shape[1] - 1
    scale = length * length / (row.r * row.r)
    for k in range(count):
        for i in range(modes + 1):
            loads[k, i] = 0.0
    for n in range(row.orders.size):
        c, s, way = motion.waves[0, n], motion.waves[1, n], row.orders[n] * length
        for i in range(modes + 1):
            share = scale if i < modes else 1.0
            term = share * (phasors[0, n, i] * c + phasors[1, n, i] * s)
            after = share * (phasors[1, n, i] * c - phasors[0, n, i] * s)
            for k in range(count if term != 0.0 or after != 0.0 else 0):
                loads[k, i] += term
                term, after = after * (way * _PARTS_OF[k]), -term * (way * _PARTS_OF[k])


@kernel
def friction(problem, cell, motion, j, z):
    """Force of a contact."""
    at = problem.first[j] + j + motion.now.level[j]
    return motion.now.sense[j] * cell.slid[at] + problem.left[at] * z - motion.pull[at]


@kernel
def put_rates(problem, row, cell, motion, z):
    """Set the accelerations of the modes; z (N, ...) has the displacements first."""
    now, modes = motion.now, problem.squares.size
    square = row.r * row.r
    for i in range(modes):
        total = motion.loads[0, i] - problem.squares[i] * now.q[i]
        if problem.coupled:
            for k in range(modes):
                total -= row.r * problem.damping[i, k] * now.p[k]
        else:
            total -= row.r * problem.damping[i, i] * now.p[i]
        motion.rate[i] = total
    for j in range(problem.moved.size):
        force = friction(problem, cell, motion, j, z[j, 0])
        for i in range(modes):
            motion.rate[i] -= problem.chi[j, i] * force
    for i in range(modes):
        motion.rate[i] /= square


@kernel
def _expected(problem, cell, motion, j, z, w, rate):
    """Time to the next event of a contact if its acceleration stays; infinite without one.

    Parameters
    ----------
    problem, cell, motion : Problem, Cell, Motion
    j : number of the contact
    z, w, rate : its displacement, velocity and acceleration
    """
    now = motion.now
    speed, rise = max(0.0, now.sense[j] * w), now.sense[j] * rate
    found = np.inf
    if rise < 0.0 and speed > 0.0:
        found = -speed / rise
    if has_threshold(problem, now, j):
        way = max(0.0, now.sense[j] * (threshold(problem, cell, now, j) - z))
        root = speed * speed + 2.0 * rise * way
        if root >= 0.0 and speed + math.sqrt(root) > 0.0:
            found = min(found, 2.0 * way / (speed + math.sqrt(root)))
    return found


@kernel
def _fastest(problem, row, motion):
    """Bound on the rate of the fastest part of the motion at the present levels, in tau."""
    square = row.square
    for j in range(problem.moved.size):
        square += problem.left[problem.first[j] + j + motion.now.level[j]] * row.weight[j]
    rate = 0.5 * (row.damping + math.sqrt(row.damping * row.damping + 4.0 * square)) / row.r
    return max(rate, row.highest)


@kernel
def choose_length(problem, row, cell, motion, rest):
    """Length of a step, at most `rest`, and the angle of its fastest part; the waves are those of now."""
    now, modes, expected = motion.now, problem.squares.size, np.inf
    for j in range(problem.moved.size):
        z = -problem.moved[j] * motion.loads[0, modes]
        for i in range(modes):
            z += problem.chi[j, i] * now.q[i]
        motion.z[j, 0] = z
    put_rates(problem, row, cell, motion, motion.z)
    for j in range(problem.moved.size):
        w, rate = -problem.moved[j] * motion.loads[1, modes], 0.0
        for i in range(modes):
            w += problem.chi[j, i] * now.p[i]
            rate += problem.chi[j, i] * motion.rate[i]
        expected = min(expected, _expected(problem, cell, motion, j, motion.z[j, 0], w, rate))
    fastest = _fastest(problem, row, motion)
    longest = LARGEST / fastest
    length = min(rest, longest, max(_BEYOND * expected, _SHORTEST * longest))
    return length, length * fastest


@kernel
def _damped(problem, moves, k, i):
    """Damping of mode i times term k of the velocities of the modes, in `moves` (LONG, m)."""
    if not problem.coupled:
        return problem.damping[i, i] * moves[k, i]
    total = 0.0
    for n in range(moves.shape[1]):
        total += problem.damping[i, n] * moves[k, n]
    return total


@kernel
def _put_terms(problem, cell, motion, count, scale, damped):
    """Fill the series of modes and displacements from their first two terms.

    Parameters
    ----------
    problem, cell, motion : Problem, Cell, Motion with the series of the load
    count : terms
    scale, damped : square of the length of the step, and this length, over r^2 and r
    """
    moves, loads, chi, z = motion.moves, motion.loads, problem.chi, motion.z
    modes, contacts, force = problem.squares.size, problem.moved.size, motion.force
    for k in range(count):
        for j in range(contacts):
            total = -problem.moved[j] * loads[k, modes]
            for i in range(modes):
                total += chi[j, i] * moves[k, i]
            z[j, k] = total
            at = problem.first[j] + j + motion.now.level[j]
            force[j] = problem.left[at] * total if k > 0 else friction(problem, cell, motion, j, total)
        for i in range(modes if k < count - 2 else 0):
            pull = problem.squares[i] * moves[k, i]
            for j in range(contacts):
                pull += chi[j, i] * force[j]
            drag = damped * (k + 1.0) * _damped(problem, moves, k + 1, i)
            moves[k + 2, i] = _INVERSE[k] * ((loads[k, i] - scale * pull) - drag)


@kernel
def _put_single_terms(problem, cell, motion, count, scale, damped):
    """Do as `_put_terms` for one mode and one contact, with numbers in registers: in a third of the time."""
    moves, loads, z, chi, moved = motion.moves, motion.loads, motion.z, problem.chi[0, 0], problem.moved[0]
    x, after = moves[0, 0], moves[1, 0]
    place = chi * x - moved * loads[0, 1]
    left = problem.left[motion.now.level[0]]
    constant = scale * chi * (friction(problem, cell, motion, 0, place) - left * place)
    stiffness, hold, damping = scale * problem.squares[0], scale * chi * left, damped * problem.damping[0, 0]
    for k in range(count - 2):
        place = chi * x - moved * loads[k, 1]
        z[0, k] = place
        total = (loads[k, 0] - stiffness * x - hold * place) - constant
        x, after = after, _INVERSE[k] * (total - damping * (k + 1.0) * after)
        moves[k + 2, 0] = after
        constant = 0.0
    z[0, count - 2] = chi * x - moved * loads[count - 2, 1]
    z[0, count - 1] = chi * after - moved * loads[count - 1, 1]


@kernel
def terms_of_step(angle):
    """Number of terms of a displacement in a step whose fastest part turns by this angle."""
    return _COUNTS[min(int(angle / LARGEST * _PARTS), _PARTS - 1)] + 2


@kernel
def put_moves(problem, row, cell, motion, length, count):
    """Fill the series of modes and displacements in a step of this length; those of the load are there."""
    now, moves, modes, contacts = motion.now, motion.moves, problem.squares.size, problem.moved.size
    scale, damped = length * length / (row.r * row.r), length / row.r
    for i in range(modes):
        moves[0, i], moves[1, i] = now.q[i], length * now.p[i]
    if modes == 1 and contacts == 1:
        _put_single_terms(problem, cell, motion, count, scale, damped)
    else:
        _put_terms(problem, cell, motion, count, scale, damped)
    for j in range(contacts):
        for k in range(count, WIDTH):
            motion.z[j, k] = 0.0


@kernel
def put_series(problem, row, cell, motion, length, angle):
    """Fill the series of a step of this length; return the number of terms of a displacement."""
    count = terms_of_step(angle)
    _put_loads(row, count, length, motion)
    put_moves(problem, row, cell, motion, length, count)
    return count


@kernel
def _keeps_sense(z, j, sense, count):
    """Whether the sizes of the terms show that the velocity in a contact keeps its sense in the step."""
    least = sense * z[j, 1]
    for k in range(2, count):
        least -= k * abs(z[j, k])
    return least > 0.0


@kernel
def _first_turn(motion, j, count):
    """First zero of the velocity in a contact along its sense; 0 where it begins against it."""
    watch, z, sense = motion.watch, motion.z, motion.now.sense[j]
    skipped = 0
    if motion.now.lead[j] != 0:  # the velocity begins at 0: what follows it has the sign of the first term
        skipped = 1
        while skipped < TERMS - 1 and z[j, skipped + 1] == 0.0:
            skipped += 1
    elif _keeps_sense(z, j, sense, count):
        return NONE
    for k in range(WIDTH):
        at = k + skipped
        watch[0, k] = sense * (at + 1.0) * z[j, at + 1] if at < TERMS else 0.0
    if watch[0, 0] < 0.0 or (watch[0, 0] == 0.0 and watch[0, 1] <= 0.0):
        return NONE if motion.now.lead[j] != 0 and watch[0, 0] == 0.0 else 0.0
    return first_zero(watch, 0)


@kernel
def _place_and_slope(z, j, count, x):
    """Value of a series, and its slope."""
    value = slope = 0.0
    for k in range(count - 1, -1, -1):
        slope = slope * x + value
        value = value * x + z[j, k]
    return value, slope


@kernel
def _reached(z, j, count, sense, place, end):
    """Where a series that goes on along its sense from 0 to `end` reaches a place between."""
    way, speed, bend = sense * (place - z[j, 0]), sense * z[j, 1], sense * z[j, 2]
    root = speed * speed + 4.0 * bend * way
    low, high, x = 0.0, end, 0.5 * end
    if root > 0.0 and speed + math.sqrt(root) > 0.0:
        x = min(end, max(0.0, 2.0 * way / (speed + math.sqrt(root))))
    for _ in range(_MOST_STEPS):
        value, slope = _place_and_slope(z, j, count, x)
        off, slope = sense * (value - place), sense * slope
        if off > 0.0:
            high = x
        else:
            low = x
        new = x - off / slope if slope > 0.0 else -1.0
        if not low <= new <= high:
            new = 0.5 * (low + high)
        if abs(new - x) <= _ROUNDING:
            return new
        x = new
    return x


@kernel
def first_event(problem, cell, motion, count):
    """The first event of a step.

    Parameters
    ----------
    problem, cell, motion : Problem, Cell, Motion, whose series have `count` terms

    Returns
    -------
    (x, j, what) : its place, its contact, and NOTHING, YIELD or TURN
    """
    best, who, what = 1.0, -1, NOTHING
    for j in range(problem.moved.size):
        now = motion.now
        turn = _first_turn(motion, j, count)
        end = min(turn, best)
        if has_threshold(problem, now, j):
            place = threshold(problem, cell, now, j)
            value, _ = _place_and_slope(motion.z, j, count, end)
            if now.sense[j] * (value - place) >= 0.0:
                best, who, what = _reached(motion.z, j, count, now.sense[j], place, end), j, YIELD
                continue
        if turn < best or (turn == best and who < 0):
            best, who, what = turn, j, TURN
    return best, who, what


@kernel
def mode_at(motion, i, count, x):
    """Value of a mode at x of the present step, and its slope there."""
    q, p = 0.0, 0.0
    for k in range(count - 1, -1, -1):
        p = p * x + q
        q = q * x + motion.moves[k, i]
    return q, p


@kernel
def advance(motion, count, length, x):
    """Move the modes on by x of the present step."""
    now = motion.now
    for i in range(now.q.size):
        q, p = mode_at(motion, i, count, x)
        now.q[i], now.p[i] = q, p / length


@kernel
def contact_velocity(problem, motion, j):
    """Velocity in a contact; the rate of the base is that of the last `put_waves`."""
    modes = problem.squares.size
    total = -problem.moved[j] * motion.loads[1, modes]
    for i in range(modes):
        total += problem.chi[j, i] * motion.now.p[i]
    return total


@kernel
def clear_leads(motion):
    """Forget the velocities that began at 0."""
    for j in range(motion.now.lead.size):
        motion.now.lead[j] = 0
