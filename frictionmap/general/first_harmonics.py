"""First harmonics of steady states at a list of points, each with its own frequency and friction ratio."""

import numpy as np

from .. import regimes
from .._kernels.compiler.lending import lent
from .._kernels.general.counts import MOVED
from .._kernels.general.samples import fill_phasors
from .._kernels.general.series import Friction
from .._kernels.general.steady import REPEATS
from ..model.settings import Solver
from ..model.system import System
from .boundaries import friction_lines, rest_states
from .held import held_displacements, least_static_friction, linear_parts, solve_each, stick_scales
from .observed import has_residual
from .problem import general_of, problem_of
from .recorded import Memory, recorded_state

#: Steps for which there is room at first.
_STEPS = 64


def steady_phasors(system: System, r: np.ndarray, beta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Find the steady state of mu = 1 at every point; NaN and unresolved where none is found.

    Parameters
    ----------
    system : System
        With elastic contacts, under one harmonic.
    r : (k,) > 0
    beta : (k,) >= 0

    Returns
    -------
    phasors : (k, n) complex, X_k1 over P/k1 (Y)
    regime : (k,) int8
    """
    at, index = np.unique(r, return_inverse=True)
    phasors = np.full((r.size, system.n), complex(np.nan, np.nan))
    regime = np.full(r.size, regimes.UNRESOLVED, np.int8)
    free = beta == 0.0
    general = general_of(system)
    if general.shaken_points is None:
        alone = system.modes.mass_responses(at)
    else:
        alone = solve_each(*linear_parts(system, system.modes.stiffness, 1, at))
    without = general.displacements(1, at, alone, np.zeros((at.size, general.count)))
    phasors[free] = without[index[free]]
    regime[free] = regimes.CONTINUOUS
    one = np.ones(1)
    stick = stick_scales(general_of(system), least_static_friction(system, at), one)[0].max(axis=1)
    stuck = ~free & (beta >= stick[index])
    phasors[stuck] = held_displacements(system, at)[1][index[stuck]]
    regime[stuck] = regimes.PERMANENT_STICKING
    _follow(system, (at, index), beta, np.flatnonzero(~free & ~stuck), (phasors, regime))
    return phasors, regime


def _follow(
    system: System, frequencies: tuple[np.ndarray, np.ndarray], beta: np.ndarray, chosen: np.ndarray,
    found: tuple[np.ndarray, np.ndarray],
) -> None:  # fmt: skip
    """Fill in the motions that slip.

    frequencies : distinct r, and which of them each point has
    """
    at, index = frequencies
    problem, modal = problem_of(system, at)
    general = general_of(system)
    kinetic, _ = friction_lines(system, np.ones(1))
    starts, solver = rest_states(system, modal, at), Solver()
    no_masses = np.empty((0, modal.squares.size))  # their displacements are not recorded: modes are enough
    memory, given = Memory(problem, no_masses, _STEPS), lent(problem)
    for k in chosen:
        force = kinetic @ np.array([beta[k], 1.0])
        state, _, _, counts, record, h, steps = recorded_state(
            given, index[k], Friction(force, force), starts[index[k]], (solver.cycles, solver.tolerance),
            memory, settled=False,
        )  # fmt: skip
        if state.status != REPEATS:
            continue
        parts = np.empty((2, modal.squares.size))
        fill_phasors(record.steps, record.patterns, steps, h, parts)
        q = modal.phi @ (parts[0] + 1j * parts[1])
        forces = _forces(system, float(at[index[k]]), q) if has_residual(system) else np.zeros(general.count)
        r = at[index[k] : index[k] + 1]
        found[0][k] = general.displacements(1, r, q[np.newaxis], forces[np.newaxis])[0]
        moves = counts[MOVED].any()
        found[1][k] = regimes.STICK_SLIP if moves else regimes.PERMANENT_STICKING


def _forces(system: System, r: float, q: np.ndarray) -> np.ndarray:
    """First harmonics of the forces in contacts, (N,), that a motion q (n,) in balance with its load has."""
    matrix, load = linear_parts(system, system.modes.stiffness, 1, np.array([r]))
    return np.asarray(np.linalg.lstsq(general_of(system).vectors.T, load[0] - matrix[0] @ q)[0])
