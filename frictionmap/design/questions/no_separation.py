"""The least friction at preload, and so the least preload, from which contacts never open over a band."""

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ...datasets.amounts import DIGITS, UP, amounts_of, band_of, rounded
from ...datasets.design_labels import size_label
from ...datasets.labels import Label
from ...errors import InputError, NoSteadyState
from ...model.sizes import SEPARATION
from ...model.system import System
from ...units.scales import Units
from .keys import BAND, BETA, MU
from .record import Question
from .rows import answer_rows
from .sentences import whole_sentence

if TYPE_CHECKING:
    import xarray as xr

    from ..performance import PerformanceCurve
    from ..task import Task

#: Friction ratios of the search that are computed together, from the most downwards.
_AT_ONCE = 6

#: The answer is found to this share of the friction, with a bracket in this number of parts: where a
#: motion that opens ends, the loss of normal force jumps.
_CLOSE, _PARTS = 1e-6, 4

#: Friction below the answer by less than this share is next to it.
_NEXT = 1e-3


def no_separation(
    system: System, band: Any, mu: float = 1.0, *, beta: Any = None, threads: int | None = None,
    units: Units | None = None,
) -> "xr.Dataset":  # fmt: skip
    """Find the least preload from which contacts never open over a band of frequencies.

    A contact whose normal force moves with the structure opens where it loses all of its preload.  The loss
    is followed in the steady motions from rest and from a large sliding motion, over the band and the
    friction at preload; of contacts that never slip it is known that they never open.

    Parameters
    ----------
    system, band, mu, beta, threads, units
        As in `least_peak`; the preload of a contact is N0 = beta ratio/phi.

    Returns
    -------
    xarray.Dataset
        `beta`, the friction from which on contacts never open, and `at_r`, the frequency that decides;
        `preload` N0 of the contacts (`pressed`), over P; on `peak` the largest losses of normal force over
        the preload at `beta`; `peak_of_beta` on `beta_search`, the largest loss over friction, from the most
        down to where a contact opens.  With units also `friction_force` and `preload_N`.

    Raises
    ------
    InputError
        An argument has the wrong type or is out of range; no normal force moves, or the preload is given; or
        contacts open with the most friction that is searched.
    NoSteadyState
        As `least_peak`.

    Examples
    --------
    >>> import frictionmap as fm
    >>> wedge = fm.NormalForce(mass=2, stiffness=1.0, friction=0.4)
    >>> pair = fm.System(
    ...     contacts=[fm.Contact(masses=[1], normal=wedge)],
    ...     mass_ratios=[1, 1], stiffness_ratios=[1, 1], damping_ratios=0.05,
    ... )
    >>> ds = fm.design.no_separation(pair, band=[0.3, 2.0])  # doctest: +SKIP
    >>> ds.preload.values  # doctest: +SKIP
    """
    from ...checks import instance
    from ..answers import answer
    from ..task import checked_task

    instance(system, "system", System)
    _refuse_others(system)
    task = checked_task(system, band, ("contact", system.dofs.numbers[0], 1), mu, beta, threads, units)
    task = _with_losses(task)
    curve = task.performance()
    least = _least_friction(task, curve)
    (peaks,) = curve.whole(np.array([least]), all_peaks=True)
    states, table = curve.states(peaks), curve.table
    found = {
        "beta": least, "at_r": float(peaks.r[0]), "mu": task.mu, "limit": 1.0,
        "peak": peaks.size, "peak_r": peaks.r, "peak_regime": states.regime, "peak_stops": states.stops,
        "beta_search": [one.beta for one in table], "peak_of_beta": [one.largest for one in table],
        "beta_stuck": task.stuck.beta, **_preloads(task, least),
    }  # fmt: skip
    asked = {"mu": task.mu, "beta": [task.low, task.high]}
    ds = answer("no-separation", system, task.band, found, asked, task.units, task.scales)
    return ds.assign_attrs(response=task.response_in_words)


def _refuse_others(system: System) -> None:
    """Refuse systems in which no normal force moves, and preloads that friction does not change."""
    groups = system.contact_system.groups
    if all(group.normal is None for group in groups):
        raise InputError(
            "cannot find a preload without a contact whose normal force moves with the structure: others "
            "never open; give contacts[1].normal"
        )
    for k, group in enumerate(groups, 1):
        own = group.friction(1.0, 1.0)[0] == group.friction(0.0, 1.0)[0]
        if group.normal is not None and own:
            key = "normal.preload" if group.first.has_preload else "force"
            raise InputError(
                f"cannot find a preload with contacts[{k}].{key}: it fixes the preload; omit {key}"
            )


def _with_losses(task: "Task") -> "Task":
    """The task about the loss of normal force."""
    from ..responses import Response

    return replace(task, response=Response(SEPARATION))


