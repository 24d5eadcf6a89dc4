"""What README and guides show runs, type checkers agree with README, links lead somewhere."""

import importlib.util
import os
import re
import shlex
import subprocess
import sys

import pytest
from conftest import ROOT

from frictionmap.command_line.arguments import parse

TEXT = (ROOT / "README.md").read_text(encoding="utf-8")
GUIDES = [path for path in sorted((ROOT / "docs").rglob("*.md")) if path.parent.name != "reference"]


def blocks(text):
    """Language and text of every block of code."""
    return re.findall(r"^```(\w*)\n(.*?)^```", text, re.MULTILINE | re.DOTALL)


BLOCKS = blocks(TEXT)
CODE = "\n".join(text for language, text in BLOCKS if language == "python")

#: More than a test has time for, and what stands in its place: a film of four frames, four samples.
SHORTER = {
    "figures.md": ("fm.animate(motion, seconds=4, fps=20)", "fm.animate(motion, seconds=0.2, fps=20)"),
    "choosing-friction.md": ("random.normal(1.0, 0.05, 20)", "random.normal(1.0, 0.05, 4)"),
}

#: Slips that a type checker has to find, each in place of what the README says.
SLIPS = {
    "a setting": ("outputs=[", "output=["),
    "an output": ('"also_reachable"', '"also_reachble"'),
    "a contact": ('"between-masses"', '"between_masses"'),
    "an argument": ("damping_ratios=0.01\n)\nevery", "damping_ratio=0.01\n)\nevery"),
    "a start": ("mu=1.2,", 'mu=1.2, start="moveing",'),
    "a name": ("fm.boundaries", "fm.boundarys"),
    "a system": ("fm.response(system", "fm.response(ds"),
}


def commands(shown):
    """Command lines of frictionmap in blocks that are not Python, without their comments."""
    for language, text in shown:
        if language in ("", "sh"):
            for line in text.splitlines():
                for part in line.partition("#")[0].split("&&"):
                    words = shlex.split(part.partition(">")[0])
                    if words and words[0].split("/")[-1] == "frictionmap":
                        yield words[1:]


def test_python_blocks_run(tmp_path):
    """In order, in one program, in an empty folder."""
    assert CODE.count("import frictionmap as fm") == 1
    run_python(CODE, tmp_path)
    assert (tmp_path / "map.png").stat().st_size > 1000


def test_python_blocks_of_guides_run(tmp_path):
    """Those of a page in order; those that need another package are left out."""
    codes = {path.name: "\n".join(python_of(path)) for path in GUIDES}
    for name, (shown, shorter) in SHORTER.items():
        assert codes[name].count(shown) == 1
        codes[name] = codes[name].replace(shown, shorter)
    (tmp_path / "configs").symlink_to(ROOT / "configs")  # guides read configurations of the repository
    programs = [code for code in codes.values() if code and "dask_jobqueue" not in code]
    assert len(programs) >= 3
    code = "\n".join(f"exec(compile({code!r}, '<guide>', 'exec'), {{}})" for code in programs)
    run_python(code, tmp_path)


def python_of(path):
    return [text for language, text in blocks(path.read_text(encoding="utf-8")) if language == "python"]


def run_python(code, folder):
    """Run a program in a folder; a warning is an error."""
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", code],
        cwd=folder,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        timeout=6000,
    )
    assert done.returncode == 0, done.stderr


def test_command_lines_parse():
    found = list(commands(BLOCKS))
    assert {words[0] for words in found} >= {"init", "map", "response", "plot", "info"}
    for path in GUIDES:
        found += commands(blocks(path.read_text(encoding="utf-8")))
    assert ["--version"] in found  # it ends the program while it is parsed
    for words in found:
        if words != ["--version"]:
            assert parse(words).command == words[0]


def test_shell_blocks_are_shell():
    texts = [text for language, text in BLOCKS if language == "sh"]
    assert texts
    for text in texts:
        assert subprocess.run(["sh", "-n"], input=text, text=True).returncode == 0, text


def test_links_lead_somewhere():
    """To files; pages that are made when the manual is built, and addresses, are left out."""
    for path in (ROOT / "README.md", *GUIDES):
        for target in re.findall(r"\]\(([^)#]+)[^)]*\)", path.read_text(encoding="utf-8")):
            made = re.match(r"(\.\./)?(reference|figures)/", target)
            assert made or "://" in target or (path.parent / target).is_file(), f"{path.name}: {target}"


def errors(checker, programs, folder):
    """Lines in which a type checker, at its strictest, finds errors, for each of the programs by name."""
    for name, code in programs.items():
        (folder / name).write_text(code)
    if checker == "mypy":
        options = ["--strict", "--follow-imports=silent", "--config-file=", "--cache-dir=.mypy"]
    else:
        (folder / "pyrightconfig.json").write_text(
            f'{{"typeCheckingMode": "strict", "extraPaths": ["{ROOT}"]}}'
        )
        options = ["--pythonpath", sys.executable]
    done = subprocess.run(
        [sys.executable, "-m", checker, *options, *programs],
        cwd=folder,
        env=os.environ | {"MYPYPATH": str(ROOT), "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        timeout=6000,
    )
    assert done.returncode in (0, 1), done.stdout + done.stderr
    found = {
        name: [
            int(line.partition(f"{name}:")[2].split(":")[0])
            for line in done.stdout.splitlines()
            if re.search(r"\berror\b", line) and f"{name}:" in line
        ]
        for name in programs
    }
    assert any(found.values()) == bool(done.returncode), done.stdout
    return found


@pytest.mark.parametrize("checker", ["mypy", "pyright"])
def test_type_checkers_accept_the_code_and_find_slips(checker, tmp_path):
    if importlib.util.find_spec(checker) is None:
        pytest.skip(f"{checker} is not installed")
    code = CODE
    for right, wrong in SLIPS.values():
        assert right in CODE
        code = code.replace(right, wrong, 1)
    found = errors(checker, {"shown.py": CODE, "slipped.py": code}, tmp_path)
    assert found["shown.py"] == []
    changed = {
        number
        for number, (one, other) in enumerate(zip(CODE.splitlines(), code.splitlines(), strict=True), 1)
        if one != other
    }
    assert changed <= set(found["slipped.py"])


def test_tests_find_reference_data_through_their_fixture_only():
    """What lies beside a clone is not in it: whatever else looked there would fail in the reader's clone."""
    elsewhere = re.compile(r"FRICTIONMAP_" r"REFERENCE|\bROOT\.parent")
    for path in sorted((ROOT / "tests").rglob("*.py")):
        if path.name != "conftest.py":
            assert not elsewhere.search(path.read_text(encoding="utf-8")), path.name


def test_tests_of_reference_data_carry_the_marker(request):
    """By it the others can be run alone."""
    for item in request.session.items:
        wants = "reference_path" in getattr(item, "fixturenames", ())
        assert wants == (item.get_closest_marker("reference") is not None), item.nodeid
