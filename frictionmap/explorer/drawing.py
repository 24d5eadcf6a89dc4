"""Drawing of a system in motion for the page: masses, springs, contacts, and how base and loads move."""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from ..model.system import System
from ..structures.dofs import POINT

#: Masses, springs and contacts that are drawn at most.
_MASSES, _SPRINGS, _CONTACTS = 8, 12, 12

#: State of an open contact, beside its directions.
OPEN = 2

#: Springs that are weaker than this, relative to the stiffness of their masses, are rounding errors.
_WEAK = 1e-9


class DrawnContact(NamedTuple):
    """A contact of a drawing."""

    row: int  # of all contacts, counted from 0
    name: str
    masses: list[int]  # places of its masses in the drawing: one beside a wall, two beside each other
    base: bool  # whether its wall moves with the base
    elastic: bool
    belt: float  # velocity of its wall


def drawing_of(system: System, shown: int | None = None) -> dict[str, Any]:
    """Describe what is drawn: rows of `x` that are masses, springs, contacts, loaded masses.

    A spring is a pair of places in `rows`, -1 for the wall or base at the left.  Large and reduced structures
    are drawn by their masses in contact and under load only, without springs; of many masses and contacts
    some are drawn.

    shown : the contact that is shown, counted from 0, which is drawn in any case; None: all together
    """
    rows, names = _rows(system, shown), mass_names(system)
    complete = len(rows) == system.n and system.contact_system.points is None
    return {
        "rows": rows,
        "names": [str(names[row]) for row in rows],
        "masses": system.n,
        "springs": _springs(system.modes.stiffness) if complete else [],
        "base": system.excitation == "base",
        "loaded": [rows.index(row) for row in _loaded(system) if row in rows],
        "contacts": [contact._asdict() for contact in _contacts(system, rows, shown)],
    }


def mass_names(system: System) -> list[int] | list[str]:
    """Short names of masses: their numbers, or those of points."""
    dofs = system.dofs
    return [dofs.word(number) for number in dofs.numbers] if dofs.noun == POINT else list(dofs.numbers)


def vectors_of(system: System) -> np.ndarray:
    """Displacement in each contact per displacement of the masses, or points, (N, n)."""
    general = system.contact_system
    if general.points is None:
        return general.vectors
    found = np.zeros((general.count, system.n))
    for row, group in zip(found, general.groups, strict=True):
        numbers = [system.dofs.number(mass, "masses") for mass in group.first.masses]  # type: ignore[union-attr]
        row[system.dofs.rows(numbers)] = (1.0,) if len(numbers) == 1 else (-1.0, 1.0)
    return found


def drawing_curves(system: System, tau: np.ndarray, shown: int | None = None) -> dict[str, np.ndarray]:
    """Motion of the base (tau,) and loads on the `loaded` masses (masses, tau), float32."""
    rows = _rows(system, shown)
    loaded = [row for row in _loaded(system) if row in rows]
    if system.excitation == "base":
        phasors = system.contact_system.base
        return {"base": _displacements_at({n: np.array([u]) for n, u in phasors.items()}, tau)[0]}
    forces = system.contact_system.loads
    return {"load": _displacements_at({n: load[loaded] for n, load in forces.items()}, tau)}


def _displacements_at(phasors: Mapping[int, np.ndarray], tau: np.ndarray) -> np.ndarray:
    """Re sum u_n e^{i n tau}, float32 (values, tau)."""
    total = sum(np.outer(u, np.exp(1j * n * tau)).real for n, u in phasors.items())
    return np.asarray(total, dtype=np.float32)


def _rows(system: System, shown: int | None) -> list[int]:
    """Rows of the masses that are drawn: those of the contact that is shown first, then of the others."""
    if system.n <= _MASSES and system.reduction is None:
        return list(range(system.n))
    vectors = vectors_of(system)
    first = [] if shown is None else np.flatnonzero(vectors[shown]).tolist()
    touched = np.flatnonzero(vectors.any(axis=0)).tolist()
    return sorted(list(dict.fromkeys([*first, *touched, *_loaded(system)]))[:_MASSES])


def _loaded(system: System) -> list[int]:
    """Rows of masses under load, the largest first; none if the base moves."""
    if system.excitation == "base":
        return []
    size = sum(np.abs(load) for load in system.contact_system.loads.values())
    order = np.argsort(-np.asarray(size), kind="stable")
    return [int(row) for row in order if np.asarray(size)[row] > 0.0][:_MASSES]


def _springs(stiffness: np.ndarray) -> list[list[int]]:
    """Springs of a stiffness matrix; none if there are too many for a drawing."""
    size = np.sqrt(np.diag(stiffness))
    coupled = np.abs(stiffness) > _WEAK * np.outer(size, size)
    to_ground = stiffness.sum(axis=1) > _WEAK * size**2
    found = [[-1, int(k)] for k in np.flatnonzero(to_ground)]
    found += [[int(i), int(j)] for i, j in np.argwhere(np.triu(coupled, 1))]
    return found if len(found) <= _SPRINGS else []


def _contacts(system: System, rows: list[int], shown: int | None) -> list[DrawnContact]:
    """The contacts whose masses are drawn, that which is shown among them."""
    groups = system.contact_system.groups
    masses = [np.flatnonzero(vector).tolist() for vector in vectors_of(system)]
    drawn = [k for k, touched in enumerate(masses) if set(touched) <= set(rows)]
    order = sorted(drawn, key=lambda k: (k != shown, k))[:_CONTACTS]
    return [
        DrawnContact(
            k,
            groups[k].name if len(groups) > 1 else "",
            [rows.index(row) for row in masses[k]],
            bool(groups[k].base),
            groups[k].stiffness is not None,
            float(groups[k].first.belt),
        )
        for k in sorted(order)
    ]
