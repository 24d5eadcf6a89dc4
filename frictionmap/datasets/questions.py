"""Design questions by their records, for all places that list them.

A question is a file of `design/questions`, which computes its answer and describes it.  The tables of
labels, of keys and of pictures are made of these records.  They stand above them, so that nothing but this
module imports from below, and not before the records are asked for.
"""

from functools import cache
from importlib import import_module
from typing import Any


@cache
def records() -> tuple[Any, ...]:
    """The records of all questions, in the order of menus: `design.questions.record.Question`."""
    return import_module("frictionmap.design.questions").RECORDS


def record(name: str) -> Any:
    """The record of a question."""
    return next(one for one in records() if one.name == name)
