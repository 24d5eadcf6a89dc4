"""Boundaries of the regimes over a band of frequencies: their least and largest values."""

from typing import NamedTuple

import numpy as np

from ..errors import InputError
from ..general.certificate import certified_beta, friction_to_rest
from ..general.held import rest_scales, stick_scales
from ..general.loops import loop_stick_scales
from ..general.normal_resting import is_known, resting_friction
from ..model.general import refuse_law, refuse_phases
from ..model.system import System
from ..solvers.choose import engine_of
from .band import Band
from .extremes import Brackets, brackets_of, chosen, joined, refine_maxima
from .grading import FINE, FOLLOWED, graded, no_stop_poles, stick_poles
from .minimum import Points
from .watching import current_watch, look

#: A maximum that falls to less than half within this relative distance is a pole: no damping is so small.
_POLE = 1e-9

#: beta_lim below this share of its largest value is 0: the frequency of a pole without damping is rounded.
_LOST = 4.0 * float(np.finfo(float).eps)

#: A local extremum may be above its sample by this multiple of the step to the lower neighbour: by an eighth
#: if the curve is smooth, by a half at a kink between two lines, by 1.4 at the tip of a square root.
_RISE = 2.0


class Extreme(NamedTuple):
    """The least or largest value of a boundary over a band, and the frequency at which it is."""

    beta: float
    r: float


def stick_samples(system: System, band: Band) -> np.ndarray:
    """Frequencies that show all of a boundary to sticking over a band."""
    return graded(band, stick_poles(system), FINE)


def _fineness(system: System) -> float:
    return FINE if engine_of(system).has_closed_limits else FOLLOWED


def no_stop_samples(system: System, band: Band) -> np.ndarray:
    """Frequencies that show all of beta_lim over a band."""
    return graded(band, no_stop_poles(system, band.low), _fineness(system))


def boundary_samples(system: System, band: Band) -> np.ndarray:
    """Frequencies that show all boundaries of a system over a band."""
    if not has_no_stop_limit(system):
        return stick_samples(system, band)
    poles = np.concatenate((no_stop_poles(system, band.low), stick_poles(system)))
    return graded(band, poles, _fineness(system))


def needed_friction(system: System, r: np.ndarray) -> np.ndarray:
    """Friction with which each contact holds, over P, (n_r, N): half the range of its force."""
    look()
    return engine_of(system).needed_friction(r)


def _scales(system: System, needed: np.ndarray, mu: float | None) -> np.ndarray:
    """Friction ratio at which each contact has the friction it needs, (n_r, N); mu as in `stick_limit`."""
    if mu is None:
        return rest_scales(system.contact_system, friction_to_rest(system, needed))
    return stick_scales(system.contact_system, needed, np.array([mu]))[0]


def is_joint(system: System) -> bool:
    """Whether one friction ratio is that of all contacts: no friction of a single one is known to hold it
    where contacts close a loop, or normal forces move with the structure.
    """
    contacts = system.contact_system
    return bool(contacts.loop) or contacts.has_phases


def _joint(system: System, r: np.ndarray, mu: float | None) -> np.ndarray:
    """The friction ratio of `stick_limit` where it is that of all contacts, (n_r, 1)."""
    look()
    if system.contact_system.loop:
        found = loop_stick_scales(system, r, np.array([1.0 if mu is None else mu]), kinetic=mu is None)[0]
        return found[:, np.newaxis]
    if unknown_stick(system):
        return np.full((r.size, 1), np.nan)
    return resting_friction(system, r, 1.0 if mu is None else mu)[:, np.newaxis]


def unknown_stick(system: System) -> str:
    """What a system has with which `stick_limit` is not known, in words; empty without that."""
    contacts = system.contact_system
    engine_of(system)  # it refuses free structures
    if contacts.loop and any(n % 2 == 0 for n in contacts.orders):
        return "even harmonics and contacts that close a loop"
    if contacts.has_phases and not is_known(system):
        return "piecewise linear springs or contacts without friction"
    return ""


def refuse_unknown_stick(system: System, what: str) -> None:
    """Refuse a system without a known `stick_limit`; `what`: words after "cannot"."""
    unknown = unknown_stick(system)
    if unknown:
        raise InputError(
            f"cannot {what} with {unknown}: the friction that holds has no closed form there; compute a map, "
            f"or use question at-most"
        )


def stick_limit(system: System, r: np.ndarray, mu: float | None) -> np.ndarray:
    """Friction ratio from which all contacts hold, (n_r,): beta_stick, or beta_noslip of elastic contacts.

    With static friction, of ratio mu, contacts that are at rest stay so.  With mu None kinetic friction
    alone is enough, at every speed: every motion comes to rest (theory.md 6, 11).  Where normal forces move
    with the structure they can rest, from some starts.  NaN where this has no closed form.
    """
    if is_joint(system):
        return _joint(system, r, mu)[:, 0]
    return _scales(system, needed_friction(system, r), mu).max(axis=1)


