"""Places of contacts that rest: those to which the motion leads from its start.

A contact that rests permanently keeps its place, and an elastic one the offset of its slider.  Every place
for which its force stays within its friction is that of a steady state.  These states differ by the static
displacements under constant forces in the contacts at rest; all else is the same in them.  Which of them is
reached depends on the start: the motion is followed from there until no contact at rest can slip any more.
"""

import math
from typing import NamedTuple

import numpy as np

from ..compiler import entry, kernel, late_kernel
from ..structure.newton import solve_linear
from .counts import MOVED
from .creep import WITHOUT_LIMIT, keep_friction, restore_friction
from .follow import FOLLOWED
from .laws.coupled import is_coupled
from .laws.kinds import has_force, holding_stiffness
from .laws.speed import has_law, steepest, velocity_unit
from .loops import factor_independent
from .orbits import NO_REPEAT, REPEATS, drifts, newton, square_kept
from .parts import has_parts
from .pattern import stop_exactly
from .problem import MANY, SECTION, SIZE, F, H, P, Q, R, padded, varies
from .record import FORCES, HIGH, LOW, NOTHING, clear_record, displaced_by, pushed_by
from .return_map import (
    allow_factors,
    begins_held,
    copy_motion,
    forget_factors,
    from_rest,
    go_round,
    keeps_factors,
    put_state,
    round_state,
    take_end,
    take_state,
)
from .row import set_channels
from .series import factor_held, solve_held

#: Margin that a contact at rest must have, over the force that the present difference from the steady state
#: can cause: where other contacts slide, they turn a little earlier or later than in the steady state, which
#: that estimate leaves out.  Without them it is a bound.
_SAFETY = 4.0

#: A contact whose force hardly exceeds its friction slides ever more slowly, in one direction, to where it no
#: longer does.  One that slid so in this many periods, and has more than this share of the excess left,
#: ends there: all that changes faster, and could move it beyond, is over by then.
_CREEPS, _LEFT = 16, 0.5

#: Rows of `Places.creep`: periods in which a contact crept or stayed, its excess before the present _CREEPS
#: ones, and whether enough of it was left after those before.
_PERIODS, _BEFORE, _SLOWLY = 0, 1, 2

#: Share of the friction that is rounding error of the forces, and the one to which they are wanted.
_ROUNDING = 1e-12
_PRECISE = 1e-10

#: Periods without slip after which a contact counts as settled in any case: without damping, vibrations from
#: the start never end.
_STILL = 128

#: Sweeps over the contacts at rest in which their forces are brought within their friction.
_SWEEPS = 100


class Places(NamedTuple):
    """The contacts at rest in a steady state, and its forces."""

    rests: np.ndarray  # (N,) int: 1 for contacts that rest permanently
    limits: np.ndarray  # (2, N) friction of a cell while contacts are held, see `creep`
    orbit: np.ndarray  # (3, ...) the steady state at the section
    senses: np.ndarray  # (N,) its pattern there
    at: np.ndarray  # (N,) places in it
    forces: (
        np.ndarray
    )  # (2, N) lowest f + limit nu and highest f - limit nu in it; limits of 0 for a constant nu
    flexibility: np.ndarray  # (N, N) places per constant force, with a sign
    gains: np.ndarray  # (N,) largest force over the size of a difference of two motions, see `_difference`
    creep: np.ndarray  # (3, N), see `_note_creep`
    change: np.ndarray  # (N,) constant forces by which the places of a motion differ from those in the orbit
    moved: np.ndarray  # (M,) displacement of the modes under these
    matrix: np.ndarray  # (N, N) scratch
    columns: np.ndarray  # (M,) scratch


