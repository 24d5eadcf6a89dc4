"""Where records come from, and bases that drift at the end of theirs, in words for datasets."""

from collections.abc import Sequence

import numpy as np

from ..model.system import System
from .channels import is_relative_damping, sees_place
from .pieces import integral
from .record import Record

#: A base whose velocity at the end is above this share of its largest drifts.
_DRIFTS = 0.01


def uses_place(system: System) -> bool:
    """Whether the displacement or the velocity of the base acts on a structure, too."""
    return sees_place(system) or (not is_relative_damping(system) and bool(system.modes.damping.any()))


def end_velocity(record: Record) -> float:
    """Velocity of the base at the end over its largest at samples; 0 of forces and of a base at rest."""
    if record.quantity == "velocity":
        velocity = np.append(record.pieces.terms[:, 0], record.pieces.ends[-1])
    elif record.quantity == "acceleration":
        found = integral(record.pieces)
        velocity = np.append(found.terms[:, 0], found.ends[-1])
    else:  # a displacement ends at rest
        return 0.0
    largest = float(np.abs(velocity).max())
    return 0.0 if largest == 0.0 else float(velocity[-1]) / largest


def drifts(system: System, records: Sequence[Record]) -> str:
    """A remark on records whose base still moves at their end where its place matters, or empty."""
    if not uses_place(system):
        return ""
    ends = [abs(end_velocity(record)) for record in records]
    names = [record.name or f"record {k + 1}" for k, record in enumerate(records) if ends[k] > _DRIFTS]
    if not names:
        return ""
    more = f" and {len(names) - 3} more" if len(names) > 3 else ""
    return (
        f"the base of {', '.join(names[:3])}{more} ends with up to {max(ends):.0%} of its largest velocity, "
        'and its place acts on the structure: use a corrected record, or of accelerations baseline = "mean"'
    )


def origins(records: Sequence[Record]) -> str:
    """Where records come from and what was made of them, one line each; empty if nothing is known."""
    lines = [
        f"{record.name or f'record {k + 1}'}: {'; '.join(filter(None, (record.source, record.note)))}"
        for k, record in enumerate(records)
        if record.source or record.note
    ]
    return "\n".join(lines)


def record_attributes(system: System | None, records: Sequence[Record]) -> dict[str, str]:
    """Attributes of a dataset that say where its records come from, and what to look out for.

    system : None: only the acceleration of the base acts
    """
    found = {"records": origins(records), "remark": "" if system is None else drifts(system, records)}
    return {name: text for name, text in found.items() if text}