def no_stop_limit(system: System, r: np.ndarray, mu: float) -> np.ndarray:
    """Friction ratio up to which a motion without stops exists, (n_r,): beta_lim.

    Raises
    ------
    InputError
        Contacts are elastic, or their friction depends on the speed: they have no such limit; contacts
        that close a loop, where it is not known.
    """
    look()
    refuse_law(
        system,
        "find friction without stops",
        "where friction depends on the speed no limit of it is known; compute a map of stops_per_cycle",
    )
    if system.contact_system.has_phases:
        refuse_phases(
            system,
            "find friction without stops",
            "no limit of it is known there; compute a map of stops_per_cycle",
        )
    if system.contact_system.loop:
        raise InputError(
            "cannot find friction without stops where contacts close a loop: no limit of it is known there; "
            "compute a map of stops_per_cycle"
        )
    if not has_no_stop_limit(system):
        raise InputError(
            "cannot find friction without stops with contact_stiffness: a spring in the contact has no such "
            "limit; use question stuck"
        )
    return engine_of(system).no_stop_limit(r, mu, current_watch())


def has_no_stop_limit(system: System) -> bool:
    """Whether `no_stop_limit` exists, and is known."""
    contacts = system.contact_system
    return not (contacts.elastic.any() or contacts.has_law or is_joint(system))


def starts_matter(system: System, mu: float) -> bool:
    """Whether a cell may have several steady states: static friction exceeds kinetic friction somewhere, or
    friction falls with the speed, and no damping is known to outweigh it.
    """
    return np.isfinite(unique_friction(system, mu))


def unique_friction(system: System, mu: float) -> float:
    """Friction ratio up to which the steady state is proved to be the same from all starts (theory.md 11)."""
    general = system.contact_system
    if not general.has_equal_friction(mu):
        return 0.0
    return max(certified_beta(system), 0.0) if general.has_law else np.inf


def may_reach(bracket: Brackets, level: float) -> Brackets:
    """The maxima that may be at a level or above it, see `_RISE`."""
    with np.errstate(invalid="ignore"):  # infinite less infinite: it is above every level
        rise = bracket.at_m - np.minimum(bracket.at_a, bracket.at_b)
        below = bracket.at_m + _RISE * rise < level
    return chosen(bracket, np.flatnonzero(~below))


def least_no_stop(system: System, band: Band, mu: float) -> tuple[Extreme, Points]:
    """The least beta_lim over a band, and the samples of it."""

    def negative(_: np.ndarray, r: np.ndarray) -> np.ndarray:
        return -no_stop_limit(system, r, mu)

    r = no_stop_samples(system, band)
    points = Points(r, no_stop_limit(system, r, mu))
    dips = brackets_of(r, -points.size)
    order = np.argsort(-dips.at_m, kind="stable")
    place, value = refine_maxima(negative, chosen(dips, order[:1]))
    others = may_reach(chosen(dips, order[1:]), float(value[0]))
    if others.m.size:
        places, values = refine_maxima(negative, others)
        place, value = np.append(place, places), np.append(value, values)
    best = int(np.argmax(value))
    beta, most = float(-value[best]), points.size[np.isfinite(points.size)].max(initial=0.0)
    return Extreme(beta if beta > _LOST * most else 0.0, float(place[best])), points


def largest_stick(system: System, band: Band, mu: float | None) -> Extreme:
    """The largest friction ratio of `stick_limit` over a band: infinite at a pole, NaN if unknown."""
    if unknown_stick(system):
        return Extreme(np.nan, np.nan)
    joint = is_joint(system)

    def of(r: np.ndarray) -> np.ndarray:
        return _joint(system, r, mu) if joint else needed_friction(system, r)

    r = stick_samples(system, band)
    needed = of(r)
    count = needed.shape[1]
    if np.isinf(needed).any():
        return Extreme(np.inf, float(r[np.argmax(needed.max(axis=1))]))
    peaks = [brackets_of(r, one) for one in needed.T]
    contact = np.repeat(np.arange(count), [one.m.size for one in peaks])

    def of_contacts(which: np.ndarray, r: np.ndarray) -> np.ndarray:
        return of(r)[np.arange(r.size), contact[which]]

    places, values = refine_maxima(of_contacts, joined(peaks))
    best = [np.flatnonzero(contact == j)[np.argmax(values[contact == j])] for j in range(count)]
    most, at = values[best], places[best]
    inside = (at > band.low) & (at < band.high)
    for sign in (-1.0, 1.0):
        beside = of_contacts(np.array(best), at * (1.0 + sign * _POLE))
        inside &= beside < 0.5 * most
    most = np.where(inside, np.inf, most)
    scales = most if joint else _scales(system, most[np.newaxis], mu)[0]
    j = int(np.argmax(scales))
    return Extreme(float(scales[j]), float(at[j]))
