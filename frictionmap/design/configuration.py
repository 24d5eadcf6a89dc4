"""The table [design] of a configuration: which question, and its arguments."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import xarray as xr

from .. import checks
from ..datasets.design_labels import QUESTIONS
from ..errors import InputError
from ..files.config import common_tables, design_table, further_axes, read_tree, unknown_key, within
from ..files.variants import put_variants
from .questions import at_most, least_peak, margin, no_stop, robust, stuck, two_forces
from .samples import Samples

#: Functions of the questions, the keys that each needs, and those that it may have.
_FUNCTIONS: dict[str, tuple[Callable[..., xr.Dataset], tuple[str, ...], tuple[str, ...]]] = {
    "least-peak": (least_peak, ("band",), ("mu", "beta", "response")),
    "two-forces": (two_forces, ("band",), ("mu", "beta", "response", "second", "ratio")),
    "robust": (robust, ("band",), ("mu", "beta", "response", "spread", "quantile")),
    "at-most": (at_most, ("band", "limit"), ("mu", "beta", "response")),
    "no-stop": (no_stop, ("band",), ("mu",)),
    "stuck": (stuck, ("band",), ("mu",)),
    "margin": (margin, ("r", "beta"), ("mu",)),
}

#: Keys of the table `response`.
_OF_RESPONSE = ("quantity", "mass", "contact")

#: Questions that take a number of threads.
_THREADED = ("least-peak", "two-forces", "robust", "at-most")


@dataclass(frozen=True)
class Design:
    """A configuration of a design question."""

    title: str
    name: str  # of the file, without its ending
    text: str  # the TOML text used, overrides applied
    files: tuple[Path, ...]
    question: str
    ask: Callable[[], xr.Dataset]


def load_design(path: str | Path, overrides: Sequence[str] = (), threads: int | None = None) -> Design:
    """Read a configuration with a table [design], which contains the question; [grid] is not used.

    Raises
    ------
    InputError
        The file cannot be read or is not TOML; a key is unknown, missing or of the wrong type.  The message
        names the key.
    """
    tree, text = read_tree(path, overrides)
    path = Path(path)
    common = common_tables(tree, path)
    if "design" not in tree:
        raise InputError("the configuration must have a table [design]; got none")
    files = put_variants(tree.get("axes"), path.parent)
    axes = further_axes(tree)
    given = design_table(tree)
    try:
        question = checks.choice(given.get("question", QUESTIONS[0]), "question", QUESTIONS)
        arguments = _with_samples(question, _arguments(question, given), axes)
    except InputError as error:
        raise (within("design", error) if error.where else error) from None
    function = _FUNCTIONS[question][0]
    if question in _THREADED:
        arguments["threads"] = threads
    ask = partial(_call_question, function, common.system, {**arguments, "units": common.units})
    return Design(common.title, path.stem, text, (*common.files, *files), question, ask)


def _with_samples(question: str, arguments: dict[str, Any], axes: Mapping[str, Any] | None) -> dict[str, Any]:
    """Arguments with the samples of [axes] in the place of spread and quantile."""
    quantile = arguments.pop("quantile", None)
    if axes is None:
        if quantile is not None:
            raise InputError(
                "cannot use",
                "quantile",
                f"without [axes]: it is one over their samples; add [axes] or leave it out; got {quantile}",
            )
        return arguments
    if question != "robust":
        raise InputError(
            "question",
            f"must be robust in a configuration with [axes], whose points are samples; got {question}",
        )
    if "spread" in arguments:
        raise InputError(
            "cannot use",
            "spread",
            f"with [axes]: their samples take its place; leave one of them out; got {arguments['spread']}",
        )
    return {**arguments, "spread": Samples(axes) if quantile is None else Samples(axes, quantile)}


def _call_question(
    function: Callable[..., xr.Dataset], system: object, arguments: Mapping[str, Any]
) -> xr.Dataset:
    """Call the function of a question; errors name keys of the table."""
    try:
        return function(system, **arguments)
    except InputError as error:
        raise within("design.response" if error.where in _OF_RESPONSE else "design", error) from None


def _arguments(question: str, given: Mapping[str, Any]) -> dict[str, Any]:
    """Arguments of the function of a question, from the keys that it uses."""
    _, needed, optional = _FUNCTIONS[question]
    for key in needed:
        if key not in given:
            raise InputError(key, f"must be given for question {question}; got nothing")
    arguments = {key: given[key] for key in (*needed, *optional) if key in given}
    response = _response(arguments.pop("response", {}))
    return arguments | response


def _response(given: Any) -> dict[str, Any]:
    """The key `response`: a table, or the name of a quantity."""
    if isinstance(given, str):
        return {"quantity": given}
    if not isinstance(given, Mapping):
        raise InputError(
            "response", f"must be a table of {', '.join(_OF_RESPONSE)}; got {checks.one_line(given)}"
        )
    for key in given:
        if key not in _OF_RESPONSE:
            raise unknown_key(key, "design.response", _OF_RESPONSE)
    return dict(given)
