"""The reference of the Python API: every public name is in one group, and has an example that runs."""

import doctest
import inspect
import sys
from collections import Counter

import pytest
from conftest import ROOT

import frictionmap as fm

sys.path.append(str(ROOT / "docs"))
import generated

NAMES = generated.public_names()

#: Examples that are shown only: a film, questions that take minutes.
SHOWN_ONLY = {"animate", "design.no_separation", "design.two_forces"}

#: Examples that take seconds: of design questions, which search over maps.
SLOW = ("design.",)


def found(name):
    """What a public name stands for."""
    value = fm
    for part in name.split("."):
        value = getattr(value, part)
    return value


def example(name):
    """The example in the docstring of a public name."""
    text = inspect.getdoc(found(name)) or ""
    return doctest.DocTestParser().get_doctest(text, {}, name, None, 0)


def test_every_public_name_is_in_one_group():
    public = {name for name in fm.__all__ if callable(getattr(fm, name))}
    for module in ("design", "features", "identify", "regimes"):
        space = found(module)
        public |= {f"{module}.{name}" for name in space.__all__ if callable(getattr(space, name))}
    assert Counter(NAMES) == Counter(public)


@pytest.mark.parametrize("name", NAMES)
def test_every_public_name_has_an_example_with_output(name):
    shown = example(name).examples
    assert shown
    skipped = [one for one in shown if one.options.get(doctest.SKIP)]
    assert bool(skipped) == (name in SHOWN_ONLY)
    if not skipped:
        assert any(one.want for one in shown)


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.slow if name.startswith(SLOW) else ()) for name in NAMES]
)
def test_example_prints_what_it_shows(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    said = []
    runner = doctest.DocTestRunner(verbose=False)
    runner.run(example(name), out=said.append)
    assert runner.summarize(verbose=False).failed == 0, "".join(said)
