"""Wording: texts of the program use the words of the field, not the phrases of a short list.

The list gives a replacement for each phrase.  It is applied to README, manual, release notes, comments of
configurations, help texts, error messages and docstrings.
"""

import ast
import io
import re
import tokenize
from typing import NamedTuple

import pytest
from conftest import ROOT

from frictionmap.command_line.arguments import described

#: Phrase (regular expression, any case), and what to write instead.
BANNED = (
    (r"so and so (many|often|much)", "how many, how often; or the number"),
    (r"(tells?|told) (\w+ )?apart", "distinguish"),
    (r"(is|was|were|be|been|they are|that are|which are) told", "is reported, is stated; you are told"),
    (r"(tell|tells) (no|how|what|whether|which|where|when|why|only|as much)", "show, determine, state"),
    (r"of one that", "the noun: of a map that, of a cell that"),
    (
        r"what (is|are) (not|no|outdated|missing|thin|wrong|left|found|asked|known)",
        "the noun: missing blocks",
    ),
    (r"(is|are|be) (not )?whole", "complete; an integer; not damaged"),
    (r"numbers? that (is|are) not whole|broken numbers?", "non-integer number"),
    (r"from (it|beta\w*( = [\d.]+)?|mu|zeta|r) on", "at or above"),
    (r"(il)?legal", "valid, allowed; invalid"),
    (
        r"(stops?|turns?|slides?|times|samples|steps|periods?|cycles|points|nodes?|bytes|digits|characters|cells"
        r"|blocks|threads?|files?|lines?|values?|modes?|ns|µs|ms|s)"
        r" an? (cycle|period|cell|second|mode|host|worker|step|mass|frequency|process|machine|phase|fit)",
        "per: stops per cycle",
    ),
    (r"(stops?|slides?|turns?|times) in an? (cycle|period)", "per: stops per cycle"),
    (r"so many (?!that|as)\w+(?! that)", "the number; or: some"),
    (r"as (they|it) comes?", "leave it out, or name the cases"),
    (r"(will|would|might) do(?! \w)", "suffices, is enough"),
    (r"for good", "permanently"),
    (r"but for", "except for"),
    (r"ringed", "circled"),
    (r"in a blink", "the time"),
    (r"dear", "slow; expensive"),
    (r"half as (many|much|strong) again", "50 % more"),
    (r"without a word", "silently"),
    (r"at fault", "invalid; wrong"),
    (r"to be had", "available"),
    (r"held to (?!z)\w+", "checked against; limited to"),
    (r"mend(s|ed|ing)?", "fix, repair"),
    (r"the answer to a", "the response to; the result of"),
    (r"the start decides", "the result depends on the initial state"),
    (r"(must be .*|need not be .*) to go on", "cannot resume X: reason"),
    (r"goes? on with", "resumes, continues"),
    (r"what it comes down to", "for example; in short"),
    (r"in careless hands|bad days?", "invalid input; faults"),
    (r"put in words|in so narrow|by whose hand|the like of", "plain English"),
)

#: First words of docstrings that are fragments.
FRAGMENTS = r"(Of|Those of|That of|The same of|The same as|What of|Than)"


class Text(NamedTuple):
    """A text that people read."""

    place: str  # file, and the line where it begins
    text: str


class Finding(NamedTuple):
    """A phrase to be replaced."""

    place: str
    phrase: str
    instead: str


def compiled(pattern):
    """Whole words only; a space stands for any white space."""
    return re.compile(rf"(?<!\w)(?:{pattern.replace(' ', chr(92) + 's+')})(?!\w)", re.IGNORECASE)


PATTERNS = [(compiled(pattern), instead) for pattern, instead in BANNED]


def findings(texts):
    """All phrases of the list in some texts."""
    for place, text in texts:
        for pattern, instead in PATTERNS:
            for match in pattern.finditer(text):
                yield Finding(place, " ".join(match[0].split()), instead)


def report(found):
    return "\n".join(f"{place}: '{phrase}'; write: {instead}" for place, phrase, instead in found)


def prose(path):
    """Text of a Markdown page without code."""
    text = re.sub(r"^```.*?^```", "", path.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL)
    yield Text(str(path.relative_to(ROOT)), re.sub(r"`[^`\n]*\n?[^`\n]*`", "`code`", text))


def comments(path):
    """Comments of a TOML or Python file, without the marks."""
    source = path.read_text(encoding="utf-8")
    if path.suffix == ".py":
        tokens = tokenize.generate_tokens(io.StringIO(source).readline)
        found = [token.string.lstrip("#: %") for token in tokens if token.type == tokenize.COMMENT]
    else:
        found = re.findall(r"#\s?(.*)", source)
    yield Text(str(path.relative_to(ROOT)), "\n".join(found))


