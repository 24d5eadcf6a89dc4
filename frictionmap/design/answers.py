"""Answers to design questions as datasets."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

from ..datasets.amounts import DOWN, amounts_by
from ..datasets.design_labels import answer_axes, answer_labels
from ..datasets.labels import attributes
from ..datasets.physical import scale_attributes
from ..datasets.provenance import value_text
from ..datasets.questions import record
from ..datasets.variables import stamp
from ..model.system import System
from ..units.scales import Scales, Units
from .band import Band, peak_samples
from .limits import (
    boundary_samples,
    has_no_stop_limit,
    no_stop_limit,
    starts_matter,
    stick_limit,
    unique_friction,
)
from .minimum import Points
from .optimum import THRESHOLD, TWO_PEAKS, Minimum, Optimum, find_optimum, irregular_cells, largest
from .performance import PerformanceCurve
from .responses import Response, Responses
from .sampled import SampledPerformance, sample_values, sampled
from .samples import Samples
from .task import Task

#: Relative changes of the friction at which the response is given beside the answer.
_OFFSETS = np.array([-0.2, -0.02, 0.02, 0.2])

#: The same of an answer for a spread, whose own response is not its peak.
_OFFSETS_OF_SPREAD = np.array([-0.2, -0.02, 0.0, 0.02, 0.2])

#: Response curves of an answer, at these multiples of its friction; also without friction, and stuck.  With
#: a spread they are at its ends.
_CURVES = np.array([0.5, 1.0, 2.0])

#: Peaks of an answer that are listed: those above this share of the largest one.
_LISTED = 0.8


def _variable(name: str, value: Any) -> xr.Variable:
    label = answer_labels()[name]
    if label.also and np.size(value) and np.max(value) > label.codes[-1].value:
        label = label._replace(codes=(*label.codes, *label.also))
    attrs = attributes(label)
    if label.dtype is np.str_:
        attrs.pop("units")
    return xr.Variable(label.dims, np.asarray(value, dtype=label.dtype), attrs)


def answer(
    question: str, system: System, band: Band, values: Mapping[str, Any], asked: Mapping[str, Any],
    units: Units | None, scales: Scales, study: Mapping[str, Any] | None = None,
) -> xr.Dataset:  # fmt: skip
    """Build the dataset of an answer.

    Parameters
    ----------
    question : name of its record
    system : System
    band : range of frequencies
    values : variables and axes by name, see `design_labels.answer_labels`
    asked : further keys of the table [design] that ask the same question
    units : Units, or None
    scales : Scales
    study : axes of the samples, as `sweep` takes them
    """
    values = _with_unique(system, values)
    found = {"question": question, **values, **_answer_in_units(question, values, asked, scales)}
    variables = {name: _variable(name, value) for name, value in found.items()}
    coords = {name: variables.pop(name) for name in answer_axes() if name in variables}
    r = np.array([band.low, band.high])
    function = f"design.{question.replace('-', '_')}"
    ds = stamp(
        xr.Dataset(variables, coords),
        function,
        record(question).title,
        system,
        {"r": r},
        study=study,
        units=units,
    )
    ds.attrs["config"] += _table_text(question, {"band": [band.low, band.high], **asked})
    caution = _not_unique(question, values, scales)
    ds.attrs |= {"warnings": caution} if caution else {}
    return ds.assign_attrs(scale_attributes(scales), response=_response_in_words(asked, system))


def unloaded_answer(
    question: str, system: System, values: Mapping[str, Any], asked: Mapping[str, Any],
    units: Units | None, scales: Scales,
) -> xr.Dataset:  # fmt: skip
    """Build the dataset of an answer about a belt without a load; arguments as in `answer`."""
    found = {"question": question, **values, **_answer_in_units(question, values, asked, scales)}
    variables = {name: _variable(name, value) for name, value in found.items()}
    coords = {name: variables.pop(name) for name in answer_axes() if name in variables}
    function, axes = f"design.{question.replace('-', '_')}", {"beta": np.array([values["beta"]])}
    ds = stamp(xr.Dataset(variables, coords), function, record(question).title, system, axes, units=units)
    ds.attrs["config"] += _table_text(question, asked)
    ds.attrs |= {"system": system.describe_unloaded(), "excitation": "none"}
    return ds.assign_attrs(scale_attributes(scales))


def _table_text(question: str, asked: Mapping[str, Any]) -> str:
    """The table [design] of a configuration that asks a question."""
    lines = [f"{key} = {value_text(value)}" for key, value in {"question": question, **asked}.items()]
    return "\n".join(["", "[design]", *lines, ""])


def _with_unique(system: System, values: Mapping[str, Any]) -> dict[str, Any]:
    """The values, with the friction up to which the steady state is unique where friction has a law."""
    unique = {"beta_unique": unique_friction(system, values["mu"])} if system.contact_system.has_law else {}
    return {**values, **unique}


def _not_unique(question: str, values: Mapping[str, Any], scales: Scales) -> str:
    """What an answer does not prove where friction falls with the speed, in words; empty if it is proved."""
    unique, beta = values.get("beta_unique", np.inf), values["beta"]
    most = max([beta * (1.0 + values.get("spread", 0.0)), *values.get("interval_end", ())])
    rests = beta >= values.get("beta_stuck", np.inf)
    if question == "stuck" or rests or most <= unique:
        return ""
    begin = amounts_by(scales, "", False).friction(unique, DOWN)
    words = f"above {begin} the steady state is not proved to be the same from every start"
    if not record(question).of_response:
        return words
    return f"{words}, and the larger response of those from rest and from a large sliding motion counts"


def _response_in_words(asked: Mapping[str, Any], system: System) -> str:
    """Describe the response of a question; empty for one about boundaries."""
    return Response(**asked["response"]).describe(system.dofs) if "response" in asked else ""


def _answer_in_units(
    question: str, values: Mapping[str, Any], asked: Mapping[str, Any], scales: Scales
) -> dict[str, Any]:
    """The answer in newtons, its peaks in hertz and metres, as far as the reference values are known."""
    found: dict[str, Any] = {}
    force, frequency = scales.of("force"), scales.of("frequency")
    if force is not None:
        found["friction_force"] = np.asarray(values["beta"]) * force
    if frequency is not None and "peak_r" in values:
        found["peak_frequency"] = np.asarray(values["peak_r"]) * frequency
    transmitted = dict(asked.get("response", {})).get("quantity") == "transmitted_force"
    kind, name = ("force", "peak_N") if transmitted else ("length", "peak_m")
    one = scales.of(kind)
    if one is not None and "peak" in values and "response" in asked:
        found[name] = np.asarray(values["peak"]) * one
    return found


def peaks_answer(
    question: str, task: Task, curve: PerformanceCurve, optimum: Optimum,
    asked: Mapping[str, Any], further: Mapping[str, Any] | None = None,
    study: Mapping[str, Any] | None = None,
) -> xr.Dataset:  # fmt: skip
    """Build the dataset of a question about the largest response: `asked` and `further` as in `answer`."""
    best = optimum.best
    second = optimum.second or Minimum(np.nan, np.nan, "")
    points = optimum.points
    unknown = [curve.unknown[beta].number if beta in curve.unknown else 0 for beta in points.beta.tolist()]
    offsets = _OFFSETS_OF_SPREAD if "spread" in asked else _OFFSETS
    found = {
        "beta": best.beta, "mu": task.mu, "kind": best.kind, **_peaks(curve, optimum, "spread" in asked),
        "second_beta": second.beta, "second_peak": second.size,
        "beta_search": points.beta, "peak_of_beta": points.size,
        "unknown_of_beta": unknown,
        "offset": offsets, "peak_at_offset": largest(curve.whole(best.beta * (1.0 + offsets))),
        **({} if study else task.limits()), **(further or {}), **_worst(optimum),
        **_response_curves(task, best.beta, _shown(asked)),
        **{name: value for name, value in asked.items() if name in answer_labels()},
    }  # fmt: skip
    keys = {"response": task.response.as_config(), "mu": task.mu, "beta": [task.low, task.high], **asked}
    ds = answer(question, task.system, task.band, found, keys, task.units, task.scales, study)
    caution = irregular_cells(task.amounts, curve, best.beta)
    cautions = [words for words in (ds.attrs.get("warnings", ""), caution) if words]
    return ds.assign_attrs(warnings="; ".join(cautions)) if cautions else ds


def _peaks(curve: PerformanceCurve, optimum: Optimum, of_spread: bool) -> dict[str, Any]:
    """The peaks of an answer, the largest one first: with a spread the worst in it.  A threshold has none."""
    best, peaks = optimum.best, optimum.peaks
    if best.kind == THRESHOLD:
        return {"peak": [0.0], "at_r": peaks.r[0]}
    listed = peaks.above(_LISTED * peaks.largest).by_frequency(TWO_PEAKS)
    states = curve.states(listed)
    size = np.concatenate(([best.size], listed.size[1:])) if of_spread else listed.size
    return {"peak": size, "peak_r": listed.r, "peak_regime": states.regime, "peak_stops": states.stops}


def _worst(optimum: Optimum) -> dict[str, np.ndarray]:
    """The curve that was minimised with a spread."""
    if optimum.worst is None:
        return {}
    return {"worst_search": optimum.worst.beta, "worst_of_beta": optimum.worst.size}


def _shown(asked: Mapping[str, Any]) -> np.ndarray:
    """Multiples of the answer's friction at which response curves are given."""
    spread = asked.get("spread", 0.0)
    return np.array([1.0 - spread, 1.0, 1.0 + spread]) if spread else _CURVES


