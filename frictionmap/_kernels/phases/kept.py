"""What is kept of a motion under a record: peaks, works, slides, events, and states at samples.

What is watched is a sum of units: modes, their velocities, friction forces, changes N - max(0, N0) of normal
forces, forces of springs, and channels of the record.
"""

from typing import NamedTuple

import numpy as np

from ..compiler import kernel
from ..general.crossings import value_at
from ..general.problem import LONG, TERMS, WIDTH
from ..general.record import OF_FRICTION, OF_WALL
from ..general.row import shift_piece
from ..history.kept import (
    BEGIN,
    BEND,
    END,
    LARGEST,
    OF_BASE,
    OF_LOAD,
    OVERSHOOT,
    PRESENT,
    START,
    STOP,
    TURN,
    VALUE,
    add_up,
    integral_by_slope,
    keep_peak,
    list_event,
    stays_within,
)
from .problem import ELASTIC, SMOOTH, F, Motion, Row, W, Z
from .record import integral_of_product
from .series import dot, normal_change, spring_force

#: Kinds of events beside those of `history.kept`: a contact opens, closes; a spring passes a knot.
OPENS, CLOSES, KNOT = 3, 4, 5

#: What stands in the place of the sense of an open contact.
LIFTED = 2

#: Row of the scratch for what a channel pushes.
_PUSHED = 7


class Memory(NamedTuple):
    """Memory of a motion under a record of D channels.

    Where the place of the base is a channel, it is the last one of the modes, too: nothing acts on it, and
    what the ground presses and stretches depends on it.
    """

    motion: Motion
    row: Row  # of r = 1; its arrays are those of the present part of an interval, its h is not used
    belt: np.ndarray  # (N,) velocities of the walls
    push: np.ndarray  # (m, D) loads on the modes
    walls: np.ndarray  # (D,) 1 of the channel that is the place of the base
    free: np.ndarray  # (1,) int: modes of the structure; the next one, if there is one, is the base
    ground: np.ndarray  # (0 or 1, 2 m + 2 N + S + D) force of the ground, over which the base moves, by units
    rate: np.ndarray  # (1,) bound on the rate of motion in any phase
    length: np.ndarray  # (1,) of the present part
    terms: np.ndarray  # (1,) int: terms of a channel
    channels: np.ndarray  # (D, WIDTH) the channels in the present part
    present: np.ndarray  # (D, WIDTH) the same in the present step
    before: np.ndarray  # (N,) int: senses before an event
    places: np.ndarray  # (N,) where rigid contacts are held, relative to their walls
    scratch: np.ndarray  # (8, WIDTH)
    last: np.ndarray  # (m,) modes of the structure at the last sample, see `under_record.creeps`


@kernel
def put_channels(memory, x):
    """Fill the channels, and the series of the load, of the step that begins at x of the present part."""
    drive, modes = memory.motion.drive, memory.push.shape[0]
    terms, square = memory.terms[0], memory.length[0] * memory.length[0]
    for d in range(memory.push.shape[1]):
        for k in range(terms):
            memory.present[d, k] = memory.channels[d, k]
        if x != 0.0:
            shift_piece(memory.present, d, x, terms)
    for k in range(terms):
        for i in range(modes + 1):
            drive[k, i] = 0.0
        for d in range(memory.push.shape[1]):
            value = memory.present[d, k]
            for i in range(modes):
                drive[k, i] += square * memory.push[i, d] * value
            drive[k, modes] += memory.walls[d] * value
    if memory.free[0] < modes:
        _put_base(memory, terms)


@kernel
def _put_base(memory, terms):
    """Set the place of the base, its velocity, and the series of its acceleration."""
    base, motion = memory.free[0], memory.motion
    drive, place = motion.drive, memory.push.shape[0]
    motion.q[base], motion.p[base] = drive[0, place], drive[1, place]
    for k in range(2, terms):
        drive[k - 2, base] = k * (k - 1.0) * drive[k, place]


@kernel
def _put_motion(problem, memory, units, x):
    """Fill the modes and their velocities at x of the present step."""
    modes, moves = problem.squares.size, memory.motion.terms.moves
    for i in range(modes):
        q, p = 0.0, 0.0
        for k in range(LONG - 1, -1, -1):
            p = p * x + q
            q = q * x + moves[k, i]
        units[i], units[modes + i] = q, p / memory.length[0]


@kernel
def put_units(problem, cell, memory, units, x):
    """Fill the units at x of the present step."""
    modes, contacts, terms = problem.squares.size, problem.law.size, memory.motion.terms
    _put_motion(problem, memory, units, x)
    for j in range(contacts):
        force, change = 0.0, 0.0
        for k in range(TERMS - 1, -1, -1):
            force = force * x + terms.force[k, j]
            if problem.presses[j]:
                change = change * x + normal_change(problem, cell, memory.motion, terms, k, j, 1.0)
        units[2 * modes + j], units[2 * modes + contacts + j] = force, change
    first = 2 * modes + 2 * contacts
    for s in range(problem.along.shape[0]):
        stretched = 0.0
        for i in range(modes):
            stretched += problem.along[s, i] * units[i]
        units[first + s] = spring_force(problem, s, memory.motion.piece[s], stretched)
    first += problem.along.shape[0]
    for d in range(memory.push.shape[1]):
        value = 0.0
        for k in range(memory.terms[0] - 1, -1, -1):
            value = value * x + memory.present[d, k]
        units[first + d] = value


