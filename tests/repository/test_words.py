"""Wording: texts of the program use the words of the field, not the phrases of a short list.

The list gives a replacement for each phrase.  It is applied to README, manual, release notes, paper, comments
of configurations, help texts, error messages, docstrings, labels of variables and other texts of the program,
the page in the browser, and docstrings of tests.  Two more lists are of names: of tests and of functions.
"""

import ast
import functools
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
    (r"(one|numbers?|few) an? (cycle|period|mode|mass|contact)", "per: one per mode"),
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

#: Words of names of tests (regular expression), and what to write instead.
WORDS_OF_TESTS = (
    (r"says?|tells?", "states, reports, shows, determines"),
    (r"told", "reported, stated, shown, distinguished"),
    (r"beside", "next to, near, with"),
    (r"so and so", "how many, how often"),
    (r"for good", "permanently"),
    (r"goes on|to go on", "resumes, continues"),
    (r"(il)?legal", "valid, invalid"),
    (r"(is|are) whole", "complete, undamaged"),
    (r"dear", "slow, expensive"),
)

#: Names of functions that do not state what they return or do (regular expression), and what to write.
NAMES_OF_FUNCTIONS = (
    (r"_?(\w+_)?(told|asked)", "describe_x, x_warnings, as_config"),
    (r"_?(in_)?words", "describe, describe_x"),
    (r"_?(tamed|tempered)", "winsorised, inflate_errors"),
    (r"_?(solved|improved|sharpened|refitted)", "solve_x, refine_x, fit_again"),
    (r"_?(beside|reach)", "the noun: residual, limit, neighbours"),
    (r"_of_\w+", "the noun first: peak_rows, fit_warnings"),
    (r"_in_(one|what\w*|order|short|rows|columns|time|units|file|sight)", "the verb or the noun first"),
    (
        r"_?(by_holding|hold_some|let_go|settle_for_less|forget_orbits|keep_state|bring_back)",
        "verb and object",
    ),
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
TEST_PATTERNS = [(compiled(pattern), instead) for pattern, instead in WORDS_OF_TESTS]


@functools.cache
def tree_of(path):
    return ast.parse(path.read_text(encoding="utf-8"))


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
        tree, place = tree_of(path), str(path.relative_to(ROOT))
        yield from docstrings(tree, place)
        yield from messages(tree, place)


def texts_within(tree, place):
    """Texts of more than two words in code: labels, comments in files, lines that are printed."""
    parts = {
        id(part) for node in ast.walk(tree) if isinstance(node, ast.JoinedStr) for part in ast.walk(node)
    }
    for node in ast.walk(tree):
        if isinstance(node, ast.JoinedStr):
            text = "".join(part.value if isinstance(part, ast.Constant) else "{}" for part in node.values)
        elif isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in parts:
            text = node.value
        else:
            continue
        if len(text.split()) > 2:
            yield Text(f"{place}:{node.lineno}", text)


#: Comments and texts of a script.
SCRIPT = re.compile(
    r"""//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])*'|`(?:\\.|[^`\\])*`""", re.DOTALL
)


def script_texts(source, place):
    """Comments and texts of a script; the marks of comments are left out."""
    for match in SCRIPT.finditer(source):
        line = source.count("\n", 0, match.start()) + 1
        yield Text(f"{place}:{line}", re.sub(r"\n\s*\*", " ", match[0]))


def page_texts(path):
    """Texts of a file of the page: of a script, or all of a style sheet or of HTML."""
    source, place = path.read_text(encoding="utf-8"), str(path.relative_to(ROOT))
    return script_texts(source, place) if path.suffix == ".js" else [Text(place, source)]


def functions(paths):
    """Names of functions, and where they are."""
    for path in paths:
        for node in ast.walk(tree_of(path)):
            if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
                yield Text(f"{path.relative_to(ROOT)}:{node.lineno}", node.name)


def names_of_tests(names):
    """Words of names of tests that are to be replaced."""
    for place, name in names:
        for pattern, instead in TEST_PATTERNS:
            for match in pattern.finditer(name.replace("_", " ") if name.startswith("test_") else ""):
                yield Finding(place, match[0], instead)


def names_of_functions(names):
    """Names of functions that are to be replaced."""
    for place, name in names:
        for pattern, instead in NAMES_OF_FUNCTIONS:
            if re.fullmatch(pattern, name):
                yield Finding(place, name, instead)


def fragments(paths):
    """Docstrings that begin with a fragment."""
    for path in paths:
        tree = tree_of(path)
        for place, text in docstrings(tree, str(path.relative_to(ROOT))):
            if re.match(rf"{FRAGMENTS}\b", text):
                yield Finding(place, text.splitlines()[0], "a verb or a noun phrase")


PACKAGE = sorted((ROOT / "frictionmap").rglob("*.py"))


def made(path):
    """Whether a build of the manual has made it."""
    return {"reference", "figures", "_build"} & set(path.relative_to(ROOT).parts)


PAGES = [
    *(ROOT / name for name in ("README.md", "CHANGELOG.md", "CONTRIBUTING.md", "SECURITY.md")),
    *sorted((ROOT / "paper").rglob("*.md")),
    *(
        path
        for path in sorted((ROOT / "docs").rglob("*.[mr][ds]*"))
        if not made(path) and path.suffix in (".md", ".rst")
    ),
]


def test_pages():
    assert len(PAGES) > 20
    assert not report(findings(text for path in PAGES for text in prose(path)))


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


def test_docstrings_and_messages():
    assert not report([*findings(python_texts(PACKAGE)), *fragments(PACKAGE)])


def test_further_texts():
    """Labels of variables, comments in files, lines that are printed; comments of the code."""
    for path in PACKAGE:
        tree = tree_of(path)
        assert not report(findings([*texts_within(tree, path.relative_to(ROOT)), *comments(path)]))


def test_names_of_functions():
    assert not report(names_of_functions(functions(PACKAGE)))


def test_citation():
    assert not report(findings([Text("CITATION.cff", (ROOT / "CITATION.cff").read_text(encoding="utf-8"))]))


PAGE = sorted(path for path in (ROOT / "frictionmap").rglob("*.*") if path.suffix in (".js", ".html", ".css"))


def test_page():
    assert len(PAGE) > 10
    assert not report(findings(text for path in PAGE for text in page_texts(path)))


def test_names_of_tests():
    paths = sorted((ROOT / "tests").rglob("*.py"))
    assert not report(names_of_tests(functions(paths)))


def test_docstrings_of_tests():
    paths = sorted((ROOT / "tests").rglob("*.py"))
    found = (one for path in paths for one in findings(docstrings(tree_of(path), path.relative_to(ROOT))))
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


def test_texts_within_code_are_read():
    source = 'LABEL = "it rests for good"\nOTHER = f"a {LABEL} b {1} c"\nSHORT = "for good"\n'
    texts = list(texts_within(ast.parse(source), "f"))
    assert texts == [Text("f:1", "it rests for good"), Text("f:2", "a {} b {} c")]


def test_scripts_are_read():
    script = (
        "/** It sticks\n * for good. */\nconst legal = `a ${1} dear`; // is told\n"
        "f(\"so and so often\", 'so many x');\n"
    )
    found = [one.phrase for text in script_texts(script, "a.js") for one in findings([text])]
    assert found == ["for good", "dear", "is told", "so and so often", "so many x"]


def test_names_are_found():
    names = [Text("f", name) for name in ("test_it_says_so", "says", "test_essays", "test_sticks_for_good")]
    assert [found.phrase for found in names_of_tests(names)] == ["says", "for good"]
    names = [Text("f", name) for name in ("_of_peaks", "mu_told", "words", "reached", "describe", "_rows_of")]
    assert [found.phrase for found in names_of_functions(names)] == ["_of_peaks", "mu_told", "words"]