@entry
def make_places(problem):
    """Allocate the memory for places."""
    contacts, modes = problem.chi.shape
    width = padded(max(modes, contacts))
    square = (contacts, contacts)
    return Places(
        np.zeros(contacts, np.int64), np.zeros((2, contacts)), np.zeros((3, width)),
        np.zeros(contacts, np.int64), np.zeros(contacts), np.zeros((2, contacts)), np.zeros(square),
        np.zeros(contacts), np.zeros((3, contacts)), np.zeros(contacts), np.zeros(width), np.zeros(square),
        np.zeros(width),
    )  # fmt: skip


@kernel
def find_rests(problem, memory, halves, places):
    """List the contacts that rest in a steady state; how many.

    They did not move on the last way, or, where derivatives serve for several steps, only by rounding errors:
    in one direction, at the edge of their limits.

    Parameters
    ----------
    problem, memory, places : Problem, Return, Places
    halves : half periods of the last way
    """
    count = 0
    for j in range(memory.senses.size):
        edge = places.rests.size >= MANY and drifts(problem, memory.counts, halves, j)
        places.rests[j] = 1 if memory.counts[MOVED, j] == 0.0 or edge else 0
        count += places.rests[j]
    return count


@kernel
def _lift_limits(friction, places):
    """Hold the contacts at rest, whatever their force."""
    for j in range(places.rests.size):
        if places.rests[j] != 0:
            friction.kinetic[j] = friction.static[j] = WITHOUT_LIMIT


@kernel
def stop_contacts(problem, row, motion, memory):
    """Take the velocities of held contacts from the state in `memory.start`; False if they close a loop."""
    put_state(memory.start, memory.senses, motion)
    motion.clock[0] = math.nan
    set_channels(problem, row, SECTION, 0, motion)
    if not factor_independent(problem, row, motion, memory.box):
        return False
    stop_exactly(problem, row, motion)
    take_state(motion, memory.start, memory.senses, 1.0)
    return True


@kernel
def _place(problem, state, motion, j):
    """Place of a contact, of an elastic one that of its slider; the channels are those of the section."""
    modes, channels = problem.push.shape
    place = 0.0
    for m in range(modes):
        place += problem.chi[j, m] * state[Q, m]
    for d in range(channels):
        place -= problem.base[j, d] * motion.series[modes + d, 0]
    if has_force(problem, j):
        place -= state[F, j] / holding_stiffness(problem, j)
    for i in range(problem.spring.size if is_coupled(problem) else 0):
        if i != j:
            place -= problem.coupling.flexibility[j, i] * state[F, i]
    return place


@kernel
def fill_flexibility(problem, places):
    """Fill the change of places, with its sign turned, by constant forces in the contacts at rest."""
    contacts, modes = problem.chi.shape
    for a in range(contacts):
        for b in range(contacts):
            places.flexibility[a, b] = 1.0 if a == b else 0.0
            if places.rests[a] == 0 or places.rests[b] == 0:
                continue
            places.flexibility[a, b] = 0.0
            for m in range(modes):
                places.flexibility[a, b] += problem.chi[a, m] * problem.chi[b, m] / problem.squares[m]
            if is_coupled(problem):
                places.flexibility[a, b] += problem.coupling.flexibility[a, b]
            elif a == b and has_force(problem, a):
                places.flexibility[a, a] += 1.0 / holding_stiffness(problem, a)


@kernel
def _forces_of(places, change):
    """Replace changes of places by the changes of the forces in the contacts at rest."""
    contacts = places.rests.size
    for a in range(contacts):
        change[a] = -change[a] if places.rests[a] != 0 else 0.0
        for b in range(contacts):
            places.matrix[a, b] = places.flexibility[a, b]
    return solve_linear(places.matrix, change, contacts)


@kernel
def _fill_moved(problem, change, moved):
    """Displacement of the modes under constant forces in the contacts at rest."""
    contacts, modes = problem.chi.shape
    for m in range(modes):
        moved[m] = 0.0
        for j in range(contacts):
            moved[m] -= problem.chi[j, m] * change[j] / problem.squares[m]


