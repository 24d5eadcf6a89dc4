"""Partial sticking for mu = 1: the friction from which one contact sticks while the others slide.

A contact with mu = 1 and constant normal load sticks permanently iff its friction is at least half the range
of the force that holds it in the steady state of the others (theory.md 11).
"""

import numpy as np

from .._kernels.compiler.lending import lent, made
from .._kernels.general.partial import fill_holding_force
from .._kernels.general.series import Friction
from .._kernels.general.steady import make_workspace
from ..model.system import System
from .boundaries import rest_states
from .problem import general_of, problem_of

_CYCLES, _TOLERANCE = 500.0, 1e-12


def has_limits(system: System) -> bool:
    """Whether partial sticking has such a limit: no belt, constant normal loads, walls at rest at tau = 0."""
    general = general_of(system)
    still = all(not group.first.belt and not group.first.nu for group in general.groups)
    return still and all(value.imag == 0.0 for value in general.base.values())


def holding_force(
    system: System, r: float, contact: int, lines: np.ndarray, values: np.ndarray
) -> np.ndarray:
    """Half the range of the force that holds a contact, over P.

    Parameters
    ----------
    system : System
        For which `has_limits` holds.
    r : float
        Frequency ratio, > 0.
    contact : int
        The contact, counted from 0.
    lines : array, shape (N, 2)
        Friction of contact j: lines[j, 0] value + lines[j, 1].
    values : array, shape (n,)

    Returns
    -------
    array, shape (n,); NaN where no steady state was found
    """
    problem, modal = problem_of(system, np.array([r]))
    state = rest_states(system, modal, problem.r)[0]
    out = np.full(values.size, np.nan)
    workspace = made(make_workspace, problem, np.empty((0, problem.squares.size)), 0)
    friction = Friction(np.empty(len(lines)), np.empty(len(lines)))
    fill_holding_force(
        lent(problem), 0, contact, lines, values, state, (_CYCLES, _TOLERANCE), lent(workspace),
        lent(friction), out,
    )  # fmt: skip
    return out
