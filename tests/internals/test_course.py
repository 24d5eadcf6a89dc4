"""Averages of general systems: those of a motion that repeats are what one period of it has."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from kernels import callable_kernel

import frictionmap as fm
from frictionmap._kernels.general import course, record, steady
from frictionmap._kernels.general.follow import MOVED, REVERSALS, SLIPS, STOPS, STUCK, TURNS
from frictionmap._kernels.general.problem import set_row
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


@pytest.mark.parametrize("name", SYSTEMS)
def test_averages_of_a_periodic_motion(name):
    system = fm.System(
        contacts=SYSTEMS[name], mass_ratios=[1.0, 0.7], stiffness_ratios=[1.0, 0.5], damping_ratios=0.05
    )
    problem, modal = problem_of(system, np.array([0.45]))
    kinetic, static = friction_lines(system, np.array([1.0]))
    friction = Friction(kinetic @ [0.3, 1.0], static[0] @ [0.3, 1.0])
    tools = steady.make_tools(problem, np.ascontiguousarray(modal.phi), 0)
    row, work, memory, ring, kept = tools.row, tools.work, tools.memory, tools.ring, tools.record
    call = SimpleNamespace(
        **{
            one.__name__: callable_kernel(one)
            for one in (
                set_row, steady.from_rest, steady.find, steady.measure, course.begin_course,
                course.follow_cycle, course.set_window, course.take_window,
            )
        }
    )  # fmt: skip
    call.set_row(problem, 0, row)
    start = rest_states(system, modal, np.array([0.45]))[0]
    call.from_rest(problem, row, friction, start, work, memory, kept)
    found = call.find(problem, row, friction, 2000.0, 1e-12, work, memory, ring, kept, tools.course)
    assert found.status == steady.REPEATS
    state, senses = memory.start.copy(), memory.senses.copy()
    whole = found.halves if found.halves % 2 == 0 else 2 * found.halves
    call.measure(problem, row, friction, whole, work, memory, kept, record.RANGES)
    wanted = counted(memory.counts, kept, whole, problem.spring > 0.0)
    memory.start[:], memory.senses[:] = state, senses
    periods = whole // 2
    call.begin_course(periods, memory, kept, tools.course)
    for cycle in range(periods, 3 * periods):
        call.follow_cycle(problem, row, friction, cycle, work, memory, ring, kept, tools.course)
    call.set_window(3 * periods, tools.course)
    halves = call.take_window(tools.course, memory.counts, kept)
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
