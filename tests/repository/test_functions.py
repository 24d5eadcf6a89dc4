"""Functions fit on a screen and take few arguments, or say why they take many."""

import ast
from pathlib import Path

import pytest

import frictionmap as fm

PACKAGE = Path(fm.__file__).parent
LONGEST = 60  # lines, docstring left out
MOST_ARGUMENTS = 10


def functions(text):
    nodes = ast.walk(ast.parse(text))
    return [node for node in nodes if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)]


def lines(function):
    """Lines from `def` to the end, without the docstring."""
    whole = function.end_lineno - function.lineno + 1
    if ast.get_docstring(function) is None:
        return whole
    return whole - (function.body[0].end_lineno - function.body[0].lineno + 1)


def arguments(function):
    taken = function.args
    rest = [argument for argument in (taken.vararg, taken.kwarg) if argument]
    return len(taken.posonlyargs) + len(taken.args) + len(taken.kwonlyargs) + len(rest)


def too_much(text):
    """Names of functions that are too long, or take many arguments and do not say why."""
    for function in functions(text):
        says_why = "arguments" in (ast.get_docstring(function) or "")
        if lines(function) > LONGEST or (arguments(function) > MOST_ARGUMENTS and not says_why):
            yield function.name


@pytest.mark.parametrize("path", sorted(PACKAGE.rglob("*.py")), ids=lambda path: path.name)
def test_functions_are_small(path):
    assert list(too_much(path.read_text(encoding="utf-8"))) == []


def test_large_functions_are_found():
    many = ", ".join(f"a{k}" for k in range(MOST_ARGUMENTS))
    why = '"""Eleven arguments: so that one is one too many."""'
    body = "\n    pass" * (LONGEST - 1)
    text = f'def f({many}):\n    """A line."""{body}\n'
    assert list(too_much(text)) == []
    assert list(too_much(f"{text}    pass\n")) == ["f"]
    assert list(too_much(f"def g({many}, *rest): {body}")) == ["g"]
    assert list(too_much(f"def h({many}, b):\n    {why}\n")) == []