@kernel
def _law_rate(problem, row, friction, places, m):
    """Largest force that holds a contact, by velocities of mode m that change the friction of sliders."""
    rate = 0.0
    for i in range(friction.kinetic.size if has_law(problem) else 0):
        if places.rests[i] == 0:
            push = 0.0
            for k in range(problem.push.shape[0]):
                push += places.columns[k] * row.reaction[i, k]
            damping = friction.kinetic[i] * steepest(problem, i) / velocity_unit(row)
            rate += abs(push * problem.chi[i, m]) * damping
    return rate


@kernel
def _gain(problem, row, friction, motion, places, j):
    """Largest force in contact j at rest, over the size of a difference of two motions; see `_difference`.

    The force that holds a rigid contact depends linearly on the displacements, the velocities and the forces
    of elastic contacts.
    """
    contacts, modes = problem.chi.shape
    if is_coupled(problem):
        return math.sqrt(problem.coupling.stiffest[j]) * row.numbers[R] / row.numbers[H]
    if has_force(problem, j):
        return math.sqrt(holding_stiffness(problem, j) * row.numbers[R] ** 2 / row.numbers[H] ** 2)
    right = motion.solve[contacts]
    for a in range(motion.held[contacts]):
        right[a] = 1.0 if motion.held[a] == j else 0.0
    solve_held(motion, right)
    for m in range(modes):
        places.columns[m] = 0.0
        for a in range(motion.held[contacts]):
            places.columns[m] += right[a] * problem.chi[motion.held[a], m]
    square = 0.0
    for m in range(modes):
        square += places.columns[m] ** 2 * row.stiffness[m]
        rate = 0.0
        for other in range(modes):
            rate += places.columns[other] * row.damping[other, m]
        rate = abs(rate) + _law_rate(problem, row, friction, places, m)
        square += rate * rate
    for other in range(contacts):
        if has_force(problem, other):
            push = 0.0
            for m in range(modes):
                push += places.columns[m] * row.reaction[other, m]
            square += (
                push * push * holding_stiffness(problem, other) * row.numbers[R] ** 2 / row.numbers[H] ** 2
            )
    return math.sqrt(square)


@kernel
def _fill_gains(problem, row, friction, motion, places):
    """Fill the gains, with the contacts at rest held and no others."""
    for j in range(places.rests.size):
        motion.sense[j] = 1 - places.rests[j]
    if not factor_held(problem, row, motion):
        return False
    for j in range(places.rests.size):
        places.gains[j] = _gain(problem, row, friction, motion, places, j) if places.rests[j] != 0 else 0.0
    return True


@late_kernel(bool)
def keep_orbit(problem, friction, halves, workspace):
    """Keep the steady state in `memory.start`, with the forces in its contacts at rest; False if that fails.

    Parameters
    ----------
    problem, friction : Problem, Friction
    halves : even number of half periods after which it returns; 1 if the other half mirrors this one, with
        all places at 0
    workspace : Workspace, whose places have the contacts at rest and their flexibility
    """
    row, motion, memory = workspace.row, workspace.motion, workspace.memory
    record, places = workspace.record, workspace.places
    copy_motion(memory.start, memory.senses, places.orbit, places.senses)
    if not _fill_gains(problem, row, friction, motion, places):
        return False
    keep_friction(friction, places.limits)
    contacts = places.rests.size
    for j in range(contacts):
        record.limits[j] = friction.static[j] if varies(problem, j) else 0.0
    _lift_limits(friction, places)
    clear_record(record)
    record.active[0] = FORCES
    code = go_round(problem, row, friction, halves, motion, memory, record, False)
    record.active[0] = NOTHING
    restore_friction(friction, places.limits)
    motion.clock[0] = math.nan
    set_channels(problem, row, SECTION, 0, motion)
    for j in range(contacts):
        places.at[j] = _place(problem, places.orbit, motion, j)
        low, high = record.forces[LOW, contacts + j], record.forces[HIGH, j]
        if halves == 1:
            low, high = min(low, -high), max(high, -low)
        places.forces[LOW, j], places.forces[HIGH, j] = low, high
        record.limits[j] = 0.0
    return code == FOLLOWED


