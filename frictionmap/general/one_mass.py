"""One mass on a wall under a load of several harmonics: what measured records are compared with."""

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from .._kernels.compiler.lending import Memories, made
from .._kernels.general.counts import MOVED, NEAREST_STOP, SLIPS, STOPS, STUCK
from .._kernels.general.problem import TURN, Problem
from .._kernels.general.row import intervals_of
from .._kernels.general.samples import fill_samples
from .._kernels.general.series import Friction
from .._kernels.general.steady import AVERAGED, REPEATS
from .recorded import Memory, recorded_state

_TOLERANCE = 1e-12

_ONE = np.ones((1, 1))
_NONE = np.zeros((1, 1))
_NO_MASSES = np.empty((0, 1))

#: Steps beyond those between events that are kept at first.
_EVENTS = 64


class SteadyMotion(NamedTuple):
    """Steady state of one mass."""

    repeats: bool  # whether there is one; if not, the rest is of the last period followed
    places: np.ndarray  # displacements
    stops: int  # a period; slips of a contact with a spring
    stuck: float  # share of the period; in which a contact with a spring does not slip
    turn_load: float  # the least load over stiffness at a turn without a stop; infinite without one


def _problem(r: float, zeta: float, load: np.ndarray, spring: float) -> Problem:
    """r^2 q'' + 2 zeta r q' + q + f = Re sum load_n e^{i n tau}, n >= 1; f through a spring, if it is not 0.

    Whole periods even where half of one suffices: a mass that rests stays where it began.
    """
    orders = np.flatnonzero(load[1:]) + 1 if load[1:].any() else np.array([1])
    phasors = load[orders] if load[1:].any() else np.zeros(1, dtype=complex)
    damping = 2.0 * zeta
    fastest = 0.5 * (damping + math.sqrt(damping * damping + 4.0 * (1.0 + spring))) / r
    size = float(np.abs(phasors).sum()) / (1.0 + r * r)
    parts = np.stack((phasors.real, -phasors.imag))[np.newaxis, :, np.newaxis]
    return Problem(
        np.ones(1), np.full((1, 1), damping), False, _ONE, _ONE, _NONE, _NONE, np.array([spring]),
        np.zeros(1), np.zeros((1, 1), dtype=bool), orders.astype(float), np.array([r]), parts,
        np.array([max(fastest, float(orders[-1]))]), np.array([size or 1.0]), False,
    )  # fmt: skip


@lru_cache(maxsize=16)
def _memories(harmonics: int, elastic: bool, intervals: int, most: int) -> Memories[Memory]:
    """Memory for problems of one size: a fit finds thousands of motions, each quicker than its allocation."""
    alike = _problem(1.0, 0.0, np.ones(harmonics + 1, dtype=complex), float(elastic))
    rate = (intervals - 0.5) * TURN / math.pi
    return Memories(lambda: Memory(alike._replace(rates=np.array([rate])), _NO_MASSES, most))


def _memories_for(problem: Problem) -> Memories[Memory]:
    """Memory with room for the steps between events, and some more; few sizes, so that it is used again."""
    rate = float(problem.rates[0])
    steps = int(4.0 * math.pi * rate / TURN) + _EVENTS
    sizes = (_power_of_two(made(intervals_of, rate)), _power_of_two(steps))
    return _memories(problem.orders.size, bool(problem.spring[0]), *sizes)


def _power_of_two(count: int) -> int:
    """The least power of two that is not below a number."""
    return 1 << (count - 1).bit_length()


def steady_motion(
    r: float, zeta: float, friction: float, mu: float, load: np.ndarray, start: tuple[float, float],
    phases: np.ndarray, cycles: int, spring: float = 0.0,
) -> SteadyMotion:  # fmt: skip
    """Find the steady state that the motion from a state at tau = 0 reaches.

    Parameters
    ----------
    r, zeta : frequency ratio > 0, damping ratio >= 0
    friction, mu : kinetic friction over stiffness >= 0, static over kinetic friction >= 1
    load : (N + 1,) complex harmonics 0, 1, ... of the load over stiffness, a length as the displacement
    start : displacement and velocity over tau at tau = 0
    phases : (n,) phases at which the displacement is wanted
    cycles : periods allowed
    spring : stiffness of a spring in the contact over that of the mass, >= 0; 0: the contact is rigid
    """
    problem = _problem(r, zeta, load, spring)
    offset = float(load[0].real)
    state = np.array([[start[0] - offset], [start[1]]])
    forces = Friction(np.array([friction]), np.array([mu * friction]))
    places = np.empty(phases.size)
    with _memories_for(problem).one() as memory:
        found, halves, _, counts, record, h, steps = recorded_state(
            problem, 0, forces, state, (cycles, _TOLERANCE), memory, False
        )
        period, counts = halves // 2, counts.copy()
        fill_samples(record.steps, record.patterns, steps, 0, h, period, phases, places)
    counted = found.halves // 2 if found.status == AVERAGED else period
    moves = counts[MOVED, 0] != 0.0
    nearest = counts[NEAREST_STOP, 0]
    return SteadyMotion(
        found.status == REPEATS, places + offset, round(counts[SLIPS if spring else STOPS, 0] / counted),
        counts[STUCK, 0] / (2.0 * math.pi * counted) if moves else 1.0,
        friction / nearest if nearest > 0.0 else math.inf,
    )  # fmt: skip