def _response_curves(task: Task, beta: float, multiples: np.ndarray) -> dict[str, np.ndarray]:
    """Response curves at multiples of the friction of the answer, without friction, and stuck."""
    responses = Responses(task.system, task.response, task.mu, task.threads)
    r = peak_samples(task.system, task.band)
    levels = np.unique(np.concatenate(([0.0] if task.may_be_without_friction else [], beta * multiples)))
    sizes = responses.on_grid(r, levels).size.T
    if np.isfinite(task.stuck.beta):
        sizes = np.vstack((sizes, responses.on_grid(r, np.array([1.01 * task.stuck.beta])).size.T))
        levels = np.append(levels, np.inf)
    return {"curve": levels, "r_search": r, "response_of_r": sizes}


def boundaries_over(system: System, band: Band, mu: float) -> dict[str, np.ndarray]:
    """The boundaries over a band, for pictures."""
    r = boundary_samples(system, band)
    if not has_no_stop_limit(system):
        return boundaries_at(system, mu, Points(r, np.empty(0)))
    return boundaries_at(system, mu, Points(r, no_stop_limit(system, r, mu)))


def boundaries_at(system: System, mu: float, no_stop: Points) -> dict[str, np.ndarray]:
    """The boundaries at the frequencies at which beta_lim is known, if the system has one, for pictures."""
    r = no_stop.beta
    found = {"r_search": r, "beta_stick_of_r": stick_limit(system, r, mu)}
    if no_stop.size.size:
        found["beta_lim_of_r"] = no_stop.size
    if starts_matter(system, mu):
        found["beta_stuck_of_r"] = stick_limit(system, r, None)
    return found


def answer_for_samples(task: Task, samples: Samples, *, widen: bool) -> xr.Dataset:
    """Build the dataset of the friction that is best for a quantile of samples."""
    variations = samples.of(task.system)
    task, tasks = sampled(task, variations, widen=widen)
    curve = SampledPerformance(tasks, samples.quantile)
    optimum = find_optimum(task, curve)
    further = sample_values(tasks, curve, optimum.best.beta)
    further |= _deciding(tasks, optimum, peak_samples(task.system, task.band))
    asked = {"quantile": samples.quantile}
    return peaks_answer("robust", task, curve, optimum, asked, further, variations.described)


def _deciding(tasks: list[Task], optimum: Optimum, r: np.ndarray) -> dict[str, Any]:
    """The response curve of the sample whose peak is the answer."""
    owner = optimum.peaks.owner
    if owner is None or optimum.best.kind == THRESHOLD:
        return {}
    task = tasks[int(owner[0])]
    responses = Responses(task.system, task.response, task.mu, task.threads)
    sizes = responses.on_grid(r, np.array([optimum.best.beta])).size[:, 0]
    return {"deciding_sample": int(owner[0]) + 1, "response_of_sample": sizes}
