"""Spectra of one mass whose contact has a spring: by the general engine, oscillator by oscillator."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import product

import numpy as np

from ..errors import InputError
from ..jobs import Progress, Watch
from ..model.contact import Contact
from ..model.system import System
from .dataset import history
from .lanes import Grid, Responses
from .pieces import scaled
from .record import Record

#: Powers of w that the values of a record are divided by, in time over 1/w and displacements as they are.
_POWERS = {"force": 2, "acceleration": 2, "velocity": 1, "displacement": 0}

#: Samples of records that are followed together, at most: each takes about 200 bytes.
_TOGETHER = 10**6


def _over_w(record: Record, w: float, size: float) -> Record:
    """The record in time over 1/w, without a unit."""
    times = {"dt": record.dt * w} if record.dt is not None else {"time": record.time * w}
    factor = size * w ** -_POWERS[record.quantity]
    series = None if record.series is None else scaled(record.series, w, factor)
    return replace(record, values=record.values * factor, unit=None, series=series, **times)


def _system(grid: Grid, stiffness: float) -> System:
    base = grid.records[0].quantity != "force"
    contact = Contact("joined-base-wall" if base else "fixed-wall", stiffness=stiffness)
    moved = {"excitation": "base", "damping_reference": "base"} if base else {}
    return System(damping_ratios=grid.damping, contacts=[contact], **moved)  # type: ignore[arg-type]


def refuse_elastic(grid: Grid) -> None:
    """Refuse what oscillators whose contact has a spring cannot have.

    Raises
    ------
    InputError
        A period is infinite, or mu is not 1.
    """
    if grid.mu.size != 1 or grid.mu[0] != 1.0:
        raise InputError(
            "mu",
            f"must be 1 with contact_stiffness: its spring would jump at break-away; got {grid.mu.tolist()}",
        )
    if np.isinf(grid.period).any():
        raise InputError(
            "period", "must be finite with contact_stiffness, a share of the stiffness of the spring; got inf"
        )


def follow_elastic(
    grid: Grid, stiffness: float, size: list[float], threads: int, progress: Progress | None,
    watch: Watch | None,
) -> np.ndarray:  # fmt: skip
    """What became of all oscillators, (variables, *grid.shape).

    Parameters
    ----------
    grid : the oscillators
    stiffness : of the contact, over that of the mass's spring
    size : factors of the records in SI units
    threads, progress, watch : as in `spectrum`
    """
    system = _system(grid, stiffness)
    found = np.zeros((len(Responses._fields), *grid.shape))
    tasks = list(product(_groups(grid.records), enumerate(grid.period)))
    for ended, (group, (k, period)) in enumerate(tasks, 1):
        w = 2.0 * np.pi / period
        records = [_over_w(grid.records[i], w, size[i]) for i in group]
        ds = history(
            system, records, beta=grid.friction / w**2, scale=grid.scale, samples="none", beta_hold=False,
            threads=threads, watch=watch,
        )  # fmt: skip
        own = {"stops": "slips"}
        for i, name in enumerate(Responses._fields):
            values = ds[own.get(name, name)]
            values = values.isel(dof=0) if "dof" in values.dims else values
            factor = {"acceleration_amplitude": w * w, "asleep_time": 1.0 / w}.get(name, 1.0)
            found[i, group.start : group.stop, :, :, k] = factor * values.values
        if progress is not None:
            progress(ended, len(tasks))
    return found


def _groups(records: Sequence[Record]) -> Iterator[range]:
    """Numbers of neighbouring records that together have few enough samples for memory."""
    first, samples = 0, 0
    for k, record in enumerate(records):
        if k > first and samples + record.values.size > _TOGETHER:
            yield range(first, k)
            first, samples = k, 0
        samples += record.values.size
    yield range(first, len(records))
