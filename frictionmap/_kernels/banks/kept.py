"""What is kept of a motion under a record: peaks, works, slips, events, and states at samples.

What is watched is a sum of units: modes, their velocities, forces of contacts, and channels of the record.
A state has two more numbers of every contact: the energy of its elements, and what they have lost so far.
"""

from typing import NamedTuple

import numpy as np

from ..compiler import kernel
from ..general.crossings import value_at
from ..general.problem import WIDTH
from ..general.record import OF_FRICTION
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
from .level import slider
from .problem import Cell, Motion, Row
from .step import friction, mode_at

#: Places in `lengths`: of the interval, and of the present step.
OF_INTERVAL, OF_STEP = 0, 1

#: Rows of the scratch for what a channel pushes, and for the force of a contact.
_PUSHED, _FORCE = 7, 4


class Memory(NamedTuple):
    """Memory of a motion under a record of D channels."""

    motion: Motion
    row: Row  # of r = 1, without harmonics
    cell: Cell
    stretch: np.ndarray  # (E,) elongations of the springs of the elements at the start or at the end
    push: np.ndarray  # (m, D) loads on the modes
    walls: np.ndarray  # (D,) 1 of the channel that is the place of the base
    terms: np.ndarray  # (1,) int: terms of a channel
    lengths: np.ndarray  # (2,) see OF_INTERVAL
    count: np.ndarray  # (1,) int: terms of a displacement in the present step
    channels: np.ndarray  # (D, WIDTH) the channels over the interval
    present: np.ndarray  # (D, WIDTH) the same over the present step
    before: np.ndarray  # (N,) int: senses before an event
    scratch: np.ndarray  # (8, WIDTH)
    last: np.ndarray  # (m,) modes at the last sample, see `under_record.creeps`


@kernel
def put_channels(memory, x):
    """Set the loads at x of the interval, the rate of the base, and the channels from there on."""
    loads, modes, terms = memory.motion.loads, memory.push.shape[0], memory.terms[0]
    for i in range(modes + 1):
        loads[0, i] = loads[1, i] = 0.0
    for d in range(memory.walls.size):
        for k in range(terms):
            memory.present[d, k] = memory.channels[d, k]
        if x != 0.0:
            shift_piece(memory.present, d, x, terms)
        for i in range(modes):
            loads[0, i] += memory.push[i, d] * memory.present[d, 0]
        loads[0, modes] += memory.walls[d] * memory.present[d, 0]
        loads[1, modes] += memory.walls[d] * memory.present[d, 1] / memory.lengths[OF_INTERVAL]


@kernel
def put_loads(memory, length, count):
    """Scale the channels to a step of this length, and fill the series of the loads."""
    loads, modes, terms = memory.motion.loads, memory.push.shape[0], memory.terms[0]
    share, factor = length / memory.lengths[OF_INTERVAL], 1.0
    memory.lengths[OF_STEP], memory.count[0] = length, count
    for k in range(count):
        for i in range(modes + 1):
            loads[k, i] = 0.0
        for d in range(memory.walls.size if k < terms else 0):
            memory.present[d, k] *= factor
            for i in range(modes):
                loads[k, i] += length * length * memory.push[i, d] * memory.present[d, k]
            loads[k, modes] += memory.walls[d] * memory.present[d, k]
        factor *= share


@kernel
def put_units(memory, problem, cell, units, x):
    """Fill the units at x of the present step."""
    motion, modes, contacts = memory.motion, problem.squares.size, problem.moved.size
    for i in range(modes):
        q, p = mode_at(motion, i, memory.count[0], x)
        units[i], units[modes + i] = q, p / memory.lengths[OF_STEP]
    for j in range(contacts):
        units[2 * modes + j] = friction(problem, cell, motion, j, value_at(motion.z, j, x))
    for d in range(memory.walls.size):
        value = 0.0
        for k in range(memory.terms[0] - 1, -1, -1):
            value = value * x + memory.present[d, k]
        units[2 * modes + contacts + d] = value


@kernel
def _put_bends(memory, problem, units, end):
    """Fill how much farther than its values at the ends of a step a unit can be between them."""
    motion, modes, contacts = memory.motion, problem.squares.size, problem.moved.size
    for a in range(units.size):
        units[a] = 0.0
    for k in range(2, memory.count[0]):
        second = OVERSHOOT * end * end * k * (k - 1.0)
        for i in range(modes):
            size = second * abs(motion.moves[k, i])
            units[i] += size
            units[modes + i] += (k - 2.0) * size / memory.lengths[OF_STEP]
        for j in range(contacts):
            stiffness = problem.left[problem.first[j] + j + motion.now.level[j]]
            units[2 * modes + j] += stiffness * second * abs(motion.z[j, k])
        for d in range(memory.walls.size if k < memory.terms[0] else 0):
            units[2 * modes + contacts + d] += second * abs(memory.present[d, k])


@kernel
def _put_force(problem, cell, motion, j, share, out):
    """Add a share of the series of the force of a contact."""
    stiffness = share * problem.left[problem.first[j] + j + motion.now.level[j]]
    out[0] += share * friction(problem, cell, motion, j, motion.z[j, 0])
    for k in range(1, WIDTH):
        out[k] += stiffness * motion.z[j, k]


@kernel
def _fill_watched(memory, problem, cell, weights, n):
    """Fill the series of quantity n in the scratch."""
    motion, modes, contacts = memory.motion, problem.squares.size, problem.moved.size
    value, moves, count = memory.scratch[VALUE], memory.motion.moves, memory.count[0]
    for k in range(WIDTH):
        value[k] = 0.0
    for i in range(modes):
        place, rate = weights[n, i], weights[n, modes + i] / memory.lengths[OF_STEP]
        for k in range(count if place != 0.0 else 0):
            value[k] += place * moves[k, i]
        for k in range(count - 1 if rate != 0.0 else 0):
            value[k] += rate * (k + 1.0) * moves[k + 1, i]
    for j in range(contacts):
        if weights[n, 2 * modes + j] != 0.0:
            _put_force(problem, cell, motion, j, weights[n, 2 * modes + j], value)
    for d in range(memory.walls.size):
        for k in range(memory.terms[0]):
            value[k] += weights[n, 2 * modes + contacts + d] * memory.present[d, k]


