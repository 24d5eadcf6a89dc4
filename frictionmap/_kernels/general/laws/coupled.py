"""Elastic contacts that are coupled beside the modes: a force in one displaces the others at once.

    F f = g - y,   f_E' = F_EE^-1 (g_E' - F_ES f_S'),   y_S' = g_S' - F_SE f_E' - F_SS f_S'

F is their flexibility, g the displacements without their forces, y those of the sliders; contacts E act as
springs and contacts S slip.  The displacement z in a contact is here that of the other end of a spring of the
stiffness 1/F_jj, z_j = g_j - sum of F_ji f_i over i != j: all else is as of contacts that are not coupled.

Where a contact begins to slip the rates of the other forces jump, and those of other sliders: each contact at
its limit slips on, or its force falls.  That is unique, because F is positive definite.
"""

from ...compiler import inner_kernel, kernel, late_kernel
from ...compiler.vectors import LANES, load, store
from ..cholesky import factor, solve_factored
from ..crossings import slope_at
from ..problem import WIDTH, F, force_row, normal_row
from .coulomb import slip_rate
from .elastic import limit_at
from .kinds import is_spring

#: Share of a rate, over the size of its terms, that rounding errors may be.
_TIE = 1e-12

#: Rounds in which all contacts that are wrong are flipped, and then the last one of them alone, which ends
#: for any positive definite F.
_BLOCKS, _MOST_PIVOTS = 10, 2000

#: Rows of the scratch: the side of its range that a contact is at, or 0; rate of its force there; rate of the
#: displacement without forces, and the size of its terms; rates of the force and of the slider; 1 where these
#: are not those of its pattern; largest force; two rows that are free.
SIDE, ALONG, FREE, SIZE, FORCE, SLIDE, _WRONG, LIMIT, OWN, LEAP = range(10)


@inner_kernel
def is_coupled(problem):
    """Whether forces in contacts displace others beside the modes; all contacts are elastic then."""
    return problem.coupling.flexibility.shape[0] > 0


@late_kernel(bool)
def factor_springs(problem, motion):
    """List the contacts that act as springs, and factor their flexibility."""
    contacts = motion.sense.size
    count = 0
    for j in range(contacts):
        if is_spring(problem, motion, j):
            motion.springs[count] = j
            count += 1
    motion.springs[contacts] = count
    return factor(problem.coupling.flexibility, motion.springs, count, motion.grip)


@inner_kernel
def solve_springs(motion, right):
    """Solve for the forces of the springs; `right` holds their displacements and then the forces."""
    solve_factored(motion.grip, motion.springs[motion.sense.size], right)


@inner_kernel
def couple_forces(problem, motion, k, first):
    """Replace term k of the forces of springs, each as if it were alone, by those of all."""
    contacts = motion.sense.size
    flexibility, series = problem.coupling.flexibility, motion.series
    forces, right = first + 2 * contacts, motion.grip[contacts]
    for a in range(motion.springs[contacts]):
        j = motion.springs[a]
        right[a] = flexibility[j, j] * series[forces + j, k]
        for i in range(contacts):
            if motion.sense[i] != 0:
                right[a] -= flexibility[j, i] * series[forces + i, k]
    solve_springs(motion, right)
    for a in range(motion.springs[contacts]):
        series[forces + motion.springs[a], k] = right[a]


@inner_kernel
def displace_by_others(problem, motion, j, first):
    """Add what the forces in the other contacts displace to the series of z of contact j."""
    contacts, series = motion.sense.size, motion.series
    z = (first + j) * WIDTH
    for i in range(contacts):
        if i != j:
            force, share = (first + 2 * contacts + i) * WIDTH, problem.coupling.flexibility[j, i]
            for k in range(0, WIDTH, LANES):
                store(load(series, z + k) - load(series, force + k) * share, series, z + k)


@kernel
def _fill_free(problem, friction, motion, x, box):
    """Fill the rates at x of the present step that are the same in all patterns."""
    contacts, series = motion.sense.size, motion.series
    flexibility = problem.coupling.flexibility
    for j in range(contacts):
        box[FORCE, j] = slope_at(series, force_row(problem, j), x)
    for j in range(contacts):
        box[SIDE, j] = motion.sense[j]
        box[ALONG, j] = friction.kinetic[j] * slope_at(series, normal_row(problem, j), x)
        box[LIMIT, j] = limit_at(problem, friction, motion, x, j)
        slide = slip_rate(problem, friction, motion, x, j) if motion.sense[j] != 0 else 0.0
        box[FREE, j], box[SIZE, j] = slide, abs(slide)
        for i in range(contacts):
            part = flexibility[j, i] * box[FORCE, i]
            box[FREE, j] += part
            box[SIZE, j] += abs(part)


