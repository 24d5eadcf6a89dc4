"""One cell of a view: its motion in numbers, words and curves, and what other starts give."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from .. import regimes
from ..errors import NoSteadyState
from ..model.settings import Output, Start
from ..pictures.classes import of_cells
from ..pictures.palette import UNRESOLVED
from ..steady.response import response
from ..steady.sweep import sweep
from .views import View

#: Samples per excitation period: a curve a few hundred pixels wide is smooth with them.
_SAMPLES = 400

#: Masses whose numbers are listed one by one.
_LISTED = 12

#: Relative difference of two amplitudes from which on two starts are said to end differently.
_OTHER = 1e-6

Packet = tuple[dict[str, Any], dict[str, np.ndarray]]


class Entry(NamedTuple):
    """A number of a cell, as the page lists it."""

    name: str
    label: str
    unit: str  # "length" and "energy" are named by the page, as the load is a force or a base's motion


_ENTRIES = (
    Entry("stops_per_cycle", "stops per cycle", ""),
    Entry("stuck_fraction", "share of time stuck", "%"),
    Entry("contact_amplitude", "amplitude in the contact", "length"),
    Entry("contact_first_harmonic_amplitude", "its first harmonic", "length"),
    Entry("contact_first_harmonic_phase", "lag of that behind the load", "rad"),
    Entry("amplitude", "amplitude of mass", "length"),
    Entry("phase_lag", "lag of mass", "rad"),
    Entry("work_friction", "energy that friction takes per cycle", "energy"),
    Entry("work_damping", "energy that damping takes per cycle", "energy"),
    Entry("equivalent_damping", "equivalent damping of the contact, cω/k₁", ""),
    Entry("period", "period, in cycles of the excitation", ""),
    Entry("beta_lim", "β_lim here", ""),
    Entry("beta_stick", "β_stick here", ""),
)

#: What a motion without slides has, and what else a list would only repeat.
_MOVING = ("stops_per_cycle", "contact_amplitude", "contact_first_harmonic_amplitude",
           "contact_first_harmonic_phase", "work_friction", "equivalent_damping")  # fmt: skip


def motion(view: View, r: float, beta: float) -> Packet:
    """The motion in a cell for the page.

    Arrays over `tau`: `z`, its velocity `z_rate`, `friction`, `phase` (-1, 0, 1), `x` (masses, tau).  Moduli
    of harmonics 0 to 7: `z_harmonics`, `friction_harmonics`.  `numbers` are those of the header's `entries`.

    Where there is no steady state, the header says why under `none`, and there are no arrays.
    """
    try:
        ds = response(view.system, r, beta, view.mu, solver=_plain(view), points=_SAMPLES)
    except NoSteadyState as error:
        return {"r": r, "beta": beta, "class": UNRESOLVED, "none": str(error)}, {}
    regime = int(ds["regime"])
    entries, numbers = _listed(ds)
    header = {
        "r": r,
        "beta": beta,
        "class": int(
            of_cells(*(np.atleast_1d(ds[name].values) for name in ("regime", "stops_per_cycle")))[0]
        ),
        "regime": next(code.name for code in regimes.REGIMES if code.value == regime),
        "told": in_words(ds),
        "entries": [entry._asdict() for entry in entries],
        "comment": ds.attrs.get("comment", ""),
    }
    return header, {**curves_of(view, ds), "numbers": np.array(numbers)}


def _plain(view: View) -> Any:
    """The solver for a motion alone: what a map is asked for beside it would take as long again."""
    return replace(view.solver, outputs=("regime",))


def _listed(ds: xr.Dataset) -> tuple[list[Entry], list[float]]:
    """What there is to list of a cell, and the numbers; of masses one by one."""
    entries: list[Entry] = []
    numbers: list[float] = []
    stuck = int(ds["regime"]) == regimes.PERMANENT_STICKING
    one = ds.sizes["dof"] == 1
    for entry in _ENTRIES:
        if stuck and entry.name in _MOVING:
            continue
        values = np.atleast_1d(ds[entry.name].values)[:_LISTED]
        for k, value in enumerate(values.tolist(), start=1):
            own = entry.label
            if ds[entry.name].dims == ("dof",):
                own = own.replace("mass", "the mass") if one else f"{own} {k}"
            entries.append(entry._replace(label=own))
            numbers.append(100.0 * value if entry.unit == "%" else float(value))
    return entries, numbers


def curves_of(view: View, ds: xr.Dataset) -> dict[str, np.ndarray]:
    """What is drawn of a motion, float32."""
    system, tau = view.system, ds["tau"].values
    rate = system.contact_vector @ ds["v"].values + system.base_motion * np.sin(tau)
    drawn = {
        "tau": tau,
        "z": ds["z"].values,
        "z_rate": np.where(ds["phase"].values == 0, 0.0, rate),  # at rest to the bit, not to rounding
        "friction": ds["friction"].values,
        "x": ds["x"].values,
        "z_harmonics": _moduli(ds["contact_harmonic"]),
        "friction_harmonics": _moduli(ds["friction_harmonic"]),
    }
    arrays = {name: values.astype(np.float32) for name, values in drawn.items()}
    return {**arrays, "phase": ds["phase"].values}


def _moduli(harmonics: xr.DataArray) -> np.ndarray:
    real, imaginary = harmonics.values[..., 0], harmonics.values[..., 1]
    return np.hypot(real, imaginary)


def in_words(ds: xr.Dataset) -> list[str]:
    """What the contact does in a cell, and why, in sentences."""
    regime = int(ds["regime"])
    told = [_deed(ds, regime)]
    beta, lim, stick = (float(ds[name]) for name in ("beta", "beta_lim", "beta_stick"))
    if beta >= stick:
        why = f"β = {beta:.4g} reaches β_stick = {stick:.4g}: friction can hold the contact for good."
    elif beta < lim:
        why = f"β = {beta:.4g} lies below β_lim = {lim:.4g}: the contact can slide without stopping."
    else:
        why = (
            f"β = {beta:.4g} lies between β_lim = {lim:.4g} and β_stick = {stick:.4g}: friction stops the "
            "contact, but cannot hold it."
        )
    told.append(why)
    status = int(ds["status"])
    if status != regimes.RESOLVED:
        meaning = regimes.status_meaning(status)
        told.append(f"{meaning[0].upper()}{meaning[1:]}.")
    return told


def _deed(ds: xr.Dataset, regime: int) -> str:
    if regime == regimes.PERMANENT_STICKING:
        return "The contact never slides: friction holds it for good."
    if regime == regimes.CONTINUOUS:
        return "The contact slides to and fro without stopping."
    if regime == regimes.UNRESOLVED:
        return "No steady state was found."
    stops, stuck = float(ds["stops_per_cycle"]), 100.0 * float(ds["stuck_fraction"])
    plural = "stop" if stops == 1.0 else "stops"
    return f"The contact slides and stops: {stops:.4g} {plural} per cycle; stuck {stuck:.3g} % of the time."


_STARTS: dict[str, Start] = {"rest": "moving", "moving": "rest"}


def others(view: View, r: float, beta: float) -> Packet:
    """What else is known of a cell: stability, every regime it can end in, the motion from the other start.

    The header has `start`, the other one, `same`, `told` and the `reachable` regimes; the arrays `multiplier`
    and, of another motion, what `motion` has of it.
    """
    wanted: tuple[Output, ...] = ("regime", "multiplier", "also_reachable")
    solver = replace(view.solver, outputs=wanted)
    own = _one(sweep(view.system, r, beta, view.mu, solver=solver, threads=1))
    start = _STARTS[view.solver.start]
    there = replace(view, solver=replace(view.solver, start=start, outputs=("regime", "contact_amplitude")))
    here = replace(view, solver=replace(view.solver, outputs=("regime", "contact_amplitude")))
    ours, theirs = (
        _one(sweep(one.system, r, beta, one.mu, solver=one.solver, threads=1)) for one in (here, there)
    )
    flags = int(own["also_reachable"])
    header: dict[str, Any] = {
        "r": r,
        "beta": beta,
        "start": start,
        "same": _alike(ours, theirs),
        "told": [],
        "reachable": [code.name for code in regimes.REACHABLE if flags & code.value],
    }
    arrays = {"multiplier": np.array([float(own["multiplier"])])}
    if not header["same"]:
        other, curves = motion(there, r, beta)
        header["told"] = [other["none"]] if "none" in other else other["told"][:1]
        arrays |= curves
    return header, arrays


def _one(ds: xr.Dataset) -> xr.Dataset:
    return ds.isel(mu=0, r=0, beta=0)


def _alike(one: Mapping[Any, Any], other: Mapping[Any, Any]) -> bool:
    """Whether two starts end in the same regime with the same amplitude."""
    if int(one["regime"]) != int(other["regime"]):
        return False
    sizes = float(one["contact_amplitude"]), float(other["contact_amplitude"])
    return bool(np.isclose(*sizes, rtol=_OTHER, atol=_OTHER, equal_nan=True))
