"""Codes of the variables `regime`, `origin` and `status`, and the bits of `also_reachable`.

Datasets and files hold these numbers, so a regime is compared with a constant, not with a name.  Each
constant is the name of its code in capitals.  Bit 1 << regime of `also_reachable` is set where a start ends
in that regime.

Examples
--------
>>> import frictionmap as fm
>>> ds = fm.sweep(fm.System(), r=[0.3], beta=[0.01, 0.5, 1.0])
>>> (ds.regime == fm.regimes.CONTINUOUS).values.ravel().tolist()
[True, False, False]
>>> [fm.regimes.regime_name(code) for code in ds.regime.values.ravel()]
['continuous', 'stick_slip', 'permanent_sticking']
"""

# Numbers and names stand in files: they may grow, not change.  Meanings and advice may change.

from typing import NamedTuple

from .errors import InputError

__all__ = [
    "BELT_REGIMES",
    "BELT_STATUSES",
    "BREAK_POINTS",
    "CLOSED_FORM",
    "COINCIDENCE",
    "CONTINUOUS",
    "CYCLE_WITHOUT_STOPS",
    "DIVERGENCE",
    "FLUTTER",
    "INSIDE",
    "INTEGRATED",
    "IRREGULAR",
    "LIMIT_KINDS",
    "MARGINAL",
    "NOT_COMPUTED",
    "NOT_PERIODIC",
    "NOT_REACHED",
    "NO_LIMIT",
    "NO_LOAD_REGIMES",
    "ONE_WAY_SLIDING",
    "ORIGINS",
    "PERIODIC_ORBIT",
    "PERMANENT_STICKING",
    "QUASI_STATIC",
    "REACHABLE",
    "REACHABLE_ON_BELTS",
    "REGIMES",
    "RESOLVED",
    "SLIDING_LIMIT_KINDS",
    "STATUSES",
    "STEADY_SLIDING",
    "STICK_SLIP",
    "STICK_SLIP_CYCLE",
    "TOO_MANY_EVENTS",
    "TURN",
    "UNLOADED",
    "UNRESOLVED",
    "WITHOUT_PERIOD",
    "regime_name",
    "status_meaning",
]


def __dir__() -> list[str]:
    return sorted(__all__)


UNRESOLVED = -1
PERMANENT_STICKING = 0
STICK_SLIP = 1
CONTINUOUS = 2
ONE_WAY_SLIDING = 3
STEADY_SLIDING = 4
STICK_SLIP_CYCLE = 5
CYCLE_WITHOUT_STOPS = 6

NO_LIMIT = 0
TURN = 1
INSIDE = 2
COINCIDENCE = 3
UNLOADED = 4

FLUTTER = 1
DIVERGENCE = 2

CLOSED_FORM = 0
INTEGRATED = 1
PERIODIC_ORBIT = 2

RESOLVED = 0
NOT_REACHED = 1
TOO_MANY_EVENTS = 2
MARGINAL = 3
QUASI_STATIC = 4
NOT_COMPUTED = 5
NOT_PERIODIC = 6
IRREGULAR = 7
BREAK_POINTS = 8

#: Statuses of stick-slip that does not repeat; files of version 0.2 have the first.
WITHOUT_PERIOD = (NOT_PERIODIC, IRREGULAR)


class Code(NamedTuple):
    """A value of a coded variable."""

    value: int
    name: str  # as in the file's flag_meanings
    meaning: str  # for people; for a status: the cause and what to do about it
    advice: str = ""  # of a status, in a few words: the summary of a map has a line of it


REGIMES = (
    Code(UNRESOLVED, "unresolved", "no steady state found; see status"),
    Code(PERMANENT_STICKING, "permanent_sticking", "the contact never slides"),
    Code(STICK_SLIP, "stick_slip", "the contact slides and stops"),
    Code(CONTINUOUS, "continuous", "the contact slides without stopping"),
)

#: Regimes of systems with a belt.
BELT_REGIMES = (
    *REGIMES,
    Code(ONE_WAY_SLIDING, "one_way_sliding", "the contact slides against its belt without turning"),
)

#: Regimes of systems with a belt and no load.
NO_LOAD_REGIMES = (
    REGIMES[0],
    Code(STEADY_SLIDING, "steady_sliding", "the belt slides under the mass, which does not vibrate"),
    Code(STICK_SLIP_CYCLE, "stick_slip_cycle", "the belt carries the mass along, and it slips back"),
    Code(CYCLE_WITHOUT_STOPS, "cycle_without_stops", "the mass vibrates and never sticks to the belt"),
)

#: What ends the motion without stops at beta_lim.
LIMIT_KINDS = (
    Code(NO_LIMIT, "no_limit", "no friction ratio ends it, or none was found"),
    Code(TURN, "turn", "a turn of a contact becomes a stop"),
    Code(INSIDE, "inside", "between two turns a contact comes to a stop"),
    Code(COINCIDENCE, "coincidence", "two contacts that act on each other turn at the same time"),
    Code(UNLOADED, "unloaded", "a contact that does not move without friction sticks for any friction"),
)

#: What makes steady sliding on a belt unstable; `NO_LIMIT` if nothing does.
SLIDING_LIMIT_KINDS = (
    Code(NO_LIMIT, "no_limit", "no friction makes it unstable"),
    Code(FLUTTER, "flutter", "two modes couple, or one is driven, and vibrations grow"),
    Code(DIVERGENCE, "divergence", "the contact locks itself: the friction pulls it into the belt"),
)

