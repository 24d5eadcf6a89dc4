"""Answers to design questions as datasets."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

from ..datasets.design_labels import DESIGN, DESIGN_AXES
from ..datasets.labels import attributes
from ..datasets.physical import scale_attributes
from ..datasets.provenance import value_text
from ..datasets.variables import stamp
from ..model.system import System
from ..units.scales import Scales, Units
from .band import Band
from .responses import Response

#: Titles of the answers.
_TITLES = {
    "least-peak": "Friction with the least peak",
    "robust": "Friction with the least peak within its spread",
    "at-most": "Friction that keeps a response within a limit",
    "no-stop": "Most friction without a stop",
    "stuck": "Least friction that holds",
    "margin": "Margins of a working point",
    "two-forces": "Two friction forces with the least peak",
}

_OF_SAMPLES = "Friction with the least peak for a share of samples"


def _variable(name: str, value: Any) -> xr.Variable:
    label = DESIGN[name]
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
    question : one of `design_labels.QUESTIONS`
    system : System
    band : range of frequencies
    values : variables and axes by name, see `design_labels.DESIGN`
    asked : further keys of the table [design] that ask the same question
    units : Units, or None
    scales : Scales
    study : axes of the samples, as `sweep` takes them
    """
    found = {"question": question, **values, **_answer_in_units(question, values, asked, scales)}
    variables = {name: _variable(name, value) for name, value in found.items()}
    coords = {name: variables.pop(name) for name in DESIGN_AXES if name in variables}
    r = np.array([band.low, band.high])
    function = f"design.{question.replace('-', '_')}"
    ds = stamp(
        xr.Dataset(variables, coords), function, _TITLES[question], system, {"r": r}, study=study, units=units
    )
    table = {"question": question, "band": [band.low, band.high], **asked}
    lines = [f"{key} = {value_text(value)}" for key, value in table.items()]
    ds.attrs["config"] += "\n".join(["", "[design]", *lines, ""])
    return ds.assign_attrs(scale_attributes(scales), response=_response_in_words(asked))


def _response_in_words(asked: Mapping[str, Any]) -> str:
    """Describe the response of a question; empty for one about boundaries."""
    return Response(**asked["response"]).describe() if "response" in asked else ""


def _answer_in_units(
    question: str, values: Mapping[str, Any], asked: Mapping[str, Any], scales: Scales
) -> dict[str, Any]:
    """The answer in newtons, its peaks in hertz and metres, as far as the reference values are known."""
    found: dict[str, Any] = {}
    force, frequency = scales.of("force"), scales.of("frequency")
    if force is not None:
        named = {
            "beta": "friction_force",
            "interval_begin": "interval_begin_N",
            "interval_end": "interval_end_N",
        }
        found |= {own: np.asarray(values[name]) * force for name, own in named.items() if name in values}
    if frequency is not None and "peak_r" in values:
        found["peak_frequency"] = np.asarray(values["peak_r"]) * frequency
    transmitted = dict(asked.get("response", {})).get("quantity") == "transmitted_force"
    kind, name = ("force", "peak_N") if transmitted else ("length", "peak_m")
    one = scales.of(kind)
    if one is not None and "peak" in values:
        found[name] = np.asarray(values["peak"]) * one
    return found