@kernel
def _put_bends(problem, memory, units, end):
    """Fill how much farther than its values at the ends of a step a unit can be between them."""
    modes, contacts, terms = problem.squares.size, problem.law.size, memory.motion.terms
    for a in range(units.size):
        units[a] = 0.0
    share = OVERSHOOT * end * end
    first = 2 * modes + 2 * contacts + problem.along.shape[0]
    for k in range(2, LONG):
        second = share * k * (k - 1.0)
        for i in range(modes):
            units[i] += second * abs(terms.moves[k, i])
            units[modes + i] += second * (k - 2.0) * abs(terms.moves[k, i]) / memory.length[0]
        if k < TERMS:
            for j in range(contacts):
                units[2 * modes + j] += second * abs(terms.force[k, j])
                pressed = problem.pressed[j] * abs(terms.press[k, j])
                units[2 * modes + contacts + j] += second * pressed
        for d in range(memory.push.shape[1] if k < memory.terms[0] else 0):
            units[first + d] += second * abs(memory.present[d, k])
    for s in range(problem.along.shape[0]):
        slope = abs(problem.slopes[s, memory.motion.piece[s]])
        for i in range(modes):
            units[2 * modes + 2 * contacts + s] += slope * abs(problem.along[s, i]) * units[i]


@kernel
def _fill_forces(problem, cell, memory, weights, i):
    """Add the forces of contacts and springs to the series of quantity i in the scratch."""
    modes, contacts, motion = problem.squares.size, problem.law.size, memory.motion
    value, terms = memory.scratch[VALUE], motion.terms
    for j in range(contacts):
        share, pressed = weights[i, 2 * modes + j], weights[i, 2 * modes + contacts + j]
        for k in range(TERMS if share != 0.0 else 0):
            value[k] += share * terms.force[k, j]
        for k in range(TERMS if pressed != 0.0 and problem.presses[j] else 0):
            value[k] += pressed * normal_change(problem, cell, motion, terms, k, j, 1.0)
    for s in range(problem.along.shape[0]):
        share, piece = weights[i, 2 * modes + 2 * contacts + s], motion.piece[s]
        if share != 0.0:
            value[0] += share * spring_force(problem, s, piece, dot(problem.along, s, terms.moves[0]))
            for k in range(1, LONG):
                value[k] += share * problem.slopes[s, piece] * dot(problem.along, s, terms.moves[k])


@kernel
def _fill_watched(problem, cell, memory, weights, i):
    """Fill the series of quantity i in the scratch."""
    modes, value, moves = problem.squares.size, memory.scratch[VALUE], memory.motion.terms.moves
    for k in range(WIDTH):
        value[k] = 0.0
    for a in range(modes):
        place, rate = weights[i, a], weights[i, modes + a] / memory.length[0]
        if place != 0.0 or rate != 0.0:
            for k in range(LONG):
                value[k] += place * moves[k, a]
            for k in range(LONG - 1):
                value[k] += rate * (k + 1.0) * moves[k + 1, a]
    _fill_forces(problem, cell, memory, weights, i)
    first = weights.shape[1] - memory.push.shape[1]
    for d in range(memory.push.shape[1]):
        for k in range(memory.terms[0] if weights[i, first + d] != 0.0 else 0):
            value[k] += weights[i, first + d] * memory.present[d, k]


@kernel
def _keep_peaks(problem, cell, memory, begin, end, kept):
    """Include the watched quantities in the present step."""
    put_units(problem, cell, memory, kept.units[BEGIN], 0.0)
    put_units(problem, cell, memory, kept.units[END], end)
    _put_bends(problem, memory, kept.units[BEND], end)
    add_up(kept)
    for i in range(kept.weights.shape[0]):
        if not stays_within(kept, i, kept.sums[BEGIN, i], kept.sums[END, i], kept.sums[BEND, i]):
            _fill_watched(problem, cell, memory, kept.weights, i)
            keep_peak(memory.scratch, begin, end, memory.length[0], memory.row.size, kept, i)


