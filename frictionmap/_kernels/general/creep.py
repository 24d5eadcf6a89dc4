"""Contacts that creep: held, they rest, or show where to begin.

A contact whose load hardly exceeds its limit slides ever less each cycle, always in one direction, and no
motion gets to the end of that.  Sliding in one direction does not repeat on a wall at rest: either the
contact rests in the steady state, which the force that holds it decides (theory.md 11), or it will slide both
ways.
"""

from ..compiler import kernel, late_kernel
from .counts import MOVED, STUCK
from .follow import FOLLOWED
from .laws.kinds import has_force
from .orbits import DRIFTS, NO_REPEAT, REPEATS, drifts, newton
from .problem import F, Q, is_carried, is_rigid
from .record import FORCES, HIGH, LOW, NOTHING, clear_record
from .recurrence import go_back
from .return_map import copy_motion, go_round, take_end
from .row import normal_at_section

#: Friction of a contact that is held.
WITHOUT_LIMIT = 1e200

#: Rows of `Ring.friction`.  Marks: a contact was let go again, or rests all the same.  Ways: in which of
#: the two directions a contact that is held was sliding, 0 for both.
_KINETIC, _STATIC, _MARK, _WAY = 0, 1, 2, 3
_LET_GO, _RESTS = 1.0, 2.0

#: Contacts are held that slide in one direction, then those that are stuck for more than a share of the time.
_HELD = (0.0, 0.98, 0.5)

#: Attempts of Newton's method with contacts held, after 0, 1, 1 + 2, ... returns: without those that creep,
#: the motion approaches its steady state fast.
_ATTEMPTS = 8


@kernel
def keep_friction(friction, kept):
    """Keep the friction of the contacts, of which none is held, in the first rows of `kept`."""
    for j in range(friction.kinetic.size):
        kept[_KINETIC, j], kept[_STATIC, j] = friction.kinetic[j], friction.static[j]


@kernel
def restore_friction(friction, kept):
    """Give the contacts the friction back that was kept."""
    for j in range(friction.kinetic.size):
        friction.kinetic[j], friction.static[j] = kept[_KINETIC, j], kept[_STATIC, j]


@kernel
def _keep(friction, kept):
    """Keep the friction of the contacts, and that none is held, in `kept` (4, N)."""
    keep_friction(friction, kept)
    for j in range(friction.kinetic.size):
        kept[_MARK, j] = kept[_WAY, j] = 0.0


@kernel
def _creeps(problem, memory, share, whole, j):
    """Whether a contact slid in one direction on the last way; for a share > 0: was stuck for more of it."""
    if share > 0.0:
        return memory.counts[STUCK, j] > share * whole
    return drifts(problem, memory.counts, 2, j)


@kernel
def _hold(problem, row, friction, share, memory, kept):
    """Hold the contacts that creep, see `_creeps`; return how many more are held than before.

    Parameters
    ----------
    problem, row, friction : Problem, Row, Friction
    share : see `_creeps`
    memory : Return; its pattern and the forces of springs are changed
    kept : see `_keep`
    """
    whole = 0.0
    for j in range(memory.senses.size):
        whole = max(whole, memory.counts[STUCK, j])
    count = 0
    for j in range(memory.senses.size):
        if friction.kinetic[j] != WITHOUT_LIMIT and _creeps(problem, memory, share, whole, j):
            friction.kinetic[j] = friction.static[j] = WITHOUT_LIMIT
            kept[_WAY, j] = 0.0
            if drifts(problem, memory.counts, 2, j):
                kept[_WAY, j] = 1.0 if memory.counts[MOVED, j] == 1.0 else -1.0
            if kept[_MARK, j] == _LET_GO:
                kept[_MARK, j] = _RESTS
            if memory.senses[j] != 0 and has_force(problem, j):
                limit = kept[_KINETIC, j] * normal_at_section(problem, row, j)
                memory.start[F, j] = memory.senses[j] * limit
            memory.senses[j] = 0
            count += 1
    return count


