"""Partial sticking: the force that holds one contact while the others move."""

import math

from ..compiler import entry, kernel
from .creep import WITHOUT_LIMIT
from .record import FORCES, HIGH, LOW, NOTHING
from .return_map import from_rest
from .row import set_row
from .steady import REPEATS, find, measure


@kernel
def _fill(problem, i, contact, lines, values, state, limits, workspace, friction, out):
    """Fill the forces; see `fill_holding_force`.

    Parameters
    ----------
    problem, i, contact, lines, values, state, out : see `fill_holding_force`
    limits : cycles, tolerance
    workspace, friction : see `fill_holding_force`
    """
    cycles, tolerance = limits
    row, motion, memory, record = workspace.row, workspace.motion, workspace.memory, workspace.record
    set_row(problem, i, row)
    near = False
    for k in range(values.size):
        for j in range(lines.shape[0]):
            force = WITHOUT_LIMIT if j == contact else lines[j, 0] * values[k] + lines[j, 1]
            friction.kinetic[j] = force
            friction.static[j] = force
        if not near:
            from_rest(problem, row, friction, state, motion, memory, record, NOTHING)
        found = find(problem, friction, cycles, tolerance, workspace)
        halves = 0
        if found.status == REPEATS:
            halves, _ = measure(problem, friction, found.halves, workspace, FORCES)
        near = halves > 0
        out[k] = math.nan
        if near:
            out[k] = 0.5 * (record.forces[HIGH, contact] - record.forces[LOW, contact])


@entry
def fill_holding_force(problem, i, contact, lines, values, state, limits, workspace, friction, out):
    """Fill half the range of the force that holds one contact, for mu = 1.

    Parameters
    ----------
    problem, i : Problem, lent, index of r
    contact : contact that is held
    lines : (N, 2) friction of contact j is lines[j, 0] value + lines[j, 1]
    values : (n,) what the friction of the others is given by
    state : (2, m) modes and their velocities q' at tau = 0
    limits : cycles, tolerance, see `steady.find`
    workspace, friction : Workspace, Friction, lent; their content does not matter
    out : (n,) filled; NaN where no steady state was found
    """
    _fill(problem, i, contact, lines, values, state, limits, workspace, friction, out)