@kernel
def _coupled_energy(problem, row, memory, places):
    """Part of the square of `_difference` by the forces in coupled contacts, f.F f."""
    sum_ = 0.0
    for j in range(places.change.size):
        for i in range(places.change.size):
            force = memory.start[F, j] - places.orbit[F, j] - places.change[j]
            other = memory.start[F, i] - places.orbit[F, i] - places.change[i]
            sum_ += force * problem.coupling.flexibility[j, i] * other
    return sum_ * row.numbers[H] ** 2 / row.numbers[R] ** 2


@kernel
def _difference(problem, row, memory, places):
    """Size of the difference of the motion in `memory.start` from the steady state with its places.

    Its square is twice the energy of the difference, in units of the interval; for mu = 1 it never grows.
    """
    contacts, modes = problem.chi.shape
    square = 0.0
    if is_coupled(problem):
        square = _coupled_energy(problem, row, memory, places)
    for m in range(modes):
        place = memory.start[Q, m] - places.orbit[Q, m] - places.moved[m]
        velocity = memory.start[P, m] - places.orbit[P, m]
        square += velocity * velocity + row.stiffness[m] * place * place
    for j in range(0 if is_coupled(problem) else contacts):
        if has_force(problem, j):
            force = memory.start[F, j] - places.orbit[F, j] - places.change[j]
            square += (
                force * force * row.numbers[H] ** 2 / (row.numbers[R] ** 2 * holding_stiffness(problem, j))
            )
    return math.sqrt(square)


@kernel
def _compare(problem, row, motion, memory, places):
    """Fill `places.change` of the motion in `memory.start`; the size of its difference otherwise."""
    motion.clock[0] = math.nan
    set_channels(problem, row, SECTION, 0, motion)
    for j in range(places.rests.size):
        places.change[j] = _place(problem, memory.start, motion, j) - places.at[j]
    if not _forces_of(places, places.change):
        return math.inf
    _fill_moved(problem, places.change, places.moved)
    return _difference(problem, row, memory, places)


@kernel
def _sides(problem, friction, places, j):
    """Largest forces of both signs in a contact at rest, above its friction, at the places of the motion."""
    limit = 0.0 if varies(problem, j) else friction.static[j]
    high = places.forces[HIGH, j] + places.change[j] - limit
    low = places.forces[LOW, j] + places.change[j] + limit
    return high, -low


@kernel
def _note_creep(problem, friction, memory, places):
    """Count the periods in which each contact at rest stayed where it was, or slid to where its force no
    longer exceeds its friction.

    Parameters
    ----------
    problem, friction : Problem, Friction
    memory : Return after the last way of the motion
    places : Places after `_compare`
    """
    creep = places.creep
    for j in range(places.rests.size):
        high, low = _sides(problem, friction, places, j)
        excess, way = max(high, low), 1.0 if high > low else 2.0
        moved = memory.counts[MOVED, j]
        # an elastic contact at its limit may be taken along by one that creeps
        if moved != 0.0 and (moved != way or excess < -_ROUNDING * friction.static[j]):
            creep[_PERIODS, j] = creep[_SLOWLY, j] = 0.0
            continue
        if creep[_PERIODS, j] % _CREEPS == 0.0:
            slowly = creep[_PERIODS, j] > 0.0 and excess >= _LEFT * creep[_BEFORE, j]
            creep[_SLOWLY, j], creep[_BEFORE, j] = 1.0 if slowly else 0.0, excess
        creep[_PERIODS, j] += 1.0