@kernel
def _keep_slide(problem, memory, j, end, kept):
    """Add the present step of a slide to its distance, and to the work of friction."""
    contacts, series = problem.law.size, memory.motion.series
    z, w, f = Z * contacts + j, W * contacts + j, F * contacts + j
    way = value_at(series, z, end) - series[z, 0] - memory.row.belt[j] * end
    force, last = series[f, 0], value_at(series, f, end)
    elastic = problem.law[j] == ELASTIC
    if elastic:
        way -= (last - force) / problem.spring[j]
    kept.record.distance[j] += abs(way)
    kept.slides[PRESENT, j] += abs(way)
    kept.slides[LARGEST, j] = max(kept.slides[LARGEST, j], kept.slides[PRESENT, j])
    if problem.lift[j] == 0.0:
        kept.record.works[OF_FRICTION, j] += force * way
        return
    kept.record.works[OF_FRICTION, j] += integral_of_product(series, f, w, end)
    if elastic:
        kept.record.works[OF_FRICTION, j] -= 0.5 * (last * last - force * force) / problem.spring[j]


@kernel
def _keep_walls(problem, memory, j, end, kept):
    """Add the works of the wall of a contact: by its own velocity, and with the base."""
    force = memory.motion.series[F * problem.law.size + j]
    if memory.row.belt[j] != 0.0:
        total = 0.0
        for k in range(TERMS - 1, -1, -1):
            total = total * end + force[k] / (k + 1.0)
        kept.record.works[OF_WALL, j] -= total * end * memory.row.belt[j]
    for d in range(memory.walls.size):
        share = problem.moved[j] * memory.walls[d]
        if share != 0.0:
            part = integral_by_slope(memory.present[d], force, end, memory.terms[0])
            kept.works[OF_BASE] -= share * part


@kernel
def _keep_ground(problem, cell, memory, end, kept):
    """Add the work of the ground on what it presses and stretches: it moves back where the base moves on."""
    value = memory.scratch[VALUE]
    for k in range(WIDTH):
        value[k] = 0.0
    _fill_forces(problem, cell, memory, memory.ground, 0)
    for d in range(memory.walls.size):
        if memory.walls[d] != 0.0:
            part = integral_by_slope(memory.present[d], value, end, memory.terms[0])
            kept.works[OF_BASE] += memory.walls[d] * part


@kernel
def _keep_load(problem, memory, end, kept):
    """Add the work of the load: [L P.x] less the integral of L' P.x."""
    modes, moves = problem.squares.size, memory.motion.terms.moves
    pushed = memory.scratch[_PUSHED]
    for d in range(memory.push.shape[1]):
        for k in range(LONG):
            pushed[k] = 0.0
            for i in range(modes):
                pushed[k] += memory.push[i, d] * moves[k, i]
        channel = memory.present[d]
        work = value_at(memory.scratch, _PUSHED, end) * value_at(memory.present, d, end)
        work -= pushed[0] * channel[0] + integral_by_slope(channel, pushed, end, memory.terms[0])
        kept.works[OF_LOAD] += work


@kernel
def keep_step(problem, cell, memory, begin, end, kept):
    """Include the present step, from `begin` in the part, to `end` in x after it."""
    motion = memory.motion
    _keep_peaks(problem, cell, memory, begin, end, kept)
    _keep_load(problem, memory, end, kept)
    if memory.ground.shape[0] > 0:
        _keep_ground(problem, cell, memory, end, kept)
    for j in range(problem.law.size):
        if motion.open[j] == 0 and problem.law[j] != SMOOTH:
            if motion.sense[j] != 0:
                _keep_slide(problem, memory, j, end, kept)
            _keep_walls(problem, memory, j, end, kept)


@kernel
def sense_of(motion, j):
    """Sense of a contact, LIFTED where it is open."""
    return LIFTED if motion.open[j] != 0 else motion.sense[j]


@kernel
def store_state(memory, units, x, kept):
    """Keep the state at x of the present part, whose units these are."""
    k = kept.counts[1]
    kept.counts[1] = k + 1
    if k < kept.states.shape[0]:
        kept.states[k, 0] = kept.clock[0] + x * memory.length[0]
        for a in range(units.size):
            kept.states[k, 1 + a] = units[a]
        for j in range(memory.motion.sense.size):
            kept.senses[k, j] = sense_of(memory.motion, j)


@kernel
def note_senses(memory):
    """Note the senses before an event."""
    for j in range(memory.before.size):
        memory.before[j] = sense_of(memory.motion, j)


@kernel
def list_changes(memory, x, kept):
    """List the contacts whose sense is not the one noted, at x of the present part."""
    time = kept.clock[0] + x * memory.length[0]
    for j in range(memory.before.size):
        old, new = memory.before[j], sense_of(memory.motion, j)
        if old == new:
            continue
        if new == LIFTED:
            kind = OPENS
        elif old == LIFTED:
            kind = CLOSES
        else:
            kind = STOP if new == 0 else (START if old == 0 else TURN)
            kept.changes[kind, j] += 1.0
        kept.slides[PRESENT, j] = 0.0
        slides = new != 0 and new != LIFTED
        if slides and kind != TURN and not (kept.first[0] <= time):
            kept.first[0] = time
        list_event(kept, time, j, kind)
