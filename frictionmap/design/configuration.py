"""The table [design] of a configuration: which question, and its arguments."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from inspect import signature
from pathlib import Path
from typing import Any

import xarray as xr

from .. import checks
from ..datasets.questions import record, records
from ..errors import InputError
from ..files.config import common_tables, design_table, further_axes, read_tree, unknown_key, within
from ..files.key import describe_values, fits
from ..files.variants import put_variants
from ..units.axes import needs
from ..units.dimensions import OF_DESIGN, wanted_axes
from ..units.scales import Wanted, scales_of
from .questions.record import Question
from .samples import Samples

#: Keys of the table `response`.
_OF_RESPONSE = ("quantity", "mass", "contact")


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
    common = common_tables(tree, path, [*_wanted(tree), *wanted_axes(tree.get("axes", {}))])
    if "design" not in tree:
        of_records = "; under records use fm.design.least_median in Python" if "record" in tree else ""
        raise InputError(f"the configuration must have a table [design]; got none{of_records}")
    files = put_variants(tree.get("axes"), path.parent)
    scales = scales_of(common.units, common.system)
    scales.require(_wanted(tree))
    axes = further_axes(tree, scales)
    given = design_table(tree)
    try:
        names = tuple(one.name for one in records())
        question = record(checks.choice(given.get("question", names[0]), "question", names))
        arguments = _with_samples(question.name, _arguments(question, given), axes)
    except InputError as error:
        raise (within("design", error) if error.where else error) from None
    if "threads" in signature(question.function).parameters:
        arguments["threads"] = threads
    ask = partial(_call_question, question.function, common.system, {**arguments, "units": common.units})
    return Design(common.title, path.stem, text, (*common.files, *files), question.name, ask)


def _wanted(tree: Mapping[str, Any]) -> list[Wanted]:
    """The numbers with units of [design]."""
    given = design_table(tree)
    response = given.get("response")
    quantity = response.get("quantity") if isinstance(response, Mapping) else response
    kinds = OF_DESIGN | ({"limit": "force"} if quantity == "transmitted_force" else {})
    return [one for key, kind in kinds.items() for one in needs(given.get(key), f"design.{key}", kind)]


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


def _arguments(question: Question, given: Mapping[str, Any]) -> dict[str, Any]:
    """Arguments of the function of a question, from the keys that it uses."""
    for key in question.needed:
        if key.name not in given:
            raise InputError(key.name, f"must be given for question {question.name}; got nothing")
    names = [key.name for key in (*question.needed, *question.optional)]
    _check_others(names, given)
    arguments = {name: given[name] for name in names if name in given}
    response = _response(arguments.pop("response", {}))
    return arguments | response


def _check_others(used: Sequence[str], given: Mapping[str, Any]) -> None:
    """Refuse invalid values of keys that the question does not use: they are there for another one."""
    keys = {key.name: key for one in records() for key in (*one.needed, *one.optional)}
    for name, value in given.items():
        if name in keys and name not in used and not fits(value, keys[name].valid):
            raise InputError(name, f"must be {describe_values(keys[name])}; got {checks.one_line(value)}")


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
