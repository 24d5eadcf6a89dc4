"""Motions from many initial states in which a contact is at its limit of friction (mu > 1).

Every motion that goes on stopping passes such states: a stop ends at rest, with the contact carrying its
static friction.  One mass has no other coordinate: then the states over all phases of the load are all there
are.  Of structures the other coordinates are those of the motion without friction.
"""

from typing import NamedTuple

import numpy as np

from .. import regimes
from .._kernels.compiler.lending import Memories, lent
from .._kernels.general.fill import Grid, fill_rows, make_row_memory
from .._kernels.general.problem import Problem
from ..jobs import Job, Watch, run_jobs
from ..model.system import System
from .boundaries import friction_lines, sliding_states
from .outputs import allocate, number
from .problem import general_of, problem_of

#: Static friction of a contact that is about to slip is exceeded by this share: it slips at once.
_PAST = 1e-9

#: Periods after which a motion is left, more than irregular ones are followed for, and its tolerance.
_CYCLES, _TOLERANCE = 600.0, 1e-12

#: Motions in a job.
_IN_A_JOB = 64


class Places(NamedTuple):
    """k motions: frequency, friction ratio, phase of the load at which each begins, the contact that is at
    rest then, and the direction, 1 or -1, in which its friction acts; arrays (k,).
    """

    r: np.ndarray
    beta: np.ndarray
    phase: np.ndarray
    contact: np.ndarray
    sense: np.ndarray


def _from_phase(problem: Problem, phase: np.ndarray) -> Problem:
    """The problem with the load beginning at a phase, one of every frequency."""
    turned = problem.phasors[:, 0] - 1j * problem.phasors[:, 1]
    turned = turned * np.exp(1j * problem.orders * phase[:, np.newaxis, np.newaxis])
    return problem._replace(phasors=np.ascontiguousarray(np.stack((turned.real, -turned.imag), axis=1)))


def _moves_of_forces(squares: np.ndarray, chi: np.ndarray) -> np.ndarray:
    """Displacements of the modes, (k, m), that change the force in a contact at rest by 1.

    Rigid-body modes change no force.  Where no other mode moves the contact, it carries the load at any
    place, and motions that begin at rest at all phases begin to slip at its limit, too.
    """
    elastic = squares > 0.0
    if elastic.all():
        return chi / squares
    own = (chi[:, elastic] ** 2).sum(axis=1, keepdims=True)
    scale = np.divide((chi**2).sum(axis=1, keepdims=True), own, out=np.zeros_like(own), where=own > 0.0)
    return np.where(elastic, chi * scale / np.where(elastic, squares, 1.0), 0.0)


def _at_limit(problem: Problem, contact: np.ndarray, friction: np.ndarray) -> np.ndarray:
    """Modes and velocities at tau = 0, (k, 2, m): the motion without friction, changed so that a contact is
    at rest and carries its static friction.

    contact, friction : (k,) contact of each row, and the friction there with its sign
    """
    states = sliding_states(problem, problem.r, 1.0)
    chi = problem.chi[contact]
    mass = 1.0 / (chi**2).sum(axis=1)
    phasors = problem.phasors[:, 0] - 1j * problem.phasors[:, 1]
    load, rate, bend = (
        (phasors * (1j * problem.orders) ** k).real.sum(axis=2) for k in range(3)
    )  # of the channels, and their derivatives
    wall = problem.base[contact]
    moved, square = (wall * rate).sum(axis=1) + problem.belt[contact], problem.r**2
    states[:, 1] -= chi * (mass * ((chi * states[:, 1]).sum(axis=1) - moved))[:, np.newaxis]
    damped = problem.r[:, np.newaxis] * (states[:, 1] @ problem.damping)
    force = problem.squares * states[:, 0] + damped - load @ problem.push.T
    carried = mass * ((chi * force).sum(axis=1) + square * (wall * bend).sum(axis=1))
    nu = 1.0 + (problem.normal[contact] * load).sum(axis=1)
    moves = _moves_of_forces(problem.squares, chi)
    states[:, 0] -= moves * (carried + (1.0 + _PAST) * friction * nu)[:, np.newaxis]
    return np.ascontiguousarray(states)


def stops_of(
    system: System, places: Places, mu: float, threads: int, watch: Watch | None = None
) -> np.ndarray:
    """Stops per cycle of the steady states that motions reach, the most of all contacts, (k,).

    1 where all contacts stick permanently in the end; 0 where no steady state is reached within the periods
    that are allowed.
    """
    problem, modal = problem_of(system, places.r)
    problem = _from_phase(problem, places.phase)
    kinetic, static = friction_lines(system, np.array([mu]))
    limit = static[0, places.contact, 0] * places.beta + static[0, places.contact, 1]
    count = places.r.size
    grid = Grid(
        places.beta[:, np.newaxis], kinetic, static, np.ones((1, count), np.int64),
        _at_limit(problem, places.contact, places.sense * limit), False, _CYCLES, _TOLERANCE, True,
    )  # fmt: skip
    found = allocate((1, count, 1), general_of(system).count, 0)
    cancel, none = np.zeros(1, np.uint8), np.empty((0, modal.phi.shape[1]))
    memories = Memories(lambda: lent(make_row_memory(problem, none)))
    given = lent(problem), lent(grid), lent(found)

    def fill(first: int) -> None:
        with memories.one() as memory:
            fill_rows(first, min(first + _IN_A_JOB, count), *given, memory, cancel)

    jobs: list[Job] = [(fill, (first,)) for first in range(0, count, _IN_A_JOB)]
    try:
        run_jobs(jobs, threads, lambda _: None, watch)
    except BaseException:
        cancel[0] = 1  # the kernel checks it at every row
        raise
    rests = (found.contact_regime[0, :, 0] == regimes.PERMANENT_STICKING).any(axis=1)
    return np.maximum(rests, np.nan_to_num(number("stops", found)[0, :, 0]).max(axis=1))
