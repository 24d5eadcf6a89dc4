"""First harmonics of steady states at a list of points, each with its own frequency and friction ratio."""

import numpy as np

from ..model.system import System
from ..single.points import States
from ..solvers.choose import engine_of


def steady_states(system: System, r: np.ndarray, beta: np.ndarray, mu: float) -> list[States]:
    """Find the possible steady states at every point; repeated points are computed once.

    For mu = 1 there is one steady state (theory.md 6), for an elastic contact too.  For mu > 1 three columns
    are returned, which may hold the same motion: the continuous motion by its closed form, where beta <=
    beta_lim, and the motions reached from rest and from a large sliding motion.

    Parameters
    ----------
    system : System
    r : (k,) > 0
    beta : (k,) >= 0
    mu : >= 1; 1 for an elastic contact
    """
    distinct, index = np.unique(r + 1j * beta, return_inverse=True)
    found = engine_of(system).states(distinct.real, distinct.imag, mu)
    return [States(states.phasors[index], states.regime[index]) for states in found]
