"""What ends the motion without stops at beta_lim (theory.md 11), from the motion just below."""

from typing import NamedTuple

import numpy as np

from .. import regimes
from .._kernels.general.follow import NEAREST_STOP, STOPS
from .._kernels.general.problem import Problem
from ..errors import NoSteadyState
from ..model.settings import Solver
from ..model.system import System
from .boundaries import Boundaries, friction_lines
from .held import sliding_phasors
from .problem import ModalSystem, problem_of
from .steps import Steps, cell_steps

#: Distance below beta_lim, relative to it, of the motion looked at: far above rounding, and so close that
#: margins and phases differ from those at the limit by some 1e-9 only.
_BELOW = 1e-9

#: Distance above beta_lim, relative to it, at which the contact that stops is looked for: the first stop is
#: then long enough to be counted, and no further one has begun.
_ABOVE = 1e-6

#: Margin at a turn that is zero, and distance of two turns that coincide [rad]: in the middle, by orders of
#: magnitude, between what `_BELOW` leaves of zero and margins that are not.
_NO_MARGIN = 1e-5
_TOGETHER = 1e-5

#: Motion without friction, relative to the largest in any contact, that is none.
_STILL = 1e-12


class Limits(NamedTuple):
    """What ends the first interval without stops, (n_mu, n_r)."""

    kind: np.ndarray  # codes `regimes.LIMIT_KINDS`
    contact: np.ndarray  # the contact that stops, counted from 1; 0: there is no limit, or none was found


def find_limits(system: System, r: np.ndarray, mu: np.ndarray, limits: Boundaries) -> Limits:
    """Find what ends the first interval without stops, and which contact stops."""
    found = Limits(
        np.full(limits.beta_lim.shape, regimes.NO_LIMIT, np.int8), np.zeros(limits.beta_lim.shape, np.int64)
    )
    problem, modal = problem_of(system, r)
    phasors = sliding_phasors(system, r)
    for i in np.flatnonzero(r > 0.0):
        moves = np.abs(phasors[i]).sum(axis=1)
        moves = np.where(np.isfinite(moves), moves, 1.0)
        for m in range(mu.size):
            limit = float(limits.beta_lim[m, i])
            if np.isnan(limits.begins[m, i, 0]) or limits.begins[m, i, 0] > 0.0:
                still = (moves <= _STILL * moves.max(initial=0.0)).any()
                found.kind[m, i] = regimes.UNLOADED if still else regimes.NO_LIMIT
                found.contact[m, i] = np.argmin(moves) + 1 if still else 0
            elif np.isfinite(limit):
                found.kind[m, i] = _kind(system, problem, modal, int(i), limit, float(mu[m]))
                found.contact[m, i] = _stopping(system, problem, modal, int(i), limit, float(mu[m]))
    return found


def _kind(
    system: System, problem: Problem, modal: ModalSystem, i: int, limit: float, mu: float
) -> int:  # fmt: skip
    """Kind of the limit at r[i]; the motion without stops is the same for all mu."""
    beta = limit * (1.0 - _BELOW)
    try:
        steps = cell_steps(system, problem, modal, i, beta, 1.0, Solver(cycles=100))
    except NoSteadyState:
        return regimes.NO_LIMIT
    kinetic, static = friction_lines(system, np.array([mu]))
    own = np.array([beta, 1.0])
    kinetic, static = kinetic @ own, static[0] @ own
    ratio = static / np.where(kinetic > 0.0, kinetic, 1.0) * (kinetic > 0.0)
    if 1.0 - (ratio * steps.counts[NEAREST_STOP]).max() <= _NO_MARGIN:
        return regimes.TURN
    return regimes.COINCIDENCE if _turns_coincide(steps) else regimes.INSIDE


def _stopping(system: System, problem: Problem, modal: ModalSystem, i: int, limit: float, mu: float) -> int:
    """The contact that stops most at r[i] just above a limit, counted from 1; 0 if none was found to."""
    try:
        steps = cell_steps(system, problem, modal, i, limit * (1.0 + _ABOVE), mu, Solver(cycles=100))
    except NoSteadyState:
        return 0
    stops = steps.counts[STOPS]
    return int(np.argmax(stops)) + 1 if stops.any() else 0


def _turns_coincide(steps: Steps) -> bool:
    """Whether two contacts that act on each other turn together, or half a period apart."""
    k, j = np.nonzero(steps.senses != np.roll(steps.senses, 1, axis=0))
    tau = steps.begins[k]
    mobility = steps.problem.chi @ steps.problem.chi.T
    apart = np.abs(np.mod(tau[:, np.newaxis] - tau + 0.5 * np.pi, np.pi) - 0.5 * np.pi)
    acts = np.abs(mobility[j[:, np.newaxis], j]) > _STILL * np.abs(mobility).max()
    others = acts & (j[:, np.newaxis] != j)
    return bool((others & (apart <= _TOGETHER)).any())
