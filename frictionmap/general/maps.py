"""Maps of general systems: cells computed row by row on several threads, as labelled variables."""

from collections.abc import Mapping

import numpy as np

from .. import regimes
from .._kernels.compiler.lending import Memories, lent
from .._kernels.general.fill import ALL_PLACES, NO_PLACES, Cells, Grid, fill_rows, make_row_memory
from ..jobs import Job, Progress, Watch, run_counted
from ..model.settings import Solver
from ..model.system import System
from .boundaries import friction_lines, stays_at_rest
from .certificate import certified_beta
from .cyclic import keep_sectors, kept_rows, spread
from .held import held_ranges
from .observed import has_direct, observed_rows, of_contacts_last
from .outputs import allocate
from .problem import general_of, problem_of, static_offset
from .starts import initial_states
from .still import put_still

#: Cells of a job at least, in whole rows: a job costs as much as a few cells.
_IN_A_JOB = 64


def _put_r_zero(found: Cells, at_zero: int, beta: np.ndarray, stick: np.ndarray) -> None:
    """Fill r = 0: the regime is known, and no number of stops has a limit."""
    for m in range(stick.shape[0]):
        stuck = beta >= stick[m, at_zero]
        found.regime[m, at_zero] = np.where(stuck, regimes.PERMANENT_STICKING, regimes.STICK_SLIP)
        found.status[m, at_zero] = np.where(stuck, regimes.RESOLVED, regimes.QUASI_STATIC)
        found.release_order[m, at_zero] = np.where(stuck, 0, regimes.UNRESOLVED)
        found.contact_regime[m, at_zero] = found.regime[m, at_zero][:, np.newaxis]


def _put_stuck(system: System, r: np.ndarray, found: Cells) -> None:
    """Add the displacements of the held structure in cells that closed forms prove to stick."""
    kept = found.lowest.shape[-1]  # contacts, and masses and more where they are wanted
    low, high = held_ranges(system, r, kept > general_of(system).count + system.n)
    stuck = (found.regime == regimes.PERMANENT_STICKING) & (found.origin == regimes.CLOSED_FORM)
    m, i, b = np.nonzero(stuck)
    found.highest[m, i, b] += high[i, :kept]
    found.lowest[m, i, b] += low[i, :kept]


def solve_cells(
    system: System, axes: Mapping[str, np.ndarray], beta_stick: np.ndarray, solver: Solver, threads: int,
    progress: Progress | None, watch: Watch | None, masses: bool, places: int = ALL_PLACES,
    further: bool = False,
) -> Cells:  # fmt: skip
    """Compute all cells of a grid.

    Parameters
    ----------
    system : System
    axes : mu, r and beta (n_beta,), or beta (n_r, n_beta), own ones of every r
    beta_stick : (n_mu, n_r) boundary to permanent sticking
    solver : Solver
    threads : number of threads
    progress, watch : as in `sweep`
    masses : whether displacements of the masses are wanted, after those in the contacts
    places : NO_PLACES, SOME_PLACES or ALL_PLACES, see `outputs.wanted_places`
    further : whether drifts, accelerations and the force on the base are, after those of the masses
    """
    mu, r = axes["mu"], axes["r"]
    beta = np.tile(axes["beta"], (r.size, 1)) if axes["beta"].ndim == 1 else axes["beta"]
    many = beta.shape[1]
    problem, modal = problem_of(system, r, float(beta.max()), loops=True)
    general = general_of(system)
    kinetic, static = friction_lines(system, mu)
    equal = (static == kinetic).all(axis=(1, 2))
    sure = equal[:, np.newaxis, np.newaxis] & (beta <= certified_beta(system))
    unique = sure.all(axis=(1, 2))
    proved = (unique | stays_at_rest(system, solver.start)) & (solver.skip == "exact")
    sticks_from = [np.searchsorted(beta[i], beta_stick[:, i]) for i in range(r.size)]
    stuck_from = np.where(proved[:, np.newaxis], np.stack(sticks_from, axis=1), many)
    starts = initial_states(system, problem, modal, solver.start)
    # the place of a free structure is arbitrary; that of contacts that close a loop is not looked for
    settled = NO_PLACES if general.free or general.loop else places
    observed, alike = masses or further or has_direct(system), None
    outputs = observed_rows(system, modal, further)
    multipliers = "multiplier" in solver.outputs
    if unique.all() and not multipliers:  # some deviations are not alike in all sectors
        alike = keep_sectors(system, problem, starts)
    if alike is not None:
        kept, starts = alike
        problem, outputs = kept.problem, kept_rows(system, kept, further)
        kinetic, static = kinetic[kept.contacts], static[:, kept.contacts]
    if not observed:
        outputs = np.empty((0, problem.squares.size))
    limits = float(solver.cycles), solver.tolerance, multipliers
    grid = Grid(beta, kinetic, static, stuck_from, starts, settled, *limits)
    contacts, segments = problem.spring.size, problem.law.speed.shape[1]
    found = allocate((mu.size, r.size, many), contacts, len(outputs), segments)
    found.unique[:] = sure
    cancel = np.zeros(1, np.uint8)
    rows = range(0, mu.size * r.size, max(1, _IN_A_JOB // max(many, 1)))
    memories = Memories(lambda: lent(make_row_memory(problem, outputs)))
    given = lent(problem), lent(grid), lent(found)

    def fill(first: int) -> None:
        with memories.one() as memory:
            fill_rows(first, min(first + rows.step, rows.stop), *given, memory, cancel)

    jobs: list[Job] = [(fill, (row,)) for row in rows]
    try:
        run_counted(jobs, threads, progress, watch)
    except BaseException:
        cancel[0] = 1  # the kernel checks it at every cell
        raise
    found = of_contacts_last(system, found if alike is None else spread(found, alike[0]))
    for at_zero in np.flatnonzero(r == 0.0):
        _put_r_zero(found, int(at_zero), beta[at_zero], beta_stick)
    _put_stuck(system, r, found)
    if masses or further:
        put_still(general, found.contact_regime, found.lowest, found.highest)
    put_offset(system, found)
    return found


def put_offset(system: System, found: Cells) -> None:
    """Add the displacements under constant loads, and these to the force on the base."""
    offset, kept = general_of(system).offset, found.lowest.shape[-1]
    if not offset.any():
        return
    z, x = static_offset(system)
    shift = np.concatenate((z, x, np.diff(x, prepend=0.0), np.zeros(system.n), [-offset.sum()]))[:kept]
    for table in (found.lowest, found.highest):
        table += shift