@kernel
def _is_settled(problem, friction, memory, difference, safety, places):
    """Whether the places are known that the contacts at rest end at.

    Where one creeps, it causes the difference from the steady state: another that stays where it is, within
    its friction, ends there.

    Parameters
    ----------
    problem, friction, memory : Problem, Friction; Return, with the motion at the section
    difference : size of the difference from the steady state, see `_difference`
    safety : see `_SAFETY`
    places : Places after `_note_creep`
    """
    creeping, waiting = 0, 0
    for j in range(places.rests.size):
        if places.rests[j] == 0:
            continue
        limit = friction.static[j]
        high, low = _sides(problem, friction, places, j)
        excess, reach = max(high, low), places.gains[j] * difference
        # one that still slides, or is overloaded by more, goes on by its inertia to another place
        held = memory.senses[j] == 0 or reach <= _PRECISE * limit
        within = excess + safety * reach <= _ROUNDING * limit or max(excess, reach) <= _PRECISE * limit
        if held and within:
            continue
        if excess > 0.0 and places.creep[_SLOWLY, j] != 0.0:
            creeping += 1
        elif excess <= _ROUNDING * limit and places.creep[_PERIODS, j] >= _CREEPS:
            waiting += 1
        else:
            return False
    return waiting == 0 or creeping > 0


@kernel
def _unload(problem, friction, places):
    """Slide the contacts at rest, one after the other, until no force exceeds its friction.

    The places of all others stay; `places.change` becomes that of the places where it ends.
    """
    contacts = places.rests.size
    step = places.columns
    for _ in range(_SWEEPS):
        worst = 0.0
        for j in range(contacts):
            if places.rests[j] == 0:
                continue
            high, low = _sides(problem, friction, places, j)
            excess = max(high, low)
            worst = max(worst, excess - _ROUNDING * friction.static[j])
            if excess <= 0.0:
                continue
            for k in range(contacts):
                step[k] = -1.0 if k == j else 0.0
            if not _forces_of(places, step):
                return
            scale = (-excess if high > low else excess) / step[j]
            for k in range(contacts):
                places.change[k] += scale * step[k]
        if worst <= 0.0:
            return


@late_kernel((bool, float))
def follow_to_rest(problem, friction, halves, cycles, safety, workspace):
    """Follow the motion from `memory.start` until the places of the contacts at rest are known.

    Parameters
    ----------
    problem, friction : Problem, Friction
    halves : even number of half periods after which the steady state returns
    cycles : periods of the load to follow at most
    safety : see `_SAFETY`; 1 where all contacts rest
    workspace : Workspace after `keep_orbit`; `places.change` becomes that of the places of the motion

    Returns
    -------
    (known, cycles) : whether the places are known, after `_unload`; periods followed
    """
    row, motion, memory = workspace.row, workspace.motion, workspace.memory
    record, places = workspace.record, workspace.places
    followed, still = 0.0, 0.0
    for j in range(places.rests.size):
        places.creep[_PERIODS, j] = places.creep[_SLOWLY, j] = 0.0
    while True:
        difference = _compare(problem, row, motion, memory, places)
        if followed > 0.0:
            _note_creep(problem, friction, memory, places)
        if _is_settled(problem, friction, memory, difference, safety, places) or still >= _STILL:
            return True, followed
        if followed >= cycles:
            return False, followed
        if go_round(problem, row, friction, halves, motion, memory, record, False) != FOLLOWED:
            return False, followed
        take_end(memory)
        followed += 0.5 * halves
        still += 0.5 * halves
        for j in range(places.rests.size):
            if places.rests[j] != 0 and memory.counts[MOVED, j] != 0.0:
                still = 0.0


@kernel
def _move(problem, memory, places):
    """Move the state in `memory.start` by the constant forces `places.change` in the contacts at rest."""
    _fill_moved(problem, places.change, places.moved)
    for m in range(problem.push.shape[0]):
        memory.start[Q, m] += places.moved[m]
    for j in range(places.rests.size):
        if has_force(problem, j):
            memory.start[F, j] += places.change[j]


