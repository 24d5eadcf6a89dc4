"""The command of the benchmarks, the committed results, and how the manual quotes them."""

import ast
import json
import math
import re
import subprocess
import sys
import tomllib
from importlib.metadata import PackageNotFoundError, packages_distributions, requires
from itertools import pairwise

import numpy as np
import pytest
from conftest import ROOT
from measuring import WITHOUT_FIGURE, python, spreads

import benchmarks.__main__ as command
from benchmarks.__main__ import BENCHMARKS
from benchmarks.measures import first_minute, histories
from benchmarks.peers.shaken import ScipyShaken
from benchmarks.report import quoting, record, results_page

RESULTS = ROOT / "benchmarks" / "results"

#: Benchmarks without timings.
UNTIMED = {"stress", "steady", "coupling", "consistency", "second_starts"}


def test_what_is_no_number_is_saved_as_none(tmp_path):
    content = {"a": [1.5, math.nan], "b": {"c": (math.inf, np.float64("nan"), 2)}, "d": "nan"}
    path = record.save("name", content, tmp_path)
    saved = json.loads(path.read_text(), parse_constant=pytest.fail)
    assert {name: saved[name] for name in content} == {
        "a": [1.5, None],
        "b": {"c": [None, None, 2]},
        "d": "nan",
    }


def test_a_whole_result_of_this_commit_and_machine_is_kept(tmp_path, monkeypatch):
    monkeypatch.setattr(record, "commit", lambda: "0123456789")
    assert not record.kept("name", tmp_path)
    record.save("name", {"seconds": [1.0]}, tmp_path)
    assert not record.kept("name", tmp_path)  # perhaps cut off
    record.complete("name", tmp_path, 4.0, True)
    assert not record.kept("name", tmp_path)  # the quick form
    record.complete("name", tmp_path, 90.0, False)
    assert record.kept("name", tmp_path)
    assert json.loads((tmp_path / "name.json").read_text())["seconds"] == [1.0]
    monkeypatch.setattr(record, "PACKAGES", (*record.PACKAGES, "matplotlib"))
    assert not record.kept("name", tmp_path)  # other packages than those that were measured


@pytest.mark.parametrize("commit", ["abcdef0123", "0123456789+", None])
def test_a_result_of_another_or_a_changed_commit_is_measured_again(commit, tmp_path, monkeypatch):
    monkeypatch.setattr(record, "commit", lambda: "0123456789" if commit == "abcdef0123" else commit)
    record.save("name", {}, tmp_path)
    record.complete("name", tmp_path, 90.0, False)
    monkeypatch.setattr(record, "commit", lambda: commit)
    assert not record.kept("name", tmp_path)


def test_a_result_that_a_kill_cut_off_is_measured_again(tmp_path):
    path = record.save("name", {"seconds": [1.0]}, tmp_path)
    record.complete("name", tmp_path, 90.0, False)
    path.write_text(path.read_text()[:-20])
    assert not record.kept("name", tmp_path)


def git(folder, *arguments):
    names = ("-c", "user.name=a", "-c", "user.email=a@b")
    subprocess.run(["git", "-C", str(folder), *names, *arguments], check=True, capture_output=True)


