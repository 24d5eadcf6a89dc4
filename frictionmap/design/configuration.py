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
from .questions import at_most, least_peak, margin, no_stop, robust, stuck
from .samples import Samples

#: Functions of the questions, the keys that each needs, and those that it may have.
_FUNCTIONS: dict[str, tuple[Callable[..., xr.Dataset], tuple[str, ...], tuple[str, ...]]] = {
    "least-peak": (least_peak, ("band",), ("mu", "beta", "response")),
    "robust": (robust, ("band",), ("mu", "beta", "response", "spread", "quantile")),
    "at-most": (at_most, ("band", "limit"), ("mu", "beta", "response")),
    "no-stop": (no_stop, ("band",), ("mu",)),
    "stuck": (stuck, ("band",), ("mu",)),
    "margin": (margin, ("r", "beta"), ("mu",)),
}

#: Keys of the table `response`.
_OF_RESPONSE = ("quantity", "mass", "contact")

#: Questions that take a number of threads.
_THREADED = ("least-peak", "robust", "at-most")


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
        arguments = _arguments(question, given, axes is not None)
        if axes is not None:
            arguments["spread"] = _samples(question, axes, given)
    except InputError as error:
        raise (error if str(error).startswith("unknown") else within("design", error)) from None
    function = _FUNCTIONS[question][0]
    if question in _THREADED:
        arguments["threads"] = threads
    ask = partial(_asked, function, common.system, {**arguments, "units": common.units})
    return Design(common.title, path.stem, text, (*common.files, *files), question, ask)


def _samples(question: str, axes: Mapping[str, Any], given: Mapping[str, Any]) -> Samples:
    """The samples of [axes], for the question that is about samples."""
    if question != "robust":
        raise InputError(
            "question must be robust in a configuration with [axes], whose points are samples; "
            f"got {question}"
        )
    if "spread" in given:
        raise InputError(
            f"spread must not be given beside [axes]: samples take its place; got {given['spread']}"
        )
    return Samples(axes, given["quantile"]) if "quantile" in given else Samples(axes)


def _asked(function: Callable[..., xr.Dataset], system: object, arguments: Mapping[str, Any]) -> xr.Dataset:
    """Call the function of a question; errors name keys of the table."""
    try:
        return function(system, **arguments)
    except InputError as error:
        inner = str(error).removeprefix("cannot use ").partition(" ")[0] in _OF_RESPONSE
        raise within("design.response" if inner else "design", error) from None


def _arguments(question: str, given: Mapping[str, Any], sampled: bool) -> dict[str, Any]:
    """Arguments of the function of a question, from the keys that it uses."""
    _, needed, optional = _FUNCTIONS[question]
    for key in needed:
        if key not in given:
            raise InputError(f"{key} must be given for question {question}; got nothing")
    arguments = {key: given[key] for key in (*needed, *optional) if key in given}
    response = _response(arguments.pop("response", {}))
    if arguments.pop("quantile", None) is not None and not sampled:
        raise InputError(f"quantile must go with samples in [axes]; got {given['quantile']} without them")
    return arguments | response


def _response(given: Any) -> dict[str, Any]:
    """The key `response`: a table, or the name of a quantity."""
    if isinstance(given, str):
        return {"quantity": given}
    if not isinstance(given, Mapping):
        raise InputError(
            f"response must be a table of {', '.join(_OF_RESPONSE)}; got {checks.one_line(given)}"
        )
    for key in given:
        if key not in _OF_RESPONSE:
            raise unknown_key(key, "design.response", _OF_RESPONSE)
    return dict(given)
