"""Responses that a goal can be about: of a mass, or in a contact."""

from typing import NamedTuple

from ..model.system import System
from .quantities import name_of_mass

#: Masses that are offered one by one.
_OFFERED = 12


class Subject(NamedTuple):
    """A response: its key on the page, its name, and the arguments that `fm.design` takes for it."""

    key: str
    label: str
    quantity: str
    number: int  # of the mass or contact, counted from 1

    @property
    def arguments(self) -> dict[str, str | int]:
        """Arguments of the functions of `fm.design`."""
        of = "mass" if self.quantity == "amplitude" else "contact"
        return {"quantity": self.quantity, of: self.number}


def subjects_of(system: System) -> tuple[Subject, ...]:
    """Masses and contacts whose response a goal can be about."""
    masses = tuple(
        Subject(f"mass-{number}", name_of_mass(system, number), "amplitude", number)
        for number in system.dofs.numbers[:_OFFERED]
    )
    groups = system.contact_system.groups
    names = [group.name for group in groups] if len(groups) > 1 else ["the contact"]
    contacts = tuple(
        Subject(f"contact-{number}", name, "contact", number) for number, name in enumerate(names, 1)
    )
    return (*masses, *contacts)


def describe_subjects(system: System) -> list[dict[str, str]]:
    """The same for the page: keys and labels."""
    return [{"key": one.key, "label": one.label} for one in subjects_of(system)]