def test_the_commit_of_a_result_shows_whether_its_files_were_changed(tmp_path, monkeypatch):
    monkeypatch.setattr(record, "ROOT", tmp_path)
    assert record.commit() is None
    for name in ("frictionmap/a.py", "benchmarks/results/a.json", "docs/results.md"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text("1\n")
    git(tmp_path, "init")
    git(tmp_path, "add", ".")
    git(tmp_path, "commit", "-m", "a")
    clean = record.commit()
    assert re.fullmatch("[0-9a-f]{10}", clean)
    for name in ("benchmarks/results/a.json", "docs/results.md"):  # what a run writes
        (tmp_path / name).write_text("2\n")
    assert record.commit() == clean
    (tmp_path / "frictionmap/a.py").write_text("2\n")
    assert record.commit() == f"{clean}+"


def test_results_of_different_commits_are_marked(tmp_path):
    for name, commit in (("startup", "0123456789"), ("banks", "abcdef0123")):
        content = json.loads((RESULTS / f"{name}.json").read_text())
        (tmp_path / f"{name}.json").write_text(json.dumps({**content, "commit": commit}))
    text = results_page.block(tmp_path)
    assert "different commits" in text
    assert "startup: 0123456789; banks: abcdef0123" in text
    (tmp_path / "banks.json").unlink()
    assert "busy" not in results_page.block(tmp_path)
    content = json.loads((tmp_path / "startup.json").read_text())
    content["machine"]["load"] = 5.0 * content["machine"]["processors"]
    (tmp_path / "startup.json").write_text(json.dumps(content))
    assert "**Measured on a busy machine:** startup." in results_page.block(tmp_path)
    assert "All tables are of commit 0123456789" in results_page.block(tmp_path)


def test_several_benchmarks_continue_with_what_is_missing(monkeypatch, tmp_path, capsys):
    taken = {"laws": 3.0, "banks": math.nan}  # the second fails, and the third runs all the same
    monkeypatch.setattr(command, "kept", lambda name, _: name == "peers")
    monkeypatch.setattr(command, "_run_apart", lambda name, _: taken.get(name, 5.0))
    monkeypatch.setattr(command.signal, "signal", lambda *_: None)
    found = command._run_all(["peers", "laws", "banks", "spectrum"], tmp_path)
    assert list(found) == ["laws", "banks", "spectrum"]
    said = capsys.readouterr().out.splitlines()
    assert said[0] == "measured on this commit and machine before: peers"
    assert said[1].endswith(f"about {-(-sum(BENCHMARKS[name] for name in found) // 60)} min")
    assert sum(" of 3, about " in line for line in said) == 3


def test_all_benchmarks_take_at_most_an_hour_and_a_half():
    assert sum(BENCHMARKS.values()) <= 5400


def named(requirement):
    """Name of a distribution, in the form in which names are compared, and the extras that are asked for."""
    name, extras = re.match(r"([\w.-]+)(?:\[([\w,-]+)\])?", requirement).groups()
    return re.sub(r"[-_.]+", "-", name).lower(), set((extras or "").split(",")) - {""}


def installed_with(extra):
    """Names of the distributions that `pip install '.[extra]'` installs, by what is installed here."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    waiting = [*project["dependencies"], *project["optional-dependencies"][extra]]
    found = set()
    while waiting:
        name, extras = named(waiting.pop())
        if name == "frictionmap":
            waiting += [one for more in extras for one in project["optional-dependencies"][more]]
        elif name not in found:
            found.add(name)
            try:
                waiting += [one for one in requires(name) or [] if "extra ==" not in one]
            except PackageNotFoundError:
                continue
    return found


#: Distributions that are imported by another name and may not be installed here.
OTHER_NAMES = {"sksundae": "scikit-sundae", "pyHarm": "pyharm-os"}


def imported(path):
    """Names of the packages that a module imports, also inside functions and by `import_module`."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and not node.level:
            yield node.module
        elif isinstance(node, ast.Call) and ast.unparse(node.func).endswith("import_module"):
            name = node.args[0]
            yield from [name.value] if isinstance(name, ast.Constant) else []


def test_the_extra_installs_what_benchmarks_use():
    """Their imports, and the extras of the package itself: stores, and workers."""
    there, distributions = installed_with("benchmarks"), packages_distributions()
    own = {"benchmarks", "frictionmap", *sys.stdlib_module_names}
    for path in sorted((ROOT / "benchmarks").rglob("*.py")):
        text = path.read_text(encoding="utf-8")
        used = {name.split(".")[0] for name in imported(path)} - own
        wanted = [distributions.get(name, [OTHER_NAMES.get(name, name)]) for name in used]
        wanted += [["zarr"]] * (".zarr" in text or "frictionmap.stores" in text)
        wanted += [["distributed"]] * ('"--workers"' in text)
        for names in wanted:
            assert {named(name)[0] for name in names} & there, (path.name, names)


def test_a_benchmark_is_imported_only_when_it_is_asked_for():
    code = (
        "import sys, benchmarks.__main__; "
        "print([name for name in sys.modules if name.partition('.')[0] == 'frictionmap'])"
    )
    assert python("-c", code) == "[]\n"


def test_what_can_be_asked_for():
    said = python("-m", "benchmarks", "--help")
    assert all(name in said for name in (*BENCHMARKS, "all", "page", "--quick"))


# The committed results


def test_the_manual_quotes_the_committed_results():
    _, quoted, _ = results_page.parts(results_page.PAGE.read_text(encoding="utf-8"))
    assert quoted == results_page.block(RESULTS), "run python -m benchmarks page"


def test_there_is_no_timing_outside_the_quoted_results():
    before, _, after = results_page.parts(results_page.PAGE.read_text(encoding="utf-8"))
    before += (ROOT / "README.md").read_text(encoding="utf-8")
    units = {"ns", "us", "µs", "ms", "s", "seconds"}
    words = [word.strip("().,;:|") for word in f"{before} {after}".split()]
    for number, unit in pairwise(words):
        timing = number.replace(".", "").replace(",", "").isdigit() and unit in units
        assert not timing, f"{number} {unit}"


def test_committed_results_are_complete():
    assert len(results_page.QUOTED) > 10
    for name in results_page.QUOTED:
        content = json.loads((RESULTS / f"{name}.json").read_text())
        assert {"processor", "system", "python", "versions"} <= set(content["machine"]), name
        assert spreads(content) or name in UNTIMED, name
        assert (RESULTS / f"{name}.png").is_file() == (name not in WITHOUT_FIGURE), name


def test_committed_results_are_of_full_runs():
    accuracy, stress, steady = (
        json.loads((RESULTS / f"{name}.json").read_text()) for name in ("accuracy", "stress", "steady")
    )
    assert accuracy["random cells"]["cells"] >= 20_000
    assert "marched, cycles = 10^6" in stress["groups"]
    assert stress["random cells"]["wanted"] >= 200_000
    assert steady["mu = 1, any start"]["resolved by all three"] >= 10_000


def test_committed_peers_had_our_answers():
    content = json.loads((RESULTS / "peers.json").read_text())
    for entry in content["cells"].values():
        if "differences" in entry:
            assert entry["differences"]["cells with other stop counts"] == 0
    for entry in content["solved and marched"].values():
        for one in entry.values() if isinstance(entry, dict) else ():
            assert one["cells with other stop counts"] == 0


def test_committed_general_solvers_had_our_answers():
    content = json.loads((RESULTS / "general.json").read_text())
    for entry in content["other solvers"].values():
        for name in ("solve_ivp DOP853", "heyoka"):
            point = entry["methods"][name]["points"][-1]  # its most accurate setting
            assert point["cells with other stop counts"] == point["cells that failed"] == 0
            assert max(point["relative errors of ranges"]) < 1e-8
    medians = [point["median relative error of Z"] for point in content["harmonic balance"]["points"]]
    assert medians == sorted(medians, reverse=True)


def test_committed_histories_had_our_answers():
    """heyoka agrees to rounding; Newmark's method converges to the elastic contact as its step squared."""
    content = json.loads((RESULTS / "histories.json").read_text())
    for scene in content["scenes"].values():
        found = scene["other solvers"]
        assert found["heyoka"]["points"][-1]["error"] < 1e-11
        for stiffness in (3, 30, 1000):
            errors = [point["error"] for point in found[f"OpenSeesPy, kt/k_1 = {stiffness}"]["points"]]
            assert all(coarse / fine > 8.0 for coarse, fine in pairwise(errors[1:]))


@pytest.mark.parametrize("masses", [1, 2])
def test_a_solver_with_events_has_our_history(masses):
    given = histories.body(masses, histories.PEAK * histories.noise(61))
    _, expected = histories.ours(given, None, 1)
    found = ScipyShaken(given, 1e-11).run()
    assert histories.difference(found, expected) < 1e-9


def test_committed_scaling_had_the_same_answers():
    content = json.loads((RESULTS / "scaling.json").read_text())
    assert content["threads"]["the same bits"]
    for rows in content["cells"]["maps"].values():
        done = [row for row in rows if "seconds" in row]
        assert all(row["cells shared with the coarsest map have its regimes and stops"] for row in done)
        assert all(row["their Z differs by"] < 1e-9 for row in done)
    for row in content["open cells"]["maps"]:
        assert row["stuck where beta >= 1, and there only"]


# What the first minute on a screen means


def noted(*rows):
    """A record of the screen: time, message, cells, pending requests."""
    return [
        {
            "at": at,
            "screen": {"cells": cells, "message": message, "motion": "Stick-slip. More", "curve": ""},
            "pending": pending,
        }
        for at, message, cells, pending in rows
    ]


def test_waits_count_only_what_stands_still_while_a_request_has_no_answer():
    found = first_minute.waits(
        noted(
            (0.0, "", "", ["map"]),
            (1.5, "First use: compiling, about 9 s left.", "", ["map"]),
            (4.0, "First use: compiling, about 9 s left.", "", ["map", "motion"]),  # nothing has changed
            (5.0, "First use: compiling, about 5 s left.", "", ["map"]),
            (6.0, "", "40 40", []),
            (30.0, "", "40 40", ["cut"]),
            (31.75, "", "40 30", []),
        )
    )
    assert found == {first_minute.UNCHANGED: 3.5, first_minute.UNEXPLAINED: 1.75}


def test_seconds_without_a_change_are_left_out():
    rows = first_minute.by_seconds(
        noted((0.4, "", "", ["map"]), (1.2, "", "1 1", ["map"]), (3.1, "computing", "40 30", ["map"]))
    )
    assert rows == [
        (0, "no page", ""),
        (1, "nothing; Stick-slip", "map"),
        (2, "boundaries; Stick-slip", "map"),
        (4, "map 40 x 30; computing; Stick-slip", "map"),
    ]


# How numbers are quoted


@pytest.mark.parametrize(
    ("seconds", "text"),
    [
        (0.0508, "51 ms"),
        (19.2, "19 s"),
        (143.0, "140 s"),
        (6.3017e-6, "6.3 µs"),
        (9.99e-4, "1 ms"),
        (0.9036, "900 ms"),
        (1.6e-7, "160 ns"),
        (1e-10, "0.1 ns"),
    ],
)
def test_durations(seconds, text):
    assert quoting.duration(seconds) == text


@pytest.mark.parametrize(
    ("value", "text"),
    [(143385.2, "140,000"), (664.9, "660"), (1.8, "1.8"), (2.0, "2"), (0.0, "0"), (9.97, "10")],
)
def test_two_digits(value, text):
    assert quoting.two_digits(value) == text


def test_the_block_replaces_the_block_and_nothing_else(tmp_path):
    page = tmp_path / "page.md"
    page.write_text(f"before\n{results_page.BEGIN}\nold\n{results_page.END}\nafter\n")
    results_page.rewrite(RESULTS, page)
    before, inside, after = results_page.parts(page.read_text())
    assert (before, after) == ("before\n", "\nafter\n")
    assert inside == results_page.block(RESULTS)
    results_page.rewrite(RESULTS, page)
    assert results_page.parts(page.read_text()) == (before, inside, after)


def test_a_page_without_markers():
    with pytest.raises(ValueError, match="needs the lines"):
        results_page.parts("no markers")


def test_what_was_not_measured_is_not_quoted(tmp_path):
    (tmp_path / "startup.json").write_text((RESULTS / "startup.json").read_text())
    text = results_page.block(tmp_path)
    assert "frictionmap --help" in text
    assert "fresh process" in text
    assert "heyoka" not in text