def messages(tree, place):
    """Literal parts of the arguments of `raise`."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Raise) and node.exc is not None:
            parts = [one for one in ast.walk(node.exc) if isinstance(one, ast.Constant)]
            text = " ".join(one.value for one in parts if isinstance(one.value, str))
            yield Text(f"{place}:{node.lineno}", text)


def docstrings(tree, place):
    for node in ast.walk(tree):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef):
            text = ast.get_docstring(node)
            if text:
                yield Text(f"{place}:{getattr(node, 'lineno', 1)}", text)


def python_texts(paths):
    """Docstrings and error messages of Python files."""
    for path in paths:
        tree, place = ast.parse(path.read_text(encoding="utf-8")), str(path.relative_to(ROOT))
        yield from docstrings(tree, place)
        yield from messages(tree, place)


def fragments(paths):
    """Docstrings that begin with a fragment."""
    for path in paths:
        tree = ast.parse(path.read_text(encoding="utf-8"))
        for place, text in docstrings(tree, str(path.relative_to(ROOT))):
            if re.match(rf"{FRAGMENTS}\b", text):
                yield Finding(place, text.splitlines()[0], "a verb or a noun phrase")


def package_parts():
    """Folders and modules right below frictionmap/."""
    root = ROOT / "frictionmap"
    return sorted(
        path.name
        for path in root.iterdir()
        if path.suffix == ".py" or (path.is_dir() and (path / "__init__.py").exists())
    )


def files_of(part):
    path = ROOT / "frictionmap" / part
    return sorted(path.rglob("*.py")) if path.is_dir() else [path]


def made(path):
    """Whether a build of the manual has made it."""
    return {"reference", "figures", "_build"} & set(path.relative_to(ROOT).parts)


PAGES = [
    *(ROOT / name for name in ("README.md", "CHANGELOG.md", "CONTRIBUTING.md")),
    *(
        path
        for path in sorted((ROOT / "docs").rglob("*.[mr][ds]*"))
        if not made(path) and path.suffix in (".md", ".rst")
    ),
]


@pytest.mark.parametrize("path", PAGES, ids=lambda path: path.name)
def test_pages(path):
    assert not report(findings(prose(path)))


def test_sources_of_the_manual():
    paths = [path for path in sorted((ROOT / "docs").rglob("*.py")) if not made(path)]
    texts = [*python_texts(paths), *(text for path in paths for text in comments(path))]
    assert not report([*findings(texts), *fragments(paths)])


def test_comments_of_configurations():
    paths = sorted((ROOT / "configs").rglob("*.toml"))
    assert paths
    assert not report(findings(text for path in paths for text in comments(path)))


def test_help():
    texts = [
        Text(f"frictionmap {command.name} --help", f"{command.description}\n{argument.help}")
        for command in described()
        for argument in command.arguments
    ]
    assert len(texts) > 40
    assert not report(findings(texts))


def test_benchmarks():
    paths = sorted((ROOT / "benchmarks").rglob("*.py"))
    assert not report([*findings(python_texts(paths)), *fragments(paths)])


@pytest.mark.parametrize("part", package_parts())
def test_docstrings_and_messages(part):
    found = [*findings(python_texts(files_of(part))), *fragments(files_of(part))]
    assert not report(found)


@pytest.mark.parametrize(
    ("text", "phrase"),
    [
        ("It stops so and so\noften.", "so and so often"),
        ("A value is told to the user.", "is told"),
        ("two stops a cycle", "stops a cycle"),
        ("It sticks for good.", "for good"),
        ("It must be legal.", "legal"),
        ("from beta_stick on it sticks", "from beta_stick on"),
    ],
)
def test_phrases_are_found(text, phrase):
    assert [found.phrase for found in findings([Text("here", text)])] == [phrase]


def test_words_of_the_field_are_not_found():
    text = "A mass slides for a good part of the cycle, so many stops that counting helps; you are told."
    assert list(findings([Text("here", text)])) == []


def test_messages_and_docstrings_are_read(tmp_path):
    source = 'def f():\n    """Those of a cell."""\n    raise ValueError(f"{1} is not legal", 2)\n'
    tree = ast.parse(source)
    assert [text.text for text in docstrings(tree, "f")] == ["Those of a cell."]
    assert [found.phrase for found in findings(messages(tree, "f"))] == ["legal"]