@kernel
def _move_to_zero(problem, row, motion, memory, places):
    """Move the state in `memory.start` so that the contacts at rest are at the place 0."""
    motion.clock[0] = math.nan
    set_channels(problem, row, SECTION, 0, motion)
    for j in range(places.rests.size):
        places.change[j] = -_place(problem, memory.start, motion, j)
    if _forces_of(places, places.change):
        _move(problem, memory, places)


@late_kernel((bool, float))
def keep_orbit_anew(problem, friction, halves, tolerance, bits, workspace):
    """Keep a steady state as `keep_orbit` does, with bits that do not depend on how it was found.

    It is found anew from its rounded state at the place 0.

    Parameters
    ----------
    problem, friction, halves, workspace : see `keep_orbit`
    tolerance : see `steady.find`
    bits : see `round_state`

    Returns
    -------
    (kept, cycles) : whether that was possible; periods followed
    """
    row, motion, memory = workspace.row, workspace.motion, workspace.memory
    record, places = workspace.record, workspace.places
    fill_flexibility(problem, places)
    _move_to_zero(problem, row, motion, memory, places)
    keep_friction(friction, places.limits)
    _lift_limits(friction, places)
    round_state(problem, row, friction, memory, bits)
    forget_factors(memory)
    status, cycles = NO_REPEAT, 0.0
    # half a period suffices where the other half mirrors it, with all places at 0
    base = 1 if keeps_factors(memory) and problem.symmetric and not has_parts(problem, 1) else halves
    if stop_contacts(problem, row, motion, memory):
        status, cycles = newton(problem, row, friction, base, tolerance, motion, memory, record)
        if base != halves and status == REPEATS:
            square_kept(problem, row, motion, memory)
    restore_friction(friction, places.limits)
    if status != REPEATS:
        return False, cycles
    kept = keep_orbit(problem, friction, base, workspace)
    return kept, cycles + 0.5 * base


@kernel
def hold_orbit(friction, memory, places):
    """Go to the steady state that was kept, its contacts at rest held whatever their force."""
    _lift_limits(friction, places)
    copy_motion(places.orbit, places.senses, memory.start, memory.senses)


@late_kernel((bool, float))
def settle_places(problem, friction, halves, cycles, workspace):
    """Find the steady state with the places that the motion from `memory.start` leads to.

    Parameters
    ----------
    problem, friction : Problem, Friction; contacts at rest get a friction without limit
    halves : even number of half periods after which the steady state returns
    cycles : periods of the load to follow at most
    workspace : Workspace after `keep_orbit`; `memory.start` becomes the steady state

    Returns
    -------
    (known, cycles) : whether the places are known; periods followed
    """
    memory, places = workspace.memory, workspace.places
    slide = 0
    for j in range(places.rests.size):
        slide += 1 - places.rests[j]
    known, followed = follow_to_rest(
        problem, friction, halves, cycles, _SAFETY if slide > 0 else 1.0, workspace
    )
    _unload(problem, friction, places)
    hold_orbit(friction, memory, places)
    _move(problem, memory, places)
    return known, followed


@kernel
def _hold_all(friction, memory, places):
    """Hold all contacts, whatever their force, and begin at the section with no displacement."""
    for part in range(3):
        for i in range(memory.start.shape[1]):
            memory.start[part, i] = 0.0
    for j in range(places.rests.size):
        places.rests[j] = 1
        memory.senses[j] = 0
        friction.kinetic[j] = friction.static[j] = WITHOUT_LIMIT


