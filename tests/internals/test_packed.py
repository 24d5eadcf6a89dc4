"""Named tuples passed by their address: the same values, the same memory, references counted."""

import sys
from typing import NamedTuple

import numpy as np
import pytest

from frictionmap._kernels.compiler import entry, kernel
from frictionmap._kernels.compiler.packed import packed

pytestmark = pytest.mark.plain


class Inner(NamedTuple):
    """Members of several kinds."""

    values: np.ndarray
    number: float
    flag: bool


class Outer(NamedTuple):
    """A tuple in a tuple."""

    inner: Inner
    counts: np.ndarray
    length: int


@kernel
def _sum_of(inner):
    total = 0.0
    for value in inner.values:
        total += value
    return total * inner.number if inner.flag else -total


@kernel
def _fill(outer, factor):
    """Write to an array while the members are read: none of them may be taken for changed."""
    for i in range(outer.length):
        outer.inner.values[i] = factor * outer.inner.values[i] + outer.inner.number
        outer.counts[i] += i
    return _sum_of(outer.inner)


@kernel
def _pack_and_fill(outer, factor):
    return _fill(packed(outer), factor)


@entry
def _filled(outer, factor):
    return _pack_and_fill(outer, factor)


@entry
def _own(n):
    """Fill arrays that nothing else refers to."""
    total = 0.0
    for _ in range(3):
        total += _pack_and_fill(Outer(Inner(np.ones(n), 0.5, True), np.zeros(n, np.int64), n), 2.0)
    return total


@pytest.mark.parametrize("flag", [True, False])
def test_members_are_those_of_the_tuple(flag):
    values, counts = np.arange(4.0), np.zeros(4, np.int64)
    found = _filled(Outer(Inner(values, 0.5, flag), counts, 4), 3.0)
    np.testing.assert_array_equal(values, 3.0 * np.arange(4.0) + 0.5)
    np.testing.assert_array_equal(counts, np.arange(4))
    assert found == (0.5 * values.sum() if flag else -values.sum())


def test_references_are_counted():
    values, counts = np.arange(1000.0), np.zeros(1000, np.int64)
    outer = Outer(Inner(values, 0.5, True), counts, 1000)
    before = sys.getrefcount(values), sys.getrefcount(counts)
    for _ in range(5):
        _filled(outer, 1.0)
    assert (sys.getrefcount(values), sys.getrefcount(counts)) == before
    assert [_own(1000) for _ in range(20)] == [3 * 0.5 * 2500.0] * 20
