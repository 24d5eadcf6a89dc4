"""One cell of a system with several contacts, springs, belts or periodic loads: its motion for the page."""

from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from .. import regimes
from ..errors import NoSteadyState
from ..general.dataset import refuse_static
from ..general.problem import general_of, springs
from ..general.response import general_response
from ..model.general import MergedContact
from ..pictures.classes import of_cells
from ..pictures.palette import UNRESOLVED
from .drawing import drawing_curves, drawing_of
from .general_lines import chosen
from .general_views import counted_of
from .lines import line_values
from .views import View, name_of_mass

#: Samples per excitation period, and masses whose numbers are listed one by one.
_SAMPLES, _LISTED = 400, 12


class _Number(NamedTuple):
    """A number of a cell, as the page lists it; `group` heads those of one contact."""

    name: str
    label: str
    unit: str = ""
    group: str = ""
    why: str = ""


_OF_CONTACT = (
    _Number("stops_per_cycle", "stops per cycle"),
    _Number("turns_per_cycle", "turns without a stop per cycle"),
    _Number("stuck_fraction", "share of time stuck", "%"),
    _Number("slips_per_cycle", "slips per cycle"),
    _Number("slip_reversals_per_cycle", "slip reversals per cycle"),
    _Number("elastic_fraction", "share of time without slip", "%"),
    _Number("contact_amplitude", "amplitude in the contact", "length"),
    _Number("contact_peak_to_peak", "peak to peak in the contact", "length"),
    _Number("contact_first_harmonic_amplitude", "first harmonic in the contact", "length"),
    _Number("work_friction", "energy dissipated by friction per cycle", "energy"),
    _Number("work_wall", "work of the belt per cycle", "energy"),
)
_OF_MASS = (
    _Number("amplitude", "amplitude of", "length"),
    _Number("peak_to_peak", "peak to peak of", "length"),
)
_OF_ALL = (
    _Number("work_damping", "energy dissipated by damping per cycle", "energy"),
    _Number("period", "period, in excitation periods"),
    _Number("multiplier", "largest Floquet multiplier"),
    _Number("beta_lim", "β_lim at this r"),
    _Number("beta_stick", "β_stick at this r"),
    _Number("beta_noslip", "β_noslip at this r"),
    _Number("wall_velocity_lim", "least belt speed for one-way sliding"),
)

#: What a contact does, by its regime: one that is rigid, and one with a spring.
_RIGID = {
    regimes.PERMANENT_STICKING: "friction holds it permanently",
    regimes.CONTINUOUS: "it slides without stopping",
    regimes.ONE_WAY_SLIDING: "it slides one way only, without turning or stopping",
}
_ELASTIC = {
    regimes.PERMANENT_STICKING: "it never slips, and its spring deforms",
    regimes.CONTINUOUS: "it slips without pause",
}


def general_motion(view: View, r: float, beta: float) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    """The motion in a cell for the page, as that of one contact has it (`cell.motion`).

    Of the contact that is shown; all contacts together have one row per contact in `z`, `friction`,
    `direction`, and their names under `contacts`.  `others` is false: no other initial state is looked for.
    """
    general = general_of(view.system)
    refuse_static(general, np.array([view.mu]))
    try:
        ds = general_response(view.system, r, beta, view.mu, view.solver, _SAMPLES)
    except NoSteadyState as error:
        return {"r": r, "beta": beta, "class": UNRESOLVED, "none": str(error), "others": False}, {}
    k = chosen(view)
    shown = range(general.count) if k is None else [k]
    own = np.atleast_1d(ds["contact_regime"].values) if general.count > 1 else ds["regime"].values.ravel()
    regime = int(ds["regime"].values.ravel()[0]) if k is None else int(own[k])
    limits = _limits(view, r)
    numbers = _numbers(view, ds, limits, list(shown))
    header = {
        "r": r, "beta": beta, "class": _class(view, ds, regime, k), "regime": _name(view, regime),
        "summary": [_sentence(ds, general.groups[j], j, int(own[j])) for j in shown] + _why(beta, limits),
        "entries": [entry._asdict() for entry, _ in numbers],
        "comment": ds.attrs.get("comment", ""), "dofs": view.system.dofs.numbers, "others": False,
        "contacts": [group.name for group in general.groups] if k is None else [],
        "contact": general.groups[k].name if k is not None and general.count > 1 else "",
        "still": ["without slip" if elastic else "stuck" for elastic in general.elastic[list(shown)]],
        "drawing": drawing_of(view.system),
    }  # fmt: skip
    return header, {**_curves(view, ds, k), "numbers": np.array([value for _, value in numbers])}


def _name(view: View, regime: int) -> str:
    """Heading of a regime, of the contact shown or of all, from the classes of the map."""
    index = int(of_cells(np.array([regime]), None)[0])
    label = "stick-slip" if regime == regimes.STICK_SLIP else counted_of(view).labels[index]
    k = chosen(view)
    if regime == regimes.STICK_SLIP and k is not None and general_of(view.system).elastic[k]:
        label = "slips and rests"
    return label[0].upper() + label[1:]


def _class(view: View, ds: xr.Dataset, regime: int, k: int | None) -> int:
    stops = None if k is None else ds[counted_of(view).variable].values.ravel()[[k]]
    return int(of_cells(np.array([regime]), stops)[0])


