"""Interface of a kind of motion: the operations that the solver calls.

A kind of motion consists of two named tuples, one for a system over a whole map and one for the system at one
frequency, and of one implementation of each function below (`by_class`).  Every slide is followed upwards: a
motion that reverses is mirrored.  The state of a motion is a `ContactState` and arrays that belong to the
kind of motion; the functions below update these arrays.

The solver reads these fields: `h`, the scan step in tau; `r`; `v_abs`, the response function of the contact;
`marginal`, whether the continuous motions form a continuum; `memory`; `load`, the unit of forces and
displacements; `recurrence_threshold`, the recurrence distance below which an orbit is sought; `scratch`,
whose `left` holds the number of scan steps that may still be taken; and `no_table`, an empty segment table.
"""

from ..compiler import by_class
from . import many_masses, one_mass
from .many_masses import ManyMasses, ManyMassSystem
from .one_mass import OneMass, OneMassSystem


def _both_motions(name: str) -> tuple:
    return (OneMass, getattr(one_mass, name)), (ManyMasses, getattr(many_masses, name))


def _both_systems(name: str) -> tuple:
    return (OneMassSystem, getattr(one_mass, name)), (ManyMassSystem, getattr(many_masses, name))


@by_class(*_both_systems("at_frequency"))
def at_frequency(system, i):
    """Build the motion of a system at its i-th frequency, r > 0."""


@by_class(*_both_systems("contact_at"))
def contact_at(system, m, i, beta, mu):
    """Build the `Contact` of a cell: m-th mu, i-th frequency, friction ratio beta."""


@by_class(*_both_motions("start"))
def start(motion, system, i, contact, moving):
    """Set the motion to its initial state, at rest or moving, and return the contact state there."""


@by_class(*_both_motions("slide_to_turn"))
def slide_to_turn(motion, contact, contact_state, allowed):
    """Follow a slide to its end.

    Returns
    -------
    (steps, contact_state) : scan steps taken, NO_END where the slide takes more than `allowed` steps
    """


@by_class(*_both_motions("after_turn"))
def after_turn(motion, contact, contact_state, allowed):
    """Determine what follows a slide.

    Returns
    -------
    (event, contact_state, wait) : code of `one_mass.events`, or NO_RELEASE for a stop that may end after more
        than `allowed` tau; the next anchor, unchanged where the contact sticks; the time until then
    """


@by_class(*_both_motions("lasting_vibration"))
def lasting_vibration(motion):
    """Whether an undamped vibration persists in a stop, so that the steady state depends on the initial
    state.
    """


@by_class(*_both_motions("stop_free"))
def stop_free(motion, contact):
    """Return (amplitude, phase, radius) of the continuous orbit; no motion within the radius can stop."""


@by_class(*_both_motions("distance_from_continuous"))
def distance_from_continuous(motion, contact, amplitude, phase, contact_state):
    """Return (distance, size): energy norms of the distance from the continuous orbit at an anchor, and of
    the motion.
    """


@by_class(*_both_motions("record_state"))
def record_state(motion, contact_state, column):
    """Record the state at an anchor in a column of the memory."""


@by_class(*_both_motions("motion_size"))
def motion_size(motion, contact_state):
    """Size of the motion at an anchor, the unit of its recurrence distances."""


@by_class(*_both_motions("recurrence_distance"))
def recurrence_distance(motion, now, then, size, most):
    """Distance between two recorded anchors relative to the motion, or a lower bound on it that is above
    `most`; infinite if it is no recurrence.
    """


@by_class(*_both_motions("creeps"))
def creeps(motion, contact, events):
    """Whether the motion creeps towards a position of permanent sticking that it never reaches, and that
    position z.
    """


@by_class(*_both_motions("seek"))
def seek(motion, contact, contact_state, event, sign, events, recurrence, failures, limits):
    """Find the periodic `Orbit` that a motion approaches, by Newton's method; on success the motion is at its
    anchor.

    Parameters
    ----------
    motion : a kind of motion; its memory holds the last anchors
    contact : Contact
    contact_state : ContactState at the last anchor
    event : event that ended the slide before it
    sign : -1.0 where the anchor is mirrored, else 1.0
    events : number of anchors so far
    recurrence : Recurrence of the last anchor; lag 0 if there is none
    failures : number of failed attempts so far
    limits : Limits

    Returns
    -------
    Orbit
    """


@by_class(*_both_motions("forget_neighbour"))
def forget_neighbour(motion):
    """Discard the orbit of the previous cell: the next cell is not its neighbour."""


@by_class(*_both_motions("seek_nearby"))
def seek_nearby(motion, contact, limits):
    """Find the unique periodic `Orbit`, starting from the orbit found last or from the onset of stopping."""


@by_class(*_both_motions("save_state"))
def save_state(motion, slot):
    """Save the state in a slot; the caller keeps the contact state."""


@by_class(*_both_motions("restore_state"))
def restore_state(motion, slot):
    """Restore the state from a slot."""


@by_class(*_both_motions("distance_from"))
def distance_from(motion, slot, saved, contact_state, stopped):
    """Distance between the present state and a saved one, relative to the motion.

    Parameters
    ----------
    motion : a kind of motion
    slot : slot of the saved state
    saved, contact_state : ContactState of the saved and of the present state
    stopped : whether both are ends of stops
    """


@by_class(*_both_motions("has_returned"))
def has_returned(motion, slot, saved, contact_state):
    """Whether the present state equals a saved one within rounding; arguments as in `distance_from`."""


@by_class(*_both_motions("on_continuous"))
def on_continuous(motion, contact):
    """Set the motion to the start of the rising half of the continuous orbit; return its contact state."""


@by_class(*_both_motions("put_slide"))
def put_slide(motion, contact_state, row):
    """Write the state at the start of a slide into a row of the segment table."""


@by_class(*_both_motions("put_stop"))
def put_stop(motion, contact_state, row):
    """Write the state at the start of a stop, the end of a slide, into a row of the segment table."""
