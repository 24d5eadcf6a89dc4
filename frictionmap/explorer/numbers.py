"""Numbers of a cell, as the page lists them."""

from collections.abc import Iterator, Mapping
from typing import NamedTuple

import numpy as np

from .. import regimes
from .quantities import name_of_mass
from .views import View

#: Masses and contacts whose numbers are listed one by one.
_LISTED, _LISTED_CONTACTS = 12, 8

Values = Mapping[str, np.ndarray]


class Number(NamedTuple):
    """A number of a cell; `group` heads those of one contact."""

    name: str
    label: str
    unit: str = ""  # "length" and "energy" are named by the page, as the load is a force or a base's motion
    group: str = ""
    why: str = ""  # reason why there is no number


_OF_CONTACT = (
    Number("stops_per_cycle", "stops per cycle"),
    Number("turns_per_cycle", "turns without a stop per cycle"),
    Number("stuck_fraction", "share of time stuck", "%"),
    Number("slips_per_cycle", "slips per cycle"),
    Number("slip_reversals_per_cycle", "slip reversals per cycle"),
    Number("elastic_fraction", "share of time without slip", "%"),
    Number("open_fraction", "share of time open", "%"),
    Number("separations_per_cycle", "separations per cycle"),
    Number("normal_force_min", "least normal force", "force"),
    Number("normal_force_max", "largest normal force", "force"),
    Number("contact_amplitude", "amplitude in the contact", "length"),
    Number("contact_peak_to_peak", "peak to peak in the contact", "length"),
    Number("contact_first_harmonic_amplitude", "first harmonic in the contact", "length"),
    Number("contact_first_harmonic_phase", "phase lag of this harmonic", "rad"),
    Number("work_friction", "energy dissipated by friction per cycle", "energy"),
    Number("work_wall", "work of the belt per cycle", "energy"),
    Number("equivalent_damping", "equivalent damping of the contact, cω/k₁"),
)
#: Of these what there is to say of a contact that never slides.
_HELD = (
    "stuck_fraction",
    "normal_force_min",
    "normal_force_max",
    "contact_amplitude",
    "contact_peak_to_peak",
)

_OF_MASS = (
    Number("amplitude", "amplitude of", "length"),
    Number("peak_to_peak", "peak to peak of", "length"),
    Number("phase_lag", "phase lag of", "rad"),
)
_OF_ALL = (
    Number("work_damping", "energy dissipated by damping per cycle", "energy"),
    Number("period", "period, in excitation periods"),
    Number("multiplier", "largest Floquet multiplier"),
    Number("beta_lim", "β_lim at this r"),
    Number("beta_stick", "β_stick at this r"),
    Number("beta_noslip", "β_noslip at this r"),
    Number("wall_velocity_lim", "least belt speed for one-way sliding"),
)


def numbers_of(view: View, values: Values, limits: Values) -> tuple[list[Number], np.ndarray]:
    """The list of a cell: of every contact that is shown, of the masses, of all; without unknown ones.

    limits : the boundaries at its frequency
    """
    known = {**values, **limits}
    found = [*_contact_numbers(view, known), *_mass_numbers(view, known), *_common_numbers(view, known)]
    return [number for number, _ in found], np.array([value for _, value in found])


def listed_contacts(view: View, values: Values) -> list[int]:
    """The contacts that have numbers and charts of their own: of many the first ones that move."""
    if view.shown is not None:
        return [view.shown]
    held = np.asarray(values["contact_regime"]) == regimes.PERMANENT_STICKING
    order = np.argsort(held, kind="stable")[:_LISTED_CONTACTS]
    return sorted(order.tolist())


def _contact_numbers(view: View, values: Values) -> Iterator[tuple[Number, float]]:
    groups = view.system.contact_system.groups
    for j in listed_contacts(view, values):
        group = groups[j].name if len(groups) > 1 else ""
        held = groups[j].stiffness is None and values["contact_regime"][j] == regimes.PERMANENT_STICKING
        for number in _OF_CONTACT:
            value = float(values[number.name][j]) if number.name in values else np.nan
            if not np.isnan(value) and (not held or number.name in _HELD):
                yield number._replace(group=group), 100.0 * value if number.unit == "%" else value


def _whole(view: View) -> str:
    """Heading of the numbers that belong to no single contact."""
    return "masses and all contacts" if view.system.contact_system.count > 1 else ""


def _mass_numbers(view: View, values: Values) -> Iterator[tuple[Number, float]]:
    dofs = view.system.dofs.numbers
    for number in _OF_MASS:
        for row, value in enumerate(values.get(number.name, np.empty(0))[:_LISTED].tolist()):
            why = _reason_for_no_lag(values, row) if number.name == "phase_lag" and np.isnan(value) else ""
            label = f"{number.label} {name_of_mass(view.system, dofs[row])}"
            yield number._replace(label=label, group=_whole(view), why=why), value


def _reason_for_no_lag(values: Values, k: int) -> str:
    """Explain why mass k, counted from 0, has no lag: its maximum has no single phase in the cycle."""
    period = int(values["period"])
    if period != 1:
        return f"the period is {period} cycles" if period else "the motion has no period"
    if values["amplitude"][k] == 0.0:
        return "the mass is at rest"
    begin, end = (f"{values[name][k]:.3f}".replace("-", "−") for name in ("phase_begin", "phase_end"))
    return f"held at its maximum from {begin} to {end} rad"


def _common_numbers(view: View, values: Values) -> Iterator[tuple[Number, float]]:
    for number in _OF_ALL:
        value = float(values[number.name].item()) if number.name in values else np.nan
        if not np.isnan(value):
            yield number._replace(group=_whole(view)), value