def _limits(view: View, r: float) -> dict[str, float]:
    """Boundaries at the frequency of the cell, of the contact shown or of all."""
    return {name: float(values[0]) for name, values in line_values(view, np.array([r])).items()}


def _why(beta: float, limits: dict[str, float]) -> list[str]:
    """Describe the position of the cell between the boundaries."""
    named = (("β_lim", "beta_lim"), ("β_stick", "beta_stick"), ("β_noslip", "beta_noslip"))
    known = [(symbol, limits[name]) for symbol, name in named if np.isfinite(limits.get(name, np.nan))]
    below = [f"below {symbol} = {value:.4g}" for symbol, value in known if beta < value]
    above = [f"at or above {symbol} = {value:.4g}" for symbol, value in known if beta >= value]
    return [f"β = {beta:.4g} lies {' and '.join((*above, *below))}."] if known else []


def _sentence(ds: xr.Dataset, group: MergedContact, j: int, regime: int) -> str:
    """Describe the motion in one contact."""
    elastic = group.stiffness is not None
    words = (_ELASTIC if elastic else _RIGID).get(regime)
    if words is None:
        name, share = ("slips", "elastic_fraction") if elastic else ("stops", "stuck_fraction")
        count, part = (float(ds[key].values.ravel()[j]) for key in (f"{name}_per_cycle", share))
        said = name.removesuffix("s") if count == 1.0 else name
        rest = "without slip" if elastic else "stuck"
        words = f"{count:.4g} {said} per cycle; {rest} {100.0 * part:.3g} % of the time"
    if "contact_name" in ds:
        return f"{group.name}: {words}."
    return f"{words[0].upper()}{words[1:]}."


def _numbers(
    view: View, ds: xr.Dataset, limits: dict[str, float], shown: list[int]
) -> list[tuple[_Number, float]]:
    """The list of numbers of a cell: of every contact that is shown, of the masses, of all."""
    found: list[tuple[_Number, float]] = []
    general = general_of(view.system)
    for j in shown:
        group = general.groups[j].name if general.count > 1 else ""
        for one in _OF_CONTACT:
            value = float(ds[one.name].values.ravel()[j]) if one.name in ds else np.nan
            if not np.isnan(value):
                share = 100.0 if one.unit == "%" else 1.0
                found.append((one._replace(group=group), share * value))
    whole = "masses and all contacts" if general.count > 1 else ""
    for one in _OF_MASS:
        for row, value in enumerate(ds[one.name].values.ravel()[:_LISTED].tolist()):
            label = f"{one.label} {name_of_mass(view.system, view.system.dofs.numbers[row])}"
            found.append((one._replace(label=label, group=whole), value))
    for one in _OF_ALL:
        value = limits.get(one.name, float(ds[one.name].values.ravel()[0]) if one.name in ds else np.nan)
        if not np.isnan(value):
            found.append((one._replace(group=whole), value))
    return found


def _curves(view: View, ds: xr.Dataset, k: int | None) -> dict[str, np.ndarray]:
    """Curves of a motion, float32: one row per contact, or those of the contact that is shown."""
    tau = ds["tau"].values
    count = general_of(view.system).count
    traces = {name: ds[name].values.reshape(count, -1) for name in ("z", "friction", "direction")}
    traces["z_rate"] = _rates(view, ds, traces["direction"])
    for name in ("contact_harmonic", "friction_harmonic"):
        table = ds[name].values.reshape(count, -1, 2)
        traces[name.replace("contact", "z").replace("_harmonic", "_harmonics")] = np.hypot(*table.T).T
    rows = {name: values if k is None else values[k] for name, values in traces.items()}
    direction = np.ascontiguousarray(rows.pop("direction")).astype(np.int8)
    curves = {"tau": tau, "x": ds["x"].values, **rows}
    found = {name: values.astype(np.float32) for name, values in curves.items()}
    return {**found, **_drawn(view, traces, tau), "direction": direction}


def _drawn(view: View, traces: dict[str, np.ndarray], tau: np.ndarray) -> dict[str, np.ndarray]:
    """Curves of the drawing: `states`, the directions in all contacts, and `stretched`, their springs."""
    stiffness = springs(general_of(view.system))[:, np.newaxis]
    elastic = stiffness > 0.0
    stretched = np.where(elastic, traces["friction"] / np.where(elastic, stiffness, 1.0), 0.0)
    return {
        **drawing_curves(view.system, tau),
        "states": traces["direction"].astype(np.int8),
        "stretched": stretched.astype(np.float32),
    }


def _rates(view: View, ds: xr.Dataset, direction: np.ndarray) -> np.ndarray:
    """Velocity z' in every contact; that of its wall, where a rigid one is stuck."""
    general, tau = general_of(view.system), ds["tau"].values
    base = sum(-n * (u * np.exp(1j * n * tau)).imag for n, u in general.base.items()) + np.zeros_like(tau)
    rows = []
    for j, group in enumerate(general.groups):
        rate = group.vector @ ds["v"].values - group.base * base
        stuck = (direction[j] == 0) & (group.stiffness is None)
        rows.append(np.where(stuck, group.first.wall_velocity, rate))
    return np.array(rows)