def _least_friction(task: "Task", curve: "PerformanceCurve") -> float:
    """The friction from which on no contact opens, looked for from the most friction downwards.

    Raises
    ------
    InputError
        A contact opens with the most friction.
    """
    from ..minimum import Points
    from ..optimum import largest

    beta = task.searched()
    beta, points = beta[beta > 0.0], None  # without a preload every contact opens
    for last in range(beta.size, 0, -_AT_ONCE):
        part = beta[max(last - _AT_ONCE, 0) : last]
        size = largest(curve.whole(part))
        points = Points(part, size) if points is None else points.with_more(part, size)
        if (size > 1.0).any():
            break
    assert points is not None
    opens = np.flatnonzero(points.size > 1.0)
    if not opens.size:
        return float(points.beta[0])
    k = int(opens[-1])
    if k + 1 == points.beta.size:
        raise InputError(
            "beta",
            f"must reach further: with {task.amounts.friction(task.high, digits=DIGITS)}, the most that is "
            f"searched, a contact opens; got [{task.low:.6g}, {task.high:.6g}]",
        )
    low, high = float(points.beta[k]), float(points.beta[k + 1])
    while high - low > _CLOSE * high:
        between = np.linspace(low, high, _PARTS + 1)
        opens = np.flatnonzero(largest(curve.at(between[1:-1])) > 1.0)
        last = int(opens[-1]) + 1 if opens.size else 0
        low, high = float(between[last]), float(between[last + 1])
    _refuse_unknown(task, curve, high)
    return high


def _refuse_unknown(task: "Task", curve: "PerformanceCurve", beta: float) -> None:
    """Refuse an answer next to friction at which it is not known whether a contact opens."""
    from ..optimum import describe_cells

    for level, cells in curve.unknown.items():
        known = cells.peak > 1.0 or cells.seen > 1.0
        if not known and level >= beta * (1.0 - _NEXT):
            raise NoSteadyState(
                f"cannot answer: {describe_cells(task.amounts, level, cells)}, and whether a contact opens "
                "there is not known; narrow the band or the range of beta, or add damping"
            )


def _preloads(task: "Task", beta: float) -> dict[str, Any]:
    """N0 of the contacts whose normal force moves."""
    groups = task.system.contact_system.groups
    moving = [k for k, group in enumerate(groups) if group.normal is not None]
    preload = [groups[k].normal.preload_at(groups[k].friction(beta, 1.0)[0]) for k in moving]  # type: ignore[union-attr]
    found: dict[str, Any] = {"pressed": np.array(moving) + 1, "preload": np.array(preload)}
    force = task.scales.of("force")
    return found | ({"preload_N": np.array(preload) * force} if force is not None else {})


def _sentences(ds: "xr.Dataset") -> Iterator[str]:
    """The preload to set."""
    if not {"beta", "preload", "pressed"} <= set(ds.variables):
        return
    several = ds["pressed"].size > 1
    preloads = ", ".join(_preload_of(ds, k) for k in range(ds["pressed"].size))
    contacts = f"contact{'s' * several} {', '.join(map(str, ds['pressed'].values.tolist()))}"
    friction = amounts_of(ds).friction(float(ds["beta"]), UP)
    never = f"{'they' if several else 'it'} never open{'s' * (not several)}"
    yield whole_sentence(
        f"press {contacts} with {preloads} or more, a friction of {friction} at rest: {never}{band_of(ds)}"
    )


def _preload_of(ds: "xr.Dataset", k: int, digits: int = 4) -> str:
    """The preload of a contact, rounded up: a force where P is known."""
    if "preload_N" in ds:
        return amounts_of(ds).friction(float(ds["preload"][k]), UP, digits)  # over P, as friction is
    return f"{rounded(float(ds['preload'][k]), UP, digits)} P"


def _preload_rows(ds: "xr.Dataset") -> Iterator[tuple[str, str]]:
    """The preload of every contact."""
    if "preload" in ds:
        for k, contact in enumerate(ds["pressed"].values.tolist()):
            ratio = f" ({rounded(float(ds['preload'][k]), UP, DIGITS)} P)" if "preload_N" in ds else ""
            yield f"preload N0 of contact {contact}", f"{_preload_of(ds, k, DIGITS)}{ratio} or more"


NO_SEPARATION = Question(
    name="no-separation",
    title="Least preload from which contacts never open",
    function=no_separation,
    needed=(BAND,),
    optional=(MU, BETA),
    rows=(answer_rows, _preload_rows),
    sentences=(_sentences,),
    panels=("performance",),
    labels={
        "pressed": Label(np.int64, "contact whose normal force moves, counted from 1", ("pressed",), least=1),
        "preload": size_label("normal force at rest over P: the answer", ("pressed",)),
        "preload_N": size_label("normal force at rest: the answer", ("pressed",), units="N"),
    },
)
