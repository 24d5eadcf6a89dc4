"""The engine's questions to a contact, answered by its law."""

from ....regimes import PERMANENT_STICKING
from ...compiler import kernel
from ..counts import MOVED
from . import elastic, rigid
from .kinds import ELASTIC, RIGID, has_force, kind_of


@kernel
def force_weight(problem, row, j):
    """Weight of a change of the force of a contact beside changes of the modes; 0: it is no coordinate."""
    return elastic.force_weight(problem, row, j) if has_force(problem, j) else 0.0


@kernel
def jumps(problem, friction, j, side):
    """Whether forces jump at an event of a contact, see `coulomb.first_event`."""
    return kind_of(problem, j) == RIGID and rigid.jumps(friction, j, side)


@kernel
def change_phase(problem, friction, motion, x, j, side):
    """Change the phase of a contact at an event without a jump, and those of others that change with it.

    Parameters
    ----------
    problem, friction, motion : Problem, Friction, Motion; the state is that of the event
    x, j, side : the event: its place in the step, the contact, see `coulomb.first_event`
    """
    if kind_of(problem, j) == ELASTIC:
        elastic.change_phase(problem, friction, motion, x, j, side)
    else:
        rigid.change_phase(problem, friction, motion, x, j, side)


@kernel
def count(problem, counts, j, old, new, share):
    """Count a change of the sense of a contact; `share`: see `rigid.count`."""
    if kind_of(problem, j) == ELASTIC:
        elastic.count(counts, j, new)
    else:
        rigid.count(counts, j, old, new, share)


@kernel
def regime_of(problem, counts, j):
    """Regime of a contact over the steady state."""
    if counts[MOVED, j] == 0.0:
        return PERMANENT_STICKING
    if kind_of(problem, j) == ELASTIC:
        return elastic.moving_regime(problem, counts, j)
    return rigid.moving_regime(problem, counts, j)


@kernel
def has_tables(problem, j):
    """Whether tables of parts of the motion hold for a contact, see `glide`: a belt would load a spring."""
    return kind_of(problem, j) == RIGID or problem.belt[j] == 0.0


@kernel
def moves_one_way(problem, j):
    """Whether the displacement in a contact has its extremes at the ends of phases."""
    return kind_of(problem, j) == RIGID and problem.belt[j] == 0.0