@kernel
def _rates_of_choice(problem, motion, box):
    """Fill the rates of forces and sliders for the pattern in the motion."""
    contacts = motion.sense.size
    flexibility, right = problem.coupling.flexibility, motion.grip[contacts]
    if not factor_springs(problem, motion):
        return False
    for j in range(contacts):
        if motion.sense[j] != 0:
            box[FORCE, j] = motion.sense[j] * box[ALONG, j]
    for a in range(motion.springs[contacts]):
        j = motion.springs[a]
        right[a] = box[FREE, j]
        for i in range(contacts):
            if motion.sense[i] != 0:
                right[a] -= flexibility[j, i] * box[FORCE, i]
    solve_springs(motion, right)
    for a in range(motion.springs[contacts]):
        box[FORCE, motion.springs[a]] = right[a]
    for j in range(contacts):
        box[SLIDE, j] = 0.0
        if motion.sense[j] != 0:
            box[SLIDE, j] = box[FREE, j]
            for i in range(contacts):
                box[SLIDE, j] -= flexibility[j, i] * box[FORCE, i]
    return True


@inner_kernel
def _fall(box, j):
    """How fast the force of a contact at its limit falls below it."""
    return box[ALONG, j] - box[SIDE, j] * box[FORCE, j]


@inner_kernel
def _rounding(problem, box, j):
    """Rate of the force of a contact that may be rounding error."""
    return _TIE * box[SIZE, j] * problem.coupling.stiffest[j]


@kernel
def _is_wrong(problem, motion, box, j):
    """Whether a contact at its limit slips against its sense, or is held and exceeds its limit."""
    if box[SIDE, j] == 0.0:
        return False
    if motion.sense[j] != 0:
        return motion.sense[j] * box[SLIDE, j] < -_TIE * box[SIZE, j]
    return _fall(box, j) < -_rounding(problem, box, j)


@kernel
def _flip_wrong(problem, motion, box, alone):
    """Flip the contacts that are wrong, or the last one alone; how many there were."""
    count, last = 0, -1
    for j in range(motion.sense.size):
        box[_WRONG, j] = 1.0 if _is_wrong(problem, motion, box, j) else 0.0
        if box[_WRONG, j] != 0.0:
            count, last = count + 1, j
    for j in range(motion.sense.size):
        if box[_WRONG, j] != 0.0 and (j == last or not alone):
            motion.sense[j] = 0 if motion.sense[j] != 0 else int(box[SIDE, j])
    return count


@kernel
def find_pattern(problem, motion, box):
    """Flip contacts at their limits until the rates are those of the pattern; False if none was found.

    box : scratch, with SIDE, ALONG, FREE and SIZE; FORCE and SLIDE are filled
    """
    for pivot in range(_MOST_PIVOTS):
        if not _rates_of_choice(problem, motion, box):
            return False
        if _flip_wrong(problem, motion, box, pivot >= _BLOCKS) == 0:
            return True
    return False


@kernel
def begin_phases(problem, motion, contact, box):
    """Set the forces of the contacts at their limits, and the leading zeros of the watched quantities.

    contact : that whose force has reached its limit; -1: none
    """
    for j in range(motion.sense.size):
        side = int(box[SIDE, j])
        if side == 0:
            continue
        motion.state[F, j] = side * box[LIMIT, j]
        if motion.sense[j] == 0:
            motion.fresh[j] = side if _fall(box, j) > _rounding(problem, box, j) else 2 * side
        elif abs(box[SLIDE, j]) > _TIE * box[SIZE, j]:
            motion.fresh[j] = 0
        elif j == contact:
            motion.fresh[j] = max(0, side * motion.fresh[j] - 1)  # the force's zeros less one of y'


@late_kernel(bool)
def begin_slip(problem, friction, motion, x, contact, side, box, jumps):
    """Begin the slip of a contact whose force is at its limit, and what that changes in other contacts there.

    Parameters
    ----------
    problem, friction, motion : Problem, Friction, Motion; the state is that of the event
    x, contact, side : the event, see `coulomb.first_event`
    box : (BOX_ROWS, N) scratch
    jumps : (N,) filled with the jumps of the rates of the forces

    Returns
    -------
    bool : False if no pattern was found
    """
    _fill_free(problem, friction, motion, x, box)
    for j in range(motion.sense.size):
        jumps[j] = -box[FORCE, j]
    motion.sense[contact] = side
    box[SIDE, contact] = side
    if not find_pattern(problem, motion, box):
        return False
    for j in range(motion.sense.size):
        jumps[j] += box[FORCE, j]
    begin_phases(problem, motion, contact, box)
    return True