@kernel
def _keep_peaks(memory, problem, cell, end, kept):
    """Include the watched quantities in the present step."""
    put_units(memory, problem, cell, kept.units[BEGIN], 0.0)
    put_units(memory, problem, cell, kept.units[END], end)
    _put_bends(memory, problem, kept.units[BEND], end)
    add_up(kept)
    length, size = memory.lengths[OF_STEP], memory.row.size
    for n in range(kept.weights.shape[0]):
        if not stays_within(kept, n, kept.sums[BEGIN, n], kept.sums[END, n], kept.sums[BEND, n]):
            _fill_watched(memory, problem, cell, kept.weights, n)
            keep_peak(memory.scratch, 0.0, end, length, size, kept, n)


@kernel
def _keep_slip(problem, cell, motion, j, end, kept):
    """Add the way of the first element, and the loss in all that slip: they are at their limits."""
    level = motion.now.level[j]
    if level > 0:
        way = abs(value_at(motion.z, j, end) - motion.z[j, 0])
        kept.record.distance[j] += way
        kept.slides[PRESENT, j] += way
        kept.slides[LARGEST, j] = max(kept.slides[LARGEST, j], kept.slides[PRESENT, j])
        kept.record.works[OF_FRICTION, j] += cell.slid[problem.first[j] + j + level] * way


@kernel
def _keep_wall(memory, problem, cell, j, end, kept):
    """Add the work of the wall of a contact that moves with the base."""
    force = memory.scratch[_FORCE]
    for k in range(WIDTH):
        force[k] = 0.0
    _put_force(problem, cell, memory.motion, j, problem.moved[j], force)
    for d in range(memory.walls.size):
        if memory.walls[d] != 0.0:
            kept.works[OF_BASE] -= integral_by_slope(memory.present[d], force, end, memory.terms[0])


@kernel
def _keep_load(memory, problem, end, kept):
    """Add the work of the load: [L P.x] less the integral of L' P.x."""
    modes, moves, terms = problem.squares.size, memory.motion.moves, memory.terms[0]
    pushed = memory.scratch[_PUSHED]
    for d in range(memory.walls.size):
        for k in range(WIDTH):
            pushed[k] = 0.0
        for k in range(memory.count[0]):
            for i in range(modes):
                pushed[k] += memory.push[i, d] * moves[k, i]
        channel = memory.present[d]
        last = value_at(memory.scratch, _PUSHED, end) * value_at(memory.present, d, end)
        kept.works[OF_LOAD] += last - pushed[0] * channel[0]
        kept.works[OF_LOAD] -= integral_by_slope(channel, pushed, end, terms)


@kernel
def keep_step(memory, problem, cell, end, kept):
    """Include the present step, which begins at `kept.clock`, up to x = `end`; its units are then END."""
    _keep_peaks(memory, problem, cell, end, kept)
    _keep_load(memory, problem, end, kept)
    for j in range(problem.moved.size):
        _keep_slip(problem, cell, memory.motion, j, end, kept)
        if problem.moved[j] != 0.0:
            _keep_wall(memory, problem, cell, j, end, kept)


@kernel
def sense_of(now, j):
    """Sense in which elements of a contact slip; 0 where none does."""
    return now.sense[j] if now.level[j] > 0 else 0


@kernel
def _energy_of(memory, problem, j, units):
    """Energy of the springs of the elements of a contact."""
    motion, modes, z, total = memory.motion, problem.squares.size, 0.0, 0.0
    for i in range(modes):
        z += problem.chi[j, i] * units[i]
    for d in range(memory.walls.size):
        z -= problem.moved[j] * memory.walls[d] * units[2 * modes + problem.moved.size + d]
    for i in range(problem.first[j], problem.first[j + 1]):
        stretch = z - slider(problem, memory.cell, motion, j, i, z)
        total += 0.5 * problem.spring[i] * stretch * stretch
    return total


@kernel
def store_state(memory, problem, kept):
    """Keep the state whose units are END, at `kept.clock`."""
    at, contacts = kept.counts[1], problem.moved.size
    kept.counts[1] = at + 1
    if at >= kept.states.shape[0]:
        return
    state, units = kept.states[at], kept.units[END]
    state[0] = kept.clock[0]
    for a in range(units.size):
        state[1 + a] = units[a]
    for j in range(contacts):
        state[1 + units.size + j] = _energy_of(memory, problem, j, units)
        state[1 + units.size + contacts + j] = kept.record.works[OF_FRICTION, j]
        kept.senses[at, j] = sense_of(memory.motion.now, j)


@kernel
def note_senses(memory):
    """Note the senses before an event."""
    for j in range(memory.before.size):
        memory.before[j] = sense_of(memory.motion.now, j)


@kernel
def list_changes(memory, kept):
    """List the contacts whose sense is not the one noted, at `kept.clock`."""
    time = kept.clock[0]
    for j in range(memory.before.size):
        old, new = memory.before[j], sense_of(memory.motion.now, j)
        if old != new:
            kind = STOP if new == 0 else (START if old == 0 else TURN)
            kept.changes[kind, j] += 1.0
            kept.slides[PRESENT, j] = 0.0
            if kind == START and not (kept.first[0] <= time):
                kept.first[0] = time
            list_event(kept, time, j, kind)
