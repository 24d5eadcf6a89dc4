"""The interface of a kind of motion: what the driver asks of it.

A kind of motion is two named tuples, of a system over a map and of the system at one frequency, and a body
for each of the functions here (`by_class`).  Every slide is followed as an upward one: a motion that goes
back is mirrored.  Where a motion is, a `Moment` says, together with arrays of the kind's own that these
functions move along with it.

The fields of a kind of motion that the driver reads: `h`, the scan step in tau; `r`; `v_abs`, the response
function of the contact; `marginal`, whether continuous motions are a continuum; `memory`; `load`, the unit of
its forces and displacements; `near_return`, how close a return is worth looking for an orbit; and `no_table`,
no table of phases.
"""

from ..compiler import by_class
from . import many_masses, one_mass
from .many_masses import ManyMasses, ManyMassSystem
from .one_mass import OneMass, OneMassSystem


def _both(name: str) -> tuple:
    return (OneMass, getattr(one_mass, name)), (ManyMasses, getattr(many_masses, name))


def _of_systems(name: str) -> tuple:
    return (OneMassSystem, getattr(one_mass, name)), (ManyMassSystem, getattr(many_masses, name))


@by_class(*_of_systems("at_frequency"))
def at_frequency(system, i):
    """The motion of a system at its i-th frequency, r > 0."""


@by_class(*_of_systems("contact_at"))
def contact_at(system, m, i, beta, mu):
    """The `Contact` of a cell: the m-th mu, the i-th frequency, and beta."""


@by_class(*_both("start"))
def start(motion, system, i, contact, moving):
    """The moment from which a motion starts, at rest or moving."""


@by_class(*_both("slide_to_turn"))
def slide_to_turn(motion, contact, at, allowed):
    """(steps, moment): a slide to where it ends; NO_END where not within `allowed` scan steps."""


@by_class(*_both("after_turn"))
def after_turn(motion, contact, at, allowed):
    """(event, moment, wait): what follows a slide, see `events`, the next anchor, and the time in between.

    NO_RELEASE: a stop that is not known to end within `allowed` tau.  Where it sticks, the moment stays.
    """


@by_class(*_both("lasting_vibration"))
def lasting_vibration(motion):
    """Whether something vibrates in a stop for good: then the steady state depends on the start for good."""


@by_class(*_both("stop_free"))
def stop_free(motion, contact):
    """(amplitude, phase, radius) of the continuous orbit; within the radius no motion can stop."""


@by_class(*_both("off_continuous"))
def off_continuous(motion, contact, amplitude, phase, at):
    """(distance, size): energy norms, of an anchor's distance from the continuous orbit and of the motion."""


@by_class(*_both("note_state"))
def note_state(motion, at, column):
    """Write the state at an anchor into the memory."""


@by_class(*_both("size_now"))
def size_now(motion, at):
    """The size of the motion at an anchor."""


@by_class(*_both("return_distance"))
def return_distance(motion, now, then, size):
    """How far apart two remembered anchors are, relative to the motion; infinite if too far for a return."""


@by_class(*_both("creeps"))
def creeps(motion, contact, events):
    """(whether, z): whether the motion creeps to where it sticks for good but never gets there, and where."""


@by_class(*_both("seek"))
def seek(motion, contact, at, event, sign, events, near, tries, limits):
    """The periodic `Orbit` that a motion approaches, by Newton's method; then the motion is at its anchor.

    at, event, sign : the last of the `events` anchors
    near : its nearest return, lag 0 if there was none
    tries : how many failed before
    """


@by_class(*_both("forget_neighbour"))
def forget_neighbour(motion):
    """The next cell is no neighbour of the last one."""


@by_class(*_both("seek_nearby"))
def seek_nearby(motion, contact, limits):
    """The periodic `Orbit`, the only one, from the one found last, or from where motions begin to stop."""


@by_class(*_both("keep_state"))
def keep_state(motion, slot):
    """Keep the state in one of SLOTS places, to come back to; its moment is the caller's to keep."""


@by_class(*_both("bring_back"))
def bring_back(motion, slot):
    """Set the state to the one that was kept."""


@by_class(*_both("distance_from"))
def distance_from(motion, slot, then, at, stopped):
    """How far the motion, at a moment, is from where it was when its state was kept, at the moment `then`.

    Relative to the motion; `stopped` : both are the ends of stops.
    """


@by_class(*_both("back_at"))
def back_at(motion, slot, then, at):
    """Whether the motion, at a moment, is where it was when its state was kept, at the moment `then`."""


@by_class(*_both("on_continuous"))
def on_continuous(motion, contact):
    """Put the motion on the continuous orbit, where it turns upwards; the moment there."""


@by_class(*_both("put_slide"))
def put_slide(motion, at, row):
    """Write the start of a slide into a row of the table of phases."""


@by_class(*_both("put_stop"))
def put_stop(motion, at, row):
    """Write the start of a stop, at the end of a slide."""