@late_kernel(bool)
def keep_held(problem, friction, tolerance, workspace):
    """Keep the steady state in which all contacts rest at the place 0; False if none was found."""
    row, motion, memory = workspace.row, workspace.motion, workspace.memory
    record, places = workspace.record, workspace.places
    keep_friction(friction, places.limits)
    _hold_all(friction, memory, places)
    allow_factors(memory, False)  # whatever the cells before
    fill_flexibility(problem, places)
    if not stop_contacts(problem, row, motion, memory):
        return False
    status, _ = newton(problem, row, friction, 2, tolerance, motion, memory, record)
    restore_friction(friction, places.limits)
    _move_to_zero(problem, row, motion, memory, places)
    return status == REPEATS and keep_orbit(problem, friction, 2, workspace)


@late_kernel(None)
def fill_needs(problem, friction, state, workspace):
    """Fill the static friction of each contact with which none ever slips; inf if one moves at the start, or
    where the normal load varies.

    Parameters
    ----------
    problem, friction : Problem; Friction, replaced
    state : (2, m) modes and their velocities q' at tau = 0
    workspace : Workspace after `keep_held`, whose needs are filled
    """
    row, motion, memory = workspace.row, workspace.motion, workspace.memory
    record, places, needs = workspace.record, workspace.places, workspace.needs
    for j in range(places.rests.size):
        friction.kinetic[j] = friction.static[j] = WITHOUT_LIMIT
        needs[j] = math.inf
    if not begins_held(problem, row, friction, state, motion, memory):
        return
    clear_record(record)
    from_rest(problem, row, friction, state, motion, memory, record, FORCES)
    difference = _compare(problem, row, motion, memory, places)
    for j in range(places.rests.size):
        if not varies(problem, j):
            most = max(places.forces[HIGH, j], -places.forces[LOW, j]) + places.gains[j] * difference
            needs[j] = max(most, max(record.forces[HIGH, j], -record.forces[LOW, j]))


@kernel
def _shift_by(problem, record, places, shift):
    """Fill the displacements under the constant forces `places.change`."""
    for i in range(shift.size):
        shift[i] = displaced_by(problem, record, places.moved, i)
        shift[i] += pushed_by(problem, record, places.change, i)


@late_kernel(bool)
def place_at_start(problem, friction, state, workspace, shift):
    """Fill the displacements of contacts and masses that all rest at the places where they begin.

    They begin without forces: a load that displaces points beside the modes moves sliders away from 0.

    Parameters
    ----------
    problem, friction, state, workspace, shift : see `place_after_start`

    Returns
    -------
    bool : False if all begin at the place 0, beside which displacements are given
    """
    row, motion, memory = workspace.row, workspace.motion, workspace.memory
    record, places = workspace.record, workspace.places
    begins_held(problem, row, friction, state, motion, memory)
    away = False
    for j in range(places.rests.size):
        places.change[j] = _place(problem, motion.state, motion, j)
        away = away or abs(places.change[j]) > _ROUNDING * row.numbers[SIZE]
    if not away or not _forces_of(places, places.change):
        return False
    _fill_moved(problem, places.change, places.moved)
    _shift_by(problem, record, places, shift)
    return True


@late_kernel(bool)
def place_after_start(problem, friction, state, cycles, workspace, shift):
    """Fill the displacements of contacts and masses that all rest, at the places to which the start leads.

    Parameters
    ----------
    problem, friction : Problem, Friction
    state : (2, m) modes and their velocities q' at tau = 0
    cycles : periods of the load to follow at most
    workspace : Workspace after `keep_held`
    shift : (N + n,) filled with the displacements beside those at the place 0

    Returns
    -------
    bool : whether the places are known
    """
    row, motion, memory = workspace.row, workspace.motion, workspace.memory
    record, places = workspace.record, workspace.places
    from_rest(problem, row, friction, state, motion, memory, record, NOTHING)
    known, _ = follow_to_rest(problem, friction, 2, cycles, 1.0, workspace)
    if not known:
        return False
    _unload(problem, friction, places)
    _fill_moved(problem, places.change, places.moved)
    _shift_by(problem, record, places, shift)
    return True