#: Bits of `also_reachable`.
REACHABLE = (
    Code(1, "permanent_sticking", "the contact may stick permanently"),
    Code(2, "stick_slip", "the contact may slide and stop"),
    Code(4, "continuous", "the contact may slide without stopping"),
)

#: A further bit of `also_reachable`, of contacts on belts.
REACHABLE_ON_BELTS = (*REACHABLE, Code(8, "one_way_sliding", "the contact may slide one way"))

ORIGINS = (
    Code(CLOSED_FORM, "closed_form", "decided by a closed form"),
    Code(INTEGRATED, "integrated", "integrated from the initial state to the steady state"),
    Code(PERIODIC_ORBIT, "periodic_orbit", "integrated for some cycles, then solved as a periodic orbit"),
)

STATUSES = (
    Code(RESOLVED, "resolved", "the steady state was found"),
    Code(
        NOT_REACHED,
        "not_reached",
        "no steady state within `cycles` excitation periods: raise solver.cycles",
        "raise solver.cycles",
    ),
    Code(
        TOO_MANY_EVENTS,
        "too_many_events",
        "more slides and stops than the solver follows, as the motion chatters: change r or beta slightly",
        "the motion chatters; change r or beta slightly",
    ),
    Code(
        MARGINAL,
        "marginal",
        "no damping, and r is an even sub-multiple (1/(2n)) of a natural frequency or of the sum or "
        "difference of two, or a frequency of the held structure that the load does not excite: a continuum "
        "of steady states exists, and the result depends on the initial state; where the regime is "
        "continuous, the amplitude is that of the symmetric motion; add a little damping",
        "undamped: the result depends on the initial state; add some damping",
    ),
    Code(
        QUASI_STATIC,
        "quasi_static",
        "r = 0: the regime is known, but the number of stops has no limit for r -> 0; use r > 0",
        "at r = 0 there is a regime but no number of stops; use r > 0",
    ),
    Code(
        NOT_COMPUTED,
        "not_computed",
        "the run ended before this cell: repeat the command to resume",
        "repeat the command to resume",
    ),
    Code(
        NOT_PERIODIC,
        "not_periodic",
        "(version 0.2 only) stick-slip that did not repeat within 8 periods: stops, amplitude and stuck "
        "fraction are averages over the last 100 periods; compute the map again for periods up to 256",
        "averages over 100 periods; compute the map again for periods up to 256",
    ),
    Code(
        IRREGULAR,
        "irregular",
        "stick-slip that did not return within the `cycles` followed, nor within 256 periods: stops, "
        "amplitude and stuck fraction are those of the last two thirds of these cycles; to follow it longer, "
        "raise solver.cycles",
        "averages over the cycles followed; raise solver.cycles to follow it longer",
    ),
)


#: Statuses of belts without a load: how certain the motions of a cell are.
BELT_STATUSES = (
    Code(RESOLVED, "resolved", "all motions were found"),
    Code(
        NOT_REACHED, "not_reached",
        "of one mass: it is not proved that there are no further cycles without stops; of a structure: no "
        "motion was reached",
        "further motions are possible",
    ),
    Code(
        MARGINAL, "marginal", "nothing damps or drives small vibrations",
        "undamped: every small vibration lasts; add some damping",
    ),
    Code(
        TOO_MANY_EVENTS, "too_many_events",
        "the motion chatters, or contacts do not determine their forces",
        "the motion chatters; change the belt speed or beta slightly",
    ),
    Code(
        IRREGULAR, "irregular",
        "a motion that does not repeat within 4000 maxima: extremes and stuck_fraction are those of the last "
        "ones",
        "no period; extremes and stuck_fraction are those of the last cycles followed",
    ),
    Code(
        BREAK_POINTS, "break_points",
        "whether steady sliding is stable differs between the formula of the law, which `growth` is of, and "
        "its break points, by which motions are followed: make law.error smaller",
        "near the limit of stability the break points of the law decide; make law.error smaller",
    ),
)  # fmt: skip


def _code(codes: tuple[Code, ...], value: int, what: str) -> Code:
    """The code with this value."""
    for code in codes:
        if code.value == value:
            return code
    raise InputError(f"unknown {what} {value!r}; valid: {', '.join(str(code.value) for code in codes)}")


def regime_name(regime: int) -> str:
    """Name of a regime code, such as "stick_slip" of 1.

    Examples
    --------
    >>> import frictionmap as fm
    >>> fm.regimes.regime_name(fm.regimes.STICK_SLIP)
    'stick_slip'
    """
    return _code((*BELT_REGIMES, *NO_LOAD_REGIMES[1:]), regime, "regime").name


def status_meaning(status: int) -> str:
    """Cause that a status code stands for, and what to do about it; of belts without a load, if only these
    have it.

    Examples
    --------
    >>> import frictionmap as fm
    >>> fm.regimes.status_meaning(fm.regimes.NOT_REACHED)
    'no steady state within `cycles` excitation periods: raise solver.cycles'
    """
    further = tuple(code for code in BELT_STATUSES if code.value not in {one.value for one in STATUSES})
    return _code((*STATUSES, *further), status, "status").meaning
