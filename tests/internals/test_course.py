"""Averages of general systems: those of a motion that repeats are what one period of it has."""

import math

import numpy as np
import pytest

import frictionmap as fm
from benchmarks.measures.own_entry import own_entry
from frictionmap._kernels.compiler.packed import packed
from frictionmap._kernels.general import record, steady
from frictionmap._kernels.general.counts import MOVED, REVERSALS, SLIPS, STOPS, STUCK, TURNS
from frictionmap._kernels.general.course import begin_course, follow_cycle, set_window, take_window
from frictionmap._kernels.general.row import set_row
from frictionmap._kernels.general.series import Friction
from frictionmap.general.boundaries import friction_lines, rest_states
from frictionmap.general.problem import problem_of

#: A rigid contact and one with a spring, mu = 1.5 of the rigid one; a belt beside a wall.
WALL = fm.Contact("fixed-wall", 1, mu=1.5)
SYSTEMS = {
    "elastic": [WALL, fm.Contact("between-masses", (1, 2), ratio=0.3, stiffness=4.0)],
    "belt": [WALL, fm.Contact("fixed-wall", 2, ratio=0.3, wall_velocity=0.2)],
    "rigid": [WALL, fm.Contact("between-masses", (1, 2), ratio=0.4, mu=1.5)],
}


def counted(counts, kept, halves, elastic):
    """Numbers per period of the load."""
    own = {name: counts[row] / (0.5 * halves) for name, row in ROWS.items()}
    own["distance"] = kept.distance / (0.5 * halves)
    own["works"] = kept.works / (0.5 * halves)
    own["least slip"] = kept.slips[record.LEAST_SLIP][elastic]  # of rigid contacts it says nothing
    own["moved"] = counts[MOVED].copy()
    own["ranges"] = kept.ranges.copy()
    return own


ROWS = {"stops": STOPS, "turns": TURNS, "stuck": STUCK, "slips": SLIPS, "reversals": REVERSALS}


# Arguments are packed as in maps: of other types, all kernels would be compiled once more.


@own_entry
def settle(problem, friction, start, workspace):
    """Find the steady state; the row of the problem is filled."""
    problem, friction, workspace = packed(problem), packed(friction), packed(workspace)
    row, motion, memory, kept = workspace.row, workspace.motion, workspace.memory, workspace.record
    set_row(problem, 0, row)
    steady.from_rest(problem, row, friction, start, motion, memory, kept, record.NOTHING)
    return steady.find(problem, friction, 2000.0, 1e-12, workspace)


@own_entry
def measure(problem, friction, halves, workspace):
    """Follow one period of the motion into the counters and the record."""
    problem, friction, workspace = packed(problem), packed(friction), packed(workspace)
    steady.measure(problem, friction, halves, workspace, record.RANGES)


@own_entry
def average(problem, friction, periods, workspace):
    """Follow twice as many periods again, and average over the window; return its half periods."""
    problem, friction, workspace = packed(problem), packed(friction), packed(workspace)
    memory, kept, course = workspace.memory, workspace.record, workspace.course
    begin_course(periods, memory, kept, course)
    for cycle in range(periods, 3 * periods):
        follow_cycle(problem, friction, cycle, workspace)
    set_window(3 * periods, course)
    return take_window(course, memory.counts, kept)


@pytest.mark.parametrize("name", SYSTEMS)
def test_averages_of_a_periodic_motion(name):
    system = fm.System(
        contacts=SYSTEMS[name], mass_ratios=[1.0, 0.7], stiffness_ratios=[1.0, 0.5], damping_ratios=0.05
    )
    problem, modal = problem_of(system, np.array([0.45]))
    kinetic, static = friction_lines(system, np.array([1.0]))
    friction = Friction(kinetic @ [0.3, 1.0], static[0] @ [0.3, 1.0])
    workspace = steady.make_workspace(problem, np.ascontiguousarray(modal.phi), 0)
    memory, kept = workspace.memory, workspace.record
    start = rest_states(system, modal, np.array([0.45]))[0]
    found = settle(problem, friction, start, workspace)
    assert found.status == steady.REPEATS
    state, senses = memory.start.copy(), memory.senses.copy()
    whole = found.halves if found.halves % 2 == 0 else 2 * found.halves
    measure(problem, friction, whole, workspace)
    wanted = counted(memory.counts, kept, whole, problem.spring > 0.0)
    memory.start[:], memory.senses[:] = state, senses
    periods = whole // 2
    halves = average(problem, friction, periods, workspace)
    assert halves == 4 * periods
    averaged = counted(memory.counts, kept, halves, problem.spring > 0.0)
    assert sum(wanted["stops"]) + sum(wanted["slips"]) >= 2.0
    for key, values in wanted.items():
        if key in ("distance", "works", "ranges", "stuck", "least slip"):
            size = max(1.0, np.abs(values[np.isfinite(values)]).max(initial=0.0))
            assert averaged[key] == pytest.approx(values, abs=1e-10 * size), key
        else:
            assert np.array_equal(averaged[key], values), key
    assert math.isfinite(averaged["works"].sum())
