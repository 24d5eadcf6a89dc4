"""Benchmarks as commands, and the numbers in their results."""

import json
import math
import os
import subprocess
import sys
from itertools import pairwise
from pathlib import Path

import pytest
from conftest import ROOT

#: Benchmarks that draw no figure: their tables show all they measure.
WITHOUT_FIGURE = {
    "steady", "startup", "design", "static", "large", "explore", "first_minute", "coupling",
    "spectrum", "banks", "second_starts",
}  # fmt: skip


def python(*arguments: str, timeout: float = 7200.0) -> str:
    """What a fresh Python prints."""
    search = os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])
    done = subprocess.run(
        [sys.executable, *arguments],
        env=os.environ | {"PYTHONPATH": search},
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=timeout,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def numbers(content: object) -> list[float]:
    """All numbers in a result, flags left out."""
    if isinstance(content, dict):
        return [number for value in content.values() for number in numbers(value)]
    if isinstance(content, list):
        return [number for value in content for number in numbers(value)]
    if isinstance(content, int | float) and not isinstance(content, bool):
        return [float(content)]
    return []


def spreads(content: object) -> list[dict]:
    """All timings in a result: what `record.spread` made."""
    if isinstance(content, list):
        return [one for value in content for one in spreads(value)]
    if not isinstance(content, dict):
        return []
    if {"median", "least", "most", "runs"} <= set(content):
        return [content]
    return [one for value in content.values() for one in spreads(value)]


def check_result(folder: Path, name: str, figure: str | None) -> None:
    """Check one result: machine, numbers, timings, and figure if it has one; skip if it needs a browser."""
    content = json.loads((folder / f"{name}.json").read_text())
    machine = content.pop("machine")
    assert machine["versions"]["numba"]
    if "no browser" in content:
        pytest.skip(content["no browser"])
    found = numbers(content)
    assert len(found) > 5
    assert not any(math.isnan(number) for number in found)
    for one in spreads(content):
        assert one["least"] <= one["median"] <= one["most"]
        assert one["runs"] >= 1
    if figure:
        assert (folder / f"{figure}.png").read_bytes().startswith(b"\x89PNG")


def check_quoted(lines: list[str]) -> int:
    """Check lines in Markdown, with tables of numbers; return the number of lines of tables."""
    assert not {"nan", "inf", "None"} & set(" ".join(lines).replace("(", " ").split())
    for before, line in pairwise(lines):  # as many cells in a row as in the one above
        if before.startswith("|") and line.startswith("|"):
            assert before.count("|") == line.count("|")
    return sum(line.startswith("|") for line in lines)
