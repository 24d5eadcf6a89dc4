"""Intervals of friction without stops over r."""

import numpy as np

from .. import regimes
from .._kernels.compiler.lending import Memories, lent, made
from .._kernels.general.ends import Intervals
from .._kernels.general.no_stop import fill_no_stop
from .._kernels.general.problem import Problem
from .._kernels.general.reach import Search, make_walk
from ..jobs import Job, Watch, run_jobs
from ..model.system import System
from .closed_limits import closed_limits, has_closed_limits
from .held import orders_of, rest_scales, sliding_phasors, solve_each
from .problem import ModalSystem, general_of, problem_of

#: Where the boundary to sticking is infinite: beta up to which stops are looked for, over the scale.
_HIGHEST = 1e6

#: Part of the loads that friction matters beside, at least.
_SMALLEST = 1e-6

#: A motion without friction that is larger, over its size away from resonances, is as good as one that grows
#: without bound.  With friction no motion is larger, by the second factor, than
#: another without, or than that of the walls.
_TALL, _TALLER = 1e6, 100.0

_CYCLES, _TOLERANCE = 40.0, 1e-12


def no_intervals(shape: tuple[int, int, int]) -> Intervals:
    """No intervals; `shape` is (n_mu, n_r, intervals)."""
    return Intervals(
        np.full(shape, np.nan), np.full(shape, np.nan), np.full(shape[:2], regimes.NO_LIMIT, np.int8),
        np.zeros(shape[:2], np.int64),
    )  # fmt: skip


def wall_size(system: System, modal: ModalSystem) -> float:
    """Largest coordinate of a mode where all masses move with the walls: friction can take them along."""
    general = general_of(system)
    moved = modal.phi.T @ general.moved(modal.mass)
    return float(np.abs(moved).max()) * sum(abs(u) for u in general.base.values())


def linear_states(problem: Problem, r: np.ndarray, wall: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Modes and velocities at tau = 0 of the motion without friction, (n_r, 2, m).

    Next to an undamped resonance it is as good as one that grows without bound; the state is then that of
    rest, from which the motion grows.

    wall : see `wall_size`

    Returns
    -------
    states, the largest motion that may be a steady state with friction (n_r,), whether it grows without
    (n_r,)
    """
    found = np.zeros((r.size, 2, problem.squares.size))
    loads = np.einsum("md,rdh->hrm", problem.push, problem.phasors[:, 0] - 1j * problem.phasors[:, 1])
    for n, load in zip(problem.orders, loads, strict=True):
        turn = (n * r)[:, np.newaxis, np.newaxis]
        matrix = (
            np.diag(problem.squares) - turn**2 * np.eye(problem.squares.size) + 1j * turn * problem.damping
        )
        modes = solve_each(matrix, load)
        found += np.stack((modes.real, -n * modes.imag), axis=1)
    size = np.abs(found).max(axis=(1, 2))
    grows = ~(size <= _TALL * problem.sizes)  # also where it is not finite
    tallest = np.where(
        grows, _TALL * problem.sizes, _TALLER * (wall + problem.sizes + np.where(grows, 0.0, size))
    )
    return np.where(grows[:, np.newaxis, np.newaxis], 0.0, found), tallest, grows


def friction_scales(
    system: System, modal: ModalSystem, r: np.ndarray, kinetic: np.ndarray, rests: np.ndarray
) -> np.ndarray:
    """Size of the friction ratios at which friction matters, (n_r,).

    It is that from which all contacts stick permanently; without one, the largest over the contacts whose
    friction has the size of the force that would stop them at a turn of the motion without friction.
    """
    general = general_of(system)
    orders = np.array(orders_of(general), dtype=float)
    mass = 1.0 / (modal.chi**2).sum(axis=1)  # effective masses
    turns = (r[:, np.newaxis] ** 2 * mass) * (orders**2 * np.abs(sliding_phasors(system, r))).sum(axis=2)
    loads = sum(float(np.abs(vector).max()) for vector in general.forces.values())
    loads += sum(abs(u) for u in general.base.values())
    least = _SMALLEST * loads
    moved = kinetic[:, 0] > 0.0
    sizes = np.where(np.isfinite(turns), turns, loads)[:, moved] / kinetic[moved, 0]
    found = np.clip(sizes.max(axis=1, initial=least), least, loads / least)
    return np.where(np.isfinite(rests) & (rests > 0.0), rests, found)


def put_closed_limits(system: System, r: np.ndarray, mu: np.ndarray, found: Intervals) -> np.ndarray:
    """Fill the first intervals in closed form; return their ends for mu = 1, (n_r,)."""
    one = closed_limits(system, r, np.append(mu, 1.0))
    found.begins[:, :, 0] = np.where(np.isnan(one.beta[:-1]), np.nan, 0.0)
    found.ends[:, :, 0] = one.beta[:-1]
    found.kind[:], found.contact[:] = one.kind[:-1], 1
    return one.beta[-1]


def find_intervals(
    system: System, r: np.ndarray, mu: np.ndarray, lines: tuple[np.ndarray, np.ndarray], needed: np.ndarray,
    intervals: int, threads: int, watch: Watch | None,
) -> Intervals:  # fmt: skip
    """Find the intervals of beta in which no contact stops, from beta = 0 up.

    Parameters
    ----------
    system : System
    r, mu : axes
    lines : kinetic (N, 2) and static (n_mu, N, 2) friction over beta
    needed : (n_r, N) static friction with which each contact sticks permanently if all do
    intervals : number of intervals that are looked for
    threads : number of threads
    watch : called repeatedly; an exception raised by it ends the search
    """
    found = no_intervals((mu.size, r.size, intervals))
    known = np.full(r.size, np.nan)
    if has_closed_limits(system):
        known = put_closed_limits(system, r, mu, found)
        if intervals == 1:
            return found
    problem, modal = problem_of(system, r)
    kinetic, static = lines
    rests = rest_scales(general_of(system), needed).max(axis=1)
    sticks = np.isfinite(rests)
    scale = friction_scales(system, modal, r, kinetic, rests)
    starts, tallest, grows = linear_states(problem, r, wall_size(system, modal))
    search = Search(
        kinetic, static, scale, np.where(sticks, rests, _HIGHEST * scale), sticks, known, tallest, grows,
        starts, _CYCLES, _TOLERANCE,
    )  # fmt: skip
    cancel = np.zeros(1, np.uint8)
    memories = Memories(lambda: lent(made(make_walk, problem, mu.size)))
    given = lent(problem), lent(search), lent(found)

    def fill(i: int) -> None:
        with memories.one() as walk:
            fill_no_stop(i, i + 1, *given, walk, cancel)

    jobs: list[Job] = [(fill, (i,)) for i in range(r.size)]
    try:
        run_jobs(jobs, threads, lambda _: None, watch)
    except BaseException:
        cancel[0] = 1  # the kernel checks it at every frequency
        raise
    return found
