"""Benchmarks as commands, and the numbers in their results."""

import os
import subprocess
import sys
from itertools import pairwise

from conftest import ROOT


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


def check_tables(lines: list[str]) -> int:
    """Check tables in Markdown, numbers in every cell; return the number of their lines."""
    tables = [line for line in lines if line.startswith("|")]
    assert not {"nan", "inf", "None"} & set(" ".join(tables).replace("(", " ").split())
    for before, line in pairwise(lines):  # as many cells in a row as in the one above
        if before.startswith("|") and line.startswith("|"):
            assert before.count("|") == line.count("|")
    return len(tables)
