"""Which law a contact has, and the linear system of its present phase."""

from ...compiler import inner_kernel

RIGID, ELASTIC = 0, 1


@inner_kernel
def kind_of(problem, j):
    """The law of a contact: RIGID or ELASTIC."""
    return RIGID if problem.spring[j] == 0.0 else ELASTIC


@inner_kernel
def has_constraint(problem, j):
    """Whether a constraint holds a contact where it does not slide: forces jump where its slides end."""
    return kind_of(problem, j) == RIGID


@inner_kernel
def is_constrained(problem, motion, j):
    """Whether a constraint holds a contact now."""
    return motion.sense[j] == 0 and has_constraint(problem, j) and not motion.idle[j]


@inner_kernel
def is_spare(problem, motion, j):
    """Whether other contacts of a loop keep a rigid one at rest: its force is constant, see `loops`."""
    return motion.idle[j] and has_constraint(problem, j)


@inner_kernel
def has_force(problem, j):
    """Whether the force of a contact is a coordinate of the state; in a slide it is the friction."""
    return kind_of(problem, j) == ELASTIC


@inner_kernel
def holding_stiffness(problem, j):
    """Stiffness of a contact that has a force, where it does not slide."""
    return problem.spring[j]


@inner_kernel
def keeps_force(problem, motion, j):
    """Whether a contact has a force now that changes from its present value only by its stiffness."""
    return motion.sense[j] == 0 and has_force(problem, j)


@inner_kernel
def is_spring(problem, motion, j):
    """Whether a contact acts now as a spring; between ends at rest its force is constant."""
    return keeps_force(problem, motion, j) and not motion.idle[j]


@inner_kernel
def state_size(problem):
    """Number of coordinates of a state: modes, their velocities, and forces of contacts if there are any."""
    contacts, modes = problem.chi.shape
    for j in range(contacts):
        if has_force(problem, j):
            return 2 * modes + contacts
    return 2 * modes
