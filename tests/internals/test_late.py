"""Kernels that are compiled at their first call: nothing that a run does not call is compiled or loaded."""

import os
import subprocess
import sys
import threading
import time
from pathlib import Path
from typing import NamedTuple

import numba
import numpy as np
import pytest

from frictionmap._kernels.compiler import entry, kernel, late_kernel, mode

pytestmark = [
    pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="nothing is compiled"),
    pytest.mark.skipif(mode.requested() == "plain", reason="the fast compiler is tested"),
]


class Sums(NamedTuple):
    count: int
    total: float
    any: bool


@kernel
def _half(x):
    return 0.5 * x


@late_kernel((int, float))
def _pair(values, factor):
    """The number of values, and their sum times half the factor."""
    total = 0.0
    for value in values:
        total += value
    return values.size, _half(factor) * total


@late_kernel(Sums)
def _sums(values, factor):
    count, total = _pair(values, factor)
    return Sums(count, total, total > 0.0)


@late_kernel(None)
def _put(values, number):
    values[0] = number


@entry
def choose(values, which):
    """3 + 0.5 (0 + 1 + 2) for which = 1, with `_sums` for 2; else the first value is replaced by 7."""
    if which == 1:
        count, total = _pair(values, 1.0)
        return count + total
    if which == 2:
        found = _sums(values, 1.0)
        return found.count + found.total if found.any else -1.0
    if which == 3:
        _put(values, 7.0)
    return 0.0


def _numbers():
    return np.arange(3.0)


#: What a new process prints for a branch: the result, the first value, and the late kernels it has compiled.
_CHILD = """
import sys
import test_late as t
values = t._numbers()
result = t.choose(values, int(sys.argv[1]))
late = {"pair": t._pair, "sums": t._sums, "put": t._put}
print(result, values[0], *(name for name, found in late.items() if found.kernel.overloads))
"""


def _printed(which, place):
    here = Path(__file__).parent
    search = os.pathsep.join([str(here), str(here.parents[1])])
    done = subprocess.run(
        [sys.executable, "-c", _CHILD, str(which)],
        env=os.environ | {"PYTHONPATH": search, "NUMBA_CACHE_DIR": str(place)},
        capture_output=True, text=True, timeout=1800,
    )  # fmt: skip
    assert (done.returncode, done.stderr) == (0, "")
    return done.stdout.split()


def test_only_what_is_called_is_compiled_and_kept(tmp_path):
    """In this order on one disk; the second process of a branch loads what the first has compiled."""

    def on_disk():
        names = {path.name.split("-")[0] for path in tmp_path.rglob("test_late.*")}
        return {name.removeprefix("test_late.") for name in names}

    assert _printed(0, tmp_path) == ["0.0", "0.0"]
    assert on_disk() == {"choose"}
    for _ in range(2):
        assert _printed(3, tmp_path) == ["0.0", "7.0", "put"]
        assert on_disk() == {"choose", "_put"}
    for _ in range(2):
        assert _printed(2, tmp_path) == ["4.5", "0.0", "pair", "sums"]
        assert on_disk() == {"choose", "_put", "_sums", "_pair", "_half"}
    assert _printed(1, tmp_path) == ["4.5", "0.0", "pair"]


def _made(function, returns):
    """A late kernel and an entry that calls it, neither of them compiled."""
    late = late_kernel(returns)(function)
    globals()[function.__name__] = late  # where its callers look for it

    def call(x):
        return late(x)

    return late, entry(call, keep=False)


def interrupted(x):
    return 2.0 * x


def test_an_interrupt_during_the_compilation_comes_after_the_kernel(monkeypatch):
    late, call = _made(interrupted, float)
    compiled, asked = type(late).compiled, []

    def interrupt_once(self, args):
        asked.append(args)
        if len(asked) == 1:
            raise KeyboardInterrupt
        return compiled(self, args)

    monkeypatch.setattr(type(late), "compiled", interrupt_once)

    def call_and_wait():
        call(1.5)
        for _ in range(1000):
            time.sleep(0.01)

    with pytest.raises(KeyboardInterrupt):
        call_and_wait()
    assert len(asked) == 2
    assert call(1.5) == 3.0


def together(x):
    return 4.0 * x


def test_threads_that_need_a_kernel_at_the_same_time_get_it():
    _, call = _made(together, float)
    call.compile((numba.float64,))
    begin, found = threading.Barrier(4), []

    def ask():
        begin.wait()
        found.append(call(0.5))

    threads = [threading.Thread(target=ask) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert found == [2.0] * 4


def test_python_cannot_call_a_late_kernel():
    with pytest.raises(TypeError, match="_put can be called by kernels only; Python calls an entry"):
        _put(_numbers(), 1.0)


_WRONG = """
import test_late as t
t._made(t.wrong, float)[1](1.0)
print("went on")
"""


def wrong(x):
    return x.no_such_attribute


def test_a_late_kernel_that_no_compiler_takes_ends_the_process_with_a_message(tmp_path):
    """Its caller has no number to go on with."""
    here = Path(__file__).parent
    search = os.pathsep.join([str(here), str(here.parents[1])])
    done = subprocess.run(
        [sys.executable, "-c", _WRONG],
        env=os.environ | {"PYTHONPATH": search, "NUMBA_CACHE_DIR": str(tmp_path)},
        capture_output=True, text=True, timeout=1800,
    )  # fmt: skip
    assert (done.returncode, done.stdout) == (1, "")
    assert "a kernel cannot be compiled" in done.stderr
    assert "no_such_attribute" in done.stderr