@kernel
def _displace(problem, memory, j, change):
    """Change the force of a contact at rest by a constant: its place, or its slider's, and nothing else.

    A structure that nothing holds against a constant force stays where it is.
    """
    if is_carried(problem, j):
        return
    for m in range(problem.push.shape[0]):
        if not is_rigid(problem, m):
            memory.start[Q, m] -= problem.chi[j, m] * change / problem.squares[m]
    if has_force(problem, j):
        memory.start[F, j] += change


@kernel
def _release_overloaded(problem, row, friction, motion, memory, record, kept):
    """Let contacts go that cannot rest in the steady state in `memory.start`; how many, -1 where unknown.

    A contact can rest if a constant is within the range [f - mu beta nu, f + mu beta nu] at every phase: that
    is what another place changes its force f by.  One that cannot is moved to where its force exceeds both
    limits by as much: it will slide both ways.

    Parameters
    ----------
    problem, row, friction : Problem, Row, Friction, with contacts held
    motion, memory, record : Motion, Return, Record
    kept : see `_keep`
    """
    contacts = memory.senses.size
    for j in range(contacts):
        record.limits[j] = kept[_STATIC, j]
    clear_record(record)
    record.active[0] = FORCES
    code = go_round(problem, row, friction, 2, motion, memory, record, False)
    record.active[0] = NOTHING
    count = 0
    for j in range(contacts):
        record.limits[j] = 0.0
        overloaded = not record.forces[HIGH, j] <= record.forces[LOW, contacts + j]
        if friction.kinetic[j] == WITHOUT_LIMIT and overloaded and kept[_MARK, j] != _RESTS:
            _displace(problem, memory, j, -0.5 * (record.forces[HIGH, j] + record.forces[LOW, contacts + j]))
            friction.kinetic[j], friction.static[j] = kept[_KINETIC, j], kept[_STATIC, j]
            kept[_MARK, j] = _LET_GO
            count += 1
    return count if code == FOLLOWED else -1


@kernel
def _newton_later(problem, friction, halves, tolerance, workspace):
    """Newton's method from the state in `memory.start`, or where it fails from those that follow.

    Returns
    -------
    (status, cycles) : see `newton`
    """
    row, motion, memory, record = workspace.row, workspace.motion, workspace.memory, workspace.record
    ring, cycles = workspace.ring, 0.0
    for count in range(1, _ATTEMPTS + 1):
        copy_motion(memory.start, memory.senses, ring.orbit, ring.orbit_senses)
        status, more = newton(problem, row, friction, halves, tolerance, motion, memory, record)
        cycles += more
        if status != NO_REPEAT:
            return status, cycles
        copy_motion(ring.orbit, ring.orbit_senses, memory.start, memory.senses)
        for _ in range(count):
            if go_round(problem, row, friction, halves, motion, memory, record, False) != FOLLOWED:
                return NO_REPEAT, cycles
            cycles += 0.5 * halves
            take_end(memory)
    return NO_REPEAT, cycles


@kernel
def _settle(problem, friction, halves, tolerance, workspace):
    """Find a steady state by Newton's method; contacts that drift are held, those that cannot rest let go.

    A contact that was let go, and drifts again, rests: its load exceeds its limit by so little that it slides
    by less than rounding error.

    Parameters
    ----------
    problem, friction : Problem, Friction; contacts that rest keep a friction without limit
    halves : half periods after which it returns
    tolerance : see `steady.find`
    workspace : Workspace; the friction in its ring is that before, see `_keep`

    Returns
    -------
    (status, cycles) : REPEATS or NO_REPEAT; periods followed
    """
    row, motion, memory, record = workspace.row, workspace.motion, workspace.memory, workspace.record
    ring, cycles, held = workspace.ring, 0.0, 0
    for j in range(memory.senses.size):
        held += friction.kinetic[j] == WITHOUT_LIMIT
    for turn in range(3 * memory.senses.size + 1):  # each contact is held, let go, and held again
        if turn == 0 and held == 0:
            status, more = newton(problem, row, friction, halves, tolerance, motion, memory, record)
        else:
            status, more = _newton_later(problem, friction, halves, tolerance, workspace)
        cycles += more
        if status == DRIFTS:
            more_held = _hold(problem, row, friction, 0.0, memory, ring.friction)
            if more_held == 0:
                break
            held += more_held
        elif status != REPEATS or held == 0:
            return status, cycles
        else:
            released = _release_overloaded(problem, row, friction, motion, memory, record, ring.friction)
            cycles += 1.0
            if released < 0:
                break
            if released == 0:
                return REPEATS, cycles
            held -= released
    return NO_REPEAT, cycles


