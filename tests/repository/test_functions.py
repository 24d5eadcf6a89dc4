"""Functions fit on a screen and take few arguments, or describe each of them."""

import ast
import re
from pathlib import Path

import frictionmap as fm

PACKAGE = Path(fm.__file__).parent
LONGEST = 60  # lines, docstring left out
MOST_ARGUMENTS = 10

#: Kernels have no type annotations: with more arguments than this each is described.
MOST_OF_A_KERNEL = 6


#: Modules of kernels; those that compile them have annotations.
KERNELS = sorted(path for path in (PACKAGE / "_kernels").rglob("*.py") if path.parent.name != "compiler")


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


def names(function):
    taken = function.args
    extra = [argument for argument in (taken.vararg, taken.kwarg) if argument]
    return {argument.arg for argument in (*taken.posonlyargs, *taken.args, *taken.kwonlyargs, *extra)}


def described(function):
    """Names of the arguments in the Parameters section of a docstring."""
    _, _, section = (ast.get_docstring(function) or "").partition("Parameters\n----------\n")
    found = set()
    for line in section.split("\n\n")[0].splitlines():
        for part in [] if line.startswith(" ") else line.split(";"):
            named = re.match(r"\s*([\w, ]+) : ", part)
            found |= {name.strip() for name in named[1].split(",")} if named else set()
    return found


def too_much(text):
    """Names of functions that are too long, or take many arguments and do not describe them."""
    for function in functions(text):
        many = arguments(function) > MOST_ARGUMENTS and not names(function) <= described(function) | {
            "settings"
        }
        if lines(function) > LONGEST or many:
            yield function.name


def undescribed(text):
    """Names of kernels that take many arguments and do not describe exactly these."""
    for function in functions(text):
        if arguments(function) > MOST_OF_A_KERNEL and described(function) != names(function):
            yield function.name


def found_in(paths, rule):
    """(file, name) of all that breaks a rule."""
    return [(path.name, name) for path in paths for name in rule(path.read_text(encoding="utf-8"))]


def test_functions_are_small():
    assert found_in(sorted(PACKAGE.rglob("*.py")), too_much) == []


def test_kernels_describe_many_arguments():
    assert len(KERNELS) > 70
    assert found_in(KERNELS, undescribed) == []


def test_undescribed_arguments_are_found():
    section = "Parameters\n    ----------\n    {}a, b, c : numbers; d : (n,)\n    e, f : texts\n    "
    docstring = f'"""A line.\n\n    {section}"""'
    text = "def k(a, b, c, d, e, f, g):\n    " + docstring
    assert list(undescribed(text.format("g : 1 or\n        x : 2\n    "))) == []
    assert list(undescribed(text.format(""))) == ["k"]
    assert list(undescribed(text.format("g, h : numbers\n    "))) == ["k"]
    assert list(undescribed("def k(a, b, c, d, e, f, g): pass")) == ["k"]
    assert list(undescribed("def k(a, b, c, d, e, f): pass")) == []


def test_large_functions_are_found():
    many = ", ".join(f"a{k}" for k in range(MOST_ARGUMENTS))
    why = f'"""A line.\n\n    Parameters\n    ----------\n    {many}, b : numbers\n    """'
    body = "\n    pass" * (LONGEST - 1)
    text = f'def f({many}):\n    """A line."""{body}\n'
    assert list(too_much(text)) == []
    assert list(too_much(f"{text}    pass\n")) == ["f"]
    assert list(too_much(f"def g({many}, *rest): {body}")) == ["g"]
    assert list(too_much(f"def h({many}, b):\n    {why}\n")) == []
