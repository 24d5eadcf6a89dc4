"""What ends the motion without stops at beta_lim (theory.md 11)."""

from typing import NamedTuple

import numpy as np

from .. import regimes
from ..model.system import System
from .boundaries import Boundaries
from .held import sliding_phasors

#: Motion without friction, relative to the largest in any contact, that is none.
_STILL = 1e-12


class Limits(NamedTuple):
    """What ends the first interval without stops, (n_mu, n_r)."""

    kind: np.ndarray  # codes `regimes.LIMIT_KINDS`
    contact: np.ndarray  # the contact that stops, counted from 1; 0: there is no limit, or none was found


def find_limits(system: System, r: np.ndarray, limits: Boundaries) -> Limits:
    """Find what ends the first interval without stops, and which contact stops.

    Where there is none, a contact that does not move without friction is the reason, if there is one.
    """
    moves = np.abs(sliding_phasors(system, r)).sum(axis=2)  # (n_r, N)
    moves = np.where(np.isfinite(moves), moves, 1.0)
    still = (moves <= _STILL * moves.max(axis=1, keepdims=True)).any(axis=1) & (r > 0.0)
    unloaded = still & ~(limits.begins[:, :, 0] == 0.0)
    return Limits(
        np.where(unloaded, np.int8(regimes.UNLOADED), limits.limit_kind),
        np.where(unloaded, np.argmin(moves, axis=1) + 1, limits.limiting_contact),
    )
