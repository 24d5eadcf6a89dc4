"""Named tuples that Python makes and lends to entries: the same values, one memory for every job."""

import pickle
from typing import NamedTuple

import numpy as np
import pytest

from frictionmap._kernels.compiler import entry, kernel, lending
from frictionmap._kernels.compiler.lending import Memories, lent, made

pytestmark = pytest.mark.plain


class Part(NamedTuple):
    """Members whose sizes differ, so that a wrong layout shows."""

    yes: bool
    no: bool
    values: np.ndarray
    also: bool


class Whole(NamedTuple):
    """A tuple in a tuple, between numbers."""

    flag: bool
    part: Part
    count: int
    factor: float
    table: np.ndarray
    found: np.ndarray
    last: bool


@kernel
def _scale(part, factor):
    for i in range(part.values.size):
        part.values[i] *= factor
    return part.yes and not part.no and part.also


@entry
def _use(whole):
    right = _scale(whole.part, whole.factor) and whole.flag and not whole.last
    for i in range(whole.table.shape[0]):
        for k in range(whole.table.shape[1]):
            whole.found[0] += whole.table[i, k] * (i + 10.0 * k)
    return right, whole.count + whole.table.shape[1]


def _whole(flag):
    part = Part(True, np.bool_(False), np.arange(3.0), True)
    return Whole(flag, part, 7, 2.5, np.arange(6.0).reshape(2, 3), np.zeros(1), False)


@pytest.mark.parametrize("flag", [True, False])
def test_an_entry_reads_and_writes_what_python_lends(flag):
    whole = _whole(flag)
    own = lent(whole)
    assert _use(own) == (flag, 10)
    assert _use(own) == (flag, 10)
    assert whole.part.values.tolist() == [0.0, 6.25, 12.5]
    expected = sum(whole.table[i, k] * (i + 10.0 * k) for i in range(2) for k in range(3))
    assert whole.found[0] == 2.0 * expected


def test_what_is_lent_lives_as_long_as_it():
    own = lent(_whole(True))
    kept = [np.full(3, 1e300) for _ in range(100)]  # takes the place of arrays that are gone
    assert _use(own) == (True, 10)
    assert len(kept) == 100


def test_tuples_alike_are_typed_once(monkeypatch):
    """numba takes milliseconds for the type of a tuple of a hundred arrays, more than most kernels run."""
    typed = []
    typeof = lending.numba.typeof
    monkeypatch.setattr(lending.numba, "typeof", lambda group: typed.append(group) or typeof(group))
    whole = _whole(True)
    first = lent(whole)
    if isinstance(first, tuple):  # as plain Python nothing is lent
        return
    typed.clear()
    assert lent(_whole(False)).kind is first.kind
    assert not typed
    others = [whole._replace(table=table) for table in (whole.table.T, whole.table[:, ::2], whole.table[0])]
    fixed = whole.table.copy()
    fixed.flags.writeable = False
    kinds = {lent(other).kind for other in (*others, whole._replace(table=fixed), whole._replace(count=7.0))}
    assert len(kinds | {first.kind}) == 6
    assert pickle.loads(pickle.dumps(first.kind)) == first.kind
    assert hash(pickle.loads(pickle.dumps(first.kind))) == hash(first.kind)


@pytest.mark.parametrize("turned", [False, True])
def test_arrays_need_not_be_contiguous_or_writable(turned):
    whole = _whole(True)
    table = whole.table.copy().T if turned else whole.table.copy()
    table.flags.writeable = False
    other = whole._replace(table=table)
    assert _use(lent(other)) == (True, 7 + table.shape[1])
    expected = sum(table[i, k] * (i + 10.0 * k) for i in range(table.shape[0]) for k in range(table.shape[1]))
    assert other.found[0] == expected


@kernel
def _rows_of(count):
    return count // 2 + 1


@entry
def _make_part(count):
    return Part(count > 2, False, np.full(count, 3.0), True)


@entry
def _make(count):
    rows = _rows_of(count)
    return Whole(
        True, _make_part(count), count, 0.5, np.ones((rows, count)), np.zeros(rows, np.int64), count == 0
    )


@pytest.mark.parametrize("count", [0, 1, 9])
def test_python_allocates_as_the_compiled_entry_does(count):
    one, other = made(_make, count), _make(count)
    interpreted = isinstance(lent(one), tuple)
    numbers = [(each.flag, each.count, each.factor, each.last) for each in (one, other)]
    assert numbers[0] == numbers[1]
    assert (one.part.yes, one.part.no, one.part.also) == (other.part.yes, other.part.no, other.part.also)
    arrays = [(each.part.values, each.table, each.found) for each in (one, other)]
    for a, b in zip(*arrays, strict=True):
        assert (a.dtype, a.shape, a.flags.c_contiguous) == (b.dtype, b.shape, True)
        assert np.array_equal(a, b)
        assert interpreted or a.size == 0 or a.ctypes.data % 64 == 0


def test_memories_are_shared_by_no_two_jobs_and_used_again():
    memories = Memories(lambda: [0])
    with memories.one() as first, memories.one() as second:
        assert first is not second
    with memories.one() as third:
        assert third is first or third is second
