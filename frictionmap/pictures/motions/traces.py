"""Motion of every contact in time, its stops and the levels of its friction force."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
import xarray as xr

from ...files.stored import stored_contacts
from ..palette import CONTACTS, in_turn
from ..words import name_of_contact

#: Colour of the only contact.
CONTACT_COLOUR = "black"

#: Largest range of a motion that counts as rest: it is the rounding error of exact motions, over P/k1.
ROUNDING = 1e-9

#: Variables of the events; without one of these the starts of stops are not marked.
_EVENTS = ("event_tau", "event_direction", "event_z")


class Trace(NamedTuple):
    """One contact of a steady state; events and values over tau."""

    number: int  # of the contact, from 1; 0 if there is only one
    label: str  # in the legend; empty if there is only one
    colour: str
    z: np.ndarray
    friction: np.ndarray
    stuck: np.ndarray  # bool
    elastic: bool
    stops: tuple[np.ndarray, np.ndarray]  # phases at which stops begin, and z there
    opened: np.ndarray  # bool
    normal: np.ndarray | None  # normal force of a contact with one that moves
    stop_friction: np.ndarray  # friction with which stops begin

    @property
    def rests(self) -> bool:
        """Whether nothing moves in the contact."""
        return is_at_rest(self.z)


def is_at_rest(values: np.ndarray) -> bool:
    """Whether a motion is constant except for rounding errors."""
    low, high = float(values.min()), float(values.max())
    return 0.56 * (high - low) <= ROUNDING * max(1.0, abs(low), abs(high))


def at_rest(values: np.ndarray) -> np.ndarray:
    """A motion without the rounding errors of rest: constant then, and zero where it is nothing else."""
    if not is_at_rest(values):
        return values
    level = float(values[0])
    return np.full_like(values, 0.0 if abs(level) <= ROUNDING else level)


def _stops(ds: xr.Dataset, number: int) -> tuple[np.ndarray, np.ndarray]:
    """Where stops of a contact begin: phases and z; of an excerpt, those inside it.

    Without the number of the contact nothing is known of events of several.
    """
    of_contact = ds["event_contact"].values if "event_contact" in ds else None
    unknown = of_contact is not None and not number and np.unique(of_contact).size > 1
    if unknown or not set(_EVENTS) <= set(ds):
        return np.empty(0), np.empty(0)
    begins = ds["event_direction"].values == 0
    if of_contact is not None and number:
        begins &= of_contact == number
    tau = ds["tau"].values
    begins &= (ds["event_tau"].values >= tau.min()) & (ds["event_tau"].values <= tau.max())
    return ds["event_tau"].values[begins], ds["event_z"].values[begins]


def _trace(ds: xr.Dataset, number: int, colour: str, label: str) -> Trace:
    """The only contact, or one that was chosen."""
    elastic = "y" in ds and bool(np.isfinite(ds["y"].values).any())
    stuck = ds["direction"].values == 0 if "direction" in ds else np.zeros(ds.sizes["tau"], dtype=bool)
    opened = ds["open"].values == 1 if "open" in ds else np.zeros_like(stuck)
    normal = ds["normal_force"].values if "normal_force" in ds else None
    if normal is not None and not np.isfinite(normal).any():
        normal = None
    stops, friction = _stops(ds, number), ds["friction"].values
    before = np.empty(0, dtype=int)
    if stops[0].size:  # motions under records have no phase, and no such events
        before = np.searchsorted(ds["tau"].values, stops[0]) - 1  # of a stop at the start the last sample
    return Trace(
        number, label, colour, at_rest(ds["z"].values), friction, stuck, elastic, stops, opened, normal,
        friction[before],
    )  # fmt: skip


def contact_colours(number: int) -> list[str]:
    """Colours of all contacts of a motion."""
    return [CONTACT_COLOUR] if number == 1 else in_turn(CONTACTS, number)


def traces_of(ds: xr.Dataset) -> list[Trace]:
    """Motion of every contact of a response."""
    if "contact" not in ds.dims:
        number = int(ds["contact"]) if "contact" in ds.coords else 0
        return [_trace(ds, number, CONTACT_COLOUR, "")]
    contacts = [ds.isel(contact=k) for k in range(ds.sizes["contact"])]
    return [
        _trace(one, int(one["contact"]), colour, name_of_contact(one))
        for one, colour in zip(contacts, contact_colours(len(contacts)), strict=True)
    ]


class Levels(NamedTuple):
    """Kinetic and static friction of a contact, and the factor of its normal load over tau.

    Of a normal force N that moves with the structure the factor is N, and the friction is over it.
    """

    kinetic: float
    static: float
    factor: np.ndarray | None  # None: constant
    over_normal: bool = False


def levels_of(ds: xr.Dataset, trace: Trace) -> Levels | None:
    """Friction levels of a contact; None for one of several in a file without its system."""
    beta, mu = float(ds["beta"]), float(ds["mu"])
    contacts = stored_contacts(ds)
    if contacts is None or trace.number > contacts.count:
        return None if trace.number else Levels(beta, mu * beta, None)
    group = contacts.groups[max(trace.number, 1) - 1]
    if group.normal is not None and trace.normal is not None:
        phi = group.normal.friction
        return Levels(phi, phi * group.first.static_ratio(mu), trace.normal, True)
    kinetic, static = group.friction(beta, mu)
    tau = ds["tau"].values
    normal = [(phasor * np.exp(1j * n * tau)).real for n, phasor in group.first.nu.items()]
    return Levels(float(kinetic), float(static), 1.0 + np.sum(normal, axis=0) if normal else None)


def load_trace(ds: xr.Dataset) -> np.ndarray:
    """Load over tau, or the motion of the base that stands in its place."""
    if "load" in ds:
        return ds["load"].values
    tau = ds["tau"].values
    if is_cosine(ds):
        return np.cos(tau)
    return np.sum([(phasor * np.exp(1j * n * tau)).real for n, phasor in _base_of(ds).items()], axis=0)


def is_cosine(ds: xr.Dataset) -> bool:
    """Whether cos tau stands for the load, whose phase is then counted from its maximum."""
    return "load" not in ds and _base_of(ds) == {1: 1.0}


def _base_of(ds: xr.Dataset) -> Mapping[int, complex]:
    """Harmonics of the base motion; cos tau where no base moves, and where the system is not known."""
    contacts = stored_contacts(ds)
    return (contacts.base if contacts is not None else {}) or {1: 1.0}
