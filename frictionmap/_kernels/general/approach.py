"""Whether a motion goes to a steady state that Newton's method found near it, where the start matters.

For mu > 1 several steady states may attract, and a motion may pass one by for some time.
"""

import math

from ..compiler import kernel, late_kernel
from .counts import SLIPS, STOPS, TURNS
from .creep import find_rest, restore_friction
from .follow import FOLLOWED
from .orbits import NO_REPEAT, REPEATS, RETURNED, Steady, largest_multiplier, least_period
from .recurrence import distance_back, distance_from_last, distance_from_orbit, go_back, put_orbit, take_orbit
from .return_map import base_halves, go_round, motion_size, take_end

#: Largest distance from the motion that Newton's method may lead to, where the start matters.
_SAME = 5e-2

#: ... and over the distance at which a motion that is on its way there would be.
_HEADING = 3.0

#: Part of the distance that is left when a motion counts as on its way to a steady state; returns after which
#: that is decided in any case; and the least contraction per return that is reckoned with.
_NEARER = 0.3
_MOST_RETURNS = 64
_FASTEST = 1e-3

#: A multiplier above this is not that of a motion that attracts.
STABLE = 1.0 + 1e-9
STABLE_PRECISION = 0.01


@kernel
def _heads_for(problem, row, halves, contraction, memory, ring):
    """Whether the steady state found is stable, and as near as one that the motion goes to would be.

    A motion that returns to within d of where it was, and comes nearer to a steady state by a factor c each
    time, is d/(1 - c) away from it.

    Parameters
    ----------
    problem, row : Problem, Row
    halves : half periods after which it returns
    contraction : largest modulus of its multipliers over these
    memory, ring : Return, Ring
    """
    if contraction > STABLE:
        return False
    far = distance_from_last(row, memory, ring) / motion_size(problem, row, memory)
    if contraction < 1.0:
        expected = distance_back(row, memory, ring, 0, halves // base_halves(problem)) / (1.0 - contraction)
        if far > max(_HEADING * expected, RETURNED):
            return False
    return far <= _SAME


@kernel
def _does_the_same(memory, ring):
    """Whether there were as many stops, turns and slips as in the steady state kept."""
    for j in range(memory.senses.size):
        for part in (STOPS, TURNS, SLIPS):
            if memory.counts[part, j] != ring.orbit_counts[part, j]:
                return False
    return True


@kernel
def _approaches(problem, friction, halves, contraction, workspace):
    """Whether the motion comes nearer to the steady state in `memory.start`, which stays there.

    The motion is followed until most of the distance is gone, or for as long as that should take.  In every
    return it must have as many stops, turns and slips as the steady state: else it may only pass by.

    Parameters
    ----------
    problem, friction : Problem, Friction
    halves : half periods after which the steady state returns
    contraction : largest modulus of its multipliers over these
    workspace : Workspace; `memory.counts` are those of the steady state

    Returns
    -------
    (approaches, cycles) : periods followed
    """
    row, motion, memory, record = workspace.row, workspace.motion, workspace.memory, workspace.record
    ring = workspace.ring
    put_orbit(memory, ring)
    go_back(memory, ring, 0)
    size = motion_size(problem, row, memory)
    begin = distance_from_orbit(row, memory, ring)
    enough = max(_NEARER * begin, RETURNED * size)
    returns = _MOST_RETURNS
    if contraction < 1.0:
        needed = 2.0 * math.log(_NEARER) / math.log(max(contraction, _FASTEST))
        returns = int(min(2.0 + needed, returns))
    approaches, cycles = False, 0.0
    for count in range(1, returns + 1):
        code = go_round(problem, row, friction, halves, motion, memory, record, False)
        cycles += 0.5 * halves
        if code != FOLLOWED or not _does_the_same(memory, ring):
            break
        take_end(memory)
        far = distance_from_orbit(row, memory, ring)
        approaches = far <= enough or (count == returns and far <= begin * contraction ** (0.5 * count))
        if approaches:
            break
    take_orbit(memory, ring)
    return approaches, cycles


@late_kernel(Steady)
def try_return(problem, friction, halves, tolerance, workspace):
    """Find the steady state that the motion goes to, from a return after some half periods.

    Parameters
    ----------
    problem, friction : Problem, Friction
    halves : number of half periods
    tolerance : see `find`
    workspace : Workspace

    Returns
    -------
    Steady : REPEATS or NO_REPEAT
    """
    row, motion, memory, record = workspace.row, workspace.motion, workspace.memory, workspace.record
    ring, base = workspace.ring, base_halves(problem)
    status, cycles = find_rest(problem, friction, halves, tolerance, workspace)
    if status == REPEATS:
        contraction = largest_multiplier(problem, row, halves, STABLE_PRECISION, motion, memory)
        if _heads_for(problem, row, halves, contraction, memory, ring):
            approaches, more = _approaches(problem, friction, halves, contraction, workspace)
            cycles += more
            if approaches:
                least, more = least_period(problem, row, friction, halves, base, motion, memory, record)
                return Steady(REPEATS, least, cycles + more)
        restore_friction(friction, ring.friction)
    go_back(memory, ring, 0)
    return Steady(NO_REPEAT, 0, cycles)