@late_kernel((int, float))
def find_rest(problem, friction, halves, tolerance, workspace):
    """Find the steady state by Newton's method, and the contacts that rest in it; see `_settle`.

    Returns
    -------
    (status, cycles) : REPEATS or NO_REPEAT, then with the friction as it was; periods followed
    """
    kept = workspace.ring.friction
    _keep(friction, kept)
    if problem.loops:  # no single force decides whether a contact can rest: the motion does
        row, motion, memory, record = workspace.row, workspace.motion, workspace.memory, workspace.record
        status, cycles = newton(problem, row, friction, halves, tolerance, motion, memory, record)
        return REPEATS if status == REPEATS else NO_REPEAT, cycles
    status, cycles = _settle(problem, friction, halves, tolerance, workspace)
    if status != REPEATS:
        restore_friction(friction, kept)
    return status, cycles


@late_kernel((int, float))
def find_held(problem, friction, halves, tolerance, workspace):
    """Find the steady state from the one of the structure that is held where it creeps; see `find_rest`.

    Parameters
    ----------
    problem, friction, halves, tolerance : see `find_rest`
    workspace : Workspace; the motion is that of the last state in its ring

    Returns
    -------
    (status, cycles) : see `find_rest`
    """
    row, motion, memory, record = workspace.row, workspace.motion, workspace.memory, workspace.record
    ring, cycles = workspace.ring, 0.0
    for share in _HELD:
        if problem.loops:
            break
        go_back(memory, ring, 0)
        code = go_round(problem, row, friction, 2, motion, memory, record, False)
        cycles += 1.0
        _keep(friction, ring.friction)
        if code == FOLLOWED and _hold(problem, row, friction, share, memory, ring.friction) > 0:
            status, more = _settle(problem, friction, halves, tolerance, workspace)
            cycles += more
            if status == REPEATS:
                return status, cycles
        restore_friction(friction, ring.friction)
    return NO_REPEAT, cycles


@late_kernel((int, float))
def find_crept(problem, friction, tolerance, workspace):
    """Find the steady state of a motion in which contacts slide in one direction, with these held; see
    `find_rest`.

    Parameters
    ----------
    problem, friction, tolerance : see `find_rest`
    workspace : Workspace; the motion is that of the last state in its ring
    """
    row, motion, memory, record = workspace.row, workspace.motion, workspace.memory, workspace.record
    kept = workspace.ring.friction
    go_back(memory, workspace.ring, 0)
    code = go_round(problem, row, friction, 2, motion, memory, record, False)
    _keep(friction, kept)
    status, cycles = NO_REPEAT, 1.0
    if code == FOLLOWED and _hold(problem, row, friction, 0.0, memory, kept) > 0:
        status, more = _settle(problem, friction, 2, tolerance, workspace)
        cycles += more
    if status != REPEATS:
        restore_friction(friction, kept)
    return status, cycles


@kernel
def end_creep(problem, friction, memory, record, ring):
    """Move the contacts that crept, and were held, to where that ends: their forces just reach their limits.

    Constant forces in contacts displace the structure, and change nothing else in a steady state.

    Parameters
    ----------
    problem, friction, memory : Problem, Friction, Return after `find_rest` or `find_held`
    record, ring : Record, with the forces in the steady state; Ring
    """
    contacts = memory.senses.size
    for j in range(contacts):
        way = ring.friction[_WAY, j]
        if friction.kinetic[j] == WITHOUT_LIMIT and way != 0.0:
            change = -record.forces[HIGH, j] if way > 0.0 else -record.forces[LOW, contacts + j]
            _displace(problem, memory, j, change)
